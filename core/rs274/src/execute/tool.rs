//! Tools: selection, change, length and offset (G43, G43.1, G43.2, G44, G49), and the tool table in the program (G10).

use super::super::block::BlockWords;
use super::super::group::Group;
use super::super::mcode::MCodes;
use super::super::{Canon, CycleError, GCode, GcodeError, NineAxes, SettingError, Shifts, Span, Tool, ToolLength};
use super::Execution;
use super::memory::CHANGED_TOOLS;
use truepath_units::{Offset, Position};

impl Execution<'_, '_, '_> {
    /// A row of the tool table, as G10 has left it.
    pub(super) fn tool_row(&self, number: u32) -> Option<Tool> {
        let changed = self.changed_tools.iter().find(|tool| tool.number == number);
        changed.or_else(|| self.options.tools.iter().find(|tool| tool.number == number)).copied()
    }
}

impl Execution<'_, '_, '_> {
    /// T, M6, M61.
    pub(super) fn tool_codes(&mut self, block: &mut BlockWords<'_>, m: &MCodes) -> Result<(), GcodeError> {
        if let Some(word) = block.use_word(b'T') {
            let tool = self.whole(word)?;
            self.require_tool(tool, word.span)?;
            self.modal.selected = Some(tool);
            self.emit(Canon::SelectTool(tool), word.span)?;
        }
        // A tool by name has no number.
        if block.use_word(b't').is_some() {
            self.modal.selected = None;
        }
        let Some(code) = m.tool else { return Ok(()) };
        if code.number == 61 {
            let Some(word) = block.use_word(b'Q') else {
                return Err(self.error(SettingError::MWordMissing { m: 61, letter: b'Q' }.into(), code.span));
            };
            let tool = self.whole(word)?;
            self.require_tool(tool, word.span)?;
            self.modal.tool = Some(tool);
            self.emit(Canon::OtherM(61), code.span)?;
            return Ok(());
        }
        self.modal.tool = self.modal.selected;
        // A second T names the next tool.
        let next = block.last_word(b'T').map(|word| self.whole(word)).transpose()?;
        self.modal.selected = next.or(self.modal.selected);
        if self.options.machine.is_none() {
            // Many machines lift to change the tool, and the new one has another length.
            self.at.z = None;
        } else if !self.modal.compensated {
            // LinuxCNC asks the machine where it stands after a change, which is beside the path when G40 came before.
            self.compensation.name_place_left(&mut self.at);
        }
        self.emit(Canon::ChangeTool(self.modal.tool), code.span)
    }

    /// Whether any tool is taken to be there.
    fn knows_no_tools(&self) -> bool {
        self.options.machine.is_none() || self.options.tools.is_empty()
    }

    fn require_tool(&self, tool: u32, span: Span) -> Result<(), GcodeError> {
        if self.knows_no_tools() || tool == 0 || self.tool_row(tool).is_some() {
            return Ok(());
        }
        Err(self.error(SettingError::ToolUnknown { tool }.into(), span))
    }

    /// G43, G43.1, G43.2, G44, G49, and H alone while an offset is on. Another offset gives the same place another name.
    pub(super) fn tool_length(&mut self, block: &mut BlockWords<'_>) -> Result<(), GcodeError> {
        let Some((code, span)) = block.code(Group::ToolLength) else {
            if !self.modal.length_offset || !block.has_unused(b"H") {
                return Ok(());
            }
            let Some(word) = block.use_word(b'H') else { return Ok(()) };
            let number = self.whole(word)?;
            let tool = self.offset_of(Some(number), word.span)?;
            return self.set_tool_offset(ToolLength::Table(Some(number)), tool, &[2], word.span);
        };
        match code.tenths() {
            490 => self.length_off(span),
            431 => {
                let words = self.all_axes(block)?;
                let mut tool = self.modal.shifts.tool;
                for (tool, word) in tool.iter_mut().zip(words) {
                    *tool = word.unwrap_or(*tool);
                }
                let named = [0usize, 1].map(|axis| words.get(axis).copied().flatten().is_some());
                let unknown: &[usize] = match named {
                    [true, true] => &[0, 1, 2],
                    [true, false] => &[0, 2],
                    [false, true] => &[1, 2],
                    [false, false] => &[2],
                };
                self.set_tool_offset(ToolLength::InProgram, tool, unknown, span)
            }
            432 => {
                let number = block.use_word(b'H').map(|w| self.whole(w)).transpose()?;
                let more = match number {
                    Some(_) => self.offset_of(number, span)?,
                    None => {
                        let words = self.all_axes(block)?;
                        if words == [None; 9] {
                            return Err(self.error(CycleError::WordMissing { code, letter: b'H' }.into(), span));
                        }
                        words.map(Option::unwrap_or_default)
                    }
                };
                let mut tool = self.modal.shifts.tool;
                for (tool, more) in tool.iter_mut().zip(more) {
                    *tool = tool.saturating_add(more);
                }
                self.set_tool_offset(ToolLength::InProgram, tool, &[0, 1, 2], span)
            }
            tenths => {
                let number = block.use_word(b'H').map(|w| self.whole(w)).transpose()?;
                let tool = self.offset_of(number, span)?;
                let tool = if tenths == 440 { tool.map(i64::saturating_neg) } else { tool };
                self.set_tool_offset(ToolLength::Table(number), tool, &[2], span)
            }
        }
    }

    /// G49.
    pub(super) fn length_off(&mut self, span: Span) -> Result<(), GcodeError> {
        self.set_tool_offset(ToolLength::Off, [0; 9], &[2], span)
    }

    /// The offsets of a row, or of the tool in the spindle.
    fn offset_of(&self, number: Option<u32>, span: Span) -> Result<NineAxes, GcodeError> {
        let tool = number.or(self.modal.tool).unwrap_or(0);
        match self.tool_row(tool) {
            Some(row) => Ok(row.offset),
            None if tool == 0 || self.knows_no_tools() => Ok([0; 9]),
            None => Err(self.error(SettingError::ToolUnknown { tool }.into(), span)),
        }
    }

    /// Puts an offset into force; the axes it may change are unknown where the machine is not known.
    fn set_tool_offset(
        &mut self,
        length: ToolLength,
        tool: NineAxes,
        changes: &[usize],
        span: Span,
    ) -> Result<(), GcodeError> {
        self.modal.length_offset = length != ToolLength::Off;
        self.shift_to(Shifts { tool, ..self.modal.shifts });
        if self.options.machine.is_none() {
            for axis in changes {
                self.forget(*axis);
            }
        }
        self.emit(Canon::ToolLength(length), span)
    }

    /// G10 L1, L10, L11: a row of the tool table.
    pub(super) fn set_tool(&mut self, block: &mut BlockWords<'_>, way: u32) -> Result<(), GcodeError> {
        let span = self.block_span();
        let Some(word) = block.use_word(b'P') else {
            let code = GCode::from_tenths(100);
            return Err(self.error(CycleError::WordMissing { code, letter: b'P' }.into(), span));
        };
        let number = self.whole(word)?;
        self.require_tool(number, word.span)?;
        let mut row = self.tool_row(number).unwrap_or(Tool { number, ..Tool::NONE });
        if let Some(radius) = self.use_length(block, b'R')? {
            row.diameter = Offset::from_nm(radius.saturating_mul(2));
        }
        for letter in [b'I', b'J', b'Q'] {
            block.use_word(letter);
        }
        let words = self.all_axes(block)?;
        // L10: the present place gets these coordinates under the present work offset; L11: under G59.3.
        let mut shifts = Shifts { tool: [0; 9], ..self.modal.shifts };
        if way == 11 {
            shifts.work = self.stored_axes(super::stored::work_place(9));
            shifts.rotation = self.stored_rotation(9);
            shifts.local = [0; 9];
        }
        let machine = self.machine_axes();
        let place = |axis: usize| machine.get(axis).copied().flatten().map(Position::from_nm);
        let bare = shifts.to_program(super::super::Axes { x: place(0), y: place(1), z: place(2) });
        for (axis, (offset, word)) in row.offset.iter_mut().zip(words).enumerate() {
            let Some(word) = word else { continue };
            let without_tool = match axis {
                0..=2 => bare.get(axis).map(Position::nm),
                _ => machine
                    .get(axis)
                    .copied()
                    .flatten()
                    .map(|at| at.saturating_add(shifts.difference(&Shifts::NONE, axis))),
            };
            *offset = match (way, without_tool) {
                (1, _) | (_, None) => word,
                (_, Some(at)) => at.saturating_sub(word),
            };
        }
        if let Some(known) = self.changed_tools.iter_mut().find(|tool| tool.number == number) {
            *known = row;
        } else if self.changed_tools.push(row).is_err() {
            let limit = CHANGED_TOOLS as u8;
            return Err(self.error(SettingError::TooManyTools { limit }.into(), span));
        }
        self.emit(Canon::ToolEntry { tool: number }, span)
    }
}
