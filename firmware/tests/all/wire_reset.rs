//! Resets in every state, and what the device then does to the axes.

use crate::wire_support;
use truepath_core::link::{Ask, Denial, ResetCause};
use truepath_core::rewrite::{Flags, Mode, Output, Reason, Refusal};
use truepath_fw::config_service::Restart;
use wire_support::part::{CLEAR, FEED, GATE, PASS, along, straight};
use wire_support::*;

const MODES: [Mode; 6] = [Mode::Off, Mode::Bypass, Mode::Armed, Mode::Active, Mode::Hold, Mode::Fault];

/// A device in a mode, the cutter in the pass.
fn in_mode(mode: Mode) -> Rig {
    let image = image_of(straight());
    let mut rig = match mode {
        Mode::Off | Mode::Bypass | Mode::Armed => Rig::with_image(&image),
        _ => Rig::active(&image),
    };
    match mode {
        Mode::Off => rig.setpoint.flags = Flags::DRIVES_ENABLED,
        Mode::Bypass => rig.enable(),
        Mode::Armed => {
            rig.enable();
            rig.arm(1).unwrap();
        }
        Mode::Active => {}
        Mode::Hold => {
            rig.setpoint.flags = rig.setpoint.flags.with(Flags::FEED_HOLD);
            rig.stay();
        }
        Mode::Fault => {
            let [x, y, z, ..] = rig.setpoint.axes;
            rig.send(x, y + 400_000, z);
        }
    }
    if mode != Mode::Off {
        rig.stay();
    }
    assert_eq!(rig.mode(), mode);
    rig
}

fn is_uncorrected(out: &Output, rig: &Rig) -> bool {
    out.axes == rig.setpoint.axes && out.correction_nm == [0; 6]
}

#[test]
fn after_a_reset_in_any_state_nothing_is_forwarded_until_the_drives_are_acknowledged_as_disabled() {
    for mode in MODES {
        for cause in [ResetCause::PowerOn, ResetCause::BrownOut, ResetCause::Pin, ResetCause::Watchdog] {
            let mut rig = in_mode(mode);
            rig.reset(cause);
            assert!(!rig.device().drive_enable());
            // The controller knows nothing of it and goes on, drives enabled.
            rig.setpoint.flags = Flags::DRIVES_ENABLED;
            for _ in 0..30 {
                let [x, y, z, ..] = rig.setpoint.axes;
                let out = rig.send(x + FEED, y, z).unwrap();
                assert!(!out.forward && out.mode == Mode::Off, "{mode}, {cause:?}");
                assert!(is_uncorrected(&out, &rig));
            }
            assert_eq!(rig.done(Ask::AcknowledgeDrivesDisabled), Err(Denial::Refused(Refusal::DrivesEnabled)));
            assert_eq!(rig.arm(9), Err(Denial::Refused(Refusal::Off { reason: Reason::None })));
            rig.enable();
            for _ in 0..30 {
                let [x, y, z, ..] = rig.setpoint.axes;
                let out = rig.send(x + FEED, y, z).unwrap();
                assert!(out.forward && out.mode == Mode::Bypass && is_uncorrected(&out, &rig), "{mode}, {cause:?}");
            }
        }
    }
}

#[test]
fn without_setpoints_the_drives_cannot_be_acknowledged() {
    let mut rig = Rig::new();
    assert_eq!(rig.done(Ask::AcknowledgeDrivesDisabled), Err(Denial::Refused(Refusal::NoSetpoints)));
    rig.setpoint.flags = Flags::default();
    rig.stay();
    rig.wait(25);
    assert_eq!(rig.done(Ask::AcknowledgeDrivesDisabled), Err(Denial::Refused(Refusal::NoSetpoints)));
}

#[test]
fn no_axis_jumps_by_the_correction_it_loses_in_a_reset() {
    for cause in [ResetCause::Watchdog, ResetCause::PowerOn, ResetCause::Software] {
        let mut rig = in_mode(Mode::Active);
        let before = rig.stay().unwrap();
        assert!(before.correction_nm.iter().any(|&nm| nm != 0));
        rig.reset(cause);
        // What goes to the drives until they are disabled: nothing at all, so there is no step in it.
        let forwarded: Vec<Output> = (0..100).filter_map(|_| rig.stay()).filter(|out| out.forward).collect();
        assert!(forwarded.is_empty());
        assert!(!rig.status().drive_enable);
    }
}

#[test]
fn a_restart_by_request_is_answered_before_it_happens() {
    for watchdog in [false, true] {
        let mut rig = in_mode(Mode::Active);
        let mut packet = request(77, Ask::Restart { watchdog });
        packet.extend(request(78, Ask::Disarm));
        let answers = rig.raw(&packet);
        assert_eq!(answers.len(), 1, "nothing after it is carried out");
        assert_eq!(rig.restart, Some(Restart { watchdog }));
        rig.reset(if watchdog { ResetCause::Watchdog } else { ResetCause::Software });
        assert_eq!(rig.mode(), Mode::Off);
    }
}

#[test]
fn boots_are_counted_and_the_cause_is_told() {
    let mut rig = Rig::new();
    for (boots, cause) in (2..).zip([ResetCause::Watchdog, ResetCause::Pin, ResetCause::BrownOut]) {
        rig.reset(cause);
        let truepath_core::link::Reply::Hello(hello) = rig.ask(Ask::Hello).unwrap() else { panic!() };
        assert_eq!((hello.boots, hello.last_reset), (boots, cause));
    }
}

/// The whole program: plunge, path, retract. Gives whether any setpoint was corrected.
fn whole_program(rig: &mut Rig) -> bool {
    let mut corrected = false;
    let mut setpoints = vec![(0, 0, CLEAR); 3];
    setpoints.extend((0..=100).map(|i| (0, 0, GATE + (PASS - GATE) * i / 100)));
    setpoints.extend(along(&straight(), FEED).into_iter().map(|(x, y)| (x, y, PASS)));
    setpoints.extend((0..200).map(|i| (10 * part::MM, 0, PASS + i * 50_000)));
    for (x, y, z) in setpoints {
        corrected |= rig.send(x, y, z).unwrap().axes != rig.setpoint.axes;
    }
    corrected
}

#[test]
fn a_program_repeated_without_a_new_arming_runs_uncorrected_also_after_a_reset() {
    let mut rig = Rig::with_image(&image_of(straight()));
    rig.enable();
    rig.arm(1).unwrap();
    assert!(whole_program(&mut rig));
    assert!(!whole_program(&mut rig));
    rig.reset(ResetCause::PowerOn);
    rig.enable();
    assert!(!whole_program(&mut rig));
}

#[test]
fn a_spring_pass_of_the_same_part_is_refused_also_after_a_reset_and_the_next_part_is_not() {
    let mut rig = Rig::with_image(&image_of(straight()));
    rig.enable();
    rig.arm(1).unwrap();
    assert!(whole_program(&mut rig));
    let repeated = Err(Denial::Refused(Refusal::PartRepeated { part_serial: 1 }));
    assert_eq!(rig.arm(1), repeated);
    for cause in [ResetCause::PowerOn, ResetCause::Watchdog, ResetCause::Software] {
        rig.reset(cause);
        let state = rig.device().state();
        assert!(state.spent().last().is_some_and(|spent| spent.part_serial == 1), "the servo knows it too");
        rig.enable();
        assert_eq!(rig.arm(1), repeated);
        let request = rig.request(1);
        assert_eq!(rig.done(Ask::Check(request)), repeated);
        assert!(!whole_program(&mut rig));
    }
    rig.arm(2).unwrap();
    assert!(whole_program(&mut rig));
}

#[test]
fn a_part_that_was_armed_when_the_watchdog_ran_out_is_spent() {
    for mode in [Mode::Armed, Mode::Active, Mode::Hold, Mode::Fault] {
        let mut rig = in_mode(mode);
        rig.reset(ResetCause::Watchdog);
        rig.enable();
        assert_eq!(rig.arm(1), Err(Denial::Refused(Refusal::PartRepeated { part_serial: 1 })), "{mode}");
        rig.arm(2).unwrap();
    }
}

#[test]
fn a_reset_in_the_middle_of_an_arming_leaves_it_spent_or_as_if_it_had_not_been_asked_for() {
    use truepath_fw::flash::{Cut, Moment};
    for after_operations in 0..3 {
        for moment in [Moment::Before, Moment::Within(3), Moment::After] {
            let mut rig = Rig::with_image(&image_of(straight()));
            rig.enable();
            rig.cut(Cut { after_operations, moment });
            assert!(matches!(rig.arm(1), Err(Denial::Flash { .. })));
            // Denied, so it must not be armed, whatever the flash says.
            assert_eq!(rig.mode(), Mode::Bypass);
            assert!(!whole_program(&mut rig));
        }
    }
}
