//! Fixed-point quantities of the core as floating-point numbers, for reports and the virtual machine.

use truepath_core::units::{Offset, Real};

/// Millimetres of a length.
pub const fn mm(v: Offset) -> f64 {
    v.nm() as f64 / 1e6
}

/// A length of so many millimetres, to the nanometre.
pub fn nm(mm: f64) -> Offset {
    Offset::from_nm((mm * 1e6).round() as i64)
}

/// A number of the model, in its own unit.
pub const fn float(v: Real) -> f64 {
    v.bits() as f64 / 4_294_967_296.0
}

/// The nearest number of the model; the end of its range for one beyond.
pub fn real(value: f64) -> Real {
    Real::from_bits((value * 4_294_967_296.0).round() as i64)
}

/// A value rounded to so many decimals: nanometres and nanoradians are enough for any reader.
pub fn rounded(v: f64, digits: i32) -> f64 {
    let scale = 10f64.powi(digits);
    (v * scale).round() / scale
}
