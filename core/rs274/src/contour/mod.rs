//! Contours of a program: which of its cutting moves are one.
//!
//! | step | where |
//! |---|---|
//! | moves → runs of cutting moves | `run` |
//! | the one contour of a program, or of some of its lines | [`read_contour`] |
//! | what makes no wall: moves between cuts, facing | `idle` |
//! | a list from which to choose | [`find_contours`], [`visit_runs`] |
//! | what each of them is for: roughing, finishing, spring pass | [`search`] |

mod candidate;
mod idle;
mod read;
mod relation;
mod run;
mod search;
mod split;

pub use candidate::{Between, Candidate, find_contours, visit_runs};
pub use idle::Idle;
pub use read::{ContourOptions, ContourProgram, RunPart, read_contour};
pub use search::{Criteria, Found, Role, search};
