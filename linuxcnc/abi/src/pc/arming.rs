//! An arming: why it is refused, and for what it is.
//!
//! While a part is armed, program and tool have to stay what they were then, whoever else watches over it. Feature, pass
//! and serial number are what is asked for, and change with the next request. A change of the work offset or of the
//! tool's length is a change of the frame, which the core notices.

use truepath_core::rewrite::{Flags, Refusal};

use super::pins::Inputs;

/// Why an arming is refused: the core's reasons, and those that only a controller has. Numbers stay the same from
/// version to version; those below 64 are [`Refusal::code`].
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

/// Program and tool of an arming.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Running {
    program_crc: u32,
    tool: i32,
}

impl Running {
    /// By the pins of a period.
    pub const fn of(inputs: &Inputs) -> Self {
        Self { program_crc: inputs.program_crc, tool: inputs.tool }
    }

    /// What ends an arming because something else runs by now.
    #[inline]
    pub fn ended(self, inputs: &Inputs) -> Flags {
        let program = if self.program_crc == inputs.program_crc { Flags::default() } else { Flags::ABORT };
        if self.tool == inputs.tool { program } else { program.with(Flags::TOOL_CHANGE) }
    }
}
