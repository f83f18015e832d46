//! Where on the path a setpoint is: a bounded walk from the place of the tick before.
//!
//! The walk goes forward while the setpoint lies beyond the end of its segment, and where the next segment is nearer
//! although the end is not reached yet (the inner side of a corner), together at most [`ADVANCE_LIMIT`] segments; it
//! goes back by at most one. It never looks elsewhere: where a contour crosses itself the other branch is not seen,
//! because it is far along the path. A path that returns on itself within one segment (a cusp) may be taken up to one
//! segment too early.
//!
//! A step of the walk is one scalar product; distances are computed only for the segment where it ends and, on the
//! inner side of a corner, for the next one.
//!
//! All arithmetic is integer and odd in the coordinates, so shifting, turning by 90° and mirroring the image together
//! with the setpoints gives the same place to the last bit.

use serde::{Deserialize, Serialize};

use super::frame::Local;
use crate::image::{Image, NODE_BYTES, Node};

/// Most segments a tick may advance: 0.8 mm at the usual 0.1 mm, 48 m/min at 1 kHz.
pub const ADVANCE_LIMIT: u32 = 8;
/// Fraction bits of a place within a segment.
pub const FRACTION_BITS: u32 = 30;
/// The end of a segment.
pub const FRACTION_ONE: u32 = 1 << FRACTION_BITS;

/// A place on the path.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Place {
    /// Index of the node at or before it.
    pub node: u32,
    /// How far to the next node, units of 2⁻³⁰, up to 1.
    pub fraction: u32,
}

/// The foot of a setpoint on one segment.
#[derive(Clone, Copy, Debug)]
pub(super) struct Foot {
    /// How far to the next node, units of 2⁻³⁰, up to 1.
    pub fraction: u32,
    /// Way from the node to the foot, nm.
    pub along: u32,
    /// Square of the distance of the setpoint from the foot, nm².
    pub distance_squared: u64,
}

/// The nearest foot.
#[derive(Clone, Copy, Debug)]
pub(super) struct Located {
    pub node: u32,
    pub foot: Foot,
    /// Way from the node at which the walk began to the foot, nm.
    pub ahead: i32,
}

type Stored = [u8; NODE_BYTES];

/// From a node to a setpoint or another node, nm. In range: a setpoint is within a jump of the path.
#[derive(Clone, Copy)]
struct Way {
    x: i32,
    y: i32,
}

impl Way {
    #[inline(always)]
    fn new(from: &Stored, to: &Local) -> Self {
        let Node { x, y, .. } = Node::decode(from);
        Self { x: to.x.wrapping_sub(x), y: to.y.wrapping_sub(y) }
    }
    #[inline(always)]
    fn between(from: &Stored, to: &Stored) -> Self {
        let Node { x, y, .. } = Node::decode(to);
        Self::new(from, &Local { x, y, z: 0 })
    }
    #[inline(always)]
    fn dot(self, other: Self) -> i64 {
        dot(self.x, self.y, other.x, other.y)
    }
}

/// How many segments from the first node of a slice on the setpoint has passed, at most a number and never the last
/// one; and their length, nm.
#[inline(never)]
fn passed(nodes: &[Stored], at: &Local, most: usize) -> (u32, i32) {
    let (mut steps, mut length) = (0u32, 0i32);
    let [first, inner @ .., _] = nodes else {
        return (0, 0);
    };
    let mut a = first;
    // As a slice of its own it has one end, not two to be asked for at each step.
    for b in inner.get(..most).unwrap_or(inner) {
        if Way::new(b, at).dot(Way::between(a, b)) < 0 {
            break;
        }
        steps = steps.wrapping_add(1);
        length = length.wrapping_add(Node::decode(a).length as i32);
        a = b;
    }
    (steps, length)
}

/// The foot on the segment a…b.
#[inline(always)]
fn foot(a: &Stored, b: &Stored, at: &Local) -> Foot {
    let (way, whole) = (Way::new(a, at), Way::between(a, b));
    let dot = way.dot(whole);
    if dot <= 0 {
        return Foot { fraction: 0, along: 0, distance_squared: square(way.x, way.y) };
    }
    let Node { length, reciprocal, .. } = Node::decode(a);
    let length_squared = whole.dot(whole);
    if dot >= length_squared {
        let rest = Way::new(b, at);
        return Foot { fraction: FRACTION_ONE, along: length, distance_squared: square(rest.x, rest.y) };
    }
    // dot/L² with the stored reciprocal ⌊2ⁿ⁺³⁰/L²⌋: dot·2³²⁻ⁿ, below 2³², makes the quotient the high word of a product.
    let (high, low) = ((length_squared >> 32) as u32, length_squared as u32);
    let scaled = if high == 0 {
        (dot as u32).wrapping_shl(low.leading_zeros())
    } else {
        let left = high.leading_zeros();
        ((dot >> 32) as u32).wrapping_shl(left) | ((dot as u32) >> 1).wrapping_shr(31u32.wrapping_sub(left))
    };
    let fraction = (u64::from(scaled).wrapping_mul(u64::from(reciprocal)) >> 32) as u32;
    let part = |u: i32| share(u, fraction as i32, FRACTION_BITS);
    let distance_squared = square(way.x.wrapping_sub(part(whole.x)), way.y.wrapping_sub(part(whole.y)));
    Foot { fraction, along: part(length as i32) as u32, distance_squared }
}

/// The foot nearest to `at`, starting from the segment of the node `from`; none beyond the last segment.
#[inline(always)]
pub(super) fn locate(image: &Image<'_>, from: u32, at: &Local) -> Option<Located> {
    let nodes = image.stored_from(from);
    let (steps, before) = passed(nodes, at, ADVANCE_LIMIT as usize);
    let [a, b, rest @ ..] = nodes.get(steps as usize..)? else {
        return None;
    };
    let foot = foot(a, b, at);
    let node = from.wrapping_add(steps);
    if foot.fraction == 0
        && steps == 0
        && let Some(previous) = image.stored_from(from.wrapping_sub(1)).first()
        // Nearer than the node between the two.
        && Way::new(a, at).dot(Way::between(previous, a)) < 0
    {
        return Some(back(previous, a, node, at));
    }
    if let Some(c) = rest.first()
        && Way::new(b, at).dot(Way::between(b, c)) > 0
        && let Some(round) = corner(nodes.get(steps as usize..)?, at, &foot, ADVANCE_LIMIT.wrapping_sub(steps))
    {
        return Some(Located {
            node: node.wrapping_add(round.node),
            foot: round.foot,
            ahead: before.wrapping_add(round.ahead),
        });
    }
    Some(Located { node, foot, ahead: before.wrapping_add(foot.along as i32) })
}

/// The setpoint is before the node `from`.
#[inline(never)]
fn back(previous: &Stored, a: &Stored, from: u32, at: &Local) -> Located {
    let foot = foot(previous, a, at);
    let ahead = (foot.along as i32).wrapping_sub(Node::decode(previous).length as i32);
    Located { node: from.wrapping_sub(1), foot, ahead }
}

/// The setpoint has begun the next segment without having passed the end of the first, as on the inner side of a
/// corner: the foot there, or behind it within so many steps, if the next segment is nearer. Node and way are counted
/// from the first one.
#[inline(never)]
fn corner(nodes: &[Stored], at: &Local, here: &Foot, most: u32) -> Option<Located> {
    let [a, next @ ..] = nodes else { return None };
    let [b, c, ..] = next else { return None };
    let near = foot(b, c, at);
    if near.distance_squared >= here.distance_squared || most == 0 {
        return None;
    }
    let before = Node::decode(a).length as i32;
    if near.fraction < FRACTION_ONE {
        return Some(Located { node: 1, foot: near, ahead: before.wrapping_add(near.along as i32) });
    }
    let (steps, length) = passed(next, at, most.wrapping_sub(1) as usize);
    let [a, b, ..] = next.get(steps as usize..)? else { return None };
    let foot = foot(a, b, at);
    let ahead = before.wrapping_add(length).wrapping_add(foot.along as i32);
    Some(Located { node: steps.wrapping_add(1), foot, ahead })
}

/// A share of a value, 0 or more in steps of 2^−bits, rounded to nearest, ties away from zero: `shift_rounded` with the sign of the value
/// for that of the product, which is the same unless the share is 0, and that gives 0 with either.
#[inline(always)]
pub(super) fn share(value: i32, share: i32, bits: u32) -> i32 {
    let half = (1i32 << bits.wrapping_sub(1)).wrapping_add(value >> 31);
    (product(value, share).wrapping_add(half.into()) >> bits) as i32
}

/// 32 × 32 → 64 bits, one instruction on the device.
#[inline(always)]
pub(super) fn product(a: i32, b: i32) -> i64 {
    i64::from(a).wrapping_mul(i64::from(b))
}

/// The scalar product, for vectors of which one is below 2³¹/√2.
#[inline(always)]
pub(super) fn dot(ax: i32, ay: i32, bx: i32, by: i32) -> i64 {
    product(ax, bx).wrapping_add(product(ay, by))
}

/// x² + y².
#[inline(always)]
pub(super) fn square(x: i32, y: i32) -> u64 {
    product(x, x).unsigned_abs().wrapping_add(product(y, y).unsigned_abs())
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;
    use truepath_units::shift_rounded;

    proptest! {
        #[test]
        fn a_share_is_rounded_like_everything_else(value: i32, part in 0..=i32::MAX, bits in 1..=30u32, ends in 0..4u8) {
            // At the ends of both ranges, and at ties, which a random number hardly ever meets.
            let value = if ends & 1 == 1 { value >> 20 } else { value };
            let part = if ends & 2 == 2 { 1 << bits.saturating_sub(1) } else { part };
            for (value, part) in [(value, part), (value, 0), (i32::MIN, part), (0, part)] {
                let exact = shift_rounded(i128::from(product(value, part)), bits);
                prop_assert_eq!(share(value, part, bits), exact as i32);
            }
        }
    }
}
