//! The commands: what each is asked is what it takes.
//!
//! A command is a module: `Options`, which clap fills; `run`, which does the work and gives a summary; `main`, which runs it
//! and prints.

pub mod bore;
pub mod canon;
pub mod compare;
pub mod correct;
mod correction_files;
pub mod demo;
pub mod device;
pub mod forces;
pub mod hil;
mod history;
pub mod image;
pub mod init;
pub mod inspect;
pub mod learn;
pub mod multiaxis;
pub mod pack;
pub mod placement;
pub mod plan;
mod plan_files;
mod plan_study;
pub mod plot;
pub mod pocket;
pub mod probe;
mod readings;
pub mod replay;
pub mod simulate;
pub mod split;
pub mod study;
