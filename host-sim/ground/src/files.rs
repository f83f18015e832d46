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

/// All of standard input, however often it is asked for.
///
/// # Errors
/// What the system says; in a browser there is none.
pub fn standard_input() -> std::io::Result<Vec<u8>> {
    #[cfg(target_family = "wasm")]
    return Err(std::io::ErrorKind::NotFound.into());
    #[cfg(not(target_family = "wasm"))]
    {
        static ALL: std::sync::Mutex<Option<Vec<u8>>> = std::sync::Mutex::new(None);
        let mut all = ALL.lock().unwrap_or_else(std::sync::PoisonError::into_inner);
        if let Some(bytes) = &*all {
            return Ok(bytes.clone());
        }
        let mut bytes = Vec::new();
        std::io::Read::read_to_end(&mut std::io::stdin().lock(), &mut bytes)?;
        Ok(all.insert(bytes).clone())
    }
}
