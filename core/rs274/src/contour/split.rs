//! Leads: the moves that bring the cutter to a contour and away from it, told from the contour itself.
//!
//! Signs that count:
//! * G41 or G42 takes its offset along one move and G40 gives it up along one; what lies before and behind is no wall;
//! * a run holds a closed loop, or one that runs a little over its own start, with a few blocks before and behind it (some
//!   CAM systems write arcs as short lines), and the loop is more than half of it;
//! * an open run (not one that misses its start by what its numbers are rounded by) begins or ends with an arc that turns
//!   away from the wall, tangent to the rest, no wider than two diameters: what CAM systems write. With a straight move
//!   outside it only where both ends are alike;
//! * an open run begins or ends with a straight move no longer than the cutter's radius, at 20 degrees or more to the
//!   wall: the wall of such a leg would lie in its own corner. No longer than two diameters where it is neither along
//!   nor across;
//! * a run ends with a straight move straight back, no longer than two diameters.
//!
//! A line and a tangent quarter circle at one end look exactly like a contour that begins with a corner: there the caller
//! names the lines.

use core::ops::Range;

use super::Candidate;
use truepath_units::geometry::{Block, Contour, Curve, Shape, Side};
use truepath_units::{Offset, Real};

/// The most blocks that lead to a loop, and away from it.
const LEAD_BLOCKS: usize = 24;
/// Of more blocks than this a lead may be no longer than an eighth of its run.
const FEW: usize = 4;

/// The blocks of a run that are its contour. Without a known side of the wall, arcs and straight moves of open runs stay.
pub(super) fn without_leads(blocks: &[Block], run: &Candidate, wall: Option<Side>, diameter: Offset) -> Range<usize> {
    let end = blocks.len().saturating_sub(run.exit);
    let told = run.entry > 0 || run.exit > 0;
    let offset = if run.entry < end { run.entry..end } else { 0..blocks.len() };
    let offset = without_way_back(blocks, offset, diameter);
    let within = blocks.get(offset.clone()).unwrap_or_default();
    let found = match (inner_loop(within, closed).or_else(|| inner_loop(within, laps)), wall) {
        (Some(found), _) => found,
        (None, Some(wall)) if !told && !closed(within) && !nearly_closed(within) => open(within, wall, diameter),
        _ => return offset,
    };
    // A loop may be closed by the way back alone.
    let found = offset.start.saturating_add(found.start)..offset.start.saturating_add(found.end);
    without_way_back(blocks, found, diameter)
}

/// The same blocks without a straight move at their end that goes straight back, over the block before it or over the
/// first one: to where a subprogram begins again. Such a run may end where it starts, and is no loop.
fn without_way_back(blocks: &[Block], range: Range<usize>, diameter: Offset) -> Range<usize> {
    let [first, .., before, last] = blocks.get(range.clone()).unwrap_or_default() else { return range };
    let heading = last.curve.start_heading();
    let over_first = last.curve.end() == first.curve.start() && first.curve.shape() == Shape::Line;
    let back = before.curve.end_heading().dot(heading) <= -TANGENT
        || (over_first && first.curve.start_heading().dot(heading) <= -TANGENT);
    if back && last.curve.shape() == Shape::Line && last.curve.length() <= diameter + diameter {
        return range.start..range.end.saturating_sub(1);
    }
    range
}

/// Cosine of one degree, and of twenty: tangent is what turns by less than the one, a corner by more than the other.
const TANGENT: Real = Real::from_bits(4_294_313_152);
const CORNER: Real = Real::from_bits(4_035_949_075);
/// Cosine of eighty degrees: what is nearly across.
const ACROSS: Real = Real::from_bits(745_813_244);

/// What an end of an open run looks like, counted from the end.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
struct End {
    /// Blocks that are certainly a lead.
    blocks: usize,
    /// Radius of a lead arc behind a straight move, which is one if the other end has the same.
    if_alike: Option<Offset>,
}

/// The blocks of an open run without the leads at either end.
fn open(blocks: &[Block], wall: Side, diameter: Offset) -> Range<usize> {
    let all = 0..blocks.len();
    let whole = length(blocks);
    let seen = |from_end: bool| {
        let at = |k: usize| {
            let index = if from_end { blocks.len().checked_sub(k)?.checked_sub(1)? } else { k };
            blocks.get(index).map(|b| b.curve)
        };
        look(&at, from_end, wall, diameter)
    };
    let (first, last) = (seen(false), seen(true));
    let alike = matches!((first.if_alike, last.if_alike), (Some(a), Some(b)) if (a - b).abs() <= Offset::from_um(10));
    let count = |end: &End| if alike { 2 } else { end.blocks };
    let kept = count(&first)..blocks.len().saturating_sub(count(&last));
    match blocks.get(kept.clone()) {
        // What is left has to be worth the name.
        Some(rest) if !rest.is_empty() && length(rest).nm() > whole.nm() / 2 => kept,
        _ => all,
    }
}

/// Looks at one end; `at` gives the curves from the end inwards.
fn look(at: &dyn Fn(usize) -> Option<Curve>, from_end: bool, wall: Side, diameter: Offset) -> End {
    let (Some(outer), Some(inner)) = (at(0), at(1)) else { return End::default() };
    let away = if wall == Side::Right { Real::ONE } else { -Real::ONE };
    // Headings at the joint of two curves, in the direction of travel.
    let joint = |outer: &Curve, inner: &Curve| {
        if from_end {
            (inner.end_heading(), outer.start_heading())
        } else {
            (outer.end_heading(), inner.start_heading())
        }
    };
    let lead_arc = |arc: &Curve, rest: &Curve| {
        let (from, to) = joint(arc, rest);
        let Shape::Arc { sweep, .. } = arc.shape() else { return None };
        let radius = arc.signed_radius()?.scaled(away);
        let small = radius > Offset::ZERO && radius <= diameter + diameter && sweep.abs() <= Real::ratio(7, 2);
        (small && from.dot(to) >= TANGENT).then_some(radius)
    };
    if lead_arc(&outer, &inner).is_some() {
        return End { blocks: 1, if_alike: None };
    }
    if outer.shape() != Shape::Line || outer.length() > diameter + diameter {
        return End::default();
    }
    if let Some(radius) = at(2).and_then(|rest| lead_arc(&inner, &rest)) {
        return End { blocks: 0, if_alike: Some(radius) };
    }
    let (from, to) = joint(&outer, &inner);
    let turns_away = from.cross(to) * away > Real::ZERO;
    let slanted = from.dot(to).abs() > ACROSS;
    let short = outer.length().nm() <= diameter.nm() / 2;
    let leads = turns_away && from.dot(to) < CORNER && (short || slanted);
    End { blocks: usize::from(leads), if_alike: None }
}

/// The loop inside a run that has leads, by what counts as one: where it closes at the end of a block, what comes behind is
/// no part of it.
fn inner_loop(blocks: &[Block], is_loop: fn(&[Block]) -> bool) -> Option<Range<usize>> {
    let whole = length(blocks);
    let short =
        |lead: Option<&[Block]>| lead.is_some_and(|lead| lead.len() <= FEW || length(lead).nm() <= whole.nm() / 8);
    let mut best: Option<Range<usize>> = None;
    for lead_in in 0..=LEAD_BLOCKS.min(blocks.len()) {
        if !short(blocks.get(..lead_in)) || !comes_back(blocks, lead_in) {
            continue;
        }
        for lead_out in 0..=LEAD_BLOCKS.min(blocks.len()) {
            let found = lead_in..blocks.len().saturating_sub(lead_out);
            let Some(inner) = blocks.get(found.clone()).filter(|b| !b.is_empty()) else { continue };
            let shorter = best.as_ref().is_some_and(|b| b.len() >= found.len());
            let leads = found.len() < blocks.len() && short(blocks.get(found.end..));
            if leads && !shorter && length(inner).nm() > whole.nm() / 2 && is_loop(inner) {
                best = Some(found);
            }
        }
    }
    best
}

/// Whether the end of a run comes near the start of a block: a loop that begins there may close.
fn comes_back(blocks: &[Block], index: usize) -> bool {
    let Some(start) = blocks.get(index).map(|b| b.curve.start()) else { return false };
    let tail = blocks.get(blocks.len().saturating_sub(LEAD_BLOCKS.saturating_mul(2))..).and_then(Contour::new);
    let mut near = false;
    if let Some(tail) = tail {
        tail.feet(start, |foot| near = near || foot.left.abs() <= Offset::from_um(3));
    }
    near
}

/// Whether blocks run on over their own start.
fn laps(blocks: &[Block]) -> bool {
    Contour::new(blocks).is_some_and(|contour| contour.overlap().is_some())
}

/// Whether blocks end where they start.
pub(super) fn closed(blocks: &[Block]) -> bool {
    match (blocks.first(), blocks.last()) {
        (Some(first), Some(last)) => first.curve.start() == last.curve.end(),
        _ => false,
    }
}

/// Whether blocks end beside their start and as they begin, as rounded numbers have it: a corner on either side of such a place looks
/// like a lead, and is none.
fn nearly_closed(blocks: &[Block]) -> bool {
    const BESIDE: Offset = Offset::from_um(10);
    blocks.first().zip(blocks.last()).is_some_and(|(first, last)| {
        let (start, end) = (&first.curve, &last.curve);
        end.end().distance(start.start()) <= BESIDE && end.end_heading().dot(start.start_heading()) >= TANGENT
    })
}

/// Their length together.
pub(super) fn length(blocks: &[Block]) -> Offset {
    match (blocks.first(), blocks.last()) {
        (Some(first), Some(last)) => last.s + last.curve.length() - first.s,
        _ => Offset::ZERO,
    }
}
