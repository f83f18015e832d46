//! From a measurement to a correction, and from part to part.
//!
//! | step | where |
//! |---|---|
//! | machine and material as other jobs of a shop let expect them | [`shop`] |
//! | cutter and stock as the points have them: runout, roughing that was pushed away | `told`: [`runout`], `roughing` |
//! | machine and material from the points | [`identification`] |
//! | the correction of an identified machine | [`correction`] |
//! | what parts show beside machine and material | [`discrepancy`] |
//! | the error of the whole wall, at every height | [`surface`] |
//! | points that are not of this job | [`misfit`] |
//! | what no correction brings a part below | [`floor`] |
//! | a whole correction with its programs, images and figures | [`correct`], [`summary`] |
//! | sharp inside corners, and arcs in their place | [`sharp_corners`], [`fillet`] |
//! | the second of two passes | [`first_pass`], [`second_pass`] |
//! | passes that hold the wall at every height | [`plan`] |
//! | the next part | [`learning`], [`learn`], [`as_milled`] |
//! | planned passes as a program | [`planned`] |
//! | where to touch, and the program that does | [`verification`] |
//! | where to touch next, by what was measured | [`further`] |
//! | accuracy from the measurement alone | [`inspection`] |

pub mod as_milled;
pub mod codes;
pub mod correct;
pub mod correction;
pub mod damped;
pub mod discrepancy;
pub mod edits;
pub mod feeds;
pub mod fillet;
pub mod first_pass;
pub mod floor;
pub mod force_tables;
pub mod further;
pub mod guard;
pub mod identification;
pub mod inspection;
pub mod learn;
pub mod learning;
pub mod misfit;
pub mod parallel_walls;
pub mod plan;
pub mod planned;
pub mod plausible;
pub mod remarks;
mod roughing;
pub mod rows;
pub mod runout;
mod seal;
pub mod second_pass;
pub mod sharp_corners;
pub mod shop;
pub mod summary;
pub mod surface;
mod told;
pub mod verification;
pub mod warnings;
mod written_out;
