//! `study --shop`: the jobs of a virtual shop, corrected with and without what the others say.

use std::io::Write;
use std::path::Path as FilePath;

use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::output::{OutputFile, OutputFolder, json};
use truepath_study::case_table::program_key;
use truepath_study::markdown::{SHOP, written_into};
use truepath_study::shop::summary::{ShopSummary, markdown, summary};
use truepath_study::shop::workflow::ShopStudy;

/// What is written.
const FILES: &[&str] = &["jobs.csv", "summary.json"];

/// Runs the study and writes its table and summary, and with `document` its table between the two marks of a Markdown file. Unlike the
/// other studies it begins anew: what the others say follows from all jobs. `progress` is told (finished, of) corrections.
///
/// # Errors
/// Outputs that cannot be written.
pub fn run(
    folder: &FilePath,
    force: bool,
    document: Option<&FilePath>,
    study: &ShopStudy,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<ShopSummary, Failure> {
    let out = OutputFolder::create(folder, force, FILES)?;
    let outcomes = study.run(progress);
    let summary = summary(&program_key(), &outcomes);
    let mut table = csv::Writer::from_writer(Vec::new());
    let internal = |e: &dyn std::fmt::Display| Failure::Internal(format!("jobs.csv: {e}"));
    for outcome in &outcomes {
        table.serialize(outcome).map_err(|e| internal(&e))?;
    }
    out.write("jobs.csv", &table.into_inner().map_err(|e| internal(&e))?)?;
    out.write("summary.json", &json(&summary)?)?;
    out.commit()?;
    if let Some(path) = document {
        let text = written_into(&Source::read(path)?, SHOP, &markdown(&summary))?;
        let mut file = OutputFile::create(path, true)?;
        file.write_all(text.as_bytes()).map_err(|e| InputError::unwritable(path, &e))?;
        file.commit()?;
    }
    Ok(summary)
}
