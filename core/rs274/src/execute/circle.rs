//! G2 and G3 in the three planes, with the third axis moving along (helix) and extra turns (P).

use super::super::block::BlockWords;
use super::super::{Axes, Canon, Event, GcodeError, GcodeErrorKind, Plane, Units};
use super::Execution;
use super::arc::{absolute_centre, centre_from_offsets, centre_from_radius};
use super::cycle::centre_letter;
use truepath_units::Offset;
use truepath_units::geometry::{Curve, Point};

/// How far the two radii of an arc may differ unless they agree to 0.1 %: LinuxCNC's value for programs in inches,
/// 0.00283 in; in millimetres it is that of [`Curve::arc`].
const INCH_TOLERANCE: Offset = Offset::from_nm(71_842);

/// Turns of one arc; more are an error.
const TURNS: u32 = 10_000;

impl<S> Execution<'_, '_, '_, S>
where
    S: FnMut(&Event<'_>) -> Result<(), GcodeErrorKind>,
{
    pub(super) fn arc(&mut self, block: &mut BlockWords<'_>, counter_clockwise: bool) -> Result<(), GcodeError> {
        let span = self.block_span();
        let plane = self.modal.plane;
        let from = self.at;
        let to = self.destination(block)?;
        let start = self.known_point(from)?;
        let end = self.known_point(to)?;
        let turns = match block.use_word(b'P') {
            Some(word) => self.between(word, 1, TURNS)?.saturating_sub(1),
            None => 0,
        };
        let centre = self.centre(block, start, end, counter_clockwise)?;
        let arc = match self.modal.units {
            Units::Millimetres => Curve::arc(start, end, centre, counter_clockwise),
            Units::Inches => Curve::arc_within(start, end, centre, counter_clockwise, INCH_TOLERANCE),
        };
        let curve = arc.map_err(|e| self.error(e.into(), span))?;
        self.check_feed()?;
        self.check_revolutions()?;
        self.at = to;
        let canon = if plane == Plane::Xy {
            Canon::Arc { from, to, curve, centre, counter_clockwise, turns }
        } else {
            Canon::PlaneArc { plane, from, to, curve, centre, counter_clockwise, turns }
        };
        self.emit(canon, span)
    }

    fn centre(&mut self, block: &mut BlockWords<'_>, start: Point, end: Point, ccw: bool) -> Result<Point, GcodeError> {
        let [first, second, _] = self.modal.plane.axes();
        let letters = [centre_letter(first), centre_letter(second)];
        let radius = block.use_word(b'R');
        let i = self.use_length(block, letters[0])?.map(Offset::from_nm);
        let j = self.use_length(block, letters[1])?.map(Offset::from_nm);
        if let Some(word) = radius {
            if i.is_some() || j.is_some() {
                return Err(self.error(GcodeErrorKind::ArcMixed, word.span));
            }
            let radius = self.length(word)?;
            return centre_from_radius(start, end, radius, ccw).map_err(|kind| self.error(kind, word.span));
        }
        let span = self.block_span();
        match (i, j) {
            (None, None) => Err(self.error(GcodeErrorKind::ArcWithoutCentre, span)),
            _ if self.modal.absolute_centres => absolute_centre(i, j, letters).map_err(|kind| self.error(kind, span)),
            _ => Ok(centre_from_offsets(start, i, j)),
        }
    }

    /// The place in the plane of arcs.
    fn known_point(&self, at: Axes) -> Result<Point, GcodeError> {
        let [first, second, _] = self.modal.plane.axes();
        match (at.get(first), at.get(second)) {
            (Some(x), Some(y)) => Ok(Point { x, y }),
            (x, _) => {
                let axis = self.letter(if x.is_none() { first } else { second });
                Err(self.error(GcodeErrorKind::PositionUnknown { axis }, self.block_span()))
            }
        }
    }
}
