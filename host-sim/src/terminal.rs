//! What a command says: its data on standard output; warnings, notes, progress and errors on standard error.

use std::io::{BufWriter, IsTerminal, Write};
use std::time::Duration;

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use serde::Serialize;
use truepath_ground::diagnostics::{Failure, Form, visible, visible_lines};
use truepath_ground::output::json;

/// Both and how to write on them.
#[derive(Clone, Copy, Debug)]
pub struct Terminal {
    json: bool,
    interactive: bool,
}

/// How long a task runs before its bar appears.
const PATIENCE: Duration = Duration::from_secs(1);

impl Terminal {
    /// For people, or with `json` for machines.
    pub fn new(json: bool) -> Self {
        Self { json, interactive: !json && std::io::stderr().is_terminal() }
    }
    /// Whether `--json` was given.
    pub const fn json(&self) -> bool {
        self.json
    }
    /// How errors are printed.
    pub fn form(&self) -> Form {
        match (self.json, self.interactive && std::env::var_os("NO_COLOR").is_none()) {
            (true, _) => Form::Json,
            (_, true) => Form::Colour,
            _ => Form::Plain,
        }
    }
    /// Prints an error and gives its exit code.
    pub fn fail(&self, failure: &Failure) -> u8 {
        write_error(&failure.render(self.form()));
        failure.exit_code()
    }
    /// Prints a warning: something to look at that does not stop the work.
    pub fn warn(&self, text: &str) {
        self.say("warning", text);
    }
    /// Prints several of them.
    pub fn warn_all(&self, texts: &[String]) {
        texts.iter().for_each(|text| self.warn(text));
    }
    /// Prints a remark.
    pub fn note(&self, text: &str) {
        self.say("note", text);
    }
    fn say(&self, kind: &str, text: &str) {
        let text = visible(text);
        if self.json {
            write_error(&format!("{}\n", serde_json::json!({ kind: text })));
        } else {
            write_error(&format!("{kind}: {text}\n"));
        }
    }
    /// Prints a result, for machines or in words.
    pub fn tell(&self, result: &impl Serialize, words: impl FnOnce() -> String) -> Result<(), Failure> {
        print(&if self.json { json(result)? } else { words().into_bytes() })
    }
    /// Does a task under a bar, which it tells the share done, 0…1.
    pub fn watch<T>(
        &self,
        task: &str,
        work: impl FnOnce(&mut dyn FnMut(f64)) -> Result<T, Failure>,
    ) -> Result<T, Failure> {
        let mut bar = self.progress(task, 100);
        work(&mut |share| bar.reached((share * 100.0) as u64))
    }
    /// A bar for a task of `steps` steps; it shows itself on a terminal when the task takes over a second.
    pub fn progress(&self, task: &str, steps: u64) -> Progress {
        let bar = ProgressBar::with_draw_target(Some(steps), ProgressDrawTarget::hidden());
        if let Ok(style) = ProgressStyle::with_template("{msg} {wide_bar} {percent:>3} % {eta}") {
            bar.set_style(style);
        }
        bar.set_message(task.to_owned());
        Progress { bar, shown: !self.interactive }
    }
}

/// A running task.
#[derive(Debug)]
pub struct Progress {
    bar: ProgressBar,
    /// Whether nothing remains to be decided about showing it.
    shown: bool,
}

impl Progress {
    /// So many steps are done.
    pub fn reached(&mut self, step: u64) {
        if !self.shown && self.bar.elapsed() > PATIENCE {
            self.shown = true;
            self.bar.set_draw_target(ProgressDrawTarget::stderr());
        }
        self.bar.set_position(step);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.bar.finish_and_clear();
    }
}

/// What a command says, for people or as JSON.
pub fn print(text: &[u8]) -> Result<(), Failure> {
    write_out(visible_lines(&String::from_utf8_lossy(text)).as_bytes())
}

/// Data byte for byte, unless a person looks on.
pub fn print_data(text: &[u8]) -> Result<(), Failure> {
    if std::io::stdout().is_terminal() { print(text) } else { write_out(text) }
}

/// Standard output that was closed early (`| head`) is not an error.
fn write_out(text: &[u8]) -> Result<(), Failure> {
    let mut out = BufWriter::new(std::io::stdout().lock());
    match out.write_all(text).and_then(|()| out.flush()) {
        Err(error) if error.kind() != std::io::ErrorKind::BrokenPipe => Err(Failure::Internal(error.to_string())),
        _ => Ok(()),
    }
}

/// A closed standard error is no reason to fail.
fn write_error(text: &str) {
    let _ = std::io::stderr().lock().write_all(text.as_bytes());
}
