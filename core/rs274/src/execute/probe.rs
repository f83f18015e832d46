//! Moves whose end is not in the program: probing (G38.2 … G38.5), and tapping in step with the spindle (G33.1).
//!
//! After a probing move the axes stand where the probe answered. With a machine that place is taken to lie a stated
//! distance before the end, as LinuxCNC's stand-alone interpreter does; without one the axes that moved are unknown.

use super::super::block::BlockWords;
use super::super::{Axes, Canon, CycleError, GCode, GcodeError, Number, SettingError, Span, Units};
use super::Execution;
use super::axes::turns;
use truepath_units::{Offset, Position, div_rounded, isqrt_rounded};

/// Parameters with the result of the last probing move: nine axes, then whether the probe answered.
const RESULT: u16 = 5061;
const ANSWERED: u16 = 5070;

impl Execution<'_, '_, '_> {
    pub(super) fn probe(&mut self, block: &mut BlockWords<'_>, away: bool, must: bool) -> Result<(), GcodeError> {
        let span = self.block_span();
        let (from, auxiliary) = (self.at, self.modal.auxiliary);
        let to = self.destination(block)?;
        if must && from == to && auxiliary == self.modal.auxiliary && to != Axes::UNKNOWN {
            return Err(self.error(CycleError::ProbeTooShort.into(), span));
        }
        self.check_feed()?;
        let code = if to == from { auxiliary } else { self.modal.auxiliary };
        self.modal.auxiliary = code;
        self.emit(Canon::Probe { from, to, away, must }, span)?;
        match self.options.machine {
            Some(machine) => {
                for axis in 0..9usize {
                    let number = RESULT.saturating_add(u16::try_from(axis).unwrap_or(0));
                    let units = if turns(axis) { Units::Millimetres } else { self.modal.units };
                    let value = match axis.checked_sub(3).and_then(|a| self.modal.auxiliary.get(a)) {
                        Some(value) => *value,
                        None => to.get(axis).map_or(0, Position::nm),
                    };
                    self.store(number, Number::of_nanometres(value, units), span)?;
                }
                self.store(ANSWERED, 0.0, span)?;
                self.at = before_end(from, to, machine.probe_before_end);
            }
            None => {
                for axis in (0..3).filter(|&axis| from.get(axis) != to.get(axis)) {
                    self.forget(axis);
                }
            }
        }
        Ok(())
    }

    /// G33.1 X Y Z K.
    pub(super) fn tap(&mut self, block: &mut BlockWords<'_>, code: GCode, span: Span) -> Result<(), GcodeError> {
        let Some(pitch) = block.use_word(b'K') else {
            return Err(self.word_missing(code, b'K', span));
        };
        self.length(pitch)?;
        block.use_word(b'I');
        let from = self.at;
        let to = self.destination(block)?;
        if from == to {
            return Err(self.error(SettingError::AxesMissing(code).into(), span));
        }
        self.emit(Canon::Tap { from, to }, span)
    }
}

/// The place a distance before the end of a line; its start when the line is shorter.
fn before_end(from: Axes, to: Axes, distance: Offset) -> Axes {
    let mut square = 0u128;
    let step = |axis: usize| match (from.get(axis), to.get(axis)) {
        (Some(a), Some(b)) => i128::from((b - a).nm()),
        _ => 0,
    };
    for axis in 0..3 {
        let part = step(axis).unsigned_abs();
        square = square.saturating_add(part.saturating_mul(part));
    }
    let length = i128::try_from(isqrt_rounded(square)).unwrap_or(i128::MAX);
    let mut at = to;
    if length == 0 {
        return at;
    }
    for axis in 0..3 {
        let back = div_rounded(step(axis).saturating_mul(i128::from(distance.nm())), length);
        let back = Offset::from_nm(i64::try_from(back).unwrap_or(0));
        at.set(axis, to.get(axis).map(|p| p - back));
    }
    at
}
