//! Where the program stands in the machine, as a frame of the core.

use truepath_core::rewrite::Frame;

use super::pins::Inputs;
use crate::convert::nearest_nm;

/// The frame in force, computed anew only when a pin changes: its checksum goes out with every setpoint.
#[derive(Clone, Copy, Debug)]
pub struct WorkFrame {
    /// The pins it was computed from, bit for bit.
    pins: ([u64; 4], [i32; 2]),
    /// None when the offset is no length.
    frame: Option<Frame>,
}

impl WorkFrame {
    /// No frame, until the first period.
    pub const fn new() -> Self {
        // No unit is 0, so these pins are never met as they are.
        Self { pins: ([0; 4], [0; 2]), frame: None }
    }

    /// The frame of a period.
    #[inline]
    pub fn update(&mut self, inputs: &Inputs) -> Option<&Frame> {
        let [x, y, z] = inputs.offset;
        let pins = ([x, y, z, inputs.nm_per_unit].map(f64::to_bits), [inputs.cosine, inputs.sine]);
        if pins != self.pins {
            self.pins = pins;
            self.frame = made(inputs);
        }
        self.frame.as_ref()
    }

    /// The checksum for a setpoint. Without a frame it is that of none, which never is an armed one: the core arms only
    /// a frame whose checksum is right.
    pub fn crc(&self) -> u32 {
        self.frame.map_or_else(|| !Frame::identity().crc, |frame| frame.crc)
    }
}

impl Default for WorkFrame {
    fn default() -> Self {
        Self::new()
    }
}

#[inline(never)]
fn made(inputs: &Inputs) -> Option<Frame> {
    let [x, y, z] = inputs.offset.map(|length| nearest_nm(length, inputs.nm_per_unit));
    let offset_nm = [x?, y?, z?];
    Some(Frame { offset_nm, cosine: inputs.cosine, sine: inputs.sine, ..Frame::identity() }.sealed())
}
