//! Programs as shops write them, each the whole way: places to touch, touches on the virtual machine, correction, and the
//! corrected program cut on the same machine.
//!
//! The programs lie in `tests/data/shop` with a table, `programs.csv`, that says of each what a machinist knows (wall side,
//! allowance, cutter) and what Truepath is not told: on which lines the wall is made. The virtual machine mills what the table
//! says; what Truepath took for the contour does not change it.

mod document;
mod table;
mod wall;
mod way;

use std::collections::BTreeMap;
use std::fs;
use std::path::Path;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::repository::{self, Profile, root, target};
use crate::step::{Failure, Outcome, Passed};
use table::Program;
use way::{End, Way};

/// The programs of this repository, from the root.
const FOLDER: &str = "tests/data/shop";
/// What became of them, from the root.
const DOCUMENT: &str = "docs/shop.md";
/// The table in the folder.
const TABLE: &str = "programs.csv";

/// Takes the programs of a folder the whole way. Those of this repository are compared with what the table expects, or the
/// expectations renewed; of any other folder the results are only shown.
pub fn check(folder: Option<&Path>, only: Option<&str>, write: bool) -> Outcome {
    repository::truepath(Profile::Dev)?;
    let own = root().join(FOLDER);
    let folder = folder.map_or(own.clone(), |f| root().join(f));
    let path = folder.join(TABLE);
    let text = fs::read_to_string(&path).map_err(|e| Failure::found(format!("{}: {e}", path.display())))?;
    let all = table::read(&text).map_err(|e| Failure::found(format!("{}: {e}", path.display())))?;
    let programs: Vec<&Program> = all.iter().filter(|p| only.is_none_or(|only| p.file.contains(only))).collect();
    let ways = walk(&folder, &programs)?;
    let results: Vec<(&Program, &Way)> = programs.iter().copied().zip(&ways).collect();
    let shown = document::table(&results) + "\n" + &document::refusals(&results);
    let listed = target().join("shop/results.txt");
    fs::write(&listed, &shown).map_err(|e| Failure::found(format!("{}: {e}", listed.display())))?;
    println!("{shown}");
    if write {
        let ends: BTreeMap<&str, &End> = results.iter().map(|(p, w)| (p.file.as_str(), &w.bare.end)).collect();
        let renewed = table::renewed(&text, |file| ends.get(file).map(|end| end.word()));
        fs::write(&path, renewed).map_err(|e| Failure::found(format!("{}: {e}", path.display())))?;
        if folder == own && only.is_none() {
            let document = root().join(DOCUMENT);
            fs::write(&document, document::document(&results))
                .map_err(|e| Failure::found(format!("{}: {e}", document.display())))?;
        }
        return verdict(&results, |_, way| way.bare.end.is_fault());
    }
    verdict(&results, |program, way| way.bare.end.is_fault() || way.bare.end.is_worse_than(&program.expected))
}

/// Fails when one of the results is as bad as that.
fn verdict(results: &[(&Program, &Way)], bad: impl Fn(&Program, &Way) -> bool) -> Outcome {
    let bad: Vec<String> = results
        .iter()
        .filter(|(program, way)| bad(program, way))
        .map(|(program, way)| {
            format!("{}: {}, expected {}; {}", program.file, way.bare.end.word(), program.expected, way.bare.said)
        })
        .collect();
    if bad.is_empty() { Ok(Passed::Done) } else { Err(Failure::found(bad.join("\n"))) }
}

/// Every program the whole way, by as many workers as there are processors.
fn walk(folder: &Path, programs: &[&Program]) -> Result<Vec<Way>, Failure> {
    let workers = std::thread::available_parallelism().map_or(2, usize::from);
    let next = AtomicUsize::new(0);
    let found: Mutex<BTreeMap<usize, Way>> = Mutex::new(BTreeMap::new());
    let work = || -> Result<(), Failure> {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(program) = programs.get(index) else { return Ok(()) };
            let way = Way::of(folder, program)?;
            eprintln!("    {:<44} {}", program.file, way.bare.end.word());
            found.lock().unwrap_or_else(std::sync::PoisonError::into_inner).insert(index, way);
        }
    };
    std::thread::scope(|scope| {
        let running: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        running.into_iter().try_for_each(|w| w.join().unwrap_or_else(|_| Err(Failure::found("a worker panicked"))))
    })?;
    Ok(found.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner).into_values().collect())
}
