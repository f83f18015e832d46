//! `study`: the cases that are asked for and not yet finished, on all cores, and the summary of all that are.

use std::io::Write;
use std::path::Path as FilePath;

use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::output::{OutputFile, json};
use truepath_study::case_table::{CaseTable, program_key};
use truepath_study::codes::{Y003, Y004};
use truepath_study::families::{FAMILIES, Family, family};
use truepath_study::id::{Axis, CaseId, Cell};
use truepath_study::markdown::{results, written_into};
use truepath_study::outcome::Outcome;
use truepath_study::page::page;
use truepath_study::reference::{Reached, reference as goals};
use truepath_study::seeds::Set;
use truepath_study::summary::{Summary, summary};
use truepath_study::{parallel, workflow};

/// File of the reference goals.
const GOALS: &str = "reference.json";

/// What is studied.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// Folder of the results.
    pub out: &'a FilePath,
    /// Which seeds.
    pub set: Set,
    /// Names of families; all when empty.
    pub families: &'a [String],
    /// Seeds a family, or cases in all for random machines.
    pub seeds: u64,
    /// The grid, if one.
    pub axis: Option<Axis>,
    /// Only the first correction.
    pub first_only: bool,
    /// A Markdown file whose results are replaced.
    pub write: Option<&'a FilePath>,
    /// Drop earlier results.
    pub force: bool,
    /// Threads; all cores when `None`.
    pub threads: Option<usize>,
}

/// The cases of a request.
///
/// # Errors
/// `Y003` for a family that does not exist, `Y004` for more seeds than the set has.
pub fn cases(options: &Options) -> Result<Vec<CaseId>, Failure> {
    let unknown = |name: &str| {
        let names: Vec<&str> = FAMILIES.iter().map(|f| f.name).collect();
        InputError::new(Y003, format!("no family `{name}`"), format!("one of {}", names.join(", ")), "correct the name")
    };
    let chosen: Vec<&Family> = if options.families.is_empty() {
        FAMILIES.iter().collect()
    } else {
        let each = options.families.iter().map(|name| family(name).ok_or_else(|| unknown(name)));
        each.collect::<Result<_, _>>()?
    };
    let seeds = options.set.seeds();
    let most = seeds.end - seeds.start;
    if options.seeds == 0 || options.seeds > most {
        let found = format!("{} seeds", options.seeds);
        return Err(InputError::new(Y004, found, format!("1 to {most}"), "ask for another number").into());
    }
    let cells: Vec<Option<Cell>> = match options.axis {
        None => vec![None],
        Some(axis) => axis.values().iter().map(|&value| Some(Cell { axis, value })).collect(),
    };
    let mut cases = Vec::new();
    for seed in seeds.take(options.seeds as usize) {
        // Random machines go round the families; otherwise every family gets every seed.
        let these = match options.set {
            Set::Random => vec![chosen[(seed % chosen.len() as u64) as usize]],
            Set::Tuning | Set::Test => chosen.clone(),
        };
        for family in these {
            cases.extend(cells.iter().map(|&cell| CaseId { family: family.name.to_owned(), seed, cell }));
        }
    }
    Ok(cases)
}

/// What a run leaves: the summary of everything in the folder.
#[derive(Clone, Debug)]
pub struct Studied {
    /// All results of the folder.
    pub outcomes: Vec<Outcome>,
    /// Their summary, as in `summary.json`.
    pub summary: Summary,
}

/// Runs what is not yet finished; writes page and summary of all results of the folder. `progress` is told (finished,
/// of) cases.
///
/// # Errors
/// A wrong request, results of another program, outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(u64, u64)) -> Result<Studied, Failure> {
    let cases = cases(options)?;
    let key = program_key();
    let mut ledger = CaseTable::open(options.out, &key, options.force)?;
    let all = cases.len() as u64;
    let left: Vec<CaseId> = cases.into_iter().filter(|id| !ledger.finished.contains_key(&id.to_string())).collect();
    let mut finished = all - left.len() as u64;
    progress(finished, all);
    let threads = options.threads.unwrap_or_else(parallel::cores);
    let carried = |id: &CaseId| workflow::outcome(id, options.first_only);
    parallel::for_each(&left, threads, carried, |outcome| {
        finished += 1;
        progress(finished, all);
        ledger.append(outcome)
    })?;
    let outcomes: Vec<Outcome> = ledger.finished.into_values().collect();
    let summary = summary(&key, &outcomes);
    let write = |name: &str, bytes: &[u8]| -> Result<(), Failure> {
        let path = options.out.join(name);
        // These two always follow from the table beside them.
        let mut file = OutputFile::create(&path, true)?;
        file.write_all(bytes).map_err(|e| InputError::unwritable(&path, &e))?;
        Ok(file.commit()?)
    };
    write("summary.json", &json(&summary)?)?;
    write("study.html", page(&summary, &outcomes)?.as_bytes())?;
    if let Some(path) = options.write {
        let goals = std::fs::read(options.out.join(GOALS)).ok();
        let reached: Vec<Reached> = goals.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default();
        let text = written_into(&Source::read(path)?, &results(&summary, &reached))?;
        let mut file = OutputFile::create(path, true)?;
        file.write_all(text.as_bytes()).map_err(|e| InputError::unwritable(path, &e))?;
        file.commit()?;
    }
    Ok(Studied { outcomes, summary })
}

/// The reference goals over `seeds` noise seeds; writes `reference.json`. `progress` is told (finished, of) runs.
///
/// # Errors
/// `F003` for a folder that has results of an earlier run, unless `force`; outputs that cannot be written.
pub fn reference(
    seeds: u64,
    threads: usize,
    out: &FilePath,
    force: bool,
    progress: &mut dyn FnMut(u64, u64),
) -> Result<Vec<Reached>, Failure> {
    let path = out.join(GOALS);
    std::fs::create_dir_all(out).map_err(|e| InputError::unwritable(&path, &e))?;
    let mut file = OutputFile::create(&path, force)?;
    let reached = goals(seeds, threads, progress)?;
    file.write_all(&json(&reached)?).map_err(|e| InputError::unwritable(&path, &e))?;
    file.commit()?;
    Ok(reached)
}
