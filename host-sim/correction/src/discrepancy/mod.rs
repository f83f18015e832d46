//! What parts show beside the model: model discrepancy, a Gaussian process with the physics as its kernel.
//!
//! Machine, cutter and material are a dozen parameters. What no parameter can say is where along the contour the load
//! differs (uneven stock, a wall that yields), how the datum drifts while the contour is cut, how the level of force moves
//! from part to part as the cutter wears, and what nobody has thought of. Each is believed in with a covariance of its own
//! ([`Kernel`]); parameters and discrepancy are fitted together to the points of all parts, so that neither is bent by
//! the other (Kennedy & O'Hagan, *Bayesian calibration of computer models*, J. R. Stat. Soc. B 63, 2001; Rasmussen &
//! Williams, *Gaussian Processes for Machine Learning*, ch. 2 and 5). How large each kind is the evidence says; what it
//! leaves open is averaged over and is part of the standard deviation.
//!
//! | step | where |
//! |---|---|
//! | how a place looks to the kernel | [`Feature`] |
//! | how alike two places are | [`Kernel`] |
//! | the points with what a parameter does to them | [`Points`] |
//! | kernels, points of something else, mean and standard deviation | [`Discrepancy`] |
//! | the stock that they show | `Allowance` |
//! | parameters again, the points relieved of their discrepancy | [`relieved()`] |
//!
//! Sums run in one stated order, and every entry of a covariance is made of products that keep their bits when the part
//! is shifted, turned by a quarter or mirrored: so does the result.

mod allowance;
mod average;
mod evidence;
mod feature;
mod kernel;
mod nominal;
mod open;
mod pairs;
mod points;
mod relieved;

pub use average::{Along, ByLoad, Discrepancy, Sizes, ln_probability_elsewhere};
pub use feature::{Engagement, Feature, Sensitivity};
pub use kernel::{Kernel, least_change};
pub use open::Open;
pub use points::{CutPoints, Own, Points, stock_sensitivities};
pub use relieved::{PartCut, Relieved, is_fitted, ln_evidence, own, plain, plain_from, relieved};
