//! Pictures (SVG, PNG): the traces of a pass, a correction, the wall to scale, laws of correction compared.
//!
//! The commands draw what they have in memory, `truepath plot` what they wrote: the same rows go into the same functions.
//! Series are thinned without losing a peak (M4), so a picture stays below a megabyte whatever the length of the
//! contour.

mod axis;
mod chart;
mod compare;
mod correction;
mod curve;
mod error;
mod legend;
mod letters;
mod page;
mod panel;
mod part;
mod raster;
pub(crate) mod style;
mod thin;
mod trace;
mod view;
mod wall;

pub use compare::{Compared, LawWall, compare};
pub use correction::correction;
pub use curve::{Band, Curve};
pub use error::{error, predicted_error};
pub(crate) use letters::unknown_letters;
pub use panel::{Mark, Panel, panels};
pub use raster::{PIXELS, SCALES, png};
pub use style::Ink;
pub(crate) use style::{INK_AFTER, INK_BEFORE, INKS};
pub use trace::{Column, PASSES, trace};
pub use view::{LETTERS, MAGNIFICATIONS, SIZES, View};
pub use wall::{Place, Probed, Wall};
