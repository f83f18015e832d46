//! The few processes a user chooses from.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use truepath_core::cut::{ForceTable, Path, Sample};
use truepath_core::identify::{Parameters, neighbours};
use truepath_core::job;
use truepath_core::process::{ImmersionGrid, Mill, Slices};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{float, mm};
use truepath_job::job::PlanTable;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use super::bench::Bench;
use super::confidence::{Draws, Predicted};
use super::process::{Cut, words};
use super::refit::refit;
use super::search::{Candidate, search};
use super::wall::{WallFigures, WallMap};
use crate::correction::{Identification, identify};
use crate::planned::{self, PlannedPass, PlannedProgram};

/// The most processes to choose from.
const MOST: usize = 6;
/// Candidates that are looked at closely.
const CLOSE: usize = 8;
/// What a plan is for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Half the width of the tolerance of the wall at every height, mm.
    pub tolerance_mm: f64,
    /// The share of machines like this one whose part has to be within it, 0…1.
    pub confidence: f64,
    /// What the process has to keep.
    pub limits: PlanTable,
}

/// A process to choose.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Choice {
    /// Its cuts, in words.
    pub process: String,
    /// Its cuts.
    #[serde(skip)]
    pub cuts: Vec<Cut>,
    /// Passes along the contour.
    pub passes: usize,
    /// Minutes along the contour, leads included.
    pub minutes: f64,
    /// Over that of the program's pass.
    pub time_ratio: f64,
    /// The predicted profile error with its standard deviation.
    #[serde(flatten)]
    pub predicted: Predicted,
    /// The wall as the identified machine cuts it.
    pub wall: WallFigures,
    /// The wall unrolled, as that machine cuts it.
    #[serde(skip)]
    pub map: WallMap,
    /// The share of machines that the points allow whose wall is within the tolerance.
    pub within_tolerance: f64,
    /// What makes most of its error.
    pub limited_by: &'static str,
    /// The largest mean force of a pass, N.
    pub force_n: f64,
    /// The thickest chip of the last pass, mm, as the mean along the contour.
    pub chip_mm: f64,
}

/// A plan.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Plan {
    /// The wall that the program leaves in one uncorrected pass.
    pub as_programmed: WallFigures,
    /// That wall unrolled.
    #[serde(skip)]
    pub map: WallMap,
    /// Minutes of that pass, leads included.
    pub minutes: f64,
    /// The choices, the fastest first.
    pub choices: Vec<Choice>,
    /// The number, from 1, of the fastest that holds the tolerance; `None` where none does.
    pub recommended: Option<usize>,
    /// Half the width of the tolerance, mm.
    pub tolerance_mm: f64,
    /// The share of machines asked for, 0…1.
    pub confidence: f64,
}

/// How finely a bench looks.
#[derive(Clone, Copy, Debug)]
struct Resolution {
    /// Along the contour, um.
    step_um: i64,
    /// The most slices.
    slices: usize,
}

const COARSE: Resolution = Resolution { step_um: 1000, slices: 12 };
const MIDDLE: Resolution = Resolution { step_um: 500, slices: 24 };
const FINE: Resolution = Resolution { step_um: 250, slices: 48 };
/// Levels that slices are divided by: 2, 3 and 4.
const DIVISIONS: usize = 12;

/// The program of a process.
#[derive(Clone, Debug)]
pub struct WrittenPlan {
    /// Its bytes, where its passes stand, and what was changed.
    pub program: PlannedProgram,
    /// The figures of the wall of the identified machine.
    pub wall: WallFigures,
    /// That wall unrolled.
    pub map: WallMap,
    /// Largest distance of a commanded place from the programmed path, mm.
    pub largest_correction_mm: f64,
}

/// What a process is planned for: the finishing pass and the machine that was identified on it.
#[derive(Clone, Debug)]
pub struct Planner<'a> {
    pass: &'a Pass,
    known: Identification,
}

impl<'a> Planner<'a> {
    /// Of a pass and the points of its wall.
    ///
    /// # Errors
    /// Points that do not fit the job, and a contour that cannot be sampled.
    pub fn new(pass: &'a Pass, measurement: &Measurement, progress: impl FnMut(f64)) -> Result<Self, Failure> {
        let mut buffer = PathBuffer::default();
        let sampled = pass.sample(&mut buffer)?;
        let known = identify(pass, &sampled, measurement, progress)?;
        let mut planner = Self { pass, known };
        let mut samples = Vec::new();
        let coarse = planner.path(MIDDLE, &mut samples)?;
        planner.known = refit(pass, (&sampled, &coarse), measurement, &planner.known)?;
        Ok(planner)
    }

    /// Machine and material.
    pub const fn known(&self) -> &Identification {
        &self.known
    }

    /// Searches, and looks closely at the best; `progress` is told the share done, 0…1.
    ///
    /// # Errors
    /// A contour that cannot be sampled.
    pub fn plan(&self, wanted: &Wanted, progress: &(dyn Fn(f64) + Sync)) -> Result<Plan, Failure> {
        let (table, grid) = (self.known.table(), ImmersionGrid::new());
        let mut samples = Vec::new();
        let path = self.path(COARSE, &mut samples)?;
        let found = search(&self.bench(&path, &table, &grid, COARSE), &wanted.limits, &|share| progress(0.5 * share));
        let found = shortlist(found, wanted.tolerance_mm);

        let mut samples = Vec::new();
        let path = self.path(MIDDLE, &mut samples)?;
        let bench = self.bench(&path, &table, &grid, MIDDLE);
        let done = AtomicUsize::new(0);
        let look = |candidate: &Candidate| {
            let choice = self.look(&bench, &grid, candidate, wanted);
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(0.5 + 0.5 * done as f64 / found.len() as f64);
            choice
        };
        let mut choices: Vec<Choice> = found.par_iter().map(look).collect();
        choices.sort_by(|a, b| a.minutes.total_cmp(&b.minutes));
        keep_worthwhile(&mut choices, wanted);
        let holds = |choice: &Choice| choice.within_tolerance >= wanted.confidence;
        let programmed = bench.as_programmed().left;
        Ok(Plan {
            as_programmed: bench.figures(&programmed),
            map: bench.map(&programmed),
            minutes: bench.minutes(),
            recommended: choices.iter().position(holds).map(|at| at + 1),
            choices,
            tolerance_mm: wanted.tolerance_mm,
            confidence: wanted.confidence,
        })
    }

    /// Designs a process finely and writes its program; `probe` is the CRC-32 of the points. `progress` is told the share done.
    ///
    /// # Errors
    /// A contour that cannot be sampled, a correction beyond the clamp, and those of [`planned::write()`].
    pub fn write(&self, cuts: &[Cut], probe: u32, progress: &mut dyn FnMut(f64)) -> Result<WrittenPlan, Failure> {
        const TURNS: u32 = 16;
        let (table, grid) = (self.known.table(), ImmersionGrid::new());
        let mut samples = Vec::new();
        let path = self.path(FINE, &mut samples)?;
        let bench = self.bench(&path, &table, &grid, FINE);
        let mut stage = bench.raw();
        for (k, cut) in cuts.iter().enumerate() {
            stage = bench.cut(stage, cut, TURNS);
            progress((k + 1) as f64 / cuts.len() as f64);
        }
        let depth = path.setup().axial_depth;
        let passes: Vec<PlannedPass> = stage
            .passes
            .iter()
            .map(|pass| PlannedPass {
                nodes: pass.nodes.clone(),
                raise: Offset::from_mm(depth * pass.order.raised),
                reversed: pass.order.order.reversed,
                feed: float(pass.order.order.feed),
            })
            .collect();
        for pass in &passes {
            job::check_clamp(&self.pass.job.numbers, &path, &pass.nodes).map_err(|error| self.pass.refused(&error))?;
        }
        let program = planned::write(self.pass, &path, &passes, Some(probe))?;
        let nodes = passes.iter().flat_map(|pass| &pass.nodes);
        Ok(WrittenPlan {
            program,
            wall: bench.figures(&stage.left),
            map: bench.map(&stage.left),
            largest_correction_mm: nodes.map(|node| mm(node.total().length())).fold(0.0, f64::max),
        })
    }

    /// The limits of the job that the program stands: passes can only be added where its leads let them, and run the other way where
    /// these can be turned round. What cannot is said.
    pub fn possible(&self, mut limits: PlanTable) -> (PlanTable, Vec<String>) {
        let mut said = Vec::new();
        if let Err(failure) = planned::can_repeat_pass(self.pass) {
            (limits.max_cuts, limits.max_levels) = (1, 1);
            said.push(format!("no pass can be added to this program, so that one is all that is planned: {failure}"));
        } else if limits.reverse
            && let Err(failure) = planned::can_reverse(self.pass)
        {
            limits.reverse = false;
            said.push(format!("no pass of this program can run the other way: {failure}"));
        }
        (limits, said)
    }

    fn path<'p>(&self, resolution: Resolution, samples: &'p mut Vec<Sample>) -> Result<Path<'p>, Failure> {
        let (contour, setup) = (self.pass.path_contour(), &self.pass.core.setup);
        // An eighth of the cutter's radius is as much as the engagement of a small cutter stands.
        let finest = Offset::from_nm(setup.radius.nm() / 8);
        let step = Offset::from_um(resolution.step_um).min(finest);
        samples.resize(Path::samples_needed(&contour, setup, step), Sample::BLANK);
        let path = self.pass.core.sample_every(step, &contour, samples, |_| ());
        let path = path.map_err(|error| self.pass.refused(&error))?;
        Ok(path.with_law(self.known.law()))
    }

    fn bench<'p>(
        &self,
        path: &'p Path<'p>,
        table: &'p ForceTable,
        grid: &'p ImmersionGrid,
        resolution: Resolution,
    ) -> Bench<'p> {
        let slices = slices(path, resolution);
        let leads: f64 = self.pass.leads().iter().flat_map(|l| l.iter()).map(|block| mm(block.curve.length())).sum();
        Bench::new(Mill::new(self.known.machine(path, table), grid, slices), slices, leads)
    }

    /// Cuts a candidate anew, and by every machine that the points allow.
    fn look(&self, bench: &Bench, grid: &ImmersionGrid, candidate: &Candidate, wanted: &Wanted) -> Choice {
        const TURNS: u32 = 12;
        let mut stage = bench.raw();
        for cut in &candidate.cuts {
            stage = bench.cut(stage, cut, TURNS);
        }
        let machine = bench.machine();
        let mut table = ForceTable::new(machine.table.size_exponent());
        let mut changed = Vec::new();
        let found = &self.known.fit().parameters;
        let others = neighbours(self.known.prior(), self.known.fit());
        for (parameters, share) in others.chain(unmodelled(found).map(|p| (p, Real::ONE))) {
            if parameters.machine(bench.path(), &table).cuts_as(machine) {
                continue;
            }
            if parameters.coefficients.size_exponent != table.size_exponent() {
                table.tabulate(parameters.coefficients.size_exponent);
            }
            let other = bench.of(Mill::new(parameters.machine(bench.path(), &table), grid, bench.slices()));
            changed.push((other.follow(&stage.passes), float(share)));
        }
        let wall = bench.figures(&stage.left);
        let draws = Draws::of((bench.path(), bench.slices()), &stage.left, &changed);
        let predicted = draws.predicted();
        Choice {
            process: words(&candidate.cuts),
            cuts: candidate.cuts.clone(),
            passes: stage.passes.len(),
            minutes: stage.minutes,
            time_ratio: stage.minutes / bench.minutes(),
            predicted,
            within_tolerance: draws.within(wanted.tolerance_mm),
            limited_by: limited_by(&wall, &predicted),
            map: bench.map(&stage.left),
            wall,
            force_n: stage.passes.iter().map(|p| float(p.load.force)).fold(0.0, f64::max),
            chip_mm: stage.passes.last().map_or(0.0, |p| float(p.load.chip)),
        }
    }
}

fn slices(path: &Path, resolution: Resolution) -> Slices {
    let wanted = Slices::of(path.setup(), DIVISIONS).count();
    Slices::new(wanted.min(resolution.slices))
}

/// Machines that the points do not tell from the one that was found, however many they are, because the model is not the cut: the
/// force by 2 %, the radial share by 3 %, the edge by 5 %, the exponent of the chip by 0.02, the bending
/// by 0.05 and the size of the cutter by 2 um.
fn unmodelled(found: &Parameters) -> impl Iterator<Item = Parameters> + use<> {
    let found = *found;
    let scaled = |value: Real, percent: i64| value + value * Real::ratio(percent, 100);
    let mut other = [found; 6];
    other[0].compliance.mean = scaled(found.compliance.mean, 2);
    other[0].compliance.difference = scaled(found.compliance.difference, 2);
    other[0].compliance.cross = scaled(found.compliance.cross, 2);
    other[1].coefficients.krc = scaled(found.coefficients.krc, 3);
    other[2].coefficients.kte = scaled(found.coefficients.kte, 5);
    other[2].coefficients.kre = scaled(found.coefficients.kre, 5);
    other[3].coefficients.size_exponent = found.coefficients.size_exponent + Real::ratio(2, 100);
    other[4].compliance.bend = found.compliance.bend + Real::ratio(5, 100);
    other[5].undersize = found.undersize + Offset::from_um(2);
    other.into_iter()
}

/// Of the front, the most accurate, the first that might hold the tolerance with its neighbours, and the fastest.
fn shortlist(front: Vec<Candidate>, tolerance_mm: f64) -> Vec<Candidate> {
    if front.len() <= CLOSE {
        return front;
    }
    let first = front.iter().position(|c| c.profile_mm <= tolerance_mm).unwrap_or(front.len() - 1);
    let last = front.len() - 1;
    let mut wanted: Vec<usize> = vec![0, last, first];
    for away in 1..front.len() {
        wanted.extend([first + away, first.wrapping_sub(away)].into_iter().filter(|at| *at <= last));
    }
    let mut kept = Vec::new();
    for at in wanted {
        if kept.len() < CLOSE && !kept.contains(&at) {
            kept.push(at);
        }
    }
    let mut front: Vec<Option<Candidate>> = front.into_iter().map(Some).collect();
    kept.sort_unstable();
    kept.into_iter().filter_map(|at| front[at].take()).collect()
}

/// Leaves out what takes longer and is no better, and, of more than six, the least different.
fn keep_worthwhile(choices: &mut Vec<Choice>, wanted: &Wanted) {
    let mut best = f64::INFINITY;
    choices.retain(|choice| {
        let better = choice.predicted.profile_mm < best;
        best = best.min(choice.predicted.profile_mm);
        better
    });
    while choices.len() > MOST {
        let holds = choices.iter().position(|c| c.within_tolerance >= wanted.confidence);
        let gain = |k: usize| choices[k - 1].predicted.profile_mm / choices[k].predicted.profile_mm;
        let inner = (1..choices.len() - 1).filter(|k| Some(*k) != holds);
        let Some(least) = inner.min_by(|a, b| gain(*a).total_cmp(&gain(*b))) else { break };
        choices.remove(least);
    }
}

/// The largest part of the error at the worst place, or what is not known of the machine.
fn limited_by(wall: &WallFigures, predicted: &Predicted) -> &'static str {
    let parts = [
        (wall.worst_height_mm, "height (helix)"),
        (wall.worst_tilt_mm.abs(), "lean (bending and helix)"),
        (wall.worst_mean_mm.abs(), "mean (what one pass can follow)"),
        (2.0 * predicted.sigma_mm, "knowledge of the machine"),
    ];
    parts.into_iter().max_by(|a, b| a.0.total_cmp(&b.0)).map_or("", |part| part.1)
}
