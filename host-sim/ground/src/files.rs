//! Files by their names: on disk, or, in a browser, in memory.
//!
//! Whatever reads a file that a user names asks here, so that the commands are the same in both. Outputs are written by
//! [`output`](crate::output).

#[cfg(any(test, target_family = "wasm"))]
pub mod in_memory;
#[cfg(not(target_family = "wasm"))]
mod on_disk;

#[cfg(target_family = "wasm")]
pub use in_memory::here::{Opened, canonical, entries, exists, is_dir, is_file, is_occupied, length, open, read};
#[cfg(not(target_family = "wasm"))]
pub use on_disk::{Opened, canonical, entries, exists, is_dir, is_file, is_occupied, length, open, read};
