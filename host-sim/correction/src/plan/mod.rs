//! Finishing processes that hold a wall at every height: which passes, in which order, each with its own correction.
//!
//! A helical tooth makes the wall at each height at another instant and so under another force; no shift in x and y cures that, but
//! passes do. The search cuts candidate processes on the identified machine, stock as a field (see
//! [`truepath_core::process`]), and weighs machining time against the largest error anywhere on the wall.
//!
//! | piece | what it holds |
//! |---|---|
//! | [`refit`] | machine and material under the physics of several passes |
//! | [`mounted`] | the cutters that are at hand: path, machine and engagement of each |
//! | [`process`] | what a process is: cuts with aim, levels, direction and feed |
//! | [`mod@bench`] | the identified machine, ready to cut processes at a resolution |
//! | [`times`] | how long a process takes, and whether it can be written |
//! | [`limits`] | what a pass has to keep |
//! | [`search`] | candidates, coarse to fine, and the front of time against error |
//! | [`choice`] | the few processes a user chooses from |
//! | [`written`] | the program of those that were chosen |
//! | [`history`] | parts that planned programs have cut, and how the next is cut |
//! | [`joint`] | machine and material from all passes of all parts |
//! | [`field`] | what these show beside the machine, over arc length and height |
//! | [`learn`] | from the points of a planned part to the program of the next |
//!
//! What is left of the wall, how sure that is and what makes it: [`crate::surface`].

pub mod bench;
pub mod choice;
pub mod field;
pub mod history;
pub mod joint;
pub mod learn;
pub mod limits;
pub mod mounted;
pub mod process;
pub mod refit;
pub mod search;
pub mod times;
pub mod written;
