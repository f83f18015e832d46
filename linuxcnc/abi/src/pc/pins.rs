//! What comes from HAL's pins in a period, and what goes to them; laid out as in `truepath.h`.

use truepath_core::rewrite::AXES;

/// Most joints of a machine.
pub const JOINTS: usize = 6;

/// Pins of type bit, as bits.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[repr(transparent)]
pub struct Switches(pub u32);

impl Switches {
    /// The drives are on (motion.motion-enabled).
    pub const DRIVES_ON: Self = Self(1);
    /// Every joint is homed.
    pub const ALL_HOMED: Self = Self(1 << 1);
    /// Emergency stop.
    pub const EMERGENCY_STOP: Self = Self(1 << 2);
    /// The axes are held, or about to be.
    pub const FEED_HOLD: Self = Self(1 << 3);
    /// A program runs or is paused.
    pub const PROGRAM_RUNNING: Self = Self(1 << 4);
    /// A tool change is under way.
    pub const TOOL_CHANGE: Self = Self(1 << 5);
    /// The spindle turns by command.
    pub const SPINDLE_ON: Self = Self(1 << 6);
    /// The cutter cuts.
    pub const SPINDLE_LOADED: Self = Self(1 << 7);
    /// Joints are axes.
    pub const TRIVIAL_KINEMATICS: Self = Self(1 << 8);
    /// Corrections are permitted.
    pub const ENABLE: Self = Self(1 << 9);
    /// Arm, at the rising edge.
    pub const ARM: Self = Self(1 << 10);
    /// Disarm, at the rising edge.
    pub const DISARM: Self = Self(1 << 11);

    /// Whether one is on.
    #[inline]
    pub const fn has(self, other: Self) -> bool {
        self.0 & other.0 != 0
    }
}

/// What comes in. Lengths and speeds are HAL's floats, in machine units.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Inputs {
    /// Commanded position of each joint, machine coordinates.
    pub pos_cmd: [f64; JOINTS],
    /// The same with homing offset and backlash, as the drive gets it.
    pub motor_pos_cmd: [f64; JOINTS],
    /// Machine position of the program's origin, X, Y, Z.
    pub offset: [f64; 3],
    /// Spindle speed, rev/min.
    pub spindle_rpm: f64,
    /// Nanometres of a machine unit.
    pub nm_per_unit: f64,
    /// Cosine of the turn of the work offset, 2⁻³⁰.
    pub cosine: i32,
    /// Sine of that turn.
    pub sine: i32,
    /// motion.motion-type.
    pub motion_type: i32,
    /// Tool in the spindle.
    pub tool: i32,
    /// Tool offset in force.
    pub tool_offset: i32,
    /// CRC-32 of the program.
    pub program_crc: u32,
    /// Feature.
    pub feature: u32,
    /// Pass.
    pub pass: u32,
    /// Setup.
    pub setup: u32,
    /// Serial number of the part.
    pub part_serial: u32,
    /// Pins of type bit.
    pub switches: Switches,
    /// Length of a period, ns.
    pub period_ns: u32,
}

/// What goes out.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct Outputs {
    /// Position for the drive of each joint: the command with the correction, or the command itself, bit for bit.
    pub motor_pos_cmd: [f64; JOINTS],
    /// Correction of X, Y, Z, machine units.
    pub correction: [f64; 3],
    /// The same, nm.
    pub correction_nm: [i32; 3],
    /// State, [`Mode`](truepath_core::rewrite::Mode) as a number.
    pub state: u32,
    /// Why the last correction ended, [`Reason`](truepath_core::rewrite::Reason).
    pub reason: u32,
    /// Not 0: that was a fault.
    pub fault: u32,
    /// Warnings, [`Status`](truepath_core::rewrite::Status).
    pub status: u32,
    /// Why the last arming was refused, [`Refused`](super::Refused); 0: it was not.
    pub refusal: u32,
    /// Not 0: drive enables may be passed on.
    pub forward: u32,
    /// Part armed last.
    pub armed_serial: u32,
    /// Not 0: an image is in use.
    pub image_ready: u32,
    /// Its CRC-32.
    pub image_crc: u32,
    /// Place on the path.
    pub node: u32,
    /// Number of the period.
    pub sequence: u32,
    /// Flags the core was given, [`Flags`](truepath_core::rewrite::Flags).
    pub flags: u32,
    /// Not 0: a probing move has to wait.
    pub feed_inhibit: u32,
}

const _: () = assert!(AXES == JOINTS);
