//! Contours of a program: which of its cutting moves are one.
//!
//! | step | where |
//! |---|---|
//! | moves → runs of cutting moves | `run` |
//! | the one contour of a program, or of some of its lines | [`read_contour`] |
//! | what is told of each in that list | [`Found`], [`Role`] |
//! | what makes no wall: moves between cuts, facing | `idle` |
//! | a list from which to choose | [`find_contours`], [`visit_runs`] |
//! | what each of them is for: roughing, finishing, spring pass | [`search`] |

mod candidate;
mod found;
mod idle;
mod read;
mod relation;
mod run;
mod search;
mod split;

pub use candidate::{Candidate, find_contours, visit_runs};
pub use found::{Criteria, Found, Idle, Role};
pub use read::{ContourOptions, ContourProgram, RunPart, read_contour};
pub use run::Between;
pub use search::search;
