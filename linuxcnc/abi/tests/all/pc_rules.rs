//! LinuxCNC's events and what they do to a correction.

use crate::pc_support;
use crate::rewrite_support::*;
use pc_support::*;
use truepath_abi::pc::{PROBING, Switches};
use truepath_core::rewrite::{Flags, Reason};

fn reason(pc: &Pc) -> u32 {
    pc.last.reason
}

const fn code(reason: Reason) -> u32 {
    reason.code() as u32
}

#[test]
fn after_loading_nothing_is_enabled_until_the_drives_are_seen_off() {
    let mut pc = Pc::load(&[]);
    pc.set(Switches::DRIVES_ON, true);
    for _ in 0..50 {
        let out = pc.period();
        assert_eq!((out.state, out.forward), (OFF, 0));
        assert!(untouched(&pc.next, &out));
    }
    pc.set(Switches::DRIVES_ON, false);
    assert_eq!(pc.period().state, BYPASS);
    assert_eq!(pc.period().forward, 1);
}

#[test]
fn an_event_while_active_ramps_the_correction_out_and_its_reason_stays() {
    type Event = fn(&mut Pc);
    let events: [(Event, Reason); 11] = [
        (|pc| pc.set(Switches::EMERGENCY_STOP, true), Reason::EmergencyStop),
        (|pc| pc.set(Switches::PROGRAM_RUNNING, false), Reason::Abort),
        (|pc| pc.set(Switches::DRIVES_ON, false), Reason::DrivesDisabled),
        (|pc| pc.set(Switches::ALL_HOMED, false), Reason::DrivesDisabled),
        (|pc| pc.set(Switches::TOOL_CHANGE, true), Reason::ToolChange),
        (|pc| pc.next.offset[1] += 1e-6, Reason::FrameChanged),
        (|pc| pc.next.sine = 1, Reason::FrameChanged),
        (|pc| pc.next.offset[2] = f64::NAN, Reason::FrameChanged),
        (|pc| pc.next.motion_type = PROBING, Reason::Abort),
        (|pc| pc.next.program_crc ^= 1, Reason::Abort),
        (|pc| pc.next.tool = 4, Reason::ToolChange),
    ];
    for (event, expected) in events {
        let mut pc = Pc::active();
        event(&mut pc);
        pc.period();
        assert_eq!((pc.last.state, reason(&pc), pc.last.fault), (FAULT, code(expected), 1));
        assert_ne!(pc.last.correction_nm, [0; 3], "it does not jump");
        pc.ramp();
        assert!(untouched(&pc.next, &pc.last));
        assert_eq!((reason(&pc), pc.last.forward), (code(expected), 1));
        // What armed it is not armed again.
        assert_eq!(pc.periods(100).state, BYPASS);
    }
}

#[test]
fn disarming_and_the_master_switch_ramp_it_out_without_a_fault() {
    for switch in [Switches::DISARM, Switches::ENABLE] {
        let mut pc = Pc::active();
        pc.set(switch, switch == Switches::DISARM);
        pc.period();
        assert_eq!((pc.last.state, reason(&pc), pc.last.fault), (ACTIVE, code(Reason::Disarmed), 0));
        pc.ramp();
        let mut pc = Pc::armed();
        pc.set(switch, switch == Switches::DISARM);
        assert_eq!(pc.period().state, BYPASS);
    }
}

#[test]
fn what_ends_an_arming() {
    type Event = fn(&mut Pc);
    let events: [(Event, Reason); 9] = [
        (|pc| pc.set(Switches::PROGRAM_RUNNING, false), Reason::ProgramEnd),
        (|pc| pc.set(Switches::EMERGENCY_STOP, true), Reason::EmergencyStop),
        (|pc| pc.set(Switches::DRIVES_ON, false), Reason::Abort),
        (|pc| pc.set(Switches::ALL_HOMED, false), Reason::Abort),
        (|pc| pc.set(Switches::TOOL_CHANGE, true), Reason::ToolChange),
        (|pc| pc.next.offset[0] = 1.0, Reason::FrameChanged),
        (|pc| pc.set(Switches::TRIVIAL_KINEMATICS, false), Reason::Disarmed),
        (|pc| pc.next.program_crc ^= 1, Reason::Abort),
        (|pc| pc.next.tool = 4, Reason::ToolChange),
    ];
    for (event, expected) in events {
        let mut pc = Pc::armed();
        event(&mut pc);
        pc.period();
        assert_eq!((pc.last.state, reason(&pc)), (BYPASS, code(expected)));
    }
}

#[test]
fn a_program_that_was_not_started_yet_may_be_armed_and_a_start_ends_nothing() {
    let mut pc = Pc::ready(&[]);
    assert_eq!(pc.arm(), 0);
    assert_eq!(pc.periods(10).state, ARMED);
    pc.set(Switches::PROGRAM_RUNNING, true);
    assert_eq!(pc.periods(10).state, ARMED);
}

#[test]
fn a_probing_move_keeps_the_gate_shut_while_armed() {
    let mut pc = Pc::armed();
    pc.next.motion_type = PROBING;
    for i in 0..=100 {
        let out = pc.go(0, 0, GATE + (PASS - GATE) * i / 100);
        assert_eq!((out.state, out.feed_inhibit), (ARMED, 0));
        assert!(untouched(&pc.next, &out));
        assert!(!Flags(out.flags as u16).has(Flags::DRIVES_ENABLED));
    }
    // The same way once more, milling.
    pc.next.motion_type = 2;
    pc.go(0, 0, CLEAR);
    for i in 0..=100 {
        pc.go(0, 0, GATE + (PASS - GATE) * i / 100);
    }
    assert_eq!(pc.last.state, ACTIVE);
}

#[test]
fn without_a_running_program_nothing_goes_through_the_gate() {
    let mut pc = Pc::ready(&[]);
    assert_eq!(pc.arm(), 0);
    for i in 0..=100 {
        let out = pc.go(0, 0, GATE + (PASS - GATE) * i / 100);
        assert_eq!(out.state, ARMED);
        assert!(untouched(&pc.next, &out));
    }
    // The same way once more, in the program.
    pc.set(Switches::PROGRAM_RUNNING, true);
    pc.go(0, 0, CLEAR);
    for i in 0..=100 {
        pc.go(0, 0, GATE + (PASS - GATE) * i / 100);
    }
    assert_eq!(pc.last.state, ACTIVE);
}

#[test]
fn a_probing_move_waits_until_the_correction_is_out() {
    let mut pc = Pc::active();
    pc.next.motion_type = PROBING;
    let mut inhibited = 0;
    loop {
        let out = pc.period();
        assert_eq!(out.feed_inhibit != 0, out.state != BYPASS);
        if out.feed_inhibit == 0 {
            break;
        }
        inhibited += 1;
    }
    assert!((2..200).contains(&inhibited), "{inhibited}");
    assert!(untouched(&pc.next, &pc.last));
    assert_eq!(reason(&pc), code(Reason::Abort));
}

#[test]
fn a_hold_keeps_the_correction_and_a_spindle_that_stops_or_has_no_load_fades_it() {
    let mut pc = Pc::active();
    pc.set(Switches::FEED_HOLD, true);
    let held = pc.period().correction_nm;
    pc.periods(200);
    assert_eq!(pc.last.state, HOLD);
    for (now, then) in pc.last.correction_nm.iter().zip(held) {
        assert!((now - then).abs() < 2_000, "{now} {then}");
    }
    for switch in [Switches::SPINDLE_ON, Switches::SPINDLE_LOADED] {
        let mut pc = Pc::active();
        pc.set(switch, false);
        let mut x = 499 * FEED;
        for _ in 0..400 {
            x += FEED;
            pc.go(x, 0, PASS);
        }
        assert_eq!((pc.last.state, pc.last.correction_nm), (ACTIVE, [0; 3]));
        pc.set(switch, true);
        for _ in 0..300 {
            x += FEED;
            pc.go(x, 0, PASS);
        }
        assert!(pc.last.correction_nm[0].abs() > 10_000);
    }
}

#[test]
fn another_request_while_a_correction_is_on_does_not_end_it() {
    let mut pc = Pc::active();
    (pc.next.feature, pc.next.pass, pc.next.part_serial) = (9, 9, 9);
    assert_eq!(pc.periods(3).state, ACTIVE);
}

#[test]
fn a_position_that_is_no_length_goes_through_as_it_is_and_takes_the_drives_with_the_correction() {
    for wrong in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e12] {
        for motor in [false, true] {
            let mut pc = Pc::active();
            if motor {
                pc.next.motor_pos_cmd[3] = wrong
            } else {
                pc.next.pos_cmd[0] = wrong
            };
            let on = pc.last.correction_nm;
            let out = pc.period();
            if motor {
                assert!((out.motor_pos_cmd[3] - wrong).abs() < 1.0 || !wrong.is_finite(), "{wrong}");
                assert_eq!(out.motor_pos_cmd[3].is_finite(), wrong.is_finite());
            }
            assert_eq!((out.state, out.forward, reason(&pc)), (OFF, 0, code(Reason::Jump)));
            assert_eq!(out.correction_nm, on, "it does not jump");
            pc.go(0, 0, CLEAR);
            assert_eq!(pc.periods(10).forward, 0, "until the drives are off");
            pc.set(Switches::DRIVES_ON, false);
            pc.periods(2);
            assert_eq!((pc.last.state, pc.last.forward), (BYPASS, 1));
            assert!(untouched(&pc.next, &pc.last));

            let mut pc = Pc::armed();
            if motor {
                pc.next.motor_pos_cmd[3] = wrong
            } else {
                pc.next.pos_cmd[0] = wrong
            };
            let out = pc.period();
            assert!(untouched(&pc.next, &out));
            assert_eq!((out.state, out.forward), (BYPASS, 1), "nothing was on that could be lost");
        }
    }
}
