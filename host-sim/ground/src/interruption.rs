//! The end of the process by a signal: what is temporary goes with it.
//!
//! Ctrl-C (SIGINT), SIGTERM and a hang-up end the process at once, also in the middle of long work, with the exit code
//! 128 + signal: 130 after Ctrl-C. A thread waits for them. It removes the temporary files and folders registered here,
//! then ends the process. Whoever creates, moves or registers one takes [`hold`] first: the thread waits, so an output is
//! there whole or not at all. A second signal ends the process without waiting. A live view takes the signals over
//! ([`Watch`]), as it has a terminal to give back.
//!
//! Limits: signals of Unix only. A process that is killed (SIGKILL) leaves its temporary files.

use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};

/// What is temporary now.
static TEMPORARY: Mutex<Vec<Weak<Temporary>>> = Mutex::new(Vec::new());

/// A file or folder that a signal removes while this lives. Dropping it removes nothing.
#[derive(Debug)]
pub struct Temporary {
    path: PathBuf,
    kind: Kind,
}

/// What is removed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// A file.
    File,
    /// A folder with all that lies in it.
    Folder,
    /// A folder, provided that nothing lies in it.
    EmptyFolder,
}

/// While it lives no signal ends the process. It must not be taken twice by one thread.
pub struct Hold(MutexGuard<'static, Vec<Weak<Temporary>>>);

/// Keeps signals from ending the process.
pub fn hold() -> Hold {
    Hold(TEMPORARY.lock().unwrap_or_else(PoisonError::into_inner))
}

impl Hold {
    /// Registers a file or folder that exists; the last one registered goes first.
    pub fn removes(&mut self, path: &Path, kind: Kind) -> Arc<Temporary> {
        self.0.retain(|entry| entry.strong_count() > 0);
        let entry = Arc::new(Temporary { path: path.to_owned(), kind });
        self.0.push(Arc::downgrade(&entry));
        entry
    }

    /// Removes everything; there is nobody left to tell of an error.
    #[cfg_attr(not(unix), expect(dead_code, reason = "no signal comes"))]
    fn remove_all(&mut self) {
        for entry in self.0.drain(..).rev().filter_map(|entry| entry.upgrade()) {
            let path = &entry.path;
            let removed = match entry.kind {
                Kind::File => std::fs::remove_file(path),
                Kind::EmptyFolder => std::fs::remove_dir(path),
                // Another process, an emulator, may write into it while it goes.
                Kind::Folder => std::fs::remove_dir_all(path).or_else(|_| std::fs::remove_dir_all(path)),
            };
            drop(removed);
        }
    }
}

#[cfg(unix)]
pub use signals::{Watch, end_by, listen};

#[cfg(unix)]
mod signals {
    use std::io;
    use std::sync::atomic::{AtomicBool, AtomicUsize, Ordering};
    use std::sync::{Arc, OnceLock};

    use signal_hook::consts::{SIGHUP, SIGINT, SIGQUIT, SIGTERM};
    use signal_hook::iterator::{Handle, Signals};
    use signal_hook::{flag, low_level};

    use super::hold;

    static LISTENING: OnceLock<Handle> = OnceLock::new();
    /// How many watch.
    static WATCHED: AtomicUsize = AtomicUsize::new(0);
    /// The last signal that came while somebody watched.
    static CAME: AtomicUsize = AtomicUsize::new(0);

    /// From now on signals end the process as said above; called again it does nothing.
    ///
    /// # Errors
    /// The system refuses.
    pub fn listen() -> io::Result<()> {
        if LISTENING.get().is_some() {
            return Ok(());
        }
        let at_once = Arc::new(AtomicBool::new(false));
        let wanted = [SIGINT, SIGTERM].into_iter().chain((!ignores_hang_up()).then_some(SIGHUP));
        let wanted: Vec<i32> = wanted.collect();
        for signal in &wanted {
            flag::register_conditional_shutdown(*signal, 128 + signal, Arc::clone(&at_once))?;
        }
        let mut signals = Signals::new(wanted)?;
        let _ = LISTENING.set(signals.handle());
        let unheard = Arc::clone(&at_once);
        let work = move || {
            for signal in signals.forever() {
                if WATCHED.load(Ordering::SeqCst) > 0 {
                    CAME.store(signal as usize, Ordering::SeqCst);
                    continue;
                }
                at_once.store(true, Ordering::SeqCst);
                let mut held = hold();
                held.remove_all();
                std::process::exit(128 + signal);
            }
        };
        let thread = std::thread::Builder::new().name("signals".to_owned()).spawn(work);
        // Without the thread nothing is removed, but a signal still ends the process.
        thread.map(drop).inspect_err(|_| unheard.store(true, Ordering::SeqCst))
    }

    /// Whether a hang-up is to be outlived, as under `nohup`; where that cannot be known it is taken for so.
    fn ignores_hang_up() -> bool {
        let status = std::fs::read_to_string("/proc/self/status").unwrap_or_default();
        let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
        let mask = mask.and_then(|mask| u64::from_str_radix(mask.trim(), 16).ok());
        mask.is_none_or(|mask| mask & (1 << (SIGHUP - 1)) != 0)
    }

    /// While it lives signals are noted and do not end the process: SIGINT, SIGTERM, SIGHUP, SIGQUIT.
    #[derive(Debug)]
    pub struct Watch(());

    impl Watch {
        /// Begins to watch.
        ///
        /// # Errors
        /// The system refuses.
        pub fn begin() -> io::Result<Self> {
            listen()?;
            CAME.store(0, Ordering::SeqCst);
            WATCHED.fetch_add(1, Ordering::SeqCst);
            let watch = Self(());
            let handle = LISTENING.get().ok_or(io::ErrorKind::Other)?;
            // Under `nohup` a hang-up stays ignored.
            let hang_up = (!ignores_hang_up()).then_some(SIGHUP);
            hang_up.into_iter().chain([SIGQUIT]).try_for_each(|signal| handle.add_signal(signal))?;
            Ok(watch)
        }
        /// The signal that came, if one did.
        pub fn came(&self) -> Option<i32> {
            let signal = CAME.load(Ordering::SeqCst) as i32;
            (signal != 0).then_some(signal)
        }
    }

    impl Drop for Watch {
        fn drop(&mut self) {
            WATCHED.fetch_sub(1, Ordering::SeqCst);
        }
    }

    /// Removes what is temporary and ends the process as if nobody had waited for the signal.
    pub fn end_by(signal: i32) {
        hold().remove_all();
        let _ = low_level::emulate_default_handler(signal);
    }
}

#[cfg(not(unix))]
pub use no_signals::{Watch, end_by, listen};

#[cfg(not(unix))]
mod no_signals {
    use std::io;

    /// There are none here.
    pub fn listen() -> io::Result<()> {
        Ok(())
    }

    /// There are none here.
    #[derive(Debug)]
    pub struct Watch(());

    impl Watch {
        /// Never fails.
        pub fn begin() -> io::Result<Self> {
            Ok(Self(()))
        }
        /// None.
        pub fn came(&self) -> Option<i32> {
            None
        }
    }

    /// Never called.
    pub fn end_by(_signal: i32) {}
}
