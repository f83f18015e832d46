//! From the points of a part that a planned program has cut to the program of the next: the same passes, designed anew by what all
//! parts together say.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::geometry::Vector;
use truepath_core::identify::{Cut as CutPoints, Observation};
use truepath_core::process::{Aim, ImmersionGrid, Load};
use truepath_core::units::{Offset, Real};
use truepath_ground::codes::J008;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::units::{float, mm};
use truepath_job::job::PlanTable;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use super::bench::CutPass;
use super::choice::{Plan, Planner, Wanted};
use super::history::{NextPart, PlanHistory, PlannedPart, Process};
use super::joint::{CutPart, Joint, Wall, predicted};
use super::mounted::{FINE, MIDDLE, path};
use super::process::Cut;
use super::written::{Chosen, WrittenPlan, write};
use crate::codes::Q007;
use crate::correction::Identification;
use crate::identification::{Found, Points, asked, found};
use crate::learn::refuse_feeds;
use crate::learning::Part;

/// The program of the next part.
#[derive(Clone, Debug)]
pub struct LearnedPlan {
    /// Its process, with what it promises; more where the passes were searched for.
    pub plan: Plan,
    /// The number of the choice that is written, from 1.
    pub chosen: usize,
    /// The program.
    pub written: WrittenPlan,
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

/// Learns from the part that was cut with the planned program of a history. `names` are the files that the program of the next
/// is written to; `progress` is told the share done, 0…1.
///
/// # Errors
/// A history of another cut or another contour (`Q002`), points it already holds (`Q003`), points of an uncorrected part
/// (`Q007`), scheduled feeds (`Q006`), and those of [`write()`].
pub fn learn(
    pass: &Pass,
    history: &PlanHistory,
    (measurement, passes): (&Measurement, Passes),
    names: &[&str],
    progress: &mut dyn FnMut(f64),
) -> Result<LearnedPlan, Failure> {
    history.facts.agree(pass)?;
    refuse_feeds(pass)?;
    let number = history.next_number();
    let new = Part::new(number, measurement, None)?;
    history.refuse_known(&new)?;
    let mut newest = PlannedPart { measured: new, process: Some(history.next.process.clone()) };

    let known = uncorrected(pass, history)?;
    let (mut coarse, mut fine) = (Vec::new(), Vec::new());
    let law = known.core.law;
    let (coarse, fine) = (path(pass, law, MIDDLE, &mut coarse)?, path(pass, law, FINE, &mut fine)?);
    let grid = ImmersionGrid::new();
    let wall = Wall { path: &coarse, slices: MIDDLE.slices(&coarse), grid: &grid };
    let told = history.parts.iter().filter(|part| !part.measured.set_aside).chain([&newest]);
    let mut parts = Vec::new();
    for part in told {
        parts.push(cut_part(wall, &fine, part)?);
    }
    let nothing = || Failure::Internal("no point lies on the wall".to_owned());
    let (prior, earlier) = (&known.core.prior, parts.len() - 1);
    let start = known.core.fit.theta;
    let before = Joint::of(wall, (prior, start), &parts[..earlier], &mut |share| progress(0.25 * share));
    let before = before.ok_or_else(nothing)?;
    refuse_uncorrected(wall, &before, &parts[earlier], mm(measurement.noise), number)?;
    let start = before.core.fit.theta;
    let after = Joint::of(wall, (prior, start), &parts, &mut |share| progress(0.25 + 0.35 * share));
    let after = after.ok_or_else(nothing)?;

    let own = after.points.last().map_or(&[][..], Vec::as_slice);
    let outlying = own.iter().filter(|point| float(point.weight) < FITTING).count();
    let touched = CutPart { points: own.to_vec(), ..parts[earlier].clone() };
    let missed_before_mm = before.missed(wall, &touched, false);
    let missed_after_mm = after.missed(wall, &touched, true);
    // What is learned has to explain what was not known, or it is not what happened.
    let set_aside = 2 * outlying > own.len() || missed_after_mm > missed_before_mm + mm(measurement.noise);
    newest.measured.set_aside = set_aside;
    let measured: Vec<f64> = own.iter().map(|point| mm(point.error)).collect();
    let Joint { core, field, mut points } = if set_aside { before } else { after.clone() };
    let verdict = PlannedVerdict {
        part: number,
        points: own.len(),
        measured_max_mm: measured.iter().fold(0.0, |most, error| error.abs().max(most)),
        measured_rms_mm: rms(measured.iter().copied()),
        promised_mm: history.next.profile_mm,
        promised_sigma_mm: history.next.sigma_mm,
        missed_before_mm,
        missed_after_mm,
        outlying,
        beside_mm: field.as_ref().map(super::field::Field::amplitudes_mm),
        set_aside,
    };
    let known = Identification { core, observations: points.pop().unwrap_or_default() };
    let planner = Planner::learned(pass, known, field);
    let NextPart { tolerance_mm, confidence, .. } = history.next;
    let wanted = |limits| Wanted { tolerance_mm, confidence, limits };
    let (plan, chosen) = match passes {
        Passes::Same => (planner.again(&history.next.process.cuts(), &wanted(pass.job.plan))?, 0),
        Passes::Searched(limits) => {
            let plan = planner.plan(&wanted(planner.possible(limits).0), &|_| ())?;
            let chosen = plan.recommended.map_or(plan.choices.len().saturating_sub(1), |number| number - 1);
            (plan, chosen)
        }
    };
    progress(0.8);
    let choice = plan.choices.get(chosen).ok_or_else(|| {
        let help = "loosen [plan] of the job, or learn without --replan";
        InputError::new(J008, "no process keeps the limits of [plan]", "at least one", help)
    })?;
    let cuts = choice.cuts.clone();
    let next = [Chosen { planner: &planner, cuts: &cuts, cutter: choice.cutter }];
    let written = write(&next, history.next.route(), measurement.crc, &mut |share| progress(0.8 + 0.2 * share))?;
    let process = Process::of(&cuts, written.walls.first().map_or(&[], |wall| &wall.passes));
    let next = NextPart::of(process, (tolerance_mm, confidence), choice.surface.profile, (&written.program, names));
    Ok(LearnedPlan { history: history.with(newest, next), chosen: chosen + 1, plan, written, verdict })
}

/// Machine and material as the model of one pass finds them from the part without a correction: where the fit of all parts begins.
fn uncorrected(pass: &Pass, history: &PlanHistory) -> Result<Found, Failure> {
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    let points: Vec<Observation> = history.parts.first().map(|part| observations(&part.measured)).unwrap_or_default();
    let cuts = [CutPoints { path, points: points.len(), part: 0 }];
    let points = Points { cuts: &cuts, earlier: &[], observations: &points };
    Ok(found(&pass.core, asked(pass.core.job.force.model), points, |_, _| Vector::ZERO, &mut |_| ()))
}

fn observations(part: &Part) -> Vec<Observation> {
    let noise = Offset::from_nm((part.noise_mm * 1e6).round() as i64);
    part.points.iter().map(|point| point.observation(noise)).collect()
}

/// A part with its passes beside the samples of a wall; `fine` is the path that they were designed along.
fn cut_part(wall: Wall<'_>, fine: &Path, part: &PlannedPart) -> Result<CutPart, InputError> {
    let passes = match &part.process {
        None => as_programmed(wall),
        Some(process) => process.passes(wall.slices, |nodes| placed(fine, wall.path, nodes))?,
    };
    Ok(CutPart { passes, points: observations(&part.measured), is_planned: part.process.is_some() })
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
    wall: Wall<'_>,
    before: &Joint,
    part: &CutPart,
    noise_mm: f64,
    number: u32,
) -> Result<(), InputError> {
    let plain = CutPart { passes: as_programmed(wall), ..part.clone() };
    let walls = predicted(wall, &before.core.fit.parameters, &[part.clone(), plain]);
    let missed = |of: usize| -> Vec<f64> {
        let both = part.points.iter().zip(&walls[of]);
        both.filter_map(|(point, wall)| Some(mm(point.error) - (*wall)?)).collect()
    };
    let (with, without) = (missed(0), missed(1));
    let [far, near] = [&with, &without].map(|missed| middle(missed));
    if far > CLEARLY * near && far > BEYOND_NOISE * noise_mm {
        let found = format!(
            "the points lie {near:.4} mm (median) from the wall that no correction leaves, and {far:.4} mm from that of the planned program in --from"
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
    sizes.sort_by(f64::total_cmp);
    sizes.get(sizes.len() / 2).copied().unwrap_or_default()
}

#[cfg(test)]
mod tests {
    use truepath_core::cut::WallLaw;
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
        let part = CutPart { passes, points, is_planned: true };
        let again = &predicted(wall, &prior.mean, &[part])[0];
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
