//! What would go to a terminal, kept in memory; progress goes to whoever watches.

use std::sync::{Mutex, MutexGuard, OnceLock, PoisonError};

use truepath_ground::diagnostics::Failure;

/// What was written since it was last taken.
#[derive(Debug, Default)]
pub struct Kept {
    /// To standard output.
    pub out: Vec<u8>,
    /// To standard error.
    pub error: Vec<u8>,
}

static KEPT: Mutex<Kept> = Mutex::new(Kept { out: Vec::new(), error: Vec::new() });
/// Is told a task and the share of it that is done, 0…1.
static WATCHER: OnceLock<fn(&str, f64)> = OnceLock::new();

fn kept() -> MutexGuard<'static, Kept> {
    KEPT.lock().unwrap_or_else(PoisonError::into_inner)
}

/// Takes what was written.
pub fn taken() -> Kept {
    std::mem::take(&mut *kept())
}

/// From now on `watcher` is told of progress; the first one stays.
pub fn watch(watcher: fn(&str, f64)) {
    let _ = WATCHER.set(watcher);
}

/// Writes to standard output.
///
/// # Errors
/// Never.
pub fn write_out(text: &[u8]) -> Result<(), Failure> {
    kept().out.extend_from_slice(text);
    Ok(())
}

/// Writes to standard error.
pub fn write_error(text: &str) {
    kept().error.extend_from_slice(text.as_bytes());
}

/// How far a task is.
#[derive(Debug)]
pub struct Bar {
    task: String,
    steps: u64,
    /// Percents that were told.
    told: u64,
}

impl Bar {
    /// One of so many steps.
    pub fn new(task: &str, steps: u64, _on_terminal: bool) -> Self {
        let bar = Self { task: task.to_owned(), steps, told: 0 };
        bar.tell();
        bar
    }

    /// So many steps are done.
    pub fn reached(&mut self, step: u64) {
        let percents = (100 * step).checked_div(self.steps).unwrap_or(100).min(100);
        if percents != self.told {
            self.told = percents;
            self.tell();
        }
    }

    fn tell(&self) {
        if let Some(watcher) = WATCHER.get() {
            watcher(&self.task, self.told as f64 / 100.0);
        }
    }
}
