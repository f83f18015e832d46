//! Route B from pins to pins: what LinuxCNC's signals become on the way to the board, and its answers on the way back.

use crate::board_support;
use crate::remote_support;

use board_support::{answer_bytes, sent};
use remote_support::{ON, inputs, outputs};
use truepath_abi::board::{Cause, PACKET_BYTES};
use truepath_abi::pc::{Inputs, Joints, Limits, Outputs, PROBING, Switches};
use truepath_abi::remote::Remote;
use truepath_core::rewrite::{Flags, Frame, Mode, Reason, Setpoint};

fn remote() -> Remote {
    let limits = Limits {
        least: [-100.0; 6],
        greatest: [100.0; 6],
        velocity: [20.0; 6],
        acceleration: [1000.0; 6],
        nm_per_unit: 1e6,
    };
    Remote::new(&limits, Joints([0, 1, 2, 1, 255, 255]), 1_000_000, 3, 500_000).unwrap()
}

/// A period whose answer is in a mode with a correction; gives what was sent and what came out.
fn period(remote: &mut Remote, inputs: &Inputs, mode: Mode, nm: [i32; 2]) -> (Setpoint, Outputs, Cause) {
    let mut packet = [0; PACKET_BYTES];
    let bytes = remote.begin(inputs, &mut packet);
    let setpoint = sent(&packet[..bytes]);
    remote.board().take(&answer_bytes(&setpoint, mode, [nm[0], nm[1], 0, 0, 0, 0]));
    let mut out = outputs();
    let (driven, _) = remote.finish(inputs, &mut out);
    (setpoint, out, driven.cause)
}

/// A machine that is on, the link heard.
fn ready() -> (Remote, Inputs) {
    let mut remote = remote();
    for _ in 0..10 {
        period(&mut remote, &inputs(), Mode::Bypass, [0; 2]);
    }
    let on = Inputs { switches: Switches(ON), ..inputs() };
    let (_, out, cause) = period(&mut remote, &on, Mode::Bypass, [0; 2]);
    assert_eq!((out.forward, cause), (1, Cause::None));
    (remote, on)
}

/// The same pins with other switches.
fn with(inputs: &Inputs, bits: u32) -> Inputs {
    Inputs { switches: Switches(bits), ..*inputs }
}

#[test]
fn pins_become_the_setpoint_of_route_a() {
    let (mut remote, mut on) = ready();
    on.offset = [150.0, 100.0, -120.0];
    (on.cosine, on.sine) = (0, 1 << 30);
    let (setpoint, ..) = period(&mut remote, &on, Mode::Bypass, [0; 2]);
    assert_eq!(setpoint.axes, [1_000_000, 2_000_000, 3_000_000, 0, 0, 0]);
    assert_eq!(setpoint.flags, Flags::DRIVES_ENABLED.with(Flags::SPINDLE_LOADED));
    assert_eq!(setpoint.spindle_millirpm, 1_500_000);
    let offset_nm = [150_000_000, 100_000_000, -120_000_000];
    let frame = Frame { offset_nm, cosine: 0, sine: 1 << 30, ..Frame::identity() }.sealed();
    assert_eq!(setpoint.frame_crc, frame.crc);
}

#[test]
fn a_correction_is_added_to_every_joint_of_its_axis_and_taken_out_of_the_feedback() {
    let (mut remote, on) = ready();
    period(&mut remote, &on, Mode::Armed, [0; 2]);
    let (_, out, _) = period(&mut remote, &on, Mode::Active, [900, -500]);
    assert_eq!(out.motor_pos_cmd, [11.0009, 11.9995, 13.0, -0.0005, 0.0, 0.0]);
    assert_eq!((out.correction_nm, out.state, out.armed_serial), ([900, -500, 0], 3, 7));
    let mut plain = [0.0; 6];
    remote.feedback(&out.motor_pos_cmd, &mut plain);
    for (plain, commanded) in plain.iter().zip(on.motor_pos_cmd) {
        assert!((plain - commanded).abs() < 1e-12);
    }
}

#[test]
fn without_a_correction_positions_keep_their_bits() {
    let (mut remote, mut on) = ready();
    on.motor_pos_cmd = [-0.0, 1.0 / 3.0, 5e-324, 0.1, 0.0, 0.0];
    let (_, out, _) = period(&mut remote, &on, Mode::Bypass, [0; 2]);
    assert_eq!(out.motor_pos_cmd.map(f64::to_bits), on.motor_pos_cmd.map(f64::to_bits));
}

#[test]
fn what_ends_an_arming_on_this_side_goes_with_the_setpoint() {
    let (mut remote, on) = ready();
    for (inputs, expected) in [
        (with(&on, ON & !Switches::ENABLE.0), Flags::PROGRAM_END),
        (with(&on, ON & !Switches::TRIVIAL_KINEMATICS.0), Flags::PROGRAM_END),
        (with(&on, ON | Switches::DISARM.0), Flags::PROGRAM_END),
        // The edge counts.
        (with(&on, ON | Switches::DISARM.0), Flags::default()),
        (with(&on, ON | Switches::EMERGENCY_STOP.0), Flags::EMERGENCY_STOP),
        (with(&on, ON & !Switches::PROGRAM_RUNNING.0), Flags::PROGRAM_END),
    ] {
        let (setpoint, ..) = period(&mut remote, &inputs, Mode::Bypass, [0; 2]);
        let usual = Flags::DRIVES_ENABLED.with(Flags::SPINDLE_LOADED);
        assert_eq!(setpoint.flags, usual.with(expected), "{:?}", inputs.switches);
    }
    // With a correction on, a program that no longer runs was aborted.
    period(&mut remote, &on, Mode::Active, [0; 2]);
    let (setpoint, ..) = period(&mut remote, &with(&on, ON & !Switches::PROGRAM_RUNNING.0), Mode::Active, [0; 2]);
    assert!(setpoint.flags.has(Flags::ABORT));
}

#[test]
fn a_probing_move_waits_until_the_correction_is_out() {
    let (mut remote, on) = ready();
    let probing = Inputs { motion_type: PROBING, ..on };
    period(&mut remote, &on, Mode::Active, [900, 0]);
    for (mode, nm, waits) in [(Mode::Fault, 500, 1), (Mode::Fault, 0, 1), (Mode::Bypass, 0, 0)] {
        let (_, out, _) = period(&mut remote, &probing, mode, [nm, 0]);
        assert_eq!(out.feed_inhibit, waits, "{mode:?} {nm}");
    }
}

#[test]
fn a_position_that_is_no_length_loses_the_link() {
    let (mut remote, on) = ready();
    let mut wrong = on;
    wrong.pos_cmd[0] = f64::NAN;
    let mut packet = [0; PACKET_BYTES];
    assert_eq!(remote.begin(&wrong, &mut packet), 0);
    let mut out = outputs();
    let (driven, _) = remote.finish(&wrong, &mut out);
    assert_eq!((driven.cause, out.forward), (Cause::Setpoint, 0));
}

/// A period whose setpoint or answer is lost; gives what was sent.
fn lost(remote: &mut Remote, inputs: &Inputs) -> Flags {
    let mut packet = [0; PACKET_BYTES];
    let bytes = remote.begin(inputs, &mut packet);
    let setpoint = sent(&packet[..bytes]);
    remote.finish(inputs, &mut outputs());
    setpoint.flags
}

#[test]
fn what_ends_an_arming_is_said_again_until_it_was_heard() {
    let events = [
        (ON & !Switches::PROGRAM_RUNNING.0, Flags::ABORT),
        (ON | Switches::DISARM.0, Flags::PROGRAM_END),
        (ON | Switches::TOOL_CHANGE.0, Flags::TOOL_CHANGE),
    ];
    for (bits, expected) in events {
        let (mut remote, on) = ready();
        period(&mut remote, &on, Mode::Active, [900, 0]);
        assert!(lost(&mut remote, &with(&on, bits)).has(expected));
        assert!(lost(&mut remote, &on).has(expected), "{expected:?}");
        let (setpoint, ..) = period(&mut remote, &on, Mode::Active, [900, 0]);
        assert!(setpoint.flags.has(expected));
        let (setpoint, ..) = period(&mut remote, &on, Mode::Fault, [800, 0]);
        assert!(!setpoint.flags.has(expected), "once heard it is not said any more");
    }
}

#[test]
fn drives_that_go_while_a_setpoint_is_lost_end_an_arming_all_the_same() {
    let (mut remote, on) = ready();
    period(&mut remote, &on, Mode::Armed, [0; 2]);
    lost(&mut remote, &with(&on, ON & !Switches::DRIVES_ON.0));
    let (setpoint, ..) = period(&mut remote, &on, Mode::Armed, [0; 2]);
    assert!(setpoint.flags.has(Flags::ABORT));
}

#[test]
fn another_program_tool_or_unit_ends_what_is_armed() {
    let events: [fn(&mut Inputs); 3] =
        [|pins| pins.program_crc ^= 1, |pins| pins.tool = 9, |pins| pins.nm_per_unit = 25.4e6];
    for (index, event) in events.into_iter().enumerate() {
        let (mut remote, on) = ready();
        period(&mut remote, &on, Mode::Armed, [0; 2]);
        period(&mut remote, &on, Mode::Active, [900, 0]);
        let mut other = on;
        event(&mut other);
        let (setpoint, out, _) = period(&mut remote, &other, Mode::Active, [890, 0]);
        assert!(setpoint.flags.has(Flags::ABORT.with(Flags::TOOL_CHANGE)), "event {index}");
        assert_eq!(setpoint.axes[0], 1_000_000);
        assert!((out.motor_pos_cmd[0] - 11.000_89).abs() < 1e-9, "nothing jumps: {}", out.motor_pos_cmd[0]);
        for _ in 0..3 {
            period(&mut remote, &other, Mode::Bypass, [0; 2]);
        }
        let (setpoint, ..) = period(&mut remote, &other, Mode::Bypass, [0; 2]);
        assert!(!setpoint.flags.has(Flags::ABORT.with(Flags::TOOL_CHANGE)), "event {index}");
    }
}

#[test]
fn while_the_link_is_lost_the_pins_say_off_and_why() {
    let (mut remote, on) = ready();
    period(&mut remote, &on, Mode::Active, [900, 0]);
    let mut out = outputs();
    for state in [3, 3, 0, 0] {
        remote.begin(&on, &mut [0; PACKET_BYTES]);
        remote.finish(&on, &mut out);
        assert_eq!((out.state, out.correction_nm), (state, [900, 0, 0]));
    }
    assert_eq!((out.reason, out.fault, out.forward), (u32::from(Reason::Silence.code()), 1, 0));
    let off = with(&on, ON & !Switches::DRIVES_ON.0);
    let (.., cause) = (0..10).map(|_| period(&mut remote, &off, Mode::Bypass, [0; 2])).last().unwrap();
    assert_eq!(cause, Cause::None);
    let (_, out, _) = period(&mut remote, &off, Mode::Bypass, [0; 2]);
    assert_eq!((out.state, out.reason), (1, 0));
}
