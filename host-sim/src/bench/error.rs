//! What can go wrong between bench and board.
//!
//! | code | meaning |
//! |---|---|
//! | H001 | a port, socket or file cannot be opened |
//! | H002 | the emulator or the firmware is missing |
//! | H003 | the device does not answer |
//! | H004 | the device refuses |
//! | H005 | the device speaks another version |
//! | H006 | device and host differ |
//! | H007 | an option does not fit |
//! | H008 | a run was stopped before its end |

use truepath_core::link::Denial;

use crate::diagnostics::{Failure, InputError};

/// An error between bench and board.
#[derive(Clone, Debug, thiserror::Error)]
pub enum BenchError {
    /// Something cannot be opened.
    #[error("{what} cannot be opened ({reason})")]
    Open {
        /// What.
        what: String,
        /// Why.
        reason: String,
    },
    /// A tool or a file is missing.
    #[error("{what} is missing")]
    Missing {
        /// What.
        what: String,
        /// How to get it.
        remedy: String,
    },
    /// Nothing came back.
    #[error("the device does not answer ({0})")]
    Silent(String),
    /// The device refuses.
    #[error("the device refuses: {0}")]
    Denied(Denial),
    /// The answer cannot be understood.
    #[error("the device answers something else: {0}")]
    Foreign(String),
    /// Device and host differ.
    #[error("device and host differ: {0}")]
    Differs(String),
    /// Somebody ended the run.
    #[error("the run was stopped {0}")]
    Stopped(String),
    /// An option that does not fit.
    #[error("{found}")]
    Option {
        /// What was found.
        found: String,
        /// What to do.
        help: String,
    },
}

impl BenchError {
    /// Something that cannot be opened.
    pub fn open(what: impl Into<String>, error: &std::io::Error) -> Self {
        Self::Open { what: what.into(), reason: error.to_string() }
    }
}

impl From<BenchError> for InputError {
    fn from(error: BenchError) -> Self {
        let (code, help) = match &error {
            BenchError::Open { .. } => ("H001", "check the name, the permissions, and that nobody else uses it"),
            BenchError::Missing { remedy, .. } => ("H002", remedy.as_str()),
            BenchError::Silent(_) => ("H003", "check cable, port and baud rate, and that the board is powered"),
            BenchError::Denied(_) => ("H004", "bring the device into the mode in which it takes this request"),
            BenchError::Foreign(_) => ("H005", "use firmware and program of the same version"),
            BenchError::Differs(_) => ("H006", "do not drive axes with this firmware; report it with the command line"),
            BenchError::Stopped(_) => ("H008", "run it again to its end; a shorter run has a smaller --count"),
            BenchError::Option { help, .. } => ("H007", help.as_str()),
        };
        Self::new(code, error.to_string(), "", help)
    }
}

impl From<BenchError> for Failure {
    fn from(error: BenchError) -> Self {
        InputError::from(error).into()
    }
}
