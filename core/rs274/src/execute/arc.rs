//! Where the centre of an arc lies.
//!
//! Centre format: the centre is the start plus (I, J), or (I, J) itself under G90.1. Radius format: the arc of radius
//! |R| through start and end; R > 0 takes the one of at most half a turn, R < 0 the other (RS274/NGC §3.5.3.1). P18
//! eqs (3)–(5) give (44, 30) for the corner whose centre is (39, 35) and are not used.
//!
//! The radius format is computed in whole numbers, relative to the start: shifted, turned by 90° or mirrored
//! programs give shifted, turned or mirrored centres to the last bit. The centre is within 1 nm of the exact one.

use super::super::GcodeErrorKind;
use truepath_units::geometry::{ArcError, Point, Vector};
use truepath_units::{Offset, Position, div_rounded, isqrt_rounded};

/// How much half the chord may exceed the radius, as programs round; the centre is then the middle of the chord.
/// LinuxCNC's value (0.00005 in).
const RADIUS_TOLERANCE_NM: u64 = 1_270;

/// The largest radius, 100 m: with it every product below fits 127 bits.
const LARGEST_NM: u64 = 100_000_000_000;

/// Extra bits kept until the two halves of a centre are added.
const EXTRA_BITS: u32 = 8;

/// The centre of the arc of radius |`radius`| from `start` to `end`.
///
/// # Errors
/// The end is the start, the radius cannot reach the end, or a length is beyond 200 m.
pub(super) fn centre_from_radius(
    start: Point,
    end: Point,
    radius: Offset,
    counter_clockwise: bool,
) -> Result<Point, GcodeErrorKind> {
    let chord = end.from(start);
    let chord_squared = chord.length_squared();
    let r = radius.nm().unsigned_abs();
    if chord_squared == 0 {
        return Err(GcodeErrorKind::ArcRadiusFullCircle);
    }
    if r > LARGEST_NM {
        return Err(GcodeErrorKind::OutOfRange { letter: b'R' });
    }
    let reach = 4u128.saturating_mul(square(r));
    let tolerated = 4u128.saturating_mul(square(r.saturating_add(RADIUS_TOLERANCE_NM)));
    if chord_squared > tolerated {
        return Err(GcodeErrorKind::ArcRadiusTooSmall { chord: chord.length(), radius: radius.abs() });
    }
    // Left of the chord for a short counter-clockwise arc.
    let left = counter_clockwise != (radius < Offset::ZERO);
    let across = if left { Vector { x: -chord.y, y: chord.x } } else { Vector { x: chord.y, y: -chord.x } };
    let offset = Half { height: Root::of(reach.saturating_sub(chord_squared)), chord: Root::of(chord_squared) };
    let x = start.x + offset.along(chord.x, across.x);
    let y = start.y + offset.along(chord.y, across.y);
    Ok(Point { x, y })
}

/// A square root with about 62 significant bits, `value / 2^shift`.
#[derive(Clone, Copy)]
struct Root {
    value: i128,
    shift: u32,
}

impl Root {
    /// Of a number below 2¹²⁴.
    fn of(square: u128) -> Self {
        let shift = square.leading_zeros().saturating_sub(4) / 2;
        let value = isqrt_rounded(square.unbounded_shl(shift.saturating_mul(2)));
        Self { value: value as i128, shift }
    }
}

/// Half the chord plus the height of the centre over it.
#[derive(Clone, Copy)]
struct Half {
    height: Root,
    chord: Root,
}

impl Half {
    /// One coordinate of `chord/2 + across·(height/2)/|chord|`; the quotient is formed with [`EXTRA_BITS`] more bits.
    fn along(self, chord: Offset, across: Offset) -> Offset {
        // across·height·2^(EXTRA − 1) / |chord|, the two powers of two moved to where they do no harm.
        let top = i128::from(across.nm()).saturating_mul(self.height.value);
        let up = self.chord.shift.saturating_add(EXTRA_BITS).saturating_sub(1);
        let down = self.height.shift;
        let (top, bottom) = if up >= down {
            (top.saturating_mul(1i128.unbounded_shl(up.saturating_sub(down))), self.chord.value)
        } else {
            (top, self.chord.value.saturating_mul(1i128.unbounded_shl(down.saturating_sub(up))))
        };
        let raised = div_rounded(top, bottom);
        let half = i128::from(chord.nm()).saturating_mul(1i128.unbounded_shl(EXTRA_BITS.saturating_sub(1)));
        let sum = div_rounded(half.saturating_add(raised), 1i128.unbounded_shl(EXTRA_BITS));
        Offset::from_nm(i64::try_from(sum).unwrap_or(i64::MAX))
    }
}

const fn square(v: u64) -> u128 {
    (v as u128).saturating_mul(v as u128)
}

/// The centre from I and J, a missing one being 0 from the start.
pub(super) fn centre_from_offsets(start: Point, i: Option<Offset>, j: Option<Offset>) -> Point {
    Point { x: start.x + i.unwrap_or_default(), y: start.y + j.unwrap_or_default() }
}

/// The centre from I and J under G90.1.
///
/// # Errors
/// One of the two is missing.
pub(super) fn absolute_centre(i: Option<Offset>, j: Option<Offset>, letters: [u8; 2]) -> Result<Point, GcodeErrorKind> {
    let (Some(i), Some(j)) = (i, j) else {
        return Err(GcodeErrorKind::ArcCentreIncomplete { missing: if i.is_none() { letters[0] } else { letters[1] } });
    };
    Ok(Point { x: Position::ZERO + i, y: Position::ZERO + j })
}

impl From<ArcError> for GcodeErrorKind {
    fn from(error: ArcError) -> Self {
        match error {
            ArcError::NoRadius => Self::ArcNoRadius,
            ArcError::RadiusMismatch { start, end } => Self::ArcEndOffRadius { start, end },
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::arithmetic_side_effects, clippy::float_arithmetic)]
    use super::*;
    use proptest::prelude::*;

    const MM: i64 = 1_000_000;

    fn centre(end: (i64, i64), r: i64, ccw: bool) -> Result<Point, GcodeErrorKind> {
        centre_from_radius(Point::from_nm(0, 0), Point::from_nm(end.0, end.1), Offset::from_nm(r), ccw)
    }

    #[test]
    fn a_quarter_turn_has_its_centre_beside_the_start() {
        let end = (5 * MM, -5 * MM);
        assert_eq!(centre(end, 5 * MM, true), Ok(Point::from_nm(5 * MM, 0)));
        assert_eq!(centre(end, 5 * MM, false), Ok(Point::from_nm(0, -5 * MM)));
    }

    #[test]
    fn a_negative_radius_takes_the_long_way_round() {
        let end = (5 * MM, -5 * MM);
        assert_eq!(centre(end, -5 * MM, true), centre(end, 5 * MM, false));
    }

    #[test]
    fn a_radius_short_by_rounding_makes_a_half_circle_and_a_shorter_one_an_error() {
        assert_eq!(centre((10 * MM, 0), 5 * MM - 1_270, true), Ok(Point::from_nm(5 * MM, 0)));
        let error = GcodeErrorKind::ArcRadiusTooSmall {
            chord: Offset::from_nm(10 * MM),
            radius: Offset::from_nm(5 * MM - 1_271),
        };
        assert_eq!(centre((10 * MM, 0), 5 * MM - 1_271, true), Err(error));
    }

    proptest! {
        #[test]
        fn the_centre_is_as_far_from_both_ends_as_the_radius_to_a_nanometre(
            x in -200_000_000_000i64..200_000_000_000, y in -200_000_000_000i64..200_000_000_000,
            scale in 0u32..36, more in 0i64..100_000_000_000, ccw: bool,
        ) {
            let (x, y) = (x >> scale, y >> scale);
            let chord = Vector::from_nm(x, y).length().nm();
            let r = (chord / 2 + 1 + (more >> scale)).min(100_000_000_000);
            prop_assume!(x != 0 || y != 0);
            prop_assume!(chord <= 2 * r);
            let c = centre((x, y), r, ccw).unwrap();
            let (start, end) = (Point::from_nm(0, 0), Point::from_nm(x, y));
            prop_assert!((c.distance(start).nm() - r).abs() <= 1);
            prop_assert!((c.distance(end).nm() - r).abs() <= 2);
            // On the asked side: left of the chord for a short counter-clockwise arc.
            let side = end.from(start).cross(c.from(start));
            let to_the_left = if ccw { side } else { -side };
            prop_assert!(to_the_left >= -i128::from(chord));
        }

        #[test]
        fn the_centre_turns_and_mirrors_with_the_arc(
            x in -10_000_000_000i64..10_000_000_000, y in -10_000_000_000i64..10_000_000_000,
            more in 0i64..1_000_000_000, long: bool, ccw: bool, sx: i32, sy: i32,
        ) {
            prop_assume!(x != 0 || y != 0);
            let r = Vector::from_nm(x, y).length().nm() / 2 + 1 + more;
            let r = if long { -r } else { r };
            let c = centre((x, y), r, ccw).unwrap();
            let (cx, cy) = (c.x.nm(), c.y.nm());
            prop_assert_eq!(centre((-y, x), r, ccw), Ok(Point::from_nm(-cy, cx)));
            prop_assert_eq!(centre((-x, y), r, !ccw), Ok(Point::from_nm(-cx, cy)));
            let shift = Vector::from_nm(sx.into(), sy.into());
            let start = Point::from_nm(0, 0) + shift;
            let end = Point::from_nm(x, y) + shift;
            prop_assert_eq!(centre_from_radius(start, end, Offset::from_nm(r), ccw), Ok(c + shift));
        }
    }
}
