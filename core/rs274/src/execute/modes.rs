//! The codes of one block in their order of execution, and those that only set a mode.
//!
//! Order: RS274/NGC (NIST 6556) table 8 with LinuxCNC's additions. The one difference is that a unit code acts before
//! the F of its own block.

use super::super::block::{BlockWords, whole};
use super::super::flow::Next;
use super::super::group::Group;
use super::super::mcode::MCodes;
use super::super::{
    ArcCentres, Canon, CornerError, Dialect, Foreign, GcodeError, GcodeErrorKind, Plane, RetractLevel, SettingError,
    WarningKind, Word,
};
use super::Execution;

impl Execution<'_, '_, '_> {
    /// Executes a block; tells where the program goes on.
    pub(super) fn execute(&mut self, block: &mut BlockWords<'_>) -> Result<Next, GcodeError> {
        if let Some((second, span)) = block.program {
            // A subprogram begins with its own number.
            if self.source.depth > 0 {
                return Ok(Next::Continue);
            }
            if let Some(first) = self.program_number {
                return Err(self.error(GcodeErrorKind::SecondProgram { first, second }, span));
            }
            self.program_number = Some(second);
            self.emit(Canon::ProgramNumber(second), span)?;
            return Ok(Next::Continue);
        }
        let m = MCodes::sorted(&block.m).map_err(|(kind, span)| self.error(kind, span))?;
        if let Some(next) = self.macro_call(block)? {
            return Ok(next);
        }
        self.check_codes(block)?;
        self.units(block)?;
        self.rates(block)?;
        if !m.is_empty() {
            self.inputs_and_outputs(block, &m)?;
        }
        self.tool_codes(block, &m)?;
        if !m.is_empty() {
            self.spindle(block, &m)?;
            self.saved_modes(&m)?;
            self.switches(block, &m)?;
        }
        if block.has_modes() {
            self.surface_speed(block)?;
            self.dwell(block)?;
            self.plane(block)?;
        }
        self.compensation(block)?;
        self.tool_length(block)?;
        if block.has_modes() {
            self.work_offset(block)?;
            self.path_control(block)?;
            self.distances(block);
        }
        self.moves(block)?;
        let dialect = self.options.dialect;
        let next = self.subprogram(block, &m)?;
        for letter in [b'H', b'D'] {
            // Siemens: the edge of the tool, with its length and its radius.
            let edge = letter == b'D' && dialect == Dialect::Siemens;
            if let Some(word) = block.use_word(letter).filter(|_| !edge) {
                self.warn(WarningKind::UnusedOffsetNumber { letter }, word.span);
            }
        }
        if m.spindle.is_some()
            && let Some(word) = block.use_word(b'P')
        {
            self.warn(WarningKind::IdleWord { letter: b'P' }, word.span);
        }
        if let Some(word) = block.first_unused() {
            let kind = match word.letter {
                b'E' => GcodeErrorKind::ForeignDialect(Foreign::Printer),
                b'r' | b'c' => CornerError::WithoutLine.into(),
                letter => GcodeErrorKind::UnusedWord { letter },
            };
            return Err(self.error(kind, word.span));
        }
        self.stop(&m)?;
        Ok(if self.end.is_some() { Next::End } else { next.unwrap_or(Next::Continue) })
    }

    /// Refuses codes that the dialect does not have, and two that both use the axis words.
    fn check_codes(&mut self, block: &BlockWords<'_>) -> Result<(), GcodeError> {
        let dialect = self.options.dialect;
        if let Some((code, span)) = block.code(Group::Units)
            && matches!(code.tenths(), 700 | 710)
            && !dialect.has_metric_g71()
        {
            // Posts for mills write it in the head of a program; a cycle of a lathe, or a row of holes, has words.
            if dialect != Dialect::Fanuc || block.has_unused(b"XYZABCUVWIJKPQRDL") {
                return Err(self.error(SettingError::Lathe(code).into(), span));
            }
            self.warn(WarningKind::UnitsByLatheCode(code), span);
        }
        if let Some((code, span)) = block.code(Group::Motion)
            && code.tenths() == 760
            && !dialect.has_macro_b()
        {
            return Err(self.error(SettingError::Lathe(code).into(), span));
        }
        // G50 of a lathe moves the origin.
        if let Some((code, span)) = block.code(Group::Cancel)
            && code.tenths() == 500
            && Self::names_axes(block)
        {
            return Err(self.error(SettingError::Lathe(code).into(), span));
        }
        let Some((first, _)) = block.code(Group::OneShot) else { return Ok(()) };
        let Some((second, span)) = block.code(Group::Motion).filter(|(code, _)| code.tenths() != 800) else {
            return Ok(());
        };
        match (first.tenths(), second.tenths()) {
            // Posts for Fanuc and Haas write G0 beside G28.
            (280 | 300, 0 | 10) => self.warn(WarningKind::ReferenceWithMotion, span),
            (100 | 280 | 300 | 520 | 920, _) => {
                return Err(self.error(SettingError::AxesUsedTwice { first, second }.into(), span));
            }
            _ => {}
        }
        Ok(())
    }

    fn plane(&mut self, block: &BlockWords<'_>) -> Result<(), GcodeError> {
        let Some((code, span)) = block.code(Group::Plane) else { return Ok(()) };
        self.modal.plane = match code.tenths() {
            180 => Plane::Zx,
            190 => Plane::Yz,
            _ => Plane::Xy,
        };
        self.emit(Canon::Plane(self.modal.plane), span)
    }

    /// G90, G91, G90.1, G91.1, G98, G99.
    fn distances(&mut self, block: &BlockWords<'_>) {
        if let Some((code, _)) = block.code(Group::Distance) {
            self.modal.absolute = code.tenths() == 900;
        }
        if let Some((code, _)) = block.code(Group::ArcDistance) {
            self.modal.absolute_centres = code.tenths() == 901;
            self.centres = ArcCentres::Incremental;
        }
        if let Some((code, _)) = block.code(Group::ReturnLevel) {
            let before = code.tenths() == 980;
            self.modal.retract = if before { RetractLevel::Before } else { RetractLevel::Clearance };
        }
    }

    /// The number of a word that must be whole.
    pub(super) fn whole(&self, word: Word) -> Result<u32, GcodeError> {
        whole(word).map_err(|kind| self.error(kind, word.span))
    }
}
