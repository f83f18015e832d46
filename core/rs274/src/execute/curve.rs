//! G5, G5.1, G5.2 … G5.3: splines in X and Y, as lines within the tolerance or as a whole.

use super::super::block::BlockWords;
use super::super::{Axes, Canon, CycleError, GCode, GcodeError, GcodeErrorKind, Plane, Span};
use super::Execution;
use super::spline::{ControlPoint, ORDER, POINTS, Spline};
use truepath_units::geometry::{Point, Vector};
use truepath_units::{Offset, Real};

impl Execution<'_, '_, '_> {
    /// G5 (cubic) and G5.1 (quadratic).
    pub(super) fn bezier(&mut self, block: &mut BlockWords<'_>, code: GCode) -> Result<(), GcodeError> {
        let span = self.block_span();
        let start = self.spline_start(block, code, span)?;
        let first = self.spline_words(block, [b'I', b'J'])?;
        let last = if code.tenths() == 50 { self.spline_words(block, [b'P', b'Q'])? } else { None };
        let to = self.destination(block)?;
        let end = to.point().unwrap_or(start).from(start);
        let origin = ControlPoint::plain(Vector::default());
        if code.tenths() == 51 {
            let Some(middle) = first else { return Err(self.word_missing(code, b'I', span)) };
            self.splines.tangent = None;
            return self.draw(&[origin, ControlPoint::plain(middle), ControlPoint::plain(end)], 3, to, span);
        }
        let Some(last) = last else { return Err(self.word_missing(code, b'P', span)) };
        let Some(first) = first.or(self.splines.tangent) else { return Err(self.word_missing(code, b'I', span)) };
        self.splines.tangent = Some(Vector { x: -last.x, y: -last.y });
        let before_end = Vector { x: end.x + last.x, y: end.y + last.y };
        let points = [origin, ControlPoint::plain(first), ControlPoint::plain(before_end), ControlPoint::plain(end)];
        self.draw(&points, 4, to, span)
    }

    /// A block under G5.2: a control point with its weight P; the first block may give the order L.
    pub(super) fn control_point(&mut self, block: &mut BlockWords<'_>, code: GCode) -> Result<(), GcodeError> {
        let span = self.block_span();
        let here = self.spline_start(block, code, span)?;
        let begins = self.splines.points.is_empty();
        let named = block.has_unused(b"XY");
        let weight = block.use_word(b'P');
        let value = match weight {
            Some(word) if word.value.real() > 0 => Some(word.value.real()),
            Some(word) => return Err(self.error(GcodeErrorKind::Negative { letter: b'P' }, word.span)),
            None => None,
        };
        if begins {
            let order = block.use_word(b'L').map(|word| self.between(word, 2, ORDER as u32)).transpose()?.unwrap_or(3);
            self.splines.order = usize::try_from(order).unwrap_or(3);
            self.splines.start = self.at;
            let start = ControlPoint { at: Vector::default(), weight: value.unwrap_or(Real::ONE) };
            self.add_point(start, span)?;
        }
        if !named {
            return Ok(());
        }
        for letter in [b'X', b'Y'] {
            if block.word(letter).is_none() {
                return Err(self.word_missing(code, letter, span));
            }
        }
        let Some(weight) = value else { return Err(self.word_missing(code, b'P', span)) };
        let to = self.destination(block)?;
        let start = self.splines.start.point().unwrap_or(here);
        let at = to.point().unwrap_or(start).from(start);
        self.add_point(ControlPoint { at, weight }, span)?;
        self.at = to;
        Ok(())
    }

    fn add_point(&mut self, point: ControlPoint, span: Span) -> Result<(), GcodeError> {
        let full = CycleError::SplineTooLong { limit: POINTS as u8 };
        self.splines.points.push(point).map_err(|_| self.error(full.into(), span))
    }

    /// G5.3.
    pub(super) fn end_spline(&mut self, span: Span) -> Result<(), GcodeError> {
        let points = core::mem::take(&mut self.splines.points);
        if points.is_empty() {
            return Err(self.error(CycleError::SplineNotBegun.into(), span));
        }
        let order = self.splines.order;
        if points.len() < order {
            let kind = CycleError::SplinePoints { found: points.len() as u8, order: order as u8 };
            return Err(self.error(kind.into(), span));
        }
        let to = core::mem::replace(&mut self.at, self.splines.start);
        self.draw(&points, order, to, span)
    }

    /// Where a spline begins; it lies in X and Y.
    fn spline_start(&self, block: &BlockWords<'_>, code: GCode, span: Span) -> Result<Point, GcodeError> {
        if self.modal.plane != Plane::Xy || block.has_unused(b"ZABCUVW") {
            return Err(self.error(CycleError::SplinePlane(code).into(), span));
        }
        self.at.point().ok_or_else(|| {
            let axis = if self.at.x.is_none() { b'X' } else { b'Y' };
            self.error(GcodeErrorKind::PositionUnknown { axis }, span)
        })
    }

    /// Two words that stand together; a single one is completed by 0.
    fn spline_words(&mut self, block: &mut BlockWords<'_>, letters: [u8; 2]) -> Result<Option<Vector>, GcodeError> {
        let [first, second] = letters;
        let x = self.use_length(block, first)?.map(Offset::from_nm);
        let y = self.use_length(block, second)?.map(Offset::from_nm);
        Ok(match (x, y) {
            (None, None) => None,
            (x, y) => Some(Vector { x: x.unwrap_or_default(), y: y.unwrap_or_default() }),
        })
    }

    fn draw(&mut self, points: &[ControlPoint], order: usize, to: Axes, span: Span) -> Result<(), GcodeError> {
        self.check_feed()?;
        self.check_revolutions()?;
        let from = self.at;
        if self.options.whole_splines {
            self.at = to;
            let points = u32::try_from(points.len()).unwrap_or(u32::MAX);
            return self.emit(Canon::Spline { from, to, points }, span);
        }
        let Some(start) = from.point() else { return Ok(()) };
        let tolerance = self.options.spline_tolerance;
        Spline { points, order }.flatten(tolerance, |by| {
            let place = start + by;
            self.feed_to(Axes { x: Some(place.x), y: Some(place.y), ..from }, span)
        })
    }
}
