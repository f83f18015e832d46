//! Pictures (SVG, PNG): the traces of a pass, a correction, the wall to scale, laws of correction compared.
//!
//! The commands draw what they have in memory, `truepath plot` what they wrote: the same rows go into the same functions.
//! Series are thinned without losing a peak (M4), so a picture stays below a megabyte whatever the length of the
//! contour.

mod compare;
mod correction;
mod error;
mod part;
mod trace;
mod wall;

pub use compare::{Compared, LawWall, compare};
pub use correction::correction;
pub use error::{error, predicted_error};
pub use trace::{Column, PASSES, trace};
pub use wall::{Place, Probed, Wall};
