//! From a measured pass to its correction: identification, design, uncertainty, all in the core.

use truepath_core::correct::{
    self, Band, Design, DesignWorkspace, Node, PaperRatio, PaperTransfer, Predicted, Profile, Update, design,
    uncertainty,
};
use truepath_core::cut::{ForceTable, Loop, Passage, Path, State, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::{Fit, Observation, PredictionWorkspace, Prior, identify, identify_law};
use truepath_core::image::MAX_CLAMP_NM;
use truepath_core::probe::Contact;
use truepath_core::units::{Offset, Position, Real};

use crate::job::{Correct, ForceModel, Law, Target};
use crate::measurement::Measurement;
use crate::pass::Pass;

/// What the probe points say about machine and material.
#[derive(Clone, Debug)]
pub struct Identified {
    /// The wall law, given or found.
    pub law: WallLaw,
    /// What was believed before.
    pub prior: Prior,
    /// What is known now.
    pub fit: Fit,
    /// The points with predictions and weights.
    pub observations: Vec<Observation>,
}

/// A correction and what it is expected to do, one entry per sample of the contour.
#[derive(Clone, Debug)]
pub struct Correction {
    /// The correction.
    pub nodes: Vec<Node>,
    /// Predicted wall errors.
    pub predicted: Vec<Predicted>,
    /// Standard deviation of the predicted error after.
    pub sigma: Vec<Offset>,
    /// What it was designed for.
    pub wanted: Design,
    /// How the elastic loop fared.
    pub passage: Passage,
}

/// Buffers for the prediction of probe points.
fn prediction_buffers(path: &Path) -> (Vec<State>, Vec<Vector>) {
    let needed = PredictionWorkspace::needed(path);
    (vec![State::REST; needed], vec![Vector::ZERO; needed])
}

/// Fits machine and material to the measurement of an uncorrected part.
pub fn identified(pass: &Pass, path: &Path, measurement: &Measurement) -> Identified {
    let mut observations = measurement.observations();
    let (mut states, mut displacements) = prediction_buffers(path);
    let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
    let uncorrected = |_| Vector::ZERO;
    let given = match pass.job.force.model {
        ForceModel::Auto => None,
        ForceModel::Mean => Some(WallLaw::Mean),
        ForceModel::Helical => Some(WallLaw::Helical),
    };
    let (law, prior, fit) = match given {
        None => identify_law(path, |law| pass.prior(law), &mut observations, uncorrected, &mut workspace),
        Some(law) => {
            let prior = pass.prior(law);
            let fit = identify(&path.with_law(law), &prior, &mut observations, uncorrected, &mut workspace);
            (law, prior, fit)
        }
    };
    Identified { law, prior, fit, observations }
}

impl Identified {
    /// The force table of the identified cutter.
    pub fn table(&self) -> ForceTable {
        ForceTable::new(self.fit.parameters.coefficients.size_exponent)
    }
    /// The identified machine on a path.
    pub fn machine<'a>(&self, path: &'a Path<'a>, table: &'a ForceTable) -> Loop<'a> {
        let parameters = &self.fit.parameters;
        Loop { path, table, coefficients: parameters.coefficients, compliance: parameters.compliance }
    }
}

/// What the job wants of a correction.
pub fn wanted(pass: &Pass, law: correct::Law) -> Design {
    let job: &Correct = &pass.job.correct;
    let depth = pass.job.cut.axial_depth;
    let [from, to] = job.band;
    Design {
        law,
        target: match job.target {
            Target::Mean => correct::Target::Mean,
            Target::Tip => correct::Target::Tip,
            Target::Minimax => correct::Target::Minimax,
        },
        band: Band { from: from.over(depth), to: to.over(depth) },
        max_gouge: job.max_gouge,
    }
}

/// The law the job names, with what it needs.
pub fn law(pass: &Pass, machine: &Loop, contacts: &[Contact], named: Law) -> correct::Law {
    match named {
        Law::Model => correct::Law::Model,
        Law::Mirror => correct::Law::Mirror,
        Law::Paper => correct::Law::Paper(paper_transfer(pass, machine, contacts)),
    }
}

/// P23 eq. (9) from one probe per wall: for each axis the contact whose normal is nearest to it, at mid-height where
/// there are several.
fn paper_transfer(pass: &Pass, machine: &Loop, contacts: &[Contact]) -> PaperTransfer {
    let path = machine.path;
    let ratio = |component: fn(&Contact) -> Real, coordinate: fn(&Contact, Offset) -> (Position, Offset)| {
        let best = contacts.iter().max_by_key(|c| (component(c).abs(), -(c.height - Real::HALF).abs()));
        let Some(contact) = best.filter(|c| component(c).abs() > Real::ratio(1, 100)) else {
            return PaperRatio::default();
        };
        let (position, displacement) = coordinate(contact, pass.setup.radius);
        let index = path.index_at(contact.s);
        let mut state = [State::REST];
        machine.run(index, &mut state, |_| Vector::ZERO);
        PaperRatio::new(position - Position::ZERO, displacement, state[0].engaged)
    };
    PaperTransfer {
        x: ratio(|c| c.normal.x, |c, r| (c.point.x - r.scaled(c.normal.x), -c.error.scaled(c.normal.x))),
        y: ratio(|c| c.normal.y, |c, r| (c.point.y - r.scaled(c.normal.y), -c.error.scaled(c.normal.y))),
    }
}

/// Designs the correction of an identified pass. `progress` is told the share done, 0…1.
pub fn corrected(machine: &Loop, identified: &Identified, wanted: Design, mut progress: impl FnMut(f64)) -> Correction {
    let path = machine.path;
    let (count, working) = (path.count(), path.working().len());
    let mut states = vec![State::REST; working];
    let mut displacements = vec![Vector::ZERO; working];
    let mut profiles = vec![Profile::default(); count];
    let mut updates = vec![Update::default(); count];
    let mut best = vec![Node::default(); count];
    let mut workspace = DesignWorkspace {
        states: &mut states,
        displacements: &mut displacements,
        profiles: &mut profiles,
        updates: &mut updates,
        best: &mut best,
    };
    let mut nodes = vec![Node::default(); count];
    let mut predicted = vec![Predicted::default(); count];
    let mut sigma = vec![Offset::ZERO; count];
    let passage = design(machine, &wanted, &mut nodes, &mut predicted, &mut workspace);
    progress(0.6);
    let belief = (&identified.prior, &identified.fit);
    uncertainty(machine, belief, &wanted, &nodes, &predicted, &mut sigma, &mut workspace);
    progress(1.0);
    Correction { nodes, predicted, sigma, wanted, passage }
}

/// What to do about a correction beyond the clamp: the peak and a tenth of it, rounded up to a hundredth, where that may
/// be a deflection at all.
pub fn clamp_help(peak: Offset) -> String {
    let proposal = (crate::report::mm(peak) * 110.0).ceil() / 100.0;
    if proposal > crate::report::mm(Offset::from_nm(MAX_CLAMP_NM)) {
        return "no cutter deflects that much: check the side of the wall, the cutter's diameter and the probe file"
            .to_owned();
    }
    format!(
        "if a correction that large is meant, set clamp_mm = {proposal} in [correct]; otherwise check the probe file and the cut"
    )
}
