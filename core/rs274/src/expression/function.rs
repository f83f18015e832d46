//! Functions of one operand, and the arc tangent of two. Angles are degrees.

use super::super::ExpressionError;
use super::super::lexical::Function;

const DEGREE: f64 = core::f64::consts::PI / 180.0;

impl Function {
    /// Its value. `Atan` and `Exists` are not computed here.
    #[expect(clippy::float_arithmetic, reason = "expressions are computed in floating point")]
    pub(super) fn apply(self, x: f64) -> Result<f64, ExpressionError> {
        let x = if x.is_nan() { 0.0 } else { x };
        Ok(match self {
            Self::Asin | Self::Acos if !(-1.0..=1.0).contains(&x) => return Err(ExpressionError::ArcOutOfRange),
            Self::Ln if x <= 0.0 => return Err(ExpressionError::LogarithmOfNothing),
            Self::Sqrt if x < 0.0 => return Err(ExpressionError::RootOfNegative),
            Self::Abs => libm::fabs(x),
            Self::Acos => libm::acos(x) / DEGREE,
            Self::Asin => libm::asin(x) / DEGREE,
            Self::Cos => libm::cos(x * DEGREE),
            Self::Exp => libm::exp(x),
            Self::Fix => libm::floor(x),
            Self::Fup => libm::ceil(x),
            Self::Ln => libm::log(x),
            Self::Round => libm::round(x),
            Self::Sin => libm::sin(x * DEGREE),
            Self::Sqrt => libm::sqrt(x),
            Self::Tan => libm::tan(x * DEGREE),
            Self::Atan | Self::Exists => x,
        })
    }

    /// `ATAN[y]/[x]`, −180 … 180.
    #[expect(clippy::float_arithmetic, reason = "expressions are computed in floating point")]
    pub(super) fn atan(y: f64, x: f64) -> f64 {
        let [y, x] = [y, x].map(|value| if value.is_nan() { 0.0 } else { value });
        libm::atan2(y, x) / DEGREE
    }
}
