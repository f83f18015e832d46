//! Feed scheduling: F words along the contour, so that the force stays where the points have seen it.
//!
//! | step | where |
//! |---|---|
//! | what the job allows, in numbers | [`Wanted`] |
//! | the largest feed under the limit beside every sample | `force` |
//! | the same as few steps: early down, late up, no chatter | `steps` |
//! | the feed at a place, and what becomes of a path | [`Schedule`] |
//! | what was gained and what it costs | [`FeedSummary`] |
//!
//! A correction is computed by a model whose parameters the probed places decide. Where the load is far from theirs the
//! model is extrapolated, and what an axial form error or a soft machine takes from the wall no displacement in X and
//! Y gives back. Both shrink with the chip. Off unless the job has a `[feed]` table; program route only: the
//! coprocessor scales its correction with the live feed and leaves the F words of its program alone.
//!
//! Limits: the force is the mean over a revolution at the engagement the program intends; the feed reaches the chip at
//! once; acceleration of the machine is not modelled.

mod force;
mod schedule;
mod steps;
mod summary;

pub use force::{Wanted, largest_force};
pub use schedule::{Schedule, schedule};
pub use steps::Change;
pub use summary::{FeedSummary, Unscheduled};
