//! Where the end of a contour comes back to its start.

use truepath_model::cut::{CutSetup, Path, PathError, Sample, WallLaw};
use truepath_units::Offset;
use truepath_units::geometry::{Block, Contour, Curve, Side, Vector};

use crate::corner::{chain, float, path, point, setup};

/// A cutter of 10 mm, 0.5 mm of stock, the wall on the right.
fn small() -> CutSetup {
    let mut cut = setup(WallLaw::Mean);
    (cut.radius, cut.allowance) = (Offset::from_um(5_000), Offset::from_um(500));
    cut
}

fn lines(points: &[[f64; 2]]) -> Vec<Block> {
    let line = |w: &[[f64; 2]]| Curve::line(point(w[0][0], w[0][1]), point(w[1][0], w[1][1])).unwrap();
    chain(&points.windows(2).map(line).collect::<Vec<_>>(), 400.0)
}

/// Engagement of the undisplaced cutter at an arc length, degrees.
fn engaged(path: &Path, s_mm: f64) -> f64 {
    let index = path.index_at(Offset::from_um((s_mm * 1e3) as i64));
    let frame = path.frame(index, Vector::ZERO).unwrap();
    float(path.engagement(index, Vector::ZERO, &frame)).to_degrees()
}

fn sample<'a>(path: &Path<'a>, s_mm: f64) -> &'a Sample {
    &path.samples()[path.index_at(Offset::from_um((s_mm * 1e3) as i64))]
}

/// On a straight wall: cos φ₁ = 1 − h/r.
const STRAIGHT: f64 = 25.842;

#[test]
fn in_a_pocket_begun_in_its_corner_the_load_falls_before_the_end_to_nothing() {
    let blocks = lines(&[[5.0, 5.0], [75.0, 5.0], [75.0, 45.0], [5.0, 45.0], [5.0, 5.0]]);
    let path = path(&blocks, &small(), 50);
    assert!((engaged(&path, 0.0) - STRAIGHT).abs() < 0.01 && (engaged(&path, 200.0) - STRAIGHT).abs() < 0.01);
    // Two circles of one radius, d apart, cross at sin φ = d/2r.
    for d in [0.5f64, 1.0, 2.0, 3.0, 4.0] {
        let expected = (d / 10.0).asin().to_degrees();
        assert!((engaged(&path, 220.0 - d) - expected).abs() < 0.3, "{d} mm before the end");
    }
    assert!(engaged(&path, 220.0) < 0.3);
    assert!(path.samples().iter().all(|s| s.on_wall));
}

/// Ways round a block of 90 × 60 mm that begin below its corner (0, 0) and end on its left, with the length up to the corner.
fn outlines() -> Vec<(Vec<Block>, f64)> {
    let round = [[-5.0, -9.0], [-5.0, 65.0], [95.0, 65.0], [95.0, -5.0]];
    let to = |end: [f64; 2]| lines(&[&round[..], &[end]].concat());
    let mut rolled = to([0.0, -5.0]);
    let arc = Curve::arc(point(0.0, -5.0), point(-5.0, 0.0), point(0.0, 0.0), false).unwrap();
    let s = rolled.last().map(|b| b.s + b.curve.length()).unwrap();
    rolled.push(Block { curve: arc, s, feed: rolled[0].feed, line: 5 });
    vec![(to([-5.0, -5.0]), 339.0), (to([-12.0, -5.0]), 339.0), (rolled, 339.0)]
}

#[test]
fn an_outline_that_runs_out_beyond_its_corner_has_stock_and_wall_up_to_it() {
    for (case, (blocks, corner)) in outlines().iter().enumerate() {
        let path = path(blocks, &small(), 50);
        // The raw stock of the first leg begins 0.5 mm below the corner: the wall begins under full load.
        assert!((engaged(&path, 9.0) - STRAIGHT).abs() < 0.01, "{case}");
        assert!((engaged(&path, 200.0) - STRAIGHT).abs() < 0.01, "{case}");
        // That of the last one ends at the wall of the first: sin φ = d/r. Its end is known to a sample (0.6°), and taken
        // where the stock is thickest (a tenth more).
        for d in [0.5f64, 1.0, 2.0] {
            let (found, expected) = (engaged(&path, corner - d), (d / 5.0).asin().to_degrees());
            let more = found - expected;
            assert!(
                (-0.1..0.7 + 0.12 * expected).contains(&more),
                "{case}: {found}° for {expected}°, {d} mm before the end"
            );
        }
        assert!(engaged(&path, corner + 0.2) < 0.01, "{case}");
        for (s, wall) in [
            (8.5, false),
            (9.9, false),
            (10.2, true),
            (corner - 1.2, true),
            (corner - 0.9, false),
            (corner + 4.0, false),
        ] {
            assert_eq!(sample(&path, s).on_wall, wall, "{case}: at {s} mm");
        }
        assert!(sample(&path, 8.8).rounds_corner && sample(&path, corner + 0.2).rounds_corner, "{case}");
        assert!(!sample(&path, 9.2).rounds_corner && !sample(&path, corner - 0.2).rounds_corner, "{case}");
    }
}

#[test]
fn an_outline_on_the_other_side_of_travel_is_the_mirrored_one() {
    let mirrored = lines(&[[-9.0, -5.0], [65.0, -5.0], [65.0, 95.0], [-5.0, 95.0], [-5.0, -12.0]]);
    let cut = CutSetup { wall: Side::Left, ..small() };
    let (left, right) = (path(&mirrored, &cut, 50), path(&outlines()[1].0, &small(), 50));
    assert_eq!(left.samples().len(), right.samples().len());
    for (a, b) in left.samples().iter().zip(right.samples()) {
        assert_eq!((a.s, a.on_wall, a.on_surface, a.rounds_corner), (b.s, b.on_wall, b.on_surface, b.rounds_corner));
    }
}

#[test]
fn where_a_lap_runs_over_its_start_no_stock_is_left_and_the_load_falls_before() {
    // 3 mm of overlap behind 210 mm.
    let blocks = lines(&[[30.0, 5.0], [75.0, 5.0], [75.0, 40.0], [5.0, 40.0], [5.0, 5.0], [33.0, 5.0]]);
    let path = path(&blocks, &small(), 50);
    assert!((engaged(&path, 204.0) - STRAIGHT).abs() < 0.01);
    assert!((engaged(&path, 208.0) - (2.0f64 / 10.0).asin().to_degrees()).abs() < 0.3);
    assert!(engaged(&path, 210.2) < 0.5 && engaged(&path, 212.5) < 0.1);
}

#[test]
fn a_path_of_sharp_corners_far_smaller_than_the_cutter_is_refused_with_its_line() {
    let zigzag = |pitch: f64, count: u32| {
        let at = |k: u32| [f64::from(k) * pitch, if k.is_multiple_of(2) { 0.0 } else { pitch }];
        lines(&(0..=count).map(at).collect::<Vec<_>>())
    };
    let sampled = |blocks: &[Block]| {
        let contour = Contour::new(blocks).unwrap();
        let (cut, step) = (small(), Offset::from_um(100));
        let mut buffer = vec![Sample::BLANK; Path::samples_needed(&contour, &cut, step)];
        Path::sample(&contour, &cut, step, &mut buffer, |_| ()).map(|path| path.count())
    };
    // The 33rd corner lies less than 10 mm behind the first.
    assert_eq!(sampled(&zigzag(0.05, 400)), Err(PathError::Jagged { line: 34 }));
    assert!(sampled(&zigzag(0.05, 33)).is_ok());
    // Corners farther apart are only an ugly wall.
    assert!(sampled(&zigzag(0.5, 200)).is_ok());
}
