//! What runs while a part is armed: it has to stay what it was then, whoever else watches over it.
//!
//! Feature, pass and serial number are not in it: they are what is asked for, and change with the next request. A change
//! of the work offset or of the tool's length is a change of the frame, which the core notices.

use truepath_core::rewrite::{ArmRequest, Flags};

use super::pins::Inputs;

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

/// An arming that waits for the ledger.
#[derive(Clone, Copy, Debug)]
pub(super) struct Arming {
    pub request: ArmRequest,
    pub running: Running,
    /// Something happened that would have ended it.
    pub overtaken: bool,
}
