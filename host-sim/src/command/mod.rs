//! What the commands do, apart from how they are called (`cli`) and printed.

pub mod bore;
mod bore_error;
mod bore_files;
mod bore_summary;
pub mod compare;
pub mod correct;
mod correction_files;
pub mod demo;
pub mod device;
pub mod hil;
pub mod inspect;
pub mod learn;
pub mod multiaxis;
pub mod plot;
pub mod pocket;
pub mod probe;
pub mod probe_next;
mod replaced;
pub mod settings;
pub mod simulate;
pub mod split;
pub mod study;
