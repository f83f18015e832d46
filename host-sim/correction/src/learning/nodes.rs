//! A correction as a history keeps it: whole nanometres beside every sample of the contour.
//!
//! Each component stands in a row of its own, as differences from the sample before: a smooth correction then takes a few
//! characters a sample.

use serde::{Deserialize, Serialize};
use truepath_core::correct::Node;
use truepath_core::geometry::Vector;
use truepath_core::units::Offset;

/// Differences from sample to sample, nm: the part of the correction that follows the chip, then the one that does not.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Nodes {
    chip_x: Vec<i64>,
    chip_y: Vec<i64>,
    edge_x: Vec<i64>,
    edge_y: Vec<i64>,
}

impl Nodes {
    /// Of a correction.
    pub fn of(nodes: &[Node]) -> Self {
        let row = |f: fn(&Node) -> Offset| differences(nodes.iter().map(|n| f(n).nm()));
        Self {
            chip_x: row(|n| n.chip.x),
            chip_y: row(|n| n.chip.y),
            edge_x: row(|n| n.edge.x),
            edge_y: row(|n| n.edge.y),
        }
    }

    /// The correction; `None` when the rows are not equally long.
    pub fn nodes(&self) -> Option<Vec<Node>> {
        let [cx, cy, ex, ey] = [&self.chip_x, &self.chip_y, &self.edge_x, &self.edge_y].map(|row| sums(row));
        let even = [&cy, &ex, &ey].iter().all(|row| row.len() == cx.len());
        let vector = |x: i64, y: i64| Vector { x: Offset::from_nm(x), y: Offset::from_nm(y) };
        even.then(|| (0..cx.len()).map(|i| Node { chip: vector(cx[i], cy[i]), edge: vector(ex[i], ey[i]) }).collect())
    }
}

/// Differences from value to value; the first from zero.
pub(super) fn differences(values: impl Iterator<Item = i64>) -> Vec<i64> {
    let mut before = 0i64;
    values.map(|v| v.saturating_sub(std::mem::replace(&mut before, v))).collect()
}

/// The values again.
pub(super) fn sums(differences: &[i64]) -> Vec<i64> {
    let mut value = 0i64;
    let next = |d: &i64| {
        value = value.saturating_add(*d);
        value
    };
    differences.iter().map(next).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_correction_comes_back_from_its_differences() {
        let node = |k: i64| Node {
            chip: Vector { x: Offset::from_nm(k * k), y: Offset::from_nm(-7 * k) },
            edge: Vector { x: Offset::from_nm(5), y: Offset::from_nm(k - 3) },
        };
        let nodes: Vec<Node> = (0..9).map(node).collect();
        assert_eq!(Nodes::of(&nodes).nodes(), Some(nodes));
    }
}
