//! Which walls a pass of the cutter leaves as they were.
//!
//! After a few refinements most of a correction stays as it is, and only what lies beside corners still changes. A wall that no cutter
//! position near it has moved from is the one that was read before.

use super::profile::Profile;
use crate::cut::Path;
use truepath_units::{Offset, Real};

/// How far along the path a cutter position may be from a wall that it makes, as a part of the radius: what an envelope looks at, half a
/// radius to either side, and what its descent goes beyond that.
const REACH: Real = Real::ratio(5, 8);

/// Cutter positions that a pass has moved: those of the contour are marked in its profiles.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Moved {
    /// The last of the run-in.
    before: Option<Offset>,
    /// The first of the run-out.
    behind: Option<Offset>,
}

impl Moved {
    /// Takes note of a sample, of which the cutter has moved or not. Samples come in their order.
    pub(super) fn note(&mut self, path: &Path, index: usize, moved: bool, profiles: &mut [Profile]) {
        let slot = index.checked_sub(path.first());
        if let Some(profile) = slot.and_then(|slot| profiles.get_mut(slot)) {
            profile.set_current(!moved);
        } else if moved {
            let at = path.samples().get(index).map(|sample| sample.s);
            if slot.is_none() { self.before = at } else { self.behind = self.behind.or(at) }
        }
    }

    /// When all samples are noted: marks every wall that one of them may make.
    pub(super) fn spread(self, path: &Path, profiles: &mut [Profile]) {
        let reach = path.setup().radius.scaled(REACH);
        let at = |slot: usize| path.samples().get(path.first().saturating_add(slot)).map_or(Offset::MAX, |s| s.s);
        let (mut last, mut ahead) = (self.before, 0usize);
        for slot in 0..profiles.len() {
            let here = at(slot);
            // The last that has moved up to as far ahead as it reaches; what is marked here lies behind that already.
            while let Some(profile) = profiles.get(ahead)
                && at(ahead) <= here + reach
            {
                last = if profile.is_current() { last } else { Some(at(ahead)) };
                ahead = ahead.saturating_add(1);
            }
            let near = |moved: Offset| (moved - here).abs() <= reach;
            if let Some(profile) = profiles.get_mut(slot) {
                profile.set_current(![last, self.behind].into_iter().flatten().any(near));
            }
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects, clippy::indexing_slicing, clippy::unwrap_used)]
    use super::*;
    use crate::cut::{CutSetup, Milling, Runout, Sample, WallLaw};
    use proptest::prelude::*;
    use std::vec::Vec;
    use truepath_units::geometry::{Block, Contour, Curve, Point, Side};

    proptest! {
        /// Compared with every sample asked about every place.
        #[test]
        fn what_is_marked_lies_within_reach_of_a_sample_that_moved(moved in prop::collection::vec(prop::bool::weighted(0.01), 400)) {
            let setup = CutSetup {
                radius: Offset::from_um(3_000),
                teeth: 4,
                helix_deg: Real::from_int(30),
                axial_depth: Real::from_int(10),
                allowance: Offset::from_um(500),
                spindle_rpm: Real::from_int(4000),
                wall: Side::Right,
                milling: Milling::of(Side::Right, true),
                law: WallLaw::Helical,
                runout: Runout::NONE,
            };
            let curve = Curve::line(Point::from_nm(0, 0), Point::from_nm(20_000_000, 0)).unwrap();
            let blocks = [Block { curve, s: Offset::ZERO, feed: Real::from_int(800), line: 1 }];
            let contour = Contour::new(&blocks).unwrap();
            let step = Offset::from_um(100);
            let mut buffer = std::vec![Sample::BLANK; Path::samples_needed(&contour, &setup, step)];
            let path = Path::sample(&contour, &setup, step, &mut buffer, |_| ()).unwrap();
            let working = path.working();
            let mut profiles = std::vec![Profile::default(); path.count()];
            let mut note = Moved::default();
            let is_moved = |index: usize| moved[index % moved.len()];
            working.clone().for_each(|index| note.note(&path, index, is_moved(index), &mut profiles));
            note.spread(&path, &mut profiles);
            let s = |index: usize| path.samples()[index].s;
            let sources: Vec<Offset> = working.filter(|index| is_moved(*index)).map(s).collect();
            for (slot, profile) in profiles.iter().enumerate() {
                let here = s(path.first() + slot);
                let is_near = sources.iter().any(|s| (*s - here).abs() <= Offset::from_um(1_875));
                prop_assert_eq!(profile.is_current(), !is_near, "{}", slot);
            }
        }
    }
}
