//! What a whole device has broken.

use std::fmt;

use crate::attack::{Alarm, Rule};

/// What a device promises beside the safety contract.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Promise {
    /// Each request that arrives whole has one answer, which can be read and has its number; nothing else has any.
    Answered,
    /// No message begins a correction, only an acknowledgement leads out of `Off`, only an arming arms.
    Message,
    /// After a reset it is in `Off`.
    Off,
    /// Once there is a key, a request below its role is denied, and a login needs a key with that role.
    Role,
    /// Once there is a key, an image is taken only if a key signed it that may.
    Trust,
    /// A signed image that is older than one of its pass that was in use is not taken.
    Older,
    /// Settings are those that were confirmed last, over resets as well.
    Settings,
    /// The image in use is the one that was put in use last, over resets as well.
    Image,
}

impl Promise {
    /// What must hold.
    pub const fn sentence(self) -> &'static str {
        match self {
            Self::Answered => "each request that arrives whole has one answer, which can be read",
            Self::Message => "no message begins a correction, and only an acknowledgement leads out of Off",
            Self::Off => "after a reset it is in Off",
            Self::Role => "once there is a key, a request below its role is denied",
            Self::Trust => "once there is a key, an image is taken only if a key signed it that may",
            Self::Older => "a signed image that is older than one of its pass that was in use is not taken",
            Self::Settings => "settings are those that were confirmed last, over resets as well",
            Self::Image => "the image in use is the one that was put in use last, over resets as well",
        }
    }
}

/// A rule of the safety contract, or a promise.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub enum Broken {
    /// A rule.
    Rule(Rule),
    /// A promise.
    Promise(Promise),
}

/// What was broken, and how that was seen.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{broken}; {found}")]
pub struct Breach {
    /// What.
    pub broken: Broken,
    /// How.
    pub found: String,
}

impl fmt::Display for Broken {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Rule(rule) => rule.fmt(f),
            Self::Promise(promise) => f.write_str(promise.sentence()),
        }
    }
}

impl From<Box<Alarm>> for Box<Breach> {
    fn from(alarm: Box<Alarm>) -> Self {
        Self::new(Breach { broken: Broken::Rule(alarm.rule), found: alarm.found })
    }
}

/// What a check gives.
pub(super) type Kept = Result<(), Box<Breach>>;

/// The promise is kept, or a breach.
pub(super) fn keep(kept: bool, promise: Promise, found: impl FnOnce() -> String) -> Kept {
    if kept { Ok(()) } else { Err(Box::new(Breach { broken: Broken::Promise(promise), found: found() })) }
}
