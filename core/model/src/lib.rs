//! What happens when a contour is cut, what probe points tell about it, and what corrects it.
//!
//! Its place: above `truepath-units` and `truepath-rs274`; `truepath-core` turns its results into an image. Data flows
//! downwards; a module never names one below it:
//!
//! | module | what it holds |
//! |---|---|
//! | [`probe`] | measurement files → contacts on the nominal contour |
//! | [`cut`] | stock → engagement → force → elastic loop → wall |
//! | [`identify`] | probe errors and the cut model → compliance, coefficients, covariance |
//! | [`correct`] | the cut model → correction array |
//! | [`process`] | several passes, the stock as a field over contour and height |
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

pub mod correct;
pub mod cut;
pub mod identify;
pub mod probe;
pub mod process;
