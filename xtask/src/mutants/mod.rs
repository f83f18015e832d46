//! Mutation testing: mistakes put into the code of the servo and of the flash, one at a time, each of which a test of the same package
//! has to notice.
//!
//! cargo-mutants says which. Those that one build can hold are judged in it all, the others by cargo-mutants, in a build for each; what
//! is run stands in `.cargo/mutants.toml` and the profile `mutants`. A mutant that no test notices fails the check, unless
//! `docs/mutants.md` has it with the reason why it does not matter. It is known there by its file and what was changed, not by its line,
//! which moves.

mod mutant;
mod slow;
mod trial;
mod weave;

use std::collections::BTreeSet;

use crate::repository::{cargo, lines, root, succeeds};
use crate::step::{Failure, Outcome, Passed};
use mutant::{End, Mutant, list};
use trial::Trial;

/// What is mutated: a folder and the package whose tests are run.
const FOLDERS: [(&str, &str); 5] = [
    ("core/wire/src/rewrite", "truepath-wire"),
    ("core/wire/src/link", "truepath-wire"),
    ("core/wire/src/image", "truepath-wire"),
    ("firmware/src/ledger", "truepath-fw"),
    ("firmware/src/slots", "truepath-fw"),
];

/// Mutates the folders whose names hold a text, or all of them; with `quick` only what one build holds.
pub fn check(only: Option<&str>, quick: bool) -> Outcome {
    let chosen: Vec<_> = FOLDERS.iter().filter(|(folder, _)| only.is_none_or(|text| folder.contains(text))).collect();
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
    let mut table =
        format!("{:<24}{}\n", "folder", row_of(["mutants", "killed", "survived", "unviable", "timed out", "not run"]));
    for (folder, package) in chosen {
        let mutants = list(folder, package)?;
        let ends = judged(folder, package, &mutants, quick)?;
        table += &format!("{folder:<24}{}\n", figures(&ends));
        let survivors = mutants.into_iter().zip(ends).filter(|(_, end)| *end == Some(End::Survived));
        unexplained
            .extend(survivors.map(|(mutant, _)| mutant).filter(|mutant| !explained.contains(&mutant.known_by())));
    }
    println!("{}", table.trim_end());
    if unexplained.is_empty() {
        return Ok(Passed::Done);
    }
    let lines: Vec<String> = unexplained.into_iter().map(|mutant| mutant.name).collect();
    let way = "add a test of the rule that it breaks, or a row to docs/mutants.md that says why it breaks none";
    Err(Failure::found(format!("{} mutants that no test notices; {way}:\n{}", lines.len(), lines.join("\n"))))
}

/// How the mutants of a folder end; none of those that were not run.
fn judged(folder: &str, package: &str, mutants: &[Mutant], quick: bool) -> Result<Vec<Option<End>>, Failure> {
    let mut ends = vec![None; mutants.len()];
    let trial = Trial::build(folder, package, mutants, quick)?;
    eprintln!("    {folder}: {} of {} mutants in one build", trial.held.len(), mutants.len());
    for (number, end) in trial.judge(mutants)? {
        // In a `const fn` what survives may be part of a constant, which is as it was.
        let in_doubt = end == End::Survived && trial.held[&number];
        ends[number - 1] = (!in_doubt).then_some(end);
    }
    if !quick {
        slow::judge(folder, package, mutants, &mut ends)?;
    }
    Ok(ends)
}

/// How many there are, how many ended in each way, and how many have not.
fn figures(ends: &[Option<End>]) -> String {
    let count = |wanted| ends.iter().filter(|end| **end == wanted).count();
    let [killed, survived, unviable, late] = End::ALL.map(|end| count(Some(end)));
    row_of([ends.len(), killed, survived, unviable, late, count(None)].map(|n| n.to_string()))
}

fn row_of(cells: [impl std::fmt::Display; 6]) -> String {
    cells.map(|cell| format!("{cell:>11}")).concat()
}

/// The mutants of the document, by file and change.
fn explained() -> Result<BTreeSet<(String, String)>, Failure> {
    let text = lines(&root().join("docs/mutants.md"))?;
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
        let rows: Vec<_> = lines(&root().join("docs/mutants.md")).unwrap().iter().filter_map(|l| row(l)).collect();
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
        let [file, change, _] =
            row("| `core/wire/src/rewrite/limit.rs` | `replace \\|\\| with && in Limits::step` | why |").unwrap();
        assert_eq!(mutant.known_by(), (file, change));
        assert_eq!(row("| folder | killed | survived |"), None);
    }

    #[test]
    fn what_has_not_ended_was_not_run() {
        let ends = [Some(End::Killed), None, Some(End::Survived), Some(End::Killed)];
        assert_eq!(figures(&ends).split_whitespace().collect::<Vec<_>>(), ["4", "2", "1", "0", "0", "1"]);
    }
}
