//! Corner words: `,R` rounds the corner between two lines with a tangent arc, `,C` cuts it off.
//!
//! `,R` is the arc's radius. `,C` is the distance from the corner to both ends of the chamfer (Fanuc's and Haas's
//! meaning; not the chamfer's length). Both stand in the block of the first line, and the second is known only when
//! its block comes, so the first line waits in a [`CornerStage`]; the arc or chamfer belongs to its block. Positions,
//! and so incremental coordinates, go on from the corner as programmed. Lines that run straight on have nothing to
//! cut off.
//!
//! Geometry: a line turned by the angle θ loses r · tan(θ/2) on each side. It is computed in whole numbers with 60
//! bits of direction and rounded once to the nanometre; a program that is shifted, turned by 90° or mirrored gives
//! shifted, turned or mirrored corners to the last bit.
//!
//! Limits: lines only, no arcs; [`BETWEEN`] steps (F, S, M, comments) between them.

use super::compensation::unit::{FINE_BITS, Fine, ONE, Unit, fine, length};
use super::compensation::{Piece, Shape, Waiting};
use super::{Axes, CornerError, Plane, Span};
use truepath_units::geometry::Point;
use truepath_units::{Offset, div_rounded, shift_rounded};

/// Steps that may wait between the two lines of a corner.
pub(super) const BETWEEN: usize = 4;

/// What may be missing of a line by the rounding of the corners at its two ends, 2 nm.
const ROUNDING: Fine = 2 << FINE_BITS;

/// How a corner is cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Corner {
    /// `,R`: by an arc of this radius.
    Radius(Offset),
    /// `,C`: from this distance before the corner to as far behind it.
    Chamfer(Offset),
}

/// A line, of which a corner may have taken the beginning.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Straight {
    /// Where it begins as programmed.
    pub(super) from: Point,
    /// Where it begins.
    pub(super) begin: Point,
    /// Where it ends as programmed.
    pub(super) to: Point,
}

/// Which of the two lines is too short, and by what.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Misfit {
    /// They are no corner.
    TurnsBack,
    /// Too little is left of a line.
    Short {
        /// Whether it is the second.
        second: bool,
        /// What is cut off.
        needed: Offset,
        /// What there is.
        left: Offset,
    },
}

impl Corner {
    /// What stands in place of the corner between two lines; `None` when nothing is cut off.
    ///
    /// # Errors
    /// The corner does not fit.
    pub(super) fn between(self, first: Straight, second: Straight) -> Result<Option<Piece>, Misfit> {
        let (before, after) = (first.to.from(first.from), second.to.from(second.from));
        let (Some(arriving), Some(leaving)) = (Unit::of(before), Unit::of(after)) else {
            return Ok(None);
        };
        if before.cross(after) == 0 {
            return if before.dot(after) < 0 { Err(Misfit::TurnsBack) } else { Ok(None) };
        }
        let (sine, cosine) = (arriving.cross(leaving), arriving.dot(leaving));
        let reach = match self {
            Self::Chamfer(distance) => fine(distance),
            // Half the angle's tangent, in the form that loses no digits.
            Self::Radius(radius) if cosine < 0 => {
                div_rounded(fine(radius).saturating_mul(ONE.saturating_sub(cosine)), sine.saturating_abs())
            }
            Self::Radius(radius) => {
                div_rounded(fine(radius).saturating_mul(sine.saturating_abs()), ONE.saturating_add(cosine))
            }
        };
        for (line, second) in [(first, false), (second, true)] {
            let left = length(line.to.from(line.begin));
            if reach > left.saturating_add(ROUNDING) {
                return Err(Misfit::Short { second, needed: nanometres(reach), left: nanometres(left) });
            }
        }
        // What the rounding would leave of a line is nothing.
        let near = |line: Straight| length(line.to.from(line.begin)).abs_diff(reach) <= ROUNDING.unsigned_abs();
        let corner = first.to;
        let from = if near(first) { first.begin } else { arriving.step(corner, reach.saturating_neg(), 0) };
        let to = if near(second) { second.to } else { leaving.step(corner, reach, 0) };
        let shape = match self {
            _ if from == to => return Ok(None),
            Self::Chamfer(_) => Shape::Line,
            Self::Radius(radius) => {
                let counter_clockwise = sine > 0;
                let aside = if counter_clockwise { fine(radius) } else { fine(-radius) };
                let centre = arriving.step(corner, reach.saturating_neg(), aside);
                Shape::Arc { centre, counter_clockwise, turns: 0 }
            }
        };
        Ok(Some(Piece { from, to, shape }))
    }
}

fn nanometres(length: Fine) -> Offset {
    Offset::from_nm(i64::try_from(shift_rounded(length, FINE_BITS)).unwrap_or(i64::MAX))
}

/// A line that waits for the next one.
#[derive(Debug)]
pub(super) struct Held<'p> {
    pub(super) corner: Corner,
    /// The word.
    pub(super) word: Span,
    pub(super) plane: Plane,
    pub(super) line: Straight,
    /// All its axes at its beginning and its end.
    pub(super) from: Axes,
    pub(super) to: Axes,
    /// The block and its modes.
    pub(super) step: Waiting<'p>,
}

/// A line whose end is not known yet, and what the program does behind it.
#[derive(Debug, Default)]
pub(super) struct CornerStage<'p> {
    held: Option<Held<'p>>,
    between: heapless::Deque<Waiting<'p>, BETWEEN>,
}

impl<'p> CornerStage<'p> {
    /// Whether a line waits.
    pub(super) const fn is_waiting(&self) -> bool {
        self.held.is_some()
    }
    /// The line that waits.
    pub(super) const fn held(&self) -> Option<&Held<'p>> {
        self.held.as_ref()
    }
    /// Keeps a line.
    pub(super) fn hold(&mut self, held: Held<'p>) {
        self.held = Some(held);
    }
    /// Keeps a step behind the line.
    ///
    /// # Errors
    /// Too much waits.
    pub(super) fn keep(&mut self, step: Waiting<'p>) -> Result<(), CornerError> {
        self.between.push_back(step).map_err(|_| CornerError::TooMuchBetween { limit: BETWEEN as u8 })
    }
    /// The line that waits, which waits no longer.
    pub(super) fn release(&mut self) -> Option<Held<'p>> {
        self.held.take()
    }
    /// The next step behind the line that waited.
    pub(super) fn next(&mut self) -> Option<Waiting<'p>> {
        self.between.pop_front()
    }
}
