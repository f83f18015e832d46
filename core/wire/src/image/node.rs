//! One node of the correction array: where it is, what to add there.
//!
//! 32 bytes, little endian: x, y (i32 nm from the origin of the image), chip part x, y and edge part x, y (i32,
//! 2⁻⁸ nm), reciprocal (u32) and length (u32 nm) of the way to the next node. The last two are derived from the
//! neighbours, and stored so that the servo cycle needs neither a division nor a root; they are recomputed and
//! compared when the image is opened.

use super::feed_law::scaled;
use super::{FineOffset, read};
use truepath_units::geometry::Point;
use truepath_units::isqrt_rounded;

/// Bytes of a node.
pub const NODE_BYTES: usize = 32;

/// A node as the caller gives it: program coordinates and the correction of the commanded centre there.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ImageNode {
    /// Place of the nominal cutter centre, program coordinates.
    pub point: Point,
    /// Part proportional to the chip, x and y, at the nominal feed per tooth.
    pub chip: [FineOffset; 2],
    /// Part of the cutting edge, x and y, independent of the feed.
    pub edge: [FineOffset; 2],
}

/// A node as the servo cycle reads it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Node {
    /// Place from the origin of the image, nm.
    pub x: i32,
    /// Place from the origin of the image, nm.
    pub y: i32,
    /// Chip part, x and y.
    pub chip: [FineOffset; 2],
    /// Edge part, x and y.
    pub edge: [FineOffset; 2],
    /// ⌊2ⁿ⁺³⁰ / L²⌋ with L² the square of the distance to the next node, nm², and n its bit length; 0 at the last.
    pub reciprocal: u32,
    /// Distance to the next node, nm, rounded; 0 at the last.
    pub length: u32,
}

impl Node {
    /// Decodes 32 bytes.
    #[inline]
    pub fn decode(bytes: &[u8; NODE_BYTES]) -> Self {
        let fine = |at| FineOffset::from_bits(read::i32_at(bytes, at));
        Self {
            x: read::i32_at(bytes, 0),
            y: read::i32_at(bytes, 4),
            chip: [fine(8), fine(12)],
            edge: [fine(16), fine(20)],
            reciprocal: read::u32_at(bytes, 24),
            length: read::u32_at(bytes, 28),
        }
    }

    /// The correction at a chip factor, 2⁻⁸ nm. In range: an image holds it within the clamp, below 2³⁰, over the feed
    /// window.
    #[inline(always)]
    pub(crate) fn full(&self, factor: i32) -> [i32; 2] {
        let ([chip_x, chip_y], [edge_x, edge_y]) = (self.chip, self.edge);
        [(chip_x, edge_x), (chip_y, edge_y)].map(|(chip, edge)| (scaled(chip, factor) as i32).wrapping_add(edge.bits()))
    }

    /// Its 32 bytes.
    pub fn encode(&self) -> [u8; NODE_BYTES] {
        let words = [
            self.x as u32,
            self.y as u32,
            self.chip[0].bits() as u32,
            self.chip[1].bits() as u32,
            self.edge[0].bits() as u32,
            self.edge[1].bits() as u32,
            self.reciprocal,
            self.length,
        ];
        let mut bytes = [0; NODE_BYTES];
        for (to, word) in bytes.as_chunks_mut::<4>().0.iter_mut().zip(words) {
            *to = word.to_le_bytes();
        }
        bytes
    }

    /// The square of the distance to another node, nm²; the components must be below 2³¹ nm.
    pub fn square_to(&self, next: &Self) -> u64 {
        let (x, y) = (u64::from(next.x.abs_diff(self.x)), u64::from(next.y.abs_diff(self.y)));
        x.saturating_mul(x).saturating_add(y.saturating_mul(y))
    }

    /// Length and reciprocal of the way to `next`, as they are stored.
    pub fn derived(&self, next: &Self) -> (u32, u32) {
        let square = self.square_to(next);
        let length = isqrt_rounded(u128::from(square)) as u32;
        let bits = 64u32.saturating_sub(square.leading_zeros());
        let reciprocal = (1u128 << bits.saturating_add(30)).checked_div(u128::from(square)).unwrap_or(0);
        (length, reciprocal as u32)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects, clippy::float_arithmetic)]
    use super::*;

    #[test]
    fn a_node_survives_its_bytes() {
        let f = FineOffset::from_bits;
        let node =
            Node { x: -1, y: i32::MAX, chip: [f(7), f(-8)], edge: [f(9), f(i32::MIN)], reciprocal: 5, length: 6 };
        assert_eq!(Node::decode(&node.encode()), node);
    }

    #[test]
    fn the_reciprocal_turns_a_square_into_one_from_below() {
        for (x, y) in [(1_000, 0), (100_000, 3), (99_999, -77_777), (1, 999_999), (0, 65_536)] {
            let (a, b) = (Node::default(), Node { x, y, ..Node::default() });
            let (length, reciprocal) = a.derived(&b);
            let square = a.square_to(&b);
            let bits = 64 - square.leading_zeros();
            let product = u128::from(square) * u128::from(reciprocal);
            assert!(product <= 1 << (bits + 30) && product + u128::from(square) > 1 << (bits + 30));
            assert!((1 << 30..=1u32 << 31).contains(&reciprocal));
            assert!((f64::from(length) - f64::from(x).hypot(f64::from(y))).abs() <= 0.5);
        }
    }
}
