//! G40, G41, G42, G41.1, G42.1: which cutter keeps beside the path, and from where to where.

use super::super::block::BlockWords;
use super::super::compensation::{CompensationError, Cutter, StartUp, Waiting};
use super::super::group::Group;
use super::super::{Canon, CompensationBy, Event, GcodeError, GcodeErrorKind, Line, Plane, Source, Span, WarningKind};
use super::Execution;
use truepath_units::geometry::Side;
use truepath_units::{Offset, div_rounded};

/// The largest radius, 100 m.
const LARGEST_NM: u64 = 100_000_000_000;

impl<'p> Execution<'p, '_, '_> {
    /// Executes G40 … G42.1.
    pub(super) fn compensation(&mut self, block: &mut BlockWords) -> Result<(), GcodeError> {
        let Some((code, span)) = block.code(Group::Compensation) else {
            if self.modal.wall.is_some()
                && let Some(word) = block.use_word(b'D')
            {
                // Where the path is compensated, the radius stays until G40.
                if self.modal.compensated {
                    return Err(self.error(GcodeErrorKind::UnusedWord { letter: b'D' }, word.span));
                }
                self.modal.radius_offset = Some(self.whole(word)?);
            }
            return self.refuse_cycles(block);
        };
        if code.tenths() == 400 {
            self.stop_compensation(span)?;
            self.modal.wall = None;
            self.modal.radius_offset = None;
            self.modal.compensated = false;
            return self.emit(Canon::Compensation { wall: None, offset_number: None }, span);
        }
        let left = matches!(code.tenths(), 410 | 411);
        let wall = Some(if left { Side::Right } else { Side::Left });
        let start_up = StartUp::of(self.options.dialect);
        if self.modal.compensated {
            // Said once more, which changes nothing.
            let number = block.use_word(b'D').map(|word| self.whole(word)).transpose()?;
            let same = wall == self.modal.wall && (number.is_none() || number == self.modal.radius_offset);
            if same && start_up == StartUp::Next && matches!(code.tenths(), 410 | 420) {
                return self.refuse_cycles(block);
            }
            return Err(self.error(CompensationError::AlreadyOn.into(), span));
        }
        let diameter = match code.tenths() {
            411 | 421 => Some(self.diameter_in_program(block, span)?),
            _ => self.diameter_of_table(block, span)?,
        };
        self.modal.wall = wall;
        self.modal.compensated = diameter.is_some();
        self.emit(Canon::Compensation { wall: self.modal.wall, offset_number: self.modal.radius_offset }, span)?;
        let Some(diameter) = diameter else {
            self.warn(WarningKind::CompensationNotApplied, span);
            return Ok(());
        };
        if self.modal.plane == Plane::Yz {
            return Err(self.error(CompensationError::Plane.into(), span));
        }
        if diameter == Offset::ZERO {
            return Ok(());
        }
        let radius = i64::try_from(div_rounded(diameter.nm().into(), 2)).unwrap_or(i64::MAX);
        if radius.unsigned_abs() > LARGEST_NM {
            return Err(self.error(CompensationError::RadiusTooLarge.into(), span));
        }
        // A negative radius keeps to the other side: that is how wear is entered where the program is the centre's.
        let side = if left == (radius > 0) { Side::Left } else { Side::Right };
        let cutter = Cutter { side, radius: Offset::from_nm(radius).abs() };
        self.compensation.start(cutter, self.modal.plane, start_up);
        Ok(())
    }

    fn diameter_in_program(&mut self, block: &mut BlockWords, span: Span) -> Result<Offset, GcodeError> {
        let word = block.use_word(b'D').ok_or_else(|| self.error(CompensationError::DiameterMissing.into(), span))?;
        self.length(word)
    }

    /// The diameter that D, or the tool in the spindle, has; `None` where the program is the path of the centre.
    pub(super) fn diameter_of_table(
        &mut self,
        block: &mut BlockWords,
        span: Span,
    ) -> Result<Option<Offset>, GcodeError> {
        let diameter = self.diameter_by_options(block, span)?;
        // DR of a conversational TOOL CALL.
        #[cfg(feature = "klartext")]
        let diameter = diameter.map(|d| d + self.klartext.oversize + self.klartext.oversize);
        Ok(diameter)
    }

    fn diameter_by_options(&mut self, block: &mut BlockWords, span: Span) -> Result<Option<Offset>, GcodeError> {
        let word = block.use_word(b'D');
        if let Some(word) = word {
            self.modal.radius_offset = Some(self.whole(word)?);
        }
        match self.options.compensation {
            CompensationBy::Nothing => Ok(None),
            CompensationBy::Radius(radius) => Ok(Some(radius + radius)),
            CompensationBy::ToolRadius { tool, radius } => {
                let other = self.modal.tool.is_some_and(|number| number != tool);
                Ok(if other { None } else { Some(radius + radius) })
            }
            CompensationBy::Table => {
                let Some(number) = word.and(self.modal.radius_offset).or(self.modal.tool) else {
                    return Ok(Some(Offset::ZERO));
                };
                let tool = self.tool_row(number);
                let unknown = CompensationError::ToolUnknown { number };
                match tool {
                    Some(tool) => Ok(Some(tool.diameter)),
                    None if number == 0 => Ok(Some(Offset::ZERO)),
                    None => Err(self.error(unknown.into(), word.map_or(span, |w| w.span))),
                }
            }
        }
    }

    /// Canned cycles, threads and G5 have no path beside them.
    fn refuse_cycles(&self, block: &BlockWords) -> Result<(), GcodeError> {
        let Some((code, span)) = block.code(Group::Motion).filter(|_| self.modal.compensated) else {
            return Ok(());
        };
        match code.tenths() {
            0 | 10 | 20 | 30 | 800 => Ok(()),
            _ => Err(self.error(CompensationError::Forbidden.into(), span)),
        }
    }

    /// Ends compensation: what waits goes on.
    pub(in super::super) fn stop_compensation(&mut self, span: Span) -> Result<(), GcodeError> {
        self.no_corner_waits()?;
        self.compensation.stop().map_err(|kind| self.error(kind.into(), span))?;
        self.give_ready()
    }

    /// Takes a step through compensation.
    pub(super) fn compensate(&mut self, canon: Canon, span: Span) -> Result<(), GcodeError> {
        if matches!(canon, Canon::End(_)) {
            self.stop_compensation(span)?;
        }
        let step = Waiting { canon, source: self.source, modal: self.modal, text: self.text };
        self.compensation.accept(step).map_err(|kind| self.error(kind.into(), span))?;
        self.give_ready()
    }

    fn give_ready(&mut self) -> Result<(), GcodeError> {
        while let Some(step) = self.compensation.next() {
            self.give(&step)?;
        }
        Ok(())
    }

    /// Gives a step that has waited to the sink; what it answers is an error at the step's block.
    fn give(&mut self, step: &Waiting<'p>) -> Result<(), GcodeError> {
        #[cfg(feature = "klartext")]
        if self.is_way_of_lead(step) {
            return Ok(());
        }
        let Some(sink) = self.sink.take() else {
            return Ok(());
        };
        let Waiting { canon, source, modal, text } = step;
        let answer = sink(&Event { canon, source: *source, modal, text, parameters: self });
        self.sink = Some(sink);
        answer.map_err(|kind| error_of(*source, kind, source.block))
    }

    /// Gives a step that has waited for a corner on to compensation, or to the sink.
    pub(super) fn give_on(&mut self, step: Waiting<'p>) -> Result<(), GcodeError> {
        if self.compensation.is_idle() {
            return self.give(&step);
        }
        let source = step.source;
        self.compensation.accept(step).map_err(|kind| error_of(source, kind.into(), source.block))?;
        self.give_ready()
    }
}

/// An error of a block that is no longer the present one.
pub(super) fn error_of(source: Source, kind: GcodeErrorKind, span: Span) -> GcodeError {
    let line = Line { number: source.line, start: source.block.start, text: &[] };
    GcodeError::new(kind, &line, span).in_file(source.file)
}
