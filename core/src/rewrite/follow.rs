//! An armed or active correction: through the gate, along the path, over a hold, to the end.

use super::feed::FeedRatio;
use super::frame::Local;
use super::locate::{FRACTION_ONE, Foot, Place, locate, product, square};
use super::state::{FADE_BITS, FADE_ONE, Mode, Phase, State};
use super::{Flags, Plan, Reason, Rewriter, Setpoint};
use crate::image::{Node, scaled};
use crate::units::shift_rounded_i64;

impl Rewriter<'_> {
    /// Waits for the gate: the setpoint over the start of the path at gate height or lower, at feed speed, not
    /// against the direction of the path, drives on and no feed hold. The first setpoint after arming only tells where the cutter is.
    #[inline]
    pub(super) fn wait(&self, plan: &Plan<'_>, state: &mut State, setpoint: &Setpoint) {
        let at = state.local(setpoint);
        let before = core::mem::replace(&mut state.last, at);
        let (Some(at), Some(before)) = (at, before) else {
            return;
        };
        let lost = setpoint.sequence.wrapping_sub(state.sequence);
        let step = step(before, at);
        let gate = plan.near_start(at) && at.z >= plan.z_bottom && at.z <= plan.z_gate;
        let runs = setpoint.flags.has(Flags::DRIVES_ENABLED) && !setpoint.flags.has(Flags::FEED_HOLD);
        if !gate || !runs || lost != 1 || self.is_jump(step, 1) {
            return;
        }
        let ahead = plan.image.node(1);
        // In range: a step is below 2²³ nm, a segment below 2²⁰ nm.
        if product(ahead.x, step.0 as i32).wrapping_add(product(ahead.y, step.1 as i32)) < 0 {
            return;
        }
        state.last = Some(before);
        state.mode = Mode::Active;
        state.phase = Phase::Entry;
        state.place = Place::default();
        state.along = 0;
        state.behind = 0;
        state.still = 0;
        state.fade = FADE_ONE;
        state.ratio = FeedRatio::default();
        state.feed_in_window = true;
    }

    /// Takes the place, feed and fade to the new setpoint; gives the correction wanted, in program coordinates,
    /// 2⁻⁸ nm. Any reason to stop is left in `state`, and nothing is wanted any more.
    #[inline]
    pub(super) fn follow(&self, plan: &Plan<'_>, state: &mut State, setpoint: &Setpoint) -> (i32, i32) {
        match self.advance(plan, state, setpoint) {
            Ok(()) => {
                let judged = self.fade(plan, state, setpoint);
                wanted(plan, state, judged)
            }
            Err(reason) => {
                state.end(reason);
                (0, 0)
            }
        }
    }

    fn advance(&self, plan: &Plan<'_>, state: &mut State, setpoint: &Setpoint) -> Result<(), Reason> {
        let ticks = setpoint.sequence.wrapping_sub(state.sequence);
        if ticks == 0 || ticks > self.settings.max_lost_frames.wrapping_add(1) {
            return Err(Reason::SequenceBroken);
        }
        let at = state.local(setpoint).ok_or(Reason::OffPath)?;
        let before = state.last.unwrap_or(at);
        let step = step(before, at);
        state.last = Some(at);
        if self.is_jump(step, ticks) {
            return Err(Reason::Jump);
        }
        let moved = at != before;
        state.still = if moved { 0 } else { state.still.saturating_add(1) };
        if state.phase == Phase::Entry && at.z > plan.z_top {
            if !plan.near_start(at) || at.z > plan.z_gate {
                return Err(Reason::LeftGate);
            }
            return Ok(());
        }
        state.phase = Phase::Path;
        if at.z > plan.z_top {
            return Err(if plan.at_end(state) { Reason::Completed } else { Reason::LeftPass });
        }
        if at.z < plan.z_bottom {
            return Err(Reason::BelowPass);
        }
        if self.holds(plan, state, setpoint, at, moved)? {
            return Ok(());
        }
        let (foot, ahead) = locate(&plan.image, state.place.node, at);
        let way = ahead.wrapping_sub(state.along.into());
        if foot.distance_squared > plan.tolerance_squared {
            let ended = plan.at_end(state) || plan.is_end(&foot);
            return Err(if ended { Reason::Completed } else { Reason::OffPath });
        }
        state.behind = state.behind.wrapping_sub(way).max(0);
        if state.behind > plan.tolerance_nm {
            return Err(Reason::Backwards);
        }
        state.place = foot.place;
        state.along = foot.along;
        if step != (0, 0) && ticks == 1 {
            state.ratio.update(plan.feed_scale, way, self.live_spindle(setpoint), self.settings.feed_smoothing);
        }
        Ok(())
    }

    /// Enters and leaves `Hold`; says whether the place is frozen in this tick. With the feed-hold flag the place
    /// still follows until the axes stand, so that nothing is missing when they go on.
    #[inline]
    fn holds(
        &self,
        plan: &Plan<'_>,
        state: &mut State,
        setpoint: &Setpoint,
        at: Local,
        moved: bool,
    ) -> Result<bool, Reason> {
        let flag = setpoint.flags.has(Flags::FEED_HOLD);
        if state.mode == Mode::Hold {
            if flag && !plan.is_near(step(state.held_at, at)) {
                return Err(Reason::MovedInHold);
            }
            if moved && !flag {
                state.mode = Mode::Active;
            }
        } else if !moved && (flag || state.still >= self.settings.hold_after_ticks) {
            state.mode = Mode::Hold;
            state.held_at = at;
        }
        Ok(state.mode == Mode::Hold)
    }

    /// Moves the fade factor one step; gives the feed ratio to correct for, units of 2⁻¹⁶.
    ///
    /// The feed is judged only while the setpoint moves: a standing cutter makes no chips, and its correction stays
    /// what it was. When the conditions are met again, the correction comes back at the same rate.
    #[inline]
    fn fade(&self, plan: &Plan<'_>, state: &mut State, setpoint: &Setpoint) -> u32 {
        let feed = &plan.image.settings().feed;
        let ratio = state.ratio.value();
        if state.still == 0 {
            state.feed_in_window = ratio >= feed.ratio_low && ratio <= feed.ratio_high;
        }
        let loaded = !self.settings.require_spindle_load || setpoint.flags.has(Flags::SPINDLE_LOADED);
        let change = if state.feed_in_window && loaded && self.live_spindle(setpoint) > 0 {
            self.fade_step
        } else {
            self.fade_step.wrapping_neg()
        };
        state.fade = state.fade.wrapping_add(change).clamp(0, FADE_ONE);
        ratio.max(feed.ratio_low).min(feed.ratio_high)
    }

    /// The spindle speed, 0 when it is stale.
    #[inline]
    fn live_spindle(&self, setpoint: &Setpoint) -> u32 {
        if setpoint.spindle_age_ticks < self.settings.spindle_stale_ticks { setpoint.spindle_millirpm } else { 0 }
    }

    #[inline]
    fn is_jump(&self, step: (i64, i64), ticks: u32) -> bool {
        // In range: 8 mm times 17 ticks.
        let most = self.settings.max_step.nm().wrapping_mul(i64::from(ticks)).unsigned_abs();
        step.0.unsigned_abs() > most || step.1.unsigned_abs() > most
    }
}

impl Plan<'_> {
    #[inline]
    fn is_near(&self, way: (i64, i64)) -> bool {
        let most = self.tolerance_nm.unsigned_abs();
        way.0.unsigned_abs() <= most
            && way.1.unsigned_abs() <= most
            && square(way.0 as i32, way.1 as i32) <= self.tolerance_squared
    }
    #[inline]
    fn near_start(&self, at: Local) -> bool {
        self.is_near((at.x, at.y))
    }
    /// Whether less than the tolerance is left to the last node.
    #[inline]
    fn at_end(&self, state: &State) -> bool {
        let length = self.image.node(state.place.node as usize).length;
        let left = i64::from(length).wrapping_sub(state.along.into());
        state.place.node == self.last_segment && left <= self.tolerance_nm
    }
    #[inline]
    fn is_end(&self, foot: &Foot) -> bool {
        foot.place.node == self.last_segment && foot.place.fraction == FRACTION_ONE
    }
}

#[inline]
fn step(from: Local, to: Local) -> (i64, i64) {
    (to.x.wrapping_sub(from.x), to.y.wrapping_sub(from.y))
}

/// The correction at the place: both ends of the segment scaled by the feed, then between them, then faded.
#[inline]
fn wanted(plan: &Plan<'_>, state: &State, ratio: u32) -> (i32, i32) {
    let factor = plan.image.settings().feed.factor_at(ratio);
    let index = state.place.node as usize;
    let (a, b) = (plan.image.node(index), plan.image.node(index.wrapping_add(1)));
    let part = |axis: usize| {
        let at = |node: &Node| {
            let (chip, edge) = (node.chip.get(axis).copied(), node.edge.get(axis).copied());
            // In range: the image holds chip · factor + edge within the clamp, below 2³⁰, over the feed window.
            scaled(chip.unwrap_or_default(), factor).wrapping_add(edge.unwrap_or_default().bits().into()) as i32
        };
        let (low, high) = (at(&a), at(&b));
        let rise = product(high.wrapping_sub(low), state.place.fraction as i32);
        let full = low.wrapping_add(shift_rounded_i64(rise, super::locate::FRACTION_BITS) as i32);
        if state.fade == FADE_ONE { full } else { shift_rounded_i64(product(full, state.fade), FADE_BITS) as i32 }
    };
    (part(0), part(1))
}
