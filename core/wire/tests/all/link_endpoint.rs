//! Whatever the setpoint link does, in every mode: what goes out, what the state becomes, within how many ticks.

use crate::link_support;
use link_support::*;
use truepath_wire::link::{Endpoint, LinkError, Verdict};
use truepath_wire::rewrite::{Flags, Mode, Output, Reason, Refusal, State};

/// Where a broken sequence leads.
fn broken(mode: Mode) -> Mode {
    match mode {
        Mode::Armed => Mode::Bypass,
        Mode::Active | Mode::Hold => Mode::Fault,
        other => other,
    }
}

/// An answer must be what its mode permits.
#[track_caller]
fn permitted(wire: &Wire, out: &Output) {
    assert_eq!(out.forward, out.mode != Mode::Off);
    assert_eq!(wire.endpoint.drive_enable(), out.forward);
    match out.mode {
        Mode::Off => assert_eq!(out.correction_nm, [0; 6]),
        Mode::Bypass | Mode::Armed => assert!(is_plain(out, &wire.next)),
        _ => assert_eq!(out.uncorrected(&out.axes), wire.next.axes),
    }
}

/// How far the correction may have moved in some ticks, nm.
fn reach(wire: &Wire, ticks: u32) -> i64 {
    ((i64::from(wire.rewriter.limits().unwrap().velocity().bits()) * i64::from(ticks)) >> 8) + 1
}

#[track_caller]
fn near(wire: &Wire, before: &Output, after: &Output, ticks: u32) {
    for axis in 0..6 {
        let moved = i64::from(after.correction_nm[axis]) - i64::from(before.correction_nm[axis]);
        assert!(moved.abs() <= reach(wire, ticks), "axis {axis} jumped by {moved} nm in {ticks} ticks");
    }
}

#[test]
fn a_few_lost_frames_are_corrected_over_in_every_mode() {
    for mode in MODES {
        for lost in 1..=2 {
            let mut wire = Wire::in_mode(mode);
            let before = wire.go_on().output();
            wire.lose(lost);
            let came = wire.go_on();
            assert_eq!(came.verdict, Verdict::Lost(lost));
            permitted(&wire, &came.output());
            near(&wire, &before, &came.output(), lost + 1);
            assert_eq!(came.output().mode, mode, "{lost} lost");
        }
    }
}

#[test]
fn more_lost_frames_or_a_sequence_from_elsewhere_end_what_is_armed_or_active() {
    for mode in MODES {
        for lost in [3, 100, 1 << 20, 1 << 31] {
            let mut wire = Wire::in_mode(mode);
            let before = wire.go_on().output();
            let reason = wire.endpoint.state().reason();
            wire.next.sequence = wire.next.sequence.wrapping_add(lost);
            let came = wire.stay();
            assert_eq!(came.verdict, Verdict::Jump);
            let out = came.output();
            permitted(&wire, &out);
            near(&wire, &before, &out, 1);
            assert_eq!(out.mode, broken(mode));
            let changed = broken(mode) != mode;
            assert_eq!(out.reason, if changed { Reason::SequenceBroken } else { reason });
            assert_eq!(wire.endpoint.counters().faults_of(Reason::SequenceBroken), u32::from(changed));
            if out.mode == Mode::Fault {
                wire.ramp_out();
            }
        }
    }
}

#[test]
fn a_damaged_frame_changes_nothing_and_is_not_answered_in_every_mode() {
    for mode in MODES {
        let mut wire = Wire::in_mode(mode);
        wire.go_on();
        let before = *wire.endpoint.state();
        let [x, y, z, ..] = wire.next.axes;
        let mut packet = wire.packet([x, y, z]);
        packet[9] ^= 0x55;
        let came = wire.receive(&packet).unwrap();
        assert!(matches!(came.verdict, Verdict::Damaged(LinkError::Checksum { .. } | LinkError::Stuffing)));
        assert_eq!((came.answer, *wire.endpoint.state()), (None, before));
        // The next good one sees a gap of one.
        let came = wire.stay();
        assert_eq!((came.verdict, came.output().mode), (Verdict::Lost(1), mode));
    }
}

#[test]
fn a_repeated_frame_is_neither_followed_nor_answered_in_every_mode() {
    for mode in MODES {
        let mut wire = Wire::in_mode(mode);
        wire.go_on();
        let before = *wire.endpoint.state();
        let again = packet_of(&wire.next);
        for _ in 0..10 {
            assert_eq!(wire.receive(&again), Some(Came { verdict: Verdict::Repeated, answer: None }));
        }
        assert_eq!(*wire.endpoint.state(), before);
        assert_eq!(wire.go_on().output().mode, mode);
    }
}

#[test]
fn an_exchanged_pair_is_a_lost_frame_and_a_late_one_in_every_mode() {
    for mode in MODES {
        let mut wire = Wire::in_mode(mode);
        let before = wire.go_on().output();
        let [x, y, z, ..] = wire.next.axes;
        let way = if mode == Mode::Active { FEED } else { 0 };
        let first = wire.packet([x + way, y, z]);
        let second = wire.packet([x + 2 * way, y, z]);
        let came = wire.receive(&second).unwrap();
        assert_eq!((came.verdict, came.output().mode), (Verdict::Lost(1), mode));
        near(&wire, &before, &came.output(), 2);
        let state = *wire.endpoint.state();
        assert_eq!(wire.receive(&first), Some(Came { verdict: Verdict::OutOfOrder, answer: None }));
        assert_eq!(*wire.endpoint.state(), state);
        assert_eq!(wire.go_on().verdict, Verdict::Accepted);
    }
}

#[test]
fn a_late_answer_is_withheld_and_counts_like_a_lost_frame_in_every_mode() {
    for mode in MODES {
        let mut wire = Wire::in_mode(mode);
        let before = wire.go_on().output();
        let deadline = u64::from(wire.endpoint.settings().deadline_us);
        wire.delay_us = deadline;
        assert!(wire.go_on().answer.is_some(), "at the deadline it is in time");
        wire.delay_us = deadline + 1;
        for late in 1..=2 {
            let came = wire.go_on();
            assert_eq!((came.verdict, came.answer), (Verdict::Accepted, None));
            assert_eq!(wire.endpoint.counters().late, late);
        }
        wire.delay_us = 0;
        let out = wire.go_on().output();
        permitted(&wire, &out);
        near(&wire, &before, &out, 4);
        assert_eq!(out.mode, mode, "two late answers are borne");

        wire.delay_us = deadline + 1;
        for _ in 0..3 {
            assert_eq!(wire.go_on().answer, None);
        }
        wire.delay_us = 0;
        let out = wire.stay().output();
        permitted(&wire, &out);
        assert_eq!(out.mode, broken(mode), "three are not");
        if mode == Mode::Active || mode == Mode::Hold {
            assert_eq!(out.reason, Reason::SequenceBroken);
            wire.ramp_out();
        }
    }
}

#[test]
fn an_answer_that_is_never_fetched_counts_as_late() {
    let mut wire = Wire::active();
    for lost in 0..4 {
        let [x, y, z, ..] = wire.next.axes;
        let mut packet = wire.packet([x + FEED, y, z]);
        packet.pop();
        let verdict = wire.endpoint.packet(&wire.rewriter, &mut packet, wire.now_us);
        assert_eq!(verdict, Verdict::Accepted);
        assert_eq!(wire.endpoint.counters().late, lost);
    }
    assert_eq!((wire.endpoint.mode(), wire.endpoint.state().reason()), (Mode::Fault, Reason::SequenceBroken));
}

#[test]
fn silence_drops_the_drives_in_every_mode_and_nothing_goes_out_until_they_are_acknowledged_as_disabled() {
    for mode in MODES {
        let mut wire = Wire::in_mode(mode);
        wire.go_on();
        let silence = u64::from(wire.endpoint.settings().silence_us);
        let heard = wire.now_us;
        assert!(!wire.endpoint.watch(&wire.rewriter, heard + silence - 1));
        assert_eq!(wire.endpoint.mode(), mode);
        assert_eq!(wire.endpoint.watch(&wire.rewriter, heard + silence), mode != Mode::Off);
        assert!(!wire.endpoint.watch(&wire.rewriter, heard + silence + 1), "once");
        assert_eq!((wire.endpoint.mode(), wire.endpoint.drive_enable()), (Mode::Off, false));
        let times = u32::from(mode != Mode::Off);
        let c = wire.endpoint.counters();
        assert_eq!((c.silences, c.faults_of(Reason::Silence)), (times, times));
        // The controller comes back, counting from anywhere, its drives still enabled.
        let armed_before = !matches!(mode, Mode::Off | Mode::Bypass);
        wire.now_us = heard + silence + 10;
        assert_eq!(wire.endpoint.acknowledge(&wire.rewriter, wire.now_us), Err(Refusal::NoSetpoints));
        wire.next.sequence = wire.next.sequence.wrapping_sub(if armed_before { 30 } else { 1 << 31 });
        wire.next.flags = Flags::DRIVES_ENABLED;
        let back = wire.stay();
        assert_eq!(back.verdict, Verdict::Accepted, "after a silence any sequence is a beginning");
        for _ in 0..5 {
            let out = wire.stay().output();
            assert_eq!((out.mode, out.forward, out.correction_nm), (Mode::Off, false, [0; 6]));
        }
        assert_eq!(wire.endpoint.acknowledge(&wire.rewriter, wire.now_us), Err(Refusal::DrivesEnabled));
        wire.next.flags = Flags::default();
        wire.stay();
        wire.endpoint.acknowledge(&wire.rewriter, wire.now_us).unwrap();
        let out = wire.stay().output();
        assert!(is_plain(&out, &wire.next));
        wire.measured();
        let armed = wire.endpoint.arm(&wire.rewriter, &wire.request);
        assert_eq!(armed, if armed_before { Err(Refusal::PartRepeated { part_serial: 1 }) } else { Ok(()) });
    }
}

#[test]
fn a_reset_in_every_mode_ends_in_off_and_remembers_the_part() {
    for mode in MODES {
        let mut wire = Wire::in_mode(mode);
        wire.go_on();
        wire.endpoint = Endpoint::new(*wire.endpoint.settings(), *wire.endpoint.state().spent());
        for _ in 0..3 {
            let out = wire.stay().output();
            assert_eq!((out.mode, out.forward, out.correction_nm), (Mode::Off, false, [0; 6]));
        }
        let armed_before = !matches!(mode, Mode::Off | Mode::Bypass);
        assert_eq!(wire.endpoint.state().spent().last().is_some(), armed_before);
    }
}

#[test]
fn off_is_left_only_while_setpoints_arrive_and_say_that_the_drives_are_disabled() {
    let mut wire = Wire::reset();
    assert_eq!(wire.endpoint.acknowledge(&wire.rewriter, 0), Err(Refusal::NoSetpoints));
    wire.next.flags = Flags::DRIVES_ENABLED;
    wire.stay();
    assert_eq!(wire.endpoint.acknowledge(&wire.rewriter, wire.now_us), Err(Refusal::DrivesEnabled));
    wire.next.flags = Flags::default();
    wire.stay();
    let stale = wire.now_us + u64::from(wire.endpoint.settings().silence_us);
    assert_eq!(wire.endpoint.acknowledge(&wire.rewriter, stale), Err(Refusal::NoSetpoints));
    assert_eq!(wire.endpoint.acknowledge(&wire.rewriter, stale - 1), Ok(()));
}

#[test]
fn a_check_says_what_arming_would_and_changes_nothing() {
    let wire = Wire::bypass();
    let before: State = *wire.endpoint.state();
    let spent = wire.endpoint.check(&wire.rewriter, &wire.request).unwrap();
    assert_eq!((spent.part_serial, spent.program_crc), (1, wire.request.binding.program_crc));
    assert_eq!(*wire.endpoint.state(), before);
    let mut other = wire.request;
    other.binding.tool += 1;
    assert!(matches!(wire.endpoint.check(&wire.rewriter, &other), Err(Refusal::Identity { .. })));
    let mut wire = Wire::armed();
    assert_eq!(wire.endpoint.check(&wire.rewriter, &wire.request), Err(Refusal::State(Mode::Armed)));
    wire.endpoint.disarm(&wire.rewriter).unwrap();
    assert_eq!((wire.endpoint.mode(), wire.endpoint.state().reason()), (Mode::Bypass, Reason::Disarmed));
}

#[test]
fn an_answer_at_its_deadline_is_given_and_one_a_microsecond_later_is_not() {
    let mut wire = Wire::bypass();
    for (delay_us, given) in [(500, true), (501, false), (499, true)] {
        wire.delay_us = delay_us;
        assert_eq!(wire.stay().answer.is_some(), given, "{delay_us} us");
    }
    assert_eq!(wire.endpoint.counters().late, 1);
}

#[test]
fn messages_are_counted_by_whether_they_were_damaged() {
    let mut endpoint = Wire::reset().endpoint;
    for damaged in [false, true, false, false] {
        endpoint.count_message(damaged);
    }
    assert_eq!((endpoint.counters().messages, endpoint.counters().messages_damaged), (3, 1));
}

#[test]
fn a_fault_is_told_once_and_settings_change_only_in_off() {
    let mut wire = Wire::active();
    assert_eq!(wire.endpoint.take_fault(), None);
    wire.next.flags = wire.next.flags.with(Flags::EMERGENCY_STOP);
    wire.stay();
    wire.stay();
    assert_eq!(wire.endpoint.counters().faults_of(Reason::EmergencyStop), 1);
    assert_eq!((wire.endpoint.take_fault(), wire.endpoint.take_fault()), (Some(Reason::EmergencyStop), None));
    // Every fault is told with its number of times, no regular end is.
    let told: Vec<_> = wire.endpoint.counters().by_fault().collect();
    let faults = Reason::ALL.into_iter().filter(|reason| reason.is_fault());
    assert_eq!(told, faults.map(|r| (r, u32::from(r == Reason::EmergencyStop))).collect::<Vec<_>>());
    assert_eq!(told.len(), Reason::FAULTS);
    let settings = *wire.endpoint.settings();
    assert_eq!(wire.endpoint.configure(settings), Err(Refusal::State(Mode::Fault)));
    assert_eq!(Wire::reset().endpoint.configure(settings), Ok(()));
}

#[test]
fn on_the_way_out_a_broken_sequence_changes_neither_state_nor_reason() {
    let mut wire = Wire::active();
    wire.endpoint.disarm(&wire.rewriter).unwrap();
    wire.stay();
    wire.lose(10);
    let out = wire.stay().output();
    assert_eq!((out.mode, out.reason), (Mode::Active, Reason::Disarmed));
    wire.ramp_out();
    assert_eq!(wire.endpoint.counters().faults, [0; Reason::FAULTS]);
}

#[test]
fn switched_off_it_forgets_what_the_controller_said_about_its_drives() {
    let wire = Wire::bypass();
    let mut state = *wire.endpoint.state();
    wire.rewriter.power_off(&mut state, Reason::Silence);
    assert_eq!((state.mode(), state.reason()), (Mode::Off, Reason::Silence));
    assert_eq!(wire.rewriter.acknowledge_drives_disabled(&mut state), Err(Refusal::DrivesEnabled));
}
