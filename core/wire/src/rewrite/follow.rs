//! An armed or active correction: through the gate, along the path, over a hold, to the end.

use super::feed::FeedRatio;
use super::frame::Local;
use super::locate::{FRACTION_BITS, FRACTION_ONE, Foot, Place, dot, locate, share, square};
use super::mode::Mode;
use super::state::{FADE_BITS, FADE_ONE, Phase, State};
use super::{Flags, Plan, Reason, Rewriter, Setpoint};
use crate::image::Node;

impl Rewriter<'_> {
    /// Waits for the gate and says whether the setpoint has entered it: over the start of the path at gate height or
    /// lower, at feed speed, not against the direction of the path, drives on and no feed hold. The first setpoint
    /// after arming only tells where the cutter is.
    #[inline(never)]
    pub(super) fn enters(&self, plan: &Plan<'_>, state: &mut State, setpoint: &Setpoint) -> bool {
        let at = state.local(setpoint);
        let before = core::mem::replace(&mut state.last, at);
        let (Some(at), Some(before)) = (at, before) else {
            return false;
        };
        let lost = setpoint.sequence.wrapping_sub(state.sequence);
        let gate = plan.near_start(&at) && at.z >= plan.z_bottom && at.z <= plan.z_gate;
        let runs = setpoint.flags.has(Flags::DRIVES_ENABLED) && !setpoint.flags.has(Flags::FEED_HOLD);
        if !gate || !runs || lost != 1 || self.is_jump(&before, &at, 1) {
            return false;
        }
        let ahead = plan.image.node(1);
        // In range: a step is below 2²³ nm, a segment below 2²⁰ nm.
        if dot(ahead.x, ahead.y, at.x.wrapping_sub(before.x), at.y.wrapping_sub(before.y)) < 0 {
            return false;
        }
        state.last = Some(before);
        state.mode = Mode::Active;
        state.phase = Phase::Entry;
        state.place = Place::default();
        state.along = 0;
        state.behind = 0;
        state.still = 0;
        // A cutter that does not turn at the gate bends nothing: a dry run has no correction from its first tick.
        state.fade = if self.live_spindle(setpoint) > 0 { FADE_ONE } else { 0 };
        state.ratio = FeedRatio::default();
        state.feed_in_window = true;
        true
    }

    /// Takes the place, feed and fade to the new setpoint; gives the correction wanted, in program coordinates,
    /// 2⁻⁸ nm. Any reason to stop is left in `state`, and nothing is wanted any more.
    #[inline(always)]
    pub(super) fn follow(&self, plan: &Plan<'_>, state: &mut State, setpoint: &Setpoint) -> (i32, i32) {
        let advanced = self.arrive(state, setpoint).and_then(|moved| self.advance(plan, state, setpoint, moved));
        match advanced {
            Ok(way) => self.correction(plan, state, setpoint, way),
            Err(reason) => {
                state.end(reason);
                (0, 0)
            }
        }
    }

    /// The setpoint in program coordinates becomes the last one, unless it is out of sequence or jumps.
    #[inline(never)]
    fn arrive(&self, state: &mut State, setpoint: &Setpoint) -> Result<Moved, Reason> {
        let ticks = setpoint.sequence.wrapping_sub(state.sequence);
        if ticks == 0 || ticks > self.settings.max_lost_frames.wrapping_add(1) {
            return Err(Reason::SequenceBroken);
        }
        let at = state.local(setpoint).ok_or(Reason::OffPath)?;
        let before = state.last.unwrap_or(at);
        state.last = Some(at);
        if self.is_jump(&before, &at, ticks) {
            return Err(Reason::Jump);
        }
        let moved = if (at.x, at.y) != (before.x, before.y) {
            if ticks == 1 { Moved::Measured } else { Moved::Unmeasured }
        } else if at.z != before.z {
            Moved::Unmeasured
        } else {
            Moved::Not
        };
        state.still = if moved == Moved::Not { state.still.saturating_add(1) } else { 0 };
        Ok(moved)
    }

    /// The place goes after the setpoint; gives the way along the path if it is that of one tick.
    #[inline(never)]
    fn advance(
        &self,
        plan: &Plan<'_>,
        state: &mut State,
        setpoint: &Setpoint,
        moved: Moved,
    ) -> Result<Option<i32>, Reason> {
        let Some(at) = state.last else { return Err(Reason::OffPath) };
        let at = &at;
        if at.z > plan.z_top {
            return above(plan, state, at);
        }
        state.phase = Phase::Path;
        if at.z < plan.z_bottom {
            return Err(Reason::BelowPass);
        }
        if self.holds(plan, state, setpoint, at, moved != Moved::Not)? {
            return Ok(None);
        }
        let located = locate(&plan.image, state.place.node, at).ok_or(Reason::OffPath)?;
        let (node, foot) = (located.node, located.foot);
        let way = located.ahead.wrapping_sub(state.along as i32);
        if foot.distance_squared > plan.tolerance_squared {
            let ended = plan.at_end(state) || plan.is_end(node, &foot);
            return Err(if ended { Reason::Completed } else { Reason::OffPath });
        }
        state.behind = state.behind.wrapping_sub(way).max(0);
        if state.behind > plan.tolerance_nm {
            return Err(Reason::Backwards);
        }
        state.place = Place { node, fraction: foot.fraction };
        state.along = foot.along;
        Ok(if moved == Moved::Measured { Some(way) } else { None })
    }

    /// Enters and leaves `Hold`; says whether the place is frozen in this tick. With the feed-hold flag the place
    /// still follows until the axes stand, so that nothing is missing when they go on.
    #[inline(always)]
    fn holds(
        &self,
        plan: &Plan<'_>,
        state: &mut State,
        setpoint: &Setpoint,
        at: &Local,
        moved: bool,
    ) -> Result<bool, Reason> {
        let flag = setpoint.flags.has(Flags::FEED_HOLD);
        if state.mode == Mode::Hold {
            let held_at = &state.held_at;
            if flag && !plan.is_near(at.x.wrapping_sub(held_at.x), at.y.wrapping_sub(held_at.y)) {
                return Err(Reason::MovedInHold);
            }
            if moved && !flag {
                state.mode = Mode::Active;
            }
        } else if !moved && (flag || state.still >= self.settings.hold_after_ticks) {
            state.mode = Mode::Hold;
            state.held_at = *at;
        }
        Ok(state.mode == Mode::Hold)
    }

    /// What is wanted at the place that was reached. One stage: two would save and hand over as much again as they share.
    #[inline(never)]
    fn correction(&self, plan: &Plan<'_>, state: &mut State, setpoint: &Setpoint, way: Option<i32>) -> (i32, i32) {
        let judged = self.feed(plan, state, setpoint, way);
        wanted(plan, state, judged)
    }

    /// Takes in the feed of a way and moves the fade factor one step; gives the feed ratio to correct for, units of
    /// 2⁻¹⁶.
    ///
    /// The feed is judged only while the setpoint moves: a standing cutter makes no chips, and its correction stays
    /// what it was. So is a missing load, and only in the pass. When the conditions are met again, the correction comes
    /// back at the same rate.
    #[inline(always)]
    fn feed(&self, plan: &Plan<'_>, state: &mut State, setpoint: &Setpoint, way: Option<i32>) -> u32 {
        let spindle = self.live_spindle(setpoint);
        if let Some(way) = way {
            state.ratio.update(plan.feed_scale, way, spindle, self.settings.feed_smoothing);
        }
        let feed = &plan.image.settings().feed;
        let ratio = state.ratio.value();
        let judged = ratio.max(feed.ratio_low).min(feed.ratio_high);
        if state.still == 0 {
            state.feed_in_window = judged == ratio;
        }
        let loaded = !self.settings.require_spindle_load || setpoint.flags.has(Flags::SPINDLE_LOADED);
        // Only a cutter that moves in the pass can be expected to be loaded.
        let cuts = state.still == 0 && state.phase == Phase::Path && state.mode != Mode::Hold;
        let change = match state.feed_in_window && spindle > 0 {
            true if loaded => self.fade_step,
            true if !cuts => 0,
            // Standing, after slowing down out of the window: what it was, until it moves again.
            false if spindle > 0 && state.still > 0 => 0,
            _ => self.fade_step.wrapping_neg(),
        };
        state.fade = state.fade.wrapping_add(change).clamp(0, FADE_ONE);
        judged
    }

    /// The spindle speed, 0 when it is stale.
    #[inline(always)]
    fn live_spindle(&self, setpoint: &Setpoint) -> u32 {
        if setpoint.spindle_age_ticks < self.settings.spindle_stale_ticks { setpoint.spindle_millirpm } else { 0 }
    }

    /// In range: the largest step is 8 mm, the ticks at most 17.
    #[inline(always)]
    fn is_jump(&self, before: &Local, at: &Local, ticks: u32) -> bool {
        let most = (self.settings.max_step.nm() as u32).wrapping_mul(ticks);
        at.x.abs_diff(before.x) > most || at.y.abs_diff(before.y) > most
    }
}

/// A setpoint above the pass: in the gate before it, out of it at its end, anywhere else a fault.
#[inline(always)]
fn above(plan: &Plan<'_>, state: &State, at: &Local) -> Result<Option<i32>, Reason> {
    if state.phase != Phase::Entry {
        return Err(if plan.at_end(state) { Reason::Completed } else { Reason::LeftPass });
    }
    if plan.near_start(at) && at.z <= plan.z_gate { Ok(None) } else { Err(Reason::LeftGate) }
}

/// Whether a setpoint is another place than the one before.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Moved {
    /// It is the same.
    Not,
    /// It is, but by the way of more than one tick, or in Z only: no measure of the feed.
    Unmeasured,
    /// It is, by the way of one tick.
    Measured,
}

impl Plan<'_> {
    #[inline(always)]
    fn is_near(&self, x: i32, y: i32) -> bool {
        // The largest components have squares of 2⁶², so the sum does not wrap.
        square(x, y) <= self.tolerance_squared
    }
    #[inline(always)]
    fn near_start(&self, at: &Local) -> bool {
        self.is_near(at.x, at.y)
    }
    /// Whether less than the tolerance is left to the last node.
    #[inline]
    fn at_end(&self, state: &State) -> bool {
        let length = self.image.node(state.place.node as usize).length;
        let left = (length as i32).wrapping_sub(state.along as i32);
        state.place.node == self.last_segment && left <= self.tolerance_nm
    }
    #[inline]
    fn is_end(&self, node: u32, foot: &Foot) -> bool {
        node == self.last_segment && foot.fraction == FRACTION_ONE
    }
}

/// The correction at the place: both ends of the segment scaled by the feed, then between them, then faded.
#[inline(always)]
fn wanted(plan: &Plan<'_>, state: &State, ratio: u32) -> (i32, i32) {
    let [a, b, ..] = plan.image.stored_from(state.place.node) else {
        return (0, 0);
    };
    let factor = plan.image.settings().feed.factor_at(ratio);
    let fraction = state.place.fraction as i32;
    let (a, b) = (Node::decode(a), Node::decode(b));
    let ([a_x, a_y], [b_x, b_y]) = (a.full(factor), b.full(factor));
    let (x, y) = (between(a_x, b_x, fraction), between(a_y, b_y, fraction));
    if state.fade == FADE_ONE { (x, y) } else { (faded(x, state.fade), faded(y, state.fade)) }
}

#[inline(always)]
fn between(low: i32, high: i32, fraction: i32) -> i32 {
    low.wrapping_add(share(high.wrapping_sub(low), fraction, FRACTION_BITS))
}

#[inline(always)]
fn faded(full: i32, fade: i32) -> i32 {
    share(full, fade, FADE_BITS)
}
