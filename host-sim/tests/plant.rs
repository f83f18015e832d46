//! The plant against the closed forms, the published corner and the symmetries of the physics.

use std::f64::consts::{FRAC_PI_2, PI};
use truepath::plant::{
    Cut, FeedChange, Machine, Milled, Path, PlantError, Point, ProbePlan, Segment, Side, Spindle, WallLaw, mill, probe,
    probeopen_text,
};

fn line(from: Point, to: Point) -> Segment {
    Segment::Line { from, to }
}

fn arc(from: Point, to: Point, centre: Point, ccw: bool) -> Segment {
    Segment::Arc { from, to, centre, ccw }
}

/// The corner of P18 and P23; the arc starts at s = 45 mm.
fn corner() -> Vec<Segment> {
    vec![
        line([34.0, 80.0], [34.0, 35.0]),
        arc([34.0, 35.0], [39.0, 30.0], [39.0, 35.0], true),
        line([39.0, 30.0], [90.0, 30.0]),
    ]
}

fn d20() -> Cut {
    Cut {
        radius_mm: 10.0,
        teeth: 6,
        helix_deg: 30.0,
        axial_depth_mm: 10.0,
        feed_mm_per_min: 400.0,
        feed_changes: vec![],
        spindle_rpm: 1500.0,
        spindle: Spindle::Clockwise,
        allowance_mm: 3.0,
        surface: None,
        memory_mm: None,
    }
}

/// The machine of P23: mean law, no edge force.
fn p23() -> Machine {
    Machine {
        ktc_n_per_mm2: 1147.7,
        krc_n_per_mm2: 0.3 * 1147.7,
        compliance_mm_per_n: Machine::compliance_of_stiffness(1150.0, 1150.0),
        law: WallLaw::Mean,
        ..Machine::rigid()
    }
}

/// Everything at once.
fn hard() -> Machine {
    Machine {
        ktc_n_per_mm2: 1000.0,
        krc_n_per_mm2: 330.0,
        kte_n_per_mm: 12.0,
        kre_n_per_mm: 16.0,
        size_exponent: 0.2,
        compliance_mm_per_n: [[1.0 / 1150.0, 1.0 / 9000.0], [1.0 / 9000.0, 1.0 / 900.0]],
        bend: 0.15,
        runout_mm: vec![0.002, -0.001, 0.003, 0.0, -0.002, 0.001],
        edge_wear_per_m: 0.5,
        stock_variation_mm: 0.05,
        probe_noise_mm: 0.002,
        seed: 3,
        ..Machine::rigid()
    }
}

fn pass(segments: &[Segment], side: Side, cut: &Cut, machine: &Machine) -> Milled {
    let path = Path::new(segments, side, 0.1).expect("valid path");
    let milled = mill(&path, cut, machine, None).expect("valid set-up");
    assert!(milled.residual_mm < 1e-6, "the elastic loop stayed open by {} mm", milled.residual_mm);
    milled
}

/// Engaged arc at the place s of a nominal pass, degrees, between samples by proportion.
fn arc_deg(milled: &Milled, s: f64) -> f64 {
    let k = milled.samples.partition_point(|x| x.s_mm < s).max(1);
    let (a, b) = (&milled.samples[k - 1], &milled.samples[k]);
    let u = (s - a.s_mm) / (b.s_mm - a.s_mm);
    (a.leaving_rad() * (1.0 - u) + b.leaving_rad() * u).to_degrees()
}

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
fn climb_leaves_material_and_conventional_milling_gouges() {
    let straight = [line([0.0, 0.0], [60.0, 0.0])];
    let climb = pass(&straight, Side::Right, &d20(), &p23()).score();
    let conventional = pass(&straight, Side::Left, &d20(), &p23()).score();
    assert!(climb.gouge_mm < -0.05, "{climb:?}");
    assert!(conventional.gouge_mm > 0.02, "{conventional:?}");
}

#[test]
fn a_rigid_machine_cuts_the_nominal_wall() {
    let facets: Vec<Segment> = (0..90)
        .map(|k| {
            let at = |k: i32| [30.0 * f64::from(k).to_radians().cos(), 30.0 * f64::from(k).to_radians().sin()];
            line(at(k), at(k + 1))
        })
        .collect();
    for segments in [corner(), facets] {
        let score = pass(&segments, Side::Right, &d20(), &Machine::rigid()).score();
        // What is left is the sagitta of the facets, 30·(1 − cos 0.5°) = 0.0011 mm, or the cusps between samples.
        assert!(score.worst_height_mm < 0.0013, "{score:?}");
    }
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

fn mirrored(p: Point) -> Point {
    [-p[0], p[1]]
}

#[test]
fn the_mirrored_program_on_the_mirrored_machine_has_the_mirrored_errors() {
    let mirror: Vec<Segment> = corner()
        .into_iter()
        .map(|s| match s {
            Segment::Line { from, to } => line(mirrored(from), mirrored(to)),
            Segment::Arc { from, to, centre, ccw } => arc(mirrored(from), mirrored(to), mirrored(centre), !ccw),
        })
        .collect();
    let machine = hard();
    let [[xx, xy], [yx, yy]] = machine.compliance_mm_per_n;
    let mirror_machine = Machine { compliance_mm_per_n: [[xx, -xy], [-yx, yy]], ..machine.clone() };
    let mirror_cut = Cut { spindle: Spindle::CounterClockwise, ..d20() };
    let a = pass(&corner(), Side::Right, &d20(), &machine).wall_errors(&[0.1, 0.6]);
    let b = pass(&mirror, Side::Left, &mirror_cut, &mirror_machine).wall_errors(&[0.1, 0.6]);
    for (a, b) in a.iter().flatten().zip(b.iter().flatten()) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    assert!(a[0].iter().any(|e| e.abs() > 0.1));
}

#[test]
fn turning_everything_by_a_quarter_turns_the_errors_with_it() {
    let turned = |p: Point| [-p[1] + 7.0, p[0] - 3.0];
    let quarter: Vec<Segment> = corner()
        .into_iter()
        .map(|s| match s {
            Segment::Line { from, to } => line(turned(from), turned(to)),
            Segment::Arc { from, to, centre, ccw } => arc(turned(from), turned(to), turned(centre), ccw),
        })
        .collect();
    let machine = hard();
    let [[xx, xy], [yx, yy]] = machine.compliance_mm_per_n;
    let turned_machine = Machine { compliance_mm_per_n: [[yy, -yx], [-xy, xx]], ..machine.clone() };
    let a = pass(&corner(), Side::Right, &d20(), &machine).mean_errors();
    let b = pass(&quarter, Side::Right, &d20(), &turned_machine).mean_errors();
    for (a, b) in a.iter().zip(&b) {
        assert!((a - b).abs() < 1e-7, "{a} {b}");
    }
}

#[test]
fn a_second_pass_over_the_surface_of_the_first_cuts_what_the_first_has_left() {
    let straight = [line([0.0, 0.0], [80.0, 0.0])];
    let first = pass(&straight, Side::Right, &d20(), &p23());
    let surface = first.surface(&[0.5]);
    let spring = Cut { surface: Some(surface), ..d20() };
    let second = pass(&straight, Side::Right, &spring, &p23());
    let left = second.mean_errors()[second.path.index_at(40.0)];
    let before = first.mean_errors()[first.path.index_at(40.0)];
    // 0.0914 mm of stock instead of 3 mm: cos φ₁ = 1 − 0.0914/10.
    let expected = (1.0 - (before - left) / 10.0).acos();
    let found = second.samples[second.path.index_at(40.0)].leaving_rad();
    assert!(left > 0.0 && left < 0.1 * before, "{left} of {before}");
    assert!((found - expected).abs() < 1e-3, "{found} {expected}");
}

#[test]
fn coming_back_to_the_start_of_a_closed_contour_meets_no_stock() {
    let circle = [arc([20.0, 0.0], [20.0, 0.0], [0.0, 0.0], true)];
    let all = pass(&circle, Side::Right, &d20(), &Machine::rigid());
    let end = all.samples.len() - 1;
    assert!(all.samples[end / 2].leaving_rad() > 0.9);
    // The cusp between the first place and the present one is all that is left.
    assert!(all.samples[end - 2].leaving_rad() < 0.02);
    // A short memory gives the contour no seam.
    let short = pass(&circle, Side::Right, &Cut { memory_mm: Some(3.0), ..d20() }, &Machine::rigid());
    let (middle, last) = (&short.samples[end / 2], &short.samples[end - 2]);
    assert!((middle.leaving_rad() - last.leaving_rad()).abs() < 1e-4);
}

#[test]
fn an_outside_corner_without_an_arc_is_judged_only_where_there_is_a_wall() {
    // Wall on the right, turn to the right: the part keeps a sharp corner at (−10, −10).
    let outside = [line([-60.0, 0.0], [0.0, 0.0]), line([0.0, 0.0], [0.0, -60.0])];
    let milled = pass(&outside, Side::Right, &d20(), &Machine::rigid());
    let errors = milled.mean_errors();
    let at = |s: f64| errors[milled.path.index_at(s)];
    assert!(at(55.0).is_nan() && at(65.0).is_nan());
    assert!(at(45.0).abs() < 1e-6 && at(75.0).abs() < 1e-6);
    // The raw stock ends at its own corner (−7, −7): from there on the cutter meets nothing.
    assert!((arc_deg(&milled, 40.0) - 45.573).abs() < 0.01);
    assert!(arc_deg(&milled, 59.0) < 0.01);
}

#[test]
fn a_feed_change_changes_the_force_from_its_place_on() {
    let straight = [line([0.0, 0.0], [80.0, 0.0])];
    let cut = Cut { feed_changes: vec![FeedChange { from_s_mm: 40.0, feed_mm_per_min: 200.0 }], ..d20() };
    let milled = pass(&straight, Side::Right, &cut, &Machine { compliance_mm_per_n: [[0.0; 2]; 2], ..p23() });
    let at = |s: f64| milled.samples[milled.path.index_at(s)].force_n[1];
    assert!((at(60.0) / at(20.0) - 0.5).abs() < 1e-9);
}

#[test]
fn wear_raises_the_edge_force_and_stock_variation_stays_within_its_bound() {
    let straight = [line([0.0, 0.0], [200.0, 0.0])];
    let worn = Machine { kre_n_per_mm: 20.0, edge_wear_per_m: 1.0, ..Machine::rigid() };
    let milled = pass(&straight, Side::Right, &d20(), &worn);
    let at = |s: f64| milled.samples[milled.path.index_at(s)].force_n[1];
    assert!((at(150.0) / at(50.0) - 1.15 / 1.05).abs() < 1e-6);

    let uneven = Machine { stock_variation_mm: 0.1, seed: 5, ..Machine::rigid() };
    let milled = pass(&straight, Side::Right, &d20(), &uneven);
    let depths: Vec<f64> = milled.samples.iter().map(|s| 10.0 * (1.0 - s.leaving_rad().cos())).collect();
    let (least, most) = depths.iter().fold((f64::MAX, f64::MIN), |(a, b), &d| (a.min(d), b.max(d)));
    assert!(least > 2.9 - 1e-3 && most < 3.1 + 1e-3 && most - least > 0.02, "{least} {most}");
}

#[test]
fn runout_lets_the_longest_tooth_make_the_wall() {
    let runout = vec![0.0, -0.01, 0.02, 0.0, 0.005, -0.004];
    let machine = Machine { runout_mm: runout, ..Machine::rigid() };
    let score = pass(&corner(), Side::Right, &d20(), &machine).score();
    assert!((score.gouge_mm - 0.02).abs() < 1e-4, "{score:?}");
}

#[test]
fn probing_is_reproducible_by_seed_and_finds_the_wall_error() {
    let milled = pass(&corner(), Side::Right, &d20(), &hard());
    let plan = ProbePlan {
        s_mm: vec![20.0, 32.0, 68.0, 80.0],
        levels: vec![0.1, 0.5, 0.9],
        ball_diameter_mm: 6.0,
        tip_z_mm: -15.0,
    };
    let text = |m: &Milled| probeopen_text(&probe(m, &plan).expect("walls there"));
    assert_eq!(text(&milled), text(&milled));
    let mut other = milled.clone();
    other.machine.seed += 1;
    assert_ne!(text(&milled), text(&other));

    let first = text(&milled).lines().next().expect("twelve lines").to_owned();
    let columns: Vec<f64> = first.split(' ').map(|c| c.parse().expect("number")).collect();
    assert_eq!(columns.len(), 9);
    assert_eq!(text(&milled).lines().count(), 12);
    assert!((columns[2] + 14.0).abs() < 1e-9);

    // Without noise the contact, ball centre plus R along n, lies at the wall error.
    other.machine.probe_noise_mm = 0.0;
    let touches = probe(&other, &plan).expect("walls there");
    let errors = milled.wall_errors(&plan.levels);
    let i = milled.path.index_at(20.0);
    // The first leg runs towards −y with the wall at x = 24.
    let contact = touches[1].ball_centre[0] - 3.0;
    assert!((contact - 24.0 - errors[1][i]).abs() < 2e-4, "{contact} {}", errors[1][i]);

    // The spread over many touches of one place is the stated noise.
    let many = ProbePlan { s_mm: vec![20.0; 2000], levels: vec![0.5], ..plan };
    let xs: Vec<f64> = probe(&milled, &many).expect("walls there").iter().map(|t| t.ball_centre[0]).collect();
    let mean = xs.iter().sum::<f64>() / 2000.0;
    let sigma = (xs.iter().map(|x| (x - mean).powi(2)).sum::<f64>() / 2000.0).sqrt();
    assert!((sigma - 0.002).abs() < 0.0002, "{sigma}");
}

#[test]
fn a_place_off_the_contour_cannot_be_probed() {
    let milled = pass(&corner(), Side::Right, &d20(), &p23());
    let plan = ProbePlan { s_mm: vec![500.0], levels: vec![0.5], ball_diameter_mm: 6.0, tip_z_mm: -15.0 };
    assert_eq!(probe(&milled, &plan), Err(PlantError::NoWallAt { s_mm: 500.0 }));
}

#[test]
fn swept_area_and_engagement_agree_on_an_uneven_path() {
    // r(1 − cos φ₁) is the area removed per unit of travel; over a pass they sum to the area between raw stock and wall.
    let milled = pass(&corner(), Side::Right, &d20(), &Machine::rigid());
    let (lo, hi) = (20.0, 80.0);
    let mut swept = 0.0;
    for w in milled.samples.windows(2) {
        if w[0].s_mm >= lo && w[1].s_mm <= hi {
            let rate = |k: usize| 10.0 * (1.0 - w[k].leaving_rad().cos());
            swept += 0.5 * (rate(0) + rate(1)) * (w[1].s_mm - w[0].s_mm);
        }
    }
    // Both ends lie on straights, where the shape of the removed front is the same, so it cancels.
    let arc_length = 2.5 * PI;
    let stock = 3.0 * (hi - lo - arc_length) + 0.25 * PI * (15.0f64.powi(2) - 12.0f64.powi(2));
    assert!((swept - stock).abs() < 0.6, "{swept} {stock}");
}
