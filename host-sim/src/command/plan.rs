//! `plan`: which passes hold a tolerance at every height of the wall, in least time.

use std::path::{Path as FilePath, PathBuf};

use clap::{Args, ValueEnum};
use truepath_core::checksum::crc32;
use truepath_core::units::Offset;
use truepath_correction::correct::as_they_agree;
use truepath_correction::plan::choice::{Choice, Plan, Planner, Wanted};
use truepath_correction::plan::history::{NextPart, PlanHistory, Process};
use truepath_correction::plan::written::{Chosen, WrittenPlan, write};
use truepath_correction::planned::{PlannedDepth, can_arm, image_name};
use truepath_correction::remarks::said_of_every;
use truepath_correction::summary::name_with;
use truepath_correction::surface::wall::WallFigures;
use truepath_correction::verification::{self, ProbeDialect, Settings, plan_every};
use truepath_ground::codes::{C001, J004, J008};
use truepath_ground::count::counted;
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::length::{Remark, Unit};
use truepath_ground::limits::Limits;
use truepath_ground::output::{OutputFolder, json};
use truepath_ground::units::{float, mm};
use truepath_job::job::{JobFile, ProbeFlags, ROUTES, Route, Which, one_of};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_job::signing::SignFlags;
use truepath_report::next::shown;
use truepath_report::{PlannedWall, planned_map_csv, planned_page};

use super::begin::BeginFlags;
use super::correction_files::{contour_name, contour_place};
pub use super::plan_files::{FILES, PROGRAM};
use super::plan_files::{MAP, PLAN_HISTORY, PROBED, REPORT, VERIFY};
use super::probe::log_name;
use crate::terminal::Terminal;

/// Half the width of a tolerance.
const TOLERANCE: Limits = Limits::within("0.0001", "10", "mm");
/// Share of parts that have to be within it.
const CONFIDENCE: Limits = Limits::within("50", "99.9", "%");

/// What is planned.
#[derive(Clone, Debug, Default, Args)]
pub struct Options {
    /// The job.
    pub job: PathBuf,
    /// What the probe measured on the part cut by the job's program.
    #[arg(long, value_name = "FILE")]
    pub probe: PathBuf,
    /// Half the width of the tolerance of the wall at every height, mm, or with its unit (0.0005in, 12um); without it
    /// that of `[part]`.
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    pub tolerance: Option<String>,
    /// Percent of the machines that the points allow whose wall has to be within the tolerance.
    #[arg(long, value_name = "PERCENT", default_value = "95")]
    pub confidence: String,
    /// Folder for the summary, the page and the program.
    #[arg(short, long, value_name = "DIR")]
    pub output: Option<PathBuf>,
    /// Write the program of a choice, by its number in the table, or of the one recommended; of several contours one number for all, or
    /// one for each, as in 2,1.
    #[arg(long, value_name = "N", num_args = 0..=1, default_missing_value = "recommended", requires = "output")]
    pub write: Option<String>,
    /// Displace the passes in the program text or in the coprocessor; the job says it otherwise.
    #[arg(long, value_parser = one_of(&ROUTES), requires = "write")]
    pub route: Option<Route>,
    /// Replace the files of an earlier run.
    #[arg(long, requires = "output")]
    pub force: bool,
    /// Who signs an image.
    #[command(flatten)]
    pub sign: SignFlags,
    /// Where the fit begins.
    #[command(flatten)]
    pub begin: BeginFlags,
    /// What is said of the probe file in place of the job.
    #[command(flatten)]
    pub probe_flags: ProbeFlags,
    /// Which cut of the program.
    #[command(flatten)]
    pub which: Which,
}

/// What is planned for a part, and what the user should know.
#[derive(Clone, Debug, serde::Serialize)]
pub struct PlanSummary {
    /// Version of this file.
    pub version: u32,
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    pub unit: Unit,
    /// The plan, where one contour is planned.
    #[serde(flatten)]
    pub plan: Option<Plan>,
    /// The plans of several contours, in the order of the program.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub contours: Vec<ContourPlan>,
    /// The choices whose program was written.
    pub written: Option<Written>,
    /// What the user should know.
    pub warnings: Vec<Remark>,
}

/// The plan of one of several contours.
#[derive(Clone, Debug, serde::Serialize)]
pub struct ContourPlan {
    /// Its name.
    pub contour: String,
    /// Its lines in the program.
    pub lines: [u32; 2],
    /// How many depths are cut alike, each in the time of the plan.
    pub depths: usize,
    /// The plan.
    #[serde(flatten)]
    pub plan: Plan,
}

/// A written program.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Written {
    /// The file to load at the machine.
    pub program: PathBuf,
    /// The program that touches its wall, for the control of the part's program; `None` where that is not known.
    pub verify: Option<PathBuf>,
    /// Images of the passes in the order of cutting, for the coprocessor.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub images: Vec<WrittenImage>,
    /// The choice, where one contour is planned.
    #[serde(flatten)]
    pub choice: Option<WrittenChoice>,
    /// The choices of several contours.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub contours: Vec<WrittenChoice>,
    /// Whether learn can go on from there.
    #[serde(skip)]
    pub learns: bool,
    /// Where the passes stand.
    pub depths: Vec<PlannedDepth>,
}

impl Written {
    /// Passes along the contours, at all depths.
    pub(super) fn passes(&self) -> usize {
        self.depths.iter().map(|depth| depth.passes.len()).sum()
    }

    /// What is said of images, where there are any.
    pub(super) fn of_images(&self) -> String {
        let Some(last) = self.images.last() else { return String::new() };
        let folder = last.image.parent().unwrap_or(FilePath::new("")).display();
        format!("images of {} in {folder}: each is armed by M160\n", counted(self.images.len(), "pass"))
    }
}

/// The image of a pass.
#[derive(Clone, Debug, serde::Serialize)]
pub struct WrittenImage {
    /// Its file.
    pub image: PathBuf,
    /// The feature, as `M160` names it.
    pub feature: u32,
    /// The pass of that feature.
    pub pass: u32,
}

/// What was written for a contour.
#[derive(Clone, Debug, serde::Serialize)]
pub struct WrittenChoice {
    /// Its name, of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<String>,
    /// Number of the choice.
    pub choice: usize,
    /// The wall that it leaves, as the identified machine cuts it.
    pub wall: WallFigures,
    /// Largest distance of a commanded place from the programmed path, mm.
    pub largest_correction_mm: f64,
}

/// Plans and prints the choices.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let summary = terminal.watch("planning", |progress| run(options, progress))?;
    terminal.warn_all(&summary.warnings);
    terminal.tell(&summary, || words(&summary, options))
}

fn words(summary: &PlanSummary, options: &Options) -> String {
    let unit = summary.unit;
    let mut text = summary.plan.iter().map(|plan| table(plan, unit)).collect::<String>();
    for one in &summary.contours {
        let depths = if one.depths > 1 { format!(", {} depths", one.depths) } else { String::new() };
        text +=
            &format!("{} (lines {}-{}{depths})\n{}\n", one.contour, one.lines[0], one.lines[1], table(&one.plan, unit));
    }
    text += &together(&summary.contours);
    match &summary.written {
        Some(written) => {
            let numbers: Vec<String> =
                written.choice.iter().chain(&written.contours).map(|one| one.choice.to_string()).collect();
            text += &format!(
                "\nchoice {} written: {}, {}\n",
                numbers.join(", "),
                written.program.display(),
                counted(written.passes(), "pass")
            );
            text += &written.of_images();
            let with = written.verify.as_ref().map_or_else(String::new, |verify| format!(" with {}", verify.display()));
            let then = if written.learns {
                let from = options.output.as_deref().map_or_else(|| "DIR".to_owned(), shown);
                format!("learn {} --probe FILE --from {from} -o DIR", shown(&options.job))
            } else {
                format!("inspect {} --probe FILE", shown(&options.job))
            };
            text += &format!("next: mill a new part with it, touch its wall{with}, and\n  truepath {then}\n");
        }
        None if summary
            .plan
            .iter()
            .chain(summary.contours.iter().map(|one| &one.plan))
            .any(|p| !p.choices.is_empty()) =>
        {
            text += "next: --write N -o DIR writes the program of a choice\n";
        }
        None => {}
    }
    text
}

/// The choices for a contour.
fn table(plan: &Plan, unit: Unit) -> String {
    let (small, um) = (|mm: f64| unit.small(mm), unit.small_name());
    let mut text = format!(
        "as programmed: {:.1} {um} at the worst place of the wall (mean over the height {:.1} {um}), {:.2} min\n\
         wanted: {:.1} {um} at every height, with {:.0} %\n\n\
         \x20      time     profile error   95 % of it   within   passes\n\
         \x20      ratio    {um}, 2 sigma     {um}\n",
        small(plan.as_programmed.profile_mm),
        small(plan.as_programmed.mean_mm),
        plan.minutes,
        small(plan.tolerance_mm),
        plan.confidence * 100.0
    );
    for (k, choice) in plan.choices.iter().enumerate() {
        let mark = if plan.recommended == Some(k + 1) { '*' } else { ' ' };
        text += &format!(
            "{mark} {}  {:>6.2}  {:>7.1} ± {:<6.1} {:>6.1} {:>10.0} %   {}; most of it {}\n",
            k + 1,
            choice.time_ratio,
            small(choice.surface.profile.profile_mm),
            small(2.0 * choice.surface.profile.sigma_mm),
            small(choice.surface.p95_mm),
            choice.within_tolerance * 100.0,
            choice.process_in(unit),
            choice.limited_by,
        );
    }
    text += &match (plan.recommended, plan.choices.last()) {
        (Some(k), _) => format!("\n* choice {k} is the fastest that holds the tolerance\n"),
        (None, Some(best)) => {
            let needed = best.surface.profile.profile_mm + 2.0 * best.surface.profile.sigma_mm;
            format!(
                "\nnone holds it: the best is expected within {:.1} {um} with 2 sigma, {:.1} {um} beyond the tolerance\n",
                small(needed),
                small((needed - plan.tolerance_mm).max(0.0))
            )
        }
        (None, None) => "\nno process keeps the limits of [plan]\n".to_owned(),
    };
    let number = plan.recommended.unwrap_or(plan.choices.len());
    if let Some(choice) = plan.choices.get(number.wrapping_sub(1)) {
        text += &format!("  what is left of choice {number}, {}\n", choice.surface.worst_words(unit));
    }
    text
}

/// The time of all contours, with the fastest choices that hold the tolerance, or the best ones where none does.
fn together(contours: &[ContourPlan]) -> String {
    if contours.is_empty() {
        return String::new();
    }
    let chosen = |plan: &Plan| plan.recommended.unwrap_or(plan.choices.len());
    let of = |one: &ContourPlan| {
        let choice = chosen(&one.plan).checked_sub(1).and_then(|k| one.plan.choices.get(k));
        choice.map_or(one.plan.minutes, |choice| choice.minutes) * one.depths as f64
    };
    let before: f64 = contours.iter().map(|one| one.plan.minutes * one.depths as f64).sum();
    let after: f64 = contours.iter().map(of).sum();
    let missed: Vec<&str> =
        contours.iter().filter(|one| one.plan.recommended.is_none()).map(|one| one.contour.as_str()).collect();
    let with = match missed.len() {
        0 => "the fastest choices that hold the tolerance".to_owned(),
        all if all == contours.len() => "the most accurate choices".to_owned(),
        _ => format!("the fastest choices that hold the tolerance, the most accurate one for {}", missed.join(", ")),
    };
    format!("all contours: {before:.2} min as programmed, {after:.2} min with {with} ({:.2} times)\n", after / before)
}

/// Plans, and writes summary, page and program where a folder is named. `progress` is told the share done, 0…1.
///
/// # Errors
/// Whatever is wrong with job, program, probe file or options, and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<PlanSummary, Failure> {
    let mut job = JobFile::read(&options.job)?;
    job.signer = options.sign.signer()?;
    job.override_probe(&options.probe_flags)?;
    job.which = options.which.clone();
    let wanted = wanted(options, &job)?;
    let file = Source::read(&options.probe)?;
    let walls = options.begin.passes(Pass::every(job)?);
    let measured = walls.first().and_then(|pass| Some((pass, pass.job.measured_stock()?)));
    if let Some((pass, key)) = measured {
        let found = format!("{key} is given: the allowance is not even");
        let help = "plan the job of the whole, even allowance";
        let error = InputError::new(J008, found, "a job with stock.allowance_mm alone", help);
        return Err(error.at(pass.job.source(), pass.job.span(key)).into());
    }
    let (measured, untouched) = match <[Pass; 1]>::try_from(walls) {
        Ok([only]) => (vec![Measurement::of_one(only, &file)?], Vec::new()),
        Err(walls) => {
            Measurement::of_every(walls, &file)?.into_iter().partition(|(_, points)| !points.contacts.is_empty())
        }
    };
    let route = options.route.or(measured.first().map(|(pass, _)| pass.job.route)).unwrap_or_default();
    if options.write.is_some() && route == Route::Coprocessor {
        measured.iter().try_for_each(|(pass, _)| can_arm(pass))?;
    }
    let to_write = options.write.as_deref().map(|text| ToWrite::parse(text, measured.len())).transpose()?;
    let folder = options.output.as_ref().map(|out| OutputFolder::create(out, options.force, FILES)).transpose()?;
    let measured = as_they_agree(measured)?;
    let walls: Vec<(&Pass, &Measurement)> = measured.iter().map(|(pass, points)| (pass, points)).collect();
    let planners = Planner::every(&walls, |share| progress(0.1 * share))?;
    let (mut plans, mut said) = (Vec::new(), Vec::new());
    for (k, (planner, (pass, points))) in planners.iter().zip(&measured).enumerate() {
        let (limits, own) = planner.possible(wanted.limits);
        let share = 0.8 / planners.len() as f64;
        let plan =
            search(planner, &Wanted { limits, ..wanted }, &mut |done| progress(0.1 + (k as f64 + done) * share))?;
        let beyond = pass.unit().remarks(|unit| {
            let beyond = beyond_what_shows(&plan, pass, unit).into_iter().chain(pushed_far(&plan, pass, unit));
            beyond.chain(deeper_than_apart(pass, unit))
        });
        said.push([pass.warnings.clone(), points.remarks(&file), own, beyond].concat());
        plans.push(plan);
    }
    let mut warnings = match &said[..] {
        [only] => only.clone(),
        several => {
            let names: Vec<String> = measured.iter().map(|(pass, _)| contour_name(pass)).collect();
            said_of_every(names.iter().map(String::as_str).zip(several.iter().map(Vec::as_slice)))
        }
    };
    for (pass, points) in &untouched {
        let lines = pass.core.contour.lines;
        warnings.push(format!(
            "{} (lines {}-{}) is not planned: no point of the probe file is on its wall. Touch it with the program of truepath probe",
            contour_name(pass),
            lines.first,
            lines.last
        ).into());
        warnings.extend(points.remarks(&file));
    }
    let several = measured.len() > 1 || !untouched.is_empty();
    let chosen = to_write.map(|which| which.chosen(&measured, &plans)).transpose()?;
    let Some((folder, out)) = folder.zip(options.output.as_ref()) else {
        return Ok(summary(several, &measured, plans, None, warnings));
    };
    let mut written = None;
    if let Some(numbers) = chosen {
        let all = planners.iter().zip(&plans).zip(&numbers);
        let all: Vec<Chosen> = all
            .map(|((planner, plan), k)| {
                let choice = &plan.choices[k - 1];
                Chosen { planner, cuts: &choice.cuts, cutter: choice.cutter }
            })
            .collect();
        let done = write(&all, route, crc32(file.bytes()), &mut |share| progress(0.9 + 0.1 * share))?;
        let passes: Vec<Pass> = measured.iter().map(|(pass, _)| pass.clone()).collect();
        let choices: Vec<&Choice> = plans.iter().zip(&numbers).map(|(plan, k)| &plan.choices[k - 1]).collect();
        // Learning knows the cutter of the program.
        let learns = choices.iter().all(|choice| choice.cutter.is_none());
        if learns {
            let names = [PROGRAM, &planned_name(&passes)];
            let asked = (wanted.tolerance_mm, wanted.confidence);
            for (((pass, points), choice), wall) in measured.iter().zip(&choices).zip(&done.walls) {
                let process = Process::of(&choice.cuts, &wall.passes);
                let next = NextPart::of(process, asked, choice.surface.profile, (&done.program, &names));
                let place = contour_place(pass, several);
                let history = PlanHistory::first(pass, points, next)?.text()?;
                folder.write(&format!("{place}{PLAN_HISTORY}"), &history)?;
            }
            folder.write(PROBED, file.bytes())?;
        }
        let all = write_files((&folder, out), &passes, several, &numbers, done, &mut warnings)?;
        written = Some(Written { learns, ..all });
    }
    let name = measured.first().map(|(pass, _)| program_name(pass)).unwrap_or_default();
    let unit = measured.first().map(|(pass, _)| pass.unit()).unwrap_or_default();
    let shown: Vec<PlannedWall> = measured
        .iter()
        .zip(&plans)
        .map(|((pass, _), plan)| PlannedWall { name: several.then(|| contour_name(pass)), plan })
        .collect();
    folder.write(REPORT, planned_page(&shown, &name, unit).as_bytes())?;
    let summary = summary(several, &measured, plans, written, warnings);
    folder.write("summary.json", &json(&summary)?)?;
    folder.commit()?;
    Ok(summary)
}

/// What is said of a tolerance narrower than what the probe can show, or than what is known of the machine.
fn beyond_what_shows(plan: &Plan, pass: &Pass, unit: Unit) -> Option<String> {
    let name = unit.name();
    let touch = 2.0 * mm(pass.job.numbers.probe?.noise);
    let machine = plan.choices.iter().map(|choice| 2.0 * choice.surface.profile.sigma_mm).fold(f64::INFINITY, f64::min);
    let floor = if machine.is_finite() { touch.max(machine) } else { touch };
    (plan.tolerance_mm < floor).then(|| {
        let known = if machine.is_finite() {
            format!(", and what the points leave open of the machine is {:.4} {name} at best", unit.of(machine))
        } else {
            String::new()
        };
        format!(
            "±{} {name} is less than can be shown: one touch is known to {:.4} {name} (2 sigma, probe.noise_mm){known}; plan for \
             ±{:.4} {name} or more, or touch more places with a better probe",
            unit.of(plan.tolerance_mm),
            unit.of(touch),
            unit.of(floor)
        )
    })
}

/// What is said where the cutter is pushed off the wall by more than half of what it is to take: there its engagement hangs on
/// the push itself, and plans were not tried.
fn pushed_far(plan: &Plan, pass: &Pass, unit: Unit) -> Option<String> {
    let (pushed, allowance) = (plan.as_programmed.profile_mm, mm(pass.core.setup.allowance));
    (2.0 * pushed > allowance).then(|| {
        format!(
            "as programmed the wall is off by {:.3} {name} of an allowance of {} {name}: beyond half of it predictions were not tried, and \
             one there was wrong by more than two standard deviations; rough the part closer to the wall, or judge the first planned part with truepath inspect",
            unit.of(pushed),
            unit.of(allowance),
            name = unit.name()
        )
    })
}

/// What is said of depths that are nearer to each other than the cutter is taken to be deep in the stock.
fn deeper_than_apart(pass: &Pass, unit: Unit) -> Option<String> {
    let depth = float(pass.core.setup.axial_depth);
    let finishing = pass.plan.iter().flat_map(|plan| &plan.passes).filter(|one| !one.spring);
    let z: Vec<Offset> = finishing.filter_map(|one| Some(Offset::from_nm(one.z?.nm()))).collect();
    let apart = z.windows(2).map(|pair| mm((pair[0] - pair[1]).abs())).fold(f64::INFINITY, f64::min);
    (apart + 0.001 < depth).then(|| {
        format!(
            "the depths of {} are {} {} apart, and cut.axial_depth_mm is {depth}: the depth before has cut the wall above already, and the \
             plan takes it to be in the stock; leave axial_depth_mm out, so that every contour has its own",
            contour_name(pass),
            unit.of(apart),
            unit.name()
        )
    })
}

/// Where there are no threads nobody looks on while the search runs.
#[cfg(target_family = "wasm")]
fn search(planner: &Planner<'_>, wanted: &Wanted, progress: &mut dyn FnMut(f64)) -> Result<Plan, Failure> {
    let plan = planner.plan(wanted, &|_| ())?;
    progress(1.0);
    Ok(plan)
}

/// The search uses all cores; `progress` belongs to this thread.
#[cfg(not(target_family = "wasm"))]
fn search(planner: &Planner<'_>, wanted: &Wanted, progress: &mut dyn FnMut(f64)) -> Result<Plan, Failure> {
    let (tell, told) = std::sync::mpsc::channel();
    std::thread::scope(|scope| {
        let work = scope.spawn(move || {
            planner.plan(wanted, &move |share| {
                let _ = tell.send(share);
            })
        });
        told.iter().for_each(progress);
        work.join().unwrap_or_else(|_| Err(Failure::Internal("the search for a plan broke off".to_owned())))
    })
}

fn summary(
    several: bool,
    measured: &[(Pass, Measurement)],
    mut plans: Vec<Plan>,
    written: Option<Written>,
    warnings: Vec<Remark>,
) -> PlanSummary {
    let unit = measured.first().map(|(pass, _)| pass.unit()).unwrap_or_default();
    let plan = if several { None } else { plans.pop() };
    let of = |((pass, _), plan): (&(Pass, Measurement), Plan)| ContourPlan {
        contour: contour_name(pass),
        lines: [pass.core.contour.lines.first, pass.core.contour.lines.last],
        depths: pass.plan.as_ref().map_or(1, |plan| plan.levels().len()),
        plan,
    };
    PlanSummary { version: 1, unit, plan, contours: measured.iter().zip(plans).map(of).collect(), written, warnings }
}

/// The program's own name beside [`PROGRAM`].
pub(super) fn planned_name(passes: &[Pass]) -> String {
    name_with(passes.first().map_or("", |pass| pass.program.name()), "planned")
}

/// Writes the program with all that belongs to it, and the one that touches its walls, to `out` in the end.
pub(super) fn write_files(
    (folder, out): (&OutputFolder, &FilePath),
    passes: &[Pass],
    several: bool,
    numbers: &[usize],
    done: WrittenPlan,
    warnings: &mut Vec<Remark>,
) -> Result<Written, Failure> {
    let verify = write_verification(folder, passes, warnings)?;
    let name = planned_name(passes);
    for file in [PROGRAM, &name] {
        folder.write(file, &done.program.text)?;
    }
    folder.write("difference.txt", done.program.report.as_bytes())?;
    let mut images = Vec::new();
    for (k, image) in done.program.images.iter().enumerate() {
        let file = image_name(k + 1);
        folder.write(&file, &image.bytes)?;
        images.push(WrittenImage { image: out.join(file), feature: image.feature, pass: image.pass });
    }
    let mut choices = Vec::new();
    for ((pass, wall), &choice) in passes.iter().zip(&done.walls).zip(numbers) {
        let place = contour_place(pass, several);
        folder.write(&format!("{place}{MAP}"), &planned_map_csv(&wall.map)?)?;
        choices.push(WrittenChoice {
            contour: several.then(|| contour_name(pass)),
            choice,
            wall: wall.figures,
            largest_correction_mm: wall.largest_correction_mm,
        });
    }
    warnings.extend(done.program.warnings.into_iter().map(Remark::from));
    let choice = if several { None } else { choices.pop() };
    Ok(Written {
        program: out.join(name),
        verify: verify.then(|| out.join(VERIFY)),
        images,
        choice,
        contours: choices,
        learns: false,
        depths: done.program.depths,
    })
}

/// Writes the program that touches the walls as `truepath probe` does, for the control of the part's program; whether that is known
/// and the walls can be touched.
fn write_verification(folder: &OutputFolder, passes: &[Pass], warnings: &mut Vec<Remark>) -> Result<bool, Failure> {
    let control = passes.first().and_then(|pass| pass.job.probe_control);
    let Some(dialect) = control.and_then(|name| ProbeDialect::from_str(name, true).ok()) else {
        let help = "job and program name no control that a verification program is written for: truepath probe writes it with --dialect, or lists the places";
        warnings.push(help.into());
        return Ok(false);
    };
    let text = plan_every(passes, &Settings::default(), &mut |_| ())
        .and_then(|plan| Ok((verification::write(&plan, dialect, &log_name(FilePath::new(VERIFY)))?, plan.warnings)));
    match text {
        Ok((text, said)) => {
            warnings.extend(said.into_iter().filter(|text| !warnings.contains(text)).collect::<Vec<_>>());
            folder.write(VERIFY, text.as_bytes())?;
            Ok(true)
        }
        Err(Failure::Input(error)) => {
            warnings.push(format!("no verification program was written: {}: {}", error.code(), error.found()).into());
            Ok(false)
        }
        Err(failure) => Err(failure),
    }
}

/// Which choices `--write` names; what is wrong with it whatever the plans are is known before they are searched.
enum ToWrite {
    /// The recommended one of every contour.
    Recommended,
    /// One for every contour, from 1.
    Numbers(Vec<usize>),
}

const LOOK: &str = "look at the table without --write, and write its number";

impl ToWrite {
    /// `contours` is how many are planned.
    fn parse(text: &str, contours: usize) -> Result<Self, Failure> {
        if text == "recommended" {
            return Ok(Self::Recommended);
        }
        let refused = |expected: String| {
            let found = format!("--write on the command line is {text:?}");
            Failure::from(InputError::new(C001, found, expected, LOOK))
        };
        let number = |word: &str| {
            let number = word.trim().parse().ok().filter(|n| *n > 0);
            number.ok_or_else(|| refused("the number of a choice, from 1 on".to_owned()))
        };
        match text.split(',').map(number).collect::<Result<Vec<usize>, _>>()? {
            one if one.len() == 1 => Ok(Self::Numbers(vec![one[0]; contours])),
            each if each.len() == contours => Ok(Self::Numbers(each)),
            _ => Err(refused(format!("one number, or one for each of the {contours} contours"))),
        }
    }

    /// The numbers of the choices, one for each contour.
    fn chosen(&self, measured: &[(Pass, Measurement)], plans: &[Plan]) -> Result<Vec<usize>, Failure> {
        let each = plans.iter().zip(measured).enumerate().map(|(k, (plan, (pass, _)))| {
            let of = if plans.len() == 1 { String::new() } else { format!(" for {}", contour_name(pass)) };
            let (number, found) = match self {
                Self::Recommended => {
                    (plan.recommended, format!("--write without a number, and no choice holds the tolerance{of}"))
                }
                Self::Numbers(numbers) => (Some(numbers[k]), format!("--write asks for choice {}{of}", numbers[k])),
            };
            let expected = format!("the number of a choice{of}, 1 to {}", plan.choices.len());
            let number = number.filter(|n| (1..=plan.choices.len()).contains(n));
            number.ok_or_else(|| InputError::new(C001, found, expected, LOOK).into())
        });
        each.collect()
    }
}

pub(super) fn program_name(pass: &Pass) -> String {
    let name = FilePath::new(pass.program.name()).file_name();
    name.map_or_else(|| pass.program.name().to_owned(), |name| name.to_string_lossy().into_owned())
}

fn wanted(options: &Options, job: &JobFile) -> Result<Wanted, Failure> {
    let flag = |name: &str, text: &str, number: Option<Decimal>, (limits, expected): (Limits, String), help: &str| {
        number.filter(|n| limits.admits(*n)).map(Decimal::as_f64).ok_or_else(|| {
            let found = format!("{name} on the command line is {text:?}");
            Failure::from(InputError::new(C001, found, expected, help))
        })
    };
    let tolerance_mm = match &options.tolerance {
        Some(text) => {
            let help = "write --tolerance 0.02 for ±0.02 mm at every height, 0.0008in for ±0.0008 in";
            flag("--tolerance", text, Decimal::length(text), (TOLERANCE, TOLERANCE.phrase_in_both()), help)?
        }
        None => match job.part.tolerance {
            Some(tolerance) => mm(tolerance.upper).min(-mm(tolerance.lower)),
            None => {
                let help = "write --tolerance 0.02 for ±0.02 mm (0.0008in for ±0.0008 in), or tolerance_mm (tolerance_in) under [part] of the job";
                let error = InputError::new(J004, "no tolerance to plan for", "half the width of one", help);
                return Err(error.in_file(&options.job).into());
            }
        },
    };
    let text = &options.confidence;
    let help = "write --confidence 95 for 95 of 100 parts";
    let confidence = flag("--confidence", text, Decimal::parse(text), (CONFIDENCE, CONFIDENCE.phrase()), help)? / 100.0;
    Ok(Wanted { tolerance_mm, confidence, limits: job.plan })
}

#[cfg(test)]
mod tests {
    use super::*;

    const DEPTHS: &str = "%\nG21 G90 G17\nT5 M6\nS2500 M3\nG0 X-6 Y6 Z20\nG1 Z-6 F300\nG1 X0 Y0 F420\nG1 X30\nG3 X40 Y10 I0 J10\n\
        G1 Y36\nG1 X34 Y42\nG0 Z20\nG0 X-6 Y6\nG1 Z-12 F300\nG1 X0 Y0 F420\nG1 X30\nG3 X40 Y10 I0 J10\nG1 Y36\nG1 X34 Y42\nG0 Z20\n\
        M30\n%\n";

    #[test]
    fn depths_nearer_than_the_cutter_is_deep_are_told() {
        let job = |depth: &str| {
            format!(
                "version = 1\nprogram = \"part.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 0.7\n[tool]\ndiameter_mm = 12.0\nteeth = 4\n\
                 helix_deg = 30.0\n[cut]\n{depth}[force]\nmaterial = \"al-7075-heavy\"\n[machine]\nstiffness_x_n_per_mm = 1600\n\
                 stiffness_y_n_per_mm = 1600\n"
            )
        };
        let folder = tempfile::tempdir().expect("a folder");
        std::fs::write(folder.path().join("part.nc"), DEPTHS).expect("written");
        let said = |depth: &str| {
            let place = folder.path().join("job.toml");
            std::fs::write(&place, job(depth)).expect("written");
            let Ok(pass) = JobFile::read(&place).map_err(Failure::from).and_then(Pass::read) else { panic!("refused") };
            deeper_than_apart(&pass, Unit::Millimetre)
        };
        assert!(said("axial_depth_mm = 8.0\n").is_some_and(|text| text.contains("6 mm apart")));
        assert_eq!(said("axial_depth_mm = 6.0\n"), None);
        assert_eq!(said(""), None);
    }
}
