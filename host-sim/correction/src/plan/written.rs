//! One program with the processes chosen for the walls of a part.

use truepath_core::cut::Sample;
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::mm;
use truepath_job::job::Route;

use super::choice::{Designed, Planner};
use super::process::Cut;
use crate::codes::K007;
use crate::planned::{self, ArmedWall, PlannedPass, PlannedProgram, PlannedWall};
use crate::surface::wall::{WallFigures, WallMap};

/// A wall with the process chosen for it.
#[derive(Clone, Copy, Debug)]
pub struct Chosen<'a> {
    /// Wall and machine.
    pub planner: &'a Planner<'a>,
    /// The cuts.
    pub cuts: &'a [Cut],
    /// Number of the cutter in place of the program's own; `None` for that.
    pub cutter: Option<u32>,
}

/// The program of the processes.
#[derive(Clone, Debug)]
pub struct WrittenPlan {
    /// Its bytes, where its passes stand, and what was changed.
    pub program: PlannedProgram,
    /// What is expected of each wall.
    pub walls: Vec<WrittenWall>,
}

/// The wall that a written process leaves.
#[derive(Clone, Debug)]
pub struct WrittenWall {
    /// The figures of the wall of the identified machine.
    pub figures: WallFigures,
    /// That wall unrolled.
    pub map: WallMap,
    /// Its passes, in the order of cutting.
    pub passes: Vec<PlannedPass>,
    /// Largest distance of a commanded place from the programmed path, mm.
    pub largest_correction_mm: f64,
}

/// Designs the processes finely and writes one program with all of them, for a route; `probe` is the CRC-32 of the points.
/// `progress` is told the share done.
///
/// # Errors
/// `K007` for a choice of a cutter of another diameter, or of another cutter for the coprocessor, those of [`Planner::design`], of [`planned::write_every`] and of [`planned::write_armed`].
pub fn write(
    chosen: &[Chosen<'_>],
    route: Route,
    probe: u32,
    progress: &mut dyn FnMut(f64),
) -> Result<WrittenPlan, Failure> {
    for (one, cutter) in chosen.iter().filter_map(|one| Some((one, one.planner.cutter(one.cutter?)?))) {
        let found = if route == Route::Coprocessor {
            format!("the choice is cut with T{}, and an image is for the cutter of the program", cutter.number)
        } else if cutter.diameter != one.planner.diameter() {
            let (other, own) = (mm(cutter.diameter), mm(one.planner.diameter()));
            format!(
                "the choice is cut with T{}, whose diameter is {other} mm: its path is another one than that of the program, {own} mm",
                cutter.number
            )
        } else {
            continue;
        };
        return Err(K007
            .error(found, "a choice of the cutter of the program, or of one as wide by the program route")
            .told_in(one.planner.unit())
            .into());
    }
    let mut samples: Vec<Vec<Sample>> = chosen.iter().map(|_| Vec::new()).collect();
    let mut designed: Vec<Designed<'_>> = Vec::new();
    for (k, (one, samples)) in chosen.iter().zip(&mut samples).enumerate() {
        let told = &mut |share: f64| progress((k as f64 + share) / chosen.len() as f64);
        designed.push(one.planner.design((one.cuts, one.cutter), samples, told)?);
    }
    let largest = |one: &Designed<'_>| {
        let nodes = one.passes.iter().flat_map(|pass| &pass.nodes);
        nodes.map(|node| mm(node.total().length())).fold(0.0, f64::max)
    };
    let walls: Vec<PlannedWall<'_>> = designed
        .iter()
        .map(|one| PlannedWall { pass: one.pass, path: &one.path, passes: &one.passes, cutter: one.cutter })
        .collect();
    let program = match route {
        Route::Program => planned::write_every(&walls, Some(probe))?,
        Route::Coprocessor => {
            let both = walls.iter().zip(&designed);
            let armed = both.map(|(wall, one)| ArmedWall { wall: *wall, identified: one.identified });
            planned::write_armed(&armed.collect::<Vec<_>>())?
        }
    };
    let walls = designed.into_iter().map(|one| {
        let largest_correction_mm = largest(&one);
        WrittenWall { figures: one.wall, map: one.map, passes: one.passes, largest_correction_mm }
    });
    let walls = walls.collect();
    Ok(WrittenPlan { program, walls })
}
