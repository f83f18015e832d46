//! Set-up, tests and checks of the Truepath repository: `cargo xtask test` is what a change has to pass, `cargo xtask
//! test --all` is everything.
//!
//! Every check is a step that announces itself. Exit codes: 0 passed, 1 a step failed, 2 wrong command line, 3 a tool
//! is missing and could not be installed.

mod aarch64;
mod bench;
mod checks;
mod conformance;
mod cost;
mod device;
mod dist;
mod features;
mod firmware;
mod fuzz;
mod hil;
mod judge;
mod linuxcnc;
mod mutants;
mod page;
mod repository;
mod rooms;
mod shop;
mod step;
mod table;
mod toolchain;
mod web;
mod wheel;

use std::path::PathBuf;
use std::process::ExitCode;

use clap::{Parser, Subcommand};

use firmware::Board;
use repository::Profile;
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
    /// What a change has to pass; with --all everything there is.
    ///
    /// fmt, rooms, test-only and features: what needs nothing but Rust, the same on every repeat. With --all also the slow tests,
    /// other random cases each time, budget, hil, page, web, linuxcnc, conformance, dist, shop, judge and fuzz; beside them firmware
    /// (both boards), elf, device, bench, lint and doc. Campaigns, tests that make a table of a document anew, are run by name.
    Test {
        /// Also what takes long.
        #[arg(long)]
        all: bool,
    },
    /// Those steps of `test --all` that only build and compute.
    #[command(hide = true)]
    Builds,
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
        /// Also the slow ones, and other random cases on every repeat.
        #[arg(long)]
        all: bool,
        /// Handed to `cargo test`, for instance `-p truepath-core engagement`.
        #[arg(trailing_var_arg = true, allow_hyphen_values = true)]
        arguments: Vec<String>,
    },
    /// Imports between crates and modules: none in a circle, none against the order of the README's diagram.
    Rooms {
        /// Name every import of a circle instead of the first few.
        #[arg(long)]
        all: bool,
        /// Only what holds this text, for instance `truepath::job` or `src/plot`.
        part: Option<String>,
    },
    /// Features of crates: the same for the program and for its tests, so that nothing is built twice.
    Features,
    /// The error codes: unique, and docs/errors.md as they are.
    Errors {
        /// Write docs/errors.md instead of comparing it.
        #[arg(long)]
        write: bool,
    },
    /// docs/job.md, the page of all keys of a job, as the readers ask for them.
    Job {
        /// Write docs/job.md instead of comparing it.
        #[arg(long)]
        write: bool,
    },
    /// Builds the core for the microcontroller and checks what is in it.
    Device,
    /// Builds the firmware of one board or of all, and compares its sizes with docs/firmware.md.
    Firmware {
        /// Only this board.
        #[arg(long)]
        board: Option<Board>,
        /// Write the sizes into docs/firmware.md instead of comparing them.
        #[arg(long)]
        write: bool,
    },
    /// The emulated bench: host debug, host release and the emulated firmware give the same bits, faults included.
    Hil {
        /// Above a million setpoints instead of some ten thousand.
        #[arg(long)]
        all: bool,
    },
    /// The long campaign of faults on the emulated board; writes docs/campaign.md.
    Campaign,
    /// Proofs on the firmware: no panic, no soft float, no division call, no formatting in the setpoint path; worst-case
    /// stack.
    Elf {
        /// Write the stack into docs/firmware.md instead of comparing it.
        #[arg(long)]
        write: bool,
    },
    /// Instructions of the setpoint path on the emulated board, against firmware/budget.toml.
    Budget {
        /// Renew the budget and the tables of docs/firmware.md.
        #[arg(long)]
        write: bool,
    },
    /// Time (criterion) or instructions (cachegrind) of the kernels of the core.
    Bench {
        /// Count instructions with valgrind instead of measuring time.
        #[arg(long)]
        count: bool,
        /// With --count: hold the watched kernels against the table of docs/measure.md, 2 % either way.
        #[arg(long, requires = "count", conflicts_with = "write")]
        compare: bool,
        /// Measure how fast programs are read instead, beside the crate gcode and LinuxCNC.
        #[arg(long, conflicts_with = "count")]
        reading: bool,
        /// Measure how long contours of 10,000 lines and of five metres take instead.
        #[arg(long, conflicts_with_all = ["count", "reading"])]
        long: bool,
        /// Measure how fast five-axis moves are measured and divided instead.
        #[arg(long, conflicts_with_all = ["count", "reading", "long"])]
        multiaxis: bool,
        /// Ours beside what others have for the same instead, in one run: rs274, the crate gcode, LinuxCNC's components, the papers' law.
        #[arg(long, conflicts_with_all = ["count", "reading", "long", "multiaxis"])]
        peers: bool,
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
    /// Our reading of programs against LinuxCNC's `rs274`, over every program its package ships and our own.
    Conformance {
        /// Renew docs/conformance.md instead of comparing its counts.
        #[arg(long)]
        write: bool,
    },
    /// Programs as shops write them, the whole way: places, touches, correction, cut again.
    Shop {
        /// A folder with other programs and their table, programs.csv.
        folder: Option<PathBuf>,
        /// Only programs whose file name holds this text.
        #[arg(long)]
        only: Option<String>,
        /// Renew what the table expects, and docs/shop.md.
        #[arg(long)]
        write: bool,
    },
    /// Random bytes, guided by coverage, into everything that reads a file.
    Fuzz {
        /// Only this target: program, probe, job, five_axis, image, servo or device.
        #[arg(long)]
        target: Option<String>,
        /// Inputs for each target, instead of a time.
        #[arg(long, conflicts_with = "seconds")]
        runs: Option<u64>,
        /// Seconds for each target.
        #[arg(long, default_value_t = 20)]
        seconds: u64,
        /// Longest input, bytes, instead of what each target has for itself: many short ones, or few long ones.
        #[arg(long)]
        longest: Option<u32>,
    },
    /// Mistakes put into the code of the servo and of the flash, one at a time: a test has to notice each, or docs/mutants.md says
    /// why it does not matter. Takes hours.
    Mutants {
        /// Only folders whose names hold this text, for instance rewrite or ledger.
        folder: Option<String>,
        /// Only what one build holds with all its mutants, in minutes; the others take a build each.
        #[arg(long)]
        quick: bool,
    },
    /// The report page: its build as committed, and pages that the program wrote in a real browser.
    Page {
        /// Renew the committed build and the reference pictures.
        #[arg(long)]
        write: bool,
    },
    /// The whole tool as one web page, target/web/site: builds it, and tries it in a real browser against the command line.
    Web {
        /// Only build it.
        #[arg(long)]
        no_tests: bool,
        /// As `test --all` builds it: in less time, larger, and not to be handed on.
        #[arg(long)]
        fast: bool,
    },
    /// Packages to install: archive, Debian packages, a wheel for Python, checksums and a list of all parts, in target/packages.
    Dist {
        /// With the program of the tests instead: makes, installs, uses and removes them.
        #[arg(long)]
        check: bool,
    },
    /// The LinuxCNC component: builds it and tests it on a simulated machine.
    #[command(args_conflicts_with_subcommands = true)]
    Linuxcnc {
        #[command(subcommand)]
        task: Option<linuxcnc::Task>,
        /// Only this scenario.
        #[arg(long)]
        scenario: Option<String>,
        /// Write the times in the servo thread into docs/linuxcnc.md.
        #[arg(long)]
        write: bool,
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
        Task::Test { all } => test(&mut report, all),
        Task::Builds => builds(&mut report),
        Task::Fmt { write } => report.run(Step::new("fmt", || checks::format(write))),
        Task::Lint => report.run(Step::new("lint", checks::lint)),
        Task::Doc => report.run(Step::new("doc", checks::doc)),
        Task::TestOnly { all, arguments } => report.run(Step::new("test-only", || checks::tests(all, &arguments))),
        Task::Rooms { all, part } => report.run(Step::new("rooms", || rooms::check(all, part.as_deref()))),
        Task::Features => report.run(Step::new("features", features::check)),
        Task::Job { write } => report.run(Step::new("job", || checks::job_keys(write))),
        Task::Errors { write } => report.run(Step::new("errors", || checks::errors(write))),
        Task::Device => report.run(Step::new("device", device::check)),
        Task::Firmware { board, write } => {
            let boards = board.map_or(Board::ALL.to_vec(), |board| vec![board]);
            report.run(Step::new("firmware", || firmware::build(&boards, write)));
        }
        Task::Hil { all } => report.run(Step::new("hil", || hil::check(all))),
        Task::Campaign => report.run(Step::new("campaign", hil::campaign)),
        Task::Elf { write } => report.run(Step::new("elf", || firmware::elf::check(&Board::ALL, write))),
        Task::Budget { write } => report.run(Step::new("budget", || firmware::budget::check(write))),
        Task::Bench { count: true, compare, write, .. } => {
            let then = match (compare, write) {
                (true, _) => bench::Counts::Compare,
                (_, true) => bench::Counts::Write,
                _ => bench::Counts::Show,
            };
            report.run(Step::new("bench --count", || bench::count(then)));
        }
        Task::Bench { reading: true, write, .. } => {
            report.run(Step::new("bench --reading", || bench::rates::reading(write)))
        }
        Task::Bench { long: true, write, .. } => report.run(Step::new("bench --long", || bench::long::measure(write))),
        Task::Bench { multiaxis: true, write, .. } => {
            report.run(Step::new("bench --multiaxis", || bench::rates::multiaxis(write)))
        }
        Task::Bench { peers: true, write, .. } => {
            report.run(Step::new("bench --peers", || bench::peers::measure(write)))
        }
        Task::Bench { no_run, write, arguments, .. } => {
            report.run(Step::new("bench", || bench::time(no_run, write, &arguments)))
        }
        Task::Conformance { write } => report.run(Step::new("conformance", || conformance::check(write))),
        Task::Shop { folder, only, write } => {
            report.run(Step::new("shop", || shop::check(folder.as_deref(), only.as_deref(), write)));
        }
        Task::Fuzz { target, runs, seconds, longest } => {
            let length = runs.map_or(fuzz::Length::Seconds(seconds), fuzz::Length::Runs);
            report.run(Step::new("fuzz", || fuzz::check(target.as_deref(), length, longest)));
        }
        Task::Mutants { folder, quick } => {
            report.run(Step::new("mutants", || mutants::check(folder.as_deref(), quick)));
        }
        Task::Page { write } => report.run(Step::new("page", || page::check(write))),
        Task::Web { no_tests, fast } => {
            let build = if fast { web::Build::Tests } else { web::Build::Small };
            report.run(Step::new("web", || web::check(build, !no_tests)));
        }
        Task::Dist { check: true } => report.run(Step::new("dist", dist::check)),
        Task::Dist { check: false } => report.run(Step::new("dist", dist::make)),
        Task::Linuxcnc { task, scenario, write } => {
            report.run(Step::new("linuxcnc", || linuxcnc::run(task, scenario.as_deref(), write)));
        }
        Task::Judge { judge } => report.run(Step::new("judge", || judge::run_all(judge.as_deref(), Profile::Local))),
    }
    report.finish()
}

/// What a change has to pass, or everything.
fn test(report: &mut Report, all: bool) {
    report.run(Step::new("fmt", || checks::format(false)));
    report.run(Step::new("rooms", || rooms::check(false, None)));
    if !all {
        report.run(Step::new("test-only", || checks::tests(false, &[])));
        report.run(Step::new("features", features::check));
        return;
    }
    // Half of the tests keep one processor waiting. What builds and computes, and has no clock, takes what they leave.
    let mut builds = repository::itself();
    report.beside("builds", builds.arg("builds"), &repository::target().join("builds.log"), |report| {
        report.run(Step::new("test-only", || checks::tests(true, &[])));
        report.run(Step::new("features", features::check));
        report.run(Step::new("budget", || firmware::budget::check(false)));
        report.run(Step::new("hil", || hil::check(true)));
        report.run(Step::new("page", || page::check(false)));
        report.run(Step::new("web", || web::check(web::Build::Tests, true)));
        // It mills in real time and hardly computes: a tenth of one processor.
        let mut linuxcnc = repository::itself();
        report.beside("linuxcnc", linuxcnc.arg("linuxcnc"), &repository::target().join("linuxcnc.log"), |report| {
            repository::stand_back();
            // Builds the program for another processor, then installs one thing after the other: half of it on one processor.
            let mut dist = repository::itself();
            report.beside("dist", dist.args(["dist", "--check"]), &repository::target().join("dist.log"), |report| {
                report.run(Step::new("conformance", || conformance::check(false)));
                report.run(Step::new("shop", || shop::check(None, None, false)));
                report.run(Step::new("judge", || judge::run_all(None, Profile::Dev)));
                report.run(Step::new("fuzz", || fuzz::check(None, fuzz::Length::Seconds(15), None)));
            });
        });
    });
}

/// What of everything only builds and computes, at low priority. First what the other steps wait for; last what would keep them from
/// the build folder. That the benchmarks build is seen by `lint`, which looks at all targets.
fn builds(report: &mut Report) {
    repository::stand_back();
    report.run(Step::new("firmware", || firmware::build(&Board::ALL, false)));
    report.run(Step::new("elf", || firmware::elf::check(&Board::ALL, false)));
    report.run(Step::new("device", device::check));
    report.run(Step::new("web build", || web::module(web::Build::Tests).map(|_| step::Passed::Done)));
    report.run(Step::new("fuzz build", || fuzz::build().map(|_| step::Passed::Done)));
    report.run(Step::new("bench --count", || bench::count(bench::Counts::Compare)));
    report.run(Step::new("lint", checks::lint));
    report.run(Step::new("doc", checks::doc));
}
