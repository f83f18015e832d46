//! A contour: lines and arcs end to end, with arc length, feed and the line of the program each came from.

use super::{Curve, Direction, Point};
use crate::{Offset, Real};

/// One line or arc of a contour with what the program says about it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Block {
    /// Its geometry.
    pub curve: Curve,
    /// Arc length of the contour at its start.
    pub s: Offset,
    /// Programmed feed, mm/min.
    pub feed: Real,
    /// Line of the program it was read from, counted from 1.
    pub line: u32,
}

impl Block {
    /// What a lent buffer is filled with before a contour is read into it.
    pub const BLANK: Self = Self { curve: Curve::SHORTEST, s: Offset::ZERO, feed: Real::ZERO, line: 0 };
}

/// Lines and arcs end to end, in a slice lent by the caller.
#[derive(Clone, Copy, Debug)]
pub struct Contour<'a> {
    blocks: &'a [Block],
}

/// A place on a contour.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Place {
    /// The point.
    pub point: Point,
    /// Direction of travel; steady over the small corners of a curve made of short lines.
    pub heading: Direction,
    /// Index of the block.
    pub block: usize,
}

/// cos 15°: a corner flatter than this is a facet of a smooth curve, not a corner of the part.
pub const FACET_TURN_LIMIT: Real = Real::from_bits(4_148_619_834);

/// Blocks at its start and end that a contour is looked for running over again.
const OVERLAPPED: usize = 8;
/// How near its end is to its start then: what programs round.
const ON_ITSELF: Offset = Offset::from_um(3);
/// Cosine of one degree.
const ALONG: Real = Real::from_bits(4_294_313_152);

impl<'a> Contour<'a> {
    /// Takes blocks that are end to end and whose arc lengths add up; `None` when there is none or they are not.
    pub fn new(blocks: &'a [Block]) -> Option<Self> {
        let first = blocks.first()?;
        let mut s = first.s;
        let mut at = first.curve.start();
        for block in blocks {
            if block.s != s || block.curve.start() != at {
                return None;
            }
            s += block.curve.length();
            at = block.curve.end();
        }
        Some(Self { blocks })
    }

    /// Its blocks.
    pub const fn blocks(&self) -> &'a [Block] {
        self.blocks
    }
    /// Arc length from its start to its end.
    pub fn length(&self) -> Offset {
        match (self.blocks.first(), self.blocks.last()) {
            (Some(first), Some(last)) => last.s + last.curve.length() - first.s,
            _ => Offset::ZERO,
        }
    }
    /// Whether it ends where it starts.
    pub fn is_closed(&self) -> bool {
        match (self.blocks.first(), self.blocks.last()) {
            (Some(first), Some(last)) => first.curve.start() == last.curve.end(),
            _ => false,
        }
    }

    /// How far it runs over its own start again, where it does: its end lies on one of the first blocks, its start on one
    /// of the last, each with their heading, no more than a quarter of its length apart. `None` of a contour that ends
    /// where it starts.
    pub fn overlap(&self) -> Option<Offset> {
        let (first, last) = (self.blocks.first()?, self.blocks.last()?);
        let count = self.blocks.len().min(OVERLAPPED);
        let head = Contour::new(self.blocks.get(..count)?)?;
        let tail = Contour::new(self.blocks.get(self.blocks.len().saturating_sub(count)..)?)?;
        // The first and the last place where a point lies on it: head and tail of a short contour hold each other's ends.
        let on = |of: &Contour, point: Point, heading: Direction| {
            let mut places: Option<(Offset, Offset)> = None;
            of.feet(point, |foot| {
                let along = |s| of.at(s, 0).is_some_and(|place| place.heading.dot(heading) >= ALONG);
                if foot.beside && foot.left.abs() <= ON_ITSELF && along(foot.s) {
                    places = Some((places.map_or(foot.s, |(first, _)| first), foot.s));
                }
            });
            places
        };
        let (overlap, _) = on(&head, last.curve.end(), last.curve.end_heading())?;
        let (_, start) = on(&tail, first.curve.start(), first.curve.start_heading())?;
        let back = tail.length() - start;
        let short = |s: Offset| s > ON_ITSELF && s.nm() <= self.length().nm() / 4;
        (short(overlap) && short(back)).then_some(overlap)
    }

    /// The place at arc length `s` (limited to the contour), found from the block `hint` onwards or backwards, so
    /// that a walk along the contour costs the same per step whatever its length.
    pub fn at(&self, s: Offset, hint: usize) -> Option<Place> {
        let last = self.blocks.len().checked_sub(1)?;
        let s = s + self.blocks.first()?.s;
        let mut index = hint.min(last);
        while index < last && self.blocks.get(index.saturating_add(1))?.s <= s {
            index = index.saturating_add(1);
        }
        while index > 0 && self.blocks.get(index)?.s > s {
            index = index.saturating_sub(1);
        }
        let block = self.blocks.get(index)?;
        let length = block.curve.length();
        let along = Offset::from_nm((s - block.s).nm().clamp(0, length.nm()));
        let fraction = along.over(length);
        Some(Place { point: block.curve.point(fraction), heading: self.heading(index, along)?, block: index })
    }

    /// Direction of travel on block `index` at the distance `along` from its start. Near a facet corner the corner's
    /// turn is spread evenly over half of the shorter neighbour on either side; on an even polyline of a circle this
    /// is the circle's own heading.
    fn heading(&self, index: usize, along: Offset) -> Option<Direction> {
        let block = self.blocks.get(index)?;
        let length = block.curve.length();
        let own = block.curve.heading(along.over(length));
        let before = self.neighbour(index, false).and_then(|b| facet(b, block, along));
        let after = self.neighbour(index, true).and_then(|b| facet(block, b, length - along));
        Some(match (before, after) {
            (None, None) => own,
            (lead, lag) => own.turned(lag.unwrap_or(Real::ZERO) - lead.unwrap_or(Real::ZERO)),
        })
    }

    /// Whether a point, off the end (`after`) or the start of block `index`, lies in the wedge of a facet corner there.
    pub(super) fn in_facet(&self, index: usize, after: bool, point: Point) -> bool {
        let (Some(block), Some(other)) = (self.blocks.get(index), self.neighbour(index, after)) else { return false };
        let (before, behind) = if after { (block, other) } else { (other, block) };
        let (from, to) = (before.curve.end_heading(), behind.curve.start_heading());
        let away = point.from(behind.curve.start());
        from.dot(to) >= FACET_TURN_LIMIT && away.along(from) >= Offset::ZERO && away.along(to) <= Offset::ZERO
    }

    fn neighbour(&self, index: usize, after: bool) -> Option<&'a Block> {
        let last = self.blocks.len().checked_sub(1)?;
        let other = match (after, index) {
            (true, i) if i < last => i.saturating_add(1),
            (false, i) if i > 0 => i.saturating_sub(1),
            (true, _) if self.is_closed() => 0,
            (false, _) if self.is_closed() => last,
            _ => return None,
        };
        self.blocks.get(other)
    }
}

/// The part of the corner's turn that belongs `distance` away from it; `None` outside its reach or at a real corner.
fn facet(before: &Block, after: &Block, distance: Offset) -> Option<Real> {
    let reach = Offset::from_nm(before.curve.length().nm().min(after.curve.length().nm()) / 2);
    if distance >= reach {
        return None;
    }
    let (from, to) = (before.curve.end_heading(), after.curve.start_heading());
    if from == to || from.dot(to) < FACET_TURN_LIMIT {
        return None;
    }
    Some(from.angle_to(to) * Real::HALF * (reach - distance).over(reach))
}
