//! Along the path: the correction is that of the table, on the right branch, for the live feed.

use crate::rewrite_support;
use rewrite_support::*;
use truepath_wire::rewrite::{ADVANCE_LIMIT, Digest, Flags, Mode, Output, Reason, Settings, Status};

/// The table at a way from the start of a path with even nodes, nm, at a chip factor.
fn table(s_nm: f64, factor: f64) -> [f64; 2] {
    let i = (s_nm / 1e5).floor();
    let t = s_nm / 1e5 - i;
    let (a, b) = (profile(i as usize), profile(i as usize + 1));
    let at = |p: [i64; 4], k: usize| p[k] as f64 * factor + p[k + 2] as f64;
    [0, 1].map(|k| at(a, k) + (at(b, k) - at(a, k)) * t)
}

#[test]
fn on_an_exact_run_the_correction_is_that_of_the_table_to_a_nanometre() {
    let mut m = Machine::on(straight()).active();
    m.stay();
    let setpoints = along(&straight(), FEED);
    for &(x, y) in &setpoints[..setpoints.len() - 1] {
        let out = m.send(x, y, PASS);
        let expected = table(x as f64, 1.0);
        for axis in 0..2 {
            assert!((f64::from(out.correction_nm[axis]) - expected[axis]).abs() <= 1.0, "{x}: {out:?} {expected:?}");
        }
        assert!(!out.status.has(Status::SATURATED), "no correction of an image is beyond its clamp");
        assert_eq!(out.axes[2..], m.next.axes[2..]);
    }
}

#[test]
fn the_chip_part_follows_the_live_feed_and_the_edge_part_does_not() {
    // Half the feed, nominal spindle; then nominal feed, 5/4 of the spindle speed.
    for (way, spindle, ratio) in [(FEED / 2, SPINDLE, 0.5), (FEED, SPINDLE / 4 * 5, 0.8)] {
        let m = Machine::on(straight());
        assert_eq!(m.state.feed_ratio(), 1 << 16, "nothing is armed");
        let mut m = m.active();
        m.next.spindle_millirpm = spindle;
        let factor = f64::powf(ratio, 0.75);
        for (tick, &(x, y)) in along(&straight(), way).iter().enumerate() {
            let out = m.send(x, y, PASS);
            if tick > 300 && x < 10 * MM {
                let expected = table(x as f64, factor);
                for axis in 0..2 {
                    let error = f64::from(out.correction_nm[axis]) - expected[axis];
                    assert!(error.abs() < 100.0, "{x}: {error} of {expected:?}");
                }
                assert!(!out.status.has(Status::FADED));
                let told = f64::from(m.state.feed_ratio()) / 65_536.0;
                assert!((told - ratio).abs() < 1e-3, "{told}");
            }
        }
    }
}

#[test]
fn the_correction_fades_when_the_spindle_stops_or_its_speed_is_stale_and_comes_back() {
    for stale in [false, true] {
        let mut m = Machine::on(straight()).active();
        m.forward(100);
        if stale {
            m.next.spindle_age_ticks = 100;
        } else {
            m.next.spindle_millirpm = 0;
        }
        m.forward(30);
        assert!(m.stay().status.has(Status::FADED));
        let gone = m.forward(400);
        assert_eq!((gone.correction_nm, gone.mode), ([0; 6], Mode::Active));
        m.next.spindle_age_ticks = 0;
        m.next.spindle_millirpm = SPINDLE;
        let back = m.forward(400);
        assert!(!back.status.has(Status::FADED));
        assert_ne!(back.correction_nm, [0; 6]);
    }
}

#[test]
fn outside_the_feed_window_the_correction_fades() {
    for way in [1_000, 15_000] {
        let mut m = Machine::on((0..=300).map(|i| (i * MM / 10, 0))).active();
        for i in 1..1_000 {
            m.send(i * way, 0, PASS);
        }
        let out = m.stay();
        assert_eq!((out.correction_nm, out.mode), ([0; 6], Mode::Active), "{way}");
    }
}

#[test]
fn cutting_air_fades_when_the_load_input_is_used() {
    let mut loaded = Settings::at_1_khz();
    loaded.require_spindle_load = true;
    let mut m = Machine::new(loaded, image_with(&settings(), &nodes(straight())));
    m.next.flags = m.next.flags.with(Flags::SPINDLE_LOADED);
    let mut m = m.active();
    assert_ne!(m.forward(200).correction_nm, [0; 6]);
    m.next.flags = Flags::DRIVES_ENABLED;
    assert_eq!(m.forward(400).correction_nm, [0; 6]);
}

#[test]
fn a_contour_that_crosses_itself_stays_on_its_branch() {
    let points = eight(10.0);
    let mut m = Machine::on(points.iter().copied()).active();
    let mut node = 0;
    let run = along(&points, FEED);
    for &(x, y) in &run {
        let out = m.send(x, y, PASS);
        assert_eq!((out.mode, out.reason), (Mode::Active, Reason::None));
        assert!(out.place.node >= node && out.place.node <= node + 1, "{out:?}");
        node = out.place.node;
        // The foot is the setpoint: it was made on the chords of the path.
        let t = f64::from(out.place.fraction) / f64::from(1 << 30);
        let (a, b) = (points[node as usize], points[node as usize + 1]);
        let foot = (a.0 as f64 + (b.0 - a.0) as f64 * t, a.1 as f64 + (b.1 - a.1) as f64 * t);
        assert!((foot.0 - x as f64).abs() < 2.0 && (foot.1 - y as f64).abs() < 2.0);
    }
    assert_eq!(node as usize, points.len() - 2);
}

#[test]
fn a_blended_corner_is_followed_from_one_leg_to_the_other() {
    let mut points: Vec<_> = (0..=50).map(|i| (i * MM / 10, 0)).collect();
    points.extend((1..=50).map(|i| (5 * MM, i * MM / 10)));
    let mut m = Machine::on(points).active();
    // An arc of 0.3 mm radius instead of the corner; its middle is 0.124 mm from the corner.
    let r = 300_000f64;
    let mut blended: Vec<_> = along(&[(0, 0), (5 * MM - 300_000, 0)], FEED);
    blended.extend((0..=70).map(|i| {
        let a = std::f64::consts::FRAC_PI_2 * f64::from(i) / 70.0;
        (5 * MM - 300_000 + (r * a.sin()) as i64, (r * (1.0 - a.cos())) as i64)
    }));
    blended.extend(along(&[(5 * MM, 300_000), (5 * MM, 5 * MM)], FEED));
    let out = m.run(&blended);
    assert_eq!((out.mode, out.place.node, out.place.fraction), (Mode::Active, 99, 1 << 30));
}

/// A leg of so many segments along X and one of 2 mm along Y, active at the start.
fn corner(segments: i64) -> Machine {
    let mut points: Vec<_> = (0..=segments).map(|i| (i * MM / 10, 0)).collect();
    points.extend((1..=20).map(|i| (segments * MM / 10, i * MM / 10)));
    Machine::on(points).active()
}

/// Node and place in the segment, thousandths.
fn place(out: &Output) -> (u32, u64) {
    (out.place.node, (u64::from(out.place.fraction) * 1_000 + (1 << 29)) >> 30)
}

#[test]
fn a_setpoint_on_a_node_has_that_node_as_its_place_and_the_last_one_the_end_of_the_last_segment() {
    let mut m = Machine::on(straight()).active();
    for i in (0..100).chain((50..99).rev()).chain(50..100) {
        for _ in 0..3 {
            let out = m.send(i * MM / 10, 0, PASS);
            if out.mode == Mode::Fault {
                // Back by more than the tolerance.
                return;
            }
            assert_eq!(place(&out), (i as u32, 0));
        }
        if i == 99 {
            for _ in 0..3 {
                assert_eq!(place(&m.send(10 * MM, 0, PASS)), (99, 1_000));
            }
        }
    }
    panic!("going back was not noticed");
}

#[test]
fn inside_a_corner_the_place_is_on_the_nearer_leg_and_on_the_first_when_both_are_as_near() {
    let inside = [(20, 50, (8, 500)), (49, 50, (8, 500)), (50, 50, (8, 500)), (51, 50, (9, 510)), (99, 1, (9, 990))];
    for (y, left, expected) in inside {
        let mut m = corner(9);
        m.send(700_000, 0, PASS);
        assert_eq!(place(&m.send(900_000 - left * 1_000, y * 1_000, PASS)), expected, "{y} {left}");
    }
    // Farther along the next leg than its first segment, in one tick.
    assert_eq!(place(&corner(3).send(280_000, 250_000, PASS)), (5, 500));
}

#[test]
fn round_a_corner_sharper_than_a_right_angle_the_place_is_that_of_the_setpoint() {
    let mut points: Vec<_> = (0..=10).map(|i| (i * MM / 10, 0)).collect();
    points.extend((1..=20).map(|i| (MM - i * 70_711, i * 70_711)));
    let mut m = Machine::on(points.iter().copied()).active();
    for (x, y) in along(&points, FEED) {
        let out = m.send(x, y, PASS);
        assert_eq!((out.mode, out.reason), (Mode::Active, Reason::None));
        let (a, b) = (points[out.place.node as usize], points[out.place.node as usize + 1]);
        let part = |a: i64, b: i64| a + (((b - a) * i64::from(out.place.fraction)) >> 30);
        assert!((part(a.0, b.0) - x).abs() < 3 && (part(a.1, b.1) - y).abs() < 3, "{x} {y}: {:?}", out.place);
    }
}

#[test]
fn the_place_goes_on_by_no_more_segments_in_a_tick_than_the_limit() {
    let mut m = Machine::on(straight()).active();
    assert_eq!(place(&m.send(990_000, 0, PASS)), (ADVANCE_LIMIT, 1_000));
    assert_eq!(place(&m.stay()), (9, 900));
    // Nor round a corner, where the next leg is nearer.
    let mut m = corner(9);
    assert_eq!(place(&m.send(850_000, 80_000, PASS)), (ADVANCE_LIMIT, 500));
    assert_eq!(place(&m.stay()), (9, 800));
    // The corner one segment earlier takes the last one.
    assert_eq!(place(&corner(8).send(750_000, 180_000, PASS)), (ADVANCE_LIMIT, 1_000));
}

#[test]
fn a_step_of_several_segments_round_a_corner_arrives_in_one_tick() {
    let mut points: Vec<_> = (0..=50).map(|i| (i * MM / 10, 0)).collect();
    points.extend((1..=50).map(|i| (5 * MM, i * MM / 10)));
    // On the path, and a little inside of the corner, where the end of the first leg is not passed.
    for inside in [0, 1, 20_000] {
        let mut m = Machine::on(points.iter().copied()).active();
        let (mut at, step) = (0, 290_000);
        let mut out = m.stay();
        while at + step < 10 * MM {
            at += step;
            out = m.send(at.min(5 * MM - inside), (at - 5 * MM).max(0) + inside, PASS);
            let way = i64::from(out.place.node) * 100_000 + ((i64::from(out.place.fraction) * 100_000) >> 30);
            assert_eq!(out.mode, Mode::Active, "{out:?}");
            assert!((way - at).abs() <= inside + 2, "{inside}: {way} for {at}");
        }
        assert_eq!(out.place.node, 98);
    }
}

#[test]
fn the_same_setpoints_give_the_same_digest_and_one_bit_changes_it() {
    let run = |change: i64| {
        let mut m = Machine::on(eight(10.0)).active();
        let mut digest = Digest::default();
        for (i, &(x, y)) in along(&eight(10.0), FEED).iter().enumerate() {
            digest.add(&m.send(x + if i == 4_000 { change } else { 0 }, y, PASS));
        }
        digest.value()
    };
    assert_eq!(run(0), run(0));
    assert_ne!(run(0), run(1));
}

#[test]
fn a_large_correction_raises_the_warning() {
    let mut low = settings();
    low.limits.warn = truepath_units::Offset::from_um(50);
    let mut m = Machine::new(Settings::at_1_khz(), image_with(&low, &nodes(straight()))).active();
    let mut warned = 0;
    for &(x, y) in &along(&straight(), FEED) {
        let out = m.send(x, y, PASS);
        let large = out.correction_nm.iter().any(|c| c.abs() > 50_000);
        assert_eq!(out.status.has(Status::WARN), large);
        warned += u32::from(large);
    }
    assert!(warned > 100);
}

#[test]
fn a_correction_that_is_not_yet_where_it_should_be_is_told() {
    let mut m = Machine::on(straight()).armed();
    let [cx, cy, ex, ey] = profile(0);
    let full = [(cx + ex) as i32, (cy + ey) as i32];
    let mut lagging = 0;
    for _ in 0..100 {
        let out = m.send(0, 0, GATE);
        let there = out.correction_nm[..2] == full;
        assert!(there || out.status.has(Status::LAGGING), "{out:?}");
        lagging += u32::from(out.status.has(Status::LAGGING));
    }
    assert!((5..50).contains(&lagging), "{lagging}");
    assert_eq!(m.stay().correction_nm[..2], full);
}
