//! Why an arming is refused: the core's reasons, and those that only a controller has.

use truepath_core::rewrite::Refusal;

/// Numbers stay the same from version to version; those below 64 are [`Refusal::code`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Refused {
    /// The core refuses it.
    Core(Refusal),
    /// Corrections are not permitted (pin `enable`).
    NotEnabled,
    /// Joints are not axes, or nobody says so.
    Kinematics,
    /// A probing move runs.
    Probing,
    /// The ledger cannot be written: the part would not be remembered.
    Ledger,
    /// An arming is under way.
    Busy,
    /// While the ledger was written the program ended, a stop came, or the arming was taken back.
    Overtaken,
}

impl Refused {
    /// Its number.
    pub const fn code(self) -> u32 {
        match self {
            Self::Core(refusal) => refusal.code() as u32,
            Self::NotEnabled => 64,
            Self::Kinematics => 65,
            Self::Probing => 66,
            Self::Ledger => 67,
            Self::Busy => 68,
            Self::Overtaken => 69,
        }
    }
}

impl From<Refusal> for Refused {
    fn from(refusal: Refusal) -> Self {
        Self::Core(refusal)
    }
}
