//! Operators with two operands.

use super::super::ExpressionError;
use super::super::lexical::Operator;

/// How far two numbers may differ and count as equal; LinuxCNC's value.
const EQUAL: f64 = 1e-4;

impl Operator {
    /// The higher, the closer it binds.
    pub(super) const fn rank(self) -> u8 {
        match self {
            Self::Power => 5,
            Self::Times | Self::Over | Self::Modulo => 4,
            Self::Plus | Self::Minus => 3,
            Self::Equal | Self::NotEqual | Self::Greater | Self::GreaterEqual | Self::Less | Self::LessEqual => 2,
            Self::And | Self::Or | Self::Xor => 1,
        }
    }

    /// The value of `left operator right`. A vacant parameter (no number) is 0, but not equal to 0.
    #[expect(clippy::float_arithmetic, reason = "expressions are computed in floating point")]
    pub(super) fn apply(self, left: f64, right: f64) -> Result<f64, ExpressionError> {
        if matches!(self, Self::Equal | Self::NotEqual) && (left.is_nan() || right.is_nan()) {
            return Ok(truth((left.is_nan() && right.is_nan()) == (self == Self::Equal)));
        }
        let [left, right] = [left, right].map(|value| if value.is_nan() { 0.0 } else { value });
        Ok(match self {
            Self::Power if left < 0.0 && right != libm::floor(right) => return Err(ExpressionError::NegativePower),
            Self::Power => libm::pow(left, right),
            Self::Times => left * right,
            Self::Over | Self::Modulo if right == 0.0 => return Err(ExpressionError::DivisionByZero),
            Self::Over => left / right,
            Self::Modulo => {
                let rest = libm::fmod(left, right);
                if rest < 0.0 { rest + libm::fabs(right) } else { rest }
            }
            Self::Plus => left + right,
            Self::Minus => left - right,
            Self::Equal => truth(libm::fabs(left - right) < EQUAL),
            Self::NotEqual => truth(libm::fabs(left - right) >= EQUAL),
            Self::Greater => truth(left > right),
            Self::GreaterEqual => truth(left >= right),
            Self::Less => truth(left < right),
            Self::LessEqual => truth(left <= right),
            Self::And => truth(left != 0.0 && right != 0.0),
            Self::Or => truth(left != 0.0 || right != 0.0),
            Self::Xor => truth((left != 0.0) != (right != 0.0)),
        })
    }
}

const fn truth(value: bool) -> f64 {
    if value { 1.0 } else { 0.0 }
}
