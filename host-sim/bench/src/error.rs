//! What can go wrong between bench and board.

use truepath_core::link::Denial;
use truepath_core::rewrite::Refusal;
use truepath_ground::diagnostics::{Failure, InputError};

use crate::codes::{H001, H002, H003, H004, H005, H006, H007, H008, H009};

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
    /// A rule of the safety contract is broken.
    #[error("{0}")]
    Alarm(String),
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
        if let BenchError::Denied(Denial::Access(inner)) = &error {
            return Self::of_core(inner.code(), error.to_string(), "", inner.help());
        }
        if let BenchError::Denied(Denial::Update(inner)) = &error {
            return Self::of_core(inner.code(), error.to_string(), "", inner.help());
        }
        let (row, help) = match &error {
            BenchError::Open { .. } => (H001, H001.remedy),
            BenchError::Missing { remedy, .. } => (H002, remedy.as_str()),
            BenchError::Silent(_) => (H003, H003.remedy),
            BenchError::Denied(denial) => (H004, remedy(denial)),
            BenchError::Foreign(_) => (H005, H005.remedy),
            BenchError::Differs(_) => (H006, H006.remedy),
            BenchError::Alarm(_) => (H009, H009.remedy),
            BenchError::Stopped(_) => (H008, H008.remedy),
            BenchError::Option { help, .. } => (H007, help.as_str()),
        };
        Self::new(row, error.to_string(), "", help)
    }
}

/// What to do when the device refuses.
fn remedy(denial: &Denial) -> &'static str {
    match denial {
        Denial::Refused(refusal) => match refusal {
            Refusal::Off { .. } => "disable the drives, then: truepath device acknowledge",
            Refusal::State(_) => "bring the device into the mode in which it takes this request",
            Refusal::NoImage => "truepath device upload FILE --activate",
            Refusal::DrivesEnabled => "disable the drives (machine off), then ask again",
            Refusal::NoSetpoints => "start the controller: it has to send setpoints, with the drives disabled",
            Refusal::Identity { .. } => {
                "load the program, tool and set-up of the image, or activate the image of this program"
            }
            Refusal::PartRepeated { .. } => "give each part its own number, higher than the one before",
            Refusal::FrameDamaged { .. } | Refusal::FrameNotRigid { .. } => {
                "send cosine and sine of one angle, units of 2^-30"
            }
            Refusal::FrameAxes { .. } => "name three axes that the controller sends",
            Refusal::FrameRate { .. } => "set rewriter.tick_hz to the servo rate, or wait until 33 setpoints have come",
        },
        Denial::NoImage { .. } => "truepath device upload FILE --activate",
        Denial::NotConfigured => "truepath device settings NAME=VALUE, with the limits of this machine",
        Denial::Untrusted(error) => error.help(),
        Denial::NotPresent => "hold the button of the board while it is reset, then ask again",
        Denial::KeysFull => "use a key that it trusts, or revoke one; with eight known, only its flash can be erased",
        Denial::Busy => "wait until the upload or the computation has ended",
        _ => "bring the device into the mode in which it takes this request",
    }
}

impl From<BenchError> for Failure {
    fn from(error: BenchError) -> Self {
        InputError::from(error).into()
    }
}
