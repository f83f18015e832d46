//! The paper's case: every number of the reference to its printed digits.

use truepath_bore::dependence::{exponent, on_teeth};
use truepath_bore::motion::Motion;
use truepath_bore::roots::roots;
use truepath_bore::setup::{FeedAt, Setup, cusp_formula};

use super::{paper, setup};

#[test]
fn waviness_of_the_paper_s_case_has_all_digits_of_the_reference() {
    let reference =
        [(1, "0.307885"), (2, "0.076355"), (3, "0.033886"), (4, "0.019051"), (6, "0.008464"), (8, "0.004760")];
    for (teeth, printed) in reference {
        assert_eq!(format!("{:.6}", paper(10.0, teeth).height()), printed, "{teeth} teeth");
    }
    for (teeth, printed) in [(1, "0.427825"), (2, "0.105433"), (3, "0.046738")] {
        assert_eq!(format!("{:.6}", paper(-10.0, teeth).height()), printed, "{teeth} teeth, reversed");
    }
}

#[test]
fn one_radian_has_sixteen_roots_and_the_wall_is_the_farthest_of_nine() {
    let profile = paper(10.0, 1);
    let found = roots(&profile.passes, 1.0);
    assert_eq!(found.len(), 16);
    assert_eq!(found.iter().filter(|r| r.on_ray).count(), 9);
    let chosen: Vec<_> = found.iter().filter(|r| r.chosen).collect();
    assert_eq!(chosen.len(), 1);
    assert_eq!(format!("{:.4}", chosen[0].radius_mm), "89.9275");
    assert_eq!(chosen[0].radius_mm, profile.at(1.0).0);
}

#[test]
fn feed_and_speed_of_the_machine_give_the_same_numbers() {
    let motion = setup(1).motion().expect("in range");
    assert!((motion.omega1 - 0.1).abs() < 1e-16 && (motion.omega2 - 10.0).abs() < 1e-14, "{motion:?}");
    for teeth in 1..=8 {
        let (by_machine, by_speeds) =
            (setup(teeth).profile(0.0).expect("a wall").height(), paper(10.0, teeth).height());
        assert!((by_machine - by_speeds).abs() < 1e-12, "{teeth}: {by_machine} {by_speeds}");
    }
    // The wall moves faster than the centre by 9 : 8.
    let at_wall = Setup { feed_at: FeedAt::Wall, feed_mm_per_min: 540.0, ..setup(1) };
    assert!((at_wall.motion().expect("in range").omega1 - 0.1).abs() < 1e-16);
}

#[test]
fn waviness_falls_with_the_square_of_the_number_of_teeth_and_the_formula_is_two_percent_low_at_one() {
    let rows = on_teeth(&setup(1), 8).expect("in range");
    let heights = || rows.iter().filter_map(|r| Some((f64::from(r.teeth), r.conventional_mm?)));
    assert_eq!(format!("{:.2}", exponent(heights()).expect("a line")), "-2.00");
    let motion = Motion::new(80.0, 0.1, 10.0).expect("in range");
    for (teeth, height) in heights() {
        let low = 1.0 - cusp_formula(&motion, 10.0, teeth as u32) / height;
        let limit = 0.02 / (teeth * teeth);
        assert!((0.2 * limit..limit).contains(&low), "{teeth}: {low}");
    }
}
