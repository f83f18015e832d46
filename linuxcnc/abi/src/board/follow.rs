//! The correction that is added: it follows the board's within the limits of the machine, and stands while there is no
//! answer.
//!
//! An answer on time is followed to the last bit, because the board keeps the same limits or narrower ones. Behind a
//! tick without one the correction starts from where it stood, and catches up within the limits of speed and
//! acceleration of the machine instead of in one step.

use truepath_core::image::FineOffset;
use truepath_core::rewrite::{AXES, AxisState, Limits};
use truepath_core::units::shift_rounded_i31;

/// More than any correction; joint limits are so far from the ends of the range that no sum wraps.
const FAR: i64 = 1 << 32;

/// The correction of every axis.
#[derive(Clone, Debug)]
pub(super) struct Follower {
    limits: Limits,
    clamp_nm: i32,
    joints: [(i64, i64); AXES],
    axes: [AxisState; AXES],
}

impl Follower {
    /// No correction is on.
    pub fn new(limits: Limits, clamp_nm: i32, joints: [(i64, i64); AXES]) -> Self {
        let joints = joints.map(|(low, high)| (low.max(i64::MIN + FAR), high.min(i64::MAX - FAR)));
        Self { limits, clamp_nm, joints, axes: [AxisState::default(); AXES] }
    }

    /// One tick towards the board's correction; says whether it is reached in every axis.
    pub fn follow(&mut self, correction_nm: &[i32; AXES]) -> bool {
        let mut reached = true;
        for (axis, nm) in self.axes.iter_mut().zip(correction_nm) {
            // In range: a correction is at most 4 mm.
            self.limits.step(axis, nm.wrapping_shl(FineOffset::FRACTION_BITS));
            reached &= axis.is_on_target();
        }
        reached
    }

    /// One tick without an answer.
    pub fn stand(&mut self) {
        for axis in &mut self.axes {
            *axis = AxisState::at_rest(axis.correction());
        }
    }

    /// The drives are off: the axes stand where they stand, without a correction.
    pub fn drop_all(&mut self) {
        self.axes = [AxisState::default(); AXES];
    }

    /// Whether a correction is on.
    pub fn is_on(&self) -> bool {
        self.axes.iter().any(|axis| !axis.is_at_rest_at_zero())
    }

    /// What is added to these commanded positions, nm, and whether a joint limit held some of it back.
    pub fn added(&self, commanded: &[i64; AXES]) -> ([i32; AXES], bool) {
        let mut added = [0; AXES];
        let mut limited = false;
        for (((to, axis), &position), &(low, high)) in added.iter_mut().zip(&self.axes).zip(commanded).zip(&self.joints)
        {
            let wanted = shift_rounded_i31(axis.correction().bits(), FineOffset::FRACTION_BITS);
            // Catching up may carry it a little beyond the goal.
            let wanted = wanted.min(self.clamp_nm).max(self.clamp_nm.wrapping_neg());
            // What is left to the limits, not below 0: a setpoint beyond one is not carried farther out.
            let room = |nm: i64| nm.max(0).min(i32::MAX.into()) as i32;
            let up = room(high.saturating_sub(position));
            let down = room(position.saturating_sub(low)).wrapping_neg();
            *to = wanted.min(up).max(down);
            limited |= *to != wanted;
        }
        (added, limited)
    }
}
