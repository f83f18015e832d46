//! The reference numbers of the papers' corner, recomputed independently of this code.
use crate::corner;
use corner::*;
use truepath_model::cut::*;
use truepath_units::geometry::{Curve, Vector};
use truepath_units::{Offset, Real};

fn engaged_deg(path: &Path, s_mm: f64) -> f64 {
    // The sample nearest to s, then exactly beside it: interpolate between its neighbours.
    let s = Offset::from_nm(mm(s_mm));
    let i = path.samples().partition_point(|x| x.s <= s) - 1;
    let at = |i: usize| {
        let frame = path.frame(i, Vector::ZERO).unwrap();
        float(path.engagement(i, Vector::ZERO, &frame)).to_degrees()
    };
    let (a, b) = (path.samples()[i].s.nm() as f64, path.samples()[i + 1].s.nm() as f64);
    let u = (s.nm() as f64 - a) / (b - a);
    at(i) * (1.0 - u) + at(i + 1) * u
}

#[test]
fn the_engagement_of_the_corner_follows_the_reference_points() {
    let blocks = corner();
    let path = path(&blocks, &setup(WallLaw::Mean), 100);
    let reference = [
        (-20.0, 45.573),
        (-8.0, 45.57),
        (-5.0, 47.43),
        (-4.0, 50.00),
        (-3.0, 54.12),
        (-2.0, 60.19),
        (-1.0, 68.52),
        (0.0, 79.047),
        (1.5, 79.047),
        (3.06, 79.05),
        (4.0, 76.88),
        (5.0, 71.51),
        (6.0, 64.02),
        (7.0, 54.77),
        (7.854, 45.57),
        (30.0, 45.573),
    ];
    for (s, degrees) in reference {
        let got = engaged_deg(&path, 45.0 + s);
        assert!((got - degrees).abs() < 0.05, "s = {s}: {got} instead of {degrees}");
    }
}

#[test]
fn engagement_on_arcs_agrees_with_its_closed_forms() {
    let concave = [(12.0, 125.100), (15.0, 79.047), (20.0, 63.577), (30.0, 55.075), (50.0, 50.487), (100.0, 47.804)];
    for (wall_radius, degrees) in concave {
        let rho: f64 = wall_radius - 10.0;
        let curve = Curve::arc(point(0.0, -rho), point(0.0, rho), point(0.0, 0.0), true).unwrap();
        let path = path(&chain(&[curve], 400.0), &setup(WallLaw::Mean), 100);
        let got = engaged_deg(&path, rho * 0.9);
        assert!((got - degrees).abs() < 0.01, "Rp = {wall_radius}: {got} instead of {degrees}");
    }
    let convex = [(5.0, 29.541), (15.0, 36.678), (30.0, 40.204), (100.0, 43.682)];
    for (wall_radius, degrees) in convex {
        let rho: f64 = wall_radius + 10.0;
        let curve = Curve::arc(point(0.0, rho), point(0.0, -rho), point(0.0, 0.0), false).unwrap();
        let path = path(&chain(&[curve], 400.0), &setup(WallLaw::Mean), 100);
        let got = engaged_deg(&path, rho * 1.5);
        assert!((got - degrees).abs() < 0.01, "Rp = {wall_radius}: {got} instead of {degrees}");
    }
}

#[test]
fn the_mean_force_is_that_of_the_papers_record() {
    let s = setup(WallLaw::Mean);
    let table = ForceTable::new(Real::ZERO);
    let f = s.feed_per_tooth(real(400.0));
    let magnitude = |degrees: f64| {
        let (n, t) = table.mean((&s, &s.helix()), &coefficients(), real(degrees.to_radians())).total(f);
        float(n).hypot(float(t))
    };
    assert!((magnitude(45.573) - 150.0).abs() < 1.0, "{}", magnitude(45.573));
    assert!((magnitude(79.047) - 390.0).abs() < 2.0, "{}", magnitude(79.047));
    let area = |d: f64| float(chip_area(&s, f, real(d.to_radians())));
    assert!((area(45.573) - 0.1333).abs() < 1e-4 && (area(79.047) - 0.36).abs() < 1e-4);
}

#[test]
fn the_helix_decides_the_force_that_makes_a_height() {
    let s = setup(WallLaw::Helical);
    let table = ForceTable::new(Real::ZERO);
    let f = s.feed_per_tooth(real(400.0));
    let rows = [(45.573, [-90, -46, -39, -94, -140], -109), (79.047, [-379, -435, -456, -385, -317], -361)];
    for (degrees, forces, mean) in rows {
        let engaged = real(f64::to_radians(degrees));
        for (z, expected) in [0.1, 2.5, 5.0, 7.5, 9.9].into_iter().zip(forces) {
            let got = float(table.at_height((&s, &s.helix()), &coefficients(), engaged, real(z)).total(f).0);
            assert!((got - f64::from(expected)).abs() < 1.0, "{degrees} z {z}: {got} instead of {expected}");
        }
        let got = float(table.mean((&s, &s.helix()), &coefficients(), engaged).total(f).0);
        assert!((got - f64::from(mean)).abs() < 1.0, "mean {got}");
    }
}

#[test]
fn the_closed_loop_leaves_the_papers_error_on_the_corner() {
    let blocks = corner();
    let path = path(&blocks, &setup(WallLaw::Mean), 100);
    let table = ForceTable::new(Real::ZERO);
    let stiffness = real(1150.0);
    let machine = machine(&path, &table, Compliance::from_stiffness(stiffness, stiffness));
    let mut states = vec![State::REST; path.working().len()];
    let passage = machine.run(path.working().start, &mut states, |_| Vector::ZERO);
    println!("{passage:?} over {} samples", states.len());
    assert_eq!(passage.unsettled, 0);
    let errors = wall_errors(&machine, &states, 1);
    let straight = errors[path.index_at(Offset::from_um(20_000)) - path.first()];
    let arc = errors.iter().copied().fold(0.0, f64::max);
    let widest = states.iter().map(|s| float(s.engaged).to_degrees()).fold(0.0, f64::max);
    println!("straight {straight:.4} arc {arc:.4} widest {widest:.2}");
    assert!((straight - 0.0914).abs() < 0.001, "{straight}");
    assert!((arc - 0.297).abs() < 0.004, "{arc}");
    assert!((widest - 76.6).abs() < 0.2, "{widest}");
}

#[test]
fn a_cantilever_with_its_load_at_mid_depth_moves_its_tip_as_the_beam_formula_says() {
    // D 16, L 60, b 10: u = 1 − b/2L = 0.9167; P·L³/3EI times u²(3 − u)/2.
    let beam = Cantilever::new(Offset::from_um(16_000), 4, Offset::from_um(60_000), real(10.0), ToolMaterial::Carbide);
    let rigidity = 600.0 * std::f64::consts::PI * 12f64.powi(4) / 64.0;
    let tip_load = 60f64.powi(3) / (3.0 * rigidity);
    let u: f64 = 1.0 - 10.0 / 120.0;
    let expected = tip_load * u * u * (3.0 - u) / 2.0;
    let got = float(beam.at(Real::ZERO));
    assert!((got / expected - 1.0).abs() < 0.005, "{got} instead of {expected}");
    assert!(beam.at(real(10.0)) < beam.at(Real::ZERO));
}
