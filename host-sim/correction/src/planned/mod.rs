//! Planned passes as a program: the finishing contour gives way to the passes of a plan.
//!
//! | step | where |
//! |---|---|
//! | the program with every pass written out along the programmed path | [`truepath_program::passes`], with its proof |
//! | what is asked for and what is told of it | `plan` |
//! | each pass moved to where it is to run, leads carried along | `paths` |
//! | the text, and the proof that nothing else has moved | [`rewrite_program`] |
//! | for the coprocessor instead of both: what arms each pass, and its image | `images` |
//! | what was done, in words | `report` |
//!
//! All depths of the feature that are cut alike get the same passes; spring passes behind them are replaced as well. Lines in
//! subprograms and loops are written out first, as for every corrected program.

mod images;
mod paths;
mod plan;
mod report;

use truepath_core::checksum::crc32;
use truepath_core::cut::Path;
use truepath_core::gcode::{LineRange, program_crc};
use truepath_core::units::Offset;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::units::mm;
use truepath_job::job::PlanCutter;
use truepath_job::levels;
use truepath_job::pass::{Pass, PathBuffer};
use truepath_program::codes::{P002, P003, P005};
use truepath_program::passes::{Cutter, Depth, Repeated, RepeatedPass, Times, Turn, can_repeat, repeat_contours};
use truepath_program::{BlockEdit, Difference, Origin, RewriteOptions, Rewritten, rewrite_program};

use crate::feeds::written_feeds_count;
use crate::written_out::written_out;

use images::Laid;
pub use images::{ArmedWall, PassImage, image_name};
use paths::Leads;
pub use plan::{PlannedDepth, PlannedPass, PlannedWall};

/// A program with planned passes.
#[derive(Clone, Debug)]
pub struct PlannedProgram {
    /// Its bytes.
    pub text: Vec<u8>,
    /// Where the passes stand.
    pub depths: Vec<PlannedDepth>,
    /// What moving the passes has changed, against the programmed path written out; `None` where the coprocessor moves them.
    pub difference: Option<Difference>,
    /// For the coprocessor, an image of every pass in the order of cutting.
    pub images: Vec<PassImage>,
    /// `difference.txt`.
    pub report: String,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Writes the program of a wall with its plan; `probe` is the CRC-32 of the points that the plan comes from.
///
/// # Errors
/// As [`write_every`].
pub fn write(
    pass: &Pass,
    path: &Path<'_>,
    passes: &[PlannedPass],
    probe: Option<u32>,
) -> Result<PlannedProgram, Failure> {
    write_every(&[PlannedWall { pass, path, passes, cutter: None }], probe)
}

/// Writes one program with the plans of all walls of a part. A wall whose correction is one pass has a plan of one.
///
/// # Errors
/// `P004` for a contour executed several times that cannot be written out, `P006` for feeds that cannot be written,
/// `P007` for compensation beyond the leads, `P009` for a contour that cannot be cut in several passes, `P010` for a pass that
/// cannot run the other way, `P011` for a change of the cutter that cannot be written, `J008` for a changed feed where the F words are not those of the cut, and whatever
/// [`rewrite_program`] refuses.
pub fn write_every(walls: &[PlannedWall<'_>], probe: Option<u32>) -> Result<PlannedProgram, Failure> {
    let (planned, mut warnings) = laid_out(walls, false)?;
    let first = &planned.original;
    let original = program_crc(first.bytes());
    let written = match planned.moved(walls, original, probe, Leads::Carried) {
        Err(Failure::Input(error)) if [P002, P003, P005].iter().any(|row| row.code == error.code()) => {
            warnings.push(format!(
                "{}: what comes before the contour or behind it cannot be moved: the leads begin and end where they did, and each pass comes to its path along them",
                first.name()
            ));
            planned.moved(walls, original, probe, Leads::Kept)?
        }
        written => written?,
    };
    let depths = planned.depths(|lines| {
        let lines = written.lines(lines);
        [lines.first, lines.last]
    });
    let report = report::moved(first.name(), walls, &depths, &written);
    let (text, difference) = (written.text, Some(written.difference));
    Ok(PlannedProgram { text, depths, difference, images: Vec::new(), report, warnings })
}

/// Writes one program with the passes of all walls along the programmed path, each armed on its own, and the images with
/// which the coprocessor moves them.
///
/// # Errors
/// As [`write_every`]; `P022` for a control that cannot arm each pass, `P009` where the cutter comes to the contour on a ramp, a correction
/// beyond the clamp at a feed that the image allows, and a job without the number of the tool.
pub fn write_armed(walls: &[ArmedWall<'_>]) -> Result<PlannedProgram, Failure> {
    let own: Vec<PlannedWall<'_>> = walls.iter().map(|wall| wall.wall).collect();
    if let Some(wall) = own.first() {
        images::check_control(wall.pass)?;
    }
    let (planned, mut warnings) = laid_out(&own, true)?;
    let laid = Laid {
        repeated: &planned.repeated,
        walls: planned.places.iter().map(|(wall, _)| *wall).collect(),
        passes: &planned.passes,
    };
    let armed = images::arm(walls, &laid)?;
    warnings.extend(armed.warnings);
    let depths = planned.depths(|lines| armed.announced.lines(lines));
    let report = report::armed(planned.original.name(), &own, &depths, &armed.images);
    let (text, images) = (armed.announced.text, armed.images);
    Ok(PlannedProgram { text, depths, difference: None, images, report, warnings })
}

/// Checks the plans and writes out the passes of all depths, with what the user should know.
fn laid_out(walls: &[PlannedWall<'_>], announced: bool) -> Result<(Planned, Vec<String>), Failure> {
    for wall in walls {
        checked(wall)?;
    }
    let mut warnings = Vec::new();
    let passes: Vec<&Pass> = walls.iter().map(|wall| wall.pass).collect();
    let planned = match repeated(walls, &passes, announced) {
        Ok(planned) => planned,
        Err(failure) => {
            let (flat, said) = written_out(&passes, &failure).ok_or(failure)?;
            warnings.push(said);
            repeated(walls, &flat.iter().collect::<Vec<_>>(), announced)?
        }
    };
    warnings.extend(planned.left.iter().cloned());
    if walls.iter().any(|wall| wall.pass.job.feed.is_some()) {
        warnings.push("[feed] of the job has no part in planned passes: each has the feed of the plan".to_owned());
    }
    Ok((planned, warnings))
}

/// Whether the contour of a pass can be cut in several passes in the direction of the program.
///
/// # Errors
/// As [`write()`].
pub fn can_repeat_pass(pass: &Pass) -> Result<(), Failure> {
    times(pass, &in_turn(&[false, false]), false).map(|_| ())
}

/// Whether the coprocessor can be armed for each of several passes along the contour of a pass.
///
/// # Errors
/// As [`write_armed`].
pub fn can_arm(pass: &Pass) -> Result<(), Failure> {
    images::check_control(pass)?;
    times(pass, &in_turn(&[false, false]), true).map(|_| ())
}

/// Whether a pass along the contour can run against the direction of the program. Where there is no lead-out that ends off the
/// wall, [`write()`] further wants a pass in the direction of the program at the same depth or below right before it.
///
/// # Errors
/// As [`write()`]; `P010` where the reason is the direction.
pub fn can_reverse(pass: &Pass) -> Result<(), Failure> {
    times(pass, &in_turn(&[false, true]), false).map(|_| ())
}

fn in_turn(reversed: &[bool]) -> Vec<Turn> {
    reversed.iter().map(|&reversed| Turn { raise: Offset::ZERO, reversed, feed: 1.0 }).collect()
}

/// How long passes in the place of a contour take, each `announced` to the coprocessor or not, at the programmed feed; what they are moved
/// by is not looked at.
///
/// # Errors
/// As [`write()`], where they cannot follow each other.
pub fn times(pass: &Pass, turns: &[Turn], announced: bool) -> Result<Times, Failure> {
    let tried = |pass: &Pass| {
        can_repeat(&pass.program, &depth(pass, turns.to_vec(), announced, None)?, pass.job.numbers.program_options())
    };
    match tried(pass) {
        Err(failure) => {
            let (flat, _) = written_out(&[pass], &failure).ok_or(failure)?;
            tried(flat.first().unwrap_or(pass))
        }
        times => times,
    }
}

/// A plan that can be meant.
fn checked(wall: &PlannedWall<'_>) -> Result<(), Failure> {
    let wrong = |what: &str| Err(Failure::Internal(format!("a plan {what}")));
    let raised = |pass: &PlannedPass| pass.raise != Offset::ZERO;
    if wall.passes.last().is_none_or(raised) {
        return wrong("whose last pass does not finish the wall");
    }
    for pass in wall.passes {
        if pass.nodes.len() != wall.path.count() {
            return wrong("for another contour");
        }
        if pass.raise < Offset::ZERO || !(pass.feed.is_finite() && pass.feed > 0.0) {
            return wrong("below the programmed depth, or without a feed");
        }
    }
    if wall.passes.iter().any(|pass| pass.feed != 1.0) {
        written_feeds_count(wall.pass, "the plan changes F words", "plan without other feeds")?;
    }
    Ok(())
}

/// The passes of walls along the programmed path, and the programs they come from.
struct Planned {
    repeated: Repeated,
    /// Wall and level of every depth.
    places: Vec<(usize, u32)>,
    /// The passes of the depths, on the program that was repeated.
    passes: Vec<Pass>,
    left: Vec<String>,
    /// The program of the user.
    original: Source,
}

/// One depth as the program writer wants it.
fn depth(pass: &Pass, turns: Vec<Turn>, announced: bool, cutter: Option<&PlanCutter>) -> Result<Depth, Failure> {
    let level = pass.level();
    let springs = pass.plan.iter().flat_map(|plan| &plan.passes).filter(|one| one.spring && one.number == level);
    let springs = springs.map(|one| Ok(pass.along(one, pass.job.numbers.wall)?.blocks));
    Ok(Depth {
        contour: pass.blocks.clone(),
        springs: springs.collect::<Result<_, Failure>>()?,
        allowance: pass.core.setup.allowance,
        turns,
        announced,
        cutter: cutter.map(|cutter| Cutter {
            number: cutter.number,
            own: pass.job.numbers.tool.number,
            words: report::words_of(cutter),
        }),
    })
}

/// Writes out the passes of all depths; `passes` are those of the walls, or the same of another text of the program.
fn repeated(walls: &[PlannedWall<'_>], passes: &[&Pass], announced: bool) -> Result<Planned, Failure> {
    let (mut depths, mut places, mut own, mut left) = (Vec::new(), Vec::new(), Vec::new(), Vec::new());
    for (at, (wall, pass)) in walls.iter().zip(passes).enumerate() {
        let turns: Vec<Turn> = wall.passes.iter().map(PlannedPass::turn).collect();
        // Depths are compared at the step of all passes, which that of a plan need not be.
        let mut buffer = PathBuffer::default();
        let sampled = pass.sample(&mut buffer)?.with_law(wall.path.setup().law);
        let levels = levels::each(pass, &sampled, |level, pass, _| {
            depths.push(depth(pass, turns.clone(), announced, wall.cutter)?);
            places.push((at, level));
            own.push(pass.clone());
            Ok(())
        })?;
        left.extend(levels.left);
    }
    let (first, wall) =
        passes.first().zip(walls.first()).ok_or_else(|| Failure::Internal("no wall to be planned".to_owned()))?;
    let repeated = repeat_contours(&first.program, &depths, first.job.numbers.program_options())?;
    Ok(Planned { repeated, places, passes: own, left, original: wall.pass.program.clone() })
}

impl Planned {
    /// Moves every pass to where it is to run.
    fn moved(
        &self,
        walls: &[PlannedWall<'_>],
        original: u32,
        probe: Option<u32>,
        leads: Leads,
    ) -> Result<Rewritten, Failure> {
        let mut edits: Vec<BlockEdit> = Vec::new();
        for ((depth, (wall, _)), pass) in self.repeated.depths.iter().zip(&self.places).zip(&self.passes) {
            let wall = &walls[*wall];
            let mut before: Option<(bool, &RepeatedPass)> = None;
            for (planned, written) in wall.passes.iter().zip(&depth.passes) {
                let mut own = paths::edits(pass, wall.path, planned, written, leads)?;
                if let Some((reversed, earlier)) = before.replace((planned.reversed, written)) {
                    let end = edits.last().and_then(|edit| edit.samples.last().copied());
                    paths::meet(earlier, written, [reversed, planned.reversed], end, &mut own);
                }
                edits.append(&mut own);
            }
        }
        // Each depth has its lines in the order of cutting, and depths follow each other in that of the program.
        let begins =
            |line: u32| self.repeated.depths.iter().find(|d| d.written.contains(line)).map(|d| d.written.first);
        edits.sort_by_key(|edit| begins(edit.line));
        let pass = self.passes.first().ok_or_else(|| Failure::Internal("no wall to be planned".to_owned()))?;
        let mut notes = report::notes(walls);
        if self.repeated.depths.iter().any(|depth| depth.centre_path) {
            let (radius, name) = (pass.unit().of(mm(pass.core.setup.radius)), pass.unit().name());
            notes.push(format!(
                "path of the cutter centre: the cutter radius of {radius} {name} is part of it, D is not used"
            ));
        }
        let job = &pass.job;
        let options = RewriteOptions {
            tolerance: job.tolerance,
            max_arc_radius: job.max_arc_radius,
            max_kink_deg: job.max_kink_deg,
            program: job.numbers.program_options(),
            origin: Origin { program: Some(original), job: Some(crc32(job.source().bytes())), probe },
            notes,
            ..RewriteOptions::default()
        };
        let source = Source::new(pass.program.name(), self.repeated.text.clone());
        rewrite_program(&source, &edits, &options)
    }

    /// Where the passes stand in the written program, whose `lines` those of the passes along the programmed path have become.
    fn depths(&self, lines: impl Fn(LineRange) -> [u32; 2]) -> Vec<PlannedDepth> {
        let depth = |(depth, &(wall, level)): (&truepath_program::passes::RepeatedDepth, &(usize, u32))| PlannedDepth {
            wall,
            level,
            replaced: [depth.replaced.first, depth.replaced.last],
            passes: depth.passes.iter().map(|pass| lines(pass.lines)).collect(),
            z_mm: depth.passes.iter().map(|pass| pass.z_nm as f64 / 1e6).collect(),
        };
        self.repeated.depths.iter().zip(&self.places).map(depth).collect()
    }
}
