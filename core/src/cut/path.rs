//! The nominal path of the cutter centre as even samples, with the raw stock that lies beside it.
//!
//! The raw stock is the surface an earlier pass left: the parallel curve of the path, radius − allowance towards the
//! wall. It is held sample by sample beside the path (P23 keeps machined wall, cutting arc and raw stock as three
//! runs of such arrays), so the walk over it costs the same however long the contour is. Before the first and behind
//! the last block path and stock are continued straight: a contour that starts by plunging starts fully engaged.

use super::setup::{CutSetup, Helix, WallLaw};
use crate::geometry::{Contour, Direction, FACET_TURN_LIMIT, Point, Side};
use crate::units::{Offset, Real};

/// One sample of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Sample {
    /// Arc length from the start of the contour; negative before it.
    pub s: Offset,
    /// Nominal cutter centre.
    pub point: Point,
    /// Normal towards the wall.
    pub normal: Direction,
    /// Raw stock surface beside it.
    pub stock: Point,
    /// Programmed feed, mm/min.
    pub feed: Real,
    /// Index of the block.
    pub block: u32,
    /// Whether `stock` is part of the surface; at a sharp outside corner the parallel curve crosses itself.
    pub on_surface: bool,
}

impl Sample {
    /// What a lent buffer is filled with before a path is sampled into it.
    pub const BLANK: Self = Self {
        s: Offset::ZERO,
        point: Point::from_nm(0, 0),
        normal: Direction::X,
        stock: Point::from_nm(0, 0),
        feed: Real::ZERO,
        block: 0,
        on_surface: true,
    };
}

/// The sampled path: a straight run-in, the contour, a straight run-out, in a slice lent by the caller.
#[derive(Clone, Copy, Debug)]
pub struct Path<'a> {
    samples: &'a [Sample],
    first: usize,
    count: usize,
    step: Offset,
    stock_step: Offset,
    setup: CutSetup,
    helix: Helix,
}

/// Why a path could not be sampled.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PathError {
    /// The lent slice holds fewer samples than the contour needs.
    BufferTooShort {
        /// Samples needed.
        needed: usize,
        /// Samples lent.
        lent: usize,
    },
    /// The path turns so tightly away from the wall that the cutter would undercut it.
    NoWall {
        /// Line of the program.
        line: u32,
    },
}

/// A turn of the normal at a sharp inside corner is sampled this finely, rad.
const PIVOT_STEP: Real = Real::ratio(1, 100);

impl<'a> Path<'a> {
    /// How many samples [`Path::sample`] needs at a step.
    pub fn samples_needed(contour: &Contour, setup: &CutSetup, step: Offset) -> usize {
        let mut count = 0usize;
        walk(contour, setup, step, |_| count = count.saturating_add(1));
        count
    }

    /// Samples a contour at about `step` (even on each block).
    ///
    /// # Errors
    /// [`PathError`] when the buffer is too short or an arc leaves no wall.
    pub fn sample(
        contour: &Contour,
        setup: &CutSetup,
        step: Offset,
        buffer: &'a mut [Sample],
    ) -> Result<Self, PathError> {
        for block in contour.blocks() {
            // The wall lies inside an arc that turns towards it: the arc must be wider than the cutter.
            if let Some(radius) = block.curve.signed_radius() {
                let towards_wall = (radius > Offset::ZERO) == (setup.wall == Side::Left);
                if towards_wall && radius.abs() <= setup.radius - setup.allowance {
                    return Err(PathError::NoWall { line: block.line });
                }
            }
        }
        let needed = Self::samples_needed(contour, setup, step);
        let lent = buffer.len();
        if needed > lent {
            return Err(PathError::BufferTooShort { needed, lent });
        }
        let mut slots = buffer.iter_mut();
        walk(contour, setup, step, |sample| {
            if let Some(slot) = slots.next() {
                *slot = sample;
            }
        });
        let used = buffer.get_mut(..needed).unwrap_or_default();
        remove_crossings(used, setup);
        let samples: &'a [Sample] = used;
        let inside = |s: &&Sample| s.s >= Offset::ZERO && s.s <= contour.length();
        let first = samples.iter().take_while(|s| s.s < Offset::ZERO).count();
        let count = samples.iter().filter(inside).count();
        let gap = |f: fn(&Sample) -> Point| {
            samples.iter().zip(samples.iter().skip(1)).map(|(a, b)| f(a).distance(f(b))).max().unwrap_or_default()
        };
        let (step, stock_step) = (gap(|s| s.point), gap(|s| s.stock));
        Ok(Self { samples, first, count, step, stock_step, setup: *setup, helix: setup.helix() })
    }

    /// The same path under another wall law.
    pub const fn with_law(mut self, law: WallLaw) -> Self {
        self.setup.law = law;
        self
    }
    /// All samples, run-in and run-out included.
    pub const fn samples(&self) -> &'a [Sample] {
        self.samples
    }
    /// The samples on which the cut is computed: the contour and, on either side, as much of the straight run as
    /// shapes its wall.
    pub fn working(&self) -> core::ops::Range<usize> {
        let margin = margin(&self.setup);
        let end =
            self.samples.get(self.first.saturating_add(self.count).saturating_sub(1)).map_or(Offset::ZERO, |s| s.s);
        let from = self.samples.partition_point(|s| s.s < -margin);
        from..self.samples.partition_point(|s| s.s <= end + margin)
    }
    /// Index of the first sample of the contour itself.
    pub const fn first(&self) -> usize {
        self.first
    }
    /// Number of samples of the contour itself.
    pub const fn count(&self) -> usize {
        self.count
    }
    /// The largest distance between neighbouring samples of the path.
    pub const fn step(&self) -> Offset {
        self.step
    }
    /// The largest distance between neighbouring samples of the raw stock.
    pub const fn stock_step(&self) -> Offset {
        self.stock_step
    }
    /// The cut it was sampled for.
    pub const fn setup(&self) -> &CutSetup {
        &self.setup
    }
    /// How its cutter's edges wind.
    pub const fn helix(&self) -> &Helix {
        &self.helix
    }
    /// Nominal wall beside a sample.
    pub fn wall(&self, sample: &Sample) -> Point {
        sample.point + sample.normal.times(self.setup.radius)
    }
    /// Index of the sample nearest to an arc length of the contour.
    pub fn index_at(&self, s: Offset) -> usize {
        let after = self.samples.partition_point(|x| x.s < s).min(self.samples.len().saturating_sub(1));
        let before = after.saturating_sub(1);
        match (self.samples.get(before), self.samples.get(after)) {
            (Some(a), Some(b)) if (s - a.s) < (b.s - s) => before,
            _ => after,
        }
    }
}

/// How far beyond the contour's ends the cutter positions still shape its wall: the reach of the envelope.
fn margin(setup: &CutSetup) -> Offset {
    Offset::from_nm(setup.radius.nm() / 2)
}

/// Length of the straight run before and behind the contour: the margin, and from there the look-ahead of the
/// engagement (2.2 radii).
fn run_out(setup: &CutSetup) -> Offset {
    margin(setup) + setup.radius.scaled(Real::ratio(23, 10))
}

/// Produces the samples in order: even steps on every block, so that the ends of blocks, where the engagement has its
/// kinks, are samples; at a sharp inside corner the normal turns on the spot, which is how the wall there is formed.
fn walk(contour: &Contour, setup: &CutSetup, step: Offset, mut emit: impl FnMut(Sample)) {
    let blocks = contour.blocks();
    let (Some(start), Some(end)) = (blocks.first(), blocks.last()) else { return };
    let reach = setup.radius - setup.allowance;
    let mut give = |s: Offset, point: Point, heading: Direction, block: usize| {
        let normal = setup.wall.normal(heading);
        let feed = blocks.get(block).map_or(Real::ZERO, |b| b.feed);
        let stock = point + normal.times(reach);
        emit(Sample { s, point, normal, stock, feed, block: block as u32, on_surface: true });
    };
    let straight = run_out(setup);
    let steps = pieces(straight, step);
    let (point, heading) = (start.curve.start(), start.curve.start_heading());
    for k in 0..steps {
        let back = straight.scaled(Real::ratio(steps.saturating_sub(k), steps));
        give(-back, point - heading.times(back), heading, 0);
    }
    for (index, block) in blocks.iter().enumerate() {
        let before = index.checked_sub(1).and_then(|i| blocks.get(i));
        if let Some(before) = before {
            pivot(before.curve.end_heading(), block.curve.start_heading(), setup, |heading| {
                give(block.s - start.s, block.curve.start(), heading, index);
            });
        }
        let steps = pieces(block.curve.length(), step);
        for k in 0..steps {
            let s = block.s - start.s + block.curve.length().scaled(Real::ratio(k, steps));
            if let Some(place) = contour.at(s, index) {
                give(s, place.point, place.heading, index);
            }
        }
    }
    if let Some(place) = contour.at(contour.length(), blocks.len()) {
        give(contour.length(), place.point, place.heading, place.block);
    }
    let steps = pieces(straight, step);
    let (point, heading) = (end.curve.end(), end.curve.end_heading());
    for k in 1..=steps {
        let ahead = straight.scaled(Real::ratio(k, steps));
        give(contour.length() + ahead, point + heading.times(ahead), heading, blocks.len().saturating_sub(1));
    }
}

fn pieces(length: Offset, step: Offset) -> i64 {
    let step = step.nm().max(1);
    length.nm().saturating_add(step.saturating_sub(1)).checked_div(step).unwrap_or(1).max(1)
}

/// Headings between two, when the corner opens towards the wall (an inside corner of the part).
fn pivot(from: Direction, to: Direction, setup: &CutSetup, mut emit: impl FnMut(Direction)) {
    let turn = from.angle_to(to);
    let inside = (turn > Real::ZERO) == (setup.wall == Side::Right);
    if !inside || from.dot(to) >= FACET_TURN_LIMIT {
        return;
    }
    let steps = (turn.abs() / PIVOT_STEP).floor().max(1);
    for k in 0..steps {
        emit(from.turned(turn * Real::ratio(k, steps)));
    }
}

/// Drops stock samples that an earlier pass along the same path removed: at a sharp outside corner the parallel
/// curve of one leg lies within reach of the other.
fn remove_crossings(samples: &mut [Sample], setup: &CutSetup) {
    let reach = setup.radius - setup.allowance;
    let limit = reach - Offset::from_um(1);
    let outside_corner = |a: &Sample, b: &Sample| {
        let turn = a.normal.cross(b.normal);
        let towards_wall = (turn > Real::ZERO) == (setup.wall == Side::Left);
        towards_wall && a.normal.dot(b.normal) < FACET_TURN_LIMIT
    };
    let mut corner = 1usize;
    while corner < samples.len() {
        let is_corner = match (samples.get(corner.saturating_sub(1)), samples.get(corner)) {
            (Some(a), Some(b)) => outside_corner(a, b),
            _ => false,
        };
        if is_corner {
            let (left, right) = samples.split_at_mut(corner);
            let near = |from: Point| move |s: &&mut Sample| s.point.distance(from) <= reach + reach;
            let at = right.first().map(|s| s.point).unwrap_or_default();
            for a in left.iter_mut().rev().take_while(near(at)) {
                for b in right.iter_mut().take_while(near(at)) {
                    a.on_surface &= a.stock.distance(b.point) >= limit;
                    b.on_surface &= b.stock.distance(a.point) >= limit;
                }
            }
        }
        corner = corner.saturating_add(1);
    }
}
