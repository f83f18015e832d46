//! Finishing processes that hold a wall at every height: which passes, in which order, each with its own correction.
//!
//! A helical tooth makes the wall at each height at another instant and so under another force; no shift in x and y cures that, but
//! passes do. The search cuts candidate processes on the identified machine, stock as a field (see
//! [`truepath_core::process`]), and weighs machining time against the largest error anywhere on the wall.
//!
//! | piece | what it holds |
//! |---|---|
//! | [`refit`] | machine and material under the physics of several passes |
//! | [`process`] | what a process is: cuts with aim, levels, direction and feed |
//! | [`mod@bench`] | the identified machine, ready to cut processes at a resolution |
//! | [`limits`] | what a process has to keep |
//! | [`search`] | candidates, coarse to fine, and the front of time against error |
//! | [`confidence`] | how sure the predicted error is |
//! | [`wall`] | the wall that is left, and what makes its error |
//! | [`choice`] | the few processes a user chooses from |

pub mod bench;
pub mod choice;
pub mod confidence;
pub mod limits;
pub mod process;
pub mod refit;
pub mod search;
pub mod wall;
