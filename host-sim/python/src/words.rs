//! The words of a command line as the options of a command.

use std::ffi::OsString;

use clap::{Args, Command};
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError};

/// Reads the words behind the name of a command.
///
/// # Errors
/// `C001` for words that the command does not take.
pub(crate) fn options<O: Args>(words: Vec<OsString>) -> Result<O, Failure> {
    let command = O::augment_args(Command::new("truepath").no_binary_name(true).disable_help_flag(true));
    let read = command.try_get_matches_from(words).and_then(|matches| O::from_arg_matches(&matches));
    read.map_err(|error| {
        let text = error.render().to_string();
        let first = text.lines().next().unwrap_or_default().trim_start_matches("error: ").to_owned();
        InputError::new(C001, first, "", "pass a value that the documentation of the function names").into()
    })
}
