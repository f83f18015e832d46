//! The path of the cutter's centre, one move behind the program.
//!
//! A move's end depends on the corner after it, so each move waits for the next one. The first move leads from where
//! the cutter stands to beside its own end; it must be longer than the cutter's radius. A first move along an arc
//! becomes the arc through the cutter's place that leaves in the same direction. That is LinuxCNC's way ([`StartUp::Own`]).
//! On controls with start-up type A ([`StartUp::Next`]) the first move is a line of any length, and leads to beside the
//! start of the move after it.
//!
//! Neighbouring moves are compared, no others: a slot narrower than the cutter whose walls are not neighbours is not
//! noticed, as on the machine.

use super::corner::{Corner, meeting};
use super::leg::{Circle, Cutter, Piece, Shape};
use super::remains::remaining;
use super::unit::{Unit, fine, length};
use super::{CompensationError, FINE_BITS};
use crate::Dialect;
use truepath_units::geometry::{Point, Side};
use truepath_units::{Offset, div_rounded, shift_rounded};

/// A move whose end is not known yet.
#[derive(Clone, Copy, Debug)]
struct Pending {
    /// As programmed.
    programmed: Piece,
    /// Where the cutter's centre begins it.
    from: Point,
    /// Its own centre, when it is the arc of an entry.
    entry_centre: Option<Point>,
    /// The first move after G41 or G42.
    entry: bool,
}

/// What one more move makes known.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Step {
    /// The move before it, with both ends.
    pub finished: Option<Piece>,
    /// The way round the corner between the two, an arc of the cutter's radius.
    pub corner: Option<Piece>,
}

/// Where the first move under G41 or G42 leads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum StartUp {
    /// To beside its own end.
    #[default]
    Own,
    /// To beside the start of the next move.
    Next,
}

impl StartUp {
    /// That of a dialect: the next move's on Fanuc and Haas set to start-up type A, as they are delivered, and with Siemens'
    /// NORM, whatever the first move's own length and direction; a TNC leads to beside the start of the contour too.
    pub const fn of(dialect: Dialect) -> Self {
        match dialect {
            Dialect::Fanuc | Dialect::Haas | Dialect::Siemens | Dialect::Heidenhain => Self::Next,
            Dialect::Linuxcnc | Dialect::Mach => Self::Own,
        }
    }
}

/// The cutter's path between G41 or G42 and G40.
#[derive(Clone, Copy, Debug)]
pub struct CutterPath {
    cutter: Cutter,
    start_up: StartUp,
    pending: Option<Pending>,
}

impl CutterPath {
    /// With no move yet.
    pub const fn new(cutter: Cutter, start_up: StartUp) -> Self {
        Self { cutter, start_up, pending: None }
    }

    /// The cutter.
    pub const fn cutter(&self) -> Cutter {
        self.cutter
    }

    /// Whether no move has been given yet.
    pub const fn is_before_entry(&self) -> bool {
        self.pending.is_none()
    }

    /// The next move as programmed: a line that has length, or an arc. The first begins where the cutter's centre
    /// stands, every other where the one before ended.
    ///
    /// # Errors
    /// The cutter cannot follow; see [`CompensationError`]. The path is of no more use then.
    pub fn push(&mut self, next: Piece) -> Result<Step, CompensationError> {
        if self.pending.is_none() && self.start_up == StartUp::Next && next.shape != Shape::Line {
            return Err(CompensationError::EntryArc);
        }
        for place in [next.from, next.to] {
            next.circle(place, self.cutter)?;
        }
        let Some(pending) = self.pending else {
            self.pending = Some(self.enter(next)?);
            return Ok(Step::default());
        };
        let too_short = CompensationError::MoveUnreachable { length: Offset::ZERO, radius: self.cutter.radius };
        let mut corner = None;
        let joint = if pending.entry && self.start_up == StartUp::Next {
            None
        } else {
            Some(Corner::between(&pending.programmed, &next, self.cutter).ok_or(too_short)?)
        };
        let end = match joint {
            None => next.beside_start(self.cutter).ok_or(too_short)?,
            Some(joint) => self.end(&pending, &next, joint).ok_or(too_short)??,
        };
        let finished = self.finished(&pending, end)?;
        let mut from = end;
        if joint == Some(Corner::Outside) {
            from = next.beside_start(self.cutter).ok_or(too_short)?;
            let counter_clockwise = self.cutter.side == Side::Right;
            let shape = Shape::Arc { centre: next.from, counter_clockwise, turns: 0 };
            corner = Some(Piece { from: end, to: from, shape }).filter(|p| p.from != p.to);
        }
        self.pending = Some(Pending { programmed: next, from, entry_centre: None, entry: false });
        Ok(Step { finished: Some(finished), corner })
    }

    /// Where the cutter's centre ends a move before a corner; `None` when the move has no direction.
    fn end(&self, pending: &Pending, next: &Piece, joint: Corner) -> Option<Result<Point, CompensationError>> {
        Some(match joint {
            Corner::Straight | Corner::Outside => Ok(pending.programmed.beside_end(self.cutter)?),
            Corner::Inside | Corner::Cusp => self
                .circle(pending)
                .and_then(|circle| meeting(&pending.programmed, circle, next, joint == Corner::Cusp, self.cutter)),
        })
    }

    /// The last move, when there was any: the path ends beside its end.
    ///
    /// # Errors
    /// Nothing is left of it.
    pub fn finish(&mut self) -> Result<Option<Piece>, CompensationError> {
        let Some(pending) = self.pending.take() else {
            return Ok(None);
        };
        let end = pending.programmed.beside_end(self.cutter).unwrap_or(pending.from);
        self.finished(&pending, end).map(Some)
    }

    fn enter(&self, first: Piece) -> Result<Pending, CompensationError> {
        let radius = self.cutter.radius;
        let too_short = |length| CompensationError::EntryTooShort { length, radius };
        let pending = Pending { programmed: first, from: first.from, entry_centre: None, entry: true };
        let Shape::Arc { centre, .. } = first.shape else {
            let length = first.from.distance(first.to);
            return if length <= radius && self.start_up == StartUp::Own {
                Err(too_short(length))
            } else {
                Ok(pending)
            };
        };
        let too_small = |arc| CompensationError::EntryArcTooSmall { arc, radius };
        let (Some(end), Some(inwards)) = (first.beside_end(self.cutter), Unit::of(centre.from(first.to))) else {
            return Err(too_small(Offset::ZERO));
        };
        // |way + t·inwards| = t: the centre is as far from the cutter's place as from the end.
        let way = end.from(first.from);
        let against = inwards.along(way).saturating_neg();
        if against <= 0 {
            return Err(too_small(Offset::ZERO));
        }
        let square = length(way).saturating_mul(length(way));
        let t = div_rounded(square, against.saturating_mul(2));
        if t <= fine(radius) {
            let arc = Offset::from_nm(i64::try_from(shift_rounded(t, FINE_BITS)).unwrap_or(i64::MAX));
            return Err(too_small(arc));
        }
        Ok(Pending { entry_centre: Some(inwards.step(end, t, 0)), ..pending })
    }

    /// The circle on which a waiting move ends, seen from its programmed end.
    fn circle(&self, pending: &Pending) -> Result<Option<Circle>, CompensationError> {
        let corner = pending.programmed.to;
        match (pending.entry_centre, pending.programmed.beside_end(self.cutter)) {
            (Some(centre), Some(end)) => {
                Ok(Some(Circle { centre: centre.from(corner), radius: length(end.from(centre)) }))
            }
            _ => pending.programmed.circle(corner, self.cutter),
        }
    }

    fn finished(&self, pending: &Pending, to: Point) -> Result<Piece, CompensationError> {
        let from = pending.from;
        let shape = match (pending.programmed.shape, pending.entry_centre) {
            (Shape::Line, _) if pending.entry => Shape::Line,
            (Shape::Arc { counter_clockwise, turns, .. }, Some(centre)) => {
                if from == to {
                    Shape::Line
                } else {
                    Shape::Arc { centre, counter_clockwise, turns }
                }
            }
            _ => remaining(&pending.programmed, from, to, self.cutter)?,
        };
        Ok(Piece { from, to, shape })
    }
}
