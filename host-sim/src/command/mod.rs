//! The commands: what each is asked is what it takes.
//!
//! A command is a module: `Options`, which clap fills; `run`, which does the work and gives a summary; `main`, which runs it
//! and prints. Those that need ports, processes, folders of the system or threads are left out in a browser.

pub mod batch;
mod begin;
pub mod bore;
pub mod canon;
pub mod compare;
pub mod correct;
mod correction_files;
pub mod demo;
#[cfg(not(target_family = "wasm"))]
pub mod device;
pub mod fillet;
#[cfg(not(target_family = "wasm"))]
pub mod firmware;
pub mod forces;
#[cfg(not(target_family = "wasm"))]
pub mod hil;
mod history;
pub mod image;
pub mod init;
pub mod inspect;
#[cfg(not(target_family = "wasm"))]
pub mod key;
pub mod learn;
#[cfg(not(target_family = "wasm"))]
pub mod manual;
pub mod multiaxis;
#[cfg(not(target_family = "wasm"))]
pub mod pack;
pub mod placement;
pub mod plan;
mod plan_files;
#[cfg(not(target_family = "wasm"))]
mod plan_study;
pub mod plot;
pub mod pocket;
pub mod probe;
#[cfg(not(target_family = "wasm"))]
pub mod publish;
mod readings;
mod relative;
pub mod replay;
mod rewritten_job;
#[cfg(not(target_family = "wasm"))]
mod shop_study;
pub mod simulate;
pub mod split;
#[cfg(not(target_family = "wasm"))]
pub mod store;
#[cfg(not(target_family = "wasm"))]
pub mod study;
