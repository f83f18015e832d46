//! The cutter of one machine, asked for sample by sample near a run that is known.

use super::elastic::{Kept, Loop, State};
use super::teeth::Teeth;
use super::wall::{left_by, lowest_about};
use truepath_units::geometry::Vector;
use truepath_units::{Offset, Real};

/// States of a machine at samples near each other, the last of them kept: walls beside one place, at several heights, are made by
/// few cutter positions.
///
/// A machine that differs a little from one whose walls are known moves each of them as it moves the position that made it. That
/// another position makes it then is of second order.
#[derive(Debug)]
pub struct Near<'a> {
    machine: &'a Loop<'a>,
    /// Whether the run that is known is its own.
    is_known: bool,
    kept: Kept,
    teeth: Teeth,
    /// By how much its deflection was another one than that of the run at the last sample: it hardly changes from place to place.
    change: Vector,
    /// By the remainder of the number of their sample.
    states: [Option<(usize, State)>; 4],
}

impl<'a> Near<'a> {
    /// Of another machine than that of the run, and no sample yet.
    pub fn new(machine: &'a Loop<'a>) -> Self {
        let (kept, teeth, change) = (Kept::default(), Teeth::BLANK, Vector::ZERO);
        Self { machine, is_known: false, kept, teeth, change, states: [None; 4] }
    }

    /// Of the machine of the run itself.
    pub fn known(machine: &'a Loop<'a>) -> Self {
        Self { is_known: true, ..Self::new(machine) }
    }

    /// The machine.
    pub const fn machine(&self) -> &Loop<'a> {
        self.machine
    }

    /// The state at a sample, with the command of the run there, and settled from about its deflection where it is not kept. `run` tells the
    /// states that are known; `None` beyond them.
    fn state(&mut self, sample: usize, run: impl FnOnce(usize) -> Option<State>) -> Option<State> {
        if self.is_known {
            return run(sample);
        }
        let slot = sample.checked_rem(self.states.len()).and_then(|at| self.states.get_mut(at))?;
        if let Some((at, state)) = slot
            && *at == sample
        {
            return Some(*state);
        }
        let State { commanded, displacement, .. } = run(sample)?;
        let guess = displacement + self.change;
        let (state, _) = self.machine.state(&mut self.kept, sample, commanded, guess)?;
        self.change = state.displacement - displacement;
        *slot = Some((sample, state));
        Some(state)
    }

    /// The wall error beside sample `index` at a height that the cutter makes at or between sample `maker` and its neighbours, without the
    /// undersize of the machine. `run` tells the states that are known.
    pub fn wall(
        &mut self,
        (index, maker, height): (usize, usize, Real),
        run: impl Fn(usize) -> Option<State>,
    ) -> Option<Offset> {
        let mut gap = |sample: usize| {
            let state = self.state(sample, &run)?;
            let displacement = self.machine.at_height(&mut self.teeth, &state, height);
            left_by(self.machine.path, index, sample, displacement)
        };
        let own = gap(maker)?;
        Some(lowest_about(maker, own, gap))
    }
}
