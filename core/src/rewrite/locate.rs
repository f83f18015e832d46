//! Where on the path a setpoint is: a bounded walk from the place of the tick before.
//!
//! The walk goes forward while the next segment is nearer (at a shared corner also when it is equally near), at most
//! [`ADVANCE_LIMIT`] segments, and back by at most one. It never looks elsewhere: where a contour crosses itself the
//! other branch is not seen, because it is far along the path. A path that returns on itself within one segment
//! (a cusp) may be taken up to one segment too early.
//!
//! All arithmetic is integer and odd in the coordinates, so shifting, turning by 90° and mirroring the image together
//! with the setpoints gives the same place to the last bit.

use serde::{Deserialize, Serialize};

use crate::image::{Image, Node};
use crate::units::shift_rounded_i64;

use super::frame::Local;

/// Most segments a tick may advance: 0.8 mm at the usual 0.1 mm, 48 m/min at 1 kHz.
pub const ADVANCE_LIMIT: u32 = 8;
/// Fraction bits of a place within a segment.
pub const FRACTION_BITS: u32 = 30;
/// The end of a segment.
pub const FRACTION_ONE: u32 = 1 << FRACTION_BITS;
/// Farther than this from a node, nm, no distance is computed: it is off any path (tolerances end at 5 mm).
const FAR_NM: u64 = 1 << 24;

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
    pub place: Place,
    /// Way from the node to the foot, nm.
    pub along: u32,
    /// Square of the distance of the setpoint from the foot, nm²; the largest number when far.
    pub distance_squared: u64,
}

/// The foot nearest to `at`, starting from the foot's node `from`, and the way from that node's start to the foot, nm.
#[inline]
pub(super) fn locate(image: &Image<'_>, from: u32, at: Local) -> (Foot, i64) {
    let last_segment = image.len().wrapping_sub(2) as u32;
    let node = |index: u32| image.node(index as usize);
    let mut start = node(from);
    let mut end = node(from.wrapping_add(1));
    let mut best = foot(&start, &end, from, at);
    let mut before = 0i64;
    if best.place.fraction == 0 && from > 0 {
        let previous = node(from.wrapping_sub(1));
        let back = foot(&previous, &start, from.wrapping_sub(1), at);
        if back.distance_squared < best.distance_squared {
            before = i64::from(previous.length).wrapping_neg();
            best = back;
            end = start;
            start = previous;
        }
    }
    let mut steps = 0;
    while steps < ADVANCE_LIMIT && best.place.node < last_segment {
        let index = best.place.node.wrapping_add(1);
        let after = node(index.wrapping_add(1));
        let next = foot(&end, &after, index, at);
        let shared = best.place.fraction == FRACTION_ONE && next.distance_squared == best.distance_squared;
        if next.distance_squared >= best.distance_squared && !shared {
            break;
        }
        before = before.wrapping_add(i64::from(start.length));
        best = next;
        start = end;
        end = after;
        steps = steps.wrapping_add(1);
    }
    (best, before.wrapping_add(i64::from(best.along)))
}

/// The foot on the segment a…b.
#[inline]
fn foot(a: &Node, b: &Node, index: u32, at: Local) -> Foot {
    let length = a.length;
    let result = |fraction: u32, along: u32, distance_squared: u64| Foot {
        place: Place { node: index, fraction },
        along,
        distance_squared,
    };
    let dx = at.x.wrapping_sub(i64::from(a.x));
    let dy = at.y.wrapping_sub(i64::from(a.y));
    if dx.unsigned_abs() > FAR_NM || dy.unsigned_abs() > FAR_NM {
        return result(0, 0, u64::MAX);
    }
    let (dx, dy) = (dx as i32, dy as i32);
    // In range: an image's neighbours are at most 1 mm apart, so all products here stay below 2⁵⁰.
    let (ux, uy) = (b.x.wrapping_sub(a.x), b.y.wrapping_sub(a.y));
    let dot = product(dx, ux).wrapping_add(product(dy, uy));
    if dot <= 0 {
        return result(0, 0, square(dx, dy));
    }
    let length_squared = square(ux, uy);
    let dot = dot.unsigned_abs();
    if dot >= length_squared {
        return result(FRACTION_ONE, length, square(dx.wrapping_sub(ux), dy.wrapping_sub(uy)));
    }
    // dot/L² with the stored reciprocal ⌊2ⁿ⁺³⁰/L²⌋: both shifted so that the quotient is the high word of a product.
    let leading = length_squared.leading_zeros();
    let right = 32u32.wrapping_sub(leading);
    let scaled = if leading < 32 { dot.wrapping_shr(right) } else { dot.wrapping_shl(right.wrapping_neg()) };
    let fraction = (scaled.wrapping_mul(u64::from(a.reciprocal)) >> 32) as u32;
    let part = |u: i32| shift_rounded_i64(product(u, fraction as i32), FRACTION_BITS) as i32;
    let along = part(length as i32).unsigned_abs();
    result(fraction, along, square(dx.wrapping_sub(part(ux)), dy.wrapping_sub(part(uy))))
}

/// 32 × 32 → 64 bits, one instruction on the device.
#[inline]
pub(super) fn product(a: i32, b: i32) -> i64 {
    i64::from(a).wrapping_mul(i64::from(b))
}

/// x² + y², for components below 2³¹.
#[inline]
pub(super) fn square(x: i32, y: i32) -> u64 {
    product(x, x).unsigned_abs().wrapping_add(product(y, y).unsigned_abs())
}
