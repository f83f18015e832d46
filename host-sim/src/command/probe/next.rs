//! `probe --next`: the places to touch next, given what was measured.
//!
//! | given | touched is | what is known |
//! |---|---|---|
//! | a probe file | the part it is of, which no correction was cut with | that file |
//! | a folder of `correct` or `learn` | the next part, cut with the correction in it | the parts of its history |
//! | both | the part cut with that correction, once more | the parts of its history, and that file |
//! | a folder of `plan`, or of `learn` from there | the next part, cut with the planned program in it | the job |

use std::path::Path as FilePath;

use truepath_correction::codes::{Q003, Q007};
use truepath_correction::further::{next, next_part};
use truepath_correction::verification::{Plan, Settings, plan_every};
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_job::job::JobFile;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use crate::command::begin::BeginFlags;
use crate::command::history::{history_in, holds_planned, planned_in};

/// Plans further touches from files; `begin` says where fits begin. `progress` is told the share done, 0…1.
///
/// # Errors
/// Neither file nor folder; whatever is wrong with them, a correction beyond the clamp, and as [`next`] and [`next_part`].
pub(super) fn of_files(
    (job, begin): (JobFile, &BeginFlags),
    (probe, from): (Option<&FilePath>, Option<&FilePath>),
    settings: &Settings,
    progress: &mut dyn FnMut(f64),
) -> Result<Plan, Failure> {
    let file = probe.map(Source::read).transpose()?;
    let Some(folder) = from else {
        let Some(file) = file else {
            let help = "give --probe, --from or both";
            return Err(InputError::new(C001, "--next without anything measured", "measured points", help).into());
        };
        let (pass, measurement) = Measurement::of_any_depth(begin.pass(Pass::read(job)?), &file)?;
        let mut plan = next(&pass, &measurement, settings, progress)?;
        plan.warnings.extend(measurement.remarks(&file));
        return Ok(plan);
    };
    if holds_planned(folder) {
        return planned_part((job, begin), folder, settings, progress);
    }
    let pass = begin.pass(Pass::read(job)?);
    let history = history_in(folder, folder)?;
    let level = history.facts.level().filter(|_| pass.job.which.pass.is_none() && pass.plan.is_some());
    let pass = level.map(|level| pass.at_level(level)).transpose()?.unwrap_or(pass).cut_with(history.cut_with());
    let measurement = file.as_ref().map(|file| Measurement::read(&pass, file)).transpose()?;
    let mut plan = next_part(&pass, &history, measurement.as_ref(), settings, progress).map_err(|failure| {
        match (failure, probe) {
            (Failure::Input(error), Some(probe)) if [Q003.code, Q007.code].contains(&error.code()) => {
                error.in_file(probe).into()
            }
            (failure, _) => failure,
        }
    })?;
    plan.warnings.extend(measurement.iter().zip(&file).flat_map(|(m, file)| m.remarks(file)));
    Ok(plan)
}

/// Plans touches of the part cut with the planned program of a folder, of all its contours: at heights that tell the profile, since every
/// height counts.
fn planned_part(
    (job, begin): (JobFile, &BeginFlags),
    folder: &FilePath,
    settings: &Settings,
    progress: &mut dyn FnMut(f64),
) -> Result<Plan, Failure> {
    let cuts = planned_in(folder, job)?.cuts;
    cuts.iter().try_for_each(|(pass, history)| history.facts.agree(pass))?;
    let narrowest = cuts.iter().map(|(_, history)| history.next.tolerance_mm).reduce(f64::min);
    let settings = Settings { tolerance: settings.tolerance.or(narrowest), ..settings.clone() };
    let program = cuts.first().and_then(|(_, history)| history.program());
    let passes = begin.passes(cuts.into_iter().map(|(pass, _)| pass).collect());
    Ok(Plan { correction: program, ..plan_every(&passes, &settings, progress)? })
}
