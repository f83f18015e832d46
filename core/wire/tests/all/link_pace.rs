//! The pace of the setpoints: nothing is armed before it is known, and one that is too fast ends the correction.

use crate::link_support;
use link_support::*;
use truepath_wire::link::Verdict;
use truepath_wire::rewrite::{Flags, Mode, Reason, Refusal, Settings};

/// What a check says of the pace.
fn refusal(wire: &Wire) -> Option<Refusal> {
    let checked = wire.endpoint.check(&wire.rewriter, &wire.request).err();
    let mut copy = wire.endpoint.clone();
    assert_eq!(copy.arm(&wire.rewriter, &wire.request).err(), checked);
    assert_eq!(copy.mode(), if checked.is_some() { Mode::Bypass } else { Mode::Armed });
    checked
}

/// In `Bypass`, with two frames since the link began.
fn begun(tick_us: u64) -> Wire {
    let mut wire = Wire::reset();
    wire.tick_us = tick_us;
    wire.stay();
    wire.endpoint.acknowledge(&wire.rewriter, wire.now_us).unwrap();
    wire.next.flags = Flags::DRIVES_ENABLED;
    wire.stay();
    wire
}

#[test]
fn nothing_is_armed_before_a_window_of_32_frames_at_a_permitted_pace() {
    let tick_hz = Settings::at_1_khz().tick_hz;
    for (tick_us, good) in [(50, false), (500, false), (666, false), (667, true), (1_000, true), (4_000, true)] {
        let mut wire = begun(tick_us);
        for _ in 0..31 {
            assert_eq!(refusal(&wire), Some(Refusal::FrameRate { tick_hz, interval_ns: 0 }));
            wire.stay();
        }
        let measured = Refusal::FrameRate { tick_hz, interval_ns: tick_us as u32 * 1_000 };
        assert_eq!(refusal(&wire), (!good).then_some(measured), "{tick_us} us");
        // A controller that slows down is armed after one window more, one that hurries no longer.
        wire.tick_us = 1_000;
        wire.measured();
        assert_eq!(refusal(&wire), None);
        wire.tick_us = 600;
        wire.measured();
        wire.measured();
        assert_eq!(refusal(&wire), Some(Refusal::FrameRate { tick_hz, interval_ns: 600_000 }));
    }
}

#[test]
fn after_a_silence_the_pace_is_unknown_again_in_off_too() {
    for mode in [Mode::Bypass, Mode::Off] {
        let mut wire = Wire::bypass();
        assert_eq!(refusal(&wire), None);
        if mode == Mode::Off {
            wire.rewriter = truepath_wire::rewrite::Rewriter::new(Settings::at_1_khz(), None).unwrap();
        }
        wire.now_us += 20_000;
        wire.endpoint.watch(&wire.rewriter, wire.now_us);
        assert_eq!(wire.endpoint.mode(), Mode::Off);
        wire.next.flags = Flags::default();
        if mode == Mode::Off {
            // A second silence, in `Off`: what comes next is a beginning as well.
            for _ in 0..20 {
                wire.stay();
            }
            wire.now_us += 20_000;
            assert!(!wire.endpoint.watch(&wire.rewriter, wire.now_us));
            wire.next.sequence -= 30;
            assert!(wire.stay().verdict.is_accepted());
            wire.rewriter = Wire::reset().rewriter;
        }
        wire.stay();
        wire.endpoint.acknowledge(&wire.rewriter, wire.now_us).unwrap();
        for _ in 0..30 {
            assert!(matches!(refusal(&wire), Some(Refusal::FrameRate { interval_ns: 0, .. })));
            wire.stay();
        }
        wire.stay();
        wire.stay();
        assert_eq!(refusal(&wire), None);
    }
}

#[test]
fn a_controller_that_counts_anew_is_measured_anew() {
    let mut wire = Wire::bypass();
    wire.forward(20);
    wire.lose(10);
    wire.tick_us = 500;
    assert_eq!(wire.stay().verdict, Verdict::Jump);
    for _ in 0..33 {
        // The window before was good, but it may have been another controller's.
        assert_eq!(refusal(&wire), Some(Refusal::FrameRate { tick_hz: 1_000, interval_ns: 0 }));
        wire.stay();
    }
    assert_eq!(refusal(&wire), Some(Refusal::FrameRate { tick_hz: 1_000, interval_ns: 500_000 }));
}

#[test]
fn lost_late_and_jittering_frames_at_the_nominal_pace_are_never_too_fast() {
    let mut wire = Wire::active();
    for i in 0..600u64 {
        // Frames come up to 0.8 of a tick late, and one in five not at all.
        wire.tick_us = 1_000 + 800 * (i % 2);
        wire.forward(1);
        wire.now_us -= 800 * (i % 2);
        if i % 5 == 0 {
            wire.tick_us = 1_000;
            wire.lose(1);
        }
        assert_eq!((wire.endpoint.mode(), wire.endpoint.state().reason()), (Mode::Active, Reason::None), "{i}");
    }
    assert_eq!(wire.endpoint.counters().faults_of(Reason::FrameRate), 0);
}

#[test]
fn slower_setpoints_keep_the_limits_and_are_no_fault() {
    let mut wire = Wire::active();
    wire.tick_us = 3_000;
    let out = wire.forward(200).output();
    assert_eq!((out.mode, out.reason), (Mode::Active, Reason::None));
}

#[test]
fn too_fast_a_pace_disarms_and_is_counted() {
    let mut wire = Wire::armed();
    wire.tick_us = 50;
    for _ in 0..64 {
        wire.stay();
    }
    assert_eq!((wire.endpoint.mode(), wire.endpoint.state().reason()), (Mode::Bypass, Reason::FrameRate));
    assert_eq!(wire.endpoint.counters().faults_of(Reason::FrameRate), 1);
    assert_eq!(wire.endpoint.take_fault(), Some(Reason::FrameRate));
}

#[test]
fn a_window_of_two_thirds_of_its_time_is_permitted_and_one_a_microsecond_shorter_is_not() {
    // 21,334 µs for 32 ticks of 1 ms, whatever frame the window begins with.
    for (last_us, permitted) in [(657, true), (656, false)] {
        let mut wire = Wire::armed();
        for i in 0..96 {
            wire.tick_us = if i % 32 == 31 { last_us } else { 667 };
            wire.stay();
        }
        let expected = if permitted { (Mode::Armed, Reason::None) } else { (Mode::Bypass, Reason::FrameRate) };
        assert_eq!((wire.endpoint.mode(), wire.endpoint.state().reason()), expected);
        // Arming has the same bound.
        let _ = wire.endpoint.disarm(&wire.rewriter);
        wire.request.part_serial += 1;
        assert_eq!(refusal(&wire).is_none(), permitted);
    }
}

#[test]
fn the_refusals_have_the_numbers_and_sentences_a_person_needs() {
    let unknown = Refusal::FrameRate { tick_hz: 1_000, interval_ns: 0 };
    let fast = Refusal::FrameRate { tick_hz: 1_000, interval_ns: 50_000 };
    assert_eq!((unknown.code(), fast.code()), (9, 9));
    assert_eq!(unknown.to_string(), "too few setpoints have come to tell whether they come at 1000 Hz");
    assert_eq!(fast.to_string(), "a setpoint comes every 50000 ns, faster than the 1000 Hz of the settings");
}
