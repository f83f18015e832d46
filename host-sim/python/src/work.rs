//! A command at work, beside Python.

use std::panic::{AssertUnwindSafe, catch_unwind, resume_unwind};
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::mpsc::{RecvTimeoutError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use pyo3::prelude::*;
use truepath_ground::diagnostics::Failure;

use crate::error::raised;

/// As the first thread of a process has it.
const STACK: usize = 8 << 20;
/// How often Python is asked for signals, and told of progress.
const TICK: Duration = Duration::from_millis(50);

/// What a call says beside the words of the command line.
#[derive(FromPyObject)]
#[pyo3(from_item_all)]
pub(crate) struct Given<'py> {
    /// Folders that are not the caller's: files in them are named without them.
    pub(crate) hidden: Vec<PathBuf>,
    /// Whether the touches are columns in millimetres whatever the job says.
    pub(crate) millimetres: bool,
    /// Is called with the share that is done, 0…1.
    pub(crate) progress: Option<Bound<'py, PyAny>>,
}

/// Ends a command that nobody waits for any more.
struct Stopped;

/// Does the work of a command on a thread of its own and waits for it, with other threads of Python running.
///
/// # Errors
/// What the command says; a panic as an internal error; what a signal's handler or `progress` raises: the work then ends
/// where it next tells its progress.
pub(crate) fn done<T: Send + 'static>(
    py: Python<'_>,
    given: Given<'_>,
    work: impl FnOnce(&mut dyn FnMut(f64)) -> Result<T, Failure> + Send + 'static,
) -> PyResult<T> {
    let (stop, share) = (Arc::new(AtomicBool::new(false)), Arc::new(AtomicU64::new(0)));
    let (stopped, reached) = (Arc::clone(&stop), Arc::clone(&share));
    let (sender, receiver) = sync_channel(1);
    let work = move || {
        let mut progress = |share: f64| {
            if stopped.load(Ordering::Relaxed) {
                // Unlike a panic this says nothing.
                resume_unwind(Box::new(Stopped));
            }
            reached.store(share.to_bits(), Ordering::Relaxed);
        };
        let outcome = catch_unwind(AssertUnwindSafe(|| work(&mut progress)));
        // Nobody may be left to tell.
        let _ = sender.send(outcome);
    };
    let started = std::thread::Builder::new().name("truepath".to_owned()).stack_size(STACK).spawn(work);
    started.map_err(|e| raised(py, Failure::Internal(e.to_string()), &given.hidden))?;
    let receiver = Mutex::new(receiver);
    let wait = || receiver.lock().unwrap_or_else(PoisonError::into_inner).recv_timeout(TICK);
    let told = |share: f64| given.progress.as_ref().map_or(Ok(()), |progress| progress.call1((share,)).map(drop));
    let outcome = loop {
        match py.detach(wait) {
            Ok(outcome) => break outcome,
            Err(RecvTimeoutError::Timeout) => {
                let share = f64::from_bits(share.load(Ordering::Relaxed));
                py.check_signals().and_then(|()| told(share)).inspect_err(|_| stop.store(true, Ordering::Relaxed))?;
            }
            Err(RecvTimeoutError::Disconnected) => break Ok(Err(Failure::Internal("the work ended".to_owned()))),
        }
    };
    let outcome = outcome.unwrap_or_else(|panic| {
        let text = panic.downcast_ref::<String>().map(String::as_str).or_else(|| panic.downcast_ref::<&str>().copied());
        Err(Failure::Internal(text.unwrap_or("a panic without a message").to_owned()))
    });
    let done = outcome.map_err(|failure| raised(py, failure, &given.hidden))?;
    told(1.0)?;
    Ok(done)
}
