//! Format, lints, documentation, tests and error codes of the workspace.

use crate::repository::{cargo, run};
use crate::step::{Outcome, Passed};

/// Formatting of every source file.
pub fn format(write: bool) -> Outcome {
    let mut command = cargo();
    command.args(["fmt", "--all"]);
    if !write {
        command.arg("--check");
    }
    run(&mut command)?;
    Ok(Passed::Done)
}

/// Clippy over all targets; a warning fails.
pub fn lint() -> Outcome {
    run(cargo().args(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))?;
    Ok(Passed::Done)
}

/// The documentation of the workspace's own packages; a warning fails.
pub fn doc() -> Outcome {
    run(cargo().args(["doc", "--workspace", "--no-deps"]).env("RUSTDOCFLAGS", "-D warnings"))?;
    Ok(Passed::Done)
}

/// What decides the random cases of property tests.
const SEED: &str = "PROPTEST_RNG_SEED";

/// The tests. Without arguments those of the whole workspace, and all of them even when one fails. Property tests take
/// the same cases on every repeat, other ones each time when `all` is wanted.
pub fn tests(all: bool, arguments: &[String]) -> Outcome {
    let mut command = cargo();
    command.arg("test");
    if !all && std::env::var_os(SEED).is_none() {
        command.env(SEED, "1");
    }
    if arguments.is_empty() {
        command.args(["--workspace", "--no-fail-fast"]);
    }
    run(command.args(arguments))?;
    Ok(Passed::Done)
}

/// docs/errors.md against the rows of the error codes; a test knows them all.
pub fn errors(write: bool) -> Outcome {
    let mut command = cargo();
    command.args(["test", "--quiet", "-p", "truepath-tests", "--test", "all", "errors::"]);
    if write {
        command.env("BLESS", "1");
    }
    run(&mut command)?;
    Ok(Passed::Done)
}
