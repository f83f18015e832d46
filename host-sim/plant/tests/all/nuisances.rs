//! What shops add to a machine, each effect by itself against what it is expected to do by hand.

use std::f64::consts::PI;

use truepath_plant::{Drives, Felt, Heights, Part, ProbeErrors, ProbePlan, Run, UnevenStock, YieldingWall, probe};

use super::*;

/// Edges only: the force is linear in the engaged arc and knows no feed.
fn edges() -> Machine {
    Machine {
        kte_n_per_mm: 10.0,
        kre_n_per_mm: 20.0,
        compliance_mm_per_n: Machine::compliance_of_stiffness(1e5, 1e5),
        law: WallLaw::Mean,
        ..Machine::rigid()
    }
}

fn straight(length: f64) -> [Segment; 1] {
    [line([0.0, 0.0], [length, 0.0])]
}

/// Stock on the wall met at a place by a rigid machine, mm: from the engaged arc, h = r·(1 − cos φ₁).
fn stock(milled: &Milled, s: f64) -> f64 {
    milled.cut.radius_mm * (1.0 - arc_deg(milled, s).to_radians().cos())
}

fn error_at(milled: &Milled, s: f64) -> f64 {
    milled.mean_errors()[milled.path.index_at(s)]
}

#[test]
fn the_force_factor_scales_the_deflection_of_an_edge_only_cut() {
    let at = |force_factor| {
        let milled = pass(&straight(60.0), Side::Right, &d20(), &Machine { force_factor, ..edges() });
        (error_at(&milled, 30.0), milled.samples[milled.path.index_at(30.0)].clone())
    };
    let ((sharp, sample), (worn, _)) = (at(1.0), at(1.18));
    // Climb: −N·b/(2π)·(Kte·(1 − cos φ₁) + Kre·sin φ₁) along the normal, on a stiffness of 1e5 N/mm.
    let phi = sample.leaving_rad();
    let normal = 6.0 * 10.0 / (2.0 * PI) * (10.0 * (1.0 - phi.cos()) + 20.0 * phi.sin());
    assert!((sharp - normal / 1e5).abs() < 1e-3 * sharp, "{sharp} {}", normal / 1e5);
    // The deeper push takes some of the arc: 1e-3 of it here.
    assert!((worn / sharp - 1.18).abs() < 2e-3, "{}", worn / sharp);
}

#[test]
fn a_yielding_stretch_leaves_its_compliance_times_the_normal_force() {
    let give = YieldingWall { from_mm: 30.0, to_mm: 70.0, rise_mm: 8.0, compliance_mm_per_n: 2e-5 };
    let machine = Machine { compliance_mm_per_n: [[0.0; 2]; 2], yielding: give, ..edges() };
    let milled = pass(&straight(100.0), Side::Right, &d20(), &machine);
    let force = |s: f64| -milled.samples[milled.path.index_at(s)].force_n[1] * milled.path.normal[0][1];
    assert!(force(50.0) > 100.0);
    for s in [42.0, 50.0, 58.0] {
        assert!((error_at(&milled, s) - 2e-5 * force(s)).abs() < 1e-6, "{s}: {}", error_at(&milled, s));
    }
    // Half of it in the middle of the rise, none outside, and the wall is rigid across the normal.
    assert!((error_at(&milled, 34.0) - 1e-5 * force(34.0)).abs() < 2e-5 * 5.0);
    assert!(error_at(&milled, 20.0).abs() < 1e-9 && error_at(&milled, 80.0).abs() < 1e-9);
    assert!(milled.samples.iter().all(|s| (s.actual[0] - s.commanded[0]).abs() < 1e-12));
    // The same where several passes are cut on one part.
    let run = Run::even(milled.path.centre.clone(), 0.0, 400.0, 1500.0);
    let mut part = Part::new(&milled.path, &d20(), &machine, &Heights::of(0.0, 10.0)).expect("a part");
    assert_eq!(part.cut(&run), Ok(1));
    let mean = |s: f64| part.mean_errors()[milled.path.index_at(s)];
    assert!((mean(50.0) - error_at(&milled, 50.0)).abs() < 1e-4, "{} {}", mean(50.0), error_at(&milled, 50.0));
    assert!(mean(20.0).abs() < 1e-5);
}

#[test]
fn waves_reach_their_share_of_the_allowance_and_repeat_by_their_own_seed() {
    let uneven = UnevenStock { seed: 11, waves: 0.25, wavelength_mm: 30.0, ..UnevenStock::default() };
    let cut = |stock: UnevenStock, seed| {
        pass(&straight(150.0), Side::Right, &d20(), &Machine { stock, seed, ..Machine::rigid() })
    };
    let of = |milled: &Milled| -> Vec<f64> { (1..140).map(|s| stock(milled, f64::from(s))).collect() };
    let (one, next, other) =
        (of(&cut(uneven, 1)), of(&cut(uneven, 2)), of(&cut(UnevenStock { seed: 12, ..uneven }, 1)));
    assert_eq!(one, next, "what roughing leaves is alike on the next blank");
    assert!(one.iter().zip(&other).any(|(a, b)| (a - b).abs() > 0.3));
    let most = one.iter().map(|h| (h - 3.0).abs()).fold(0.0, f64::max);
    // The extension before the start holds the surface at its end only; the extreme lies somewhere on the contour.
    assert!(most < 0.76 && most > 0.5, "{most}");
}

#[test]
fn a_step_and_a_level_are_shares_of_the_allowance() {
    let stepped = UnevenStock { step: -0.25, step_from_mm: 40.0, level: 0.05, ..UnevenStock::default() };
    let milled = pass(&straight(80.0), Side::Right, &d20(), &Machine { stock: stepped, ..Machine::rigid() });
    assert!((stock(&milled, 15.0) - 3.0 * 1.05).abs() < 1e-3, "{}", stock(&milled, 15.0));
    assert!((stock(&milled, 60.0) - 3.0 * 0.8).abs() < 1e-3, "{}", stock(&milled, 60.0));
}

#[test]
fn there_is_more_stock_in_an_inside_corner_and_nowhere_else() {
    // The arc of radius 5 turns by π/2 within a cutter's radius of way: all of the share.
    let fat = UnevenStock { corner: 0.2, ..UnevenStock::default() };
    let cut = |stock| pass(&corner(), Side::Right, &d20(), &Machine { stock, ..Machine::rigid() });
    let (even, more) = (cut(UnevenStock::default()), cut(fat));
    for s in [20.0, 75.0] {
        assert!((arc_deg(&even, s) - arc_deg(&more, s)).abs() < 1e-6, "{s}");
    }
    assert!(arc_deg(&more, 48.0) > arc_deg(&even, 48.0) + 2.0);
    // An outside corner has none of it.
    let outside = [line([-60.0, 0.0], [0.0, 0.0]), line([0.0, 0.0], [0.0, -60.0])];
    let cut = |stock| pass(&outside, Side::Right, &d20(), &Machine { stock, ..Machine::rigid() });
    let (even, more) = (cut(UnevenStock::default()), cut(fat));
    assert!((0..120).all(|s| (arc_deg(&even, f64::from(s) + 0.5) - arc_deg(&more, f64::from(s) + 0.5)).abs() < 1e-6));
}

#[test]
fn drift_moves_the_wall_by_as_much_as_it_has_grown() {
    // The wall lies at −y; the datum moves towards +y, away from it: material is left.
    let machine = Machine { drift_mm: [0.004, 0.02], ..Machine::rigid() };
    let milled = pass(&straight(100.0), Side::Right, &d20(), &machine);
    for s in [20.0, 50.0, 90.0] {
        assert!((error_at(&milled, s) - 0.02 * s / 100.0).abs() < 1e-5, "{s}: {}", error_at(&milled, s));
    }
}

#[test]
fn a_cutter_that_is_too_large_cuts_that_much_deeper_with_every_tooth() {
    let large = Machine { radius_error_mm: 0.02, ..hard() };
    let runout = Machine { runout_mm: hard().runout_mm.iter().map(|r| r + 0.02).collect(), ..hard() };
    let (a, b) = (pass(&corner(), Side::Right, &d20(), &large), pass(&corner(), Side::Right, &d20(), &runout));
    for (a, b) in a.mean_errors().iter().zip(b.mean_errors()).filter(|(a, _)| a.is_finite()) {
        assert!((a - b).abs() < 1e-9, "{a} {b}");
    }
    let plain = pass(&straight(60.0), Side::Right, &d20(), &Machine { radius_error_mm: 0.02, ..Machine::rigid() });
    assert!((error_at(&plain, 30.0) + 0.02).abs() < 1e-6);
}

#[test]
fn drives_lag_by_velocity_times_time_constant_and_cut_a_circle_too_small() {
    // 600 mm/min and 10 ms: 0.1 mm behind on a straight, which leaves its wall where it is.
    let drives = Drives { time_constant_s: 0.010, ..Drives::default() };
    let machine = Machine { drives, ..Machine::rigid() };
    let cut = Cut { feed_mm_per_min: 600.0, ..d20() };
    let milled = pass(&straight(60.0), Side::Right, &cut, &machine);
    for (k, sample) in milled.samples.iter().enumerate() {
        assert!((milled.path.s_mm[k] - sample.commanded[0] - 0.1).abs() < 1e-9, "{k}");
        assert!(sample.commanded[1].abs() < 1e-12);
    }
    // On a circle of radius R at ω = v/R the amplitude of a first-order lag is R/√(1 + (ωτ)²); the command goes along chords of
    // 0.1 mm, which lie c²/12R inside the circle on the mean.
    let circle = [arc([5.0, 0.0], [5.0, 0.0], [0.0, 0.0], true)];
    let milled = pass(&circle, Side::Right, &cut, &machine);
    let last = milled.samples.len() - 2;
    let radius = milled.samples[last].commanded[0].hypot(milled.samples[last].commanded[1]);
    let expected = 5.0 / (1.0 + (10.0 / 5.0 * 0.010f64).powi(2)).sqrt() - 0.1 * 0.1 / (12.0 * 5.0);
    assert!((radius - expected).abs() < 2e-5, "{radius} {expected}");
}

#[test]
fn backlash_shows_where_an_axis_turns_back() {
    let drives = Drives { backlash_mm: [0.0, 0.006], ..Drives::default() };
    let there = [line([0.0, 0.0], [30.0, 30.0]), line([30.0, 30.0], [60.0, 0.0])];
    let milled = pass(&there, Side::Left, &d20(), &Machine { drives, ..Machine::rigid() });
    let off = |s: f64| {
        let k = milled.path.index_at(s);
        milled.samples[k].commanded[1] - milled.path.centre[k][1]
    };
    // Half the play behind on the way up, half of it the other way on the way down.
    assert!((off(20.0) + 0.003).abs() < 1e-9 && (off(60.0) - 0.003).abs() < 1e-9, "{} {}", off(20.0), off(60.0));
    assert!(milled.samples.iter().zip(&milled.path.centre).all(|(s, c)| (s.commanded[0] - c[0]).abs() < 1e-12));
}

#[test]
fn a_probe_with_three_lobes_reads_by_the_direction_of_its_approach() {
    let errors = ProbeErrors { lobing_mm: 0.003, lobing_deg: 30.0, ..ProbeErrors::default() };
    let circle = [arc([20.0, 0.0], [20.0, 0.0], [0.0, 0.0], true)];
    let milled = pass(&circle, Side::Right, &d20(), &Machine { probe: errors, ..Machine::rigid() });
    // The wall is the ring of radius 30; the approach of a place is its direction from the middle.
    let places: Vec<f64> = (0..12).map(|k| 20.0 * (f64::from(k) * 30.0 + 1.0).to_radians()).collect();
    let plan = ProbePlan { s_mm: places, levels: vec![0.5], ball_diameter_mm: 6.0, tip_z_mm: 0.0 };
    for touch in probe(&milled, &plan).expect("a wall") {
        let [x, y, _] = touch.ball_centre;
        let expected = 0.003 * (3.0 * (y.atan2(x) - 30f64.to_radians())).cos();
        assert!((x.hypot(y) - 27.0 - expected).abs() < 1e-4, "{} {expected}", x.hypot(y) - 27.0);
    }
}

#[test]
fn one_touch_in_so_many_is_wild_whoever_moves_the_ball() {
    let wild = |seed| {
        let errors = ProbeErrors { wild_mm: 0.2, wild_one_in: 6, ..ProbeErrors::default() };
        let milled = pass(&straight(80.0), Side::Right, &d20(), &Machine { probe: errors, seed, ..Machine::rigid() });
        let s_mm: Vec<f64> = (0..24).map(|k| 10.0 + 2.0 * f64::from(k)).collect();
        let plan = ProbePlan { s_mm: s_mm.clone(), levels: vec![0.5], ball_diameter_mm: 6.0, tip_z_mm: 0.0 };
        let touches = probe(&milled, &plan).expect("a wall");
        // The ball rests at y = −10 + 3; a chip holds it 0.2 mm before that.
        let early: Vec<bool> = touches.iter().map(|t| (t.ball_centre[1] + 6.8).abs() < 1e-4).collect();
        let others = touches.iter().zip(&early).filter(|(_, wild)| !**wild);
        assert!(others.into_iter().all(|(t, _)| (t.ball_centre[1] + 7.0).abs() < 1e-4));
        // A program touches twice, fast and slow: both readings are of one touch.
        let mut felt = Felt::new(&milled, 0.0);
        for (s, wild) in s_mm.iter().zip(&early) {
            let at = [*s, -7.0, 5.0];
            for _ in 0..2 {
                assert_eq!(felt.off_mm(at, [0.0, -1.0]), if *wild { -0.2 } else { 0.0 });
            }
        }
        early
    };
    let first = wild(3);
    assert!(first.chunks(6).all(|six| six.iter().filter(|wild| **wild).count() == 1), "{first:?}");
    assert_ne!(first, wild(4));
}
