//! Mutation testing: mistakes put into the code of the servo and of the flash, one at a time, each of which a test of the same package
//! has to notice.
//!
//! cargo-mutants makes them, in a copy of the repository, as `.cargo/mutants.toml` and the profile `mutants` say. A mutant that no test
//! notices fails the check, unless `docs/mutants.md` has it with the reason why it does not matter. It is known there by its file and
//! what was changed, not by its line, which moves.

use std::collections::BTreeSet;
use std::path::Path;

use crate::repository::{cargo, make_folder, root, succeeds, target};
use crate::step::{Failure, Outcome, Passed};

/// What is mutated: a folder and the package whose tests are run.
const FOLDERS: [(&str, &str); 5] = [
    ("core/wire/src/rewrite", "truepath-wire"),
    ("core/wire/src/link", "truepath-wire"),
    ("core/wire/src/image", "truepath-wire"),
    ("firmware/src/ledger", "truepath-fw"),
    ("firmware/src/slots", "truepath-fw"),
];

/// What became of the mutants of a folder.
#[derive(Debug)]
struct Tally {
    killed: usize,
    unviable: usize,
    timed_out: usize,
    survived: Vec<Mutant>,
}

/// A mutant: its file, the place in it, and what was changed.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord)]
struct Mutant {
    file: String,
    place: String,
    change: String,
}

impl Mutant {
    /// `core/wire/src/rewrite/limit.rs:40:12: replace > with >= in Limits::step`
    fn read(line: &str) -> Option<Self> {
        let (place, change) = line.split_once(": ")?;
        let (file, place) = place.split_once(':')?;
        Some(Self { file: file.to_owned(), place: place.to_owned(), change: change.to_owned() })
    }
    /// What it is known by in the document.
    fn name(&self) -> (String, String) {
        (self.file.clone(), self.change.clone())
    }
}

/// Mutates the folders whose names hold a text, or all of them; `shard` is `k/n`, one part of so many.
pub fn check(only: Option<&str>, shard: Option<&str>) -> Outcome {
    let chosen = FOLDERS.iter().filter(|(folder, _)| only.is_none_or(|text| folder.contains(text)));
    let chosen: Vec<_> = chosen.collect();
    if chosen.is_empty() {
        let folders = FOLDERS.map(|(folder, _)| folder).join(", ");
        return Err(Failure::found(format!("no such folder; there are {folders}")));
    }
    if !succeeds(cargo().args(["mutants", "--version"])) {
        let way = "cargo install cargo-mutants --locked";
        return Err(Failure::Missing(format!("mutations are made by cargo-mutants: {way}")));
    }
    let explained = explained()?;
    let mut unexplained = Vec::new();
    println!("{:<24} {:>8} {:>9} {:>9} {:>10}", "folder", "killed", "survived", "unviable", "timed out");
    for (folder, package) in chosen {
        let Tally { killed, unviable, timed_out, survived } = mutate(folder, package, shard)?;
        println!("{folder:<24} {killed:>8} {:>9} {unviable:>9} {timed_out:>10}", survived.len());
        unexplained.extend(survived.into_iter().filter(|mutant| !explained.contains(&mutant.name())));
    }
    if unexplained.is_empty() {
        return Ok(Passed::Done);
    }
    let lines: Vec<String> = unexplained.iter().map(|m| format!("{}:{}: {}", m.file, m.place, m.change)).collect();
    let way = "add a test of the rule that it breaks, or a row to docs/mutants.md that says why it breaks none";
    Err(Failure::found(format!("{} mutants that no test notices; {way}:\n{}", lines.len(), lines.join("\n"))))
}

fn mutate(folder: &str, package: &str, shard: Option<&str>) -> Result<Tally, Failure> {
    let out = target().join("mutants").join(folder.replace('/', "-"));
    make_folder(&out)?;
    let mut command = cargo();
    command.args(["mutants", "--package", package, "--file"]).arg(format!("{folder}/**")).arg("--output").arg(&out);
    if let Some(shard) = shard {
        // Every n-th, so that a part is of all files.
        command.args(["--sharding", "round-robin", "--shard", shard]);
    }
    // A property that fails is enough: its smallest example is looked for by nobody here, and takes longer than the time-out.
    command.env("PROPTEST_MAX_SHRINK_ITERS", "0");
    let status = command.status().map_err(|e| Failure::Missing(format!("cargo mutants: {e}")))?;
    // 2: some survived, 3: some timed out; the files say which.
    if !matches!(status.code(), Some(0 | 2 | 3)) {
        return Err(Failure::found(format!("{status}: cargo mutants; its log is in {}", out.display())));
    }
    let lines = |name: &str| listed(&out.join("mutants.out").join(name));
    Ok(Tally {
        killed: lines("caught.txt")?.len(),
        unviable: lines("unviable.txt")?.len(),
        timed_out: lines("timeout.txt")?.len(),
        survived: lines("missed.txt")?.iter().filter_map(|line| Mutant::read(line)).collect(),
    })
}

fn listed(file: &Path) -> Result<Vec<String>, Failure> {
    let text = std::fs::read_to_string(file).map_err(|e| Failure::found(format!("{}: {e}", file.display())))?;
    Ok(text.lines().map(str::to_owned).collect())
}

/// The mutants of the document, by file and change.
fn explained() -> Result<BTreeSet<(String, String)>, Failure> {
    let document = root().join("docs/mutants.md");
    let text = listed(&document)?;
    Ok(text.iter().filter_map(|line| row(line)).map(|[file, change, _]| (file, change)).collect())
}

/// A row of the table: `` | `file` | `change` | why | ``. What was changed may hold `|`, written `\|`.
fn row(line: &str) -> Option<[String; 3]> {
    let cells = line.replace("\\|", "\u{0}");
    let cells: Vec<String> = cells.split('|').map(|cell| cell.trim().replace('\u{0}', "|")).collect();
    let [_, file, change, why, _] = cells.as_slice() else { return None };
    let quoted = |cell: &str| Some(cell.strip_prefix('`')?.strip_suffix('`')?.to_owned());
    Some([quoted(file)?, quoted(change)?, why.clone()])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_folder_is_there_and_every_row_of_the_document_names_a_file_and_a_reason() {
        for (folder, _) in FOLDERS {
            assert!(root().join(folder).is_dir(), "{folder}");
        }
        let rows: Vec<_> = listed(&root().join("docs/mutants.md")).unwrap().iter().filter_map(|l| row(l)).collect();
        assert!(!rows.is_empty());
        for [file, change, why] in rows {
            assert!(
                root().join(&file).is_file() && FOLDERS.iter().any(|(folder, _)| file.starts_with(folder)),
                "{file}"
            );
            assert!(why.len() > 20, "{file}: {change} has no reason");
        }
    }

    #[test]
    fn a_mutant_is_known_by_file_and_change_wherever_it_stands() {
        let line = "core/wire/src/rewrite/limit.rs:40:12: replace || with && in Limits::step";
        let mutant = Mutant::read(line).unwrap();
        assert_eq!(mutant.place, "40:12");
        let [file, change, _] =
            row("| `core/wire/src/rewrite/limit.rs` | `replace \\|\\| with && in Limits::step` | why |").unwrap();
        assert_eq!(mutant.name(), (file, change));
        assert_eq!(row("| folder | killed | survived |"), None);
    }
}
