#![allow(clippy::arithmetic_side_effects, clippy::indexing_slicing, clippy::unwrap_used, clippy::panic)]
use proptest::prelude::*;

use super::*;
use truepath_units::Offset;

fn limits(clamp_nm: i64, slew: u32, acceleration: u64, hz: u32) -> Limits {
    let given = CorrectionLimits {
        clamp: Offset::from_nm(clamp_nm),
        warn: Offset::ZERO,
        slew_nm_per_s: slew,
        acceleration_nm_per_s2: acceleration,
    };
    Limits::new(&given, hz).unwrap()
}

/// 0.5 mm, 20 mm/s, 1 m/s² at 1 kHz.
fn usual() -> Limits {
    limits(500_000, 20_000_000, 1_000_000_000, 1_000)
}

/// The way made while braking from a velocity, tick by tick.
fn braking_way(mut v: i64, a: i64) -> i64 {
    let mut way = 0;
    while v > 0 {
        way += v;
        v -= a;
    }
    way
}

#[test]
fn the_braking_table_never_exceeds_the_braking_way_and_is_close_to_it() {
    for made in [usual(), limits(4_000_000, 4_000_000_000, 3_000_000_000, 1_000), limits(100, 900, 70_000, 2_000)] {
        let a = i64::from(made.acceleration);
        let mut distance = 0u32;
        while distance <= 2 * made.clamp.unsigned_abs() {
            let v = i64::from(made.braking(distance));
            assert!(braking_way(v, a) <= i64::from(distance), "{distance} {v}");
            // A chord over an eighth of an octave of a square root lies at most 1/2048 of it below, 1/64 where the
            // root meets the velocity limit; where S is a line of few pieces, a part of one more.
            let more = v + v / 60 + a / 8 + 2;
            let capped = more >= i64::from(made.velocity);
            assert!(capped || braking_way(more, a) > i64::from(distance), "{distance} {v}");
            distance += 1 + distance / 1_000;
        }
    }
}

#[test]
fn a_change_within_the_limits_is_followed_to_the_last_bit() {
    let made = usual();
    let mut axis = AxisState::default();
    let (mut target, mut speed) = (0, 0);
    for tick in 0..2_000 {
        // Accelerates by at most a/2 per tick and stays far from the clamp.
        speed += if tick % 400 < 100 || tick % 400 >= 300 { 700 } else { -700 };
        target += speed;
        made.step(&mut axis, target);
        assert_eq!(axis.position, target, "tick {tick}");
    }
}

#[test]
fn a_slow_drift_of_a_nanometre_in_a_hundred_ticks_does_not_stick() {
    let made = usual();
    let mut axis = AxisState::default();
    for tick in 0..10_000 {
        made.step(&mut axis, tick * 256 / 100);
        assert_eq!(axis.position, tick * 256 / 100);
    }
}

#[test]
fn a_step_of_the_target_is_reached_exactly_and_without_leaving_the_clamp() {
    for made in [usual(), limits(500_000, 20_000_000, 300_000_000, 4_000), limits(900, 1_000, 8_000, 1_000)] {
        let mut axis = AxisState::default();
        for target in [made.clamp, -made.clamp, 1, 0, made.clamp / 3, -7] {
            let mut ticks = 0;
            while !(axis.position == target && axis.velocity == 0) {
                made.step(&mut axis, target);
                assert!(axis.position.abs() <= made.clamp);
                ticks += 1;
                assert!(ticks <= 2 * made.ramp_ticks(), "{target} not reached: {axis:?}");
            }
        }
    }
}

#[test]
fn limits_that_vanish_are_refused() {
    let given = CorrectionLimits {
        clamp: Offset::from_um(500),
        warn: Offset::ZERO,
        slew_nm_per_s: 1_000,
        acceleration_nm_per_s2: 1_000,
    };
    assert!(matches!(Limits::new(&given, 1_000), Err(SettingsError::LimitVanishes { acceleration: 0, .. })));
    assert!(Limits::new(&given, 10).is_ok());
}

#[test]
fn a_target_beyond_the_clamp_by_more_than_the_rounding_of_a_turn_is_told() {
    let made = usual();
    for sign in [1, -1] {
        for (beyond, told) in [(-1, false), (0, false), (2, false), (3, true), (4, true), (1 << 29, true)] {
            let mut axis = AxisState::default();
            assert_eq!(made.step(&mut axis, sign * (made.clamp + beyond)), told, "{sign} {beyond}");
        }
    }
}

#[test]
fn a_correction_at_rest_stays_there_and_is_on_its_target_until_the_target_moves() {
    let made = usual();
    for nm in [-400_000, 0, 3] {
        let mut axis = AxisState::at_rest(FineOffset::from_bits(nm << 8));
        for _ in 0..3 {
            made.step(&mut axis, nm << 8);
            assert_eq!(axis, AxisState::at_rest(FineOffset::from_bits(nm << 8)));
            assert!(axis.is_on_target());
        }
        made.step(&mut axis, (nm + 100_000) << 8);
        assert!(!axis.is_on_target() && !axis.is_at_rest_at_zero());
    }
}

#[test]
fn the_samples_of_the_table_are_the_inverse_of_the_braking_way() {
    for made in [usual(), limits(4_000_000, 4_000_000_000, 3_000_000_000, 1_000), limits(900, 1_000, 8_000, 1_000)] {
        let a = i64::from(made.acceleration);
        for index in 0..=LAST_SAMPLE {
            // Eight to an octave, the first eight exact.
            let distance = if index < 8 { index as i64 } else { (8 + index as i64 % 8) << (index / 8 - 1) };
            assert_eq!(sample(index), distance as u64);
            let v = i64::from(braking_velocity(distance as u64, made.acceleration));
            assert!(braking_way(v, a) <= distance && braking_way(v + 1, a) > distance, "{distance}: {v}");
            assert_eq!(i64::from(made.allowed[index]), v.min(made.velocity.into()));
        }
    }
}

#[test]
fn half_of_the_way_to_the_clamp_is_followed_freely() {
    for made in [usual(), limits(50_000, 1_000_000_000, 100_000_000, 1_000), limits(1, 1 << 30, 1 << 40, 1_000)] {
        let Free { velocity, reach, places } = made.free;
        assert!(reach >= made.clamp / 2 && places == 2 * reach as u32 + 1, "{:?}", made.free);
        assert!(
            velocity >= 1
                && braking_way(i64::from(velocity), i64::from(made.acceleration)) <= i64::from(made.clamp - reach)
        );
    }
}

#[test]
fn at_the_end_of_the_free_way_a_target_is_followed_as_the_rule_says() {
    let made = usual();
    let Free { velocity, reach, .. } = made.free;
    let mut limits_it = 0;
    for (beside, sign, way) in
        (-2..=2).flat_map(|k| [-1, 1].map(|s| (k, s))).flat_map(|(k, s)| [-1, 0, 1].map(|w| (k, s, w)))
    {
        let (place, follow) = (sign * (reach + beside), sign * (velocity + way));
        let axis = AxisState { position: place, velocity: follow, target: place };
        let (mut stepped, mut ruled) = (axis, axis);
        assert_eq!(made.step(&mut stepped, place + follow), made.limited(&mut ruled, place + follow));
        assert_eq!(stepped, ruled, "{beside} {follow}");
        limits_it += usize::from(ruled.position != place + follow);
    }
    // One beyond, the rule does limit.
    assert!(limits_it >= 4, "{limits_it}");
}

fn any_limits() -> impl Strategy<Value = Limits> {
    (1i64..4_000_000, 0u32..22, 0u32..32, prop_oneof![Just(1_000u32), Just(400), Just(10_000)]).prop_filter_map(
        "limits vanish or take long",
        |(clamp_nm, slew, acceleration, hz)| {
            let given = CorrectionLimits {
                clamp: Offset::from_nm(clamp_nm),
                warn: Offset::ZERO,
                slew_nm_per_s: 1_000 << slew,
                acceleration_nm_per_s2: 1_000 << acceleration,
            };
            Limits::new(&given, hz).ok().filter(|made| made.ramp_ticks() < 20_000)
        },
    )
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]

    #[test]
    fn no_target_leads_outside_the_limits(made in any_limits(), targets in proptest::collection::vec((any::<i32>(), 0u32..32, 1u8..40), 1..40)) {
        let mut axis = AxisState::default();
        let mut mirrored = AxisState::default();
        for (target, shift, ticks) in targets {
            let target = (target >> shift).max(-i32::MAX);
            for _ in 0..ticks {
                let before = axis;
                made.step(&mut axis, target);
                made.step(&mut mirrored, -target);
                prop_assert!(axis.position.abs() <= made.clamp);
                prop_assert_eq!(axis.position, before.position + axis.velocity);
                prop_assert!(axis.velocity.abs() <= made.velocity);
                prop_assert!((axis.velocity - before.velocity).abs() <= made.acceleration);
                prop_assert_eq!((mirrored.position, mirrored.velocity), (-axis.position, -axis.velocity));
            }
        }
    }

    #[test]
    fn a_target_that_nothing_limits_is_followed_as_the_rule_says(made in any_limits(), ways in proptest::collection::vec((any::<i32>(), 0u32..32, 1u8..40), 1..40)) {
        let (mut axis, mut ruled) = (AxisState::default(), AxisState::default());
        let mut target = 0i32;
        for (way, shift, ticks) in ways {
            // To targets anywhere, and from the target on by ways of every size.
            target = if shift < 4 { way >> shift } else { target };
            for _ in 0..ticks {
                target = if shift < 4 { target } else { target.wrapping_add(way >> shift) };
                prop_assert_eq!(made.step(&mut axis, target), made.limited(&mut ruled, target));
                prop_assert_eq!(axis, ruled);
            }
        }
    }

    #[test]
    fn every_correction_ramps_to_rest_at_zero_in_the_stated_time(made in any_limits(), targets in proptest::collection::vec((any::<i32>(), 1u16..300), 1..6)) {
        let mut axis = AxisState::default();
        for (target, ticks) in targets {
            for _ in 0..ticks {
                made.step(&mut axis, target);
            }
        }
        for _ in 0..made.ramp_ticks() {
            made.step(&mut axis, 0);
        }
        prop_assert!(axis.is_at_rest_at_zero(), "{:?} after {} ticks", axis, made.ramp_ticks());
    }
}
