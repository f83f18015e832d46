//! The process of a pass: a finishing pass along its wall, or a slot along its path.

use truepath_core::correct::Law;
use truepath_core::cut::Path;
use truepath_job::pass::Pass;

use super::error::PocketError;
use super::machine::Machine;
use super::slot::Slot;
use super::station::{is_arc, slot_stations};
use super::wall::Wall;

/// The finishing pass of a job along its sampled path.
///
/// # Errors
/// A cutter that is not described.
pub fn finishing<'a>(pass: &Pass, path: &'a Path<'a>) -> Result<Wall<'a>, PocketError> {
    let machine = Machine::of(&pass.job)?;
    let blocks: Vec<(bool, u32)> = pass.blocks.iter().map(|block| (is_arc(block), block.line)).collect();
    let wanted = pass.job.numbers.design(Law::Model);
    Ok(Wall::new(path, &blocks, pass.core.coefficients(), &machine, wanted))
}

/// The slot of a job along its contour.
///
/// # Errors
/// A cutter that is not described, a path that is too long, a cutter too soft for it.
pub fn slotting(pass: &Pass) -> Result<Slot, PocketError> {
    let machine = Machine::of(&pass.job)?;
    let stations =
        slot_stations(&pass.path_contour(), (pass.core.setup.wall, pass.core.setup.radius), pass.core.step())?;
    Slot::new(stations, pass.core.setup, pass.core.coefficients(), machine)
}
