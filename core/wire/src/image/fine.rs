//! Corrections in units finer than the nanometre.

use truepath_units::{Offset, Real, shift_rounded, shift_rounded_i64};

/// One component of a correction: signed, 8 fraction bits of a nanometre (Q23.8 nm), range ±8.39 mm, step 3.9 pm.
///
/// The step is below a nanometre so that a slow change of the correction, a few nanometres in a hundred ticks, is
/// followed instead of sticking, and so that the two parts of a correction can be scaled and added before the one
/// rounding to whole nanometres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct FineOffset(i32);

impl FineOffset {
    /// Bits behind the point of a nanometre.
    pub const FRACTION_BITS: u32 = 8;
    /// No correction.
    pub const ZERO: Self = Self(0);

    /// From raw bits, units of 2⁻⁸ nm.
    pub const fn from_bits(bits: i32) -> Self {
        Self(bits)
    }
    /// Raw bits, units of 2⁻⁸ nm.
    pub const fn bits(self) -> i32 {
        self.0
    }
    /// From whole nanometres; `None` beyond ±8.38 mm.
    pub const fn checked_from_offset(offset: Offset) -> Option<Self> {
        let bits = offset.nm().saturating_mul(1 << Self::FRACTION_BITS);
        if bits.unsigned_abs() > i32::MAX as u64 { None } else { Some(Self(bits as i32)) }
    }
    /// From millimetres, rounded once; `None` beyond ±8.38 mm.
    pub const fn checked_from_mm(mm: Real) -> Option<Self> {
        let wide = (mm.bits() as i128).saturating_mul(1_000_000 << Self::FRACTION_BITS);
        let bits = shift_rounded(wide, Real::FRACTION_BITS);
        if bits.unsigned_abs() > i32::MAX as u128 { None } else { Some(Self(bits as i32)) }
    }
    /// Whole nanometres, rounded.
    pub const fn offset(self) -> Offset {
        Offset::from_nm(shift_rounded_i64(self.0 as i64, Self::FRACTION_BITS))
    }
    /// Millimetres, to 2⁻³² mm.
    pub const fn mm(self) -> Real {
        Real::ratio(self.0 as i64, 1_000_000 << Self::FRACTION_BITS)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used)]
    use super::*;

    #[test]
    fn millimetres_and_nanometres_agree_and_the_range_is_guarded() {
        let a = FineOffset::checked_from_mm(Real::ratio(-3, 10)).unwrap();
        assert_eq!(a.offset(), Offset::from_nm(-300_000));
        assert_eq!(FineOffset::checked_from_offset(Offset::from_nm(-300_000)), Some(a));
        assert_eq!(FineOffset::checked_from_offset(Offset::from_nm(8_388_608)), None);
        assert_eq!(FineOffset::checked_from_mm(Real::from_int(-9)), None);
        assert_eq!(a.mm(), Real::ratio(-3, 10));
        let greatest = FineOffset::from_bits(i32::MAX);
        assert_eq!(FineOffset::checked_from_mm(greatest.mm()), Some(greatest));
    }
}
