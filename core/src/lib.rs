//! The core of Truepath: everything that runs on the device, and everything the host must share with it.
//!
//! A milling cutter pushes the machine away from the wall it cuts. This crate predicts that push along a contour
//! from the geometry of the cut, fits the prediction to a few probe points, turns it into a correction array and
//! rewrites interpolated setpoints with it. It is `no_std`, allocates nothing, contains no `unsafe` and computes in
//! fixed point, so a PC and a microcontroller give the same bits.
//!
//! It is the roof of five crates nested in its folder and re-exports the rooms of the other four, so that whoever
//! builds a whole correction names one crate. Data flows downwards; a crate or module never names one below it:
//!
//! | crate | module | what it holds |
//! |---|---|---|
//! | `truepath-units` | [`units`] | fixed-point lengths and numbers, the one rounding, trigonometry, roots |
//! | | [`checksum`] | CRC-32 of programs, images and frames |
//! | | [`geometry`] | vectors, directions, lines, arcs, contours and their sampling |
//! | `truepath-rs274` | [`gcode`] | bytes → words → modal interpreter → canonical moves → contour |
//! | `truepath-model` | [`probe`] | measurement files → contacts on the nominal contour |
//! | | [`cut`] | stock → engagement → force → elastic loop → wall |
//! | | [`identify`] | probe errors and the cut model → compliance, coefficients, covariance |
//! | | [`correct`] | the cut model → correction array |
//! | | [`process`] | several passes, the stock as a field over contour and height |
//! | `truepath-wire` | [`image`] | correction array ↔ bytes |
//! | | [`update`] | the signed head of a firmware update |
//! | | [`rewrite`] | setpoint → corrected setpoint, the only code in the servo cycle |
//! | | [`link`] | frames and messages of both links, and what becomes of a frame |
//! | `truepath-core` | [`job`] | job, program and measurement → image: what the command line and the device both run |
//! | | [`errors`] | the code and the sentences of every error |
//!
//! `truepath-wire` needs `truepath-units` alone: it is all that a servo cycle has to trust.
//!
//! The engagement of a 20 mm cutter that takes 3 mm off a straight wall, from geometry, as the core computes it:
//!
//! ```rust
//! use truepath_core::cut::{CutSetup, Milling, Path, Runout, Sample, WallLaw};
//! use truepath_core::geometry::{Block, Contour, Curve, Point, Side, Vector};
//! use truepath_core::units::{Offset, Real};
//!
//! let setup = CutSetup {
//!     radius: Offset::from_um(10_000),
//!     teeth: 6,
//!     helix_deg: Real::from_int(30),
//!     axial_depth: Real::from_int(10),
//!     allowance: Offset::from_um(3_000),
//!     spindle_rpm: Real::from_int(1500),
//!     wall: Side::Right,
//!     milling: Milling::of(Side::Right, true),
//!     law: WallLaw::Helical,
//!     runout: Runout::NONE,
//! };
//! let curve = Curve::line(Point::from_nm(0, 0), Point::from_nm(40_000_000, 0)).unwrap();
//! let blocks = [Block { curve, s: Offset::ZERO, feed: Real::from_int(400), line: 1 }];
//! let contour = Contour::new(&blocks).unwrap();
//!
//! let step = Offset::from_um(100);
//! let mut buffer = vec![Sample::BLANK; Path::samples_needed(&contour, &setup, step)];
//! let path = Path::sample(&contour, &setup, step, &mut buffer, |_| ()).unwrap();
//! let index = path.index_at(Offset::from_um(20_000));
//! let frame = path.frame(index, Vector::ZERO).unwrap();
//! let degrees = path.engagement(index, Vector::ZERO, &frame) * Real::from_int(180) / Real::PI;
//! // acos(1 − h/r) = 45.573°
//! assert!((degrees - Real::ratio(45_573, 1000)).abs() < Real::ratio(1, 100));
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

pub mod errors;
pub mod job;

pub use truepath_model::{correct, cut, identify, probe, process};
pub use truepath_rs274 as gcode;
pub use truepath_units::{self as units, checksum, geometry};
pub use truepath_wire::{image, link, rewrite, update};
