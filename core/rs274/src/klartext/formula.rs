//! Q parameters, and what is computed with them: `Q1 = (Q2 + 3) * SIN Q4`, `FN 1: Q1 = +Q2 + -5`.
//!
//! `^` binds closer than `* / %`, these closer than `+ -`; a function takes what stands next to it, a number, a parameter or
//! a bracket. Angles are degrees. Q, QL and QR have places of their own in the memory; a parameter that was never set
//! is 0.

use super::super::expression::{arc_tangent, computed, function_of};
use super::super::lexical::{Function, Operator, trimmed};
use super::super::{ExpressionError, GcodeErrorKind, KlartextError, Memory};
use super::text::{behind, named, number, parameter};

/// Brackets and functions inside each other.
const DEPTH: u8 = 16;

/// What FN 9 … FN 12 compare by.
pub(in super::super) fn comparison(text: &[u8]) -> Option<(Operator, &[u8])> {
    let text = trimmed(text);
    for (name, operator) in [
        (&b"EQU"[..], Operator::Equal),
        (b"NE", Operator::NotEqual),
        (b"GT", Operator::Greater),
        (b"LT", Operator::Less),
    ] {
        if let Some(rest) = named(text, name) {
            return Some((operator, rest));
        }
    }
    None
}

/// Computes with the values of a memory.
pub(in super::super) struct Formula<'m, 't> {
    memory: &'m Memory<'m>,
    /// What is still to be read.
    pub(in super::super) rest: &'t [u8],
    depth: u8,
}

/// How close an operator binds.
const fn rank(operator: Operator) -> u8 {
    match operator {
        Operator::Power => 3,
        Operator::Times | Operator::Over | Operator::Modulo => 2,
        _ => 1,
    }
}

impl<'m, 't> Formula<'m, 't> {
    pub(in super::super) const fn new(memory: &'m Memory<'m>, rest: &'t [u8]) -> Self {
        Self { memory, rest, depth: 0 }
    }

    /// The value of what stands next, with all that is computed with it.
    pub(in super::super) fn value(&mut self) -> Result<f64, GcodeErrorKind> {
        self.operation(0)
    }

    fn operation(&mut self, least: u8) -> Result<f64, GcodeErrorKind> {
        let mut left = self.operand()?;
        loop {
            self.rest = trimmed(self.rest);
            let operator = match self.rest.first() {
                Some(b'+') => Operator::Plus,
                Some(b'-') => Operator::Minus,
                Some(b'*') => Operator::Times,
                Some(b'/') => Operator::Over,
                Some(b'%') => Operator::Modulo,
                Some(b'^') => Operator::Power,
                _ => return Ok(left),
            };
            if rank(operator) <= least {
                return Ok(left);
            }
            self.rest = behind(self.rest);
            let right = self.operation(rank(operator))?;
            left = computed(operator, left, right)?;
        }
    }

    /// A number, a parameter, a bracket or a function, with its sign.
    pub(in super::super) fn operand(&mut self) -> Result<f64, GcodeErrorKind> {
        self.depth = self.depth.saturating_add(1);
        if self.depth > DEPTH {
            return Err(ExpressionError::TooDeep { limit: DEPTH }.into());
        }
        let value = self.unsigned();
        self.depth = self.depth.saturating_sub(1);
        value
    }

    #[expect(clippy::float_arithmetic, reason = "formulas are computed in floating point")]
    fn unsigned(&mut self) -> Result<f64, GcodeErrorKind> {
        self.rest = trimmed(self.rest);
        match self.rest.first() {
            Some(b'+') => {
                self.rest = behind(self.rest);
                return self.operand();
            }
            Some(b'-') => {
                self.rest = behind(self.rest);
                return Ok(-self.operand()?);
            }
            Some(b'(') => {
                self.rest = behind(self.rest);
                let value = self.operation(0)?;
                self.rest = trimmed(self.rest);
                if self.rest.first() != Some(&b')') {
                    return Err(KlartextError::BracketOpen.into());
                }
                self.rest = behind(self.rest);
                return Ok(value);
            }
            _ => {}
        }
        if let Some((number, rest)) = parameter(self.rest) {
            self.rest = rest;
            return Ok(self.memory.get(number));
        }
        let (rest, value) = number(self.rest);
        if let Ok(value) = value {
            self.rest = rest;
            return Ok(value.value());
        }
        self.function()
    }

    #[expect(clippy::float_arithmetic, reason = "formulas are computed in floating point")]
    fn function(&mut self) -> Result<f64, GcodeErrorKind> {
        if let Some(rest) = named(self.rest, b"PI") {
            self.rest = rest;
            return Ok(core::f64::consts::PI);
        }
        for (name, function) in [
            (&b"ASIN"[..], Function::Asin),
            (b"ACOS", Function::Acos),
            (b"SIN", Function::Sin),
            (b"COS", Function::Cos),
            (b"TAN", Function::Tan),
            (b"SQRT", Function::Sqrt),
            (b"ABS", Function::Abs),
            (b"LN", Function::Ln),
            (b"EXP", Function::Exp),
        ] {
            if let Some(rest) = named(self.rest, name) {
                self.rest = rest;
                return function_of(function, self.operand()?).map_err(Into::into);
            }
        }
        for (name, of) in [
            (&b"ATAN"[..], (|x| arc_tangent(x, 1.0)) as fn(f64) -> f64),
            (b"SQ", |x| x * x),
            (b"INT", libm::trunc),
            (b"FRAC", |x| x - libm::trunc(x)),
            (b"NEG", |x| -x),
            (b"SGN", |x| {
                if x > 0.0 {
                    1.0
                } else if x < 0.0 {
                    -1.0
                } else {
                    0.0
                }
            }),
        ] {
            if let Some(rest) = named(self.rest, name) {
                self.rest = rest;
                return Ok(of(self.operand()?));
            }
        }
        if let Some(rest) = named(self.rest, b"LOG") {
            self.rest = rest;
            let natural = function_of(Function::Ln, self.operand()?)?;
            return Ok(natural / core::f64::consts::LN_10);
        }
        Err(KlartextError::Formula.into())
    }
}
