//! The move of a block, and whether it can be checked.

use super::apply::OneShot;
use super::block::{AXES, Block};
use super::codes::Motion;
use super::reason::Reason;
use super::state::{Place, Reading, State};
use super::step::{Move, Step, Trouble};

impl State {
    /// Moves the axes that the block names.
    pub(super) fn motion(
        &mut self,
        block: &Block,
        text: &[u8],
        reading: &Reading,
        shot: OneShot,
    ) -> Result<Step, Trouble> {
        if shot.elsewhere {
            let turning = (3..6).any(|axis| block.axis(axis).is_some());
            let named: Vec<usize> = (0..6).filter(|&axis| block.axis(axis).is_some()).collect();
            if named.is_empty() {
                self.forget(0..6)
            } else {
                self.forget(named)
            }
            let cuts = turning && shot.machine && self.cuts();
            return Ok(if cuts { Step::Unchecked(Reason::Elsewhere) } else { Step::Nothing });
        }
        if shot.dwell || shot.table || !block.names_axes() {
            return Ok(Step::Nothing);
        }
        let from = self.at;
        let to = self.destination(block, text, reading)?;
        let moves = |axis: usize| block.axis(axis).is_some() && (from[axis].is_none() || from[axis] != to[axis]);
        let turns = (3..6).any(moves);
        let travels = (0..3).any(moves);
        self.at = to;
        if shot.unknown {
            self.forget((0..6).filter(|&axis| block.axis(axis).is_some()));
            return Ok(if turns && self.cuts() { Step::Unchecked(Reason::UnknownCode) } else { Step::Nothing });
        }
        let step = match self.motion {
            Motion::None => {
                let word = (0..6).find_map(|axis| block.axis(axis)).copied();
                return Err(word.map_or(Trouble::FeedMissing, Trouble::NoMotion));
            }
            Motion::Traverse => Step::Nothing,
            Motion::Arc if turns => Step::Unchecked(Reason::Arc),
            Motion::Arc => Step::Nothing,
            Motion::Other(_) | Motion::Probe => {
                // A cycle leaves Z at its retract level, a probe stops where it touches.
                let probing = self.motion == Motion::Probe;
                self.forget((0..6).filter(|&axis| axis == 2 || (probing && block.axis(axis).is_some())));
                if turns { Step::Unchecked(Reason::Curve) } else { Step::Nothing }
            }
            Motion::Feed if !turns => Step::Straight,
            Motion::Feed => {
                if self.lacks_inverse_time(block) {
                    return Err(Trouble::FeedMissing);
                }
                self.check(block, from, to, travels, reading)
            }
        };
        Ok(step)
    }

    fn destination(&self, block: &Block, text: &[u8], reading: &Reading) -> Result<Place, Trouble> {
        let mut to = self.at;
        for (axis, to) in to.iter_mut().enumerate() {
            let Some(word) = block.axis(axis) else { continue };
            let value = self.value(word, axis, text, reading.decimal).ok_or(Trouble::TooFar(*word))?;
            *to = match (self.absolute, self.at[axis]) {
                (true, _) => Some(value),
                (false, None) => None,
                (false, Some(at)) => Some(at.plus(value, self.scale(axis)).ok_or(Trouble::TooFar(*word))?),
            };
        }
        Ok(to)
    }

    /// A G1 that turns a rotary axis.
    fn check(&mut self, block: &Block, from: Place, to: Place, travels: bool, reading: &Reading) -> Step {
        let reason = self
            .compensation
            .map(Reason::Compensation)
            .or_else(|| self.transforms.iter().flatten().next().map(|&line| Reason::Transform(line)))
            .or_else(|| block.corner.as_ref().map(|_| Reason::Corner))
            .or_else(|| self.offsets_lost.or(self.offsets_changed).map(Reason::Offsets))
            .or_else(|| self.tool_changed.map(Reason::Tool));
        if let Some(reason) = reason {
            return Step::Unchecked(reason);
        }
        let needed: Vec<usize> = (0..6).filter(|&axis| axis < 3 || reading.rotary[axis - 3]).collect();
        let unknown = |axis: usize| match (self.local[axis], self.named_unknown) {
            (None, Some(line)) => Reason::Offsets(line),
            _ => Reason::StartUnknown(AXES[axis]),
        };
        let start = match self.in_frame(&from, &needed) {
            Ok(start) => start,
            Err(axis) => return Step::Unchecked(unknown(axis)),
        };
        let end = match self.in_frame(&to, &needed) {
            Ok(end) => end,
            Err(axis) => return Step::Unchecked(unknown(axis)),
        };
        self.frame.get_or_insert(self.work);
        Step::Move(Box::new(Move { from, to, start, end, travels }))
    }
}
