//! Errors as Python has them.

use std::path::PathBuf;

use pyo3::create_exception;
use pyo3::exceptions::PyException;
use pyo3::prelude::*;
use truepath_ground::codes::{C001, X001};
use truepath_ground::diagnostics::Failure;

create_exception!(
    truepath,
    TruepathError,
    PyException,
    "What was given is wrong, or does not do.\n\n\
     code: stable code of the error, as docs/errors.md lists them, 'J006' for instance.\n\
     file, line, column: the place it is about, both counted from 1; None where there is none.\n\
     hint: what to do."
);

/// A failure as the exception to raise; files in `hidden` folders are named without them.
pub(crate) fn raised(py: Python<'_>, failure: Failure, hidden: &[PathBuf]) -> PyErr {
    let (code, said, file, place, hint) = match failure {
        Failure::Input(error) => {
            let error = hidden.iter().fold(error, |error, folder| error.without_folder(folder));
            let told = error.to_json();
            let text = |key: &str| told["error"][key].as_str().map(str::to_owned);
            let said = text("message").unwrap_or_default();
            (error.code().to_owned(), said, text("file"), error.line_column(), text("help"))
        }
        Failure::Usage(text) => (C001.code.to_owned(), text, None, None, Some(C001.remedy.to_owned())),
        internal @ Failure::Internal(_) => {
            (X001.code.to_owned(), internal.to_string(), None, None, Some(X001.remedy.to_owned()))
        }
    };
    let at = match (&file, place) {
        (Some(file), Some((line, column))) => format!("{file}:{line}:{column}: "),
        (Some(file), None) => format!("{file}: "),
        (None, _) => String::new(),
    };
    let then = hint.as_ref().map_or_else(String::new, |hint| format!("\n  hint: {hint}"));
    let error = TruepathError::new_err(format!("{code}: {at}{said}{then}"));
    let value = error.value(py);
    let attributes = value
        .setattr("code", code)
        .and_then(|()| value.setattr("file", file))
        .and_then(|()| value.setattr("line", place.map(|place| place.0)))
        .and_then(|()| value.setattr("column", place.map(|place| place.1)))
        .and_then(|()| value.setattr("hint", hint));
    match attributes {
        Ok(()) => error,
        Err(other) => other,
    }
}
