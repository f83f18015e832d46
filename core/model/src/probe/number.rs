//! Plain decimal numbers of measurement files, exact until they are rounded once to nanometres.

use super::error::ProbeErrorKind;
use super::format::LengthUnit;
use truepath_rs274::{Decimal, NumberError};
use truepath_units::Real;

/// A decimal number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Number(Decimal);

/// The first number with too many digits before its point.
const TOO_LARGE: u64 = 1_000_000_000_000;

/// Which bytes stand before the decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Signs {
    pub(super) point: bool,
    pub(super) comma: bool,
}

impl Signs {
    pub(super) const POINT: Self = Self { point: true, comma: false };
}

impl Number {
    pub(super) const ZERO: Self = Self(Decimal::ZERO);

    /// Sign, digits, one decimal sign; neither exponent nor blanks.
    pub(super) fn parse(text: &[u8], signs: Signs) -> Result<Self, ProbeErrorKind> {
        let is_point = |byte| (byte == b'.' && signs.point) || (byte == b',' && signs.comma);
        match Decimal::read(text, is_point, |_| false) {
            ([_, ..], _) | (_, Err(NumberError::Missing)) => Err(ProbeErrorKind::NotANumber),
            (_, Ok(number)) if whole(number) < TOO_LARGE => Ok(Self(number)),
            _ => Err(ProbeErrorKind::NumberTooLarge),
        }
    }

    /// Zero with as many decimals as this number.
    pub(super) fn zeroed(self) -> Self {
        Self(Decimal::new(0, self.decimals()).unwrap_or(self.0))
    }

    /// Digits behind the point.
    pub(super) const fn decimals(self) -> u8 {
        self.0.decimals()
    }

    /// This number with the other sign.
    pub(super) const fn negated(self) -> Self {
        Self(self.0.negated())
    }

    /// The length in nanometres, rounded to nearest.
    pub(super) fn nm(self, unit: LengthUnit) -> Result<i64, ProbeErrorKind> {
        i64::try_from(self.0.times(unit.nm())).map_err(|_| ProbeErrorKind::NumberTooLarge)
    }

    /// The number without a unit.
    pub(super) const fn real(self) -> Real {
        self.0.real()
    }

    /// The whole number; `None` when it is not one or is negative.
    pub(super) fn whole(self) -> Option<u32> {
        u32::try_from(self.0.exactly_times(1)?).ok()
    }
}

/// What stands before the point.
fn whole(number: Decimal) -> u64 {
    number.mantissa().unsigned_abs().checked_div(10u64.saturating_pow(number.decimals().into())).unwrap_or(0)
}
