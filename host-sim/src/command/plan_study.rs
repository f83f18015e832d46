//! `study --plan`: plans of drawn cases, cut and judged at every height.

use std::io::Write;
use std::ops::Range;
use std::path::Path as FilePath;

use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::output::{OutputFile, OutputFolder, json};
use truepath_study::case_table::{CaseTable, program_key};
use truepath_study::markdown::{RESULTS, written_into};
use truepath_study::parallel;
use truepath_study::plan::outcome::PlanOutcome;
use truepath_study::plan::summary::{PlanSummary, markdown, summary};
use truepath_study::plan::workflow::{Planned, name, outcome};

/// Files of a case, to repeat it by hand.
const FILES: &[&str] = &["program.nc", "job.toml", "plant.toml", "probe.txt", "planned.nc"];

/// What is studied.
#[derive(Clone, Debug)]
pub struct PlanStudy<'a> {
    /// Folder of the results; an interrupted study goes on there.
    pub folder: &'a FilePath,
    /// A case each.
    pub seeds: Range<u64>,
    /// Cases at a time.
    pub threads: usize,
    /// Drop earlier results.
    pub force: bool,
    /// A Markdown file that gets the table between its two marks.
    pub document: Option<&'a FilePath>,
}

/// Runs what is not yet finished and writes the summary of all results of the folder. `progress` is told (finished, of) cases.
///
/// # Errors
/// Results of another program or another study, outputs that cannot be written.
pub fn run(study: &PlanStudy, progress: &mut dyn FnMut(u64, u64)) -> Result<PlanSummary, Failure> {
    let key = format!("{} plan", program_key());
    let mut table: CaseTable<PlanOutcome> = CaseTable::open(study.folder, &key, study.force)?;
    let all = study.seeds.end - study.seeds.start;
    let left: Vec<u64> = study.seeds.clone().filter(|seed| !table.finished.contains_key(&name(*seed))).collect();
    let mut finished = all - left.len() as u64;
    progress(finished, all);
    let carried = |seed: &u64| {
        let (outcome, planned) = outcome(*seed);
        let written = planned.map_or(Ok(()), |planned| export(&planned, &study.folder.join(seed.to_string())));
        (outcome, written)
    };
    parallel::for_each(&left, study.threads, carried, |(outcome, written)| {
        written?;
        finished += 1;
        progress(finished, all);
        table.append(outcome)
    })?;
    let outcomes: Vec<PlanOutcome> = table.finished.into_values().collect();
    let summary = summary(&key, &outcomes);
    write(&study.folder.join("summary.json"), &json(&summary)?)?;
    if let Some(path) = study.document {
        write(path, written_into(&Source::read(path)?, RESULTS, &markdown(&summary))?.as_bytes())?;
    }
    Ok(summary)
}

/// Replaces a file.
fn write(path: &FilePath, bytes: &[u8]) -> Result<(), Failure> {
    let mut file = OutputFile::create(path, true)?;
    file.write_all(bytes).map_err(|e| InputError::unwritable(path, &e))?;
    Ok(file.commit()?)
}

/// Writes the files of a case.
fn export(planned: &Planned, folder: &FilePath) -> Result<(), Failure> {
    let case = &planned.case;
    let out = OutputFolder::create(folder, true, FILES)?;
    let plant = toml::to_string(&case.machine).map_err(|e| Failure::Internal(format!("plant.toml: {e}")))?;
    for (name, bytes) in FILES.iter().zip([
        case.program.as_bytes(),
        case.job.as_bytes(),
        plant.as_bytes(),
        case.probe.as_bytes(),
        &planned.program,
    ]) {
        out.write(name, bytes)?;
    }
    out.commit()?;
    Ok(())
}
