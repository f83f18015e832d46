//! What the operator should do, state by state and reason by reason (`docs/safety.md`).
//!
//! The device stops nobody: after a fault the program runs on uncorrected, so the first word is to retract. After any end,
//! regular or not, the same pass of the same part cannot be armed again, so what is left is to find the cause and to judge
//! the part. Nothing here asks for a safety stop to be released before its cause is known.

use truepath_core::rewrite::{Reason, Status};

/// After an end, while setpoints arrive.
pub const fn advice(reason: Reason) -> &'static str {
    match reason {
        Reason::None => "Nothing to do.",
        Reason::Completed | Reason::Disarmed | Reason::ProgramEnd => "Confirm the next part at the controller.",
        Reason::EmergencyStop => "Find its cause before it is released; then retract, and measure the part.",
        Reason::Abort => "Retract; find out why the program was aborted, and measure the part.",
        Reason::ToolChange => "Retract; check the program for a tool change within the pass.",
        Reason::DrivesDisabled => "Find out why the drives were disabled in the pass; retract.",
        Reason::FrameChanged => "Retract; do not change work offset, tool offset or rotation after arming.",
        Reason::ImageChanged => "Retract; find out who changed the image after arming.",
        Reason::Jump => "Retract; look for a rapid move in the pass, or gaps in the setpoints.",
        Reason::OffPath => "Retract; check that program, work offset and image belong together.",
        Reason::Backwards => "Retract; do not go back along the contour while it is corrected.",
        Reason::LeftGate => "Retract; check the approach: the program left the start without going down to the pass.",
        Reason::LeftPass => "Retract; check the program for a retract before the end of the contour.",
        Reason::BelowPass => "Retract; check zero of Z and length of the tool.",
        Reason::MovedInHold => "Do not jog in a feed hold; retract.",
        Reason::SequenceBroken => "Retract; check the setpoint cable and the controller's load; see the counters.",
        Reason::JointLimit => "Retract; clamp the part farther from the end of the axis, or check the joint limits.",
        Reason::Silence => "Retract; check controller and setpoint cable, and measure the part.",
        Reason::FrameRate => "Retract; set rewriter.tick_hz to the controller's rate: truepath device settings.",
    }
}

/// While the drive enable is dropped: first the drives, whatever the reason.
pub const fn while_off(reason: Reason) -> &'static str {
    match reason {
        Reason::Silence => "Check controller and setpoint cable. Disable the drives; the controller acknowledges that.",
        Reason::ImageChanged => {
            "Disable the drives; the controller acknowledges that. Find out who took the image away."
        }
        _ => "Disable the drives; the controller acknowledges that, then setpoints pass.",
    }
}

/// While a correction is on, with the flags of the samples.
pub const fn while_active(flags: Status) -> &'static str {
    if flags.has(Status::FADED) {
        "Check spindle speed and load, and the feed: meanwhile the wall is not corrected."
    } else if flags.has(Status::SATURATED) {
        "Measure the wall here: the correction is cut at its clamp."
    } else {
        "Nothing to do."
    }
}
