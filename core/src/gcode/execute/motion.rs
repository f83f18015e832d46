//! The moves of one block: where each axis goes, and along what.

use super::super::block::BlockWords;
use super::super::code::Group;
use super::super::{Axes, Canon, Event, GcodeError, GcodeErrorKind, Motion, Span, WarningKind, Word};
use super::Execution;
use super::arc::{absolute_centre, centre_from_offsets, centre_from_radius};
use crate::geometry::{Curve, Point};
use crate::units::{Offset, Position};

/// The farthest coordinate and the longest length word, 100 m.
const FARTHEST_NM: u64 = 100_000_000_000;

/// The axis words.
const AXES: [u8; 3] = [b'X', b'Y', b'Z'];

impl<S> Execution<'_, '_, '_, S>
where
    S: FnMut(&Event<'_>) -> Result<(), GcodeErrorKind>,
{
    /// Executes G28, G30, G53, G0 … G3.
    pub(super) fn moves(&mut self, block: &mut BlockWords) -> Result<(), GcodeError> {
        let explicit = block.code(Group::Motion);
        if let Some((code, _)) = explicit {
            self.set_motion(code.tenths());
        }
        if let Some((code, span)) = block.code(Group::OneShot) {
            match code.tenths() {
                280 | 300 => self.reference(block, code.tenths() == 300, span)?,
                530 if block.has_unused(&AXES) => return self.machine_move(block, span),
                530 => self.warn(WarningKind::BareG53, span),
                _ => {}
            }
        }
        let named = block.has_unused(&AXES);
        let centred = block.has_unused(b"IJR");
        match self.modal.motion {
            Some(Motion::Arc { counter_clockwise }) if named || centred => self.arc(block, counter_clockwise),
            None if named => Err(self.error(GcodeErrorKind::NoMotion, self.first_axis(block))),
            Some(Motion::Traverse) if named => {
                let (from, to) = self.go(block)?;
                self.emit(Canon::Traverse { from, to }, self.block_span())
            }
            Some(Motion::Feed) if named => {
                let (from, to) = self.go(block)?;
                self.check_feed();
                self.emit(Canon::Feed { from, to }, self.block_span())
            }
            _ => Ok(()),
        }
    }

    fn first_axis(&self, block: &BlockWords) -> Span {
        AXES.iter().find_map(|&l| block.word(l)).map_or(self.block_span(), |w| w.span)
    }

    /// A length word in nanometres.
    pub(super) fn length(&mut self, word: Word) -> Result<Offset, GcodeError> {
        self.note_unit(word);
        match word.value.nanometres(self.modal.units) {
            Some(nm) if nm.unsigned_abs() <= FARTHEST_NM => Ok(Offset::from_nm(nm)),
            _ => Err(self.error(GcodeErrorKind::OutOfRange { letter: word.letter }, word.span)),
        }
    }

    /// Warns once when a length is read before the program names its unit.
    pub(super) fn note_unit(&mut self, word: Word) {
        if !self.units_given {
            self.units_given = true;
            self.warn(WarningKind::UnitsAssumed, word.span);
        }
    }

    fn check_feed(&mut self) {
        if self.modal.feed.is_none_or(|f| f == 0) {
            self.warn(WarningKind::FeedMissing, self.block_span());
        }
    }

    pub(super) fn forget(&mut self, axis: u8) {
        *self.axis(axis) = None;
    }

    pub(super) fn forget_all(&mut self) {
        self.at = Axes::UNKNOWN;
    }

    fn axis(&mut self, axis: u8) -> &mut Option<Position> {
        match axis {
            b'X' => &mut self.at.x,
            b'Y' => &mut self.at.y,
            _ => &mut self.at.z,
        }
    }

    /// Where an axis word leads; `None` when it is incremental from an unknown position.
    fn target(&mut self, word: Word) -> Result<Option<Position>, GcodeError> {
        let by = self.length(word)?;
        let from = if self.modal.absolute { Some(Position::ZERO) } else { *self.axis(word.letter) };
        let Some(from) = from else { return Ok(None) };
        let to = from + by;
        if to.nm().unsigned_abs() > FARTHEST_NM {
            return Err(self.error(GcodeErrorKind::OutOfRange { letter: word.letter }, word.span));
        }
        Ok(Some(to))
    }

    /// Uses the axis words and moves there: before and after.
    fn go(&mut self, block: &mut BlockWords) -> Result<(Axes, Axes), GcodeError> {
        let from = self.at;
        for letter in AXES {
            let Some(word) = block.use_word(letter) else {
                continue;
            };
            let Some(to) = self.target(word)? else {
                return Err(self.error(GcodeErrorKind::PositionUnknown { axis: letter }, word.span));
            };
            *self.axis(letter) = Some(to);
        }
        Ok((from, self.at))
    }

    /// G28, G30: by way of the place that the words give, then to a place that the program does not know. No axis
    /// word means every axis.
    fn reference(&mut self, block: &mut BlockWords, second: bool, span: Span) -> Result<(), GcodeError> {
        let mut axes = [false; 3];
        let mut via = self.at;
        for ((letter, moves), via) in AXES.iter().zip(&mut axes).zip([&mut via.x, &mut via.y, &mut via.z]) {
            let Some(word) = block.use_word(*letter) else {
                continue;
            };
            *moves = true;
            *via = self.target(word)?;
        }
        if axes == [false; 3] {
            axes = [true; 3];
        }
        for (letter, _) in AXES.iter().zip(axes).filter(|(_, moves)| *moves) {
            self.forget(*letter);
        }
        self.emit(Canon::Reference { second, axes, via }, span)
    }

    /// G53 with axis words: always absolute machine coordinates.
    fn machine_move(&mut self, block: &mut BlockWords, span: Span) -> Result<(), GcodeError> {
        let rapid = match self.modal.motion {
            Some(Motion::Traverse) => true,
            Some(Motion::Feed) => false,
            _ => return Err(self.error(GcodeErrorKind::MachineMoveNeedsLine, span)),
        };
        let mut to = Axes::UNKNOWN;
        for (letter, to) in AXES.into_iter().zip([&mut to.x, &mut to.y, &mut to.z]) {
            let Some(word) = block.use_word(letter) else {
                continue;
            };
            *to = Some(Position::ZERO + self.length(word)?);
            self.forget(letter);
        }
        if !rapid {
            self.check_feed();
        }
        self.emit(Canon::MachineMove { to, rapid }, span)
    }

    fn arc(&mut self, block: &mut BlockWords, counter_clockwise: bool) -> Result<(), GcodeError> {
        let span = self.block_span();
        let (from, to) = self.go(block)?;
        let start = self.known_point(from)?;
        let end = self.known_point(to)?;
        if let Some(word) = block.use_word(b'P')
            && word.value.exactly_times(1) != Some(1)
        {
            return Err(self.error(GcodeErrorKind::ArcTurns, word.span));
        }
        let centre = self.centre(block, start, end, counter_clockwise)?;
        let curve = Curve::arc(start, end, centre, counter_clockwise).map_err(|e| self.error(e.into(), span))?;
        self.check_feed();
        self.emit(Canon::Arc { from, to, curve, centre, counter_clockwise, turns: 0 }, span)
    }

    fn centre(&mut self, block: &mut BlockWords, start: Point, end: Point, ccw: bool) -> Result<Point, GcodeError> {
        let radius = block.use_word(b'R');
        let i = block.use_word(b'I').map(|w| self.length(w)).transpose()?;
        let j = block.use_word(b'J').map(|w| self.length(w)).transpose()?;
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
            _ if self.modal.absolute_centres => absolute_centre(i, j).map_err(|kind| self.error(kind, span)),
            _ => Ok(centre_from_offsets(start, i, j)),
        }
    }

    fn known_point(&self, at: Axes) -> Result<Point, GcodeError> {
        at.point().ok_or_else(|| {
            let axis = if at.x.is_none() { b'X' } else { b'Y' };
            self.error(GcodeErrorKind::PositionUnknown { axis }, self.block_span())
        })
    }
}
