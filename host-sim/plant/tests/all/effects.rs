//! Each effect of the machine, the set-up and the probe by itself.

use truepath_plant::{FeedChange, PlantError, ProbePlan, probe, probeopen_text};

use super::*;

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
    // Nor does a flank of the cutter that crosses the normal far out in the stock make one, whatever the height.
    let soft = pass(&outside, Side::Right, &d20(), &p23());
    let levels: Vec<f64> = (0..=8).map(|k| f64::from(k) / 8.0).collect();
    assert!(soft.wall_errors(&levels).iter().flatten().filter(|e| e.is_finite()).all(|e| e.abs() <= 2.0));
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
fn a_ball_smaller_than_the_wall_is_off_finds_it_all_the_same() {
    let mut milled = pass(&corner(), Side::Right, &d20(), &hard());
    milled.machine.probe_noise_mm = 0.0;
    let at = |ball_diameter_mm| {
        let plan = ProbePlan { s_mm: vec![20.0], levels: vec![0.5], ball_diameter_mm, tip_z_mm: -15.0 };
        probe(&milled, &plan).expect("a wall")[0].ball_centre[0] - 0.5 * ball_diameter_mm
    };
    let off = at(6.0) - 24.0;
    assert!(off.abs() > 0.06, "{off}");
    assert!((at(0.1) - 24.0 - off).abs() < 2e-4, "{} {off}", at(0.1));
}

#[test]
fn a_place_off_the_contour_cannot_be_probed() {
    let milled = pass(&corner(), Side::Right, &d20(), &p23());
    let plan = ProbePlan { s_mm: vec![500.0], levels: vec![0.5], ball_diameter_mm: 6.0, tip_z_mm: -15.0 };
    assert_eq!(probe(&milled, &plan), Err(PlantError::NoWallAt { s_mm: 500.0 }));
}

#[test]
fn a_curve_in_short_lines_is_cut_like_the_arc_it_stands_for() {
    let point = |k: usize| {
        let (s, c) = (std::f64::consts::PI + (k as f64).to_radians()).sin_cos();
        [39.0 + 5.0 * c, 35.0 + 5.0 * s]
    };
    let mut facets = vec![line([34.0, 80.0], [34.0, 35.0])];
    facets.extend((0..90).map(|k| line(point(k), point(k + 1))));
    facets.push(line([39.0, 30.0], [90.0, 30.0]));
    let a = pass(&corner(), Side::Right, &d20(), &hard()).score();
    let b = pass(&facets, Side::Right, &d20(), &hard()).score();
    assert!((a.max_error_mm - b.max_error_mm).abs() < 0.0005, "{a:?} {b:?}");
    assert!((a.rms_error_mm - b.rms_error_mm).abs() < 0.0005, "{a:?} {b:?}");
}

#[test]
fn the_elastic_loop_closes_at_sharp_corners_and_on_a_soft_machine() {
    let inside = [line([0.0, 60.0], [0.0, 0.0]), line([0.0, 0.0], [60.0, 0.0])];
    let acute = [line([0.0, 60.0], [0.0, 0.0]), line([0.0, 0.0], [30.0, 50.0])];
    let soft = Machine { compliance_mm_per_n: hard().compliance_mm_per_n.map(|row| row.map(|c| 2.0 * c)), ..hard() };
    for segments in [inside.to_vec(), acute.to_vec(), corner()] {
        let path = Path::new(&segments, Side::Right, 0.1).expect("valid path");
        let milled = mill(&path, &d20(), &soft, None).expect("valid set-up");
        assert!(milled.residual_mm < 1e-4, "{}", milled.residual_mm);
        assert!(milled.score().max_error_mm > 0.1);
    }
}

#[test]
fn a_command_that_leaves_the_contour_and_a_wrong_runout_list_are_refused() {
    let path = Path::new(&corner(), Side::Right, 0.1).expect("valid path");
    let half = [[34.0, 80.0], [34.0, 40.0]];
    let refused = mill(&path, &d20(), &p23(), Some(&half));
    assert!(matches!(refused, Err(PlantError::NotCovered { .. })));
    let runout = Machine { runout_mm: vec![0.001; 4], ..p23() };
    let refused = mill(&path, &d20(), &runout, None).map(|_| ());
    assert_eq!(refused, Err(PlantError::RunoutCount { found: 4, teeth: 6 }));
}
