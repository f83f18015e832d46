//! Timing of the setpoint link: what is counted of arrivals and answers, and that nothing overflows.

use truepath_wire::link::{
    DeviceSettings, STAMPS_AT_ONCE, Spread, Stamps, TIMING_BINS, TIMING_EDGES_NS, Timing, TimingMeter, Verdict,
};

const MHZ_480: u32 = 480_000_000;

/// Frames by verdict, arrival in µs and counts to the answer, each counted at once.
fn timed(frames: &[(Verdict, u64, u32)]) -> Timing {
    let mut stamps = Stamps::<16>::new();
    let mut meter = TimingMeter::new(&DeviceSettings::at_1_khz(), MHZ_480);
    for &(verdict, arrived_us, counts) in frames {
        stamps.leave(verdict, arrived_us, counts);
        let (missed, drained) = stamps.drain();
        meter.take(missed, &drained);
    }
    meter.timing()
}

/// Frames that follow each other after these times, µs.
fn after(first_us: u64, intervals_us: &[u64]) -> Timing {
    let mut at = first_us;
    let mut frames = vec![(Verdict::Accepted, at, 0)];
    frames.extend(intervals_us.iter().map(|interval| {
        at += interval;
        (Verdict::Accepted, at, 0)
    }));
    timed(&frames)
}

#[test]
fn arrivals_are_counted_by_what_they_are_off_the_period() {
    // Deviations −10, 0, 0, +30, −20 µs: mean 0, variance (100 + 900 + 400)/5 = 280.
    let timing = after(5_000, &[990, 1_000, 1_000, 1_030, 980]);
    assert_eq!(timing.period_ns, 1_000_000);
    let deviation_ns = (280f64.sqrt() * 1e3).round() as u32;
    assert_eq!(timing.arrivals, Spread { count: 5, mean_ns: 0, deviation_ns, least_ns: -20_000, greatest_ns: 30_000 });
    let mut early = [0; TIMING_BINS];
    (early[4], early[5]) = (1, 1);
    let mut late = [0; TIMING_BINS];
    (late[0], late[5]) = (2, 1);
    assert_eq!((timing.early, timing.late), (early, late));
}

#[test]
fn only_frames_that_follow_each_other_have_a_time_between_them() {
    use Verdict::{Accepted, Jump, Lost};
    let silence_us = u64::from(DeviceSettings::at_1_khz().silence_us);
    let timing = timed(&[
        (Accepted, 1_000, 0),
        (Accepted, 2_000, 0),
        // One is missing before it.
        (Lost(1), 4_000, 0),
        (Accepted, 5_000, 0),
        (Jump, 9_000, 0),
        (Accepted, 10_000, 0),
        // The link was silent: accepted with any sequence.
        (Accepted, 10_000 + silence_us, 0),
        (Accepted, 11_000 + silence_us, 0),
    ]);
    let Spread { count, least_ns, greatest_ns, .. } = timing.arrivals;
    assert_eq!((count, least_ns, greatest_ns), (4, 0, 0));
    assert_eq!(timing.answers.count, 8, "they were answered all the same");
}

#[test]
fn the_clock_may_pass_32_bits_between_two_frames() {
    let timing = after((1 << 32) - 500, &[1_000, 1_001]);
    assert_eq!(timing.arrivals.greatest_ns, 1_000);
    assert_eq!(timing.arrivals.least_ns, 0);
}

#[test]
fn answers_are_counted_in_nanoseconds_of_the_boards_counter() {
    // 3600 cycles of 480 MHz are 7.5 µs; 480 are one, which belongs to the bin that begins there.
    let timing =
        timed(&[(Verdict::Accepted, 0, 3_600), (Verdict::Accepted, 1_000, 480), (Verdict::Accepted, 2_000, 479)]);
    let Spread { count, mean_ns, least_ns, greatest_ns, .. } = timing.answers;
    assert_eq!((count, least_ns, greatest_ns), (3, 997, 7_500));
    assert_eq!(mean_ns, (7_500 + 1_000 + 997 + 1) / 3);
    let mut taken = [0; TIMING_BINS];
    (taken[0], taken[1], taken[3]) = (1, 1, 1);
    assert_eq!(timing.taken, taken);
}

#[test]
fn every_bin_begins_with_its_edge() {
    assert!(TIMING_EDGES_NS.is_sorted_by(|a, b| a < b));
    for (bin, edge) in TIMING_EDGES_NS.into_iter().enumerate() {
        let edge_us = u64::from(edge / 1_000);
        let timing = after(0, &[1_000 + edge_us, 1_000 + edge_us - 1]);
        assert_eq!((timing.late[bin + 1], timing.late[bin]), (1, 1), "{edge} ns");
    }
}

#[test]
fn what_nobody_took_out_in_time_is_missed_and_not_guessed() {
    let mut stamps = Stamps::<32>::new();
    let mut meter = TimingMeter::new(&DeviceSettings::at_1_khz(), MHZ_480);
    // The first one is counted, then nobody comes for 100 frames, of which the first 68 are overwritten.
    stamps.leave(Verdict::Accepted, 0, 0);
    let mut take = |stamps: &mut Stamps<32>| {
        let (missed, drained) = stamps.drain();
        meter.take(missed, &drained);
        (missed, drained.len(), meter.timing())
    };
    assert_eq!(take(&mut stamps).1, 1);
    for frame in 1..=100 {
        // Those that are overwritten come at another pace: they must not leave a trace.
        let at = if frame <= 68 { frame * 1_500 } else { 200_000 + frame * 1_000 };
        stamps.leave(Verdict::Accepted, at, 0);
    }
    let (missed, count, _) = take(&mut stamps);
    assert_eq!((missed, count), (68, STAMPS_AT_ONCE));
    let (missed, count, timing) = take(&mut stamps);
    assert_eq!((missed, count), (0, 16));
    assert_eq!((timing.missed, timing.answers.count), (68, 33));
    assert_eq!((timing.arrivals.count, timing.arrivals.greatest_ns), (31, 0), "no time over the gap");
    assert_eq!(take(&mut stamps).1, 0, "each is given once");
}

/// The largest deviations there are, both ways: sums of them have to stay what they are.
#[test]
fn nothing_overflows_however_long_it_runs_and_whatever_comes() {
    let settings = DeviceSettings { silence_us: u32::MAX, ..DeviceSettings::at_1_khz() };
    let mut meter = TimingMeter::new(&settings, 1);
    let mut stamps = Stamps::<16>::new();
    let mut at = 0u64;
    for frame in 0..100_000u32 {
        // A counter of 1 Hz: 2³¹ − 1 counts are 68 years.
        stamps.leave(Verdict::Accepted, at, u32::MAX);
        at += u64::from(u32::MAX) - 1;
        if frame % 16 == 15 {
            let (missed, drained) = stamps.drain();
            meter.take(missed, &drained);
        }
    }
    let timing = meter.timing();
    let end = Spread { count: 99_999, mean_ns: i32::MAX, deviation_ns: 0, least_ns: i32::MAX, greatest_ns: i32::MAX };
    assert_eq!(timing.arrivals, end);
    assert_eq!(timing.answers, Spread { count: 100_000, ..end });
    assert_eq!((timing.late[TIMING_BINS - 1], timing.taken[TIMING_BINS - 1]), (99_999, 100_000));
}
