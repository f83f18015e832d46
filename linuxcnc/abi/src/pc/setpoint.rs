//! What LinuxCNC commands in a period, as a setpoint: positions, flags, frame of the program. The same for either route.
//!
//! | LinuxCNC | flag |
//! |---|---|
//! | drives on and all joints homed | drives enabled; while armed only in a running program, and not during a probing move |
//! | drives or homing lost while armed | abort |
//! | program no longer runs | abort with a correction on, otherwise program end |
//! | probing move with a correction on | abort |
//!
//! Without "drives enabled" the gate stays shut, so jogging, a line typed by hand or a probing move never goes through it.

use truepath_core::rewrite::{AXES, Flags, Frame, Mode, Setpoint};

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

/// motion.motion-type of G38.
pub const PROBING: i32 = 5;

/// What was the period before.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Signals {
    drives: bool,
    running: bool,
}

impl Signals {
    /// The flags of a period; `mode` is that before it.
    #[inline]
    pub fn flags(&mut self, inputs: &Inputs, mode: Mode) -> Flags {
        let on = |switch| inputs.switches.has(switch);
        let drives = on(Switches::DRIVES_ON) && on(Switches::ALL_HOMED);
        let running = on(Switches::PROGRAM_RUNNING);
        let probing = inputs.motion_type == PROBING;
        let (armed, active) = (mode == Mode::Armed, matches!(mode, Mode::Active | Mode::Hold));
        let ended = self.running && !running;
        let lost = self.drives && !drives;
        *self = Self { drives, running };
        [
            (drives && !(armed && (probing || !running)), Flags::DRIVES_ENABLED),
            (on(Switches::FEED_HOLD), Flags::FEED_HOLD),
            (on(Switches::SPINDLE_LOADED), Flags::SPINDLE_LOADED),
            (on(Switches::EMERGENCY_STOP), Flags::EMERGENCY_STOP),
            (on(Switches::TOOL_CHANGE), Flags::TOOL_CHANGE),
            (ended && !active, Flags::PROGRAM_END),
            ((ended || probing) && active || lost && armed, Flags::ABORT),
        ]
        .into_iter()
        .filter(|&(is, _)| is)
        .fold(Flags::default(), |flags, (_, flag)| flags.with(flag))
    }
}

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
