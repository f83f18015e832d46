//! The force that a feed makes beside a sample.

use truepath_core::cut::{Loop, State};
use truepath_core::units::{Offset, Real};
use truepath_ground::units::float;

/// What the job allows, with the limit in newtons.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// Lowest and highest feed, percent of the programmed one; 100 lies between them.
    pub percent: [u16; 2],
    /// Largest mean force over a revolution, N.
    pub limit_n: f64,
}

/// The largest mean force at some places of a contour, at the feeds of the program, N; 0 without any.
pub fn largest_force(machine: &Loop, places: impl Iterator<Item = Offset>) -> f64 {
    let load = Load::new(machine);
    places.map(|s| load.newtons(machine.path.index_at(s), 100)).fold(0.0, f64::max)
}

/// Equal walls are equally loaded but for rounding: the one that gives the limit must not slow the others down.
const SLACK: f64 = 1.002;

/// The load of a machine along its path at other feeds than those of the program.
pub(super) struct Load<'a> {
    machine: &'a Loop<'a>,
}

impl<'a> Load<'a> {
    /// Of an identified machine.
    pub(super) const fn new(machine: &'a Loop<'a>) -> Self {
        Self { machine }
    }

    /// Mean force over a revolution at the engagement the program intends, N, for a percentage of the sample's feed.
    pub(super) fn newtons(&self, index: usize, percent: u16) -> f64 {
        self.at(&self.nominal(index), self.feed(index), percent)
    }

    /// The largest percentage in the range whose force is within the limit; the lowest where none is.
    pub(super) fn allowed(&self, index: usize, wanted: &Wanted) -> u16 {
        let (state, feed) = (self.nominal(index), self.feed(index));
        let fits = |percent: u16| self.at(&state, feed, percent) <= SLACK * wanted.limit_n;
        let [mut low, mut high] = wanted.percent;
        if fits(high) {
            return high;
        }
        // The force grows with the feed: `high` is too much, `low` is the best known.
        while high - low > 1 {
            let middle = u16::midpoint(low, high);
            if fits(middle) {
                low = middle;
            } else {
                high = middle;
            }
        }
        low
    }

    fn feed(&self, index: usize) -> Real {
        self.machine.path.samples().get(index).map_or(Real::ZERO, |sample| sample.feed)
    }

    /// The engagement does not depend on the feed.
    fn nominal(&self, index: usize) -> State {
        self.machine.nominal(index, Real::ZERO)
    }

    fn at(&self, state: &State, feed: Real, percent: u16) -> f64 {
        let per_tooth = self.machine.path.setup().feed_per_tooth(feed * Real::ratio(percent.into(), 100));
        let chip_scale = self.machine.coefficients.chip_scale(per_tooth);
        let (normal, along) = self.machine.mean_force(&State { chip_scale, ..*state });
        float(normal).hypot(float(along))
    }
}
