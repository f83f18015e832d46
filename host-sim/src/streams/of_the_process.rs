//! The streams of the process, and a bar on its terminal.

use std::io::{BufWriter, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use truepath_ground::diagnostics::Failure;

/// How long a task runs before its bar appears.
const PATIENCE: Duration = Duration::from_secs(1);

/// Writes to standard output. One that was closed early (`| head`) is not an error.
///
/// # Errors
/// Internal, where the system refuses.
pub fn write_out(text: &[u8]) -> Result<(), Failure> {
    let mut out = BufWriter::new(std::io::stdout().lock());
    unless_closed(out.write_all(text).and_then(|()| out.flush()))
}

/// What became of writing to standard output; that it was closed early is not an error.
///
/// # Errors
/// Internal, where the system refused.
pub fn unless_closed(written: std::io::Result<()>) -> Result<(), Failure> {
    match written {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::Internal(error.to_string())),
        _ => Ok(()),
    }
}

/// Writes to standard error. A closed one is no reason to fail.
pub fn write_error(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}

/// How far a task is; it shows itself on a terminal when the task takes over a second.
#[derive(Debug)]
pub struct Bar {
    bar: ProgressBar,
    /// Whether nothing remains to be decided about showing it.
    shown: bool,
}

impl Bar {
    /// One of so many steps; it stays hidden unless it is drawn `on_terminal`.
    pub fn new(task: &str, steps: u64, on_terminal: bool) -> Self {
        let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} % {eta}") {
            bar.set_style(style);
        }
        bar.set_message(task.to_owned());
        Self { bar, shown: !on_terminal }
    }

    /// So many steps are done.
    pub fn reached(&mut self, step: u64) {
        if !self.shown && self.bar.elapsed() > PATIENCE {
            self.shown = true;
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_position(step);
    }
}

impl Drop for Bar {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}
