//! Our reading of programs against LinuxCNC's, program by program.
//!
//! Nothing of LinuxCNC is part of this repository: the package is installed where it may be, its interpreter is run as
//! a program, and the files it ships are read where they lie.

mod corpus;
mod document;
mod expected;
mod five_axis;
mod mend;
mod outcome;
mod rule;
mod stream;
mod verdict;

use std::fs;
use std::sync::Mutex;
use std::sync::atomic::{AtomicUsize, Ordering};

use crate::repository::{self, Profile, program, read, root, succeeds, target};
use crate::step::{Failure, Outcome, Passed};
use crate::toolchain::need;
use corpus::{PACKAGE, Program};
use outcome::Bench;
use verdict::Verdict;

/// The document, from the root.
const DOCUMENT: &str = "docs/conformance.md";

/// Runs both interpreters over everything; writes the document or compares with it.
pub fn check(write: bool) -> Outcome {
    need(|| succeeds(program("sh").args(["-c", "command -v rs274"])), PACKAGE, "rs274 is missing")?;
    repository::truepath(Profile::Dev)?;
    five_axis::check()?;
    let programs = corpus::programs()?;
    let verdicts = judge(&programs)?;
    let version = read(program("dpkg-query").args(["-W", "-f", "${Version}", PACKAGE]))?;
    let text = document::document(&verdicts, version.trim());
    let details: String = verdicts
        .iter()
        .map(|v| {
            format!(
                "{:<26} {:<60} {:?} {:?} mended {:?}: {}\n",
                v.class.name(),
                v.name,
                v.rule,
                v.lack,
                v.mended,
                v.detail
            )
        })
        .collect();
    let listed = target().join("conformance/verdicts.txt");
    fs::write(&listed, details).map_err(|e| Failure::found(format!("{}: {e}", listed.display())))?;
    let counts = document::counts(&verdicts);
    let goals = document::goals(&verdicts);
    println!("{counts}");
    for goal in &goals {
        println!("{} {}: {}", if goal.reached { "reached" } else { "MISSED " }, goal.name, goal.stands);
    }
    let path = root().join(DOCUMENT);
    let expected = root().join(expected::FILE);
    if write {
        let recorded = expected::record(&programs, &verdicts)?;
        for (path, text) in [(&path, &text), (&expected, &recorded)] {
            fs::write(path, text).map_err(|e| Failure::found(format!("{}: {e}", path.display())))?;
        }
    }
    let missed: Vec<String> =
        goals.iter().filter(|g| !g.reached).map(|g| format!("{}: {}", g.name, g.stands)).collect();
    if !missed.is_empty() {
        return Err(Failure::found(format!(
            "goals missed; every verdict in {}\n{}",
            listed.display(),
            missed.join("\n")
        )));
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    if !committed.contains(&counts) {
        return Err(Failure::found(format!(
            "the counts are not those of {DOCUMENT}; look at them, then run with --write"
        )));
    }
    Ok(Passed::Done)
}

/// The verdicts in the order of the programs, found by as many workers as there are processors.
fn judge(programs: &[Program]) -> Result<Vec<Verdict>, Failure> {
    let workers = std::thread::available_parallelism().map_or(2, usize::from);
    let next = AtomicUsize::new(0);
    let found: Mutex<Vec<(usize, Verdict)>> = Mutex::new(Vec::new());
    let work = || -> Result<(), Failure> {
        loop {
            let index = next.fetch_add(1, Ordering::Relaxed);
            let Some(program) = programs.get(index) else { return Ok(()) };
            let verdict = Verdict::of(program, &Bench::new(index, program)?);
            found.lock().unwrap_or_else(std::sync::PoisonError::into_inner).push((index, verdict));
        }
    };
    std::thread::scope(|scope| {
        let running: Vec<_> = (0..workers).map(|_| scope.spawn(work)).collect();
        running.into_iter().try_for_each(|w| w.join().unwrap_or_else(|_| Err(Failure::found("a worker panicked"))))
    })?;
    let mut found = found.into_inner().unwrap_or_else(std::sync::PoisonError::into_inner);
    found.sort_by_key(|(index, _)| *index);
    Ok(found.into_iter().map(|(_, verdict)| verdict).collect())
}
