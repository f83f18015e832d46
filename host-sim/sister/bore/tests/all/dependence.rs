//! What the waviness depends on, what it does not, and what is refused.

use std::f64::consts::{PI, TAU};

use truepath_bore::Refusal;
use truepath_bore::depth::{generatrix_wavelength, levels};
use truepath_bore::envelope::{Profile, cutting_teeth};
use truepath_bore::motion::{Cutter, Motion};
use truepath_bore::passes::Passes;
use truepath_bore::setup::Setup;
use truepath_bore::wanted::feed_for;

use super::{paper, setup};

#[test]
fn a_turned_cutter_turns_the_marks_and_nothing_else() {
    // A whole number of marks a lap: the profile is the same all round.
    let reference = paper(10.0, 3);
    for phase in [10.0, 77.0, -140.0] {
        let motion = Motion::new(80.0, 0.1, 10.0).expect("in range");
        let cutter = Cutter { phase_deg: phase, ..Cutter::plain(10.0, 3) };
        let profile = Profile::of(Passes::new(motion, cutter.at(0.0, &motion), None).expect("a wall")).expect("closes");
        assert!((profile.height() - reference.height()).abs() < 1e-12);
        // u = 0 comes later by −phase/(ω₂ − ω₁).
        let turn = -phase.to_radians() * motion.advance();
        for n in 0..100 {
            let phi = f64::from(n) * 0.0631;
            assert!((profile.at(phi + turn).0 - reference.at(phi).0).abs() < 1e-9, "{phase} {phi}");
        }
    }
}

#[test]
fn mirroring_both_rotations_changes_nothing_and_scale_only_scales() {
    let plain = setup(2).profile(0.0).expect("a wall").height();
    let faster = Setup { feed_mm_per_min: 4800.0, rpm: 3000.0 / PI, ..setup(2) };
    assert!((faster.profile(0.0).expect("a wall").height() - plain).abs() < 1e-12, "only the ratio of speeds counts");
    let larger = Setup { hole_mm: 180.0, cutter: Cutter::plain(20.0, 2), feed_mm_per_min: 960.0, ..setup(2) };
    assert!((larger.profile(0.0).expect("a wall").height() - 2.0 * plain).abs() < 1e-12);
}

#[test]
fn a_cutter_with_much_runout_mills_with_one_tooth() {
    let mut with = setup(4);
    with.cutter.runout_mm = 0.5;
    let profile = with.profile(0.0).expect("a wall");
    let motion = Motion::new(80.0, 0.1, 10.0).expect("in range");
    let single = Cutter::plain(10.5, 1).at(0.0, &motion);
    let alone = Profile::of(Passes::new(motion, single, None).expect("a wall")).expect("closes");
    assert!((profile.height() - alone.height()).abs() < 1e-9, "{} {}", profile.height(), alone.height());
    assert_eq!(cutting_teeth(&profile.passes, &profile.stretches), 1);
    // And a runout of a nanometre is none.
    with.cutter.runout_mm = 1e-6;
    assert!(
        (with.profile(0.0).expect("a wall").height() - setup(4).profile(0.0).expect("a wall").height()).abs() < 5e-6
    );
}

#[test]
fn waviness_grows_with_feed_and_a_wanted_one_is_met() {
    for (teeth, runout_mm, rpm) in [(1, 0.0, 95.493), (4, 0.0, -95.493), (3, 0.01, 95.493), (4, 0.03, -95.493)] {
        let mut start = setup(teeth);
        start.rpm = rpm;
        start.cutter.runout_mm = runout_mm;
        let mut before = 0.0;
        for n in 1..=24 {
            start.feed_mm_per_min = 40.0 * f64::from(n);
            let height = start.profile(0.0).expect("a wall").height();
            assert!(height > before, "{teeth} teeth, F{}: {height} {before}", start.feed_mm_per_min);
            before = height;
        }
        for wanted in [0.005, 0.02, 0.1] {
            let found = feed_for(&start, wanted).expect("within reach");
            let height = found.profile(0.0).expect("a wall").height();
            assert!((height - wanted).abs() < 1e-6 * wanted, "{teeth} {runout_mm}: {height}");
        }
    }
    // Conventional marks get as deep as the cutter is wide; climbing ones part before.
    for (wanted, rpm, most) in [(20.0, 95.493, 19.9), (15.0, -95.493, 2.0)] {
        let far = feed_for(&Setup { rpm, ..setup(1) }, wanted);
        let largest = if let Err(Refusal::OutOfReach { largest_mm, .. }) = far { largest_mm } else { 0.0 };
        assert!(largest > most && largest <= wanted, "{far:?}");
    }
}

#[test]
fn one_lap_leaves_a_seam_where_the_ratio_is_not_whole_and_a_second_lap_halves_the_marks() {
    // 98.5 marks a lap.
    let of = |laps| {
        let motion = Motion::new(80.0, 0.1, 9.95).expect("in range");
        let cutter = Cutter { phase_deg: 170.0, ..Cutter::plain(10.0, 1) };
        Profile::of(Passes::new(motion, cutter.at(0.0, &motion), laps).expect("a wall")).expect("closes").height()
    };
    let (seamless, one, two) = (of(None), of(Some(1.0)), of(Some(2.0)));
    assert!(one > 2.0 * seamless && one < 4.0 * seamless, "{one} {seamless}");
    assert!((two / seamless - 0.25).abs() < 0.005, "{two} {seamless}");
}

#[test]
fn a_helix_turns_the_profile_over_the_height_and_runout_changes_it_too() {
    let mut with = setup(3);
    with.cutter.helix_deg = 30.0;
    let wavelength = generatrix_wavelength(&with).expect("a helix");
    assert!((wavelength - TAU * 10.0 / (3.0 * 30f64.to_radians().tan())).abs() < 1e-12);
    let (tip, higher) = (with.profile(0.0).expect("a wall"), with.profile(7.0).expect("a wall"));
    let turn = levels(&with, 7.0, 2).expect("a wall")[1].turned_deg.to_radians();
    assert!(turn > 0.0);
    for n in 0..200 {
        let phi = f64::from(n) * 0.0311;
        assert!((higher.at(phi + turn).0 - tip.at(phi).0).abs() < 1e-9);
    }
    // A wavelength up the wall the marks are the same again.
    let again = with.profile(wavelength).expect("a wall");
    assert!((again.at(1.0).0 - tip.at(1.0).0).abs() < 1e-9);
    with.cutter.runout_mm = 0.02;
    let over = levels(&with, 20.0, 9).expect("a wall");
    let heights = over.iter().map(|l| l.height_mm).fold((f64::MAX, 0.0f64), |(l, h), v| (l.min(v), h.max(v)));
    assert!(heights.1 > 1.05 * heights.0, "{heights:?}");
}

#[test]
fn numbers_without_a_wall_are_refused_with_their_limit() {
    let range = |found: Result<Motion, Refusal>| matches!(found, Err(Refusal::Range { .. }));
    for bad in [f64::NAN, f64::INFINITY, 0.0, -1.0, 1e300] {
        assert!(range(Setup { hole_mm: bad, ..setup(1) }.motion()));
        assert!(range(Setup { feed_mm_per_min: bad, ..setup(1) }.motion()));
        assert!(range(Setup { cutter: Cutter::plain(bad, 1), ..setup(1) }.motion()));
        assert!(range(Motion::new(bad, 0.1, 10.0)) && range(Motion::new(80.0, bad, 10.0)));
    }
    assert!(range(Setup { rpm: f64::NAN, ..setup(1) }.motion()));
    assert!(range(Setup { hole_mm: 10.0, ..setup(1) }.motion()), "a hole no larger than the cutter");
    assert!(range(Setup { cutter: Cutter::plain(10.0, 0), ..setup(1) }.motion()));
    assert_eq!(Motion::new(80.0, 10.0, 10.0), Err(Refusal::NoRelativeTurn));
    assert!(range(Setup { feed_mm_per_min: 40_000.0, ..setup(1) }.motion()), "a fifth of a turn a lap");
    let apart = Setup { feed_mm_per_min: 8_000.0, rpm: -95.493, ..setup(1) }.profile(0.0).err();
    assert!(matches!(apart, Some(Refusal::Apart { .. })), "{apart:?}");
    let many = Setup { feed_mm_per_min: 1e-4, ..setup(1) }.profile(0.0).err();
    assert!(matches!(many, Some(Refusal::Passes { .. })), "{many:?}");
    let laps = Setup { laps: Some(0.5), ..setup(1) }.profile(0.0).err();
    assert!(matches!(laps, Some(Refusal::Range { .. })), "{laps:?}");
}
