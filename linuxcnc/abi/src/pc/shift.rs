//! The correction on the joints: added behind the motion controller, taken off before it, in the unit it was armed in.
//!
//! Both routes end here, whoever has computed the correction. LinuxCNC is told positions without it, so what goes out with
//! one period comes off what is measured in the next. The unit of the machine is taken from the pins only while nothing
//! is armed or on: a correction that is on keeps its size.

use truepath_core::rewrite::AXES;

use super::limits::Joints;
use super::pins::{Inputs, JOINTS, Outputs};
use crate::convert::{added, removed, units};

/// What is added to the joints.
#[derive(Clone, Copy, Debug)]
pub struct Shift {
    joints: Joints,
    /// Added to each joint in the last period, machine units.
    correction: [f64; JOINTS],
    nm_per_unit: f64,
}

impl Shift {
    /// Nothing is added; the unit is that of the first period.
    pub const fn new(joints: Joints) -> Self {
        Self { joints, correction: [0.0; JOINTS], nm_per_unit: 0.0 }
    }

    /// Which axis each joint moves.
    pub const fn joints(&self) -> &Joints {
        &self.joints
    }

    /// The measured position of each joint without what was added in the last period.
    pub fn feedback(&self, measured: &[f64; JOINTS], plain: &mut [f64; JOINTS]) {
        for ((to, &from), &correction) in plain.iter_mut().zip(measured).zip(&self.correction) {
            *to = removed(from, correction);
        }
    }

    /// The pins with the unit that what is armed or on is in, and whether that is the one of the pins. `idle`: nothing is.
    pub fn in_unit(&mut self, pins: &Inputs, idle: bool) -> (Inputs, bool) {
        if idle {
            self.nm_per_unit = pins.nm_per_unit;
        }
        let kept = self.nm_per_unit.to_bits() == pins.nm_per_unit.to_bits();
        (Inputs { nm_per_unit: self.nm_per_unit, ..*pins }, kept)
    }

    /// Adds a correction, nm along each axis, to the commanded position of every joint that moves its axis, and says
    /// how large it is on the pins.
    pub fn put(&mut self, inputs: &Inputs, correction_nm: &[i32; AXES], outputs: &mut Outputs) {
        let unit = self.nm_per_unit;
        let nm = |axis: usize| correction_nm.get(axis).copied().unwrap_or(0);
        let length = |nm| if nm == 0 { 0.0 } else { units(nm, unit) };
        for (joint, correction) in self.correction.iter_mut().enumerate() {
            *correction = self.joints.axis(joint).map_or(0.0, |axis| length(nm(axis)));
        }
        for ((to, &from), &correction) in
            outputs.motor_pos_cmd.iter_mut().zip(&inputs.motor_pos_cmd).zip(&self.correction)
        {
            *to = added(from, correction);
        }
        outputs.correction_nm = [0, 1, 2].map(nm);
        outputs.correction = outputs.correction_nm.map(length);
    }
}
