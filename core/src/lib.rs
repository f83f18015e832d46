//! The core of Truepath: everything that runs on the device, and everything the host must share with it.
//!
//! A milling cutter pushes the machine away from the wall it cuts. This crate predicts that push along a contour
//! from the geometry of the cut, fits the prediction to a few probe points, turns it into a correction array and
//! rewrites interpolated setpoints with it. It is `no_std`, allocates nothing, contains no `unsafe` and computes in
//! fixed point, so a PC and a microcontroller give the same bits.
//!
//! Data flows downwards through the modules; a module never names one below it in this list:
//!
//! | module | what it holds |
//! |---|---|
//! | [`checksum`] | CRC-32 of programs, images and frames |
//! | [`units`] | fixed-point lengths and numbers, the one rounding, trigonometry, roots |
//! | [`geometry`] | vectors, directions, lines, arcs, contours and their sampling |
//! | [`gcode`] | bytes → words → modal interpreter → canonical moves → contour |
//! | [`probe`] | measurement files → contacts on the nominal contour |
//! | [`cut`] | stock → engagement → force → elastic loop → wall |
//! | [`identify`] | probe errors and the cut model → compliance, coefficients, covariance |
//! | [`correct`] | the cut model → correction array |
//! | [`image`] | correction array ↔ bytes |
//! | [`job`] | job, program and measurement → image: what the command line and the device both run |
//! | [`rewrite`] | setpoint → corrected setpoint, the only code in the servo cycle |
//! | [`link`] | frames and messages of both links, and what becomes of a frame |
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
pub mod correct;
pub mod cut;
pub mod gcode;
pub mod geometry;
pub mod identify;
pub mod image;
pub mod job;
pub mod link;
pub mod probe;
pub mod rewrite;
pub mod units;
