//! The few processes a user chooses from.

use std::sync::atomic::{AtomicUsize, Ordering};

use rayon::prelude::*;
use truepath_core::cut::{ForceTable, Path, Sample};
use truepath_core::identify::{Parameters, neighbours};
use truepath_core::job::{self, Identified};
use truepath_core::process::ImmersionGrid;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::{float, mm};
use truepath_job::job::{PlanCutter, PlanTable};
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use super::bench::{Bench, Stage};
use super::field::Field;
use super::mounted::{FINE, MIDDLE, Mounted, Resolution};
use super::process::{Cut, words};
use super::refit::{Refitted, refit};
use super::search::{Candidate, search};
use super::times::Times;
use crate::correction::{Identification, MeasuredCut, identify_together};
use crate::feeds::written_feeds_count;
use crate::force_tables::force_table;
use crate::planned::{self, PlannedPass};
use crate::surface::draws::Uncertain;
use crate::surface::expected::Surface;
use crate::surface::unmodelled::{unbent, unmodelled};
use crate::surface::wall::{WallFigures, WallMap};

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

impl Choice {
    /// Its cuts in words, lengths in a unit.
    pub fn process_in(&self, unit: Unit) -> String {
        let told = words(&self.cuts, Unit::Millimetre);
        self.process
            .strip_suffix(&told)
            .map_or_else(|| self.process.clone(), |with| with.to_owned() + &words(&self.cuts, unit))
    }
}

/// A process to choose.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Choice {
    /// Its cuts, in words.
    pub process: String,
    /// Number of the tool where it is not that of the job.
    pub cutter: Option<u32>,
    /// Its cuts.
    #[serde(skip)]
    pub cuts: Vec<Cut>,
    /// Passes along the contour.
    pub passes: usize,
    /// Minutes at feed: contour, leads, ways down and up.
    pub minutes: f64,
    /// Over those of the program.
    pub time_ratio: f64,
    /// What is expected of its wall.
    #[serde(flatten)]
    pub surface: Surface,
    /// The wall as the identified machine cuts it.
    pub wall: WallFigures,
    /// The wall unrolled, as that machine cuts it.
    #[serde(skip)]
    pub map: WallMap,
    /// The share of machines that the points allow whose wall is within the tolerance.
    pub within_tolerance: f64,
    /// What makes most of the error at its worst place.
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
    /// Minutes of the program at feed: contour, leads, ways down and up, spring passes.
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

const COARSE: Resolution = Resolution { step_um: 1000, slices: 12, of_radius: 5 };

/// A process designed finely, ready to be written.
#[derive(Clone, Debug)]
pub struct Designed<'a> {
    /// The pass of the program that it takes the place of.
    pub pass: &'a Pass,
    /// Its path.
    pub path: Path<'a>,
    /// Its passes.
    pub passes: Vec<PlannedPass>,
    /// The cutter where it is not that of the program.
    pub cutter: Option<&'a PlanCutter>,
    /// Machine and material that it was designed for.
    pub identified: &'a Identified,
    /// The figures of the wall of the identified machine.
    pub wall: WallFigures,
    /// That wall unrolled.
    pub map: WallMap,
}

/// What a process is planned for: the finishing pass, the machine that was identified on it, and the cutters that are at hand.
#[derive(Clone, Debug)]
pub struct Planner<'a> {
    pass: &'a Pass,
    own: Mounted<'a>,
    others: Vec<Mounted<'a>>,
    /// Why cutters of the job are left out.
    left_out: Vec<String>,
    /// How far machine and material are from settling at a probed place, where they do not.
    unsettled: Option<Offset>,
    /// Whether planned parts have told of the machine: then what the model lacks is part of what is known.
    is_learned: bool,
    /// What they have shown beside it, and which of their contours this is.
    field: Option<(Field, usize)>,
}

impl<'a> Planner<'a> {
    /// Of a pass and the points of its wall.
    ///
    /// # Errors
    /// Points that do not fit the job, and a contour that cannot be sampled.
    pub fn new(pass: &'a Pass, measurement: &Measurement, progress: impl FnMut(f64)) -> Result<Self, Failure> {
        let planner = Self::every(&[(pass, measurement)], progress)?.pop();
        planner.ok_or_else(|| Failure::Internal("a pass without its planner".to_owned()))
    }

    /// Of the walls of one part, which one cutter makes: one machine is identified from the points of all.
    ///
    /// # Errors
    /// As [`Planner::new`].
    pub fn every(walls: &[(&'a Pass, &Measurement)], progress: impl FnMut(f64)) -> Result<Vec<Self>, Failure> {
        let mut buffers: Vec<PathBuffer> = walls.iter().map(|_| PathBuffer::default()).collect();
        let sampled: Vec<Path> =
            walls.iter().zip(&mut buffers).map(|((pass, _), buffer)| pass.sample(buffer)).collect::<Result<_, _>>()?;
        let cuts = walls.iter().zip(&sampled);
        let cuts: Vec<MeasuredCut> =
            cuts.map(|(&(pass, measurement), path)| MeasuredCut { pass, path, measurement }).collect();
        let known = identify_together(&cuts, progress)?;
        let own: Vec<Mounted> =
            walls.iter().zip(&known).map(|(&(pass, _), known)| Mounted::own(pass, known.clone())).collect();
        let mut samples: Vec<Vec<Sample>> = walls.iter().map(|_| Vec::new()).collect();
        let coarse = own.iter().zip(&mut samples).map(|(own, samples)| own.path(MIDDLE, samples));
        let Refitted { known, unsettled } = refit(&cuts, &coarse.collect::<Result<Vec<_>, _>>()?, known)?;
        let mounted = walls.iter().zip(known).map(|(&(pass, _), known)| {
            let own = Mounted::own(pass, known);
            let (mut others, mut left_out) = (Vec::new(), Vec::new());
            for cutter in &pass.job.plan_cutters {
                match Mounted::other(pass, own.known(), *cutter) {
                    Ok(mounted) => others.push(mounted),
                    Err(why) => left_out.push(why),
                }
            }
            Self { pass, own, others, left_out, unsettled, is_learned: false, field: None }
        });
        Ok(mounted.collect())
    }

    /// Of a pass and what planned parts have told of the cutter of its job, with which of their contours it is; they tell nothing of other
    /// cutters.
    pub const fn learned(pass: &'a Pass, known: Identification, field: Option<(Field, usize)>) -> Self {
        let own = Mounted::own(pass, known);
        Self { pass, own, others: Vec::new(), left_out: Vec::new(), unsettled: None, is_learned: true, field }
    }

    /// Diameter of the cutter of the program.
    pub const fn diameter(&self) -> Offset {
        self.pass.job.numbers.tool.diameter
    }

    /// The unit of the program.
    pub fn unit(&self) -> Unit {
        self.pass.unit()
    }

    /// Another cutter that is at hand, by its number.
    pub fn cutter(&self, number: u32) -> Option<&PlanCutter> {
        self.others.iter().filter_map(Mounted::cutter).find(|cutter| cutter.number == number)
    }

    /// Machine and material.
    pub const fn known(&self) -> &Identification {
        self.own.known()
    }

    /// Searches with every cutter, and looks closely at the best; `progress` is told the share done, 0…1.
    ///
    /// # Errors
    /// A contour that cannot be sampled.
    pub fn plan(&self, wanted: &Wanted, progress: &(dyn Fn(f64) + Sync)) -> Result<Plan, Failure> {
        let (table, grid) = (self.own.table(), ImmersionGrid::new());
        let mut samples = Vec::new();
        let path = self.own.path(MIDDLE, &mut samples)?;
        let bench = self.bench(&self.own, (&path, &table), &grid, MIDDLE);
        let times = self.times(&bench, &bench);
        let cutters: Vec<&Mounted> = std::iter::once(&self.own).chain(&self.others).collect();
        let mut choices = Vec::new();
        for (k, mounted) in cutters.iter().enumerate() {
            let of_all = |share: f64| progress((k as f64 + share) / cutters.len() as f64);
            choices.extend(self.choices(mounted, &grid, (wanted, &bench), &of_all)?);
        }
        let error = |choice: &Choice| choice.surface.profile.profile_mm;
        choices.sort_by(|a, b| a.minutes.total_cmp(&b.minutes).then(error(a).total_cmp(&error(b))));
        keep_worthwhile(&mut choices, wanted);
        Ok(Plan::of((&bench, times.programmed()), choices, wanted))
    }

    /// The plan of one process of the program's own cutter: the same cuts, designed anew.
    ///
    /// # Errors
    /// A contour that cannot be sampled.
    pub fn again(&self, cuts: &[Cut], wanted: &Wanted) -> Result<Plan, Failure> {
        let (table, grid) = (self.own.table(), ImmersionGrid::new());
        let (mut samples, mut finer) = (Vec::new(), Vec::new());
        let path = self.own.path(COARSE, &mut samples)?;
        let coarse = self.bench(&self.own, (&path, &table), &grid, COARSE);
        let path = self.own.path(MIDDLE, &mut finer)?;
        let bench = self.bench(&self.own, (&path, &table), &grid, MIDDLE);
        let times = self.times(&bench, &bench);
        let choices = self.look(&self.own, (&bench, &coarse), &[cuts], (wanted, &times), &|_| ());
        Ok(Plan::of((&bench, times.programmed()), choices, wanted))
    }

    /// A cutter at work, with what parts have shown beside the machine.
    fn bench<'p>(
        &self,
        mounted: &Mounted,
        (path, table): (&'p Path<'p>, &'p ForceTable),
        grid: &'p ImmersionGrid,
        resolution: Resolution,
    ) -> Bench<'p> {
        let bench = mounted.bench(path, table, grid, resolution);
        let residual = self.field.as_ref();
        let residual = residual.map(|(field, contour)| field.along((bench.machine(), *contour), bench.slices()));
        bench.with_residual(residual.unwrap_or_default())
    }

    /// What is open of what parts have shown beside the machine.
    fn open(&self, bench: &Bench) -> Vec<Vec<f64>> {
        let open = |(field, contour): &(Field, usize)| field.open((bench.machine(), *contour), bench.slices());
        self.field.as_ref().map(open).unwrap_or_default()
    }

    /// The times of what is cut on the bench of a cutter; `own` is that of the program's cutter, at the same resolution.
    fn times(&self, own: &Bench, bench: &Bench) -> Times<'_> {
        Times::new(self.pass, own.path().setup().axial_depth, [own.minutes(), bench.minutes()])
    }

    /// What one cutter can do; `own` is the bench of the program's cutter.
    fn choices(
        &self,
        mounted: &Mounted,
        grid: &ImmersionGrid,
        (wanted, own): (&Wanted, &Bench),
        progress: &(dyn Fn(f64) + Sync),
    ) -> Result<Vec<Choice>, Failure> {
        let table = mounted.table();
        let (mut samples, mut finer) = (Vec::new(), Vec::new());
        let path = mounted.path(COARSE, &mut samples)?;
        let coarse = self.bench(mounted, (&path, &table), grid, COARSE);
        let middle = mounted.path(MIDDLE, &mut finer)?;
        let bench = self.bench(mounted, (&middle, &table), grid, MIDDLE);
        let times = self.times(own, &bench);
        let found = search(&coarse, (&wanted.limits, &times), &|share| progress(0.5 * share));
        let found = shortlist(found, wanted.tolerance_mm);
        let processes: Vec<&[Cut]> = found.iter().map(|candidate| &candidate.cuts[..]).collect();
        let told = |share: f64| progress(0.5 + 0.5 * share);
        Ok(self.look(mounted, (&bench, &coarse), &processes, (wanted, &times), &told))
    }

    /// Designs a process of the program's own cutter, or of the one with a number, finely, on a path for which `samples` is room.
    /// `progress` is told the share done.
    ///
    /// # Errors
    /// A contour that cannot be sampled, and a correction beyond the clamp.
    pub fn design<'p>(
        &'p self,
        (cuts, cutter): (&[Cut], Option<u32>),
        samples: &'p mut Vec<Sample>,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Designed<'p>, Failure> {
        const TURNS: u32 = 16;
        let of_number = |mounted: &&Mounted| mounted.cutter().is_some_and(|other| Some(other.number) == cutter);
        let mounted = self.others.iter().find(of_number).unwrap_or(&self.own);
        let (table, grid) = (mounted.table(), ImmersionGrid::new());
        let path = mounted.path(FINE, samples)?;
        let bench = self.bench(mounted, (&path, &table), &grid, FINE);
        let mut stage = bench.raw();
        for (k, cut) in cuts.iter().enumerate() {
            stage = bench.cut(stage, cut, TURNS);
            progress((k + 1) as f64 / cuts.len() as f64);
        }
        let depth = path.setup().axial_depth;
        let (wall, map) = (bench.figures(&stage.left), bench.map(&stage.left));
        let passes: Vec<PlannedPass> = stage
            .passes
            .into_iter()
            .map(|pass| PlannedPass {
                nodes: pass.nodes,
                raise: Offset::from_mm(depth * pass.order.raised),
                reversed: pass.order.order.reversed,
                feed: float(pass.order.order.feed),
            })
            .collect();
        for pass in &passes {
            job::check_clamp(&self.pass.job.numbers, &path, &pass.nodes).map_err(|error| self.pass.refused(&error))?;
        }
        let cutter = mounted.cutter();
        Ok(Designed { pass: self.pass, path, passes, cutter, identified: &self.own.known().core, wall, map })
    }

    /// The limits of the job that the program stands, and what is left out: passes can only be added where its leads let them, and run the other way where
    /// these can be turned round, and feeds changed where the F words of the program are those of the cut. What cannot is said.
    pub fn possible(&self, mut limits: PlanTable) -> (PlanTable, Vec<Remark>) {
        let mut said: Vec<Remark> = self.left_out.iter().map(|why| why.as_str().into()).collect();
        said.extend(self.unsettled.map(|by| {
            self.pass.unit().remark(|unit| {
                format!(
                    "machine and material do not settle: at a probed place what the model of several passes says still changes by {:.3} {}, so that the plan is less sure than it says; touch the part at more heights, or plan for a part that is roughed closer to the wall",
                    unit.of(mm(by)),
                    unit.name()
                )
            })
        }));
        if let Err(failure) = planned::can_repeat_pass(self.pass) {
            (limits.max_cuts, limits.max_levels) = (1, 1);
            let why = format!("no pass can be added to this program, so that one is all that is planned: {failure}");
            said.push(why.into());
        } else if limits.reverse
            && let Err(failure) = planned::can_reverse(self.pass)
        {
            limits.reverse = false;
            said.push(format!("no pass of this program can run the other way: {failure}").into());
        }
        if let Err(failure) = written_feeds_count(self.pass, "a plan changes F words", "plan with the feed as it is") {
            limits.percent = [100, 100];
            let why =
                format!("every pass is planned at the feed of the cut, because no other can be written: {failure}");
            said.push(why.into());
        }
        (limits, said)
    }

    /// Cuts processes anew, and by every machine that the points allow; `progress` is told the share done.
    fn look(
        &self,
        mounted: &Mounted,
        (bench, coarse): (&Bench, &Bench),
        processes: &[&[Cut]],
        (wanted, times): (&Wanted, &Times<'_>),
        progress: &(dyn Fn(f64) + Sync),
    ) -> Vec<Choice> {
        let others = self.others_than(mounted, coarse);
        let tables: Vec<_> = others.iter().map(|other| force_table(&other.parameters)).collect();
        let machines: Vec<Bench> = others
            .iter()
            .zip(&tables)
            .map(|(other, table)| coarse.of(other.parameters.machine(coarse.path(), table)))
            .collect();
        let begun = begun((bench, coarse), &machines, processes, progress);
        let open = self.open(bench);
        let choice = |cuts: &&[Cut]| {
            let begun = begun.iter().find(|begun| begun.cuts == *cuts)?;
            Some(self.choice(mounted, (bench, coarse), (begun, &others, &open), (wanted, times)))
        };
        processes.par_iter().filter_map(choice).collect()
    }

    /// The machines beside the identified one whose walls are other ones.
    fn others_than(&self, mounted: &Mounted, coarse: &Bench) -> Vec<Other> {
        let known = mounted.known();
        let found = mounted.with(&known.fit().parameters);
        let noise = neighbours(known.prior(), known.fit()).map(|(other, share)| (mounted.with(&other), share));
        let noise = noise.map(|(parameters, share)| Other { parameters, why: Why::Noise(float(share)) });
        let lacking = unmodelled(&found).chain(mounted.unknown(&found)).filter(|_| !self.is_learned);
        let lacking = lacking.map(|parameters| Other { parameters, why: Why::Lacking });
        let stiff = Other { parameters: unbent(&found), why: Why::Unbent };
        let (machine, path) = (coarse.machine(), coarse.path());
        let differs = |other: &Other| !other.parameters.machine(path, machine.table).cuts_as(machine);
        noise.chain(lacking).chain([stiff]).filter(differs).collect()
    }

    /// A process that was cut by all machines.
    fn choice(
        &self,
        mounted: &Mounted,
        (bench, coarse): (&Bench, &Bench),
        (begun, others, open): (&Begun, &[Other], &[Vec<f64>]),
        (wanted, times): (&Wanted, &Times<'_>),
    ) -> Choice {
        let (stage, cuts) = (&begun.stage, begun.cuts);
        let minutes = times.of(cuts).unwrap_or_else(|| times.at_least(cuts));
        let (mut noise, mut lacking, mut stiff) = (Vec::new(), Vec::new(), None);
        for (other, left) in others.iter().zip(&begun.others) {
            let wall = bench.changed_like(&stage.left, coarse, (&begun.like, left));
            match other.why {
                Why::Noise(share) => noise.push((wall, share)),
                Why::Lacking => lacking.push(wall),
                Why::Unbent => stiff = Some(wall),
            }
        }
        lacking.extend(open.iter().map(|column| bench.beside(&stage.left, column)));
        let wall = bench.figures(&stage.left);
        let uncertain = Uncertain::of((bench.path(), bench.slices()), &stage.left, &noise, &lacking, stiff.as_deref());
        let height_mm = wall.worst_fraction * float(bench.path().setup().axial_depth);
        let (surface, draws) = Surface::of(&uncertain, wall.worst, (wall.worst_s_mm, height_mm));
        let cutter = mounted.cutter();
        let with = cutter.map_or_else(String::new, |cutter| {
            format!("T{}, helix {} degrees: ", cutter.number, float(cutter.helix_deg))
        });
        Choice {
            process: with + &words(cuts, Unit::Millimetre),
            cutter: cutter.map(|cutter| cutter.number),
            cuts: cuts.to_vec(),
            passes: stage.passes.len(),
            minutes,
            time_ratio: minutes / times.programmed(),
            surface,
            within_tolerance: draws.within(wanted.tolerance_mm),
            limited_by: surface.causes.largest(),
            map: bench.map(&stage.left),
            wall,
            force_n: stage.passes.iter().map(|p| float(p.load.force)).fold(0.0, f64::max),
            chip_mm: stage.passes.last().map_or(0.0, |p| float(p.load.chip)),
        }
    }
}

/// A machine beside the identified one.
#[derive(Clone, Copy, Debug)]
struct Other {
    parameters: Parameters,
    why: Why,
}

/// What a machine beside the identified one stands for.
#[derive(Clone, Copy, Debug)]
enum Why {
    /// What the points leave open, with the share of its change.
    Noise(f64),
    /// What the model lacks.
    Lacking,
    /// A cutter that does not bend.
    Unbent,
}

/// The first cuts of a process, as all machines have made them.
struct Begun<'c> {
    cuts: &'c [Cut],
    stage: Stage,
    /// What the identified machine leaves on the coarse bench.
    like: Vec<Offset>,
    /// What each of the others leaves there.
    others: Vec<Vec<Offset>>,
}

/// Cuts processes finely, and on a coarse bench by the other machines. What several of them begin with is cut once.
fn begun<'c>(
    (bench, coarse): (&Bench, &Bench),
    machines: &[Bench],
    processes: &[&'c [Cut]],
    progress: &(dyn Fn(f64) + Sync),
) -> Vec<Begun<'c>> {
    const TURNS: u32 = 12;
    let mut beginnings: Vec<&[Cut]> = Vec::new();
    for cuts in processes.iter().flat_map(|cuts| (1..=cuts.len()).map(|k| &cuts[..k])) {
        if !beginnings.contains(&cuts) {
            beginnings.push(cuts);
        }
    }
    let raw = coarse.raw().left;
    let others = vec![raw.clone(); machines.len()];
    let mut begun = vec![Begun { cuts: &[], stage: bench.raw(), like: raw, others }];
    let done = AtomicUsize::new(0);
    for count in 1.. {
        let next: Vec<&[Cut]> = beginnings.iter().copied().filter(|cuts| cuts.len() == count).collect();
        if next.is_empty() {
            break;
        }
        let go_on = |cuts: &&'c [Cut]| {
            let (last, before) = cuts.split_last()?;
            let before = begun.iter().find(|begun| begun.cuts == before)?;
            let stage = bench.cut(before.stage.clone(), last, TURNS);
            let own = &stage.passes[before.stage.passes.len()..];
            let passes = coarse.taken_over(own, bench);
            let like = coarse.follow_on(before.like.clone(), &passes);
            let others = machines.par_iter().zip(&before.others);
            let others = others.map(|(machine, left)| machine.follow_on(left.clone(), &passes)).collect();
            let done = done.fetch_add(1, Ordering::Relaxed) + 1;
            progress(done as f64 / beginnings.len() as f64);
            Some(Begun { cuts, stage, like, others })
        };
        let next: Vec<Begun> = next.par_iter().filter_map(go_on).collect();
        begun.extend(next);
    }
    begun
}

impl Plan {
    /// Of choices, the fastest first.
    fn of((bench, minutes): (&Bench, f64), choices: Vec<Choice>, wanted: &Wanted) -> Self {
        let holds = |choice: &Choice| choice.within_tolerance >= wanted.confidence;
        let programmed = bench.as_programmed().left;
        Self {
            as_programmed: bench.figures(&programmed),
            map: bench.map(&programmed),
            minutes,
            recommended: choices.iter().position(holds).map(|at| at + 1),
            choices,
            tolerance_mm: wanted.tolerance_mm,
            confidence: wanted.confidence,
        }
    }
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
        let better = choice.surface.profile.profile_mm < best;
        best = best.min(choice.surface.profile.profile_mm);
        better
    });
    while choices.len() > MOST {
        let holds = choices.iter().position(|c| c.within_tolerance >= wanted.confidence);
        let gain = |k: usize| choices[k - 1].surface.profile.profile_mm / choices[k].surface.profile.profile_mm;
        let inner = (1..choices.len() - 1).filter(|k| Some(*k) != holds);
        let Some(least) = inner.min_by(|a, b| gain(*a).total_cmp(&gain(*b))) else { break };
        choices.remove(least);
    }
}
