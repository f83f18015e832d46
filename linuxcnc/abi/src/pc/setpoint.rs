//! What LinuxCNC commands in a period, as a setpoint: the same for either route.

use truepath_core::rewrite::{AXES, Flags, Setpoint};

use super::limits::Joints;
use super::pins::{Inputs, JOINTS, Switches};
use crate::convert::{millirpm, nearest_nm};

impl Joints {
    /// The setpoint of a period; none when a position is no length.
    pub(crate) fn setpoint(&self, inputs: &Inputs, flags: Flags, frame_crc: u32, sequence: u32) -> Option<Setpoint> {
        let mut axes = [0; AXES];
        // From the last joint on, so that of two joints of an axis the first one counts.
        for joint in (0..JOINTS).rev() {
            let Some(axis) = self.axis(joint) else { continue };
            *axes.get_mut(axis)? = nearest_nm(*inputs.pos_cmd.get(joint)?, inputs.nm_per_unit)?;
            nearest_nm(*inputs.motor_pos_cmd.get(joint)?, inputs.nm_per_unit)?;
        }
        let turns = inputs.switches.has(Switches::SPINDLE_ON);
        Some(Setpoint {
            axes,
            spindle_millirpm: if turns { millirpm(inputs.spindle_rpm) } else { 0 },
            spindle_age_ticks: 0,
            sequence,
            frame_crc,
            flags,
        })
    }
}
