//! The nominal path of the cutter centre as even samples, with the raw stock that lies beside it.
//!
//! The raw stock is the surface an earlier pass left: the parallel curve of the path, radius − allowance towards the
//! wall, or that surface as it was measured. It is held sample by sample beside the path (P23 keeps machined wall, cutting arc and raw stock as three
//! runs of such arrays), so the walk over it costs the same however long the contour is. A closed contour
//! runs on into itself; before the first and behind the last block of any other, path and stock are continued straight: a
//! contour that starts by plunging starts fully engaged.

use super::coarse_look::CoarseLook;
use super::corner;
use super::sample::Sample;
use super::seam::Seam;
use super::setup::{CutSetup, Helix, Runout, WallLaw};
use super::walk::{closes_smoothly, margin, walk};
use truepath_units::Offset;
use truepath_units::geometry::{Contour, FACET_TURN_LIMIT, Point, Side};

/// The sampled path: a straight run-in, the contour, a straight run-out, in a slice lent by the caller.
#[derive(Clone, Copy, Debug)]
pub struct Path<'a> {
    samples: &'a [Sample],
    first: usize,
    count: usize,
    step: Offset,
    stock_step: Offset,
    crowded: bool,
    closed: bool,
    /// Whether the raw stock stands beside every sample.
    stocked: bool,
    look: CoarseLook,
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
    /// The path has so many sharp corners within one diameter of the cutter that no wall stands beside it.
    Jagged {
        /// Line of the program that is too much.
        line: u32,
    },
}

/// How much narrower than the cutter an arc round an edge may be: a cutter measures a little more than it is called, and
/// programs round.
const TOO_WIDE: Offset = Offset::from_um(50);
/// Sharp corners that a path may have within one diameter of the cutter. It is also what bounds the samples that any step
/// of the cut looks at: every corner has hundreds.
const MOST_CORNERS: usize = 32;

impl<'a> Path<'a> {
    /// How many samples [`Path::sample`] needs at a step.
    pub fn samples_needed(contour: &Contour, setup: &CutSetup, step: Offset) -> usize {
        let mut count = 0usize;
        walk(contour, setup, step, |_| count = count.saturating_add(1));
        count
    }

    /// Samples a contour at about `step` (even on each block). `shape` may change the stock and the feed of each sample,
    /// which are the parallel curve at the allowance and the programmed feed: for the wall that a first pass left, or a feed
    /// that changes within a block.
    ///
    /// # Errors
    /// [`PathError`] when the buffer is too short or path and cutter leave no wall.
    pub fn sample(
        contour: &Contour,
        setup: &CutSetup,
        step: Offset,
        buffer: &'a mut [Sample],
        mut shape: impl FnMut(&mut Sample),
    ) -> Result<Self, PathError> {
        for block in contour.blocks() {
            // The wall lies inside an arc that turns towards it: the arc must be as wide as the cutter (and is
            // exactly that where a control rolls round a sharp corner).
            if let Some(radius) = block.curve.signed_radius() {
                let towards_wall = (radius > Offset::ZERO) == (setup.wall == Side::Left);
                if towards_wall && radius.abs() + TOO_WIDE < setup.radius {
                    return Err(PathError::NoWall { line: block.line });
                }
            }
        }
        if let Some(line) = jagged(contour, setup) {
            return Err(PathError::Jagged { line });
        }
        let needed = Self::samples_needed(contour, setup, step);
        let lent = buffer.len();
        if needed > lent {
            return Err(PathError::BufferTooShort { needed, lent });
        }
        let mut slots = buffer.iter_mut();
        walk(contour, setup, step, |mut sample| {
            if let Some(slot) = slots.next() {
                shape(&mut sample);
                *slot = sample;
            }
        });
        let used = buffer.get_mut(..needed).unwrap_or_default();
        corner::mark(used, setup);
        corner::mark_rolled(used, contour, setup);
        if let Some(seam) = Seam::of(contour, setup) {
            seam.mark(used, setup);
        }
        let samples: &'a [Sample] = used;
        let inside = |s: &&Sample| s.s >= Offset::ZERO && s.s <= contour.length();
        let first = samples.iter().take_while(|s| s.s < Offset::ZERO).count();
        let count = samples.iter().filter(inside).count();
        let (step, stock_step) = (widest(samples, |s| s.point), widest(samples, |s| s.stock));
        let crowds = |(a, b): (&Sample, &Sample)| a.point.distance(b.point).nm().saturating_mul(8) < step.nm();
        let crowded = samples.iter().zip(samples.iter().skip(1)).any(crowds);
        let (closed, helix) = (closes_smoothly(contour, setup), setup.helix());
        let stocked = samples.iter().all(|s| s.on_surface);
        let look = CoarseLook::of(samples, setup, step);
        Ok(Self { samples, first, count, step, stock_step, crowded, closed, stocked, look, setup: *setup, helix })
    }

    /// The same path with its raw stock moved along the normal of every sample by `shift`, positive towards the wall, in a
    /// buffer as long as its samples.
    pub fn with_stock_moved<'b>(&self, buffer: &'b mut [Sample], mut shift: impl FnMut(&Sample) -> Offset) -> Path<'b> {
        let count = self.samples.len().min(buffer.len());
        let used = buffer.get_mut(..count).unwrap_or_default();
        for (slot, sample) in used.iter_mut().zip(self.samples) {
            *slot = Sample { stock: sample.stock + sample.normal.times(shift(sample)), ..*sample };
        }
        let samples: &'b [Sample] = used;
        let stock_step = widest(samples, |s| s.stock);
        Path { samples, stock_step, ..*self }
    }

    /// The same path under another wall law.
    pub const fn with_law(mut self, law: WallLaw) -> Self {
        self.setup.law = law;
        self
    }
    /// The same path for a cutter that runs out otherwise.
    pub const fn with_runout(mut self, runout: Runout) -> Self {
        self.setup.runout = runout;
        self
    }
    /// All samples, run-in and run-out included.
    pub const fn samples(&self) -> &'a [Sample] {
        self.samples
    }
    /// Whether the normal turns at a sample while the centre stays: between the end of one leg of a sharp inside corner and the
    /// start of the other.
    pub fn is_pivot(&self, index: usize) -> bool {
        let at = |i: usize| self.samples.get(i).map(|s| s.point);
        let here = at(index);
        here.is_some() && index.checked_sub(1).and_then(at) == here && at(index.saturating_add(1)) == here
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
    /// Whether samples stand much closer together in some places than in others.
    pub(super) const fn is_crowded(&self) -> bool {
        self.crowded
    }
    /// What is known of the coarse looks of its envelope.
    pub(super) const fn coarse_look(&self) -> &CoarseLook {
        &self.look
    }
    /// The same path, of which nothing is known there.
    #[cfg(test)]
    pub(super) const fn without_clearance(mut self) -> Self {
        self.look.clearance = 0;
        self
    }
    /// Whether the raw stock stands beside every sample: nowhere ends it at a corner.
    pub(super) const fn is_stocked(&self) -> bool {
        self.stocked
    }
    /// Whether the end of the contour runs on into its start: there is then no seam.
    pub const fn is_closed(&self) -> bool {
        self.closed
    }
    /// Length of the contour itself.
    pub fn length(&self) -> Offset {
        self.samples.get(self.first.saturating_add(self.count).saturating_sub(1)).map_or(Offset::ZERO, |s| s.s)
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
        self.nearest(s, self.samples.partition_point(|x| x.s < s))
    }
    /// As [`index_at`](Self::index_at), the sooner found the nearer it is to `about`.
    pub(super) fn index_near(&self, s: Offset, about: usize) -> usize {
        self.nearest(s, self.first_not(|x| x.s < s, about))
    }
    /// Index of the first sample beyond an arc length, the sooner found the nearer it is to `about`.
    pub(super) fn first_beyond(&self, s: Offset, about: usize) -> usize {
        self.first_not(|x| x.s <= s, about)
    }
    /// The first sample of which something does not hold that holds of all before it and of none behind, the sooner found the nearer it
    /// is to `about`.
    #[inline]
    fn first_not(&self, holds: impl Fn(&Sample) -> bool, about: usize) -> usize {
        let is_before = |i: usize| self.samples.get(i).is_some_and(&holds);
        // It lies in from..=to.
        let (mut from, mut to) = (about, about);
        let mut stride = 1usize;
        while is_before(to) {
            (from, to) = (to.saturating_add(1), to.saturating_add(stride));
            stride = stride.saturating_mul(2);
        }
        stride = 1;
        while from > 0 && !is_before(from.saturating_sub(1)) {
            to = from.saturating_sub(1);
            from = from.saturating_sub(stride);
            stride = stride.saturating_mul(2);
        }
        while from < to {
            let middle = from.midpoint(to);
            if is_before(middle) { from = middle.saturating_add(1) } else { to = middle }
        }
        from
    }
    /// Of the sample at `after`, the first at or behind an arc length, and the one before it, the nearer one.
    fn nearest(&self, s: Offset, after: usize) -> usize {
        let after = after.min(self.samples.len().saturating_sub(1));
        let before = after.saturating_sub(1);
        match (self.samples.get(before), self.samples.get(after)) {
            (Some(a), Some(b)) if (s - a.s) < (b.s - s) => before,
            _ => after,
        }
    }
}

/// The largest distance from one point of the samples to the next.
fn widest(samples: &[Sample], of: impl Fn(&Sample) -> Point) -> Offset {
    let pairs = samples.iter().zip(samples.iter().skip(1));
    pairs.map(|(a, b)| of(a).distance(of(b))).max().unwrap_or_default()
}

/// The line at which a path has had more than [`MOST_CORNERS`] sharp corners within one diameter of the cutter.
fn jagged(contour: &Contour, setup: &CutSetup) -> Option<u32> {
    let blocks = contour.blocks();
    let mut corners = [None; MOST_CORNERS];
    let mut slots = (0..MOST_CORNERS).cycle();
    for (before, block) in blocks.iter().zip(blocks.iter().skip(1)) {
        if before.curve.end_heading().dot(block.curve.start_heading()) >= FACET_TURN_LIMIT {
            continue;
        }
        let oldest = slots.next().and_then(|slot| corners.get_mut(slot))?;
        if oldest.is_some_and(|s| block.s - s < setup.radius + setup.radius) {
            return Some(block.line);
        }
        *oldest = Some(block.s);
    }
    None
}
