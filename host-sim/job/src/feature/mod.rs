//! Which cut of a program is corrected: named in the job, marked in the program, or searched for.
//!
//! | step | where |
//! |---|---|
//! | comments `(TRUEPATH BEGIN id)` … `(TRUEPATH END)` | `marker` |
//! | N words or line numbers → lines | `place` |
//! | the runs of cutting moves, whole or on some lines | `survey` |
//! | regions of the program that are features | `region` |
//! | the one feature and its passes | `plan` |
//! | what was found, as a list | `listing` |
//!
//! A program with one run of cutting moves, no markers and a job without `[[feature]]` needs none of this: the run is
//! the contour. Otherwise roughing, finishing and spring passes are told apart by [`truepath_core::gcode::search`].
//!
//! | code | meaning |
//! |---|---|
//! | N001 | several features can be corrected, and none is named |
//! | N002 | no feature of that name |
//! | N003 | a marker BEGIN inside another feature |
//! | N004 | a marker END without its BEGIN, or of another name |
//! | N005 | a marker BEGIN without its END |
//! | N006 | a name used by two markers |
//! | N007 | a feature whose markers are missing, or markers of a feature the job does not know |
//! | N008 | a block number that the program does not have, or has several times |
//! | N009 | heights of passes that differ from those of the job |
//! | N010 | several finishing contours in one feature |
//! | N011 | nothing to correct: no cut of the tool, or a role that is not corrected |
//! | N012 | no pass of that number |
//! | G071 | several finishing contours in a program that names none |

mod choice;
mod listing;
mod marker;
mod place;
mod plan;
mod region;
mod survey;

pub use listing::{FeatureSummary, PassRow, Row, listing};
pub use place::lines_named;
pub use plan::{FeaturePass, Plan, plan};
pub use survey::Survey;
