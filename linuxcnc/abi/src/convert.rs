//! Between HAL's floats and whole nanometres: the only place with float arithmetic in this crate.
//!
//! Each function is called by its name and not inlined, so that a look at the machine code shows that the rest of the
//! servo cycle has none.

#![expect(clippy::float_arithmetic, reason = "HAL carries lengths as floats")]

/// A length of this or more is none: 1000 km, which a float still tells to an eighth of a nanometre.
const MOST_NM: f64 = 1e15;
/// Units from a micrometre to a metre; also in inches there is nothing beyond.
const UNITS: core::ops::RangeInclusive<f64> = 1e3..=1e9;

/// Nanometres of a length in machine units, to the nearest. None when it is no number, too large, or the unit is not
/// one of 1 µm … 1 m.
#[inline(never)]
pub fn nearest_nm(length: f64, nm_per_unit: f64) -> Option<i64> {
    let nm = exact(length, nm_per_unit)?;
    Some(if nm < 0.0 { nm - 0.5 } else { nm + 0.5 } as i64)
}

/// The whole nanometres not above a length.
pub fn floor_nm(length: f64, nm_per_unit: f64) -> Option<i64> {
    let nm = exact(length, nm_per_unit)?;
    let whole = nm as i64;
    Some(if whole as f64 > nm { whole.saturating_sub(1) } else { whole })
}

/// The whole nanometres not below a length.
pub fn ceil_nm(length: f64, nm_per_unit: f64) -> Option<i64> {
    let nm = exact(length, nm_per_unit)?;
    let whole = nm as i64;
    Some(if (whole as f64) < nm { whole.saturating_add(1) } else { whole })
}

#[inline(always)]
fn exact(length: f64, nm_per_unit: f64) -> Option<f64> {
    let nm = length * nm_per_unit;
    (UNITS.contains(&nm_per_unit) && nm.abs() < MOST_NM).then_some(nm)
}

/// A correction in machine units. `nm_per_unit` is one that [`nearest_nm`] takes.
#[inline(never)]
pub fn units(nm: i32, nm_per_unit: f64) -> f64 {
    f64::from(nm) / nm_per_unit
}

/// With the correction; the same bits without one.
#[inline(never)]
pub fn added(position: f64, correction: f64) -> f64 {
    if correction == 0.0 { position } else { position + correction }
}

/// Without the correction; the same bits when there is none.
#[inline(never)]
pub fn removed(position: f64, correction: f64) -> f64 {
    if correction == 0.0 { position } else { position - correction }
}

/// Thousandths of a revolution per minute, whichever way the spindle turns; 0 for no number.
#[inline(never)]
pub fn millirpm(rpm: f64) -> u32 {
    (rpm.abs() * 1000.0 + 0.5) as u32
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lengths_become_the_nearest_nanometre_in_both_directions() {
        for (length, nm) in [(1.0, 1_000_000), (-0.000_001_4, -1), (0.000_001_5, 2), (-0.000_001_5, -2), (-0.0, 0)] {
            assert_eq!(nearest_nm(length, 1e6), Some(nm), "{length}");
        }
        assert_eq!(nearest_nm(1.0, 25.4e6), Some(25_400_000));
        assert_eq!((floor_nm(-0.000_001_5, 1e6), ceil_nm(-0.000_001_5, 1e6)), (Some(-2), Some(-1)));
        assert_eq!((floor_nm(0.000_001_5, 1e6), ceil_nm(0.000_001_5, 1e6)), (Some(1), Some(2)));
    }

    #[test]
    fn what_is_no_length_is_none() {
        for length in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 1e300, -1e9] {
            assert_eq!(nearest_nm(length, 1e6), None, "{length}");
        }
        for unit in [0.0, -1e6, f64::NAN, f64::INFINITY, 1.0] {
            assert_eq!(nearest_nm(1.0, unit), None, "{unit}");
        }
    }

    #[test]
    fn a_position_without_a_correction_keeps_its_bits() {
        for position in [-0.0, f64::NAN, 5e-324, 1e300] {
            assert_eq!(added(position, 0.0).to_bits(), position.to_bits());
            assert_eq!(removed(position, 0.0).to_bits(), position.to_bits());
        }
        assert_eq!(removed(added(10.0, units(-3, 1e6)), units(-3, 1e6)), 10.0);
    }

    #[test]
    fn any_spindle_speed_is_a_number() {
        for (rpm, expected) in [(-1500.0, 1_500_000), (0.0004, 0), (f64::NAN, 0), (f64::INFINITY, u32::MAX)] {
            assert_eq!(millirpm(rpm), expected);
        }
    }
}
