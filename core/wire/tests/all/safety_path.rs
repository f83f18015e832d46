//! What controller and cutter may do while a correction is on, with the ticks of the table of `docs/safety.md`.

use crate::link_support;
use crate::safety;
use link_support::*;
use safety::row;
use truepath_wire::rewrite::{Flags, Mode, Reason, Rewriter, Settings, Status};

/// In the middle of the path; the event is one frame, made again and again until it is noticed.
fn ends(event: &str, reason: Reason, act: impl FnMut(&mut Wire) -> Came) {
    let row = row(event);
    Wire::active().ends(row.noticed, row.out, reason, act);
}

fn flagged(event: &str, reason: Reason, flag: Flags) {
    ends(event, reason, |wire| {
        wire.next.flags = wire.next.flags.with(flag);
        wire.forward(1)
    });
}

fn at(wire: &mut Wire, dx: i64, y: i64, z: i64) -> Came {
    let x = wire.next.axes[0];
    wire.send(x + dx, y, z)
}

#[test]
fn an_emergency_stop() {
    flagged("emergency stop", Reason::EmergencyStop, Flags::EMERGENCY_STOP);
}
#[test]
fn an_abort() {
    flagged("abort", Reason::Abort, Flags::ABORT);
}
#[test]
fn a_tool_change() {
    flagged("tool changed while active", Reason::ToolChange, Flags::TOOL_CHANGE);
}
#[test]
fn the_end_of_the_program() {
    flagged("end of the program (M2, M30)", Reason::ProgramEnd, Flags::PROGRAM_END);
}
#[test]
fn disabled_drives() {
    ends("drives disabled", Reason::DrivesDisabled, |wire| {
        wire.next.flags = Flags::default();
        wire.stay()
    });
}
#[test]
fn a_changed_frame() {
    ends("frame changed while active", Reason::FrameChanged, |wire| {
        wire.next.frame_crc ^= 1;
        wire.stay()
    });
}
#[test]
fn a_changed_image() {
    let mut other = settings();
    other.limits.warn = other.limits.clamp;
    let image = image_with(&other, &nodes(straight()));
    ends("image changed while active", Reason::ImageChanged, |wire| {
        wire.rewriter = Rewriter::new(Settings::at_1_khz(), Some(image)).unwrap();
        wire.forward(1)
    });
}
#[test]
fn an_image_taken_away() {
    let row = row("image taken away while active");
    let mut wire = Wire::active();
    wire.rewriter = Rewriter::new(Settings::at_1_khz(), None).unwrap();
    let out = wire.forward(1).output();
    assert_eq!((row.noticed, row.out), (Some(1), Some(0)));
    assert_eq!(
        (out.mode, out.reason, out.forward, out.correction_nm),
        (Mode::Off, Reason::ImageChanged, false, [0; 6])
    );
    assert!(!wire.endpoint.drive_enable());
}
#[test]
fn a_setpoint_off_the_contour() {
    ends("setpoint off the contour", Reason::OffPath, |wire| at(wire, 0, 200_002, PASS));
}
#[test]
fn a_setpoint_that_jumps() {
    ends("setpoint jumps by more than a feed move", Reason::Jump, |wire| at(wire, MM + 1, 0, PASS));
}
#[test]
fn a_setpoint_out_of_range() {
    let row = row("setpoint out of range, up to the ends of i64");
    for far in [i64::MAX, i64::MIN, i64::MAX - 1, -(1 << 40)] {
        for axis in 0..2 {
            let mut wire = Wire::active();
            let mut place = [wire.next.axes[0], 0];
            place[axis] = far;
            let [x, y] = place;
            wire.ends(row.noticed, row.out, Reason::OffPath, |wire| {
                let came = wire.send(x, y, PASS);
                let out = came.output();
                for axis in 0..6 {
                    let corrected = wire.next.axes[axis].saturating_add(out.correction_nm[axis].into());
                    assert_eq!(out.axes[axis], corrected);
                }
                came
            });
        }
    }
}
#[test]
fn going_backwards() {
    ends("back along the contour at feed speed, beyond the tolerance of 0.2 mm", Reason::Backwards, |wire| {
        at(wire, -FEED, 0, PASS)
    });
}
#[test]
fn leaving_the_pass() {
    ends("out of the pass, up", Reason::LeftPass, |wire| at(wire, 0, 0, PASS + 200_001));
}
#[test]
fn below_the_pass() {
    ends("out of the pass, down", Reason::BelowPass, |wire| at(wire, 0, 0, PASS - 200_001));
}
#[test]
fn a_command_to_disarm() {
    ends("disarmed by command", Reason::Disarmed, |wire| {
        wire.endpoint.disarm(&wire.rewriter).unwrap();
        wire.stay()
    });
}
#[test]
fn the_end_of_the_contour() {
    let row = row("end of the contour");
    let mut wire = Wire::active();
    while wire.next.axes[0] < 10 * MM {
        assert_eq!(wire.forward(1).output().reason, Reason::None);
    }
    // Off the end by more than the tolerance.
    wire.send(10 * MM, 0, PASS);
    wire.ends(row.noticed, row.out, Reason::Completed, |wire| wire.send(10 * MM + 200_002, 0, PASS));
}

#[test]
fn a_joint_limit() {
    let row = row("joint limit");
    // The correction in Y is positive; the setpoint comes nearer to the limit than it.
    let mut limited = Settings::at_1_khz();
    limited.joint_limits_nm[1] = (i64::MIN, 150_000);
    let limit = 150_000;
    let mut wire = Wire::active();
    wire.rewriter = Rewriter::new(limited, wire.rewriter.image().copied()).unwrap();
    wire.ends(row.noticed, row.out, Reason::JointLimit, |wire| {
        let came = at(wire, FEED, 140_000, PASS);
        let out = came.output();
        assert!(out.axes[1] <= limit && out.status.has(Status::JOINT_LIMITED), "{out:?}");
        came
    });
}

/// The ticks until the mode is another one.
fn ticks_to_hold(wire: &mut Wire) -> Option<u32> {
    let before = wire.next.axes;
    for tick in 1..100 {
        let out = wire.stay().output();
        assert_eq!(wire.next.axes, before);
        if out.mode == Mode::Hold {
            // Held for as long as it lasts.
            for _ in 0..500 {
                let later = wire.stay().output();
                assert_eq!((later.mode, later.correction_nm), (Mode::Hold, out.correction_nm));
            }
            return Some(tick);
        }
    }
    None
}

#[test]
fn a_feed_hold() {
    let row = row("feed hold, once the axes stand");
    let mut wire = Wire::active();
    wire.next.flags = wire.next.flags.with(Flags::FEED_HOLD);
    assert_eq!(wire.forward(5).output().mode, Mode::Active);
    assert_eq!(ticks_to_hold(&mut wire), row.noticed);
    wire.next.flags = Flags::DRIVES_ENABLED;
    assert_eq!(wire.forward(1).output().mode, Mode::Active);
}

#[test]
fn standing_still() {
    let row = row("standing without feed hold");
    let mut wire = Wire::active();
    assert_eq!(ticks_to_hold(&mut wire), row.noticed);
}

#[test]
fn moving_in_hold() {
    let row = row("moved away in feed hold");
    let mut wire = Wire::in_mode(Mode::Hold);
    wire.stay();
    wire.ends(row.noticed, row.out, Reason::MovedInHold, |wire| at(wire, 210_000, 0, PASS));
}

/// Ticks from the cause to the fade, and from there to no correction at all; then the correction comes back.
fn fades(event: &str, mut wire: Wire, mut cause: impl FnMut(&mut Wire), gone: impl FnOnce(&mut Wire)) {
    let row = row(event);
    let mut noticed = 0;
    loop {
        cause(&mut wire);
        noticed += 1;
        if wire.forward(1).output().status.has(Status::FADED) {
            break;
        }
        assert!(Some(noticed) < row.noticed, "not noticed after {noticed} ticks");
    }
    assert_eq!(Some(noticed), row.noticed);
    let mut out = 1;
    while wire.forward(1).output().correction_nm != [0; 6] {
        cause(&mut wire);
        out += 1;
        assert!(Some(out) <= row.out, "{out} ticks");
    }
    assert!(Some(out + 5) > row.out, "the table says more than it takes: {out} ticks");
    assert_eq!((wire.endpoint.mode(), wire.endpoint.state().reason()), (Mode::Active, Reason::None));
    gone(&mut wire);
    assert_ne!(wire.forward(260).output().correction_nm, [0; 6]);
}

#[test]
fn a_stopped_spindle() {
    let stop = |wire: &mut Wire| wire.next.spindle_millirpm = 0;
    fades("spindle stopped", Wire::active(), stop, |wire| wire.next.spindle_millirpm = SPINDLE);
}

#[test]
fn a_stale_spindle_speed() {
    let mut wire = Wire::active();
    wire.forward(1);
    // The first tick without a new speed still has the age 0.
    let mut age = 0;
    let older = move |wire: &mut Wire| {
        wire.next.spindle_age_ticks = age;
        age += 1;
    };
    fades("spindle speed not renewed", wire, older, |wire| wire.next.spindle_age_ticks = 0);
}

/// The load is asked for.
fn load_wanted(mut wire: Wire) -> Wire {
    let wanted = Settings { require_spindle_load: true, ..Settings::at_1_khz() };
    wire.rewriter = Rewriter::new(wanted, wire.rewriter.image().copied()).unwrap();
    wire
}

#[test]
fn a_spindle_without_load() {
    let mut wire = load_wanted(Wire::active());
    wire.next.flags = wire.next.flags.with(Flags::SPINDLE_LOADED);
    assert!(!wire.forward(1).output().status.has(Status::FADED));
    let air = |wire: &mut Wire| wire.next.flags = Flags::DRIVES_ENABLED;
    let cuts = |wire: &mut Wire| wire.next.flags = Flags::DRIVES_ENABLED.with(Flags::SPINDLE_LOADED);
    fades("no load on the spindle, when it is asked for", wire, air, cuts);
}

#[test]
fn a_spindle_without_load_while_the_axes_stand_or_above_the_pass() {
    let row = row("no load on the spindle while the axes stand, or above the pass");
    assert_eq!((row.noticed, row.out), (None, None));
    // Standing, in a feed hold and without.
    for flags in [Flags::DRIVES_ENABLED, Flags::DRIVES_ENABLED.with(Flags::FEED_HOLD)] {
        let mut wire = load_wanted(Wire::active());
        let before = wire.stay().output().correction_nm;
        wire.next.flags = flags;
        for _ in 0..600 {
            let out = wire.stay().output();
            assert!(!out.status.has(Status::FADED));
            assert_eq!(out.correction_nm, before);
        }
        // What has faded away when the cutter stops does not come back without a load.
        wire.next.flags = Flags::DRIVES_ENABLED;
        let faded = wire.forward(200).output().correction_nm;
        for _ in 0..600 {
            let now = wire.stay().output().correction_nm;
            assert!(now.iter().zip(faded).all(|(now, faded)| now.abs_diff(faded) < 2_000), "{now:?} {faded:?}");
        }
    }
    // Down through the gate, slowly: whole at the first contact.
    let mut wire = load_wanted(Wire::armed());
    for i in 0..600 {
        wire.send(0, 0, GATE - i);
    }
    let out = wire.stay().output();
    assert_eq!((out.mode, out.status.has(Status::FADED)), (Mode::Active, false));
    assert_ne!(out.correction_nm, [0; 6]);
}
