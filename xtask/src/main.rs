//! Set-up, tests and checks of the Truepath repository: `cargo xtask test` is all of them.
//!
//! Every check is a step that announces itself. Exit codes: 0 passed, 1 a step failed, 2 wrong command line, 3 a tool
//! is missing and could not be installed.

mod bench;
mod checks;
mod device;
mod judge;
mod repository;
mod step;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use step::{Report, Step};

/// Set-up, tests and checks of the Truepath repository.
#[derive(Debug, Parser)]
#[command(name = "cargo xtask", bin_name = "cargo xtask", arg_required_else_help = true)]
struct Arguments {
    #[command(subcommand)]
    task: Task,
}

#[derive(Debug, Subcommand)]
enum Task {
    /// Everything a change has to pass: fmt, lint, doc, device, test-only.
    Test,
    /// Formatting of every source file.
    Fmt {
        /// Rewrite the files instead of comparing them.
        #[arg(long)]
        write: bool,
    },
    /// Clippy over all targets; a warning fails.
    Lint,
    /// The documentation, without warnings.
    Doc,
    /// The tests of all packages, examples in the documentation included.
    TestOnly {
        /// Handed to `cargo test`, for instance `-p truepath-core engagement`.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Builds the core for the microcontroller and checks what is in it.
    Device,
    /// Time (criterion) or instructions (callgrind) of the kernels of the core.
    Bench {
        /// Count instructions with valgrind instead of measuring time.
        #[arg(long)]
        count: bool,
        /// Write the table into docs/measure.md.
        #[arg(long)]
        write: bool,
        /// Without --count: only build the benchmarks.
        #[arg(long, conflicts_with_all = ["count", "write"])]
        no_run: bool,
        /// Without --count: handed to criterion, for instance a part of a benchmark's name.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Corrects the parts of an independent machine program and has it score them.
    Judge {
        /// The program that makes and scores parts, relative to the repository; its scenarios lie in `scenarios`
        /// beside it. By default `judge/judge.py` in a folder beside the repository.
        #[arg(long)]
        judge: Option<PathBuf>,
    },
}

fn main() -> ExitCode {
    let mut report = Report::default();
    match Arguments::parse().task {
        Task::Test => {
            report.run(Step::new("fmt", || checks::format(false)));
            report.run(Step::new("lint", checks::lint));
            report.run(Step::new("doc", checks::doc));
            report.run(Step::new("device", device::check));
            report.run(Step::new("test-only", || checks::tests(&[])));
        }
        Task::Fmt { write } => report.run(Step::new("fmt", || checks::format(write))),
        Task::Lint => report.run(Step::new("lint", checks::lint)),
        Task::Doc => report.run(Step::new("doc", checks::doc)),
        Task::TestOnly { arguments } => report.run(Step::new("test-only", || checks::tests(&arguments))),
        Task::Device => report.run(Step::new("device", device::check)),
        Task::Bench { count: true, write, .. } => report.run(Step::new("bench --count", || bench::count(write))),
        Task::Bench { no_run, write, arguments, .. } => {
            report.run(Step::new("bench", || bench::time(no_run, write, &arguments)))
        }
        Task::Judge { judge } => report.run(Step::new("judge", || judge::run_all(judge.as_deref()))),
    }
    report.finish()
}
