//! G2 and G3 in the three planes, with the third axis moving along (helix) and extra turns (P).

use super::super::block::BlockWords;
use super::super::{
    ArcCentres, Axes, Canon, Decimal, GcodeError, GcodeErrorKind, Number, Plane, Units, WarningKind, Word,
};
use super::Execution;
use super::arc::{absolute_centre, centre_from_offsets, centre_from_radius};
use super::cycle::centre_letter;
use truepath_units::Offset;
use truepath_units::geometry::{ARC_TOLERANCE, ArcError, Curve, Point};

/// How far the two radii of an arc may differ unless they agree to 0.1 %: LinuxCNC's value for programs in inches,
/// 0.00283 in; in millimetres it is that of [`Curve::arc`].
const INCH_TOLERANCE: Offset = Offset::from_nm(71_842);

/// Turns of one arc; more are an error.
const TURNS: u32 = 10_000;

impl Execution<'_, '_, '_> {
    pub(super) fn arc(&mut self, block: &mut BlockWords<'_>, counter_clockwise: bool) -> Result<(), GcodeError> {
        let to = self.destination(block)?;
        let (start, end) = self.arc_ends(to)?;
        let turns = match block.use_word(b'P') {
            Some(word) => self.between(word, 1, TURNS)?.saturating_sub(1),
            None => 0,
        };
        let centre = self.centre(block, start, end, counter_clockwise)?;
        self.arc_about(centre, to, turns, counter_clockwise, block.words())
    }

    /// Where an arc to a place begins and ends in its plane.
    pub(super) fn arc_ends(&self, to: Axes) -> Result<(Point, Point), GcodeError> {
        Ok((self.known_point(self.at)?, self.known_point(to)?))
    }

    /// Moves along the arc about a centre, or about the other one that its words may mean.
    pub(super) fn arc_about(
        &mut self,
        centre: (Point, Option<Point>),
        to: Axes,
        turns: u32,
        counter_clockwise: bool,
        words: &[Word],
    ) -> Result<(), GcodeError> {
        let (start, end) = self.arc_ends(to)?;
        let (centre, curve) = self.curve(start, end, centre, counter_clockwise, words)?;
        self.check_feed()?;
        self.check_revolutions()?;
        let (span, plane) = (self.block_span(), self.modal.plane);
        let from = core::mem::replace(&mut self.at, to);
        let canon = if plane == Plane::Xy {
            Canon::Arc { from, to, curve, centre, counter_clockwise, turns }
        } else {
            Canon::PlaneArc { plane, from, to, curve, centre, counter_clockwise, turns }
        };
        self.emit(canon, span)
    }

    /// The centre, and where it would be if I and J are absolute places although no G90.1 says so.
    fn centre(
        &mut self,
        block: &mut BlockWords<'_>,
        start: Point,
        end: Point,
        ccw: bool,
    ) -> Result<(Point, Option<Point>), GcodeError> {
        let [first, second, third] = self.modal.plane.axes();
        let letters = [centre_letter(first), centre_letter(second)];
        let idle = centre_letter(third);
        if let Some(word) = block.word(idle)
            && word.value.exactly_times(1) == Some(0)
        {
            block.use_word(idle);
            self.warn(WarningKind::IdleWord { letter: idle }, word.span);
        }
        let radius = block.use_word(b'R');
        let i = self.use_length(block, letters[0])?.map(Offset::from_nm);
        let j = self.use_length(block, letters[1])?.map(Offset::from_nm);
        if let Some(word) = radius {
            if i.is_some() || j.is_some() {
                return Err(self.error(GcodeErrorKind::ArcMixed, word.span));
            }
            let radius = self.length(word)?;
            let centre = centre_from_radius(start, end, radius, ccw).map_err(|kind| self.error(kind, word.span))?;
            return Ok((centre, None));
        }
        let span = self.block_span();
        let absolute = absolute_centre(i, j, letters);
        match (i, j) {
            (None, None) => Err(self.error(GcodeErrorKind::ArcWithoutCentre, span)),
            _ if self.modal.absolute_centres => {
                absolute.map(|centre| (centre, None)).map_err(|kind| self.error(kind, span))
            }
            _ => Ok((centre_from_offsets(start, i, j), absolute.ok())),
        }
    }

    /// The arc, with the centre that makes it one. Where the program does not say how I and J count, the first arc that
    /// is one in a single way tells it for all that follow; none is read in two ways.
    fn curve(
        &mut self,
        start: Point,
        end: Point,
        (centre, absolute): (Point, Option<Point>),
        ccw: bool,
        words: &[Word],
    ) -> Result<(Point, Curve), GcodeError> {
        let tolerance = if self.modal.units == Units::Inches { INCH_TOLERANCE } else { ARC_TOLERANCE };
        let about = |centre| Curve::arc_within(start, end, centre, ccw, tolerance);
        let error = match about(centre) {
            Ok(curve) => {
                if absolute.is_some_and(|other| other != centre) {
                    self.centres = ArcCentres::Incremental;
                }
                return Ok((centre, curve));
            }
            Err(error) => error,
        };
        let span = self.block_span();
        // A full circle is one about any centre.
        let other = absolute
            .filter(|other| *other != centre && start != end)
            .and_then(|other| Some((other, about(other).ok()?)));
        match other {
            Some(other) if self.centres == ArcCentres::Detect => {
                self.warn(WarningKind::CentresFoundAbsolute, span);
                self.modal.absolute_centres = true;
                Ok(other)
            }
            other => {
                if let ArcError::RadiusMismatch { start: a, end: b } = error {
                    let digit = self.last_digit(words);
                    let limit = tolerance.nm().max(a.nm().min(b.nm()) / 1000).saturating_add(digit);
                    let wider = Curve::arc_within(start, end, centre, ccw, Offset::from_nm(limit));
                    if let Ok(curve) = wider
                        && (a - b).abs().nm() <= limit
                    {
                        self.warn(WarningKind::ArcBeyondLimit, span);
                        return Ok((centre, curve));
                    }
                }
                let kind = if other.is_some() { GcodeErrorKind::ArcCentreAbsolute } else { error.into() };
                Err(self.error(kind, span))
            }
        }
    }

    /// What the rounding of the numbers of an arc can change of its radii: √2 times the last digit of its most exact
    /// word at each end, no more than 0.01 mm or 0.001 in each; nothing without a decimal.
    fn last_digit(&self, words: &[Word]) -> i64 {
        let decimals = |word: &Word| match word.value {
            Number::Exact(number) if b"XYZIJK".contains(&word.letter) => number.decimals(),
            _ => 0,
        };
        let most = words.iter().map(decimals).max().unwrap_or(0);
        let (unit, coarsest) = match self.modal.units {
            Units::Millimetres => (1_000_000, 10_000),
            Units::Inches => (25_400_000, 25_400),
        };
        let digit: i64 = Decimal::new(1, most).map_or(0, |digit| i64::try_from(digit.times(unit)).unwrap_or(0));
        if most == 0 { 0 } else { digit.min(coarsest).saturating_mul(283) / 100 }
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
