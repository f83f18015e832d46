//! A million random streams of setpoints against what must hold for any input: never outside the clamp, never faster
//! than the limits of speed and acceleration, bypass byte for byte, only the transitions of the table.

use crate::rewrite_support;
use rewrite_support::*;
use truepath_units::{Offset, Real, shift_rounded_i64};
use truepath_wire::image::FeedLaw;
use truepath_wire::rewrite::{ArmRequest, Flags, Limits, Mode, Output, Rewriter, Setpoint, Settings, State};

const STREAMS: u64 = 1_000_000;

/// One tick judged against the one before.
fn judge(limits: &Limits, before: &State, after: &State, setpoint: &Setpoint, out: &Output) {
    let (clamp, v, a) = (limits.clamp().bits(), limits.velocity().bits(), limits.acceleration().bits());
    for (now, then) in after.axes().iter().zip(before.axes()) {
        assert!(now.correction().bits().abs() <= clamp, "outside the clamp: {now:?}");
        let moved = now.correction().bits() - then.correction().bits();
        assert!(moved.abs() <= v, "faster than the limit: {then:?} {now:?}");
        assert!((now.velocity().bits() - then.velocity().bits()).abs() <= a, "harder than the limit: {then:?} {now:?}");
    }
    assert_eq!(out.sequence, setpoint.sequence);
    for axis in 0..6 {
        let correction = after.axes().get(axis).map_or(0, |a| shift_rounded_i64(a.correction().bits().into(), 8));
        assert_eq!(i64::from(out.correction_nm[axis]), correction);
        assert_eq!(out.axes[axis], setpoint.axes[axis].saturating_add(correction));
    }
    assert!(out.forward);
    if matches!(out.mode, Mode::Bypass | Mode::Armed) {
        assert!(out.axes == setpoint.axes && out.correction_nm == [0; 6]);
        assert!(after.axes().iter().all(|a| a.correction().bits() == 0 && a.velocity().bits() == 0));
    }
    use Mode::{Active, Armed, Bypass, Fault, Hold};
    let permitted = match before.mode() {
        Armed => &[Armed, Bypass, Active, Fault][..],
        Active => &[Active, Hold, Fault, Bypass],
        Hold => &[Hold, Active, Fault],
        Fault => &[Fault, Bypass],
        Bypass => &[Bypass],
        Mode::Off => &[],
    };
    assert!(permitted.contains(&out.mode), "{:?} to {:?}", before.mode(), out.mode);
}

/// A path whose correction is as large as the clamp permits and changes its direction every 0.7 mm, at any feed:
/// the limiter is asked for more than it may give all the time, and for a stop right at the clamp.
fn harsh() -> (Vec<(i64, i64)>, Machine) {
    let points = eight(6.0);
    let clamp = 20_000;
    let mut harsh = settings();
    harsh.feed = FeedLaw::new(harsh.feed.per_tooth, 6, SPINDLE, Real::ONE, Real::ZERO, Real::from_int(2));
    harsh.limits.clamp = Offset::from_nm(clamp);
    harsh.limits.warn = Offset::from_nm(clamp / 2);
    // At the feed the target moves by 2.7 µm per tick from clamp to clamp: it can just be caught up with at the limit of
    // speed, and then the stop at the clamp takes 12 µm.
    harsh.limits.slew_nm_per_s = 3_000_000;
    harsh.limits.acceleration_nm_per_s2 = 300_000_000;
    let mut made = nodes(points.iter().copied());
    for (i, node) in made.iter_mut().enumerate() {
        let (x, y) = [(clamp, 0), (-clamp, 0), (0, -clamp), (0, clamp)][i / 7 % 4];
        node.chip = [fine(x / 2), fine(y / 2)];
        node.edge = node.chip;
    }
    let machine = Machine::new(Settings::at_1_khz(), image_with(&harsh, &made));
    (points, machine)
}

type Beginning = (State, Setpoint, (i64, i64));

/// States of an exact run, each with its last setpoint and step: where the streams begin.
fn beginnings() -> (Rewriter<'static>, ArmRequest, Vec<Beginning>) {
    let (points, m) = harsh();
    let mut m = m.armed();
    let mut found = vec![(m.state, m.next, (FEED, 0))];
    m.send(points[0].0, points[0].1, GATE);
    for &(x, y) in along(&points, FEED).iter() {
        let [x0, y0, ..] = m.next.axes;
        m.send(x, y, PASS);
        if m.next.sequence % 37 == 0 {
            found.push((m.state, m.next, (x - x0, y - y0)));
        }
    }
    (m.rewriter, m.request, found)
}

/// The next setpoint: mostly a feed move, now and then anything else that a controller or a broken link can send.
fn disturb(random: &mut Random, direction: &mut (i64, i64), sp: &mut Setpoint) {
    sp.sequence = sp.sequence.wrapping_add(1);
    match random.below(40) {
        0 => *direction = (-direction.0, -direction.1),
        1 | 2 => *direction = (random.around(2 * FEED), random.around(2 * FEED)),
        3 => *direction = (0, 0),
        4 => sp.axes[random.below(3) as usize] += random.around(3 * MM),
        5 => sp.axes[random.below(2) as usize] += random.around(150_000),
        6 => sp.axes[random.below(6) as usize] = random.next() as i64 >> random.below(60),
        7 => sp.sequence = sp.sequence.wrapping_add(random.below(5) as u32),
        8 => sp.sequence = sp.sequence.wrapping_sub(1),
        9 => sp.spindle_millirpm = random.next() as u32 >> random.below(32),
        10 => sp.spindle_age_ticks = random.below(200) as u32,
        11 if random.below(4) == 0 => sp.flags = Flags(random.next() as u16),
        12 | 13 => sp.flags = sp.flags.with(Flags::FEED_HOLD),
        14 => sp.flags = Flags::DRIVES_ENABLED,
        15 if random.below(8) == 0 => sp.frame_crc ^= 1 << random.below(32),
        16 => sp.axes[2] = PASS + random.around(300_000),
        _ => {}
    }
    sp.axes[0] = sp.axes[0].saturating_add(direction.0);
    sp.axes[1] = sp.axes[1].saturating_add(direction.1);
}

#[test]
fn a_million_random_streams_never_leave_the_limits() {
    let (rewriter, request, beginnings) = beginnings();
    let limits = rewriter.limits().unwrap();
    let mut random = Random(0x9e37_79b9_7f4a_7c15);
    let mut seen = [0u64; 6];
    let mut most = 0;
    for stream in 0..STREAMS {
        let (mut state, mut sp, mut direction) = beginnings[random.below(beginnings.len() as u64) as usize];
        for _ in 0..16 + random.below(32) {
            disturb(&mut random, &mut direction, &mut sp);
            let before = state;
            let out = rewriter.tick(&mut state, &sp);
            judge(limits, &before, &state, &sp, &out);
            seen[out.mode as usize] += 1;
            most = most.max(out.correction_nm[0].abs());
            match random.below(2_000) {
                0 => {
                    let _ = rewriter.disarm(&mut state);
                }
                1 => {
                    let serial = ArmRequest { part_serial: stream as u32, ..request };
                    let _ = rewriter.arm(&mut state, &serial);
                }
                _ => {}
            }
        }
    }
    // The streams must have been everywhere but in `Off`, and with corrections of size.
    assert!(seen[1..].iter().all(|&ticks| ticks > 100_000) && seen[0] == 0, "{seen:?}");
    assert!((19_900..=20_000).contains(&most), "{most}");
}

#[test]
fn long_streams_end_at_rest_in_bypass_after_a_stop() {
    let (rewriter, _, beginnings) = beginnings();
    let limits = rewriter.limits().unwrap();
    let mut random = Random(77);
    for _ in 0..300 {
        let (mut state, mut sp, mut direction) = beginnings[1 + random.below(beginnings.len() as u64 - 1) as usize];
        for _ in 0..500 {
            disturb(&mut random, &mut direction, &mut sp);
            let before = state;
            let out = rewriter.tick(&mut state, &sp);
            judge(limits, &before, &state, &sp, &out);
        }
        sp.flags = sp.flags.with(Flags::ABORT);
        for _ in 0..=limits.ramp_ticks() {
            sp.sequence += 1;
            let before = state;
            let out = rewriter.tick(&mut state, &sp);
            judge(limits, &before, &state, &sp, &out);
        }
        assert_eq!(state.mode(), Mode::Bypass);
    }
}
