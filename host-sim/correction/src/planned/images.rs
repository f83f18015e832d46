//! Planned passes for the coprocessor: the program with every pass along the programmed path, and an image for each.
//!
//! The program is bound to its images by its bytes, so every pass is armed on its own: `M160 P<feature>.<pass>` stands before the way
//! down to it, where nothing is armed and the cutter is above its start. The passes of a feature count on from depth to depth.
//!
//! Limits: a control that arms from the program (LinuxCNC), and no more passes of a feature than `M160` can name. What a pass is
//! displaced by scales with the live feed as a whole, though some of it is what the pass is to leave.

use std::collections::BTreeMap;
use std::path::Path as FilePath;

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::gcode::program_crc;
use truepath_core::geometry::Vector;
use truepath_core::image::{DEVICE_NODES, FineOffset, Image, ImageError, ImageNode, build, image_bytes};
use truepath_core::job::{self, Identified, Part};
use truepath_core::probe::MOST_ALIKE;
use truepath_core::units::{Offset, Position};
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_job::pass::Pass;
use truepath_program::passes::{Announced, Repeated};

use super::plan::{PlannedPass, PlannedWall};
use crate::codes::P022;

/// What arms, on LinuxCNC.
const ARM: i64 = 160;
/// The tenths of P are the pass.
const MOST_PASSES: u32 = 9;

/// A wall with its plan, and the machine that it was made for.
#[derive(Clone, Copy, Debug)]
pub struct ArmedWall<'a> {
    /// Wall and plan.
    pub wall: PlannedWall<'a>,
    /// Machine and material: how the correction follows the feed.
    pub identified: &'a Identified,
}

/// The image of one pass.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PassImage {
    /// The feature it belongs to.
    pub feature: u32,
    /// The pass of that feature, as `M160` names it.
    pub pass: u32,
    /// Its bytes.
    pub bytes: Vec<u8>,
}

/// File of the image of a pass, counted from 1 in the order of cutting.
pub fn image_name(number: usize) -> String {
    format!("planned-{number}.tpi")
}

/// Where the passes of walls lie: the depths of the program that they were written into.
pub(super) struct Laid<'a> {
    pub(super) repeated: &'a Repeated,
    /// Wall of every depth.
    pub(super) walls: Vec<usize>,
    /// The pass of the program at every depth.
    pub(super) passes: &'a [Pass],
}

/// The program with what arms each pass, and the images in the order of cutting.
pub(super) struct Armed {
    pub(super) announced: Announced,
    pub(super) images: Vec<PassImage>,
    pub(super) warnings: Vec<String>,
}

/// Refuses a control that cannot arm one pass after the other.
///
/// # Errors
/// `P022`.
pub(super) fn check_control(pass: &Pass) -> Result<(), Failure> {
    match pass.job.probe_control {
        Some("linuxcnc") => Ok(()),
        control => {
            let found = match control {
                Some(name) => format!("the program is for {name}, and each planned pass is armed by M160 of LinuxCNC"),
                None => "job and program do not say that the control is LinuxCNC, whose M160 arms each planned pass"
                    .to_owned(),
            };
            let error = InputError::new(P022, found, "a program for LinuxCNC", P022.remedy);
            Err(error.in_file(FilePath::new(pass.program.name())).into())
        }
    }
}

/// Numbers the passes, writes what arms them, and makes their images.
pub(super) fn arm(walls: &[ArmedWall<'_>], laid: &Laid<'_>) -> Result<Armed, Failure> {
    let numbers = numbered(laid)?;
    let words = |depth: usize, pass: usize| {
        let (feature, number) = numbers[depth][pass];
        format!("M{ARM} P{feature}.{number}")
    };
    let first = laid.passes.first().ok_or_else(|| Failure::Internal("no wall to be armed".to_owned()))?;
    let announced = laid.repeated.announced(ARM, words).map_err(|text| {
        let found = format!("`{text}` arms the coprocessor and does something else");
        InputError::new(P022, found, "M160 on a line of its own, or none: every pass has its own", P022.remedy)
            .in_file(FilePath::new(first.program.name()))
    })?;
    let crc = program_crc(&announced.text);
    let mut images = Vec::new();
    for ((depth, (&at, pass)), numbers) in
        laid.repeated.depths.iter().zip(laid.walls.iter().zip(laid.passes)).zip(&numbers)
    {
        let ArmedWall { wall, identified } = &walls[at];
        for ((planned, written), &(feature, number)) in wall.passes.iter().zip(&depth.passes).zip(numbers) {
            let mut own = pass.clone();
            own.core.program_crc = crc;
            own.core.contour.z = Position::from_nm(written.z_nm);
            own.core.job.part = Some(Part { feature, pass: number, ..own.core.job.part.unwrap_or(WHOLE) });
            let bytes = image(&own, identified, wall.path, planned)?;
            images.push((written.down, PassImage { feature, pass: number, bytes }));
        }
    }
    images.sort_unstable_by_key(|(line, _)| *line);
    let images = images.into_iter().map(|(_, image)| image).collect();
    let said =
        |own: &String| format!("{}: \"{own}\" is a comment now: M160 stands before each pass", first.program.name());
    let warnings = announced.taken_out.iter().map(said).collect();
    Ok(Armed { announced, images, warnings })
}

/// The part of a program with one contour.
const WHOLE: Part = Part { feature: 1, pass: 1, run: 1, first_block: 0, blocks: 1, alike: [Offset::ZERO; MOST_ALIKE] };

/// Feature and number of every pass of every depth; they count in the order of cutting.
fn numbered(laid: &Laid<'_>) -> Result<Vec<Vec<(u32, u32)>>, Failure> {
    let depths = &laid.repeated.depths;
    let mut order: Vec<usize> = (0..depths.len()).collect();
    order.sort_unstable_by_key(|at| depths[*at].written.first);
    let mut counts = BTreeMap::new();
    let mut numbers = vec![Vec::new(); depths.len()];
    for at in order {
        let pass = &laid.passes[at];
        let feature = pass.job.numbers.part.map_or(1, |part| part.feature);
        let count: &mut u32 = counts.entry(feature).or_default();
        for _ in &depths[at].passes {
            *count += 1;
            numbers[at].push((feature, *count));
        }
        if *count > MOST_PASSES {
            let found = format!("feature {feature} would have more passes than {MOST_PASSES} over all its depths");
            let expected = format!("at most {MOST_PASSES}: the tenths of P in M160 are the pass");
            let error = InputError::new(P022, found, expected, "choose a plan with fewer passes, or the program route");
            return Err(error.in_file(FilePath::new(pass.program.name())).into());
        }
    }
    Ok(numbers)
}

/// The image of a pass: its nodes in its own direction of travel, at its own feed.
fn image(pass: &Pass, identified: &Identified, path: &Path<'_>, planned: &PlannedPass) -> Result<Vec<u8>, Failure> {
    let mut nodes: Vec<Node> = planned.nodes.clone();
    let mut bytes = vec![0; image_bytes(DEVICE_NODES)];
    let (core, blocks) = (&pass.core, &pass.blocks);
    let written = job::to_nominal_feed(core, identified, path, blocks, &mut nodes)
        .and_then(|()| job::write_image(core, identified, path, blocks, &nodes, &mut bytes))
        .map_err(|error| pass.refused(&error))?;
    bytes.truncate(written.bytes);
    let internal = |error: ImageError| Failure::Internal(error.to_string());
    let forwards = Image::new_checked(&bytes).map_err(internal)?;
    let mut settings = *forwards.settings();
    let per_tooth = f64::from(settings.feed.per_tooth.bits()) * planned.feed;
    settings.feed.per_tooth = FineOffset::from_bits(per_tooth.round() as i32);
    let origin = forwards.header().origin;
    let mut nodes: Vec<ImageNode> = forwards
        .nodes()
        .map(|node| ImageNode {
            point: origin + Vector::from_nm(node.x.into(), node.y.into()),
            chip: node.chip,
            edge: node.edge,
        })
        .collect();
    if planned.reversed {
        nodes.reverse();
    }
    let mut own = vec![0; bytes.len()];
    build(&settings, &nodes, &mut own).map_err(internal)?;
    pass.job.signed(own)
}
