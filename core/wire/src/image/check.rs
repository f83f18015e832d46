//! What makes a well-framed image trustworthy: ranges, spacing, derived fields, clamp.

use super::feed_law::scaled;
use super::{FACTOR_ONE, Field, FineOffset, Header, ImageError, Node, RATIO_ONE};
use truepath_units::isqrt_rounded;

/// Shortest way between neighbouring nodes.
pub const MIN_SPACING_NM: i64 = 1_000;
/// Longest way between neighbouring nodes.
pub const MAX_SPACING_NM: i64 = 1_000_000;
/// Largest clamp; keeps every sum of corrections within 32 bits of 2⁻⁸ nm.
pub const MAX_CLAMP_NM: i64 = 4_000_000;
/// Most nodes of an image: 100 m of path at 0.1 mm.
pub const MAX_NODES: usize = 1 << 20;
/// Most nodes of an image that a coprocessor holds. A slot of its flash is three sectors of 128 KiB; less one flash
/// word for the commit and one for the head of the slot (32 bytes each) that is room for 12,276 nodes, rounded down
/// so that the head may grow. 1.2 m of path at 0.1 mm.
pub const DEVICE_NODES: usize = 12_000;

fn within(name: Field, value: i64, low: i64, high: i64) -> Result<(), ImageError> {
    if (low..=high).contains(&value) { Ok(()) } else { Err(ImageError::Range { name, value, low, high }) }
}

/// Every value of the header within its range.
pub(super) fn header(header: &Header) -> Result<(), ImageError> {
    /// Coordinates of a program: ±1000 m keeps every difference of the servo cycle far from its end.
    const PLACE: i64 = 1_000_000_000_000;
    let s = &header.settings;
    within(Field::Nodes, i64::from(header.node_count), 2, MAX_NODES as i64)?;
    within(Field::FeedPerTooth, i64::from(s.feed.per_tooth.bits()), 1 << FineOffset::FRACTION_BITS, 8_000_000 << 8)?;
    within(Field::Teeth, i64::from(s.feed.teeth), 1, 64)?;
    within(Field::SizeExponent, i64::from(s.feed.size_exponent), 0, i64::from(RATIO_ONE))?;
    within(Field::RatioLow, i64::from(s.feed.ratio_low), 0, i64::from(RATIO_ONE))?;
    within(Field::RatioHigh, i64::from(s.feed.ratio_high), RATIO_ONE.into(), i64::from(RATIO_ONE) << 1)?;
    within(Field::Clamp, s.limits.clamp.nm(), 1, MAX_CLAMP_NM)?;
    within(Field::Warn, s.limits.warn.nm(), 0, s.limits.clamp.nm())?;
    within(Field::Slew, i64::from(s.limits.slew_nm_per_s), 1, 4_000_000_000)?;
    let acceleration = i64::try_from(s.limits.acceleration_nm_per_s2).unwrap_or(i64::MAX);
    within(Field::Acceleration, acceleration, 1, 1_000_000_000_000)?;
    within(Field::Tolerance, s.window.tolerance.nm(), 1_000, 5_000_000)?;
    within(Field::PassLow, s.window.z_low.nm(), -PLACE, s.window.z_high.nm().min(PLACE))?;
    within(Field::PassHigh, s.window.z_high.nm(), -PLACE, PLACE)?;
    within(Field::Gate, s.window.gate_height.nm(), 0, 1_000_000_000)?;
    within(Field::NodeStep, s.node_step.nm(), MIN_SPACING_NM, MAX_SPACING_NM)?;
    within(Field::OriginX, header.origin.x.nm(), -PLACE, PLACE)?;
    within(Field::OriginY, header.origin.y.nm(), -PLACE, PLACE)?;
    factor_table(&s.feed.factor)
}

/// The factor must not fall with the feed, must be 1 at the nominal feed and at most 2.
fn factor_table(factor: &[u32]) -> Result<(), ImageError> {
    let mut below = 0;
    for (entry, &value) in factor.iter().enumerate() {
        let nominal = entry != 16 || value == FACTOR_ONE as u32;
        if value < below || value > (FACTOR_ONE as u32) << 1 || !nominal {
            return Err(ImageError::FactorTable { entry });
        }
        below = value;
    }
    Ok(())
}

/// Spacing, derived fields and clamp of all nodes.
pub(super) fn nodes(header: &Header, nodes: impl ExactSizeIterator<Item = Node>) -> Result<(), ImageError> {
    let count = nodes.len();
    let mut before: Option<Node> = None;
    // Counted by hand: the sum within `enumerate` could panic for all that the compiler knows.
    let mut index = 0usize;
    for node in nodes {
        if let Some(previous) = before {
            link(index.saturating_sub(1), &previous, &node)?;
        } else if (node.x, node.y) != (0, 0) {
            return Err(ImageError::Derived { node: 0 });
        }
        clamp(index, &node, header)?;
        before = Some(node);
        index = index.saturating_add(1);
    }
    let Some(last) = before else {
        return Ok(());
    };
    if (last.length, last.reciprocal) != (0, 0) {
        return Err(ImageError::Derived { node: count.saturating_sub(1) });
    }
    if header.settings.closed && (last.x, last.y) != (0, 0) {
        return Err(ImageError::NotClosed);
    }
    Ok(())
}

fn link(index: usize, node: &Node, next: &Node) -> Result<(), ImageError> {
    let (length, reciprocal) = node.derived(next);
    let found_nm = i64::from(length);
    if !(MIN_SPACING_NM..=MAX_SPACING_NM).contains(&found_nm) {
        return Err(ImageError::Spacing { node: index, found_nm, low_nm: MIN_SPACING_NM, high_nm: MAX_SPACING_NM });
    }
    if (length, reciprocal) != (node.length, node.reciprocal) {
        return Err(ImageError::Derived { node: index });
    }
    Ok(())
}

fn clamp(index: usize, node: &Node, header: &Header) -> Result<(), ImageError> {
    let s = &header.settings;
    let correction_nm =
        reach_nm(node.chip, node.edge, &[s.feed.factor_at(s.feed.ratio_low), s.feed.factor_at(s.feed.ratio_high)]);
    let clamp_nm = s.limits.clamp.nm();
    if correction_nm > clamp_nm { Err(ImageError::OverClamp { node: index, correction_nm, clamp_nm }) } else { Ok(()) }
}

/// The longest vector chip·F + edge, nm rounded up, over the given chip factors. A convex function of F, so its
/// maximum over a window of F lies at one of its ends.
pub(super) fn reach_nm(chip: [FineOffset; 2], edge: [FineOffset; 2], factors: &[i32]) -> i64 {
    let mut most = 0u128;
    for &factor in factors {
        let mut square = 0u128;
        for (chip, edge) in chip.iter().zip(edge) {
            let part = scaled(*chip, factor).saturating_add(i64::from(edge.bits()));
            let part = u128::from(part.unsigned_abs());
            square = square.saturating_add(part.saturating_mul(part));
        }
        most = most.max(square);
    }
    let fine = isqrt_rounded(most) as i64;
    fine.saturating_add((1 << FineOffset::FRACTION_BITS) - 1) >> FineOffset::FRACTION_BITS
}
