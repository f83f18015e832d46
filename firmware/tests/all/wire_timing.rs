//! Timing over the links: a controller with a known jitter, and a clock that goes on while a frame is answered.

use core::cell::Cell;

use crate::wire_support;
use truepath_core::link::{Ask, DeviceSettings, Reply, Spread, Timing};
use truepath_core::rewrite::Flags;
use truepath_fw::servo::STAMPS;
use wire_support::*;

fn timing(rig: &mut Rig) -> Timing {
    let Reply::Timing(timing) = rig.ask(Ask::Timing).unwrap() else { panic!() };
    timing
}

/// A frame so many microseconds after the last one, answered by a clock that a reading moves on by a step.
fn send(rig: &mut Rig, after_us: u64, step_us: u64) {
    rig.setpoint.sequence = rig.setpoint.sequence.wrapping_add(1);
    rig.now_us += after_us;
    let (packet, arrived_us) = (rig.frame(), rig.now_us);
    let readings = Cell::new(0);
    let clock = || {
        let now_us = arrived_us + step_us * readings.get();
        readings.set(readings.get() + 1);
        now_us
    };
    let mut answers = 0;
    rig.device().watch(arrived_us);
    rig.device().setpoint_bytes_answered(&packet, arrived_us, &clock, |_| answers += 1);
    assert_eq!(answers, 1);
}

#[test]
fn the_device_tells_the_jitter_of_its_controller() {
    let mut rig = Rig::new();
    // Every other frame comes 40 µs late, and the one behind it in time again: +40, −40 µs in turn.
    send(&mut rig, 1_000, 0);
    for _ in 0..500 {
        send(&mut rig, 1_040, 0);
        send(&mut rig, 960, 0);
    }
    let timing = timing(&mut rig);
    let spread = Spread { count: 1_000, mean_ns: 0, deviation_ns: 40_000, least_ns: -40_000, greatest_ns: 40_000 };
    assert_eq!((timing.arrivals, timing.period_ns, timing.missed), (spread, 1_000_000, 0));
    // From 20 µs on.
    assert_eq!((timing.early[5], timing.late[5]), (500, 500));
    assert_eq!([timing.early, timing.late].as_flattened().iter().sum::<u32>(), 1_000);
}

#[test]
fn the_time_to_an_answer_is_that_of_the_clock_of_the_board() {
    let mut rig = Rig::new();
    // It is read when the bytes come, for the deadline, and when the answer is made: two steps.
    for step_us in [3, 5, 7] {
        send(&mut rig, 1_000, step_us);
    }
    let spread = timing(&mut rig).answers;
    assert_eq!((spread.count, spread.mean_ns, spread.least_ns, spread.greatest_ns), (3, 10_000, 6_000, 14_000));
}

#[test]
fn other_settings_and_cleared_counters_begin_anew() {
    let mut rig = Rig::new();
    let ten_frames = |rig: &mut Rig| {
        for _ in 0..10 {
            assert!(rig.stay().is_some());
        }
    };
    rig.setpoint.flags = Flags::default();
    ten_frames(&mut rig);
    assert_eq!(timing(&mut rig).answers.count, 10);
    rig.done(Ask::ClearCounters).unwrap();
    assert_eq!(timing(&mut rig).answers.count, 0);
    ten_frames(&mut rig);
    let mut settings = DeviceSettings::at_1_khz();
    settings.rewriter.tick_hz = 3_000;
    rig.done(Ask::Configure(settings)).unwrap();
    let timing = timing(&mut rig);
    assert_eq!((timing.period_ns, timing.answers.count, timing.arrivals.count), (333_333, 0, 0));
}

#[test]
fn frames_that_nobody_could_count_are_told() {
    let mut rig = Rig::new();
    send(&mut rig, 1_000, 0);
    // The configuration service is busy: nothing but the setpoint path runs for 300 frames.
    for _ in 0..300 {
        rig.setpoint.sequence = rig.setpoint.sequence.wrapping_add(1);
        rig.now_us += 1_000;
        let (packet, now_us) = (rig.frame(), rig.now_us);
        rig.device().setpoint_bytes(&packet, now_us, |_| {});
    }
    let timing = timing(&mut rig);
    let kept = STAMPS as u32;
    assert_eq!((timing.missed, timing.answers.count), (300 + 1 - kept, kept));
    assert_eq!((timing.arrivals.count, timing.arrivals.greatest_ns), (kept - 1, 0));
    assert!(include_str!("../../../docs/link.md").contains(&format!("{kept} stamps are kept")));
}
