//! The correction through sharp inside corners.
//!
//! Before such a corner the cutter runs into the stock of the other leg; the moment the direction changes that load ends, and the
//! cutter springs back to where it was sent. So
//! * beside either wall the correction never goes nearer to it than that of the straight wall: what is sent into the wall to
//!   meet a load is cut into it by the cutter that springs back. Away from the wall it is followed;
//! * along the wall, where nothing is cut by it, the correction goes over to the one with which both walls are right in the
//!   corner: `p·n₁ = c₁`, `p·n₂ = c₂`. The corrected path then has a corner as well, and no step.

use super::node::Node;
use crate::cut::{Path, Sample};
use truepath_units::geometry::{Direction, Side, Vector};
use truepath_units::{Offset, Real};

/// Sine of the turn from which on the correction of a corner is sought: where the path nearly turns back it lies far away, and the
/// correction changes on the spot.
const TURN: Real = Real::ratio(1, 5);

/// A correction across the wall and along it.
#[derive(Clone, Copy, Debug, Default)]
struct Parts {
    /// Towards the wall: chip and edge part.
    across: [Offset; 2],
    /// With the travel.
    along: [Offset; 2],
}

impl Parts {
    fn of(node: &Node, sample: &Sample, side: Side) -> Self {
        let heading = side.heading(sample.normal);
        let both = [node.chip, node.edge];
        Self { across: both.map(|v| v.along(sample.normal)), along: both.map(|v| v.along(heading)) }
    }

    fn node(&self, normal: Direction, side: Side) -> Node {
        let heading = side.heading(normal);
        let [chip, edge] = [0, 1].map(|part: usize| {
            self.across
                .get(part)
                .zip(self.along.get(part))
                .map_or(Vector::ZERO, |(across, along)| normal.times(*across) + heading.times(*along))
        });
        Node { chip, edge }
    }

    fn towards_wall(&self) -> Offset {
        let [chip, edge] = self.across;
        chip + edge
    }
}

/// Leads a correction through all sharp inside corners of a path.
pub(super) fn turn(path: &Path, nodes: &mut [Node]) {
    let samples = path.samples().get(path.first()..).unwrap_or_default();
    let side = path.setup().wall;
    let near = |i: usize| samples.get(i).is_some_and(|s| s.near_corner);
    let parts = |nodes: &[Node], i: usize| Some(Parts::of(nodes.get(i)?, samples.get(i)?, side));
    let mut at = 0usize;
    while at < nodes.len() {
        let end = (at..nodes.len()).find(|i| !near(*i)).unwrap_or(nodes.len());
        if end == at {
            at = at.saturating_add(1);
            continue;
        }
        // Corners whose surroundings meet share the leg between them: its middle stands for its straight wall.
        let mut before = at.checked_sub(1).and_then(|i| parts(nodes, i));
        while at < end {
            let corner = (at..end).find(|i| turned(samples, *i));
            let start = corner.and_then(|corner| (corner..end).find(|i| !turned(samples, *i)));
            let next = start.and_then(|start| (start..end).find(|i| turned(samples, *i)));
            let middle = start.zip(next).map(|(start, next)| start.midpoint(next));
            let behind = parts(nodes, middle.unwrap_or(end));
            let until = middle.unwrap_or(end);
            let turn = [corner.unwrap_or(until), start.unwrap_or(until)];
            through(side, samples, nodes, [at, until], turn, [before, behind]);
            (before, at) = (behind, until.max(at.saturating_add(1)));
        }
    }
}

/// Whether the centre stays from one sample to the next: the corner lies between them and the samples before.
fn turned(samples: &[Sample], i: usize) -> bool {
    matches!((samples.get(i), samples.get(i.saturating_add(1))), (Some(a), Some(b)) if a.point == b.point)
}

/// Leads it through one corner, whose surroundings are the samples `at..end`, between the straight walls before and behind. It turns
/// on the spot from sample `corner` to `start`; where it does not, both are `end`, and all is beside the first wall.
fn through(
    side: Side,
    samples: &[Sample],
    nodes: &mut [Node],
    [at, end]: [usize; 2],
    [corner, start]: [usize; 2],
    [before, behind]: [Option<Parts>; 2],
) {
    let parts = |nodes: &[Node], i: usize| Some(Parts::of(nodes.get(i)?, samples.get(i)?, side));
    // Nowhere a straight wall: nothing is known of it.
    let Some([before, behind]) = before.or(behind).zip(behind.or(before)).map(|(a, b)| [a, b]) else {
        nodes.iter_mut().take(end).skip(at).for_each(|node| *node = Node::default());
        return;
    };
    for i in at..end.min(nodes.len()) {
        let held = if i <= corner { before } else { behind };
        let Some((own, sample)) = parts(nodes, i).zip(samples.get(i)) else { continue };
        let across = if own.towards_wall() < held.towards_wall() { own.across } else { held.across };
        if let Some(node) = nodes.get_mut(i) {
            *node = Parts { across, along: held.along }.node(sample.normal, side);
        }
    }
    let ends = parts(nodes, corner).zip(parts(nodes, start)).zip(samples.get(corner).zip(samples.get(start)));
    let Some(((arriving, leaving), (last, first))) = ends.filter(|_| start > corner) else { return };
    let cosine = last.normal.dot(first.normal);
    let [sine, back] = [side.heading(last.normal).dot(first.normal), side.heading(first.normal).dot(last.normal)];
    let mut met = arriving;
    if sine.abs() >= TURN {
        let between = |own: [Offset; 2], other: [Offset; 2], sine: Real| {
            let one = |own: Offset, other: Offset| {
                // Into an acute corner no farther than twice what either wall is moved by.
                let most = own.abs().max(other.abs()) + own.abs().max(other.abs());
                (other - own.scaled(cosine)).scaled(Real::ONE / sine).max(-most).min(most)
            };
            let ([own_chip, own_edge], [chip, edge]) = (own, other);
            [one(own_chip, chip), one(own_edge, edge)]
        };
        met.along = between(arriving.across, leaving.across, sine);
        let gone = between(leaving.across, arriving.across, back);
        lead(side, samples, nodes, [at, corner], [before.along, met.along]);
        lead(side, samples, nodes, [start, end.saturating_sub(1)], [gone, behind.along]);
    }
    // While it turns, the cutter stays where it has arrived.
    let arrived = met.node(last.normal, side);
    nodes.iter_mut().take(start).skip(corner).for_each(|node| *node = arrived);
}

/// Lets the part along the wall go over from one to another, over samples `from..=to`.
fn lead(side: Side, samples: &[Sample], nodes: &mut [Node], [from, to]: [usize; 2], [begin, end]: [[Offset; 2]; 2]) {
    let Some((first, last)) = samples.get(from).zip(samples.get(to)).map(|(a, b)| (a.s, b.s)) else { return };
    for i in from..=to {
        let Some((node, sample)) = nodes.get_mut(i).zip(samples.get(i)) else { continue };
        let u = if last > first { (sample.s - first).over(last - first) } else { Real::ONE };
        let share = u * u * (Real::from_int(3) - u - u);
        let mix = |a: Offset, b: Offset| a + (b - a).scaled(share);
        let ([begin_chip, begin_edge], [end_chip, end_edge]) = (begin, end);
        let own = Parts::of(node, sample, side);
        let along = [mix(begin_chip, end_chip), mix(begin_edge, end_edge)];
        *node = Parts { along, ..own }.node(sample.normal, side);
    }
}
