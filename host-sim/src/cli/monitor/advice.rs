//! What the operator should do after an end of a correction, reason by reason.
//!
//! After any end, regular or not, the same pass of the same part cannot be armed again (`docs/safety.md`), so what is
//! left to do is to retract, to find the cause, and to judge the part.

use truepath_core::rewrite::Reason;

/// What to do.
pub const fn advice(reason: Reason) -> &'static str {
    match reason {
        Reason::None => "Nothing to do.",
        Reason::Completed | Reason::Disarmed | Reason::ProgramEnd => "Confirm the next part at the controller.",
        Reason::EmergencyStop => "Clear the emergency stop, retract, and measure the part before going on.",
        Reason::Abort => "Retract; find out why the program was aborted, and measure the part.",
        Reason::ToolChange => "End the pass before the tool change: check the program.",
        Reason::DrivesDisabled => "Find out why the drives were disabled in the pass; retract.",
        Reason::FrameChanged => "Do not change work offset, tool offset or rotation after arming; retract.",
        Reason::ImageChanged => "Do not change the image after arming; find out who else uses the device.",
        Reason::Jump => "Retract; look for a rapid move in the pass, or gaps in the setpoints.",
        Reason::OffPath => "Retract; check that program, work offset and image belong together.",
        Reason::Backwards => "Retract; do not go back along the contour while it is corrected.",
        Reason::LeftGate => "Check the approach: the program left the start without going down to the pass.",
        Reason::LeftPass => "Check the program for a retract before the end of the contour.",
        Reason::BelowPass => "Retract; check zero of Z and length of the tool.",
        Reason::MovedInHold => "Do not jog in a feed hold; retract.",
        Reason::SequenceBroken => "Check the setpoint cable and the controller's load; see the counters.",
        Reason::JointLimit => "Move the part away from the end of the axis, or check the joint limits.",
        Reason::Silence => "Check controller and setpoint cable; disable the drives, then acknowledge.",
        Reason::FrameRate => "Set rewriter.tick_hz to the controller's rate: truepath device settings.",
    }
}
