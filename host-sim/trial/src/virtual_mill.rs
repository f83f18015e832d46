//! The plant in the service of a pass: nominal path and cut handed over in float, and nothing of the model.

use truepath_core::gcode::Spindle;
use truepath_core::geometry::{Block, Point, Shape, Side};
use truepath_core::units::Real;
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;
use truepath_plant as plant;
use truepath_plant::{Milled, PlantError};

use crate::codes::L003;
use crate::recorded;
use crate::replay::Placement;
use crate::setpoints::Setpoints;

fn coordinates(p: Point) -> [f64; 2] {
    [p.x.nm() as f64 / 1e6, p.y.nm() as f64 / 1e6]
}

fn refused(error: &PlantError) -> Failure {
    L003.error(error.to_string(), "").into()
}

/// The nominal path of a pass for the plant.
fn path(pass: &Pass) -> Result<plant::Path, PlantError> {
    let segments: Vec<plant::Segment> = pass
        .blocks
        .iter()
        .map(|block| {
            let (from, to) = (coordinates(block.curve.start()), coordinates(block.curve.end()));
            match block.curve.shape() {
                Shape::Line => plant::Segment::Line { from, to },
                Shape::Arc { centre, sweep } => {
                    plant::Segment::Arc { from, to, centre: coordinates(centre), ccw: sweep > Real::ZERO }
                }
            }
        })
        .collect();
    let side = match pass.core.setup.wall {
        Side::Left => plant::Side::Left,
        Side::Right => plant::Side::Right,
    };
    plant::Path::new(&segments, side, 0.1)
}

/// The cut of a pass for the plant.
fn cut(pass: &Pass) -> plant::Cut {
    let setup = &pass.core.setup;
    let first = pass.blocks.first().map_or(0.0, |b| float(b.feed));
    let changes = pass.blocks.windows(2).filter(|w| w[0].feed != w[1].feed);
    plant::Cut {
        radius_mm: mm(setup.radius),
        teeth: setup.teeth.into(),
        helix_deg: float(setup.helix_deg),
        axial_depth_mm: float(setup.axial_depth),
        feed_mm_per_min: first,
        feed_changes: changes
            .map(|w| plant::FeedChange { from_s_mm: mm(w[1].s), feed_mm_per_min: float(w[1].feed) })
            .collect(),
        spindle_rpm: float(setup.spindle_rpm),
        allowance_mm: mm(setup.allowance),
        spindle: match pass.core.contour.spindle {
            Spindle::CounterClockwise => plant::Spindle::CounterClockwise,
            Spindle::Clockwise | Spindle::Stopped => plant::Spindle::Clockwise,
        },
        surface: pass.surface.as_ref().map(|surface| surface.points().to_vec()),
        memory_mm: Some(3.0),
    }
}

/// Mills a pass along its nominal path, or along commanded centres.
///
/// # Errors
/// What the plant refuses.
pub fn mill(pass: &Pass, machine: &plant::Machine, commanded: Option<&[plant::Point]>) -> Result<Milled, Failure> {
    let path = path(pass).map_err(|e| refused(&e))?;
    plant::mill(&path, &cut(pass), machine, commanded).map_err(|e| refused(&e))
}

/// Mills a pass with a corrected program: along its path and at its feeds.
///
/// # Errors
/// What the plant refuses, and whatever is wrong with the program.
pub fn mill_program(pass: &Pass, machine: &plant::Machine, text: &[u8]) -> Result<Milled, Failure> {
    let blocks = contour(pass, text)?;
    let path = path(pass).map_err(|e| refused(&e))?;
    let mut cut = cut(pass);
    if pass.job.numbers.cut.feed_mm_per_min.is_none() {
        (cut.feed_mm_per_min, cut.feed_changes) = feeds(&path, &blocks);
    }
    plant::mill(&path, &cut, machine, Some(&centres(&blocks))).map_err(|e| refused(&e))
}

/// Mills a pass along the path a controller was recorded on, at the feeds it had there.
///
/// # Errors
/// What the plant refuses, and a recording without such a pass.
pub fn mill_recorded(
    pass: &Pass,
    machine: &plant::Machine,
    setpoints: &Setpoints,
    placement: &Placement,
) -> Result<(Milled, recorded::Facts), Failure> {
    let path = path(pass).map_err(|e| refused(&e))?;
    let mut cut = cut(pass);
    let z_mm = pass.core.contour.z.nm() as f64 / 1e6;
    let found = recorded::cut_path(setpoints, placement, &path, &cut, z_mm)?;
    (cut.feed_mm_per_min, cut.feed_changes) = (found.feed_mm_per_min, found.feed_changes);
    let milled = plant::mill(&path, &cut, machine, Some(&found.centre)).map_err(|e| refused(&e))?;
    Ok((milled, found.facts))
}

/// How far beyond the length of a block its end is looked for, mm.
const DRIFT_MM: f64 = 2.0;

/// The feed at the start, and where it changes along the nominal path.
fn feeds(path: &plant::Path, blocks: &[Block]) -> (f64, Vec<plant::FeedChange>) {
    let mut at = 0;
    let mut feed = blocks.first().map_or(0.0, |b| float(b.feed));
    let first = feed;
    let mut changes = Vec::new();
    for block in blocks {
        if float(block.feed) != feed {
            feed = float(block.feed);
            changes.push(plant::FeedChange { from_s_mm: path.s_mm[at], feed_mm_per_min: feed });
        }
        // Where the block ends: the path may come near that place again later, so only a stretch onwards is looked at.
        let end = coordinates(block.curve.end());
        let off = |k: &usize| (path.centre[*k][0] - end[0]).hypot(path.centre[*k][1] - end[1]);
        let reach = path.s_mm[at] + 1.1 * mm(block.curve.length()) + DRIFT_MM;
        let stretch = (at..path.s_mm.len()).take_while(|k| path.s_mm[*k] <= reach);
        at = stretch.min_by(|a, b| off(a).total_cmp(&off(b))).unwrap_or(at);
    }
    (first, changes)
}

/// Touches a milled part and writes the file LinuxCNC's PROBEOPEN would.
///
/// # Errors
/// What the plant refuses.
pub fn probe(pass: &Pass, milled: &Milled, places_mm: &[f64], levels: &[f64], ball_mm: f64) -> Result<String, Failure> {
    probe_shifted(pass, milled, places_mm, levels, ball_mm, [0.0; 2])
}

/// The same after the datum has moved by `datum_mm` in x and y since the part was cut: every reading is off by that.
///
/// # Errors
/// What the plant refuses.
pub fn probe_shifted(
    pass: &Pass,
    milled: &Milled,
    places_mm: &[f64],
    levels: &[f64],
    ball_mm: f64,
    datum_mm: plant::Point,
) -> Result<String, Failure> {
    let plan = plant::ProbePlan {
        s_mm: places_mm.to_vec(),
        levels: levels.to_vec(),
        ball_diameter_mm: ball_mm,
        tip_z_mm: pass.core.contour.z.nm() as f64 / 1e6,
    };
    let mut touches = plant::probe(milled, &plan).map_err(|e| refused(&e))?;
    for touch in &mut touches {
        for (place, shift) in touch.ball_centre.iter_mut().zip(datum_mm) {
            *place += shift;
        }
    }
    Ok(plant::probeopen_text(&touches))
}

/// The commanded centres of a corrected program: the contour moves, sampled finely.
///
/// # Errors
/// Whatever is wrong with the program.
pub fn commanded(pass: &Pass, text: &[u8]) -> Result<Vec<plant::Point>, Failure> {
    Ok(centres(&contour(pass, text)?))
}

/// The contour of a corrected program.
fn contour(pass: &Pass, text: &[u8]) -> Result<Vec<Block>, Failure> {
    let source =
        truepath_ground::diagnostics::Source::new(format!("{} (corrected)", pass.program.name()), text.to_vec());
    Ok(truepath_job::pass::read_blocks(&source)?.0)
}

fn centres(blocks: &[Block]) -> Vec<plant::Point> {
    let mut points = Vec::new();
    for block in blocks {
        let pieces = (mm(block.curve.length()) / 0.02).ceil().max(1.0) as i64;
        let skip = i64::from(!points.is_empty());
        points.extend((skip..=pieces).map(|k| coordinates(block.curve.point(Real::ratio(k, pieces)))));
    }
    points
}
