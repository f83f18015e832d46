//! What a controller sends: setpoints tick by tick, and the commands between them.
//!
//! A [`Traffic`] is asked once per tick and told the mode the coprocessor must be in, as the host's own rewriter has it.
//! So the same seed gives the same traffic, whatever board answers. Two kinds exist: recorded setpoints
//! ([`Recorded`]), and a controller that mills the part of an image again and again ([`Controller`]), well behaved or
//! with disturbances.

mod controller;
mod cursor;
mod disturbance;
mod recorded;

use truepath_core::rewrite::{ArmRequest, Mode, Setpoint};

pub use controller::{Controller, ControllerOptions};
pub(crate) use cursor::Cursor;
pub use recorded::Recorded;

/// Setpoints with the drives disabled before that is acknowledged. Before it has seen 32 frames at its setpoint rate the
/// device refuses to arm; a good share of them may be lost.
const LEAD: u32 = 48;

/// What the controller does in a tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Command {
    /// Sends a setpoint.
    Setpoint(Setpoint),
    /// Says that the drives are disabled.
    Acknowledge,
    /// Arms.
    Arm(ArmRequest),
    /// Ends the arming.
    Disarm,
}

/// A controller.
pub trait Traffic {
    /// The next command, given the mode the coprocessor is in; `None` at the end.
    fn next(&mut self, mode: Mode) -> Option<Command>;
}
