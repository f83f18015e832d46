//! Whether a packet is the answer of this tick, whether it can be true, and how often what happened.

use truepath_core::link::{AnswerFrame, LinkError};
use truepath_core::rewrite::{AXES, Mode, Output, Setpoint};

/// What a packet is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Verdict {
    /// The answer of this tick.
    Answer(Output),
    /// The answer to an earlier tick.
    Late,
    /// Undamaged, but it cannot be true.
    Wrong(Fault),
    /// Not an answer of this link, or not as it was sent.
    Damaged(LinkError),
}

/// Why an undamaged answer cannot be true: the board or its settings are at fault.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// It answers a setpoint that was not sent yet.
    Sequence,
    /// A position is not setpoint + correction.
    Position,
    /// A correction is above the clamp.
    Clamp,
    /// A correction in `Off`, `Bypass` or `Armed`.
    Correction,
    /// Positions for the drives in `Off`, or none in another state.
    Forward,
}

/// Counters of the controller's end; each stops at its end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Counters {
    /// Right answers in their tick.
    pub answered: u32,
    /// Ticks without one.
    pub missed: u32,
    /// Answers to an earlier tick; dropped.
    pub late: u32,
    /// Packets that are no undamaged answer; dropped.
    pub damaged: u32,
    /// Undamaged answers that cannot be true, see [`Fault`]; dropped.
    pub wrong: u32,
    /// How often the link was lost.
    pub lost: u32,
}

impl Counters {
    /// One more, up to the end.
    pub(super) fn one_more(counter: &mut u32) {
        *counter = counter.saturating_add(1);
    }
}

/// Judges a frame, COBS taken out, against the setpoint of this tick.
pub(super) fn judge(raw: &[u8], axes: u8, setpoint: &Setpoint, clamp_nm: i32) -> Verdict {
    let output = match AnswerFrame::decode(raw, axes) {
        Ok(answer) => answer.output,
        Err(error) => return Verdict::Damaged(error),
    };
    // Half of the range lies behind, half ahead.
    let ahead = output.sequence.wrapping_sub(setpoint.sequence);
    if ahead > u32::MAX / 2 {
        return Verdict::Late;
    }
    if ahead != 0 {
        return Verdict::Wrong(Fault::Sequence);
    }
    match fault(&output, axes, setpoint, clamp_nm) {
        Some(fault) => Verdict::Wrong(fault),
        None => Verdict::Answer(output),
    }
}

fn fault(output: &Output, axes: u8, setpoint: &Setpoint, clamp_nm: i32) -> Option<Fault> {
    if output.forward == (output.mode == Mode::Off) {
        return Some(Fault::Forward);
    }
    let may_correct = matches!(output.mode, Mode::Active | Mode::Hold | Mode::Fault);
    let each = output.axes.iter().zip(output.correction_nm).zip(setpoint.axes);
    for ((position, correction), commanded) in each.take(usize::from(axes).min(AXES)) {
        if commanded.checked_add(correction.into()) != Some(*position) {
            return Some(Fault::Position);
        }
        if correction.unsigned_abs() > clamp_nm.unsigned_abs() {
            return Some(Fault::Clamp);
        }
        if correction != 0 && !may_correct {
            return Some(Fault::Correction);
        }
    }
    None
}
