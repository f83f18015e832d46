//! Parameters under their ISO names.

use std::f64::consts::TAU;

use truepath_bore::filter::Closed;
use truepath_bore::setup::Setup;
use truepath_bore::texture::{Cutoffs, evaluate, texture};

use super::setup;

#[test]
fn iso_parameters_say_where_the_marks_fall() {
    let profile = setup(1).profile(0.0).expect("a wall");
    let close = |a: f64, b: f64, part: f64| (a - b).abs() <= part * b.abs();
    // Marks 5.7 mm apart: waviness for λc 0.8, roughness for λc 25.
    let fine = texture(&profile, &Cutoffs { lambda_c_mm: 0.08, upr: 50.0 }).expect("in range");
    assert!(close(fine.marks.per_revolution, 99.0, 1e-12) && fine.marks.fall_under == "waviness");
    assert!(close(fine.marks.spacing_mm, TAU * 89.9 / 99.0, 0.001), "{:?}", fine.marks);
    assert!(close(fine.wt, fine.pt, 0.02) && fine.rt < 0.03 * fine.pt, "{fine:?}");
    let coarse = texture(&profile, &Cutoffs { lambda_c_mm: 25.0, upr: 50.0 }).expect("in range");
    assert_eq!(coarse.marks.fall_under, "roughness");
    assert!(close(coarse.rz, coarse.pt, 1e-3) && coarse.wt < 1e-3 * coarse.pt, "{coarse:?}");
    // 99 undulations: 2^−(99/50)² of them pass the roundness filter, nearly all of them that of 1500.
    let first = Closed::of(&profile, 1500.0).amplitude(99);
    assert!(close(coarse.ront, 2.0 * first * (-(99.0f64 / 50.0).powi(2)).exp2(), 1e-3), "{coarse:?} {first}");
    let all = texture(&profile, &Cutoffs { lambda_c_mm: 0.8, upr: 15000.0 }).expect("in range");
    assert!(close(all.ront, all.pt, 5e-3) && all.ront_mzci <= all.ront, "{all:?}");
}

#[test]
fn parameters_do_not_depend_on_the_sampling() {
    let profile = setup(3).profile(0.0).expect("a wall");
    let of = |count: u32| {
        let radii = (0..count).map(|n| profile.at(TAU * f64::from(n) / f64::from(count)).0).collect();
        evaluate(&profile, &Closed::from_radii(radii), &Cutoffs::default()).expect("in range")
    };
    let (a, b) = (of(1 << 15), of(100_003));
    for (x, y) in [(a.wt, b.wt), (a.rz, b.rz), (a.ra, b.ra), (a.ront, b.ront)] {
        assert!((x - y).abs() < 2e-3 * a.pt, "{x} {y}");
    }
    assert_eq!(a.pt, b.pt);
}

#[test]
fn filtered_parameters_are_those_of_a_gaussian_filter_in_space() {
    // Independent: 40 000 samples, the weighting function of ISO 16610-21 summed over 5 λc, mean line by least squares.
    let t = texture(&setup(1).profile(0.0).expect("a wall"), &Cutoffs::default()).expect("in range");
    for (found, other) in [
        (t.wt, 0.28186),
        (t.ra, 0.001_515_1),
        (t.rq, 0.003_404_86),
        (t.ront, 0.016_446),
        (t.ronp, 0.008_222),
        (t.ronv, 0.008_224),
        (t.ronq, 0.005_813_9),
    ] {
        assert!((found / other - 1.0).abs() < 1e-3, "{found} {other}");
    }
}

#[test]
fn waviness_without_its_circle_can_be_higher_than_the_whole_profile() {
    // At 95 rev/min the marks do not close after a lap: the circle lies aside of the centre of the path.
    let profile = Setup { rpm: 95.0, ..setup(1) }.profile(0.0).expect("a wall");
    let fine = texture(&profile, &Cutoffs { lambda_c_mm: 0.02, upr: 50.0 }).expect("in range");
    assert!(fine.wt > fine.pt && fine.wt < 1.03 * fine.pt, "{fine:?}");
}
