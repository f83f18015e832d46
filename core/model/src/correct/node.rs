//! The correction beside a sample of the contour, and what it commands along the whole path.

use crate::cut::Path;
use truepath_units::geometry::Vector;

/// The correction at one sample of the contour, in its two parts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// The part that scales with the live feed per tooth.
    pub chip: Vector,
    /// The part that does not.
    pub edge: Vector,
}

impl Node {
    /// The correction at the programmed feed.
    pub fn total(&self) -> Vector {
        self.chip + self.edge
    }
}

/// The commanded displacement at a sample of the path: the correction of the contour. Beyond its ends it is held, or
/// taken from the other end where the contour closes.
pub fn commanded(path: &Path, nodes: &[Node], index: usize) -> Vector {
    let last = nodes.len().saturating_sub(1);
    let mut at = index.saturating_sub(path.first());
    if path.is_closed()
        && (index < path.first() || at > last)
        && let Some(sample) = path.samples().get(index)
    {
        let round = if index < path.first() { path.length() } else { -path.length() };
        at = path.index_at(sample.s + round).saturating_sub(path.first());
    }
    nodes.get(at.min(last)).map_or(Vector::ZERO, Node::total)
}
