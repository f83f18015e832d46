//! Numbers: one length type, one general number, one rounding; plane [`geometry`] and the [`checksum`] on top of them; how [`errors`](mod@errors) are declared.
//!
//! Its place: the ground floor. It names no other crate of Truepath; all others name it.
//!
//! * [`Position`] and [`Offset`] are whole nanometres in 64 bits. A decimal G-code word is then exact
//!   (0.0001 in = 2540 nm). A position is a place, an offset a difference of places; two positions cannot be added.
//! * [`Real`] is the general number of the model (forces in newtons, angles in radians, chip thickness in
//!   millimetres, …): 31 integer and 32 fraction bits, saturating.
//! * `round.rs` ([`shift_rounded`], [`div_rounded`]) holds the only rounding of the crate. It is odd-symmetric, so a mirrored contour gives mirrored bits.
//!
//! ```
//! use truepath_units::{Offset, Position, Real, hypot_nm};
//!
//! let from = Position::from_nm(2_540); // 0.0001 in
//! let to = from + Offset::from_um(3);
//! assert_eq!(to - from, Offset::from_nm(3_000));
//! assert_eq!(hypot_nm(Offset::from_um(3), Offset::from_um(4)), Offset::from_um(5));
//! assert_eq!(Real::ratio(1, 3) * Real::from_int(-3), -(Real::ratio(-1, 3) * Real::from_int(-3)));
//! ```
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]
#![deny(
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_arithmetic
)]

#[cfg(test)]
extern crate std;

pub mod checksum;
pub mod errors;
pub mod geometry;

mod length;
mod power;
mod real;
mod root;
mod round;
mod trig;

pub use length::{Millimetres, Offset, Position, hypot_nm};
pub use power::{exp2, log2, pow};
pub use real::Real;
pub use root::{isqrt_near, isqrt_rounded, part};
pub use round::{div_rounded, shift_rounded, shift_rounded_i31, shift_rounded_i63, shift_rounded_i64};
pub use trig::{atan2, sin_cos};
