//! Places along the path at which the walls of a pocket are predicted.

use truepath_core::geometry::{Block, Contour, Direction, FACET_TURN_LIMIT, Point, Shape, Side};
use truepath_core::units::{Offset, Real};
use truepath_ground::units::{float, mm};
use truepath_program::BlockEdit;

use super::error::PocketError;

/// One place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Station {
    /// Arc length of the nominal path, mm.
    pub s_mm: f64,
    /// Nominal centre, mm.
    pub point: [f64; 2],
    /// Unit normal towards the near wall.
    pub normal: [f64; 2],
    /// Unit direction of travel.
    pub heading: [f64; 2],
    /// Index of the block.
    pub block: usize,
    /// Line of the program.
    pub line: u32,
    /// Feed, mm/min.
    pub feed_mm_per_min: f64,
    /// Whether the block turns.
    pub turns: bool,
    /// Whether it lies so near to a sharp inside corner that no shift follows the load: the shift of the straight wall is
    /// held there.
    pub held: bool,
}

/// Samples of a slot's path: with 0.1 mm apart, 40 m.
pub const MOST_STATIONS: usize = 400_000;

/// How far from a sharp corner the shift of the wall is held, radii: as the core does on a finishing pass.
const HELD: f64 = 1.2;

/// Coordinates in mm.
pub fn coordinates(p: Point) -> [f64; 2] {
    [p.x.nm() as f64 / 1e6, p.y.nm() as f64 / 1e6]
}

/// Components.
pub fn components(d: Direction) -> [f64; 2] {
    [float(d.x), float(d.y)]
}

/// Whether a block is an arc.
pub const fn is_arc(block: &Block) -> bool {
    matches!(block.curve.shape(), Shape::Arc { .. })
}

/// Stations of a slot: even steps on every block; at a sharp corner one at the end of the block before and one at the
/// start of the next, at the same place.
///
/// # Errors
/// [`PocketError::TooLong`].
pub fn slot_stations(
    contour: &Contour,
    (near, radius): (Side, Offset),
    step: Offset,
) -> Result<Vec<Station>, PocketError> {
    let step = step.nm().max(1);
    let pieces = |block: &Block| (block.curve.length().nm() + step - 1).checked_div(step).unwrap_or(1).max(1);
    let needed: usize = contour.blocks().iter().map(|block| pieces(block) as usize + 2).sum();
    if needed > MOST_STATIONS {
        return Err(PocketError::TooLong { needed, most: MOST_STATIONS });
    }
    let start = contour.blocks().first().map_or(Offset::ZERO, |b| b.s);
    let mut stations: Vec<Station> = Vec::with_capacity(needed);
    let mut before: Option<Direction> = None;
    for (index, block) in contour.blocks().iter().enumerate() {
        let pieces = pieces(block);
        let sharp = before.is_none_or(|heading| heading.dot(block.curve.start_heading()) < FACET_TURN_LIMIT);
        for k in i64::from(!sharp)..=pieces {
            let fraction = Real::ratio(k, pieces);
            let heading = block.curve.heading(fraction);
            stations.push(Station {
                s_mm: mm(block.s - start + block.curve.length().scaled(fraction)),
                point: coordinates(block.curve.point(fraction)),
                normal: components(near.normal(heading)),
                heading: components(heading),
                block: index,
                line: block.line,
                feed_mm_per_min: float(block.feed),
                turns: is_arc(block),
                held: false,
            });
        }
        before = Some(block.curve.end_heading());
    }
    hold(&mut stations, HELD * mm(radius));
    Ok(stations)
}

/// Marks the stations around sharp corners.
fn hold(stations: &mut [Station], reach: f64) {
    let sharp = |i: usize| {
        let (a, b) = (&stations[i - 1], &stations[i]);
        a.point == b.point && a.heading[0] * b.heading[0] + a.heading[1] * b.heading[1] < 1.0 - 1e-9
    };
    let corners: Vec<usize> = (1..stations.len()).filter(|i| sharp(*i)).collect();
    for corner in corners {
        let at = stations[corner].s_mm;
        let (before, behind) = stations.split_at_mut(corner);
        let near = |s: &&mut Station| (s.s_mm - at).abs() <= reach;
        before.iter_mut().rev().take_while(near).for_each(|s| s.held = true);
        behind.iter_mut().take_while(near).for_each(|s| s.held = true);
    }
}

/// The shifted path of a slot, as the program writer wants it: one list of points per line of the program, from the end of the block before to its own end.
pub fn edits(stations: &[Station], vectors: &[[f64; 2]]) -> Vec<BlockEdit> {
    let nm = |v: f64| (v * 1e6).round() as i64;
    let mut edits: Vec<BlockEdit> = Vec::new();
    for (station, vector) in stations.iter().zip(vectors) {
        let point = [nm(station.point[0] + vector[0]), nm(station.point[1] + vector[1])];
        let before = edits.last().and_then(|edit| edit.samples.last().copied());
        match edits.last_mut() {
            Some(edit) if edit.line == station.line => {
                if before != Some(point) {
                    edit.samples.push(point);
                }
            }
            _ => {
                let mut points: Vec<[i64; 2]> = before.into_iter().filter(|b| *b != point).collect();
                points.push(point);
                edits.push(BlockEdit::new(station.line, points));
            }
        }
    }
    edits
}
