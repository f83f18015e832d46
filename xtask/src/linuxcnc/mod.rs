//! The LinuxCNC component: built, installed, tested on a simulated machine.

mod check;
mod component;
mod install;
mod machine;
mod notes;
mod parts;
mod proof;
mod recording;
mod route_b;
mod story;
mod suite;
mod timing;
mod verdict;

use std::path::PathBuf;

use clap::Subcommand;

pub use install::packaged;
pub use machine::sample::Sample;
pub use suite::typical_times;
pub use timing::median_us;

use crate::step::Outcome;

/// What is done with the component; without one, everything that tests it.
#[derive(Clone, Debug, Subcommand)]
pub enum Task {
    /// Builds the real-time component truepath.so, and proves from its machine code what its servo side does not do.
    Build,
    /// Builds it and puts it and what belongs to it into LinuxCNC's folders, as root or through sudo.
    Install {
        /// Only the real-time component, not the programs.
        #[arg(long)]
        component_only: bool,
        /// This program `truepath`, for instance a downloaded one, instead of building it.
        #[arg(long, value_name = "FILE", conflicts_with = "component_only")]
        program: Option<PathBuf>,
    },
    /// Takes away what install put there; images, ledger and configuration of a machine stay.
    Uninstall,
    /// Route B: mills through the virtual board, and stops, delays and resets it in the cut.
    Board,
    /// Mills two parts on the sample machine, touches them, corrects, mills again, and tells how much better the walls are.
    Story,
}

/// Does a task.
pub fn run(task: Option<Task>, scenario: Option<&str>, write: bool) -> Outcome {
    match task {
        None if scenario.is_some() => suite::run(scenario, write),
        None => {
            suite::run(None, write)?;
            story::run(write)
        }
        Some(Task::Board) => route_b::run(),
        Some(Task::Story) => story::run(write),
        Some(Task::Build) => component::build().map(|_| crate::step::Passed::Done),
        Some(Task::Install { component_only, program }) => install::install(component_only, program),
        Some(Task::Uninstall) => install::uninstall(),
    }
}
