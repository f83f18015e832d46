//! Axis words → places: absolute, incremental, polar; lengths and angles.

use super::super::block::BlockWords;
use super::super::shifts::sin_cos_degrees;
use super::super::{
    AXIS_LETTERS, Axes, Decimal, GcodeError, GcodeErrorKind, Number, Plane, PointlessLength, SettingError, Units,
    WarningKind, Word,
};
use super::Execution;
use truepath_units::geometry::Point;
use truepath_units::{Offset, Position, Real, atan2, hypot_nm};

/// The farthest coordinate and the longest length word, 100 m; for angles 100,000 degrees.
pub(super) const FARTHEST_NM: u64 = 100_000_000_000;

/// Letters of moves: axes, and the polar words of LinuxCNC.
pub(super) const PLACE_LETTERS: [u8; 11] = *b"XYZABCUVW@^";

/// Whether an axis (by number, X 0 … W 8) turns.
pub(super) const fn turns(axis: usize) -> bool {
    matches!(axis, 3..=5)
}

impl Execution<'_, '_, '_> {
    /// The letter of an axis by its number.
    pub(super) fn letter(&self, axis: usize) -> u8 {
        AXIS_LETTERS.get(axis).copied().unwrap_or(b'Z')
    }
}

impl Execution<'_, '_, '_> {
    /// A length word in nanometres.
    pub(super) fn length(&mut self, word: Word) -> Result<Offset, GcodeError> {
        self.note_unit(&word);
        self.scaled(word, self.modal.units)
    }

    /// The word of an axis: nanometres, or millionths of a degree.
    pub(super) fn axis_value(&mut self, word: Word, axis: usize) -> Result<Offset, GcodeError> {
        // A number times a million is what a millimetre is in nanometres.
        if turns(axis) { self.scaled(word, Units::Millimetres) } else { self.length(word) }
    }

    fn scaled(&mut self, word: Word, units: Units) -> Result<Offset, GcodeError> {
        self.within_reach(&word, units).ok_or_else(|| self.out_of_range(&word))
    }

    /// The same; `None` beyond the farthest coordinate.
    #[inline]
    fn within_reach(&mut self, word: &Word, units: Units) -> Option<Offset> {
        let nm = if self.reads_points { self.by_point(word, units) } else { word.value.nanometres(units) };
        nm.filter(|nm| nm.unsigned_abs() <= FARTHEST_NM).map(Offset::from_nm)
    }

    fn out_of_range(&self, word: &Word) -> GcodeError {
        self.error(GcodeErrorKind::OutOfRange { letter: word.letter }, word.span)
    }

    /// The nanometres of a number where it matters whether it has a point.
    #[inline(never)]
    fn by_point(&mut self, word: &Word, units: Units) -> Option<i64> {
        match word.value {
            Number::Exact(number) if !word.has_point(self.text) => self.pointless(word, number, units),
            value => value.nanometres(units),
        }
    }

    /// The nanometres of a number without a point.
    fn pointless(&mut self, word: &Word, number: Decimal, units: Units) -> Option<i64> {
        match self.options.decimal {
            PointlessLength::Least => i64::try_from(number.times(units.least_increment())).ok(),
            PointlessLength::Calculator => {
                if number.mantissa() != 0 {
                    self.warn(WarningKind::LengthWithoutPoint, word.span);
                }
                i64::try_from(number.times(units.nanometres())).ok()
            }
        }
    }

    /// Uses a length word, in nanometres.
    pub(super) fn use_length(&mut self, block: &mut BlockWords<'_>, letter: u8) -> Result<Option<i64>, GcodeError> {
        block.use_word(letter).map(|word| self.length(word).map(Offset::nm)).transpose()
    }

    /// Uses the word of an axis: nanometres, or millionths of a degree.
    pub(super) fn use_axis(&mut self, block: &mut BlockWords<'_>, axis: usize) -> Result<Option<i64>, GcodeError> {
        block.use_word(self.letter(axis)).map(|word| self.axis_value(word, axis).map(Offset::nm)).transpose()
    }

    /// Uses the words of two axes as they stand.
    pub(super) fn axis_steps(
        &mut self,
        block: &mut BlockWords<'_>,
        axes: [usize; 2],
    ) -> Result<[Option<i64>; 2], GcodeError> {
        let mut steps = [None; 2];
        for (step, axis) in steps.iter_mut().zip(axes) {
            *step = self.use_axis(block, axis)?;
        }
        Ok(steps)
    }

    /// Warns once when a length is read before the program names its unit.
    #[inline]
    pub(super) fn note_unit(&mut self, word: &Word) {
        if !self.units_given {
            self.units_given = true;
            self.warn(WarningKind::UnitsAssumed, word.span);
        }
    }

    pub(super) fn forget(&mut self, axis: usize) {
        self.at.set(axis, None);
    }

    /// Where an axis word leads; `None` when it is incremental from an unknown position.
    #[inline]
    pub(super) fn target(&mut self, word: &Word, axis: usize) -> Result<Option<Position>, GcodeError> {
        self.note_unit(word);
        let Some(by) = self.within_reach(word, self.modal.units) else { return Err(self.out_of_range(word)) };
        let from = if self.modal.absolute { Some(Position::ZERO) } else { self.at.get(axis) };
        let Some(from) = from else { return Ok(None) };
        let to = from + by;
        if to.nm().unsigned_abs() > FARTHEST_NM { Err(self.out_of_range(word)) } else { Ok(Some(to)) }
    }

    /// Uses the axis words: where they lead. Axes that turn, U, V and W are moved at once.
    pub(super) fn destination(&mut self, block: &mut BlockWords<'_>) -> Result<Axes, GcodeError> {
        let mut to = self.at;
        if let Some(polar) = self.polar_words(block)? {
            let place = self.polar_place(polar, self.at)?;
            (to.x, to.y) = (Some(place.x), Some(place.y));
        }
        for axis in 0..3 {
            if let Some(word) = block.use_word(self.letter(axis)) {
                self.lead(&mut to, axis, &word)?;
            }
        }
        self.move_auxiliary(block)?;
        Ok(to)
    }

    /// Puts an axis where its word leads.
    pub(super) fn lead(&mut self, to: &mut Axes, axis: usize, word: &Word) -> Result<(), GcodeError> {
        let Some(place) = self.target(word, axis)? else {
            return Err(self.error(GcodeErrorKind::PositionUnknown { axis: word.letter }, word.span));
        };
        to.set(axis, Some(place));
        Ok(())
    }

    fn move_auxiliary(&mut self, block: &mut BlockWords<'_>) -> Result<(), GcodeError> {
        if !block.has_unused(b"ABCUVW") {
            return Ok(());
        }
        for axis in 3..9usize {
            let Some(value) = self.use_axis(block, axis)? else {
                continue;
            };
            if let Some(at) = self.modal.auxiliary.get_mut(axis.saturating_sub(3)) {
                *at = if self.modal.absolute { value } else { at.saturating_add(value) };
            }
        }
        Ok(())
    }

    /// `@` (distance from the origin) and `^` (angle) in X and Y, used; only in G17.
    pub(super) fn polar_words(&mut self, block: &mut BlockWords<'_>) -> Result<Option<Polar>, GcodeError> {
        if self.modal.plane != Plane::Xy || !block.has_unused(b"@^") {
            return Ok(None);
        }
        let (radius, angle) = (block.use_word(b'@'), block.use_word(b'^'));
        for letter in [b'X', b'Y'] {
            if let Some(word) = block.word(letter) {
                return Err(self.error(SettingError::PolarMixed { letter }.into(), word.span));
            }
        }
        let radius = radius.map(|word| self.length(word)).transpose()?;
        let angle = angle.map(|word| self.scaled(word, Units::Millimetres)).transpose()?;
        Ok(Some(Polar { radius, angle: angle.map(Offset::nm) }))
    }

    /// Where polar words lead from a place: what is not given stays, in G91 what is given is added.
    pub(super) fn polar_place(&self, polar: Polar, at: Axes) -> Result<Point, GcodeError> {
        let absolute = self.modal.absolute;
        let (far, direction) = match (polar, at.point()) {
            (Polar { radius: Some(radius), angle: Some(angle) }, _) if absolute => (radius, angle),
            (Polar { radius, angle }, Some(at)) => {
                let (x, y) = (at.x - Position::ZERO, at.y - Position::ZERO);
                let radians = atan2(y.nm(), x.nm());
                let far = hypot_nm(x, y);
                let direction = Offset::from_nm(180_000_000).scaled(radians.over(Real::PI)).nm();
                let base = |value: i64| if absolute { 0 } else { value };
                (
                    radius.map_or(far, |r| Offset::from_nm(base(far.nm())) + r),
                    angle.map_or(direction, |a| base(direction).saturating_add(a)),
                )
            }
            (_, None) => {
                let axis = if at.x.is_none() { b'X' } else { b'Y' };
                return Err(self.error(GcodeErrorKind::PositionUnknown { axis }, self.block_span()));
            }
        };
        let (sine, cosine) = sin_cos_degrees(direction);
        Ok(Point { x: Position::ZERO + far.scaled(cosine), y: Position::ZERO + far.scaled(sine) })
    }
}

/// Polar words of a block.
#[derive(Clone, Copy, Debug)]
pub(super) struct Polar {
    /// `@`.
    radius: Option<Offset>,
    /// `^`, millionths of a degree.
    angle: Option<i64>,
}
