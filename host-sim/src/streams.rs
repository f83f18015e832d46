//! Standard output, standard error and the bar of a running task: those of the process, or, in a browser, kept for the page
//! that shows them.

#[cfg(target_family = "wasm")]
mod kept;
#[cfg(not(target_family = "wasm"))]
mod of_the_process;

#[cfg(target_family = "wasm")]
pub use kept::{Bar, Kept, taken, watch, write_error, write_out};
#[cfg(not(target_family = "wasm"))]
pub use of_the_process::{Bar, unless_closed, write_error, write_out};
