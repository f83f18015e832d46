//! A column of numbers: decimal fractions as 32-bit whole numbers in base64.
//!
//! Value = (offset + number) / 10^decimals, little endian; −2³¹ stands for no value. A value is stored exactly to the
//! decimals of its column. A column whose values span more than 32 bits gets fewer decimals than asked for, and what fits
//! with none of them (beyond ±9·10¹⁵, or finite values more than 4·10⁹ apart) becomes "no value": nothing wraps.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;

/// Digits of lengths and angles, and of forces, in the tables.
pub(super) const FINE: u32 = 6;
/// The same of forces.
pub(super) const FORCE: u32 = 4;
/// Of feeds.
pub(super) const FEED: u32 = 3;
/// Of unit vectors.
pub(super) const UNIT: u32 = 9;

/// A column. In it every number is finite or absent.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Column {
    decimals: u32,
    #[serde(skip_serializing_if = "Option::is_none")]
    offset: Option<i64>,
    data: String,
}

/// Stands for no value.
const NONE: i32 = i32::MIN;
/// Decimals at most: those of a nanometre in metres.
const MOST_DECIMALS: u32 = 9;
/// Whole numbers up to this are exact in double precision, which is what the page computes in.
const EXACT: f64 = 9_007_199_254_740_992.0;

impl Column {
    /// From values, with the given decimals (9 at most) or fewer. What is not finite is no value.
    pub fn of(values: impl IntoIterator<Item = f64>, decimals: u32) -> Self {
        let values: Vec<f64> = values.into_iter().collect();
        let decimals = decimals.min(MOST_DECIMALS);
        let fitting = (0..=decimals).rev().find_map(|d| offset(&values, d).map(|offset| (d, offset)));
        // Values that no column holds together: those near zero stay, the others are left out.
        let (decimals, offset) = fitting.unwrap_or((decimals, 0));
        let number = |v: &f64| {
            let whole = scaled(*v, decimals)?.checked_sub(offset)?;
            i32::try_from(whole).ok().filter(|n| *n != NONE)
        };
        let bytes: Vec<u8> = values.iter().flat_map(|v| number(v).unwrap_or(NONE).to_le_bytes()).collect();
        Self { decimals, offset: (offset != 0).then_some(offset), data: STANDARD.encode(bytes) }
    }

    /// From values of which some are absent.
    pub fn partly(values: impl IntoIterator<Item = Option<f64>>, decimals: u32) -> Self {
        Self::of(values.into_iter().map(|v| v.unwrap_or(f64::NAN)), decimals)
    }

    /// The values, as the page reads them.
    pub fn values(&self) -> Vec<Option<f64>> {
        // What was encoded here can be decoded.
        let bytes = STANDARD.decode(&self.data).unwrap_or_default();
        let unit = 10f64.powi(self.decimals as i32);
        let value = |n: i32| (n != NONE).then(|| (self.offset.unwrap_or(0) + i64::from(n)) as f64 / unit);
        let (numbers, _) = bytes.as_chunks::<4>();
        numbers.iter().map(|four| value(i32::from_le_bytes(*four))).collect()
    }

    /// Digits behind the decimal point.
    pub const fn decimals(&self) -> u32 {
        self.decimals
    }
}

/// A value in units of the last decimal; `None` where that is no exact whole number in the page.
fn scaled(v: f64, decimals: u32) -> Option<i64> {
    let whole = (v * 10f64.powi(decimals as i32)).round();
    (whole.abs() <= EXACT).then_some(whole as i64)
}

/// What is subtracted so that all finite values fit; `None` when they do not with so many decimals.
fn offset(values: &[f64], decimals: u32) -> Option<i64> {
    const MOST: i64 = i32::MAX as i64;
    let (mut low, mut high) = (i64::MAX, i64::MIN);
    for v in values.iter().filter(|v| v.is_finite()) {
        let whole = scaled(*v, decimals)?;
        (low, high) = (low.min(whole), high.max(whole));
    }
    if low > high || (low >= -MOST && high <= MOST) {
        return Some(0);
    }
    let middle = low + (high - low) / 2;
    (high - middle <= MOST && middle - low <= MOST).then_some(middle)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::Column;

    proptest! {
        #[test]
        fn numbers_of_a_table_come_back_exactly(
            whole in prop::collection::vec(prop::option::of(-2_147_483_647i64..=2_147_483_647), 0..60),
            decimals in 0u32..=9,
            far in prop_oneof![Just(0i64), -4_000_000_000_000i64..=4_000_000_000_000],
        ) {
            let unit = 10f64.powi(decimals as i32);
            let values: Vec<Option<f64>> = whole.iter().map(|w| w.map(|w| (w / 2 + far) as f64 / unit)).collect();
            let column = Column::partly(values.iter().copied(), decimals);
            prop_assert_eq!(column.decimals(), decimals);
            prop_assert_eq!(column.values(), values);
        }

        #[test]
        fn any_number_comes_back_rounded_or_not_at_all(
            values in prop::collection::vec(prop::num::f64::ANY, 0..20),
            decimals in 0u32..=12,
        ) {
            let column = Column::of(values.iter().copied(), decimals);
            let read = column.values();
            prop_assert_eq!(read.len(), values.len());
            let half = 0.5 / 10f64.powi(column.decimals() as i32);
            for (value, read) in values.iter().zip(read) {
                if let Some(read) = read {
                    prop_assert!((value - read).abs() <= half + value.abs() * f64::EPSILON * 2.0, "{value} became {read}");
                }
            }
        }
    }

    #[test]
    fn a_wide_column_keeps_as_many_decimals_as_fit() {
        let column = Column::of([-4000.0, 0.123_456, 4000.0], 6);
        assert_eq!(column.decimals(), 5);
        assert_eq!(column.values(), [Some(-4000.0), Some(0.123_46), Some(4000.0)]);
    }

    #[test]
    fn a_column_far_from_zero_keeps_its_decimals() {
        let column = Column::of([8_000.000_001, f64::NAN, 8000.5], 6);
        assert_eq!((column.decimals(), column.values()), (6, vec![Some(8_000.000_001), None, Some(8000.5)]));
    }

    #[test]
    fn what_fits_nowhere_is_no_value() {
        let column = Column::of([1e300, 0.25, f64::INFINITY, -1e18], 3);
        assert_eq!(column.values(), [None, Some(0.25), None, None]);
    }

    #[test]
    fn the_mark_of_no_value_is_never_a_value() {
        let column = Column::of([-2_147_483_648.0, 0.0], 0);
        assert_eq!(column.values(), [Some(-2_147_483_648.0), Some(0.0)]);
    }
}
