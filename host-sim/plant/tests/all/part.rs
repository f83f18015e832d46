//! Several runs over one part: closed forms, what must not matter, and convergence.

use truepath_plant::{EngagedArcs, Equilibrium, Flutes, Heights, Part, Run, Surface, SurfaceScore, judged_trim_mm};

use super::*;

/// A straight wall on the right of travel.
fn straight() -> Path {
    Path::new(&[line([0.0, 0.0], [70.0, 0.0])], Side::Right, 0.1).expect("a path")
}

/// The nominal path as a run, `beside` mm away from the wall, with the tip at `tip` mm.
fn along(path: &Path, cut: &Cut, beside: f64, tip: f64) -> Run {
    let away = |(c, n): (&Point, &Point)| [c[0] - n[0] * beside, c[1] - n[1] * beside];
    let centre = path.centre.iter().zip(&path.normal).map(away).collect();
    Run::even(centre, tip, cut.feed_mm_per_min, cut.spindle_rpm)
}

fn reversed(mut run: Run) -> Run {
    run.centre.reverse();
    run
}

fn whole(path: &Path, cut: &Cut, machine: &Machine) -> Part {
    Part::new(path, cut, machine, &Heights::of(0.0, cut.axial_depth_mm)).expect("a part")
}

/// A part after some runs, each of them one lap.
fn cut_by(path: &Path, cut: &Cut, machine: &Machine, runs: &[Run]) -> Part {
    let mut part = whole(path, cut, machine);
    for run in runs {
        assert_eq!(part.cut(run), Ok(1));
    }
    let open = part.laps().iter().map(|lap| lap.residual_mm).fold(0.0, f64::max);
    assert!(open < 1e-4, "the elastic loop stayed open by {open} mm");
    part
}

fn score(part: &Part) -> SurfaceScore {
    part.surface().score(judged_trim_mm(part.set_up().radius_mm)).expect("a wall")
}

/// Mean over the height at a place, mm.
fn mean_at(part: &Part, s: f64) -> f64 {
    part.mean_errors()[part.path().index_at(s)]
}

/// Largest difference at the judged samples between a part and a single pass, at the middles of its slices.
fn apart(part: &Part, milled: &Milled) -> f64 {
    let surface = part.surface();
    let trim = judged_trim_mm(part.set_up().radius_mm);
    let depth = part.set_up().axial_depth_mm;
    let judged = |i: &usize| (trim..part.path().length_mm - trim).contains(&part.path().s_mm[*i]);
    let mut most = 0.0f64;
    for &(lower, upper) in &surface.slices_mm {
        let z = 0.5 * (lower + upper);
        let (a, b) = (part.errors_at(z), &milled.wall_errors(&[z / depth])[0]);
        most = (0..a.len()).filter(judged).map(|i| (a[i] - b[i]).abs()).fold(most, f64::max);
    }
    most
}

#[test]
fn one_pass_over_even_stock_is_the_single_pass() {
    let bound = Machine { bend: 0.0, ..hard() };
    for (machine, coarse_um, fine_um) in [(p23(), 1.0, 0.3), (bound, 5.0, 2.0)] {
        let differs = |step| {
            let path = Path::new(&corner(), Side::Right, step).expect("a path");
            let milled = mill(&path, &d20(), &machine, None).expect("milled");
            let mut part = whole(&path, &d20(), &machine).with(Equilibrium::Mean);
            assert_eq!(part.cut(&along(&path, &d20(), 0.0, 0.0)), Ok(1));
            let (one, all) = (milled.score(), score(&part));
            assert!((one.max_error_mm - all.mean_over_height_mm).abs() < 5e-4, "{one:?} {all:?}");
            1e3 * apart(&part, &milled)
        };
        // Where the wall is steep along the contour the two differ by half a step of the way; it goes away with the step.
        let (coarse, fine) = (differs(0.1), differs(0.05));
        assert!(coarse < coarse_um && fine < fine_um && fine < 0.6 * coarse, "{coarse} {fine} µm");
    }
}

#[test]
fn at_the_instant_the_cutter_yields_to_the_stock_of_the_instant() {
    // Straight wall: the stock is as much thinner at the instant as the cutter is farther off, e(z) = −Fn(z, h − e(z))/k; with the
    // engagement of the mean centre it is that of the mean displacement at all instants.
    let (path, cut) = (straight(), d20());
    let machine = Machine { law: WallLaw::Helical, ..p23() };
    let flutes = Flutes::new(&cut, &machine, true, cut.feed_mm_per_min);
    let arcs = |e: f64| EngagedArcs::up_to((1.0 - (3.0 - e) / 10.0f64).acos());
    let answered = |of: &dyn Fn(f64) -> f64| {
        let (mut lo, mut hi) = (0.0, 1.0);
        for _ in 0..60 {
            let e = 0.5 * (lo + hi);
            if of(e) > e { lo = e } else { hi = e }
        }
        lo
    };
    let mean = answered(&|e| -flutes.mean(&arcs(e), 1.0)[0] / 1150.0);
    let run = along(&path, &cut, 0.0, 0.0);
    let instant = cut_by(&path, &cut, &machine, std::slice::from_ref(&run));
    let mut of_mean = whole(&path, &cut, &machine).with(Equilibrium::Mean);
    assert_eq!(of_mean.cut(&run), Ok(1));
    let i = path.index_at(35.0);
    let mut most = 0.0f64;
    for k in 0..30 {
        let z = (f64::from(k) + 0.5) / 3.0;
        let force = |e: f64| -flutes.at_wall(0, z, &arcs(e), 1.0)[0] / 1150.0;
        let (expected, plain) = (answered(&force), force(mean));
        let (found, found_mean) = (instant.errors_at(z)[i], of_mean.errors_at(z)[i]);
        // Between two steps of the way a ridge of up to 0.05²/2r stays.
        assert!((found - expected).abs() < 2e-4, "z = {z}: {found} for {expected}");
        assert!((found_mean - plain).abs() < 2e-4, "z = {z}: {found_mean} for {plain}");
        most = most.max((found - found_mean).abs());
    }
    assert!(most > 0.001, "{most}");
}

#[test]
fn the_second_pass_meets_what_the_first_left_and_leaves_its_share_of_it() {
    // Straight wall, mean law: a pass over the stock h leaves e = F(h − e)/k. What the first left is the stock of the second.
    let (path, cut, machine) = (straight(), d20(), p23());
    let force = |stock: f64| {
        let (phi, f) = ((1.0 - stock / 10.0f64).acos(), 400.0 / 9000.0);
        let (s, c) = phi.sin_cos();
        let (iss, isc) = ((phi - s * c) / 2.0, s * s / 2.0);
        6.0 * 10.0 / std::f64::consts::TAU * f * 1147.7 * (iss + 0.3 * isc)
    };
    let mut stock = 3.0;
    let mut part = whole(&path, &cut, &machine);
    for turn in 0..4 {
        let (mut lo, mut hi) = (0.0, stock);
        for _ in 0..60 {
            let e = 0.5 * (lo + hi);
            if force(stock - e) / 1150.0 > e { lo = e } else { hi = e }
        }
        assert_eq!(part.cut(&along(&path, &cut, 0.0, 0.0)), Ok(1));
        let found = mean_at(&part, 35.0);
        assert!((found - lo).abs() < 0.02 * lo + 2e-5, "pass {turn}: {found} for {lo}");
        stock = lo;
    }
    assert!(stock < 0.004, "spring passes take the rest: {stock}");
}

#[test]
fn a_step_to_the_side_leaves_what_it_is_commanded_to_and_its_deflection() {
    let (path, cut) = (straight(), d20());
    let rigid = cut_by(&path, &cut, &Machine::rigid(), &[along(&path, &cut, 0.4, 0.0)]);
    assert!((mean_at(&rigid, 35.0) - 0.4).abs() < 1e-9);
    let mut part = cut_by(&path, &cut, &p23(), &[along(&path, &cut, 0.4, 0.0)]);
    let first = mean_at(&part, 35.0);
    // 2.6 mm of stock are cut instead of 3: less than the 0.0914 mm of the whole.
    assert!(first > 0.46 && first < 0.4 + 0.0914, "{first}");
    assert_eq!(part.cut(&along(&path, &cut, 0.0, 0.0)), Ok(1));
    let second = mean_at(&part, 35.0);
    assert!(second > 0.0 && second < 0.3 * first, "{second}");
    let beside = part.laps().iter().map(|lap| lap.beside_mm).collect::<Vec<_>>();
    assert!((beside[0] - 0.4).abs() < 1e-6 && beside[1].abs() < 1e-6, "{beside:?}");
}

#[test]
fn a_run_in_the_other_direction_is_conventional_where_the_first_climbs() {
    let (path, cut) = (straight(), d20());
    let run = along(&path, &cut, 0.0, 0.0);
    let climb = cut_by(&path, &cut, &p23(), std::slice::from_ref(&run));
    let conventional = cut_by(&path, &cut, &p23(), &[reversed(run)]);
    assert!(climb.laps()[0].climb && !conventional.laps()[0].climb && conventional.laps()[0].reversed);
    // The same as a wall on the other side.
    let other = Path::new(&[line([70.0, 0.0], [0.0, 0.0])], Side::Left, 0.1).expect("a path");
    let milled = mill(&other, &cut, &p23(), None).expect("milled");
    let (found, one) = (mean_at(&conventional, 35.0), milled.mean_errors()[other.index_at(35.0)]);
    assert!(found < -0.02 && (found - one).abs() < 2e-5, "{found} {one}");
    assert!(mean_at(&climb, 35.0) > 0.05);
}

#[test]
fn levels_of_a_rigid_machine_make_the_wall_of_one_pass() {
    for machine in [Machine::rigid(), Machine { runout_mm: hard().runout_mm, ..Machine::rigid() }] {
        let path = Path::new(&corner(), Side::Right, 0.1).expect("a path");
        let runs: Vec<Run> = [6.0, 3.0, 0.0].iter().map(|tip| along(&path, &d20(), 0.0, *tip)).collect();
        let one = cut_by(&path, &d20(), &machine, &runs[2..]);
        let three = cut_by(&path, &d20(), &machine, &runs);
        assert_eq!(one.surface().errors_mm, three.surface().errors_mm);
        // A level alone leaves what is below its tip.
        let upper = cut_by(&path, &d20(), &machine, &runs[..1]).surface();
        let at = upper.s_mm.partition_point(|s| *s < 30.0);
        for ((lower, _), errors) in upper.slices_mm.iter().zip(&upper.errors_mm) {
            assert_eq!(errors[at] > 2.9, *lower < 5.99, "{lower} {}", errors[at]);
        }
    }
}

#[test]
fn a_level_over_a_finished_one_cuts_only_its_own_height() {
    // Mean law, no bending: the lower half of the force makes the lower half of the wall, so levels halve the error.
    let (path, cut) = (straight(), d20());
    let one = cut_by(&path, &cut, &p23(), &[along(&path, &cut, 0.0, 0.0)]);
    let two = cut_by(&path, &cut, &p23(), &[along(&path, &cut, 0.0, 5.0), along(&path, &cut, 0.0, 0.0)]);
    let (whole, halves) = (mean_at(&one, 35.0), two.errors_at(2.0)[path.index_at(35.0)]);
    assert!((halves / whole - 0.52).abs() < 0.03, "{halves} {whole}");
    // The second level springs off the first by what it leaves itself, so the upper half is as before.
    let upper = two.errors_at(8.0)[path.index_at(35.0)];
    assert!((upper - halves).abs() < 1e-3, "{upper} {halves}");
}

#[test]
fn a_run_below_the_wall_is_pushed_away_by_the_stock_there() {
    // Two levels of 10 mm; judged is the upper one. Mean law, straight wall: the second leaves what the first left.
    let (path, cut) = (straight(), d20());
    let heights = Heights { stock_from_z_mm: -10.0, edges_z_mm: vec![0.0, -10.0], ..Heights::of(0.0, 10.0) };
    let mut part = Part::new(&path, &cut, &p23(), &heights).expect("a part");
    assert_eq!(part.cut(&along(&path, &cut, 0.0, 0.0)), Ok(1));
    let first = mean_at(&part, 35.0);
    assert_eq!(part.cut(&along(&path, &cut, 0.0, -10.0)), Ok(1));
    let second = mean_at(&part, 35.0);
    assert!((first - 0.0914).abs() < 0.0005 && (second - first).abs() < 1e-4, "{first} {second}");
    assert_eq!(part.height_mm(), [0.0, 10.0]);
    assert_eq!(part.surface().slices_mm.len(), 30);
    // Without that stock it springs.
    let mut air = whole(&path, &cut, &p23());
    for tip in [0.0, -10.0] {
        assert_eq!(air.cut(&along(&path, &cut, 0.0, tip)), Ok(1));
    }
    assert!(mean_at(&air, 35.0) < 0.5 * first);
}

#[test]
fn turning_everything_by_a_quarter_turns_the_wall_of_two_passes_with_it() {
    let turned = |p: Point| [-p[1] + 7.0, p[0] - 3.0];
    let quarter: Vec<Segment> = corner()
        .into_iter()
        .map(|s| match s {
            Segment::Line { from, to } => line(turned(from), turned(to)),
            Segment::Arc { from, to, centre, ccw } => arc(turned(from), turned(to), turned(centre), ccw),
        })
        .collect();
    let machine = Machine { runout_mm: vec![], ..hard() };
    let [[xx, xy], [yx, yy]] = machine.compliance_mm_per_n;
    let turned_machine = Machine { compliance_mm_per_n: [[yy, -yx], [-xy, xx]], ..machine.clone() };
    let [a, b] = [(corner(), &machine), (quarter, &turned_machine)].map(|(segments, machine)| {
        let path = Path::new(&segments, Side::Right, 0.1).expect("a path");
        let runs = [along(&path, &d20(), 0.2, 0.0), reversed(along(&path, &d20(), 0.0, 0.0))];
        cut_by(&path, &d20(), machine, &runs).surface()
    });
    let pairs = a.errors_mm.iter().flatten().zip(b.errors_mm.iter().flatten());
    let most = pairs.map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(most < 2e-5, "{most}");
}

#[test]
fn thinner_slices_and_shorter_steps_change_little() {
    let machine = Machine { runout_mm: vec![], stock_variation_mm: 0.0, ..hard() };
    let short = [
        line([34.0, 57.0], [34.0, 35.0]),
        arc([34.0, 35.0], [39.0, 30.0], [39.0, 35.0], true),
        line([39.0, 30.0], [61.0, 30.0]),
    ];
    let result = |step: f64, slices: usize| {
        let path = Path::new(&short, Side::Right, step).expect("a path");
        let heights = Heights { slices, ..Heights::of(0.0, 10.0) };
        let mut part = Part::new(&path, &d20(), &machine, &heights).expect("a part");
        for run in [along(&path, &d20(), 0.1, 0.0), reversed(along(&path, &d20(), 0.0, 0.0))] {
            assert_eq!(part.cut(&run), Ok(1));
        }
        score(&part)
    };
    let (usual, slices, step) = (result(0.1, 30), result(0.1, 60), result(0.05, 30));
    for finer in [&slices, &step] {
        assert!((usual.profile_mm - finer.profile_mm).abs() < 0.002, "{} {}", usual.profile_mm, finer.profile_mm);
        assert!((usual.mean_over_height_mm - finer.mean_over_height_mm).abs() < 0.001);
        assert!((usual.p95_mm - finer.p95_mm).abs() < 0.001);
    }
}

#[test]
fn a_closed_wall_is_cut_where_the_run_overlaps_itself() {
    let at = |a: f64| [20.0 * a.cos(), 20.0 * a.sin()];
    let pi = std::f64::consts::PI;
    let half = |from: f64, to: f64| arc(at(from), at(to), [0.0, 0.0], true);
    let path = Path::new(&[half(0.0, pi), half(pi, 2.0 * pi)], Side::Right, 0.1).expect("a path");
    let mut part = whole(&path, &d20(), &p23());
    let once = along(&path, &d20(), 0.0, 0.0);
    // Once round and half round again: the first half is sprung over.
    let mut run = once.clone();
    run.centre.extend(once.centre.iter().skip(1).take(path.len() / 2).copied());
    run = Run::even(run.centre, 0.0, 400.0, 1500.0);
    assert_eq!(part.cut(&run), Ok(1));
    let (sprung, once) = (mean_at(&part, 31.0), mean_at(&part, 94.0));
    assert!(sprung < 0.4 * once && once > 0.1, "{sprung} {once}");
}

#[test]
fn the_cutter_bends_towards_the_tip_and_by_reciprocity_more_under_a_low_force() {
    let (path, cut) = (straight(), d20());
    let at = |bend_law| {
        let machine = Machine { bend: 0.3, bend_law, ..p23() };
        let part = cut_by(&path, &cut, &machine, &[along(&path, &cut, 0.0, 0.0), along(&path, &cut, 0.0, 5.0)]);
        [0.2, 9.8].map(|z| part.errors_at(z)[path.index_at(35.0)])
    };
    let ([tip, top], [tip_m, _]) = (at(BendLaw::Alike), at(BendLaw::Maxwell));
    assert!((tip / top - 1.0) > 0.2, "{tip} {top}");
    // An even force bends alike under both laws.
    assert!((tip - tip_m).abs() < 2e-3, "{tip} {tip_m}");
    let refused = mill(&path, &cut, &Machine { bend_law: BendLaw::Maxwell, ..p23() }, None).map(|_| ());
    assert_eq!(refused, Err(PlantError::BendLaw));
}

#[test]
fn stock_deeper_than_the_cutters_radius_and_lists_of_unlike_length_are_refused() {
    let deep = Cut { allowance_mm: 12.0, ..d20() };
    let refused = Part::new(&straight(), &deep, &p23(), &Heights::of(0.0, 10.0)).map(|_| ());
    assert!(matches!(refused, Err(PlantError::OutOfRange { key: "allowance_mm", .. })), "{refused:?}");
    let mut run = along(&straight(), &d20(), 0.0, 0.0);
    run.tip_z_mm.pop();
    assert!(whole(&straight(), &d20(), &p23()).cut(&run).is_err());
}

#[test]
fn the_wall_of_a_single_pass_is_judged_in_the_same_numbers() {
    let milled = pass(&corner(), Side::Right, &d20(), &hard());
    let (one, all) = (milled.score(), Surface::of(&milled, -15.0, 10).score(judged_trim_mm(10.0)).expect("a wall"));
    assert!((one.max_error_mm - all.mean_over_height_mm).abs() < 1e-12);
    assert!((one.worst_height_mm - all.profile_mm).abs() < 1e-12);
    assert_eq!(all.heights.len(), 10);
    assert!((all.heights[0].z_mm + 14.5).abs() < 1e-12);
}
