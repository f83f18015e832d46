//! The machine's own caps on velocity and acceleration of a correction.

use crate::rewrite_support;
use rewrite_support::*;
use truepath_wire::image::FineOffset;
use truepath_wire::rewrite::{
    Mode, NO_ACCELERATION_CAP, NO_VELOCITY_CAP, Rewriter, Setting, Settings, SettingsError, Status,
};

fn capped(slew: u32, acceleration: u64) -> Settings {
    Settings { correction_slew_nm_per_s: slew, correction_acceleration_nm_per_s2: acceleration, ..Settings::at_1_khz() }
}

/// Largest velocity and change of velocity of a correction over a whole feature, 2⁻⁸ nm per tick.
fn largest(settings: Settings) -> (i32, i32, bool) {
    let mut m = Machine::new(settings, image_with(&self::settings(), &nodes(straight()))).armed();
    let mut before = [0; 2];
    let (mut velocity, mut change, mut lagged) = (0, 0, false);
    let mut look = |m: &Machine| {
        for (axis, before) in m.state.axes().iter().zip(&mut before) {
            let now = axis.velocity().bits();
            velocity = velocity.max(now.abs());
            change = change.max((now - *before).abs());
            *before = now;
        }
    };
    for _ in 0..1_000 {
        m.send(0, 0, GATE);
        look(&m);
    }
    for (x, y) in along(&straight(), FEED) {
        lagged |= m.send(x, y, PASS).status.has(Status::LAGGING);
        look(&m);
    }
    for tick in 1..1_000 {
        m.send(10 * MM + tick.min(60) * FEED, 0, PASS);
        look(&m);
    }
    assert_eq!(m.state.mode(), Mode::Bypass);
    (velocity, change, lagged)
}

#[test]
fn a_correction_is_no_faster_than_the_machine_permits() {
    let free = largest(capped(NO_VELOCITY_CAP, NO_ACCELERATION_CAP));
    assert_eq!(free, largest(Settings::at_1_khz()), "no cap changes nothing");
    // 0.5 mm/s and 20 mm/s² are 500 and 20 nm per tick.
    let (velocity, change, _) = largest(capped(500_000, 20_000_000));
    assert!(free.0 > 500 << 8 && free.1 > 20 << 8, "{free:?}");
    assert_eq!((velocity, change), (500 << FineOffset::FRACTION_BITS, 20 << FineOffset::FRACTION_BITS));
}

#[test]
fn the_lower_of_cap_and_image_counts_for_each_of_the_two() {
    let image = || Some(image_with(&settings(), &nodes(straight())));
    let limits = |slew, acceleration| Rewriter::new(capped(slew, acceleration), image()).unwrap().limits().cloned();
    let own = limits(NO_VELOCITY_CAP, NO_ACCELERATION_CAP);
    assert_eq!(limits(20_000_000, 1_000_000_000), own);
    assert_eq!(limits(30_000_000, 2_000_000_000), own);
    assert_ne!(limits(10_000_000, 2_000_000_000), own);
    assert_ne!(limits(30_000_000, 500_000_000), own);
}

#[test]
fn caps_outside_their_range_or_too_low_for_the_tick_rate_are_refused() {
    let refused = |slew, acceleration, with: bool| {
        let image = with.then(|| image_with(&settings(), &nodes(straight())));
        Rewriter::new(capped(slew, acceleration), image).unwrap_err()
    };
    let range = |name, value, high| SettingsError::Range { name, value, low: 1, high };
    let (velocity, acceleration) = (Setting::CorrectionVelocity, Setting::CorrectionAcceleration);
    assert_eq!(refused(0, 1, false), range(velocity, 0, u32::MAX.into()));
    assert_eq!(refused(1, 0, false), range(acceleration, 0, 1_000_000_000_000));
    assert_eq!(refused(1, u64::MAX, false), range(acceleration, i64::MAX, 1_000_000_000_000));
    assert!(matches!(refused(1, 1, true), SettingsError::LimitVanishes { .. }));
}

#[test]
fn settings_at_another_rate_have_the_same_times() {
    assert_eq!(Settings::at_rate(1_000), Settings::at_1_khz());
    let fast = Settings::at_rate(4_000);
    assert_eq!(
        (fast.hold_after_ticks, fast.spindle_stale_ticks, fast.fade_ticks, fast.feed_smoothing),
        (80, 400, 1_000, 6)
    );
    assert_eq!(fast.max_step.nm(), 250_000);
    for hz in [0, 1, 9, 10, 333, 100_000, 100_001, u32::MAX] {
        let made = Rewriter::new(Settings::at_rate(hz), None);
        assert_eq!(made.is_ok(), (10..=100_000).contains(&hz), "{hz}: {made:?}");
    }
}
