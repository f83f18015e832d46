//! What moves the origin of the program: G54 … G59.3, G54.1, G154, G52, G92 and its family, G10 L2 and L20.
//!
//! A shift renames the place where the machine stands. Without knowledge of the machine another work offset makes every
//! position unknown, and G10 L2 the axes it names; G92, G52 and G10 L20 tell enough to go on.

use super::super::block::BlockWords;
use super::super::group::Group;
use super::super::{
    AXIS_LETTERS, Axes, Canon, GCode, GcodeError, NineAxes, SettingError, ShiftKind, Shifts, Span, Word,
};
use super::Execution;
use super::axes::turns;
use super::stored::{LOCAL_FLAG, WORK_NUMBER, work_place};
use truepath_units::Position;

/// Axis words of a block as values.
type AxisWords = [Option<i64>; 9];

impl Execution<'_, '_, '_> {
    /// G54 … G59.3, G54.1 P, G154 P.
    pub(super) fn work_offset(&mut self, block: &mut BlockWords<'_>) -> Result<(), GcodeError> {
        let Some((code, span)) = block.code(Group::WorkOffset) else {
            return Ok(());
        };
        let system = match code.tenths() {
            541 | 1540 => {
                let Some(word) = block.use_word(b'P') else {
                    return Err(self.error(super::super::CycleError::WordMissing { code, letter: b'P' }.into(), span));
                };
                let (first, most) = if code.tenths() == 541 { (9, 100) } else { (109, 99) };
                let number = self.between(word, 1, most)?;
                number.saturating_add(first)
            }
            // G110 … G129 are G154 P1 … P20.
            tenths @ 1_100..=1_290 => u32::from(tenths / 10),
            tenths @ 540..=590 => u32::from(tenths / 10).saturating_sub(53),
            tenths => u32::from(tenths.saturating_sub(584)),
        };
        self.select_work_offset(u16::try_from(system).unwrap_or(u16::MAX), span)
    }

    /// Puts a work offset into force.
    pub(super) fn select_work_offset(&mut self, system: u16, span: Span) -> Result<(), GcodeError> {
        let work = self.stored_axes(work_place(system));
        self.shift_to(Shifts { work, rotation: self.stored_rotation(system), ..self.modal.shifts });
        if system != self.modal.work_offset && self.options.machine.is_none() {
            self.at = Axes::UNKNOWN;
        }
        self.modal.work_offset = system;
        if system <= 9 && self.options.machine.is_some() {
            self.store(WORK_NUMBER, f64::from(system), span)?;
        }
        self.emit(Canon::WorkOffset(system), span)
    }

    /// Renames the place where the machine stands.
    pub(super) fn shift_to(&mut self, shifts: Shifts) {
        let before = self.modal.shifts;
        self.at = shifts.renamed_from(&before, self.at);
        for (at, axis) in self.modal.auxiliary.iter_mut().zip(3..9) {
            *at = at.saturating_add(shifts.difference(&before, axis));
        }
        self.modal.shifts = shifts;
    }

    /// A whole number of a word, within limits.
    pub(super) fn between(&self, word: Word, least: u32, greatest: u32) -> Result<u32, GcodeError> {
        let letter = word.letter;
        match word.value.exactly_times(1).and_then(|n| u32::try_from(n).ok()) {
            Some(n) if (least..=greatest).contains(&n) => Ok(n),
            _ => Err(self.error(SettingError::NotBetween { letter, least, greatest }.into(), word.span)),
        }
    }

    /// The words of all axes, used.
    pub(super) fn all_axes(&mut self, block: &mut BlockWords<'_>) -> Result<AxisWords, GcodeError> {
        let mut words = [None; 9];
        for (axis, word) in words.iter_mut().enumerate() {
            *word = self.use_axis(block, axis)?;
        }
        Ok(words)
    }

    /// The program coordinate of an axis, when it is known.
    fn present(&self, axis: usize) -> Option<i64> {
        match axis.checked_sub(3).and_then(|a| self.modal.auxiliary.get(a)) {
            Some(at) => Some(*at),
            None => self.at.get(axis).map(Position::nm),
        }
    }

    /// Says where an axis stands.
    fn name(&mut self, axis: usize, value: i64) {
        match axis.checked_sub(3).and_then(|a| self.modal.auxiliary.get_mut(a)) {
            Some(at) => *at = value,
            None => self.at.set(axis, Some(Position::from_nm(value))),
        }
    }

    /// G92: the place where the machine stands gets the coordinates of the words.
    pub(super) fn name_place(&mut self, block: &mut BlockWords<'_>, code: GCode, span: Span) -> Result<(), GcodeError> {
        let words = self.all_axes(block)?;
        if words == [None; 9] {
            return Err(self.error(SettingError::AxesMissing(code).into(), span));
        }
        let mut local = self.modal.shifts.local;
        for (axis, (local, word)) in local.iter_mut().zip(words).enumerate() {
            let (Some(word), Some(at)) = (word, self.present(axis)) else { continue };
            *local = local.saturating_add(at.saturating_sub(word));
        }
        self.local(local, true, span)?;
        // Also where the place was unknown before.
        for (axis, word) in words.into_iter().enumerate() {
            if let Some(word) = word {
                self.name(axis, word);
            }
        }
        self.emit(Canon::Shift(ShiftKind::Local), span)
    }

    /// G52: the origin lies where the words say. TRANS of Siemens sets the axes that it does not name to 0, and ATRANS
    /// adds.
    pub(super) fn local_origin(
        &mut self,
        block: &mut BlockWords<'_>,
        code: GCode,
        span: Span,
    ) -> Result<(), GcodeError> {
        let words = self.all_axes(block)?;
        let written = span.of(self.text).first().map(u8::to_ascii_uppercase);
        if words == [None; 9] && written == Some(b'G') {
            return Err(self.error(SettingError::AxesMissing(code).into(), span));
        }
        let mut local = self.modal.shifts.local;
        for (local, word) in local.iter_mut().zip(words) {
            *local = match written {
                Some(b'T') => word.unwrap_or(0),
                Some(b'A') => local.saturating_add(word.unwrap_or(0)),
                _ => word.unwrap_or(*local),
            };
        }
        self.local(local, true, span)?;
        self.emit(Canon::Shift(ShiftKind::Local), span)
    }

    /// G92.1 (forget), G92.2 (suspend), G92.3 (restore).
    pub(super) fn local_family(&mut self, code: GCode, span: Span) -> Result<(), GcodeError> {
        match code.tenths() {
            921 => self.local([0; 9], false, span)?,
            922 => {
                self.shift_to(Shifts { local: [0; 9], ..self.modal.shifts });
                self.store(LOCAL_FLAG, 0.0, span)?;
            }
            _ => {
                let local = self.stored_axes(LOCAL_FLAG.saturating_add(1));
                self.local(local, true, span)?;
            }
        }
        self.emit(Canon::Shift(ShiftKind::Local), span)
    }

    fn local(&mut self, local: NineAxes, applied: bool, span: Span) -> Result<(), GcodeError> {
        self.shift_to(Shifts { local, ..self.modal.shifts });
        self.store(LOCAL_FLAG, if applied { 1.0 } else { 0.0 }, span)?;
        for (axis, value) in local.into_iter().enumerate() {
            self.store_axis(LOCAL_FLAG.saturating_add(1), axis, value, span)?;
        }
        Ok(())
    }

    /// G10 L2 and L20: sets a work offset.
    pub(super) fn set_work_offset(&mut self, block: &mut BlockWords<'_>, from_here: bool) -> Result<(), GcodeError> {
        let span = self.block_span();
        let Some(word) = block.use_word(b'P') else {
            let code = GCode::from_tenths(100);
            return Err(self.error(super::super::CycleError::WordMissing { code, letter: b'P' }.into(), span));
        };
        let system = u16::try_from(self.between(word, 0, 9)?).unwrap_or(0);
        let system = if system == 0 { self.modal.work_offset } else { system };
        let active = system == self.modal.work_offset;
        // G10 L20 has no R: the word is left over.
        let word = if from_here { None } else { block.use_word(b'R') };
        let rotation = word.map(|word| self.axis_value(word, 3)).transpose()?;
        let words = self.all_axes(block)?;
        let first = work_place(system);
        let mut shifts = self.modal.shifts;
        if !active {
            shifts.work = self.stored_axes(first);
            shifts.rotation = self.stored_rotation(system);
        }
        if let Some(rotation) = rotation {
            shifts.rotation = rotation.nm();
            self.store(
                first.saturating_add(9),
                super::super::Number::of_nanometres(rotation.nm(), super::super::Units::Millimetres),
                span,
            )?;
        }
        if from_here {
            self.offset_from_here(&mut shifts, &words);
        } else {
            for (work, word) in shifts.work.iter_mut().zip(words) {
                *work = word.unwrap_or(*work);
            }
        }
        for (axis, value) in shifts.work.into_iter().enumerate() {
            self.store_axis(first, axis, value, span)?;
        }
        if !active {
            return Ok(());
        }
        self.shift_to(shifts);
        for (axis, word) in words.into_iter().enumerate() {
            match word {
                Some(word) if from_here => self.name(axis, word),
                Some(_) if self.options.machine.is_none() && !turns(axis) => self.forget(axis),
                _ => {}
            }
        }
        self.emit(Canon::Shift(ShiftKind::Work), span)
    }

    /// The work offset with which the machine's place has the coordinates of the words.
    fn offset_from_here(&self, shifts: &mut Shifts, words: &AxisWords) {
        let machine = self.modal.shifts.to_machine(self.at);
        let mut named = shifts.to_program(machine);
        for (axis, word) in words.iter().enumerate().take(3) {
            if let Some(word) = word {
                named.set(axis, Some(Position::from_nm(*word)));
            }
        }
        let work = shifts.work_naming(machine, named);
        let here = self.machine_axes();
        for (axis, (slot, new)) in shifts.work.iter_mut().zip(work).enumerate() {
            let word = words.get(axis).copied().flatten();
            *slot = match (word, here.get(axis).copied().flatten()) {
                // Axes that stand alone: machine = program + local + work + tool.
                (Some(word), Some(here)) if axis >= 3 => {
                    let other = |table: &NineAxes| table.get(axis).copied().unwrap_or(0);
                    here.saturating_sub(word)
                        .saturating_sub(other(&self.modal.shifts.local))
                        .saturating_sub(other(&self.modal.shifts.tool))
                }
                _ if axis >= 3 => *slot,
                _ => new,
            };
        }
    }

    /// Whether a block has words of axes.
    pub(super) fn names_axes(block: &BlockWords<'_>) -> bool {
        block.has_unused(&AXIS_LETTERS) || block.has_unused(b"@^")
    }
}
