//! Expressions: what stands in brackets and behind `#`, computed in floating point.
//!
//! | file | what |
//! |---|---|
//! | `evaluator.rs` | reads and computes, with stacks of its own and no recursion |
//! | `operator.rs` | `** * / MOD + - EQ NE GT GE LT LE AND OR XOR` |
//! | `function.rs` | `ABS` … `TAN`, in degrees |
//! | `name.rs` | names of parameters |
//!
//! Rules and precedence are LinuxCNC's: `**` before `* / MOD` before `+ -` before comparisons before `AND OR XOR`, from
//! the left within a rank; a sign binds closer than any of them.

mod evaluator;
mod function;
mod name;
mod operator;

pub(super) use evaluator::{Evaluator, Fault, parameter_number};
pub(super) use name::name;

#[cfg(feature = "klartext")]
pub(super) use klartext::{arc_tangent, computed, function_of};

/// The operators and functions, for formulas of another spelling.
#[cfg(feature = "klartext")]
mod klartext {
    use super::super::ExpressionError;
    use super::super::lexical::{Function, Operator};

    /// `left operator right`, a finite number.
    pub(in super::super) fn computed(operator: Operator, left: f64, right: f64) -> Result<f64, ExpressionError> {
        let value = operator.apply(left, right)?;
        if value.is_finite() { Ok(value) } else { Err(ExpressionError::NotFinite) }
    }

    /// The value of a function.
    pub(in super::super) fn function_of(function: Function, x: f64) -> Result<f64, ExpressionError> {
        let value = function.apply(x)?;
        if value.is_finite() { Ok(value) } else { Err(ExpressionError::NotFinite) }
    }

    /// The angle of (x, y), degrees.
    pub(in super::super) fn arc_tangent(y: f64, x: f64) -> f64 {
        Function::atan(y, x)
    }
}
