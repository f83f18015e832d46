//! What the commands do, apart from how they are called (`cli`) and printed.

pub mod bore;
mod bore_error;
mod bore_files;
mod bore_summary;
pub mod compare;
pub mod correct;
pub mod demo;
pub mod device;
mod doubts;
mod feeds;
mod first_pass;
pub mod hil;
pub mod inspect;
pub mod learn;
mod levels;
pub mod multiaxis;
mod page;
pub mod plot;
pub mod pocket;
pub mod probe;
pub mod probe_next;
mod remarks;
mod replaced;
pub mod second_pass;
pub mod simulate;
pub mod split;
pub mod study;
