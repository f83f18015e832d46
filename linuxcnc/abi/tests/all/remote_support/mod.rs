//! Pins of a small machine that stands at X1 Y2 Z3 mm with its drives off, everything permitted.

use truepath_abi::pc::{Inputs, Outputs, Switches};

/// Switches of a machine that is on, with everything permitted.
pub const ON: u32 = Switches::DRIVES_ON.0
    | Switches::ALL_HOMED.0
    | Switches::PROGRAM_RUNNING.0
    | Switches::SPINDLE_ON.0
    | Switches::SPINDLE_LOADED.0
    | Switches::TRIVIAL_KINEMATICS.0
    | Switches::ENABLE.0;

pub fn inputs() -> Inputs {
    Inputs {
        pos_cmd: [1.0, 2.0, 3.0, 0.0, 0.0, 0.0],
        motor_pos_cmd: [11.0, 12.0, 13.0, 0.0, 0.0, 0.0],
        offset: [0.0; 3],
        spindle_rpm: 1500.0,
        nm_per_unit: 1e6,
        cosine: 1 << 30,
        sine: 0,
        motion_type: 0,
        tool: 1,
        tool_offset: 1,
        program_crc: 0,
        feature: 0,
        pass: 0,
        setup: 1,
        part_serial: 7,
        switches: Switches(ON & !Switches::DRIVES_ON.0),
        period_ns: 1_000_000,
    }
}

pub fn outputs() -> Outputs {
    Outputs {
        motor_pos_cmd: [0.0; 6],
        correction: [0.0; 3],
        correction_nm: [0; 3],
        state: 9,
        reason: 9,
        fault: 9,
        status: 9,
        refusal: 9,
        forward: 9,
        armed_serial: 9,
        image_ready: 9,
        image_crc: 9,
        node: 9,
        sequence: 9,
        flags: 9,
        feed_inhibit: 9,
    }
}
