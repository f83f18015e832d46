//! From the points of a part that a planned program has cut to the program of the next: the same passes, designed anew by what all
//! parts together say.

use truepath_core::correct::Node;
use truepath_core::cut::{Path, Sample, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::{Cut as CutPoints, Observation};
use truepath_core::process::{Aim, ImmersionGrid, Load};
use truepath_core::units::{Offset, Real};
use truepath_ground::codes::J008;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::Unit;
use truepath_ground::rows::median;
use truepath_ground::units::{float, mm};
use truepath_job::job::PlanTable;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use super::bench::CutPass;
use super::choice::{Choice, Plan, Planner, Wanted};
use super::history::{NextPart, PlanHistory, PlannedPart, Process};
use super::joint::{CutPart, Joint, Wall, predicted};
use super::mounted::{FINE, MIDDLE, Resolution, path};
use super::process::Cut;
use super::written::{Chosen, WrittenPlan, write};
use crate::codes::{Q002, Q007};
use crate::correction::Identification;
use crate::identification::{Found, Points, asked, found};
use crate::learn::refuse_feeds;
use crate::learning::Part;
use crate::told;

/// A contour of a part that a planned program has cut.
#[derive(Clone, Copy, Debug)]
pub struct PlannedCut<'a> {
    /// The pass of the program.
    pub pass: &'a Pass,
    /// What was learned before.
    pub history: &'a PlanHistory,
    /// Its points.
    pub measurement: &'a Measurement,
}

/// The program of the next part.
#[derive(Clone, Debug)]
pub struct LearnedPart {
    /// Of each contour.
    pub contours: Vec<LearnedPlan>,
    /// The program of all.
    pub written: WrittenPlan,
}

/// What was learned of a contour.
#[derive(Clone, Debug)]
pub struct LearnedPlan {
    /// Its process, with what it promises; more where the passes were searched for.
    pub plan: Plan,
    /// The number of the choice that is written, from 1.
    pub chosen: usize,
    /// The history with one part more.
    pub history: PlanHistory,
    /// How the touched part came out.
    pub verdict: PlannedVerdict,
}

/// How a part that a planned program has cut came out, and what was made of it.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct PlannedVerdict {
    /// Its number, from 1.
    pub part: u32,
    /// Points that were touched.
    pub points: usize,
    /// The largest measured error, the sign aside, mm.
    pub measured_max_mm: f64,
    /// Root mean square of the measured errors, mm.
    pub measured_rms_mm: f64,
    /// The profile error that had been predicted for the whole wall, mm.
    pub promised_mm: f64,
    /// Its standard deviation, mm.
    pub promised_sigma_mm: f64,
    /// What the model of the parts before misses at the points, root mean square, mm.
    pub missed_before_mm: f64,
    /// What that of all parts misses, with what is learned beside it, mm.
    pub missed_after_mm: f64,
    /// Points that do not fit and have little weight.
    pub outlying: usize,
    /// Standard deviations of what is learned beside the model, of the same stretch and of places that are engaged alike, mm;
    /// absent when the points fit within their noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub beside_mm: Option<[f64; 2]>,
    /// Whether nothing explains most of its points: the next part is then cut by what was known before.
    pub set_aside: bool,
}

/// Weight of a point that fits.
const FITTING: f64 = 0.3;
/// A part is taken for an uncorrected one when that explains its points this many times better …
const CLEARLY: f64 = 3.0;
/// … and the planned one misses them by this many standard deviations of a reading.
const BEYOND_NOISE: f64 = 5.0;

/// What becomes of the passes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Passes {
    /// They stay, and are designed anew.
    Same,
    /// They are searched for anew, within the limits of the job: the recommended choice, or the most accurate where none holds
    /// the tolerance.
    Searched(PlanTable),
}

/// Learns from the part whose contours were cut with the planned program of their histories: one machine is fitted to the points of all.
/// `names` are the files that the program of the next is written to; `progress` is told the share done.
///
/// # Errors
/// A history of another cut, another contour or of other parts than that of the contour beside it (`Q002`), points it already holds
/// (`Q003`), points of an uncorrected part (`Q007`), scheduled feeds (`Q006`), and those of [`write()`].
pub fn learn(
    cuts: &[PlannedCut<'_>],
    passes: Passes,
    names: &[&str],
    progress: &mut dyn FnMut(f64),
) -> Result<LearnedPart, Failure> {
    let nothing = || Failure::Internal("no point lies on the wall".to_owned());
    let first = cuts.first().ok_or_else(nothing)?;
    let number = first.history.next_number();
    let mut newest = Vec::new();
    for cut in cuts {
        cut.history.facts.agree(cut.pass)?;
        refuse_feeds(cut.pass)?;
        refuse_other_parts(first.history, cut.history)?;
        let measured = Part::new(number, cut.measurement, None)?;
        cut.history.refuse_known(&measured)?;
        newest.push(PlannedPart { measured, process: Some(cut.history.next.process.clone()) });
    }

    let known = uncorrected(cuts)?;
    let law = known.core.law;
    let mut room: [Vec<Vec<Sample>>; 2] = std::array::from_fn(|_| vec![Vec::new(); cuts.len()]);
    let [coarse, fine] = &mut room;
    let (coarse, fine) = (paths(cuts, law, MIDDLE, coarse)?, paths(cuts, law, FINE, fine)?);
    let grid = ImmersionGrid::new();
    let wall = |path| Wall { path, slices: MIDDLE.slices(path), grid: &grid };
    let walls: Vec<Wall> = coarse.iter().map(wall).collect();
    let (mut before, mut touched) = (Vec::new(), Vec::new());
    for (at, ((cut, newest), fine)) in cuts.iter().zip(&newest).zip(&fine).enumerate() {
        for part in cut.history.parts.iter().filter(|part| !part.measured.set_aside) {
            before.push(cut_part((at, walls[at]), fine, part)?);
        }
        touched.push(cut_part((at, walls[at]), fine, newest)?);
    }
    let (prior, start, earlier) = (&known.core.prior, known.core.fit.theta, before.len());
    let all: Vec<CutPart> = before.iter().chain(&touched).cloned().collect();
    let before = Joint::of(&walls, (prior, start), &before, &mut |share| progress(0.25 * share));
    let before = before.ok_or_else(nothing)?;
    refuse_uncorrected(&walls, &before, &touched, mm(first.measurement.noise), (number, first.measurement.unit))?;
    let start = before.core.fit.theta;
    let after = Joint::of(&walls, (prior, start), &all, &mut |share| progress(0.25 + 0.35 * share));
    let after = after.ok_or_else(nothing)?;

    for (touched, weighed) in touched.iter_mut().zip(&after.points[earlier..]) {
        touched.points.clone_from(weighed);
    }
    let outlying = |part: &CutPart| part.points.iter().filter(|point| float(point.weight) < FITTING).count();
    let missed = |part: &[CutPart]| [before.missed(&walls, part, false), after.missed(&walls, part, true)];
    // What is learned has to explain what was not known, or it is not what happened.
    let (count, strange) = touched.iter().fold((0, 0), |(n, k), part| (n + part.points.len(), k + outlying(part)));
    let [missed_before_mm, missed_after_mm] = missed(&touched);
    let set_aside = 2 * strange > count || missed_after_mm > missed_before_mm + mm(first.measurement.noise);
    let verdict = |(cut, part): (&PlannedCut<'_>, &CutPart)| {
        let measured: Vec<f64> = part.points.iter().map(|point| mm(point.error)).collect();
        let [missed_before_mm, missed_after_mm] = missed(std::slice::from_ref(part));
        PlannedVerdict {
            part: number,
            points: part.points.len(),
            measured_max_mm: measured.iter().fold(0.0, |most, error| error.abs().max(most)),
            measured_rms_mm: rms(measured.iter().copied()),
            promised_mm: cut.history.next.profile_mm,
            promised_sigma_mm: cut.history.next.sigma_mm,
            missed_before_mm,
            missed_after_mm,
            outlying: outlying(part),
            beside_mm: if set_aside { &before } else { &after }.field.as_ref().map(super::field::Field::amplitudes_mm),
            set_aside,
        }
    };
    let verdicts: Vec<PlannedVerdict> = cuts.iter().zip(&touched).map(verdict).collect();
    let Joint { core, field, points } = if set_aside { before } else { after };
    let last = |at: usize| {
        let own = all.iter().zip(&points).rfind(|(part, _)| part.wall == at);
        own.map(|(_, points)| points.clone()).unwrap_or_default()
    };
    let planner = |at: usize| {
        let known = Identification { core, observations: last(at) };
        Planner::learned(cuts[at].pass, known, field.clone().map(|field| (field, at)))
    };
    let planners: Vec<Planner> = (0..cuts.len()).map(planner).collect();
    let mut plans = Vec::new();
    for (planner, cut) in planners.iter().zip(cuts) {
        plans.push(planned(planner, cut, passes)?);
        progress(0.6 + 0.2 * plans.len() as f64 / cuts.len() as f64);
    }
    let choices: Vec<&Choice> = plans.iter().map(|(plan, chosen)| &plan.choices[*chosen]).collect();
    let next: Vec<Chosen> = planners
        .iter()
        .zip(&choices)
        .map(|(planner, choice)| Chosen { planner, cuts: &choice.cuts, cutter: choice.cutter })
        .collect();
    let (route, crc) = (first.history.next.route(), first.measurement.crc);
    let written = write(&next, route, crc, &mut |share| progress(0.8 + 0.2 * share))?;
    let mut contours = Vec::new();
    for (((cut, choice), wall), (mut newest, verdict)) in
        cuts.iter().zip(&choices).zip(&written.walls).zip(newest.into_iter().zip(verdicts))
    {
        newest.measured.set_aside = set_aside;
        let process = Process::of(&choice.cuts, &wall.passes);
        let NextPart { tolerance_mm, confidence, .. } = cut.history.next;
        let asked = (tolerance_mm, confidence);
        let next = NextPart::of(process, asked, choice.surface.profile, (&written.program, names));
        contours.push((cut.history.with(newest, next), verdict));
    }
    let contours = contours.into_iter().zip(plans);
    let contours = contours
        .map(|((history, verdict), (plan, chosen))| LearnedPlan { plan, chosen: chosen + 1, history, verdict })
        .collect();
    Ok(LearnedPart { contours, written })
}

/// The processes of the next part, and which of them is written, from 0.
fn planned(planner: &Planner<'_>, cut: &PlannedCut<'_>, passes: Passes) -> Result<(Plan, usize), Failure> {
    let NextPart { tolerance_mm, confidence, .. } = cut.history.next;
    let wanted = |limits| Wanted { tolerance_mm, confidence, limits };
    let (plan, chosen) = match passes {
        Passes::Same => (planner.again(&cut.history.next.process.cuts(), &wanted(cut.pass.job.plan))?, 0),
        Passes::Searched(limits) => {
            let plan = planner.plan(&wanted(planner.possible(limits).0), &|_| ())?;
            let chosen = plan.recommended.map_or(plan.choices.len().saturating_sub(1), |number| number - 1);
            (plan, chosen)
        }
    };
    if plan.choices.is_empty() {
        let help = "loosen [plan] of the job, or learn without --replan";
        return Err(InputError::new(J008, "no process keeps the limits of [plan]", "at least one", help).into());
    }
    Ok((plan, chosen))
}

/// Contours of one part have been cut and touched together.
fn refuse_other_parts(first: &PlanHistory, other: &PlanHistory) -> Result<(), InputError> {
    let parts = |history: &PlanHistory| -> Vec<(u32, bool)> {
        history.parts.iter().map(|part| (part.measured.number, part.measured.set_aside)).collect()
    };
    if parts(first) == parts(other) && first.next.files == other.next.files {
        return Ok(());
    }
    let help = "name the folder as truepath plan or truepath learn has written it";
    let found = "the histories of two contours tell of different parts or programs";
    Err(InputError::new(Q002, found, "contours that were cut and touched together", help))
}

/// The paths of cuts at a resolution.
fn paths<'p>(
    cuts: &[PlannedCut<'_>],
    law: WallLaw,
    resolution: Resolution,
    samples: &'p mut [Vec<Sample>],
) -> Result<Vec<Path<'p>>, Failure> {
    cuts.iter().zip(samples).map(|(cut, samples)| path(cut.pass, law, resolution, samples)).collect()
}

/// Machine and material as the model of one pass finds them from the part without a correction: where the fit of all parts begins.
fn uncorrected(cuts: &[PlannedCut<'_>]) -> Result<Found, Failure> {
    let mut buffers: Vec<PathBuffer> = cuts.iter().map(|_| PathBuffer::default()).collect();
    let (mut placed, mut points) = (Vec::new(), Vec::new());
    for (cut, buffer) in cuts.iter().zip(&mut buffers) {
        let own = cut.history.parts.first().map(|part| observations(&part.measured)).unwrap_or_default();
        placed.push(CutPoints { path: cut.pass.sample(buffer)?, points: own.len(), part: 0 });
        points.extend(own);
    }
    let passes: Vec<&Pass> = cuts.iter().map(|cut| cut.pass).collect();
    let agreed = told::agreed(&passes, &|k| {
        Ok(cuts[k].history.parts.first().map(|part| observations(&part.measured)).unwrap_or_default())
    })?;
    let first = &agreed.first().ok_or_else(|| Failure::Internal("no contour to learn from".to_owned()))?.core;
    let points = Points { cuts: &placed, earlier: &[], observations: &points, begin: None };
    Ok(found(first, asked(first.job.force.model), points, |_, _| Vector::ZERO, &mut |_| ()))
}

fn observations(part: &Part) -> Vec<Observation> {
    let noise = Offset::from_nm((part.noise_mm * 1e6).round() as i64);
    part.points.iter().map(|point| point.observation(noise)).collect()
}

/// A part with its passes beside the samples of a wall; `fine` is the path that they were designed along.
fn cut_part((at, wall): (usize, Wall<'_>), fine: &Path, part: &PlannedPart) -> Result<CutPart, InputError> {
    let passes = match &part.process {
        None => as_programmed(wall),
        Some(process) => process.passes(wall.slices, |nodes| placed(fine, wall.path, nodes))?,
    };
    let (part, is_planned) = (&part.measured, part.process.is_some());
    Ok(CutPart { wall: at, part: part.number, passes, points: observations(part), is_planned })
}

/// The one pass of the program.
fn as_programmed(wall: Wall<'_>) -> Vec<CutPass> {
    let nodes = vec![Node::default(); wall.path.count()];
    let orders = Cut::whole(Aim::Middle).orders(wall.slices);
    orders.into_iter().map(|order| CutPass { order, nodes: nodes.clone(), load: Load::default() }).collect()
}

/// The corrections beside the samples of one path beside those of another along the same contour.
fn placed(from: &Path, to: &Path, nodes: &[Node]) -> Option<Vec<Node>> {
    if nodes.len() != from.count() {
        return None;
    }
    let samples = &from.samples()[from.first()..from.first() + from.count()];
    let at = |s: Offset| {
        let before = from.index_at(s).saturating_sub(from.first()).min(samples.len() - 1);
        let after = (before + 1).min(samples.len() - 1);
        let between = samples[after].s - samples[before].s;
        let share = if between > Offset::ZERO { (s - samples[before].s).over(between) } else { Real::ZERO };
        let share = share.max(Real::ZERO).min(Real::ONE);
        let mixed = |a: Vector, b: Vector| a + (b - a).scaled(share);
        let (a, b) = (nodes[before], nodes[after]);
        Node { chip: mixed(a.chip, b.chip), edge: mixed(a.edge, b.edge) }
    };
    Some(to.samples()[to.first()..to.first() + to.count()].iter().map(|sample| at(sample.s)).collect())
}

/// Refuses points that lie where the program leaves the wall without any correction; `before` is what the parts before say.
///
/// # Errors
/// `Q007` with both distances.
fn refuse_uncorrected(
    walls: &[Wall<'_>],
    before: &Joint,
    part: &[CutPart],
    noise_mm: f64,
    (number, unit): (u32, Unit),
) -> Result<(), InputError> {
    let plain = |cut: &CutPart| CutPart { passes: as_programmed(walls[cut.wall]), ..cut.clone() };
    let plain: Vec<CutPart> = part.iter().map(plain).collect();
    let missed = |part: &[CutPart]| -> Vec<f64> {
        let left = predicted(walls, &before.core.fit.parameters, part);
        let both = part.iter().zip(&left).flat_map(|(cut, left)| cut.points.iter().zip(left));
        both.filter_map(|(point, wall)| Some(mm(point.error) - (*wall)?)).collect()
    };
    let (with, without) = (missed(part), missed(&plain));
    let [far, near] = [&with, &without].map(|missed| middle(missed));
    if far > CLEARLY * near && far > BEYOND_NOISE * noise_mm {
        let ([near, far], name) = ([near, far].map(|median| unit.of(median)), unit.name());
        let found = format!(
            "the points lie {near:.4} {name} (median) from the wall that no correction leaves, and {far:.4} {name} from that of the planned program in --from"
        );
        return Err(Q007.error(found, format!("the points of part {number}, cut with that program")));
    }
    Ok(())
}

fn rms(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, count) = values.fold((0.0, 0.0), |(sum, count), value| (sum + value * value, count + 1.0));
    f64::sqrt(sum / f64::max(count, 1.0))
}

/// Median of the magnitudes.
fn middle(values: &[f64]) -> f64 {
    let mut sizes: Vec<f64> = values.iter().map(|value| value.abs()).collect();
    median(&mut sizes)
}

#[cfg(test)]
mod tests {
    use truepath_core::identify::Fit;
    use truepath_core::job::Identified;
    use truepath_job::job::{JobFile, Route};

    use super::super::process::leaving;
    use super::*;

    const CORNER: &str = "G21 G90 G17\nT5 M6\nS2500 M3\nG0 X-6 Y6 Z20\nG1 Z-12 F300\nG1 X0 Y0 F420\nG1 X30\n\
        G3 X40 Y10 I0 J10\nG1 Y36\nG1 X34 Y42\nG0 Z20\nM30\n";
    const JOB: &str = "version = 1\nprogram = \"part.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 0.7\n[tool]\n\
        diameter_mm = 12.0\nteeth = 4\nhelix_deg = 30.0\n[cut]\naxial_depth_mm = 12.0\n[force]\nmaterial = \"al-7075-heavy\"\n\
        [machine]\nstiffness_x_n_per_mm = 1600\nstiffness_y_n_per_mm = 1600\n";

    #[test]
    fn the_passes_of_a_history_leave_the_wall_that_they_were_designed_for() {
        let folder = tempfile::tempdir().unwrap();
        for (name, text) in [("part.nc", CORNER), ("job.toml", JOB)] {
            std::fs::write(folder.path().join(name), text).unwrap();
        }
        let pass = Pass::read(JobFile::read(&folder.path().join("job.toml")).unwrap()).unwrap();
        let law = WallLaw::Helical;
        let prior = pass.core.prior(law);
        let mut covariance = [[Real::ZERO; truepath_core::identify::COUNT]; truepath_core::identify::COUNT];
        covariance.iter_mut().enumerate().for_each(|(k, row)| row[k] = Real::ONE);
        let fit = Fit {
            parameters: prior.mean,
            theta: [Real::ZERO; truepath_core::identify::COUNT],
            covariance,
            cost: Real::ZERO,
            steps: 0,
            outliers: 0,
            evidence: Real::ZERO,
        };
        let known = Identification { core: Identified { law, prior, fit }, observations: Vec::new() };
        let planner = Planner::learned(&pass, known, None);
        let reversed = Cut { reversed: true, ..Cut::whole(Aim::Middle) };
        let spring = Cut { spring: true, ..reversed };
        let cuts = [Cut::whole(leaving(20)), Cut { aim: leaving(2), ..reversed }, reversed, spring];
        let chosen = [Chosen { planner: &planner, cuts: &cuts, cutter: None }];
        let written = write(&chosen, Route::Program, 0, &mut |_| ()).unwrap().walls.remove(0);
        let process = Process::of(&cuts, &written.passes);
        assert_eq!(process.cuts(), cuts);

        let (mut coarse, mut fine) = (Vec::new(), Vec::new());
        let (coarse, fine) =
            (path(&pass, law, MIDDLE, &mut coarse).unwrap(), path(&pass, law, FINE, &mut fine).unwrap());
        let grid = ImmersionGrid::new();
        let wall = Wall { path: &coarse, slices: MIDDLE.slices(&coarse), grid: &grid };
        let passes = process.passes(wall.slices, |nodes| placed(&fine, &coarse, nodes)).unwrap();
        let normal = coarse.samples()[coarse.index_at(Offset::from_um(15_000))].normal;
        let at = |height: i64| {
            Observation::new(
                Offset::from_um(15_000),
                Real::ratio(height, 100),
                Offset::ZERO,
                Offset::from_um(1),
                normal,
            )
        };
        let points: Vec<Observation> = (1..10).map(|k| at(10 * k)).collect();
        let part = CutPart { wall: 0, part: 2, passes, points, is_planned: true };
        let again = &predicted(&[wall], &prior.mean, &[part])[0];
        let of_map = written.map.s_mm.iter().position(|s| *s >= 15.0).unwrap();
        let designed = &written.map.error_mm[of_map];
        for (k, again) in (1..10).zip(again) {
            let designed = designed[designed.len() * k / 10];
            let again = again.unwrap();
            assert!(
                (again - designed).abs() < 0.003,
                "{again} was designed to be {designed} at {k} tenths of the height"
            );
        }
    }
}
