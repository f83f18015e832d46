//! The feeds along a contour, in whole percents of the programmed ones.

use truepath_core::cut::{Loop, Path, Sample};
use truepath_core::units::{Offset, Real};

use super::force::{Load, Wanted};
use super::steps::{Change, steps};

/// The feeds along a contour. The first change is at its start.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Schedule {
    changes: Vec<Change>,
    /// Length of the contour, when its end runs on into its start.
    closed: Option<Offset>,
}

/// The feeds with which the force stays under the limit as far as the range allows; `None` when those of the program
/// do.
pub fn schedule(machine: &Loop, wanted: &Wanted) -> Option<Schedule> {
    let path = machine.path;
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let load = Load::new(machine);
    let allowed: Vec<(Offset, u16)> =
        samples.iter().enumerate().map(|(k, sample)| (sample.s, load.allowed(path.first() + k, wanted))).collect();
    let mut changes = steps(&allowed, wanted.percent, path.is_closed());
    for change in &mut changes {
        change.from = beside_block(samples, change.from);
    }
    let changed = changes.iter().any(|change| change.percent != 100);
    changed.then(|| Schedule { changes, closed: closed(path) })
}

/// How far a change is moved to an end of a block near it, so that no block is divided into crumbs.
const NEAR: Offset = Offset::from_um(400);

/// The nearest start of a block within reach of a place, else the place.
fn beside_block(samples: &[Sample], place: Offset) -> Offset {
    let starts = samples.windows(2).filter(|pair| pair[0].block != pair[1].block).map(|pair| pair[1].s);
    let near = starts.filter(|start| (*start - place).abs() <= NEAR);
    near.min_by_key(|start| (*start - place).abs()).unwrap_or(place)
}

fn closed(path: &Path) -> Option<Offset> {
    path.is_closed().then(|| path.length())
}

impl Schedule {
    /// The changes in the order of the contour.
    pub fn changes(&self) -> &[Change] {
        &self.changes
    }

    /// Percent of the programmed feed at an arc length; before and behind the contour that of its end, or of its other
    /// end where it is closed.
    pub fn percent(&self, s: Offset) -> u16 {
        let s = match self.closed {
            Some(length) if s < Offset::ZERO => s + length,
            Some(length) if s >= length => s - length,
            _ => s,
        };
        let behind = self.changes.partition_point(|change| change.from <= s);
        self.changes.get(behind.saturating_sub(1)).map_or(100, |change| change.percent)
    }

    /// The feed at an arc length whose programmed one is given.
    pub fn feed(&self, s: Offset, programmed: Real) -> Real {
        programmed * Real::ratio(self.percent(s).into(), 100)
    }
}
