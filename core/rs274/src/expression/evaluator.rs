//! Reads an expression and computes its value.
//!
//! Operands and operators wait on two stacks of fixed depth until an operator that binds less follows, or the bracket
//! closes (E. W. Dijkstra's shunting yard): nothing recurs, and an expression nested too deeply is an error.

use super::super::lexical::{Function, NumberError, Operator, number, trimmed};
use super::super::{Dialect, ExpressionError, GcodeErrorKind, MachineParameters, ParameterError};
use super::name;

/// Operands and operators that may wait.
const DEPTH: usize = 48;

/// What is wrong in an expression: from the byte with this many bytes left behind it to the byte with that many.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(in super::super) struct Fault {
    /// What is wrong.
    pub(in super::super) kind: GcodeErrorKind,
    /// Bytes of the text from the first wrong one on.
    pub(in super::super) from: usize,
    /// Bytes of the text behind the last wrong one.
    pub(in super::super) to: usize,
}

/// What waits for an operand, with the bytes left where it stands.
#[derive(Clone, Copy)]
enum Waiting {
    Bracket,
    Binary(Operator),
    Function(Function),
    /// `ATAN[y]/`: y waits below.
    ArcTangent,
    Minus,
    Parameter,
}

/// Computes expressions with the parameters of a program.
pub(in super::super) struct Evaluator<'e, P> {
    parameters: &'e P,
    dialect: Dialect,
    operands: heapless::Vec<f64, DEPTH>,
    waiting: heapless::Vec<(Waiting, usize), DEPTH>,
}

impl<'e, P: MachineParameters> Evaluator<'e, P> {
    /// An evaluator with these parameters.
    pub(in super::super) const fn new(parameters: &'e P, dialect: Dialect) -> Self {
        Self { parameters, dialect, operands: heapless::Vec::new(), waiting: heapless::Vec::new() }
    }

    /// The value at the start of a text, and what follows it: a number, a parameter, a function or an expression in
    /// brackets, with signs before it. With `open`, operators may stand outside of brackets too.
    pub(in super::super) fn value<'t>(&mut self, text: &'t [u8], open: bool) -> Result<(f64, &'t [u8]), Fault> {
        self.operands.clear();
        self.waiting.clear();
        let mut rest = text;
        loop {
            rest = self.operand(rest)?;
            // Behind an operand: what closes, and what goes on.
            loop {
                self.signs()?;
                let next = trimmed(rest);
                let at = next.len();
                let inside = self.waiting.iter().any(|(w, _)| matches!(w, Waiting::Bracket));
                if inside && next.first() == Some(&b']') {
                    rest = next.get(1..).unwrap_or(&[]);
                    if self.close(&mut rest, at)? {
                        continue;
                    }
                    break;
                }
                if !inside && !open {
                    return self.finish(rest);
                }
                let Some((operator, len)) = Operator::at(next) else {
                    return if inside { Err(unclosed(next)) } else { self.finish(rest) };
                };
                self.reduce(operator.rank())?;
                self.wait(Waiting::Binary(operator), at)?;
                rest = next.get(len..).unwrap_or(&[]);
                break;
            }
        }
    }

    /// Reads up to the end of an operand.
    fn operand<'t>(&mut self, mut rest: &'t [u8]) -> Result<&'t [u8], Fault> {
        loop {
            let next = trimmed(rest);
            let at = next.len();
            let Some((&byte, behind)) = next.split_first() else {
                return Err(fault(ExpressionError::ValueMissing, at, at));
            };
            match byte {
                b'[' => self.wait(Waiting::Bracket, at)?,
                b'-' => self.wait(Waiting::Minus, at)?,
                b'+' => {}
                b'#' => {
                    let inside = trimmed(behind);
                    if inside.first() == Some(&b'<') {
                        let (name, len) = name(inside).map_err(|kind| fault(kind, at, 0))?;
                        let end = inside.get(len..).unwrap_or(&[]);
                        let value =
                            self.named(&name).ok_or_else(|| fault(ParameterError::NotDefined, at, end.len()))?;
                        self.push(value, at)?;
                        return Ok(end);
                    }
                    self.wait(Waiting::Parameter, at)?;
                }
                b'0'..=b'9' | b'.' => {
                    let (end, value) = number(next);
                    let value = value.map_err(|kind| match kind {
                        NumberError::Missing => fault(ExpressionError::ValueMissing, at, end.len()),
                        NumberError::TooLarge => fault(ExpressionError::NumberTooLarge, at, end.len()),
                    })?;
                    self.push(value.value(), at)?;
                    return Ok(end);
                }
                _ => {
                    let Some((function, len)) = Function::at(next) else {
                        return Err(not_a_value(next));
                    };
                    let behind = next.get(len..).unwrap_or(&[]);
                    if function == Function::Exists {
                        match self.exists(behind, at)? {
                            (true, end) => return Ok(end),
                            (false, number) => rest = number,
                        }
                        continue;
                    }
                    self.wait(Waiting::Function(function), at)?;
                    rest = behind;
                    continue;
                }
            }
            rest = behind;
        }
    }

    /// `EXISTS[#<name>]`, `EXISTS[#5]`; `false` with the text of the number where that is computed, `EXISTS[##1]`.
    fn exists<'t>(&mut self, text: &'t [u8], at: usize) -> Result<(bool, &'t [u8]), Fault> {
        let wrong = fault(ExpressionError::ExistsWithoutParameter, at, 0);
        let inside = trimmed(text).strip_prefix(b"[").ok_or(wrong)?;
        let inside = trimmed(trimmed(inside).strip_prefix(b"#").ok_or(wrong)?);
        let (known, end) = if inside.first() == Some(&b'<') {
            let (name, len) = name(inside).map_err(|kind| fault(kind, at, 0))?;
            (self.named(&name).is_some(), inside.get(len..).unwrap_or(&[]))
        } else if matches!(inside.first(), Some(b'#' | b'[')) {
            self.wait(Waiting::Function(Function::Exists), at)?;
            self.wait(Waiting::Bracket, at)?;
            return Ok((false, inside));
        } else {
            let (end, value) = number(inside);
            (value.is_ok(), end)
        };
        let end = trimmed(end).strip_prefix(b"]").ok_or(wrong)?;
        self.push(if known { 1.0 } else { 0.0 }, at)?;
        Ok((true, end))
    }

    /// Closes a bracket; `false` when another operand must follow (`ATAN[y]/`).
    fn close(&mut self, rest: &mut &[u8], at: usize) -> Result<bool, Fault> {
        self.reduce(0)?;
        self.waiting.pop();
        match self.waiting.last().copied() {
            Some((Waiting::Function(Function::Atan), start)) => {
                let slash = trimmed(rest).strip_prefix(b"/").filter(|r| trimmed(r).first() == Some(&b'['));
                *rest = slash.ok_or_else(|| fault(ExpressionError::AtanNeedsTwo, start, rest.len()))?;
                self.waiting.pop();
                self.wait(Waiting::ArcTangent, start)?;
                Ok(false)
            }
            Some((Waiting::ArcTangent, _)) => {
                self.waiting.pop();
                let (x, y) = (self.pop(at)?, self.pop(at)?);
                self.push(Function::atan(y, x), at)?;
                Ok(true)
            }
            Some((Waiting::Function(Function::Exists), start)) => {
                self.waiting.pop();
                let number = self.pop(at)?;
                let known = parameter_number(number, self.dialect).is_ok_and(|number| number > 0);
                self.push(if known { 1.0 } else { 0.0 }, start)?;
                Ok(true)
            }
            Some((Waiting::Function(function), start)) => {
                self.waiting.pop();
                let x = self.pop(at)?;
                let value = function.apply(x).map_err(|kind| fault(kind, start, rest.len()))?;
                self.checked(value, start)?;
                Ok(true)
            }
            _ => Ok(true),
        }
    }

    /// Applies the signs and `#` in front of the operand just read.
    #[expect(clippy::float_arithmetic, reason = "expressions are computed in floating point")]
    fn signs(&mut self) -> Result<(), Fault> {
        while let Some(&(waiting @ (Waiting::Minus | Waiting::Parameter), at)) = self.waiting.last() {
            self.waiting.pop();
            let operand = self.pop(at)?;
            let value = match waiting {
                Waiting::Minus if operand.is_nan() => 0.0,
                // Not −operand: there is no −0.
                Waiting::Minus => 0.0 - operand,
                _ => self.numbered(operand).map_err(|kind| fault(kind, at, at.saturating_sub(1)))?,
            };
            self.push(value, at)?;
        }
        Ok(())
    }

    /// Applies the operators that bind at least as closely as `rank`, back to the last bracket.
    fn reduce(&mut self, rank: u8) -> Result<(), Fault> {
        while let Some(&(Waiting::Binary(operator), at)) = self.waiting.last() {
            if operator.rank() < rank {
                break;
            }
            self.waiting.pop();
            let (right, left) = (self.pop(at)?, self.pop(at)?);
            let value = operator.apply(left, right).map_err(|kind| fault(kind, at, at.saturating_sub(1)))?;
            self.checked(value, at)?;
        }
        Ok(())
    }

    fn finish<'t>(&mut self, rest: &'t [u8]) -> Result<(f64, &'t [u8]), Fault> {
        self.reduce(0)?;
        Ok((self.pop(rest.len())?, rest))
    }

    /// The value of a numbered parameter.
    fn numbered(&self, number: f64) -> Result<f64, ParameterError> {
        let number = parameter_number(number, self.dialect)?;
        if number == 0 {
            return if self.dialect.has_macro_b() { Ok(f64::NAN) } else { Err(largest(self.dialect)) };
        }
        Ok(self.parameters.number(u32::from(number)).unwrap_or_else(|| self.parameters.memory().get(number)))
    }

    fn named(&self, name: &[u8]) -> Option<f64> {
        self.parameters.named(name).or_else(|| self.parameters.memory().named(name))
    }

    fn checked(&mut self, value: f64, at: usize) -> Result<(), Fault> {
        if value.is_finite() {
            self.push(value, at)
        } else {
            Err(fault(ExpressionError::NotFinite, at, at.saturating_sub(1)))
        }
    }

    fn push(&mut self, value: f64, at: usize) -> Result<(), Fault> {
        self.operands.push(value).map_err(|_| too_deep(at))
    }

    fn wait(&mut self, what: Waiting, at: usize) -> Result<(), Fault> {
        self.waiting.push((what, at)).map_err(|_| too_deep(at))
    }

    fn pop(&mut self, at: usize) -> Result<f64, Fault> {
        self.operands.pop().ok_or_else(|| fault(ExpressionError::ValueMissing, at, at))
    }
}

/// The number of a parameter from a value.
pub(in super::super) fn parameter_number(value: f64, dialect: Dialect) -> Result<u16, ParameterError> {
    let whole = super::super::Number::Computed(value).exactly_times(1).ok_or(ParameterError::NotWhole)?;
    let number = u16::try_from(whole).map_err(|_| largest(dialect))?;
    if number > dialect.largest_parameter() { Err(largest(dialect)) } else { Ok(number) }
}

const fn largest(dialect: Dialect) -> ParameterError {
    ParameterError::Number { largest: dialect.largest_parameter() }
}

fn fault(kind: impl Into<GcodeErrorKind>, from: usize, to: usize) -> Fault {
    Fault { kind: kind.into(), from, to }
}

fn too_deep(at: usize) -> Fault {
    fault(ExpressionError::TooDeep { limit: DEPTH as u8 }, at, at.saturating_sub(1))
}

fn unclosed(next: &[u8]) -> Fault {
    let at = next.len();
    match next.first() {
        None => fault(ExpressionError::BracketNotClosed, 1, 0),
        Some(byte) => fault(ExpressionError::Operator(*byte), at, at.saturating_sub(1)),
    }
}

fn not_a_value(next: &[u8]) -> Fault {
    let letters = next.iter().take_while(|b| b.is_ascii_alphabetic()).count().max(1);
    let kind = if letters > 1 { ExpressionError::Function } else { ExpressionError::ValueMissing };
    fault(kind, next.len(), next.len().saturating_sub(letters))
}
