//! Several passes along one wall, with the stock as a field over contour and height.
//!
//! The model of one pass ([`crate::cut`]) takes an even allowance and one engagement angle for all heights. A pass that follows another meets
//! the wall that one left, which a helical cutter leaves different at every height. Here the remaining stock is held at every
//! sample and in every slice of the height; each pass is engaged where its circumference lies in what is left, in one
//! stretch or several, and takes its envelope from it:
//!
//! | piece | what it holds |
//! |---|---|
//! | [`Slices`] | the wall's height in even slices |
//! | [`Part`] | the stock that is left, sample by sample and slice by slice |
//! | [`ImmersionGrid`] | the immersion angles at which engagement is looked at |
//! | [`Mill`] | one machine at work: stock → depths → force → equilibrium → envelope |
//! | [`aim`] | the commanded displacements with which a pass leaves what it is meant to leave |
//!
//! Physics: the mean centre is in equilibrium with the mean force over a revolution; the wall at a height is made by the cutter in
//! equilibrium with the force and the engagement *of the instant* at which a tooth passes there. Under heavy cuts this is close to
//! the instant force at the mean engagement, which [`crate::cut`] uses; in a thin pass on a wavy wall only this is right, because the
//! tool yields before the force of the mean engagement is reached.
//!
//! Limits: rigid wall, no runout, no dynamics; chip thickness from the circular path; a raised tip lies on a border of slices.

mod aim;
mod depths;
mod grid;
mod mill;
mod part;
mod slices;

pub use aim::{Aim, AimWorkspace, Reached, aim};
pub use depths::Depths;
pub use grid::ImmersionGrid;
pub use mill::{Load, Mill, Order};
pub use part::{Part, Wall};
pub use slices::{MAX_SLICES, Slices};
