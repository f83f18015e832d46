//! A path that is shifted, turned by 90° or mirrored gives the shifted, turned or mirrored bits.

use proptest::prelude::*;

use super::*;
use truepath_units::geometry::Vector;

/// Maps a point and tells whether the sense of rotation changes.
type Map = (fn(Point) -> Point, bool);

const MAPS: [Map; 3] = [
    (|p| Point { x: truepath_units::Position::from_nm(-p.y.nm()), y: p.x }, false),
    (|p| Point { x: truepath_units::Position::from_nm(-p.x.nm()), y: p.y }, true),
    (|p| p + Vector::from_nm(123_456_789, -987_654_321), false),
];

fn mapped(piece: Piece, (map, mirrors): Map) -> Piece {
    let shape = match piece.shape {
        Shape::Line => Shape::Line,
        Shape::Arc { centre, counter_clockwise, turns } => {
            Shape::Arc { centre: map(centre), counter_clockwise: counter_clockwise != mirrors, turns }
        }
    };
    Piece { from: map(piece.from), to: map(piece.to), shape }
}

/// A chain of moves from steps and bulges: the centre of an arc lies exactly as far from both ends when the chord is
/// (2a, 2b) and the centre is at its middle plus whole multiples of (−b, a).
pub(super) fn chain(steps: &[(i64, i64, i8, bool)]) -> Vec<Piece> {
    let mut from = Point::from_nm(0, 0);
    let mut out = Vec::new();
    for &(a, b, bulge, ccw) in steps {
        let to = from + Vector::from_nm(2 * a, 2 * b);
        let piece = match bulge {
            -3..=3 => {
                let k = i64::from(bulge);
                arc(from, to, from + Vector::from_nm(a - k * b, b + k * a), ccw)
            }
            _ => line(from, to),
        };
        out.push(piece);
        from = to;
    }
    out
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(2_000))]
    #[test]
    fn the_cutters_path_turns_mirrors_and_shifts_with_the_program(
        steps in prop::collection::vec((-30_000_000i64..30_000_000, -30_000_000i64..30_000_000, -9i8..9, any::<bool>()), 1..6),
        radius in 1i64..8_000_000, left: bool,
    ) {
        let side = if left { Side::Left } else { Side::Right };
        let pieces = chain(&steps);
        prop_assume!(pieces.iter().all(|p| p.from != p.to));
        let plain = path(cutter(side, radius), &pieces);
        for map in MAPS {
            let pieces: Vec<Piece> = pieces.iter().map(|&p| mapped(p, map)).collect();
            let side = if map.1 { side.other() } else { side };
            let expected = plain.clone().map(|p| p.into_iter().map(|p| mapped(p, map)).collect::<Vec<_>>());
            prop_assert_eq!(path(cutter(side, radius), &pieces), expected);
        }
    }
}
