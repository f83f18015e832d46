//! The stock that is left on a wall.

use super::slices::Slices;
use crate::cut::Path;
use truepath_units::Offset;

/// The wall that the cutter of a pass would leave, were there stock everywhere.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Wall {
    /// Material left (positive); `None` where no wall stands or the pass does not reach down.
    pub error: Option<Offset>,
    /// Sample of the contour whose cutter made it, counted from the first of the contour; limited to the contour.
    pub made_by: u32,
}

/// The remaining stock along the normal at every sample of a path (run-in and run-out included) and in every slice of the
/// height: positive is material left, negative a wall that was cut too deep. In a slice lent by the caller, all slices of a sample
/// side by side.
#[derive(Debug)]
pub struct Part<'a> {
    slices: Slices,
    left: &'a mut [Offset],
    most: Offset,
}

impl<'a> Part<'a> {
    /// Lengths that [`Part::raw`] needs.
    pub fn needed(path: &Path, slices: Slices) -> usize {
        path.samples().len().saturating_mul(slices.count())
    }

    /// The raw part: the stock of the path, even over the height. `None` when the lent slice is too short.
    pub fn raw(path: &Path, slices: Slices, lent: &'a mut [Offset]) -> Option<Self> {
        let left = lent.get_mut(..Self::needed(path, slices))?;
        let radius = path.setup().radius;
        for (sample, heights) in path.samples().iter().zip(left.chunks_mut(slices.count())) {
            heights.fill(radius - sample.stock.from(sample.point).along(sample.normal));
        }
        let mut part = Self { slices, left, most: Offset::ZERO };
        part.measure();
        Some(part)
    }

    /// A part whose stock is known: as [`Part::left`] gave it.
    pub fn of(slices: Slices, left: &'a mut [Offset]) -> Self {
        let mut part = Self { slices, left, most: Offset::ZERO };
        part.measure();
        part
    }

    /// The stock, all slices of a sample side by side.
    pub const fn left(&self) -> &[Offset] {
        self.left
    }
    /// Its slices.
    pub const fn slices(&self) -> Slices {
        self.slices
    }
    /// The most that is left anywhere.
    pub const fn most(&self) -> Offset {
        self.most
    }
    /// What is left beside a sample of the path, slice by slice; nothing beyond the path.
    pub fn beside(&self, sample: usize) -> &[Offset] {
        let from = sample.saturating_mul(self.slices.count());
        self.left.get(from..from.saturating_add(self.slices.count())).unwrap_or_default()
    }

    /// Takes the envelope of a pass away: `walls` as [`Mill::walls`](super::Mill::walls) read them. Before the first and
    /// behind the last sample of an open contour the wall goes on as at its ends.
    pub fn take(&mut self, path: &Path, walls: &[Wall]) {
        let count = self.slices.count();
        for (index, own) in walls.chunks(count).enumerate() {
            let from = path.first().saturating_add(index).saturating_mul(count);
            let beside = self.left.get_mut(from..from.saturating_add(count)).unwrap_or_default();
            for (left, wall) in beside.iter_mut().zip(own) {
                if let Some(error) = wall.error {
                    *left = (*left).min(error);
                }
            }
        }
        let last = path.first().saturating_add(path.count()).saturating_sub(1);
        for index in (0..path.samples().len()).filter(|i| *i < path.first() || *i > last) {
            let like = if path.is_closed() {
                let round = if index < path.first() { path.length() } else { -path.length() };
                let s = path.samples().get(index).map_or(Offset::ZERO, |sample| sample.s);
                path.index_at(s + round).clamp(path.first(), last)
            } else {
                index.clamp(path.first(), last)
            };
            let from = like.saturating_mul(count);
            let to = index.saturating_mul(count);
            if to.saturating_add(count) <= self.left.len() {
                self.left.copy_within(from..from.saturating_add(count), to);
            }
        }
        self.measure();
    }

    fn measure(&mut self) {
        self.most = self.left.iter().copied().max().unwrap_or_default();
    }
}
