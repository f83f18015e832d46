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

/// Start of the names of tests that others call in a process of their own.
const CHILD: &str = "child_";
/// Start of the names of tests that make a table of a document anew, minutes each; a test beside each of them takes some of its cases.
const CAMPAIGN: &str = "campaign_";

/// The tests. Without arguments those of the whole workspace, and all of them even when one fails. With `all` also those
/// that are ignored for being slow, campaigns left out, and other cases of the property tests on every repeat.
pub fn tests(all: bool, arguments: &[String]) -> Outcome {
    let mut command = cargo();
    command.arg("test");
    if !all && std::env::var_os(SEED).is_none() {
        command.env(SEED, "1");
    }
    if arguments.is_empty() {
        command.args(["--workspace", "--no-fail-fast"]);
    }
    command.args(arguments);
    if all {
        if !arguments.iter().any(|argument| argument == "--") {
            command.arg("--");
        }
        command.args(["--include-ignored", "--skip", CHILD, "--skip", CAMPAIGN]);
    }
    run(&mut command)?;
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

/// docs/job.md against what the readers of a job ask for; a test knows them all.
pub fn job_keys(write: bool) -> Outcome {
    let mut command = cargo();
    command.args(["test", "--quiet", "-p", "truepath-job", "--test", "all", "keys::"]);
    if write {
        command.env("BLESS", "1");
    }
    run(&mut command)?;
    Ok(Passed::Done)
}
