//! The corrected centre path, as the program writer wants it.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::geometry::{Block, Point, Vector};
use truepath_core::units::{Offset, Real};
use truepath_job::feed::Schedule;
use truepath_job::pass::Pass;
use truepath_program::{BlockEdit, FeedFrom};

/// Distance of points along a lead.
const STEP_NM: i64 = 100_000;

/// The correction at an arc length: between the two samples that enclose it, or, where several stand on the spot of a
/// sharp corner, that of the first of them (the end of the block before) or of the last (the start of the next).
fn correction_at(path: &Path, nodes: &[Node], s: Offset, ends_block: bool) -> Vector {
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let last = samples.len() - 1;
    if ends_block {
        let at = samples.partition_point(|x| x.s < s).min(last);
        if samples[at].s == s {
            return nodes[at].total();
        }
    }
    let after = samples.partition_point(|x| x.s <= s).clamp(1, last);
    let (a, b) = (&samples[after - 1], &samples[after]);
    let u = (s - a.s).over(b.s - a.s).max(Real::ZERO).min(Real::ONE);
    let (from, to) = (nodes[after - 1].total(), nodes[after].total());
    from + (to - from).scaled(u)
}

/// The corrected path, one list of points per line of the program, from the end of the block before to its own end. Where
/// the moves that lead to the contour and away from it are known, the correction comes and goes along them.
pub fn block_edits(pass: &Pass, path: &Path, nodes: &[Node], schedule: Option<&Schedule>) -> Vec<BlockEdit> {
    written_with(pass, pass.leads(), path, (nodes, schedule), tapered)
}

/// The share of a correction that comes and goes along a lead.
fn tapered(u: Real) -> Real {
    u * u * (Real::from_int(3) - u - u)
}

/// The same with leads along which the correction comes and goes, so that they begin and end where they did.
pub fn tapered_edits(pass: &Pass, leads: [&[Block]; 2], path: &Path, nodes: &[Node]) -> Vec<BlockEdit> {
    written_with(pass, leads, path, (nodes, None), tapered)
}

/// The same with leads that are moved as they are, by what the contour is moved at their end.
pub fn carried_edits(pass: &Pass, leads: [&[Block]; 2], path: &Path, nodes: &[Node]) -> Vec<BlockEdit> {
    written_with(pass, leads, path, (nodes, None), |_| Real::ONE)
}

/// `share` is the part of the correction along a lead, from 0 far from the contour to 1 beside it.
fn written_with(
    pass: &Pass,
    [lead_in, lead_out]: [&[Block]; 2],
    path: &Path,
    (nodes, schedule): (&[Node], Option<&Schedule>),
    share: impl Fn(Real) -> Real,
) -> Vec<BlockEdit> {
    let mut edits: Vec<BlockEdit> = Vec::new();
    if let Some(first) = pass.blocks.first() {
        lead(lead_in, correction_at(path, nodes, first.s, false), &share, &mut edits);
    }
    contour(pass, path, (nodes, schedule), &mut edits);
    if let Some(last) = pass.blocks.last() {
        let full = correction_at(path, nodes, last.s + last.curve.length(), true);
        lead(lead_out, full, |u| share(Real::ONE - u), &mut edits);
    }
    edits
}

const fn raw(p: Point) -> [i64; 2] {
    [p.x.nm(), p.y.nm()]
}

/// Adds a line's points to those there are, with the feeds from them on; a line with several moves is one edit.
pub(crate) fn add(edits: &mut Vec<BlockEdit>, line: u32, points: Vec<[i64; 2]>, feeds: Vec<FeedFrom>) {
    match edits.last_mut() {
        Some(last) if last.line == line => {
            let before = last.samples.len() - 1;
            last.feeds.extend(feeds.iter().map(|f| FeedFrom { sample: before + f.sample, ..*f }));
            last.feeds.dedup_by_key(|from| from.percent);
            last.samples.extend_from_slice(&points[1..]);
        }
        _ => edits.push(BlockEdit { feeds, ..BlockEdit::new(line, points) }),
    }
}

/// Moves along which a share of `full` is applied; it depends on how much of them lies behind, 0 to 1.
fn lead(blocks: &[Block], full: Vector, share: impl Fn(Real) -> Real, edits: &mut Vec<BlockEdit>) {
    let whole = blocks.iter().fold(Offset::ZERO, |sum, b| sum + b.curve.length());
    let mut before = Offset::ZERO;
    for block in blocks {
        let length = block.curve.length();
        let pieces = (length.nm() / STEP_NM).max(1) + 1;
        let point = |k: i64| {
            let fraction = Real::ratio(k, pieces);
            let u = (before + length.scaled(fraction)).over(whole).max(Real::ZERO).min(Real::ONE);
            raw(block.curve.point(fraction) + full.scaled(share(u)))
        };
        let points = (0..=pieces).map(point).collect();
        add(edits, block.line, points, Vec::new());
        before += length;
    }
}

fn contour(pass: &Pass, path: &Path, (nodes, schedule): (&[Node], Option<&Schedule>), edits: &mut Vec<BlockEdit>) {
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let mut at = 0usize;
    for block in &pass.blocks {
        let end = block.s + block.curve.length();
        // At a sharp corner the correction changes on the spot: the block begins with a step from the old to the new.
        let before = edits.last().and_then(|e| e.samples.last().copied());
        let start = raw(block.curve.start() + correction_at(path, nodes, block.s, false));
        let mut points: Vec<[i64; 2]> = before.into_iter().filter(|b| *b != start).collect();
        points.push(start);
        let mut feeds = Vec::new();
        let mut feed = |sample: usize, s: Offset| {
            let Some(percent) = schedule.map(|schedule| schedule.percent(s)) else { return };
            if feeds.last().is_none_or(|from: &FeedFrom| from.percent != percent) {
                feeds.push(FeedFrom { sample, percent });
            }
        };
        feed(0, block.s);
        while at < samples.len() && samples[at].s < end {
            if samples[at].s > block.s {
                feed(points.len(), samples[at].s);
                points.push(raw(samples[at].point + nodes[at].total()));
            }
            at += 1;
        }
        points.push(raw(block.curve.end() + correction_at(path, nodes, end, true)));
        add(edits, block.line, points, feeds);
    }
}
