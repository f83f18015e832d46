//! The corrected centre path, as the program writer wants it.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::geometry::{Point, Vector};
use truepath_core::units::{Offset, Real};

use crate::pass::Pass;
use crate::program::BlockEdit;

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

/// The corrected path, one list of points per line of the program, from the end of the block before to its own end.
pub fn block_edits(pass: &Pass, path: &Path, nodes: &[Node]) -> Vec<BlockEdit> {
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let raw = |p: Point| [p.x.nm(), p.y.nm()];
    let mut edits: Vec<BlockEdit> = Vec::new();
    let mut at = 0usize;
    for block in &pass.blocks {
        let end = block.s + block.curve.length();
        // At a sharp corner the correction changes on the spot: the block begins with a step from the old to the new.
        let before = edits.last().and_then(|e| e.samples.last().copied());
        let start = raw(block.curve.start() + correction_at(path, nodes, block.s, false));
        let mut points: Vec<[i64; 2]> = before.into_iter().filter(|b| *b != start).collect();
        points.push(start);
        while at < samples.len() && samples[at].s < end {
            if samples[at].s > block.s {
                points.push(raw(samples[at].point + nodes[at].total()));
            }
            at += 1;
        }
        points.push(raw(block.curve.end() + correction_at(path, nodes, end, true)));
        match edits.last_mut() {
            Some(last) if last.line == block.line => last.samples.extend_from_slice(&points[1..]),
            _ => edits.push(BlockEdit { line: block.line, samples: points }),
        }
    }
    edits
}
