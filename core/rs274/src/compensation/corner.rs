//! What becomes of the corner between two moves.
//!
//! On the outside the cutter rolls round the corner; on the inside it stops where the two paths beside the moves
//! meet. Turns of up to 0.05 rad count as none. A turn within 0.05 rad of a reversal is an outside corner, except where
//! the move after it (or, when that is a line, the move before it) is an arc with its centre on the other side than
//! the cutter: there the two paths meet behind the corner. That is what LinuxCNC 2.9 was observed to do, and the path
//! must be the one that the machine runs.

use super::CompensationError;
use super::leg::{Circle, Cutter, Piece};
use super::unit::{Fine, ONE, Unit, fine, length, root};
use truepath_units::div_rounded;
use truepath_units::geometry::{Point, Side};

/// The sine of 0.05 rad in units of 2⁻⁶⁰.
const SMALL_TURN: i128 = 57_622_059_034_550_749;

/// The joint of two moves.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Corner {
    /// No turn worth an arc: the path beside the first move ends beside its end.
    Straight,
    /// The cutter rolls round the corner.
    Outside,
    /// The paths beside the two moves meet before the corner.
    Inside,
    /// A reversal whose paths meet behind the corner.
    Cusp,
}

impl Corner {
    /// Between two moves; `None` when one of them has no direction.
    pub(super) fn between(first: &Piece, second: &Piece, cutter: Cutter) -> Option<Self> {
        let (arriving, leaving) = (first.end_heading()?, second.start_heading()?);
        let turn = arriving.cross(leaving);
        if turn.saturating_abs() > SMALL_TURN {
            let inside = (turn > 0) == (cutter.side == Side::Left);
            return Some(if inside { Self::Inside } else { Self::Outside });
        }
        if arriving.dot(leaving) > 0 {
            return Some(Self::Straight);
        }
        let away = second.bends_away(cutter).or_else(|| first.bends_away(cutter));
        Some(if away == Some(true) { Self::Cusp } else { Self::Outside })
    }
}

/// Where the paths beside two moves meet that make an inside corner or a cusp.
///
/// `first` is the move before the corner; `circle` the one on which its cutter's centre runs, when it is an arc.
///
/// # Errors
/// They do not meet: the cutter does not fit into the corner.
pub(super) fn meeting(
    first: &Piece,
    circle: Option<Circle>,
    second: &Piece,
    cusp: bool,
    cutter: Cutter,
) -> Result<Point, CompensationError> {
    let corner = first.to;
    let unreachable = CompensationError::CornerUnreachable { radius: cutter.radius };
    let (Some(arriving), Some(leaving)) = (first.end_heading(), second.start_heading()) else {
        return Err(unreachable);
    };
    let back = arriving.reversed();
    match (circle, second.circle(corner, cutter)?) {
        (None, None) => Ok(lines(corner, arriving, leaving, cutter)),
        (None, Some(circle)) => {
            line_and_circle(corner, back, cutter.leftwards().saturating_neg(), circle, cusp).ok_or(unreachable)
        }
        (Some(circle), None) => line_and_circle(corner, leaving, cutter.leftwards(), circle, cusp).ok_or(unreachable),
        (Some(a), Some(b)) => circles(corner, a, b, cusp.then_some(back)).ok_or(unreachable),
    }
}

/// Two lines: the miter. It lies before the corner by r·tan(θ/2) = r·sin θ / (1 + cos θ), θ the turn.
fn lines(corner: Point, arriving: Unit, leaving: Unit, cutter: Cutter) -> Point {
    let sine = arriving.cross(leaving).saturating_abs();
    let cosine = arriving.dot(leaving);
    let back = div_rounded(fine(cutter.radius).saturating_mul(sine), ONE.saturating_add(cosine));
    arriving.step(corner, back.saturating_neg(), cutter.leftwards())
}

/// A line that leaves the corner, moved `aside` to its left, and a circle. The meeting stays on that side of the foot
/// of the centre on which the corner is; of a cusp it lies along the line.
fn line_and_circle(corner: Point, line: Unit, aside: Fine, circle: Circle, cusp: bool) -> Option<Point> {
    let foot = line.along(circle.centre);
    let height = line.left().along(circle.centre).saturating_sub(aside);
    let half = root(squares(circle.radius, height))?;
    let along = if foot > 0 && !cusp { foot.saturating_sub(half) } else { foot.saturating_add(half) };
    Some(line.step(corner, along, aside))
}

/// Two circles. The meeting stays on that side of the line of centres on which the corner is; of a cusp it lies
/// `back` along the way.
fn circles(corner: Point, first: Circle, second: Circle, back: Option<Unit>) -> Option<Point> {
    let between = second.centre - first.centre;
    let towards = Unit::of(between)?;
    let apart = length(between);
    let difference = squares(first.radius, second.radius);
    let along = div_rounded(difference.saturating_add(apart.saturating_mul(apart)), apart.saturating_mul(2));
    let across = root(squares(first.radius, along))?;
    let left = match back {
        Some(back) => towards.cross(back) > 0,
        None => towards.left().along(-first.centre) > 0,
    };
    let across = if left { across } else { across.saturating_neg() };
    Some(towards.step(corner + first.centre, along, across))
}

/// a² − b².
fn squares(a: Fine, b: Fine) -> Fine {
    a.saturating_mul(a).saturating_sub(b.saturating_mul(b))
}
