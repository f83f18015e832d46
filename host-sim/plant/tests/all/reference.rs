//! Closed forms and the published corner.

use std::f64::consts::{FRAC_PI_2, PI};

use truepath_plant::Sample;

use super::*;

#[test]
fn the_engagement_of_the_papers_corner_is_the_reference_at_every_listed_place() {
    let milled = pass(&corner(), Side::Right, &d20(), &Machine::rigid());
    let reference = [
        (-8.0, 45.573),
        (-5.0, 47.43),
        (-4.0, 50.00),
        (-3.0, 54.12),
        (-2.0, 60.19),
        (-1.0, 68.52),
        (0.0, 79.047),
        (1.5, 79.047),
        (3.0, 79.047),
        (4.0, 76.88),
        (5.0, 71.51),
        (6.0, 64.02),
        (7.0, 54.77),
        (7.854, 45.573),
    ];
    for (s, expected) in reference {
        let found = arc_deg(&milled, 45.0 + s);
        assert!((found - expected).abs() < 0.05, "s = {s}: {found}");
    }
}

#[test]
fn the_engagement_on_arcs_is_the_closed_form() {
    for rp in [12.0, 15.0, 20.0, 30.0, 50.0, 100.0] {
        let rho: f64 = rp - 10.0;
        let rs = rp - 3.0;
        let expected = ((rs * rs - rho * rho - 100.0) / (20.0 * rho)).acos();
        let half = [
            line([-20.0, -rho], [0.0, -rho]),
            arc([0.0, -rho], [0.0, rho], [0.0, 0.0], true),
            line([0.0, rho], [-20.0, rho]),
        ];
        let milled = pass(&half, Side::Right, &d20(), &Machine::rigid());
        // Early on the arc, before the exit of the engagement reaches the next line.
        let found = arc_deg(&milled, 20.0 + 0.3 * rho);
        assert!((found - expected.to_degrees()).abs() < 0.03, "concave {rp}: {found}");
    }
    for (rp, degrees) in [(5.0, 29.541), (15.0, 36.678), (30.0, 40.204), (100.0, 43.682)] {
        let rho = rp + 10.0;
        let quarter = [line([-20.0, rho], [0.0, rho]), arc([0.0, rho], [rho, 0.0], [0.0, 0.0], false)];
        let milled = pass(&quarter, Side::Right, &d20(), &Machine::rigid());
        let found = arc_deg(&milled, 20.0 + 0.5 * rho * FRAC_PI_2);
        assert!((found - degrees).abs() < 0.01, "convex {rp}: {found}");
    }
}

#[test]
fn the_mean_force_of_the_corner_rises_by_the_ratio_of_the_chip_areas() {
    let milled = pass(&corner(), Side::Right, &d20(), &Machine { compliance_mm_per_n: [[0.0; 2]; 2], ..p23() });
    let at = |s: f64| &milled.samples[milled.path.index_at(s)];
    let (straight, plateau) = (at(20.0), at(46.5));
    assert!((straight.force_n[0].hypot(straight.force_n[1]) - 150.0).abs() < 0.5);
    assert!((plateau.force_n[0].hypot(plateau.force_n[1]) - 390.0).abs() < 1.5);
    let area = |rad: f64| 1.0 - rad.cos();
    let ratio = area(plateau.leaving_rad()) / area(straight.leaving_rad());
    assert!((ratio - 2.70).abs() < 0.002, "{ratio}");
}

#[test]
fn the_mean_law_leaves_the_published_error_on_the_straight_and_in_the_arc() {
    let milled = pass(&corner(), Side::Right, &d20(), &p23());
    let errors = milled.mean_errors();
    let straight = errors[milled.path.index_at(20.0)];
    assert!((straight - 0.0914).abs() < 0.0005, "{straight}");
    let score = milled.score();
    assert!((score.max_error_mm - 0.297).abs() < 0.003, "{score:?}");
    assert!(score.gouge_mm < 0.0, "climb milling leaves material everywhere: {score:?}");
    let most = milled.samples.iter().map(|s| s.leaving_rad()).fold(0.0, f64::max).to_degrees();
    assert!((most - 76.6).abs() < 0.3, "{most}");
    // No height differs from another under the mean law without bending.
    assert!(score.axial_form_mm < 1e-12);
}

#[test]
fn swept_area_and_engagement_agree_on_an_uneven_path() {
    // r(1 − cos φ₁) is the area removed per unit of travel; over a pass they sum to the area between raw stock and wall.
    let milled = pass(&corner(), Side::Right, &d20(), &Machine::rigid());
    let run = &milled.samples[milled.path.index_at(20.0)..=milled.path.index_at(80.0)];
    let rate = |s: &Sample| 10.0 * (1.0 - s.leaving_rad().cos());
    let swept: f64 = run.windows(2).map(|w| 0.5 * (rate(&w[0]) + rate(&w[1])) * (w[1].s_mm - w[0].s_mm)).sum();
    let length = run[run.len() - 1].s_mm - run[0].s_mm;
    // Both ends lie on straights, where the shape of the removed front is the same, so it cancels.
    let arc_length = 2.5 * PI;
    let stock = 3.0 * (length - arc_length) + 0.25 * PI * (15.0f64.powi(2) - 12.0f64.powi(2));
    assert!((swept - stock).abs() < 0.01, "{swept} {stock}");
}

#[test]
fn commanding_the_opposite_of_the_nominal_deflection_leaves_nearly_nothing_under_the_mean_law() {
    // With the actual path nominal, the engagement is nominal and one shot is exact.
    let nominal = pass(&corner(), Side::Right, &d20(), &Machine { compliance_mm_per_n: [[0.0; 2]; 2], ..p23() });
    let command: Vec<Point> = nominal
        .samples
        .iter()
        .map(|s| [s.commanded[0] - s.force_n[0] / 1150.0, s.commanded[1] - s.force_n[1] / 1150.0])
        .collect();
    let plain = pass(&corner(), Side::Right, &d20(), &p23());
    let comparison = plain.compare(&command).expect("follows the contour");
    assert!(comparison.after.max_error_mm < 0.002, "{comparison:?}");
    assert!(comparison.factor > 150.0, "{comparison:?}");
}
