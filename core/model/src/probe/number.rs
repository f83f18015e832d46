//! Plain decimal numbers of measurement files, exact until they are rounded once to nanometres.

use super::error::ProbeErrorKind;
use super::format::LengthUnit;
use truepath_units::{Real, div_rounded};

/// A decimal number: sign, digits, and how many of them are decimals.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Number {
    mantissa: i128,
    scale: i128,
    /// Digits behind the point.
    pub(super) decimals: u32,
}

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
    pub(super) const ZERO: Self = Self { mantissa: 0, scale: 1, decimals: 0 };

    /// Sign, digits, one decimal sign; neither exponent nor blanks.
    pub(super) fn parse(text: &[u8], signs: Signs) -> Result<Self, ProbeErrorKind> {
        let (negative, digits) = match text {
            [b'-', rest @ ..] => (true, rest),
            [b'+', rest @ ..] => (false, rest),
            _ => (false, text),
        };
        let (mut mantissa, mut scale, mut whole, mut any) = (0i128, 1i128, 0u32, false);
        let (mut behind_point, mut decimals) = (false, 0u32);
        for byte in digits {
            match byte {
                b'0'..=b'9' => {
                    any = true;
                    if behind_point {
                        decimals = decimals.saturating_add(1);
                    }
                    // Digits finer than 10⁻¹⁵ are below any length.
                    if !behind_point || scale < 1_000_000_000_000_000 {
                        mantissa = mantissa.saturating_mul(10).saturating_add(i128::from(byte.saturating_sub(b'0')));
                        if behind_point {
                            scale = scale.saturating_mul(10);
                        } else if mantissa != 0 {
                            whole = whole.saturating_add(1);
                        }
                    }
                }
                b'.' if !behind_point && signs.point => behind_point = true,
                b',' if !behind_point && signs.comma => behind_point = true,
                _ => return Err(ProbeErrorKind::NotANumber),
            }
        }
        if !any {
            return Err(ProbeErrorKind::NotANumber);
        }
        if whole > 12 {
            return Err(ProbeErrorKind::NumberTooLarge);
        }
        Ok(Self { mantissa: if negative { mantissa.saturating_neg() } else { mantissa }, scale, decimals })
    }

    /// With the other sign.
    pub(super) const fn negated(self) -> Self {
        Self { mantissa: self.mantissa.saturating_neg(), ..self }
    }

    /// Zero with as many decimals as another number.
    pub(super) const fn zero_like(other: Self) -> Self {
        Self { mantissa: 0, scale: 1, decimals: other.decimals }
    }

    /// As a length in nanometres, rounded to nearest.
    pub(super) fn nm(self, unit: LengthUnit) -> Result<i64, ProbeErrorKind> {
        let nm = div_rounded(self.mantissa.saturating_mul(unit.nm()), self.scale);
        i64::try_from(nm).map_err(|_| ProbeErrorKind::NumberTooLarge)
    }

    /// As a number without a unit.
    pub(super) fn real(self) -> Real {
        Real::narrow(div_rounded(self.mantissa.saturating_mul(1 << Real::FRACTION_BITS), self.scale))
    }

    /// As a whole number; `None` when it is not one or is negative.
    pub(super) fn whole(self) -> Option<u32> {
        let whole = self.mantissa.checked_div(self.scale)?;
        let exact = self.mantissa.checked_rem(self.scale) == Some(0);
        u32::try_from(whole).ok().filter(|_| exact)
    }
}
