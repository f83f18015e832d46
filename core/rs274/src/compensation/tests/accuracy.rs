//! The cutter's path against the same geometry in floating point.
//!
//! The oracle asks nothing but the definition: both ends of a piece are a radius away from the programmed line or
//! circle, on the side of the cutter.

use proptest::prelude::*;

use super::symmetry::chain;
use super::*;

/// How far a place lies on the left of a programmed piece, nm.
fn leftwards(piece: &Piece, place: Point) -> f64 {
    let vector = |to: Point, from: Point| ((to.x.nm() - from.x.nm()) as f64, (to.y.nm() - from.y.nm()) as f64);
    match piece.shape {
        Shape::Line => {
            let (dx, dy) = vector(piece.to, piece.from);
            let (px, py) = vector(place, piece.from);
            (dx * py - dy * px) / dx.hypot(dy)
        }
        Shape::Arc { centre, counter_clockwise, .. } => {
            let (sx, sy) = vector(piece.from, centre);
            let (px, py) = vector(place, centre);
            let inwards = sx.hypot(sy) - px.hypot(py);
            if counter_clockwise { inwards } else { -inwards }
        }
    }
}

/// The turn from one piece to the next, radians to the left.
fn turn(a: &Piece, b: &Piece) -> f64 {
    let heading = |p: &Piece, place: Point| match p.shape {
        Shape::Line => ((p.to.x.nm() - p.from.x.nm()) as f64, (p.to.y.nm() - p.from.y.nm()) as f64),
        Shape::Arc { centre, counter_clockwise, .. } => {
            let s = if counter_clockwise { 1.0 } else { -1.0 };
            (-s * (place.y.nm() - centre.y.nm()) as f64, s * (place.x.nm() - centre.x.nm()) as f64)
        }
    };
    let ((ax, ay), (bx, by)) = (heading(a, a.to), heading(b, b.from));
    (ax * by - ay * bx).atan2(ax * bx + ay * by)
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(20_000))]
    #[test]
    fn every_end_is_a_radius_beside_both_moves(
        steps in prop::collection::vec((-30_000_000i64..30_000_000, -30_000_000i64..30_000_000, -9i8..9, any::<bool>()), 2..4),
        radius in 1_000i64..6_000_000, left: bool,
    ) {
        let side = if left { Side::Left } else { Side::Right };
        let pieces = chain(&steps);
        prop_assume!(pieces.iter().all(|p| p.from != p.to && p.from.distance(p.to).nm() > 2 * radius));
        // The entry is a long straight line to the first move, so that it is no case of its own.
        let start = pieces[0].from;
        let away = Point::from_nm(start.x.nm() - 400 * MM, start.y.nm() - 7 * MM);
        let pieces: Vec<Piece> = core::iter::once(line(away, start)).chain(pieces).collect();
        let mut cutter_path = CutterPath::new(cutter(side, radius), StartUp::Own);
        let wanted = if left { radius as f64 } else { -radius as f64 };
        for (i, piece) in pieces.iter().enumerate() {
            let Ok(step) = cutter_path.push(*piece) else { return Ok(()) };
            let Some(done) = step.finished else { continue };
            let (before, sharp) = (&pieces[i - 1], turn(&pieces[i - 1], piece).abs());
            prop_assert!((leftwards(before, done.to) - wanted).abs() < 1.0, "beside the move before");
            if let Some(corner) = step.corner {
                prop_assert!((leftwards(piece, corner.to) - wanted).abs() < 1.0, "beside the next after an arc");
                prop_assert!((corner.to.distance(piece.from).nm() - radius).abs() <= 1);
            } else if sharp > 0.05 {
                prop_assert!((leftwards(piece, done.to) - wanted).abs() < 1.0, "beside both");
            }
        }
    }
}
