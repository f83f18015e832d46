//! Parameters that a block sets: read with the others of the block, made when all of it was read.

use super::super::expression::{name, parameter_number};
use super::super::lexical::trimmed;
use super::super::parameter::Surroundings;
use super::super::{GcodeError, ParameterError, Span};
use super::reader::Reader;
use super::sentence::{Assignments, Destination};

/// LinuxCNC's switch of DEBUG comments, which has a value before a program sets it.
const DEBUG_SWITCH: u16 = 5599;

impl<'p> Reader<'p> {
    /// What an assignment sets, and to what.
    pub(super) fn assignment(&self, machine: &impl Surroundings, span: Span) -> Result<(Destination, f64), GcodeError> {
        let text = trimmed(self.rest(span.start.saturating_add(1)));
        let (destination, rest) = if text.first() == Some(&b'<') {
            let (_, len) = name(text).map_err(|kind| self.error(kind, span))?;
            (Destination::Name(text.len()), text.get(len..).unwrap_or(&[]))
        } else {
            let (number, rest) = self.evaluate(machine, text, false)?;
            let number = parameter_number(number, self.dialect).map_err(|kind| self.error(kind, span))?;
            if number == 0 {
                let largest = self.dialect.largest_parameter();
                return Err(self.error(ParameterError::Number { largest }, span));
            }
            if number != DEBUG_SWITCH && machine.number(u32::from(number)).is_some() {
                return Err(self.error(ParameterError::ReadOnly, span));
            }
            (Destination::Number(number), rest)
        };
        let right = trimmed(rest).strip_prefix(b"=").unwrap_or(&[]);
        let (value, rest) = self.evaluate(machine, right, self.dialect.has_macro_b())?;
        self.ends_at(rest, span.end())?;
        Ok((destination, value))
    }

    /// Makes the assignments of a block, after all of it was read.
    pub(super) fn assign(&self, machine: &mut impl Surroundings, assignments: &Assignments) -> Result<(), GcodeError> {
        for &(destination, value) in assignments {
            let done = match destination {
                Destination::Number(number) => machine.change(|m| m.set(number, value)),
                Destination::Name(left) => {
                    let start = self.line.text.len().saturating_sub(left);
                    let (name, _) = name(self.line.text.get(start..).unwrap_or(&[]))
                        .map_err(|kind| self.error(kind, self.line.span()))?;
                    if machine.named(&name).is_some() {
                        Err(ParameterError::ReadOnly)
                    } else {
                        machine.change(|m| m.set_named(&name, value))
                    }
                }
            };
            done.map_err(|kind| self.error(kind, self.line.span()))?;
        }
        Ok(())
    }
}
