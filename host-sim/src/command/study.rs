//! `study`: the cases that are asked for and not yet finished, on all cores, and the summary of all that are.

use std::fmt::Write as _;
use std::io::Write;
use std::ops::Range;
use std::path::{Path as FilePath, PathBuf};

use clap::Args;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::output::{OutputFile, json};
use truepath_job::job::one_of;
use truepath_study::case_table::{CaseTable, program_key};
use truepath_study::codes::{Y003, Y004};
use truepath_study::families::{FAMILIES, Family, family};
use truepath_study::id::{Axis, CaseId, Cell, Touches};
use truepath_study::markdown::{self, NUISANCES, RESULTS, written_into};
use truepath_study::nuisance::Nuisance;
use truepath_study::outcome::Outcome;
use truepath_study::page::page;
use truepath_study::plan::summary::words as words_of_plans;
use truepath_study::reference::{Reached, reference as goals, words as words_of_goals};
use truepath_study::seeds::Set;
use truepath_study::shop::summary::words as words_of_shop;
use truepath_study::shop::workflow::ShopStudy;
use truepath_study::summary::{Row, Summary, summary};
use truepath_study::{export, parallel, workflow};

use super::pack;
use super::pack::again::again;
use super::plan_study::{self, PlanStudy};
use super::shop_study;
use crate::terminal::Terminal;

/// File of the reference goals.
const GOALS: &str = "reference.json";

/// The sets one may ask for.
const SETS: [(&str, Set); 2] = [("tuning", Set::Tuning), ("test", Set::Test)];

/// What may be added to the machines, by name; `each` is one at a time, with none and with all beside them.
const ADDED: [(&str, &[Option<Nuisance>]); 15] = [
    ("none", &[None]),
    ("all", &[Some(Nuisance::All)]),
    ("each", &each()),
    (Nuisance::StockWave.name(), &[Some(Nuisance::StockWave)]),
    (Nuisance::StockStep.name(), &[Some(Nuisance::StockStep)]),
    (Nuisance::StockCorner.name(), &[Some(Nuisance::StockCorner)]),
    (Nuisance::StockLevel.name(), &[Some(Nuisance::StockLevel)]),
    (Nuisance::Wear.name(), &[Some(Nuisance::Wear)]),
    (Nuisance::Yielding.name(), &[Some(Nuisance::Yielding)]),
    (Nuisance::Drift.name(), &[Some(Nuisance::Drift)]),
    (Nuisance::Runout.name(), &[Some(Nuisance::Runout)]),
    (Nuisance::Lobing.name(), &[Some(Nuisance::Lobing)]),
    (Nuisance::Wild.name(), &[Some(Nuisance::Wild)]),
    (Nuisance::Lag.name(), &[Some(Nuisance::Lag)]),
    (Nuisance::Radius.name(), &[Some(Nuisance::Radius)]),
];

/// None, one at a time, all.
const fn each() -> [Option<Nuisance>; Nuisance::EACH.len() + 2] {
    let mut out = [None; Nuisance::EACH.len() + 2];
    let mut k = 0;
    while k < Nuisance::EACH.len() {
        out[k + 1] = Some(Nuisance::EACH[k]);
        k += 1;
    }
    out[k + 1] = Some(Nuisance::All);
    out
}

/// What is studied.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// Folder of the results; an interrupted study goes on there.
    #[arg(short, long, value_name = "DIR", required_unless_present_any = ["case", "pack"])]
    pub output: Option<PathBuf>,
    /// One case in detail instead, by its id.
    #[arg(long, value_name = "ID", conflicts_with_all = ["output", "set", "families", "seeds", "axis", "random", "nuisance", "touches"])]
    pub case: Option<CaseId>,
    /// The story of a real part instead, as truepath pack wrote it: made again, beside what was written and measured then.
    #[arg(long, value_name = "STORY.tpk", conflicts_with_all = ["output", "case", "set", "families", "seeds", "axis", "random", "nuisance", "touches", "reference", "first", "plan", "write"])]
    pub pack: Option<PathBuf>,
    /// Write program, job, machine, probe file and corrected program of that case.
    #[arg(long, value_name = "DIR", requires = "case")]
    pub export: Option<PathBuf>,
    /// Which seeds: those for tuning, or those kept for judging.
    #[arg(long, value_parser = one_of(&SETS), default_value = "tuning")]
    pub set: Set,
    /// Only these families.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',')]
    pub families: Vec<String>,
    /// Seeds a family.
    #[arg(long, value_name = "N", default_value_t = 5)]
    pub seeds: u64,
    /// A grid instead of single cases: the factor against one thing.
    #[arg(long, value_enum)]
    pub axis: Option<Axis>,
    /// What shops add to the machines: each stays what it is beneath.
    #[arg(long, value_name = "NAME,…", value_delimiter = ',', value_parser = one_of(&ADDED), default_value = "none", conflicts_with = "axis")]
    pub nuisance: Vec<&'static [Option<Nuisance>]>,
    /// Where the parts are touched.
    #[arg(long, value_enum, default_value_t, conflicts_with = "axis")]
    pub touches: Touches,
    /// So many wholly random machines instead of the seeds of a set.
    #[arg(long, value_name = "N", conflicts_with_all = ["set", "seeds", "axis"])]
    pub random: Option<u64>,
    /// The reference goals instead: the papers' corner, --seeds noise seeds (200 are usual) for each.
    #[arg(long, conflicts_with_all = ["set", "families", "axis", "random", "first", "nuisance", "touches"])]
    pub reference: bool,
    /// Only the first correction; nothing is learned from a second part.
    #[arg(long)]
    pub first: bool,
    /// Plans instead: the wall at every height of the part that the recommended program cuts, a case a seed.
    #[arg(long, conflicts_with_all = ["case", "families", "axis", "random", "reference", "first"])]
    pub plan: bool,
    /// A shop of so many machines instead: the first corrections of its jobs, with and without what the others say (30 are usual).
    #[arg(long, value_name = "MACHINES", conflicts_with_all = ["case", "families", "axis", "random", "reference", "first", "plan", "nuisance", "set", "seeds"])]
    pub shop: Option<u64>,
    /// Put the tables into a Markdown file, between its two marks.
    #[arg(long, value_name = "FILE.md")]
    pub write: Option<PathBuf>,
    /// Threads. [default: all cores]
    #[arg(long, value_name = "N")]
    pub threads: Option<usize>,
    /// Drop earlier results; with --export, replace files.
    #[arg(long)]
    pub force: bool,
}

impl Options {
    /// The set the seeds are of, and how many of them.
    fn seeds(&self) -> (Set, u64) {
        self.random.map_or((self.set, self.seeds), |count| (Set::Random, count))
    }
    /// Whether tables of nuisances were asked for, and not those of the families.
    fn disturbed(&self) -> bool {
        self.touches != Touches::Family || self.nuisance.iter().copied().flatten().any(Option::is_some)
    }
    fn threads(&self) -> usize {
        self.threads.unwrap_or_else(parallel::cores)
    }
    /// Folder of the results; clap has seen to it that there is one where it is needed.
    fn out(&self) -> &FilePath {
        self.output.as_deref().unwrap_or(FilePath::new("."))
    }
}

/// Studies and prints the summary.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    if let Some(id) = &options.case {
        let detail = export::detail(id)?;
        if let Some(folder) = &options.export {
            export::export(&detail, folder, options.force)?;
        }
        return terminal.tell(&detail.outcome, || export::words(&detail));
    }
    if let Some(file) = &options.pack {
        let story = pack::read(file)?;
        let made = terminal.watch("making it again", |progress| again(&story, progress))?;
        return terminal.tell(&made, || made.words());
    }
    let mut bar = terminal.progress("studying", 1000);
    let progress = &mut |done, all: u64| bar.reached(done * 1000 / all.max(1));
    if options.plan {
        let asked = PlanStudy {
            folder: options.out(),
            seeds: seeds(options)?,
            threads: options.threads(),
            force: options.force,
            document: options.write.as_deref(),
        };
        let summary = plan_study::run(&asked, progress)?;
        drop(bar);
        return terminal.tell(&summary, || words_of_plans(&summary));
    }
    if let Some(machines) = options.shop {
        let asked = ShopStudy { seed: 1, machines, threads: options.threads(), touches: options.touches };
        let summary = shop_study::run(options.out(), options.force, options.write.as_deref(), &asked, progress)?;
        drop(bar);
        return terminal.tell(&summary, || words_of_shop(&summary));
    }
    if options.reference {
        let reached = reference(options, progress)?;
        drop(bar);
        return terminal.tell(&reached, || words_of_goals(&reached));
    }
    let studied = run(options, progress)?;
    drop(bar);
    terminal.tell(&studied.summary, || words(&studied.summary, options.out()))
}

fn words(summary: &Summary, output: &FilePath) -> String {
    let mut text = format!(
        "{:<22} {:>5} {:>7} {:>7} {:>7} {:>8} {:>7} {:>8} {:>8} {:>7} {:>7} {:>8} {:>7} {:>8} {:>8} {:>6}\n",
        "",
        "cases",
        "median",
        "P10",
        "worst",
        "in 2 sg",
        "any ht",
        "in 2 sg",
        "learned",
        "P10",
        "worst",
        "in 2 sg",
        "any ht",
        "in 2 sg",
        "refused",
        "worse"
    );
    for set in &summary.sets {
        let _ = writeln!(text, "{} seeds", set.set.name());
        for one in set.families.iter().chain([&set.all]) {
            text += &row(one);
        }
        let _ = writeln!(text, "  {}", set.all.whole_wall.words());
    }
    for axis in &summary.axes {
        let _ = writeln!(text, "{}", axis.axis);
        for (_, one) in &axis.cells {
            text += &row(one);
        }
    }
    for one in &summary.nuisances {
        let _ = writeln!(text, "{} seeds with nuisances, touched {}", one.set.name(), one.touches.words());
        for one in &one.rows {
            text += &row(one);
        }
    }
    for failed in summary.failures.iter().chain(&summary.worse) {
        let _ = writeln!(text, "{}: {}", failed.case, failed.what);
    }
    let _ = writeln!(text, "\nwritten to {}", output.display());
    text
}

fn row(row: &Row) -> String {
    let mut text = format!("  {:<20} {:>5}", row.name, row.cases);
    let number = |value: Option<f64>| value.map_or_else(|| "-".to_owned(), |v| format!("{v:.1}"));
    let percent = |share: Option<f64>| number(share.map(|c| 100.0 * c));
    for (spread, coverage, any, held) in [
        (row.first, row.coverage, row.any_height, row.any_height_held),
        (row.learned, row.learned_coverage, row.learned_any_height, row.learned_any_height_held),
    ] {
        for value in [spread.map(|s| s.median), spread.map(|s| s.p10), spread.map(|s| s.worst)] {
            let _ = write!(text, " {:>7}", number(value));
        }
        let any = number(any.map(|s| s.median));
        let _ = write!(text, " {:>7}% {any:>7} {:>7}%", percent(coverage), percent(held));
    }
    let _ = writeln!(text, " {:>8} {:>6}", row.failures + row.learn_failures, row.worse);
    text
}

/// The seeds of a request.
///
/// # Errors
/// `Y004` for more than the set has, or none.
fn seeds(options: &Options) -> Result<Range<u64>, Failure> {
    let (set, count) = options.seeds();
    let seeds = set.seeds();
    let most = seeds.end - seeds.start;
    if count == 0 || count > most {
        return Err(Y004.error(format!("{count} seeds"), format!("1 to {most}")).into());
    }
    Ok(seeds.start..seeds.start + count)
}

/// The cases of a request.
///
/// # Errors
/// `Y003` for a family that does not exist, `Y004` for more seeds than the set has.
pub fn cases(options: &Options) -> Result<Vec<CaseId>, Failure> {
    let unknown = |name: &str| {
        let names: Vec<&str> = FAMILIES.iter().map(|f| f.name).collect();
        Y003.error(format!("no family `{name}`"), format!("one of {}", names.join(", ")))
    };
    let chosen: Vec<&Family> = if options.families.is_empty() {
        FAMILIES.iter().collect()
    } else {
        let each = options.families.iter().map(|name| family(name).ok_or_else(|| unknown(name)));
        each.collect::<Result<_, _>>()?
    };
    let (set, seeds) = (options.seeds().0, seeds(options)?);
    let cells: Vec<Option<Cell>> = match options.axis {
        None => vec![None],
        Some(axis) => axis.values().iter().map(|&value| Some(Cell { axis, value })).collect(),
    };
    let mut nuisances: Vec<Option<Nuisance>> = options.nuisance.iter().copied().flatten().copied().collect();
    nuisances.sort_unstable();
    nuisances.dedup();
    let mut cases = Vec::new();
    for seed in seeds {
        // Random machines go round the families; otherwise every family gets every seed.
        let these = match set {
            Set::Random => vec![chosen[(seed % chosen.len() as u64) as usize]],
            Set::Tuning | Set::Test => chosen.clone(),
        };
        for family in these {
            for &nuisance in &nuisances {
                let name = |&cell: &Option<Cell>| CaseId {
                    family: family.name.to_owned(),
                    seed,
                    nuisance,
                    touches: options.touches,
                    cell,
                };
                cases.extend(cells.iter().map(name));
            }
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
    let mut ledger = CaseTable::open(options.out(), &key, options.force)?;
    let all = cases.len() as u64;
    let left: Vec<CaseId> = cases.into_iter().filter(|id| !ledger.finished.contains_key(&id.to_string())).collect();
    let mut finished = all - left.len() as u64;
    progress(finished, all);
    let carried = |id: &CaseId| workflow::outcome(id, options.first);
    parallel::for_each(&left, options.threads(), carried, |outcome| {
        finished += 1;
        progress(finished, all);
        ledger.append(outcome)
    })?;
    let outcomes: Vec<Outcome> = ledger.finished.into_values().collect();
    let summary = summary(&key, &outcomes);
    let write = |name: &str, bytes: &[u8]| -> Result<(), Failure> {
        let path = options.out().join(name);
        // These two always follow from the table beside them.
        let mut file = OutputFile::create(&path, true)?;
        file.write_all(bytes).map_err(|e| InputError::unwritable(&path, &e))?;
        Ok(file.commit()?)
    };
    write("summary.json", &json(&summary)?)?;
    write("study.html", page(&summary, &outcomes)?.as_bytes())?;
    if let Some(path) = &options.write {
        let goals = std::fs::read(options.out().join(GOALS)).ok();
        let reached: Vec<Reached> = goals.and_then(|bytes| serde_json::from_slice(&bytes).ok()).unwrap_or_default();
        let (marks, text) = if options.disturbed() {
            (NUISANCES, markdown::nuisances(&summary))
        } else {
            (RESULTS, markdown::results(&summary, &reached))
        };
        let text = written_into(&Source::read(path)?, marks, &text)?;
        let mut file = OutputFile::create(path, true)?;
        file.write_all(text.as_bytes()).map_err(|e| InputError::unwritable(path, &e))?;
        file.commit()?;
    }
    Ok(Studied { outcomes, summary })
}

/// The reference goals; writes `reference.json`. `progress` is told (finished, of) runs.
///
/// # Errors
/// `F003` for a folder that has results of an earlier run, unless they are to be dropped; outputs that cannot be written.
fn reference(options: &Options, progress: &mut dyn FnMut(u64, u64)) -> Result<Vec<Reached>, Failure> {
    let path = options.out().join(GOALS);
    std::fs::create_dir_all(options.out()).map_err(|e| InputError::unwritable(&path, &e))?;
    let mut file = OutputFile::create(&path, options.force)?;
    let reached = goals(options.seeds, options.threads(), progress)?;
    file.write_all(&json(&reached)?).map_err(|e| InputError::unwritable(&path, &e))?;
    file.commit()?;
    Ok(reached)
}
