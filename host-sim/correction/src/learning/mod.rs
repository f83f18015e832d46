//! Learning from part to part: what earlier parts showed, kept in one file, and what follows for the next.
//!
//! | step | where |
//! |---|---|
//! | parts in their order: points, the correction each was cut with, what was promised | [`History`] |
//! | what of job and program must be the same | [`Facts`] |
//! | machine and material from all parts together | [`joint()`] |
//! | what they show beside that model | [`discrepancy`](crate::discrepancy) |
//! | places left out of a first fit | `holdout` |
//! | whether a part was cut with the correction it is said to be cut with, if any | `uncorrected` |
//! | whether the newest part came out worse | `monitor` |
//! | what a new cutter will need | `cutter` |
//! | all of it, to the next correction | [`update()`] |
//!
//! A correction is always the whole one, written into the original program: corrections are never added up, so applying
//! one twice is impossible. `docs/learning.md` tells the method.
//!
//! | code | meaning |
//! |---|---|
//! | Q001 | no history, or not one that can be read |
//! | Q002 | a history of another job, program or feature |
//! | Q003 | a measurement that the history already holds |
//! | Q004 | a corrected program or image that is not the one of the history |
//! | Q005 | input and output folder are the same |
//! | Q006 | a law of correction that cannot learn |
//! | Q007 | points of a part that no correction was applied to |
//! | Q008 | points of a part that a correction was applied to, where none is expected |

mod cutter;
mod facts;
mod history;
mod holdout;
mod joint;
mod monitor;
mod moved;
mod nodes;
mod points;
mod uncorrected;
mod update;
mod verdict;

pub use cutter::Level;
pub use facts::Facts;
pub use history::{HISTORY, History, MOST_PARTS, Next, Part, WrittenFile};
pub use holdout::Residuals;
pub use joint::{Beside, Companion, Joint, PartPoints, joint};
pub use monitor::PartError;
pub use nodes::Nodes;
pub use points::Point;
pub use uncorrected::{refuse_corrected, refuse_uncorrected};
pub use update::{Update, update};
pub use verdict::{NewCutter, Promise, UnmodelledError, UsedAgain, Verdict};
