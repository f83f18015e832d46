//! What was written in the place of a contour, for people.

use std::fmt::Write as _;

use truepath_ground::count::counted;
use truepath_ground::hypotenuse::hypot;
use truepath_ground::length::Unit;
use truepath_ground::units::{float, mm};
use truepath_job::job::PlanCutter;
use truepath_program::Rewritten;

use super::images::{PassImage, image_name};
use super::plan::{PlannedDepth, PlannedPass, PlannedWall};

/// Remarks for the head of the program.
pub(super) fn notes(walls: &[PlannedWall<'_>]) -> Vec<String> {
    let note = |wall: &PlannedWall<'_>| {
        let with = wall.cutter.map_or_else(String::new, |cutter| format!(" with T{}", cutter.number));
        format!("planned: {} along the finished wall{with}", counted(wall.passes.len(), "pass"))
    };
    walls.iter().map(note).collect()
}

/// What a cutter is, for a comment of the program.
pub(super) fn words_of(cutter: &PlanCutter) -> String {
    let (diameter, helix) = (mm(cutter.diameter), float(cutter.helix_deg));
    format!("DIAMETER {diameter} MM, {} TEETH, HELIX {helix} DEGREES", cutter.teeth)
}

/// `difference.txt` of passes that were moved in the program.
pub(super) fn moved(original: &str, walls: &[PlannedWall<'_>], depths: &[PlannedDepth], written: &Rewritten) -> String {
    passes(original, walls, depths)
        + "\nThe program with these passes along the programmed path and the original were read and compared step by step:\n\
           beside these lines every step, mode and byte is the same, and every pass cuts the lines and arcs of the original\n\
           at its height and feed. Then the passes were moved:\n\n"
        + &written.difference.text("the passes along the programmed path", unit_of(walls))
}

/// `difference.txt` of passes that the coprocessor moves.
pub(super) fn armed(
    original: &str,
    walls: &[PlannedWall<'_>],
    depths: &[PlannedDepth],
    images: &[PassImage],
) -> String {
    let mut text = passes(original, walls, depths)
        + "\nThe program without M160 and the original were read and compared step by step: beside these lines every step, mode\n\
           and byte is the same, and every pass cuts the lines and arcs of the original at its height and feed. The coprocessor\n\
           moves them, each by its image:\n\n";
    for (k, image) in images.iter().enumerate() {
        let _ = writeln!(text, "  {}  M160 P{}.{}", image_name(k + 1), image.feature, image.pass);
    }
    text
}

/// The unit of their program.
fn unit_of(walls: &[PlannedWall<'_>]) -> Unit {
    walls.first().map(|wall| wall.pass.unit()).unwrap_or_default()
}

/// The passes and their lines.
fn passes(original: &str, walls: &[PlannedWall<'_>], depths: &[PlannedDepth]) -> String {
    let (mut text, unit) = (format!("{original} with planned passes\n\n"), unit_of(walls));
    // Writing to a String cannot fail.
    for depth in depths {
        let [first, last] = depth.replaced;
        let PlannedWall { passes, cutter, .. } = &walls[depth.wall];
        let with = cutter.map_or_else(String::new, |cutter| format!(" of T{}", cutter.number));
        let _ = writeln!(text, "lines {first}-{last} of the original became {}{with}:", counted(passes.len(), "pass"));
        for (k, (pass, lines)) in passes.iter().zip(&depth.passes).enumerate() {
            let _ = writeln!(
                text,
                "  pass {} lines {}-{} Z{:.4} {}, {}{}",
                k + 1,
                lines[0],
                lines[1],
                unit.of(depth.z_mm[k]),
                unit.name(),
                way(pass),
                extent(pass, unit)
            );
        }
    }
    text
}

fn way(pass: &PlannedPass) -> String {
    let direction = if pass.reversed { "against the programmed direction" } else { "in the programmed direction" };
    format!("{direction}, feed {:.0} %", pass.feed * 100.0)
}

fn extent(pass: &PlannedPass, unit: Unit) -> String {
    let sizes = pass.nodes.iter().map(|node| {
        let total = node.total();
        hypot(total.x.nm() as f64, total.y.nm() as f64) / 1e6
    });
    format!(", moved by up to {:.4} {}", unit.of(sizes.fold(0.0, f64::max)), unit.name())
}
