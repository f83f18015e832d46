//! Numbers: one length type, one general number, one rounding.
//!
//! * [`Position`] and [`Offset`] are whole nanometres in 64 bits. A decimal G-code word is then exact
//!   (0.0001 in = 2540 nm). A position is a place, an offset a difference of places; two positions cannot be added.
//! * [`Real`] is the general number of the model (forces in newtons, angles in radians, chip thickness in
//!   millimetres, …): 31 integer and 32 fraction bits, saturating.
//! * `round.rs` ([`shift_rounded`], [`div_rounded`]) holds the only rounding of the crate. It is odd-symmetric, so a mirrored contour gives mirrored bits.

mod length;
mod power;
mod real;
mod root;
mod round;
mod trig;

pub use length::{Offset, Position};
pub use power::{exp2, log2, pow};
pub use real::Real;
pub use root::{hypot_nm, isqrt_rounded};
pub use round::{div_rounded, shift_rounded, shift_rounded_i31, shift_rounded_i63, shift_rounded_i64};
pub use trig::{atan2, sin_cos};
