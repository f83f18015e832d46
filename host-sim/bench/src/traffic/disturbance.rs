//! What controllers, operators and machines do wrong in the middle of a pass.
//!
//! Each is drawn at random and changes one setpoint, or the ones from then on. What the coprocessor must make of it is
//! in the safety contract; here nothing is judged.

use truepath_core::rewrite::{AXES, Flags, Setpoint};

use crate::chance::Chance;

/// What is different from now on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Conditions {
    /// Ticks of feed hold left; the axes stand.
    pub hold: u32,
    /// Ticks of backward motion left.
    pub backwards: u32,
    /// Feed override, 1/256.
    pub feed_256: i64,
    /// Lifted out of the pass, nm.
    pub lift_nm: i64,
    /// The spindle: nominal, stopped, or of a stale speed.
    pub spindle: Spindle,
}

/// What the spindle does.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Spindle {
    #[default]
    Nominal,
    Stopped,
    Stale,
    /// Another speed than nominal, 1/256 of it.
    Other(u16),
}

impl Conditions {
    pub fn calm() -> Self {
        Self { feed_256: 256, ..Self::default() }
    }
}

/// What an operator may do: feed hold and override.
pub(super) fn operate(chance: &mut Chance, conditions: &mut Conditions) {
    match chance.below(3) {
        0 => conditions.hold = 5 + chance.below(200) as u32,
        1 => conditions.feed_256 = 128 + chance.below(256) as i64,
        _ => conditions.feed_256 = 256,
    }
}

/// Anything else, into the setpoint or into the conditions.
pub(super) fn disturb(chance: &mut Chance, conditions: &mut Conditions, setpoint: &mut Setpoint) {
    let axis = |chance: &mut Chance, n: u64| chance.below(n) as usize;
    match chance.below(20) {
        0 => setpoint.flags = setpoint.flags.with(Flags::EMERGENCY_STOP),
        1 => setpoint.flags = setpoint.flags.with(Flags::ABORT),
        2 => setpoint.flags = setpoint.flags.with(Flags::TOOL_CHANGE),
        3 => setpoint.flags = setpoint.flags.with(Flags::PROGRAM_END),
        4 => setpoint.flags = Flags::default(),
        5 => setpoint.flags = Flags(chance.bits() as u16 & 0x7f),
        6 => setpoint.frame_crc ^= 1 << chance.below(32),
        // A setpoint that jumps and comes back, off the path, anywhere at all.
        7 => setpoint.axes[axis(chance, 3)] += chance.around(5_000_000),
        8 => setpoint.axes[axis(chance, 2)] += chance.around(600_000),
        9 => setpoint.axes[axis(chance, AXES as u64)] = chance.bits() as i64 >> chance.below(60),
        10 => conditions.lift_nm = chance.around(1_000_000),
        11 => conditions.lift_nm = 5_000_000,
        12 => conditions.backwards = 1 + chance.below(200) as u32,
        13 => conditions.spindle = Spindle::Stopped,
        14 => conditions.spindle = Spindle::Stale,
        15 => conditions.spindle = Spindle::Other(chance.below(1024) as u16),
        16 => conditions.spindle = Spindle::Nominal,
        // The controller counts from elsewhere, or jumps by as much as may be lost.
        17 => setpoint.sequence = chance.bits() as u32,
        18 => setpoint.sequence = setpoint.sequence.wrapping_add(chance.below(70) as u32),
        // A feed far outside of what the image is for.
        _ => conditions.feed_256 = chance.below(1500) as i64,
    }
}
