//! `,R` and `,C`: a line waits for the next one, then both lose what the corner takes.

use super::super::block::BlockWords;
use super::super::compensation::{Piece, Waiting, in_plane, moved, put};
use super::super::corner::{Corner, Held, Misfit, Straight};
use super::super::{Axes, Canon, CornerError, FeedMode, GcodeError, GcodeErrorKind, Span, Word};
use super::Execution;
use super::compensate::error_of;
use truepath_units::Offset;

impl<'p> Execution<'p, '_, '_> {
    /// The corner word of a line.
    pub(super) fn corner_word(&mut self, block: &mut BlockWords<'_>) -> Result<Option<(Corner, Word)>, GcodeError> {
        let word = match (block.use_word(b'r'), block.use_word(b'c')) {
            (None, None) => return Ok(None),
            (Some(_), Some(word)) => return Err(self.error(CornerError::Twice.into(), word.span)),
            (Some(word), None) | (None, Some(word)) => word,
        };
        if let Some(other) = b"ABCUVW".iter().find_map(|&letter| block.word(letter)) {
            return Err(self.error(CornerError::OtherAxis.into(), other.span));
        }
        let length = self.length(word)?;
        if length < Offset::ZERO {
            let letter = word.letter.to_ascii_uppercase();
            return Err(self.error(GcodeErrorKind::Negative { letter }, word.span));
        }
        let corner = if word.letter == b'r' { Corner::Radius(length) } else { Corner::Chamfer(length) };
        Ok(Some((corner, word)).filter(|_| length > Offset::ZERO))
    }

    /// Moves there in a line whose corner with the next one is cut.
    pub(super) fn feed_to_corner(&mut self, to: Axes, corner: Corner, word: Word) -> Result<(), GcodeError> {
        let programmed = core::mem::replace(&mut self.at, to);
        let from = self.after_corner(programmed, to)?;
        let plane = self.modal.plane;
        let (Some(start), Some(begin), Some(end)) =
            (in_plane(programmed, plane), in_plane(from, plane), in_plane(to, plane))
        else {
            return Err(self.error(CornerError::WithoutLine.into(), word.span));
        };
        if start == end {
            return Err(self.error(CornerError::WithoutLine.into(), word.span));
        }
        let [.., third] = plane.axes();
        if from.get(third) != to.get(third) {
            return Err(self.error(CornerError::OtherAxis.into(), word.span));
        }
        if self.modal.feed_mode == FeedMode::InverseTime {
            return Err(self.error(CornerError::InverseTime.into(), word.span));
        }
        let step = self.waiting(Canon::Feed { from, to });
        let line = Straight { from: start, begin, to: end };
        self.corner.hold(Held { corner, word: word.span, plane, line, from, to, step });
        Ok(())
    }

    /// A step of the program while a line waits.
    pub(super) fn behind_corner(&mut self, canon: Canon, span: Span) -> Result<(), GcodeError> {
        match canon {
            Canon::Feed { from, to } => {
                let from = self.after_corner(from, to)?;
                self.emit_on(Canon::Feed { from, to }, span)
            }
            Canon::Comment(_)
            | Canon::Units(_)
            | Canon::FeedRate(_)
            | Canon::SpindleSpeed(_)
            | Canon::Spindle(_)
            | Canon::SelectTool(_)
            | Canon::Coolant(_)
            | Canon::Stop { .. }
            | Canon::OtherM(_) => {
                let step = self.waiting(canon);
                self.corner.keep(step).map_err(|error| self.error(error.into(), span))
            }
            _ => self.no_corner_waits(),
        }
    }

    /// Refuses to go on while a line waits.
    pub(super) fn no_corner_waits(&self) -> Result<(), GcodeError> {
        match self.corner.held() {
            None => Ok(()),
            Some(held) => {
                let error = CornerError::NotFollowed { line: self.source.line };
                Err(error_of(held.step.source, error.into(), held.word))
            }
        }
    }

    /// Where the line that was programmed `from` … `to` begins: behind the corner that waits for it, if one does.
    fn after_corner(&mut self, from: Axes, to: Axes) -> Result<Axes, GcodeError> {
        let Some(Held { corner, word, plane, line, step, .. }) = self.corner.held() else {
            return Ok(from);
        };
        let (source, plane, word) = (step.source, *plane, *word);
        let refused = |error: CornerError| Err(error_of(source, error.into(), word));
        let (Some(start), Some(end)) = (in_plane(from, plane), in_plane(to, plane)) else {
            return self.no_corner_waits().map(|()| from);
        };
        if start == end {
            return self.no_corner_waits().map(|()| from);
        }
        let [.., third] = plane.axes();
        if from.get(third) != to.get(third) || self.modal.auxiliary != step.modal.auxiliary {
            return refused(CornerError::OtherAxis);
        }
        if self.modal.feed_mode == FeedMode::InverseTime {
            return refused(CornerError::InverseTime);
        }
        let piece = match corner.between(*line, Straight { from: start, begin: start, to: end }) {
            Ok(piece) => piece,
            Err(Misfit::TurnsBack) => return refused(CornerError::TurnsBack),
            Err(Misfit::Short { second, needed, left }) => {
                let line = if second { self.source.line } else { source.line };
                return refused(CornerError::TooLarge { needed, left, line });
            }
        };
        self.cut_corner(piece, from)
    }

    /// Gives the line that waits, the corner and what stood behind it; tells where the program goes on.
    fn cut_corner(&mut self, piece: Option<Piece>, corner: Axes) -> Result<Axes, GcodeError> {
        let Some(Held { plane, line, from, to, step, .. }) = self.corner.release() else {
            return Ok(corner);
        };
        let (mut first, mut next) = (to, corner);
        if let Some(piece) = piece {
            put(&mut first, piece.from, plane);
            put(&mut next, piece.to, plane);
        }
        // A corner may take the whole line.
        if piece.is_none_or(|piece| piece.from != line.begin) {
            self.give_on(Waiting { canon: Canon::Feed { from, to: first }, ..step })?;
        }
        if let Some(piece) = piece {
            let cut = Canon::Feed { from: first, to: next };
            let canon =
                moved(cut, piece, plane).map_err(|kind| error_of(step.source, kind.into(), step.source.block))?;
            self.give_on(Waiting { canon, ..step })?;
        }
        while let Some(step) = self.corner.next() {
            self.give_on(step)?;
        }
        Ok(next)
    }

    fn waiting(&self, canon: Canon) -> Waiting<'p> {
        Waiting { canon, source: self.source, modal: self.modal, text: self.text }
    }
}
