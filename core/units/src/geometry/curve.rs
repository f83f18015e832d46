//! One line or one arc.

use super::{Direction, Point, Vector};
use crate::{Offset, Real, sin_cos};

/// A line or an arc from `start` to `end`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Curve {
    start: Point,
    end: Point,
    length: Offset,
    start_heading: Direction,
    shape: Shape,
}

/// What lies between the ends of a [`Curve`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Shape {
    /// A straight line.
    Line,
    /// An arc about `centre`; `sweep` in radians, counter-clockwise positive, at most a full turn.
    /// The two end radii may differ slightly, as programs round; the radius then changes evenly along the arc.
    Arc {
        /// Centre.
        centre: Point,
        /// Angle swept, radians, counter-clockwise positive.
        sweep: Real,
    },
}

/// Why three points make no arc.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ArcError {
    /// Start or end coincides with the centre.
    NoRadius,
    /// The distances of start and end from the centre differ by more than the rule allows.
    RadiusMismatch {
        /// Distance of the start from the centre.
        start: Offset,
        /// Distance of the end from the centre.
        end: Offset,
    },
}

/// LinuxCNC's tolerance on an arc's end: an error above 100 times this, or above this and 0.1 % of the radius.
pub const ARC_TOLERANCE: Offset = Offset::from_nm(28_300);

impl Curve {
    /// A line of one nanometre along x from the origin, with which buffers are filled.
    pub(super) const SHORTEST: Self = Self {
        start: Point::from_nm(0, 0),
        end: Point::from_nm(1, 0),
        length: Offset::from_nm(1),
        start_heading: Direction::X,
        shape: Shape::Line,
    };

    /// A line; `None` when it has no length.
    pub fn line(start: Point, end: Point) -> Option<Self> {
        let vector = end.from(start);
        let start_heading = vector.direction()?;
        Some(Self { start, end, length: vector.length(), start_heading, shape: Shape::Line })
    }

    /// An arc about `centre`, counter-clockwise or clockwise. Equal start and end make a full circle.
    ///
    /// # Errors
    /// [`ArcError`] when a radius vanishes or the radii of start and end disagree beyond LinuxCNC's rule.
    pub fn arc(start: Point, end: Point, centre: Point, counter_clockwise: bool) -> Result<Self, ArcError> {
        Self::arc_within(start, end, centre, counter_clockwise, ARC_TOLERANCE)
    }

    /// An arc whose two radii may differ by a tolerance, or by 0.1 % up to 100 times the tolerance.
    ///
    /// # Errors
    /// As [`Self::arc`].
    #[inline(never)]
    pub fn arc_within(
        start: Point,
        end: Point,
        centre: Point,
        counter_clockwise: bool,
        tolerance: Offset,
    ) -> Result<Self, ArcError> {
        let (a, b) = (start.from(centre), end.from(centre));
        let (ra, rb) = (a.length(), b.length());
        let (Some(from), Some(to)) = (a.direction(), b.direction()) else {
            return Err(ArcError::NoRadius);
        };
        let difference = (ra - rb).abs().nm();
        let per_mille = ra.nm().min(rb.nm()) / 1000;
        let tolerance = tolerance.nm();
        if difference > tolerance.saturating_mul(100) || (difference > tolerance && difference > per_mille) {
            return Err(ArcError::RadiusMismatch { start: ra, end: rb });
        }
        let turn = from.angle_to(to);
        let same = start == end;
        // A half turn is its own mirror image: it has no sign of its own.
        let sweep = match (counter_clockwise, turn.bits().signum()) {
            _ if turn.abs() == Real::PI => {
                if counter_clockwise {
                    Real::PI
                } else {
                    -Real::PI
                }
            }
            (true, _) if same => Real::TAU,
            (false, _) if same => -Real::TAU,
            (true, 1) | (false, -1) => turn,
            (true, _) => turn + Real::TAU,
            (false, _) => turn - Real::TAU,
        };
        let mean_radius = Offset::from_nm(ra.nm().saturating_add(rb.nm()) / 2);
        let start_heading = if counter_clockwise { from.left() } else { from.right() };
        Ok(Self {
            start,
            end,
            length: mean_radius.scaled(sweep.abs()),
            start_heading,
            shape: Shape::Arc { centre, sweep },
        })
    }

    /// Where it begins.
    pub const fn start(&self) -> Point {
        self.start
    }
    /// Where it ends.
    pub const fn end(&self) -> Point {
        self.end
    }
    /// Its length, rounded to the nanometre.
    pub const fn length(&self) -> Offset {
        self.length
    }
    /// Line or arc.
    pub const fn shape(&self) -> Shape {
        self.shape
    }
    /// The direction of travel at its start.
    pub const fn start_heading(&self) -> Direction {
        self.start_heading
    }
    /// The direction of travel at its end.
    pub fn end_heading(&self) -> Direction {
        self.heading(Real::ONE)
    }
    /// The signed radius: positive when the curve turns left, negative when it turns right; `None` for a line.
    pub fn signed_radius(&self) -> Option<Offset> {
        match self.shape {
            Shape::Line => None,
            Shape::Arc { centre, sweep } => {
                let r = self.start.distance(centre);
                Some(if sweep < Real::ZERO { -r } else { r })
            }
        }
    }
    /// The place at a fraction 0…1 of the length; 0 gives the start and 1 the end exactly.
    pub fn point(&self, fraction: Real) -> Point {
        match self.shape {
            Shape::Line => self.start + self.end.from(self.start).scaled(fraction),
            Shape::Arc { centre, sweep } => {
                let spoke = self.start.from(centre);
                let turned = |f: Real| {
                    let (sine, cosine) = sin_cos(sweep * f);
                    spoke.turned(sine, cosine)
                };
                // What is missing at the end (rounded radii) is spread evenly.
                let gap: Vector = self.end.from(centre + turned(Real::ONE));
                centre + turned(fraction) + gap.scaled(fraction)
            }
        }
    }
    /// The direction of travel at a fraction 0…1 of the length.
    pub fn heading(&self, fraction: Real) -> Direction {
        match self.shape {
            Shape::Line => self.start_heading,
            Shape::Arc { sweep, .. } => self.start_heading.turned(sweep * fraction),
        }
    }
}
