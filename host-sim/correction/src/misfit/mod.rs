//! Points that do not fit the job: whether they do, and what would explain them.

mod cause;
mod score;
mod shift;
mod trial;

pub use cause::Cause;
pub use score::{Score, expected_mm, residual_mm};
pub use shift::Shift;
pub use trial::Trial;
