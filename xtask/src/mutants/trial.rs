//! One build of all mutants of a folder, and its tests with one of them chosen after the other.
//!
//! The repository is copied, the mutants are woven into the copy, and those that do not compile are taken out again. Then only tests run.

use std::collections::{BTreeMap, BTreeSet};
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::ops::Range;
use std::os::unix::process::ExitStatusExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

use serde_json::Value;

use super::mutant::{End, Mutant};
use super::weave::{CHOICE, FEATURES, Woven, weave};
use crate::repository::{cargo, program, read, root, target, write};
use crate::step::Failure;

/// Builds at most: each takes out what the compiler did not like in the one before.
const BUILDS: usize = 12;
/// What the tests do not run, as in `.cargo/mutants.toml`.
pub const SKIPPED: [&str; 2] =
    ["a_million_random_streams_never_leave_the_limits", "no_sequence_of_five_events_from_any_state_breaks_a_rule"];
/// Kilobytes that the tests may take: a mutant that goes round for ever may also fill the memory.
const MEMORY: u32 = 4_000_000;
/// The signal of a process whose time has run out.
const OUT_OF_TIME: i32 = 24;

/// Tests with all mutants in them.
#[derive(Debug)]
pub struct Trial {
    /// Numbers of the mutants that are in it, and whether each is in a `const fn`.
    pub held: BTreeMap<usize, bool>,
    /// The quickest tests first.
    rounds: Vec<Round>,
}

/// A test program.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Tests {
    program: PathBuf,
    /// Where cargo would run it.
    folder: PathBuf,
}

/// Some tests of a program.
#[derive(Debug)]
struct Round {
    tests: Tests,
    names: Vec<String>,
    /// Seconds of a processor after which they go round for ever.
    limit: u64,
}

/// An error of the compiler.
#[derive(Debug, PartialEq, Eq)]
struct Wrong {
    /// Files and places in them, in bytes.
    places: Vec<(String, Range<usize>)>,
    text: String,
}

impl Wrong {
    /// The mutants that it is about.
    fn blamed(&self, woven: &BTreeMap<String, Woven>) -> BTreeSet<usize> {
        let here = |file| self.places.iter().filter(move |(name, _)| name == file).map(|(_, range)| range.clone());
        woven.iter().flat_map(|(file, woven)| woven.blamed(&here(file).collect::<Vec<_>>())).collect()
    }
}

impl Trial {
    /// Builds the tests of a package with mutants of a folder in `src`, which are numbered from 1; if `quick` without the long tests.
    ///
    /// # Errors
    /// When they cannot be built or fail without any mutant.
    pub fn build(folder: &str, package: &str, mutants: &[Mutant], quick: bool) -> Result<Self, Failure> {
        copy_repository()?;
        let mut out = BTreeSet::new();
        for _ in 0..BUILDS {
            let woven = weave_all(folder, mutants, &out)?;
            let errors = match compile(package)? {
                Ok(tests) => {
                    let held = woven.values().flat_map(|w| &w.held).map(|(number, held)| (*number, held.constant));
                    return Ok(Self { held: held.collect(), rounds: rounds(&tests, quick)? });
                }
                Err(errors) => errors,
            };
            let blamed: BTreeSet<_> = errors.iter().flat_map(|error| error.blamed(&woven)).collect();
            if blamed.is_empty() {
                let said: Vec<_> = errors.into_iter().map(|error| error.text).take(3).collect();
                return Err(Failure::found(said.join("\n")));
            }
            out.extend(blamed);
        }
        Err(Failure::found(format!("{folder}: {BUILDS} builds, and still mutants that do not compile")))
    }

    /// Judges all mutants in it, as many at a time as there are processors: number and end of each.
    ///
    /// # Errors
    /// When a test program cannot be started.
    pub fn judge(&self, mutants: &[Mutant]) -> Result<Vec<(usize, End)>, Failure> {
        let numbers = Mutex::new(self.held.keys().copied());
        let next = || numbers.lock().unwrap_or_else(PoisonError::into_inner).next();
        let worker = || {
            let mut ended = Vec::new();
            while let Some(number) = next() {
                let end = self.end(number)?;
                if end != End::Killed {
                    eprintln!("    {end:?}: {}", mutants[number - 1].name);
                }
                ended.push((number, end));
            }
            Ok(ended)
        };
        let processors = std::thread::available_parallelism().map_or(1, usize::from);
        std::thread::scope(|scope| {
            let workers: Vec<_> = (0..processors).map(|_| scope.spawn(worker)).collect();
            let ended = workers.into_iter().map(|worker| worker.join().expect("a worker does not panic"));
            Ok(ended.collect::<Result<Vec<_>, Failure>>()?.concat())
        })
    }

    fn end(&self, number: usize) -> Result<End, Failure> {
        for round in &self.rounds {
            let end = round.run(number)?;
            if end != End::Survived {
                return Ok(end);
            }
        }
        Ok(End::Survived)
    }
}

impl Tests {
    /// Its command with a mutant, one test after the other, within seconds of a processor.
    fn command(&self, number: usize, limit: u64) -> Command {
        let limits = format!("ulimit -c 0; ulimit -v {MEMORY}; ulimit -S -t {limit}; exec \"$0\" \"$@\"");
        let mut command = program("sh");
        command.args(["-c", &limits]).arg(&self.program).args(["--test-threads", "1"]);
        command.current_dir(&self.folder).env("CARGO_MANIFEST_DIR", &self.folder).env("MUTANT", number.to_string());
        // A property that fails is enough: nobody looks for its smallest example, or for it in the next run.
        command.env("PROPTEST_MAX_SHRINK_ITERS", "0").env("PROPTEST_DISABLE_FAILURE_PERSISTENCE", "true");
        command
    }
    fn failed(&self, e: &std::io::Error) -> Failure {
        Failure::found(format!("{}: {e}", self.program.display()))
    }
    /// Runs all of it without a mutant: every test, and how long it takes.
    fn timed(&self) -> Result<Vec<(Duration, String)>, Failure> {
        let mut command = self.command(0, 3600);
        command.args(SKIPPED.iter().flat_map(|name| ["--skip", name]));
        let mut child = command.stdout(Stdio::piped()).stderr(Stdio::null()).spawn().map_err(|e| self.failed(&e))?;
        let (mut timed, mut last) = (Vec::new(), Instant::now());
        for line in child.stdout.take().into_iter().flat_map(|said| BufReader::new(said).lines()).map_while(Result::ok)
        {
            let ended = line.strip_prefix("test ").and_then(|line| line.strip_suffix(" ... ok"));
            timed.extend(ended.map(|name| (last.elapsed(), name.to_owned())));
            last = Instant::now();
        }
        let whole = child.wait().map_err(|e| self.failed(&e))?.success();
        let failed = || Failure::found(format!("{} fails without a mutant", self.program.display()));
        if whole { Ok(timed) } else { Err(failed()) }
    }
}

/// What runs together: of each program the tests that take no time, then those that take some; each long one alone, not if `quick`.
fn rounds(programs: &[Tests], quick: bool) -> Result<Vec<Round>, Failure> {
    const NO_TIME: Duration = Duration::from_millis(100);
    const SOME: Duration = Duration::from_secs(1);
    let (mut rounds, mut long) = (Vec::new(), Vec::new());
    for tests in programs {
        let timed = tests.timed()?;
        let round = |of: Vec<&(Duration, String)>| {
            let time: Duration = of.iter().map(|(time, _)| *time).sum();
            let names = of.into_iter().map(|(_, name)| name.clone()).collect();
            (time, Round { tests: tests.clone(), names, limit: 5 + 4 * time.as_secs() })
        };
        for times in [Duration::ZERO..NO_TIME, NO_TIME..SOME] {
            rounds.push(round(timed.iter().filter(|(time, _)| times.contains(time)).collect()));
        }
        long.extend(timed.iter().filter(|(time, _)| *time >= SOME && !quick).map(|test| round(vec![test])));
    }
    rounds.extend(long);
    rounds.retain(|(_, round)| !round.names.is_empty());
    rounds.sort_by_key(|(time, _)| *time);
    Ok(rounds.into_iter().map(|(_, round)| round).collect())
}

impl Round {
    /// Runs them until one fails.
    fn run(&self, number: usize) -> Result<End, Failure> {
        let mut command = self.tests.command(number, self.limit);
        first_failure(command.arg("--exact").args(&self.names)).map_err(|e| self.tests.failed(&e))
    }
}

/// Runs a test program until it says that a test failed, or to its end.
fn first_failure(command: &mut Command) -> std::io::Result<End> {
    let mut child = command.stdin(Stdio::null()).stdout(Stdio::piped()).stderr(Stdio::null()).spawn()?;
    let said = child.stdout.take().map(BufReader::new);
    let failed = said.is_some_and(|said| said.lines().map_while(Result::ok).any(|line| line.ends_with("... FAILED")));
    if failed {
        child.kill()?;
    }
    let status = child.wait()?;
    Ok(match status.signal() {
        _ if failed => End::Killed,
        Some(OUT_OF_TIME) => End::TimedOut,
        _ if status.success() => End::Survived,
        _ => End::Killed,
    })
}

/// Where the copy is.
fn copy() -> PathBuf {
    target().join("mutants/copy")
}

/// Copies what belongs to the repository; what has not changed keeps its time, and is not built again.
fn copy_repository() -> Result<(), Failure> {
    let names = read(program("git").args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"]))?;
    for name in names.split_terminator('\0') {
        if let Ok(bytes) = fs::read(root().join(name)) {
            renew(&copy().join(name), &bytes)?;
        }
    }
    Ok(())
}

fn renew(file: &Path, bytes: &[u8]) -> Result<(), Failure> {
    if fs::read(file).is_ok_and(|there| there == bytes) { Ok(()) } else { write(file, bytes) }
}

/// Weaves the mutants, but those that are out, into the files of the copy.
fn weave_all(folder: &str, mutants: &[Mutant], out: &BTreeSet<usize>) -> Result<BTreeMap<String, Woven>, Failure> {
    let text = |file: &str| fs::read_to_string(root().join(file)).map_err(|e| Failure::found(format!("{file}: {e}")));
    let mut of = BTreeMap::<&str, Vec<(usize, &Mutant)>>::new();
    for (number, mutant) in (1..).zip(mutants) {
        let in_file = of.entry(&mutant.file).or_default();
        in_file.extend((!out.contains(&number)).then_some((number, mutant)));
    }
    let mut all = BTreeMap::new();
    for (file, mutants) in of {
        let woven = weave(&text(file)?, mutants).map_err(|e| Failure::found(format!("{file}:{e}")))?;
        renew(&copy().join(file), woven.text.as_bytes())?;
        all.insert(file.to_owned(), woven);
    }
    let library = folder.split_inclusive("src/").next().unwrap_or(folder).to_owned() + "lib.rs";
    renew(&copy().join(&library), format!("{FEATURES}{}{CHOICE}", text(&library)?).as_bytes())?;
    Ok(all)
}

/// Builds the tests of a package in the copy: them, or what is wrong.
fn compile(package: &str) -> Result<Result<Vec<Tests>, Vec<Wrong>>, Failure> {
    let mut command = cargo();
    command.current_dir(copy()).args(["test", "--package", package, "--lib", "--tests", "--no-run"]);
    // Built once and run some hundred times.
    let optimised = format!("profile.dev.package.{package}.opt-level=1");
    command
        .args(["--config", &optimised, "--message-format", "json", "--target-dir"])
        .arg(target().join("mutants/build"));
    // The features of a nightly compiler, for these alone; the same for all, as the build scripts of others look at it.
    command.env("RUSTC_BOOTSTRAP", "truepath_wire,truepath_fw");
    let output = command.stdin(Stdio::null()).output().map_err(|e| Failure::Missing(format!("cargo test: {e}")))?;
    let said = String::from_utf8_lossy(&output.stdout);
    let said: Vec<Value> = said.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    if output.status.success() {
        return Ok(Ok(said.iter().filter_map(tests).collect()));
    }
    let errors: Vec<_> = said.iter().filter(|said| said["message"]["level"] == "error").map(error).collect();
    if errors.is_empty() { Err(Failure::found(String::from_utf8_lossy(&output.stderr))) } else { Ok(Err(errors)) }
}

/// A test program, in cargo's message of what it has built.
fn tests(said: &Value) -> Option<Tests> {
    let program = PathBuf::from(said["executable"].as_str()?);
    Some(Tests { program, folder: Path::new(said["manifest_path"].as_str()?).parent()?.to_owned() })
}

/// The places of an error and its text, in cargo's message of what the compiler said.
fn error(said: &Value) -> Wrong {
    let place = |span: &Value| {
        let byte = |key: &str| usize::try_from(span[key].as_u64()?).ok();
        // One byte at least: an error may be between two.
        let start = byte("byte_start")?;
        Some((span["file_name"].as_str()?.to_owned(), start..byte("byte_end")?.max(start + 1)))
    };
    let spans = said["message"]["spans"].as_array().map_or(&[][..], Vec::as_slice);
    let text = said["message"]["rendered"].as_str().unwrap_or_default().to_owned();
    Wrong { places: spans.iter().filter_map(place).collect(), text }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn verdict(script: &str) -> End {
        first_failure(Command::new("sh").args(["-c", script])).unwrap()
    }

    #[test]
    fn a_program_ends_with_its_first_failure_and_by_its_time() {
        assert_eq!(verdict("echo test a ... ok"), End::Survived);
        assert_eq!(verdict("echo 'test a ... FAILED'; exec sleep 60"), End::Killed);
        assert_eq!(verdict("exit 101"), End::Killed);
        assert_eq!(verdict("kill -XCPU $$"), End::TimedOut);
    }

    #[test]
    fn an_error_of_the_compiler_has_its_places() {
        let said = serde_json::json!({ "reason": "compiler-message", "message": { "level": "error", "rendered": "no",
            "spans": [{ "file_name": "src/lib.rs", "byte_start": 7, "byte_end": 7 }] } });
        assert_eq!(error(&said), Wrong { places: vec![("src/lib.rs".to_owned(), 7..8)], text: "no".to_owned() });
    }

    #[test]
    fn the_same_tests_are_left_out_as_by_cargo_mutants() {
        let configuration = fs::read_to_string(root().join(".cargo/mutants.toml")).unwrap();
        assert_eq!(configuration.matches("\"--skip\"").count(), SKIPPED.len());
        assert!(SKIPPED.iter().all(|name| configuration.contains(&format!("\"{name}\""))));
    }
}
