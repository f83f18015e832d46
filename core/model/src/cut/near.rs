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
    kept: Kept,
    teeth: Teeth,
    /// By the remainder of the number of their sample.
    states: [Option<(usize, State)>; 4],
}

impl<'a> Near<'a> {
    /// Of a machine, and no sample yet.
    pub fn new(machine: &'a Loop<'a>) -> Self {
        Self { machine, kept: Kept::default(), teeth: Teeth::BLANK, states: [None; 4] }
    }

    /// The machine.
    pub const fn machine(&self) -> &Loop<'a> {
        self.machine
    }

    /// Forgets what was asked for.
    pub fn begin_anew(&mut self) {
        (self.kept, self.states) = (Kept::default(), [None; 4]);
    }

    /// The state at a sample; where it is not kept it is settled from the commanded displacement there and a first guess of the
    /// deflection. `None` beyond the path.
    pub fn state(&mut self, sample: usize, begin: impl FnOnce(usize) -> Option<(Vector, Vector)>) -> Option<State> {
        let slot = sample.checked_rem(self.states.len()).and_then(|at| self.states.get_mut(at))?;
        if let Some((at, state)) = slot
            && *at == sample
        {
            return Some(*state);
        }
        let (commanded, guess) = begin(sample)?;
        let (state, _) = self.machine.state(&mut self.kept, sample, commanded, guess)?;
        *slot = Some((sample, state));
        Some(state)
    }

    /// The wall error beside sample `index` at a height that the cutter makes at or between sample `maker` and its neighbours; `begin` as for
    /// [`state`](Self::state). Without the undersize of the machine.
    pub fn wall(
        &mut self,
        (index, maker, height): (usize, usize, Real),
        mut begin: impl FnMut(usize) -> Option<(Vector, Vector)>,
    ) -> Option<Offset> {
        let mut gap = |sample: usize| {
            let state = self.state(sample, &mut begin)?;
            let displacement = self.machine.at_height(&mut self.teeth, &state, height);
            left_by(self.machine.path, index, sample, displacement)
        };
        let own = gap(maker)?;
        Some(lowest_about(maker, own, gap))
    }
}
