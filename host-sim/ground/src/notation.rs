//! TOML as a notation: from bytes to tables with spans, and the version every file of ours carries.
//!
//! Shared by all files the user writes in TOML; `what` names the file in the errors ("the job file").

use toml::Spanned;
use toml::de::DeTable;

use super::document::Section;
use super::limits::Limits;
use crate::codes::{J002, J010};
use crate::diagnostics::{InputError, Source};

/// The tables of a text.
///
/// # Errors
/// `J002` at the first byte that is not UTF-8 or the first place that is not TOML.
pub fn parse<'s>(source: &'s Source, what: &str) -> Result<Spanned<DeTable<'s>>, InputError> {
    let text = std::str::from_utf8(source.bytes()).map_err(|error| {
        let at = error.valid_up_to();
        let found = format!("{what} holds a byte that is not UTF-8");
        InputError::new(J002, found, "a text in UTF-8", "save the file as UTF-8").at(source, at..at + 1)
    })?;
    DeTable::parse(text).map_err(|error| syntax_error(source, what, &error))
}

fn syntax_error(source: &Source, what: &str, error: &toml::de::Error) -> InputError {
    let span = error.span().unwrap_or(0..0);
    let message = error.message().lines().next().unwrap_or("unreadable");
    let (reason, expected) = match message.split_once(", expected ") {
        _ if message.starts_with("duplicate") => ("this key is given twice", "every key once"),
        Some((reason, expected)) => (reason, expected),
        None => (message, "key = value, [table] or # comment"),
    };
    let around = source.bytes().get(span.start.saturating_sub(1)..=span.start).unwrap_or_default();
    let help = match around {
        [digit, b','] if digit.is_ascii_digit() => "write a decimal point, not a comma",
        _ => J002.remedy,
    };
    InputError::new(J002, format!("{what} is not TOML here: {reason}"), expected, help).at(source, span)
}

/// Checks `version = 1` at the top of the file.
///
/// # Errors
/// `J004` when it is missing, `J010` for any other version.
pub fn version(source: &Source, root: &Section<'_>) -> Result<(), InputError> {
    let Some(value) = root.value("version") else {
        return Err(root.missing("version", "version = 1"));
    };
    let number = root.number_in(&value, Limits::within("0", "1000000", ""))?;
    if number.as_whole() == Some(1) {
        return Ok(());
    }
    let found = format!("version is {}", source.excerpt(value.span.clone()));
    Err(J010.error(found, "1, the only version there is").at(source, value.span))
}
