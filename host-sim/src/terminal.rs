//! What a command says: its data on standard output; warnings, notes, progress and errors on standard error.

use std::io::IsTerminal;
use std::ops::Deref;

use clap::ColorChoice;
use serde::Serialize;
use truepath_ground::diagnostics::{Failure, Form, visible, visible_lines};
use truepath_ground::output::json;

use crate::streams::{Bar, write_error, write_out};

/// Both and how to write on them.
#[derive(Clone, Copy, Debug)]
pub struct Terminal {
    json: bool,
    quiet: bool,
    colour: ColorChoice,
    on_terminal: bool,
}

impl Terminal {
    /// For people, or with `json` for machines; `quiet` leaves warnings, errors and data.
    pub fn new(json: bool, quiet: bool, colour: ColorChoice) -> Self {
        Self { json, quiet, colour, on_terminal: std::io::stderr().is_terminal() }
    }
    /// Whether `--json` was given.
    pub const fn json(&self) -> bool {
        self.json
    }
    /// How errors are printed.
    pub fn form(&self) -> Form {
        let coloured = match self.colour {
            ColorChoice::Always => true,
            ColorChoice::Never => false,
            ColorChoice::Auto => self.on_terminal && std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty()),
        };
        match (self.json, coloured) {
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
    pub fn warn_all(&self, texts: &[impl Deref<Target = str>]) {
        texts.iter().for_each(|text| self.warn(text));
    }
    /// Prints a remark.
    pub fn note(&self, text: &str) {
        if !self.quiet {
            self.say("note", text);
        }
    }
    fn say(&self, kind: &str, text: &str) {
        let text = visible(text);
        if self.json {
            write_error(&format!("{}\n", serde_json::json!({ kind: text })));
        } else {
            write_error(&format!("{kind}: {text}\n"));
        }
    }
    /// Prints a result, for machines or in words; in words nothing when quiet.
    pub fn tell(&self, result: &impl Serialize, words: impl FnOnce() -> String) -> Result<(), Failure> {
        match (self.json, self.quiet) {
            (true, _) => print(&json(result)?),
            (false, true) => Ok(()),
            (false, false) => print(words().as_bytes()),
        }
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
        Bar::new(task, steps, self.on_terminal && !self.json && !self.quiet)
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
