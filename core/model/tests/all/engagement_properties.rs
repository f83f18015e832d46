//! Engagement against its closed forms and the swept-area identity, over random cuts in random places.
use crate::corner;
use corner::*;
use proptest::prelude::*;
use truepath_model::cut::{CutSetup, Milling, Path, WallLaw};
use truepath_units::Offset;
use truepath_units::geometry::{Curve, Point, Side, Vector};

/// The engagement at the middle of a path, degrees.
fn middle(path: &Path) -> f64 {
    let index = path.first() + path.count() / 2;
    let frame = path.frame(index, Vector::ZERO).unwrap();
    float(path.engagement(index, Vector::ZERO, &frame)).to_degrees()
}

fn cut(radius_um: i64, allowance_um: i64, wall: Side) -> CutSetup {
    CutSetup {
        radius: Offset::from_um(radius_um),
        allowance: Offset::from_um(allowance_um),
        wall,
        milling: Milling::of(wall, true),
        ..setup(WallLaw::Mean)
    }
}

/// A line and an arc of `rho` mm, both of them turned and shifted.
fn placed(rho: f64, left_turn: bool, angle: f64, shift: (f64, f64)) -> (Curve, Curve) {
    let place = |x: f64, y: f64| {
        let (s, c) = angle.sin_cos();
        point(c * x - s * y + shift.0, s * x + c * y + shift.1)
    };
    let y = if left_turn { rho } else { -rho };
    // A third of a turn about (0, y).
    let end = (f64::to_radians(120.0).sin() * rho, y - y * f64::to_radians(120.0).cos());
    let arc = Curve::arc(place(0.0, 0.0), place(end.0, end.1), place(0.0, y), left_turn).unwrap();
    let line: (Point, Point) = (place(0.0, 0.0), place(3.0 * rho, 0.0));
    (Curve::line(line.0, line.1).unwrap(), arc)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(150))]

    #[test]
    fn closed_forms_hold_for_any_radius_allowance_turn_and_shift(
        radius in 2_000i64..12_000,
        share in 2i64..60,
        tightness in 15i64..600,
        left_turn: bool,
        wall_left: bool,
        angle in 0.0..core::f64::consts::TAU,
        shift in (-2000.0..2000.0f64, -2000.0..2000.0f64),
    ) {
        let allowance = radius * share / 100;
        let (r, h) = (radius as f64 / 1e3, allowance as f64 / 1e3);
        let wall = if wall_left { Side::Left } else { Side::Right };
        let convex = left_turn == wall_left;
        // Concave: the path is an arc of rho, the wall one of rho + r. Convex: the wall is one of rho − r.
        let rho = if convex { r + r * tightness as f64 / 100.0 } else { r * tightness as f64 / 100.0 };
        let (line, arc) = placed(rho, left_turn, angle, shift);
        let s = cut(radius, allowance, wall);
        let straight = middle(&path(&chain(&[line], 400.0), &s, 100));
        let expected = (1.0 - h / r).acos().to_degrees();
        prop_assert!((straight - expected).abs() < 0.01, "straight {} instead of {}", straight, expected);

        let (stock, cosine);
        if convex {
            stock = rho - r + h;
            cosine = (rho * rho + r * r - stock * stock) / (2.0 * rho * r);
        } else {
            stock = rho + r - h;
            cosine = (stock * stock - rho * rho - r * r) / (2.0 * rho * r);
        }
        let expected = cosine.acos().to_degrees();
        // The window ahead is 2.2 radii and the arc a third of a turn: tighter cuts leave it before they leave the arc.
        let ahead = (expected.to_radians().sin() * r).atan2(rho + if convex { -r } else { r } * cosine).abs();
        prop_assume!(ahead < 0.9 && ahead * rho < 2.0 * r);
        let got = middle(&path(&chain(&[arc], 400.0), &s, 50));
        prop_assert!((got - expected).abs() < 0.01, "arc {} instead of {}", got, expected);

        // Swept area per unit of centre travel: r(1 − cos φ) = h(Rp + Rs)/(2ρ).
        let finished = if convex { rho - r } else { rho + r };
        let swept = h * (finished + stock) / (2.0 * rho);
        let by_angle = r * (1.0 - got.to_radians().cos());
        prop_assert!((swept - by_angle).abs() < 2e-4 * r, "swept {} by angle {}", swept, by_angle);
    }
}

#[test]
fn a_circle_in_short_lines_engages_like_the_circle() {
    // 1° facets of a path of 12 mm about an inside corner of 22 mm.
    let at = |k: i32| point(12.0 * f64::from(k).to_radians().cos(), 12.0 * f64::from(k).to_radians().sin());
    let facets: Vec<Curve> = (0..200).map(|k| Curve::line(at(k), at(k + 1)).unwrap()).collect();
    let arc = Curve::arc(at(0), at(200), point(0.0, 0.0), true).unwrap();
    let s = cut(10_000, 3_000, Side::Right);
    let (facets, arc) = (middle(&path(&chain(&facets, 400.0), &s, 100)), middle(&path(&chain(&[arc], 400.0), &s, 100)));
    assert!((facets - arc).abs() < 0.1, "facets {facets}, arc {arc}");
}

#[test]
fn a_sharp_inside_corner_is_entered_and_left() {
    let corner = [
        Curve::line(point(0.0, 30.0), point(0.0, 0.0)).unwrap(),
        Curve::line(point(0.0, 0.0), point(30.0, 0.0)).unwrap(),
    ];
    let s = cut(5_000, 1_000, Side::Right);
    let path = path(&chain(&corner, 400.0), &s, 100);
    let degrees: Vec<f64> = path
        .working()
        .map(|i| float(path.engagement(i, Vector::ZERO, &path.frame(i, Vector::ZERO).unwrap())).to_degrees())
        .collect();
    let straight = (1.0f64 - 0.2).acos().to_degrees();
    let peak = degrees.iter().copied().fold(0.0, f64::max);
    // Far from the corner the straight wall; in it the cutter meets the second wall head on.
    assert!((degrees[0] - straight).abs() < 0.01 && (degrees[degrees.len() - 1] - straight).abs() < 0.01);
    assert!(peak > 115.0 && peak < 130.0, "{peak}");
}

#[test]
fn circle_and_stock_that_meet_at_a_small_angle_are_crossed_exactly() {
    // A path of 0.30 mm about an inside corner, 2 % of the radius to cut: the circles differ by a tenth.
    let (_, arc) = placed(0.301_35, false, 0.0, (0.0, 0.0));
    let (r, h, rho) = (2.009, 0.04, 0.301_35);
    let got = middle(&path(&chain(&[arc], 400.0), &cut(2_009, 40, Side::Left), 50));
    let stock: f64 = rho + r - h;
    let expected = ((stock * stock - rho * rho - r * r) / (2.0 * rho * r)).acos().to_degrees();
    assert!((got - expected).abs() < 0.01, "{got} instead of {expected}");
}
