//! What the machine keeps in numbered parameters: reference points, work offsets, G92.
//!
//! The values are in the unit of the machine (LinuxCNC's `LINEAR_UNITS`), axes that turn in degrees.

use super::super::{GcodeError, NineAxes, Number, RetractLevel, Shifts, Span, Units};
use super::Execution;
use super::axes::turns;
use truepath_units::Position;

/// The applied flag of G92; its values follow.
pub(super) const LOCAL_FLAG: u16 = 5210;
/// The work offset in force, 1 … 9.
pub(super) const WORK_NUMBER: u16 = 5220;

/// The first parameter of a work offset: G54 … G59.3 (1 … 9), beyond them P of G54.1 (from 10) and of G154 (from 110).
pub(super) const fn work_place(system: u16) -> u16 {
    match system {
        0..=9 => 5201u16.saturating_add(system.saturating_mul(20)),
        10..=109 => 7001u16.saturating_add(system.saturating_sub(10).saturating_mul(20)),
        _ => 14_001u16.saturating_add(system.saturating_sub(110).saturating_mul(20)),
    }
}

impl Execution<'_, '_, '_> {
    fn native(&self, axis: usize) -> Units {
        if turns(axis) { Units::Millimetres } else { self.options.machine.map_or(Units::Millimetres, |m| m.units) }
    }

    fn stored_axis(&self, first: u16, axis: usize) -> i64 {
        let number = first.saturating_add(u16::try_from(axis).unwrap_or(0));
        Number::Computed(self.memory.get(number)).nanometres(self.native(axis)).unwrap_or(0)
    }

    /// Nine parameters from `first`.
    pub(super) fn stored_axes(&self, first: u16) -> NineAxes {
        let mut values = [0; 9];
        for (axis, value) in values.iter_mut().enumerate() {
            *value = self.stored_axis(first, axis);
        }
        values
    }

    /// The rotation of a work offset, millionths of a degree.
    pub(super) fn stored_rotation(&self, system: u16) -> i64 {
        if system > 9 {
            return 0;
        }
        let number = work_place(system).saturating_add(9);
        Number::Computed(self.memory.get(number)).nanometres(Units::Millimetres).unwrap_or(0)
    }

    /// Reads the state that a machine keeps while it is off.
    pub(super) fn load_machine(&mut self) {
        if self.options.machine.is_none() {
            return;
        }
        let system = Number::Computed(self.memory.get(WORK_NUMBER)).exactly_times(1);
        let system = system.and_then(|n| u16::try_from(n).ok()).filter(|n| (1..=9).contains(n)).unwrap_or(1);
        self.modal.work_offset = system;
        // LinuxCNC starts with G99.
        self.modal.retract = RetractLevel::Clearance;
        let applied = Number::Computed(self.memory.get(LOCAL_FLAG)).exactly_times(1) == Some(1);
        self.modal.shifts = Shifts {
            work: self.stored_axes(work_place(system)),
            rotation: self.stored_rotation(system),
            local: if applied { self.stored_axes(LOCAL_FLAG.saturating_add(1)) } else { [0; 9] },
            ..self.modal.shifts
        };
        let none = Shifts::NONE;
        // The options tell where the machine stands.
        self.at = self.modal.shifts.renamed_from(&none, self.at);
        for (auxiliary, axis) in self.modal.auxiliary.iter_mut().zip(3..9) {
            *auxiliary = auxiliary.saturating_add(self.modal.shifts.difference(&none, axis));
        }
    }

    /// The machine coordinates of all axes.
    pub(super) fn machine_axes(&self) -> [Option<i64>; 9] {
        let shifts = &self.modal.shifts;
        let place = shifts.to_machine(self.at);
        let mut axes = [None; 9];
        for (axis, slot) in axes.iter_mut().enumerate() {
            *slot = match axis.checked_sub(3).and_then(|a| self.modal.auxiliary.get(a)) {
                Some(at) => Some(at.saturating_add(Shifts::NONE.difference(shifts, axis))),
                None => place.get(axis).map(Position::nm),
            };
        }
        axes
    }
}

impl Execution<'_, '_, '_> {
    /// Stores the value of an axis.
    pub(super) fn store_axis(&mut self, first: u16, axis: usize, value: i64, span: Span) -> Result<(), GcodeError> {
        let number = first.saturating_add(u16::try_from(axis).unwrap_or(0));
        self.store(number, Number::of_nanometres(value, self.native(axis)), span)
    }

    /// Stores a parameter.
    pub(super) fn store(&mut self, number: u16, value: f64, span: Span) -> Result<(), GcodeError> {
        self.memory.set(number, value).map_err(|error| self.error(error.into(), span))
    }
}
