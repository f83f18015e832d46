//! A part on the machine, cut by several runs in order: its stock is a field along the contour and over the height.
//!
//! Where [`crate::mill`] cuts one pass with one engagement for all heights, here every run meets the wall that the runs before it
//! left at every height: spring passes, levels, radial steps, runs in the other direction.
//!
//! `slices` cuts the height, `rays` the contour; `field` is what is left on every ray in every slice. `laps` finds what of a
//! run goes along the contour, `immersion` what of the cutter's circumference lies in material, `elastic` closes the loop
//! between displacement and force, `march` goes along a lap, and `surface` judges the wall. See `docs/plant.md`.

mod elastic;
mod field;
mod immersion;
mod laps;
mod march;
mod rays;
mod slices;
mod surface;
mod whole;

pub use laps::{Run, laps_along};
pub use march::{Equilibrium, LapFacts, LapSample};
pub use slices::Heights;
pub use surface::{HeightScore, Surface, SurfaceScore, Worst};
pub use whole::Part;
