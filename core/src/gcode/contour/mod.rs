//! Contours of a program: which of its cutting moves are one.
//!
//! | step | where |
//! |---|---|
//! | moves → runs of cutting moves | `run` |
//! | the one contour of a program, or of some of its lines | [`read_contour`] |
//! | a list from which to choose | [`find_contours`] |

mod candidate;
mod read;
mod run;

pub use candidate::{Candidate, find_contours};
pub use read::{ContourOptions, ContourProgram, read_contour};
