//! Every safety fault: the reason is named, the correction ramps to zero in the stated time, then positions pass.

use crate::rewrite_support;
use rewrite_support::*;
use truepath_wire::rewrite::{Flags, Mode, Output, Reason, Refusal, Rewriter, Settings, Status};

/// Runs to the middle of the path, does something, and expects a fault with a ramp to bypass.
fn expect(reason: Reason, act: impl FnOnce(&mut Machine) -> Output) {
    let mut m = Machine::on(straight()).active();
    m.forward(700);
    let out = act(&mut m);
    assert_eq!((out.mode, out.reason), (Mode::Fault, reason));
    assert_ne!(out.correction_nm, [0; 6], "the correction must not jump");
    m.settle();
    assert_eq!(m.state.reason(), reason, "the reason stays");
    assert!(is_plain(&m.stay(), &m.next.clone()));
    m.request.part_serial += 1;
    m.next.flags = Flags::DRIVES_ENABLED;
    m.rewriter.arm(&mut m.state, &m.request).unwrap();
    assert_eq!(m.state.reason(), Reason::None);
}

fn with_flag(flag: Flags) -> impl FnOnce(&mut Machine) -> Output {
    move |m| {
        m.next.flags = m.next.flags.with(flag);
        m.forward(1)
    }
}

#[test]
fn an_emergency_stop_is_a_fault() {
    expect(Reason::EmergencyStop, with_flag(Flags::EMERGENCY_STOP));
}
#[test]
fn an_abort_is_a_fault() {
    expect(Reason::Abort, with_flag(Flags::ABORT));
}
#[test]
fn a_tool_change_is_a_fault() {
    expect(Reason::ToolChange, with_flag(Flags::TOOL_CHANGE));
}
#[test]
fn disabled_drives_are_a_fault() {
    expect(Reason::DrivesDisabled, |m| {
        m.next.flags = Flags::default();
        m.stay()
    });
}
#[test]
fn a_changed_frame_is_a_fault() {
    expect(Reason::FrameChanged, |m| {
        m.next.frame_crc ^= 0x10;
        m.stay()
    });
}
#[test]
fn a_changed_image_is_a_fault() {
    expect(Reason::ImageChanged, |m| {
        let mut other = settings();
        other.limits.warn = other.limits.clamp;
        m.rewriter = Rewriter::new(Settings::at_1_khz(), Some(image_with(&other, &nodes(straight())))).unwrap();
        m.stay()
    });
}
#[test]
fn a_rapid_is_a_fault() {
    expect(Reason::Jump, |m| {
        let x = m.next.axes[0];
        m.send(x + MM + 1, 0, PASS)
    });
}
#[test]
fn a_setpoint_in_another_room_is_a_fault() {
    expect(Reason::OffPath, |m| m.send(i64::MAX, 0, PASS));
}
#[test]
fn leaving_the_path_sideways_is_a_fault() {
    expect(Reason::OffPath, |m| {
        let x = m.next.axes[0];
        assert_eq!(m.send(x, 200_000, PASS).mode, Mode::Active);
        m.send(x, 200_002, PASS)
    });
}
#[test]
fn going_back_farther_than_the_tolerance_is_a_fault() {
    expect(Reason::Backwards, |m| {
        let x = m.next.axes[0];
        for i in 1..=29 {
            assert_eq!(m.send(x - i * FEED, 0, PASS).mode, Mode::Active);
        }
        m.send(x - 30 * FEED, 0, PASS)
    });
}
#[test]
fn rising_in_the_middle_of_the_path_is_a_fault() {
    expect(Reason::LeftPass, |m| {
        let x = m.next.axes[0];
        assert_eq!(m.send(x, 0, PASS + 200_000).mode, Mode::Active);
        m.send(x, 0, PASS + 200_001)
    });
}
#[test]
fn going_below_the_pass_is_a_fault() {
    expect(Reason::BelowPass, |m| {
        let x = m.next.axes[0];
        m.send(x, 0, PASS - 200_001)
    });
}
#[test]
fn a_repeated_setpoint_is_a_fault() {
    expect(Reason::SequenceBroken, |m| {
        m.next.sequence -= 1;
        m.stay()
    });
}
#[test]
fn losing_more_setpoints_than_permitted_is_a_fault_and_fewer_are_not() {
    expect(Reason::SequenceBroken, |m| {
        m.next.sequence += 2;
        let x = m.next.axes[0];
        assert_eq!(m.send(x + 3 * FEED, 0, PASS).mode, Mode::Active);
        m.next.sequence += 3;
        m.send(x + 7 * FEED, 0, PASS)
    });
}

#[test]
fn leaving_the_gate_without_going_down_is_a_fault() {
    for (x, y, z) in [(210_000, 0, GATE), (0, 0, CLEAR)] {
        let mut m = Machine::on(straight()).armed();
        for _ in 0..100 {
            m.send(0, 0, GATE);
        }
        let out = m.send(x, y, z);
        assert_eq!((out.mode, out.reason), (Mode::Fault, Reason::LeftGate));
        m.settle();
    }
}

#[test]
fn a_correction_that_would_pass_a_joint_limit_is_a_fault_and_the_output_stays_inside() {
    let mut limited = Settings::at_1_khz();
    // The correction in Y is positive: at most 10 µm are left.
    limited.joint_limits_nm[1] = (i64::MIN, 10_000);
    let mut m = Machine::new(limited, image_with(&settings(), &nodes(straight()))).armed();
    let mut faulted = false;
    for _ in 0..300 {
        let out = m.send(0, 0, GATE);
        assert!(out.axes[1] <= 10_000);
        faulted |= out.reason == Reason::JointLimit;
    }
    assert!(faulted && m.state.mode() == Mode::Bypass);

    // The limit comes nearer while the correction is on: the setpoint moves towards it.
    limited.joint_limits_nm[1] = (i64::MIN, 100_000);
    let mut m = Machine::new(limited, image_with(&settings(), &nodes(straight()))).active();
    let mut held = false;
    for y in [0, 60_000, 80_000, 90_000, 99_000, 100_000] {
        let out = m.send(0, y, PASS);
        held |= out.status.has(Status::JOINT_LIMITED);
        assert!(out.axes[1] <= 100_000, "{out:?}");
    }
    assert!(held);
}

#[test]
fn taking_the_image_away_in_the_cut_drops_the_drives_instead_of_jumping() {
    let mut m = Machine::on(straight()).active();
    m.forward(100);
    m.rewriter = Rewriter::new(Settings::at_1_khz(), None).unwrap();
    let out = m.stay();
    assert_eq!((out.mode, out.forward, out.reason), (Mode::Off, false, Reason::ImageChanged));
    // The drives were enabled by the last setpoint.
    assert_eq!(m.rewriter.acknowledge_drives_disabled(&mut m.state), Err(Refusal::DrivesEnabled));
    m.stay();
    assert_eq!(m.rewriter.acknowledge_drives_disabled(&mut m.state), Err(Refusal::DrivesEnabled));
    let flags = m.next.flags;
    m.next.flags = Flags::default();
    m.stay();
    assert_eq!(m.rewriter.acknowledge_drives_disabled(&mut m.state), Ok(()));
    m.next.flags = flags;
    assert!(is_plain(&m.stay(), &m.next.clone()));
}
