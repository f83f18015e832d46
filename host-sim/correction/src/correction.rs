//! From a measured pass to its correction: the steps of [`truepath_core::job`], with what lies between them kept for the
//! reports.

use std::sync::Arc;

use truepath_core::correct::{
    Band, Damped, Design, DesignStep, DesignWorkspace, Guarded, Law, Node, Predicted, Profile, Scratch, Update,
    WallReader, add_residual, commanded, guarded_design, guarded_given,
};
use truepath_core::cut::{ForceTable, Loop, Passage, Path, State, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::{Fit, Observation, Prior};
use truepath_core::job;
use truepath_core::units::{Offset, hypot_nm};
use truepath_ground::diagnostics::Failure;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use crate::discrepancy::{Along, PartCut, plain};
use crate::force_tables::force_table;
use crate::identification::{Found, asked};
use crate::misfit::refuse_misfit;
use crate::parallel_walls::{ParallelWalls, run};

/// What the probe points say about machine and material.
#[derive(Clone, Debug)]
pub struct Identification {
    /// The result of the core.
    pub core: job::Identified,
    /// The points with predictions and weights.
    pub observations: Vec<Observation>,
}

/// A correction and what it is expected to do, one entry per sample of the contour.
#[derive(Clone, Debug)]
pub struct Correction {
    /// The correction.
    pub nodes: Vec<Node>,
    /// What the target alone wants: the same where no guard forbids it.
    pub unguarded: Vec<Node>,
    /// Predicted wall errors.
    pub predicted: Vec<Predicted>,
    /// Standard deviation of the predicted error after, on the next part.
    pub sigma: Vec<Offset>,
    /// The part of it that more points would lower: the rest is what parts differ in.
    pub sigma_by_points: Vec<Offset>,
    /// Where only a share of it is applied, if anywhere.
    pub damped: Option<Damped>,
    /// Whether it was used before; `unguarded` is then what it was.
    pub used_again: bool,
    /// What it was designed for.
    pub wanted: Design,
    /// Whether the wall turns on the spot beside a sample, in a sharp inside corner.
    pub turning: Vec<bool>,
    /// How the elastic loop fared.
    pub passage: Passage,
}

impl Correction {
    /// The walls that are judged, with their samples: those beside the path, not what sharp inside corners keep in their rounding.
    pub fn walls(&self) -> impl Iterator<Item = (usize, &Predicted)> {
        self.predicted.iter().enumerate().filter(|(at, _)| self.turning.get(*at) != Some(&true))
    }
}

/// Fits machine and material to the measurement of an uncorrected part. `progress` is told the share done, 0…1.
///
/// # Errors
/// Points that do not fit the job.
pub fn identify(
    pass: &Pass,
    path: &Path,
    measurement: &Measurement,
    progress: impl FnMut(f64),
) -> Result<Identification, Failure> {
    let found = identify_together(&[MeasuredCut { pass, path, measurement }], progress)?;
    found.into_iter().next().ok_or_else(|| Failure::Internal("a cut without what its points say".to_owned()))
}

/// One of the cuts of an uncorrected part, and what was measured of it.
#[derive(Clone, Copy, Debug)]
pub struct MeasuredCut<'a> {
    /// The cut.
    pub pass: &'a Pass,
    /// Its path.
    pub path: &'a Path<'a>,
    /// Its points.
    pub measurement: &'a Measurement,
}

/// Fits one machine and material to the points of all cuts of an uncorrected part, which one cutter made. Every cut is given
/// what is known of them and its own points.
///
/// # Errors
/// As [`identify`], of all points together.
pub fn identify_together(cuts: &[MeasuredCut<'_>], progress: impl FnMut(f64)) -> Result<Vec<Identification>, Failure> {
    identify_with(cuts, None, progress)
}

/// The same where their [`plain()`] fit may be there already.
///
/// # Errors
/// As [`identify_together`].
pub(crate) fn identify_with(
    cuts: &[MeasuredCut<'_>],
    fit: Option<Found>,
    mut progress: impl FnMut(f64),
) -> Result<Vec<Identification>, Failure> {
    let Some(first) = cuts.first() else { return Ok(Vec::new()) };
    let measured = cuts.iter().map(|cut| cut.measurement.observations()).collect::<Result<Vec<_>, _>>()?;
    let law = asked(first.pass.core.job.force.model);
    let parts: Vec<PartCut<'_>> = cuts
        .iter()
        .zip(&measured)
        .enumerate()
        .map(|(contour, (cut, observations))| PartCut::uncorrected(*cut.path, contour, observations))
        .collect();
    let fitted = fit.unwrap_or_else(|| plain(first.pass, law, &parts, &mut progress));
    let Found { core, observations, .. } = fitted;
    let mut rest = observations.into_iter();
    let own = |own: &Vec<Observation>| Identification { core, observations: rest.by_ref().take(own.len()).collect() };
    let identified: Vec<Identification> = measured.iter().map(own).collect();
    for (cut, identified) in cuts.iter().zip(&identified) {
        refuse_misfit(cut.pass, cut.measurement, &core, &identified.observations)?;
    }
    Ok(identified)
}

impl Identification {
    /// How many of the points do not fit and have little weight.
    pub fn outlying(&self) -> usize {
        self.observations.iter().filter(|o| o.is_outlying()).count()
    }
    /// The wall law, given or found.
    pub const fn law(&self) -> WallLaw {
        self.core.law
    }
    /// What was believed before.
    pub const fn prior(&self) -> &Prior {
        &self.core.prior
    }
    /// What is known now.
    pub const fn fit(&self) -> &Fit {
        &self.core.fit
    }
    /// The force table of the identified cutter.
    pub fn table(&self) -> Arc<ForceTable> {
        force_table(&self.core.fit.parameters)
    }
    /// The identified machine on a path.
    pub const fn machine<'a>(&self, path: &'a Path<'a>, table: &'a ForceTable) -> Loop<'a> {
        self.core.machine(path, table)
    }
}

/// What a correction is made from, beside the machine.
#[derive(Clone, Copy, Debug)]
pub struct DesignRequest<'a> {
    /// How it is made.
    pub law: Law,
    /// What is beside the model along the contour; empty where nothing is known.
    pub beside: &'a Along,
    /// A correction that is used again instead of a new one, as far as the guard allows.
    pub kept: Option<&'a [Node]>,
}

impl DesignRequest<'_> {
    /// By a law, of what the model predicts alone.
    pub const fn of(law: Law) -> Self {
        static NOTHING: Along = Along::NONE;
        Self { law, beside: &NOTHING, kept: None }
    }
}

/// Designs the correction of an identified pass. `progress` is told the share done, 0…1.
///
/// # Errors
/// A correction beyond the clamp.
pub fn design_correction(
    pass: &Pass,
    machine: &Loop,
    identified: &Identification,
    request: &DesignRequest,
    mut progress: impl FnMut(f64),
) -> Result<Correction, Failure> {
    let wanted = pass.job.numbers.design(request.law);
    let correction = guarded_correction(machine, identified, wanted, request, &mut progress);
    job::check_clamp(&pass.job.numbers, machine.path, &correction.nodes).map_err(|error| pass.refused(&error))?;
    progress(1.0);
    Ok(correction)
}

/// What a correction that a part was cut with does, as the machine is known now: nothing of it is taken back.
pub fn evaluate(
    pass: &Pass,
    machine: &Loop,
    identified: &Identification,
    nodes: &[Node],
    request: &DesignRequest,
) -> Correction {
    let wanted = Design { max_gouge: None, ..pass.job.numbers.design(request.law) };
    guarded_correction(machine, identified, wanted, &DesignRequest { kept: Some(nodes), ..*request }, &mut |_| ())
}

/// A correction by its design and request.
fn guarded_correction(
    machine: &Loop,
    identified: &Identification,
    wanted: Design,
    request: &DesignRequest,
    progress: &mut dyn FnMut(f64),
) -> Correction {
    let path = machine.path;
    let count = path.count();
    let mut buffers = Buffers::of(path);
    let mut workspace = buffers.workspace(&request.beside.mean, &request.beside.sigma);
    let mut nodes = vec![Node::default(); count];
    let mut unguarded = nodes.clone();
    let mut predicted = vec![Predicted::default(); count];
    let mut sigma = vec![Offset::ZERO; count];
    let belief = (identified.prior(), identified.fit());
    let mut made = Guarded {
        nodes: &mut nodes,
        unguarded: &mut unguarded,
        predicted: &mut predicted,
        sigma: &mut sigma,
        damped: None,
    };
    let passage = match request.kept {
        Some(kept) => guarded_given(machine, belief, &wanted, kept, &mut made, &mut workspace),
        None => guarded_design(machine, belief, &wanted, &mut made, &mut workspace, &mut |step| {
            if let DesignStep::Done { permille, .. } = step {
                progress(0.9 * f64::from(permille) / 1000.0);
            }
        }),
    };
    let damped = made.damped;
    for (sigma, more) in sigma.iter_mut().zip(&request.beside.sigma) {
        *sigma = hypot_nm(*sigma, *more);
    }
    let sigma_by_points = sigma.clone();
    for (sigma, more) in sigma.iter_mut().zip(&request.beside.repeat) {
        *sigma = hypot_nm(*sigma, *more);
    }
    let used_again = request.kept.is_some();
    let turning = (0..count).map(|i| path.is_pivot(path.first() + i)).collect();
    Correction { turning, nodes, unguarded, predicted, sigma, sigma_by_points, damped, used_again, wanted, passage }
}

/// Memory of a design.
#[derive(Clone, Debug)]
pub struct Buffers {
    states: Vec<State>,
    displacements: Vec<Vector>,
    profiles: Vec<Profile>,
    updates: Vec<Update>,
    scratch: Vec<Scratch>,
    walls: ParallelWalls,
}

impl Buffers {
    /// For a path.
    pub fn of(path: &Path) -> Self {
        let (count, working) = (path.count(), path.working().len());
        Self {
            states: vec![State::REST; working],
            displacements: vec![Vector::ZERO; working],
            profiles: vec![Profile::default(); count],
            updates: vec![Update::default(); count],
            scratch: vec![Scratch::default(); count],
            walls: ParallelWalls::of(path),
        }
    }

    /// Lends it, with what is beside the model along the contour: expected, and its standard deviation.
    pub fn workspace<'a>(
        &'a mut self,
        residual: &'a [Offset],
        beside_sigma: &'a [Offset],
    ) -> DesignWorkspace<'a, &'a mut ParallelWalls> {
        DesignWorkspace {
            states: &mut self.states,
            displacements: &mut self.displacements,
            profiles: &mut self.profiles,
            updates: &mut self.updates,
            scratch: &mut self.scratch,
            residual,
            beside_sigma,
            reader: &mut self.walls,
        }
    }
}

/// The wall beside every sample of the contour that a machine leaves with a correction, empty for none.
pub fn walls(machine: &Loop, band: Band, nodes: &[Node], residual: &[Offset]) -> (Vec<Profile>, Passage) {
    let path = machine.path;
    let working = path.working();
    let mut states = vec![State::REST; working.len()];
    let passage = run(machine, working.start, &mut states, &|i| commanded(path, nodes, i));
    let mut displacements = vec![Vector::ZERO; working.len()];
    let mut walls = vec![Profile::default(); path.count()];
    ParallelWalls::of(path).profile(machine, &states, band, &mut displacements, &mut walls);
    add_residual(&mut walls, residual);
    (walls, passage)
}
