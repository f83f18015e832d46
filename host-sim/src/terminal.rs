//! What a command says: its data on standard output; warnings, notes, progress and errors on standard error.

use std::io::IsTerminal;

use serde::Serialize;
use truepath_ground::diagnostics::{Failure, Form, visible, visible_lines};
use truepath_ground::output::json;

use crate::streams::{Bar, write_error, write_out};

/// Both and how to write on them.
#[derive(Clone, Copy, Debug)]
pub struct Terminal {
    json: bool,
    interactive: bool,
}

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
    pub fn progress(&self, task: &str, steps: u64) -> Bar {
        Bar::new(task, steps, self.interactive)
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
