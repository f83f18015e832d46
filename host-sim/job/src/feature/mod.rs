//! Which cut of a program is corrected: named in the job, marked in the program, or searched for.
//!
//! | step | where |
//! |---|---|
//! | comments `(TRUEPATH BEGIN id)` … `(TRUEPATH END)` | `marker` |
//! | N words or line numbers → lines | `place` |
//! | the runs of cutting moves, whole or on some lines | `survey` |
//! | regions of the program that are features | `region` |
//! | several contours of which one may be none | `doubt` |
//! | the features and their passes | `plan` |
//! | what was found, as a list | `listing` |
//!
//! A program with one run of cutting moves, no markers and a job without `[[feature]]` needs none of this: the run is
//! the contour. Otherwise roughing, finishing and spring passes are told apart by [`truepath_core::gcode::search`].

mod choice;
mod doubt;
mod listing;
mod marker;
pub(crate) use marker::comments;
mod place;
mod plan;
mod region;
mod survey;

pub use listing::{FeatureSummary, PassRow, Row, listing};
pub use place::lines_named;
pub use plan::{FeaturePass, Plan, plan, plans};
pub(crate) use survey::LARGEST_SEARCH;
pub use survey::Survey;
