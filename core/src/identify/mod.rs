//! Probe errors and the cut model → compliance, coefficients, covariance.
//!
//! Weighted least squares with priors (Gauss–Newton on the closed elastic loop, wall envelope included). Everything
//! the user states about machine and material is only a prior; the points correct it as far as they can see it. The
//! tangential chip coefficient is held at its prior: a force twice as large on a machine twice as stiff leaves the
//! same wall, so the compliance carries the scale of both.

mod fit;
mod law;
mod loss;
mod observation;
mod outcome;
mod parameters;
mod part;
mod solve;
mod spread;
mod tails;

pub use fit::{identify, identify_observed, identify_parts};
pub use law::{identify_law, identify_law_observed, identify_law_parts, speaks_for_mean};
pub use observation::{Observation, PredictionWorkspace, predict};
pub use outcome::Fit;
pub use parameters::{COUNT, Parameter, Parameters, Prior};
pub use part::{EarlierPart, Eliminated};
pub use solve::{Information, Matrix, square_root};
