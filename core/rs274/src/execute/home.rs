//! Moves whose end is in machine coordinates: G28, G30, G53; and G28.1, G30.1, which store such a place.

use super::super::block::BlockWords;
use super::super::{
    AXIS_LETTERS, Axes, Canon, GcodeError, GcodeErrorKind, Motion, NineAxes, SettingError, Shifts, Span,
};
use super::Execution;
use truepath_units::Position;

/// The first parameter of the place of G28 and G30.
const fn stored_place(second: bool) -> u16 {
    if second { 5181 } else { 5161 }
}

impl Execution<'_, '_, '_> {
    /// G28, G30: by way of the place that the words give, then to the stored one; without axis words every axis.
    /// Without knowledge of the machine that place is unknown.
    pub(super) fn reference(&mut self, block: &mut BlockWords<'_>, second: bool, span: Span) -> Result<(), GcodeError> {
        let mut moves = AXIS_LETTERS.map(|letter| block.has_unused(&[letter]));
        if moves == [false; 9] {
            moves = [true; 9];
        }
        if self.options.machine.is_some() {
            let via = self.destination(block)?;
            self.traverse_to(via, span)?;
            let home = self.stored_axes(stored_place(second));
            let to = self.machine_place(&home, &moves);
            return self.traverse_to(to, span);
        }
        let [x, y, z, ..] = moves;
        let axes = [x, y, z];
        let mut via = self.at;
        for axis in 0..3 {
            if let Some(word) = block.use_word(self.letter(axis)) {
                let through = self.target(&word, axis)?;
                via.set(axis, through);
            }
        }
        for axis in 3..9 {
            self.use_axis(block, axis)?;
        }
        for (axis, _) in axes.into_iter().enumerate().filter(|(_, moves)| *moves) {
            self.forget(axis);
        }
        self.emit(Canon::Reference { second, axes, via }, span)
    }

    /// The program's name for a machine place of which only some axes are given; the others stay. Axes that turn,
    /// U, V and W are moved at once.
    fn machine_place(&mut self, machine: &NineAxes, moves: &[bool; 9]) -> Axes {
        let shifts = self.modal.shifts;
        let mut place = shifts.to_machine(self.at);
        for (axis, (_, to)) in moves.iter().zip(machine).enumerate().filter(|(_, (moves, _))| **moves) {
            place.set(axis, Some(Position::from_nm(*to)));
            let shift = shifts.difference(&Shifts::NONE, axis);
            if let Some(at) = axis.checked_sub(3).and_then(|a| self.modal.auxiliary.get_mut(a)) {
                *at = to.saturating_add(shift);
            }
        }
        shifts.to_program(place)
    }

    /// G28.1, G30.1.
    pub(super) fn store_reference(&mut self, second: bool, span: Span) -> Result<(), GcodeError> {
        let here = self.machine_axes();
        for (axis, at) in here.into_iter().enumerate() {
            if let Some(at) = at {
                self.store_axis(stored_place(second), axis, at, span)?;
            }
        }
        Ok(())
    }

    /// G53 with axis words: machine coordinates. They are always absolute where the machine is not known.
    pub(super) fn machine_move(&mut self, block: &mut BlockWords<'_>, span: Span) -> Result<(), GcodeError> {
        let rapid = match self.modal.motion {
            Some(Motion::Traverse) => true,
            Some(Motion::Feed) => false,
            _ => return Err(self.error(GcodeErrorKind::MachineMoveNeedsLine, span)),
        };
        let known = self.options.machine.is_some();
        if known && !self.modal.absolute {
            return Err(self.error(SettingError::MachineMoveIncremental.into(), span));
        }
        if !rapid {
            self.check_feed()?;
        }
        let mut machine: NineAxes = [0; 9];
        let mut moves = [false; 9];
        for (axis, (to, moves)) in machine.iter_mut().zip(&mut moves).enumerate() {
            if let Some(value) = self.use_axis(block, axis)? {
                (*to, *moves) = (value, true);
            }
        }
        if known {
            let to = self.machine_place(&machine, &moves);
            return if rapid { self.traverse_to(to, span) } else { self.feed_to(to, span) };
        }
        let mut to = Axes::UNKNOWN;
        for (axis, (value, _)) in machine.iter().zip(moves).enumerate().filter(|(_, (_, moves))| *moves) {
            to.set(axis, Some(Position::from_nm(*value)));
            self.forget(axis);
        }
        self.emit(Canon::MachineMove { to, rapid }, span)
    }
}
