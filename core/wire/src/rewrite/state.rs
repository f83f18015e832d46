//! The state of a rewriter, apart from its configuration.

use super::feed::FeedRatio;
use super::frame::{Local, Mapping};
use super::limit::AxisState;
use super::locate::Place;
use super::spent::{Spent, SpentList};
use super::{Mode, Reason, Refusal, Setpoint};
use crate::image::RATIO_ONE;

/// Fraction bits of the fade factor.
pub(super) const FADE_BITS: u32 = 16;
/// Fade factor 1.
pub(super) const FADE_ONE: i32 = 1 << FADE_BITS;

/// Where in the feature an active correction is.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) enum Phase {
    /// Over the start, above the pass: place frozen at the first node, the correction ramps in.
    #[default]
    Entry,
    /// The cutter is in the pass.
    Path,
    /// Behind the end: the correction ramps out.
    Leaving,
}

/// Everything that changes from tick to tick. A copy is a complete record: the same state, image, settings and
/// setpoints give the same outputs to the last bit. The default is the state after power-up, [`Mode::Off`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct State {
    pub(super) mode: Mode,
    pub(super) reason: Reason,
    pub(super) drives_seen_enabled: bool,
    pub(super) phase: Phase,
    /// Checksum of the image that was armed.
    pub(super) image_crc: u32,
    /// Checksum of the frame that was armed.
    pub(super) frame_crc: u32,
    pub(super) mapping: Option<Mapping>,
    /// The setpoint before, in program coordinates, while armed or on.
    pub(super) last: Option<Local>,
    /// Where the place was frozen.
    pub(super) held_at: Local,
    pub(super) sequence: u32,
    /// Ticks without motion.
    pub(super) still: u32,
    pub(super) place: Place,
    /// Way along the path from the node of `place`, nm.
    pub(super) along: u32,
    /// How far the setpoint has gone back from its farthest place, nm.
    pub(super) behind: i32,
    pub(super) ratio: FeedRatio,
    /// Whether the ratio was inside the window of the image when the setpoint last moved.
    pub(super) feed_in_window: bool,
    /// 0 … 2¹⁶.
    pub(super) fade: i32,
    /// Machine axes of X and Y.
    pub(super) axes: [AxisState; 2],
    pub(super) spent: SpentList,
}

impl State {
    /// State after power-up that remembers armings from before.
    pub fn remembering(spent: SpentList) -> Self {
        Self { spent, ..Self::default() }
    }
    /// The mode.
    pub const fn mode(&self) -> Mode {
        self.mode
    }
    /// Why the last correction ended or failed; stays until the next arming.
    pub const fn reason(&self) -> Reason {
        self.reason
    }
    /// The limited corrections of the machine axes of X and Y.
    pub const fn axes(&self) -> &[AxisState; 2] {
        &self.axes
    }
    /// Place on the path, the last one when no correction is on.
    #[inline]
    pub const fn place(&self) -> Place {
        self.place
    }
    /// Live feed per tooth over the nominal one, smoothed, units of 2⁻¹⁶; 1 until something is armed, then the last one
    /// that was measured, over the end of its correction as well.
    #[inline]
    pub fn feed_ratio(&self) -> u32 {
        if self.mapping.is_some() { self.ratio.value() } else { RATIO_ONE }
    }
    /// Machine axes of the program's X and Y, those of the last arming; 0 and 1 before it.
    #[inline]
    pub fn plane(&self) -> [usize; 2] {
        self.mapping.as_ref().map_or([0, 1], |mapping| mapping.plane())
    }
    /// Armed passes of parts, to be kept over a power-down.
    pub const fn spent(&self) -> &SpentList {
        &self.spent
    }

    pub(super) fn is_spent(&self, pass: &Spent) -> bool {
        self.spent.contains(pass)
    }
    pub(super) fn spend(&mut self, pass: Spent) {
        self.spent.spend(pass);
    }
    /// The end of a correction: ramp out when one is on, bypass at once when only armed.
    #[inline]
    pub(super) fn end(&mut self, reason: Reason) {
        self.reason = reason;
        self.mode = match self.mode {
            Mode::Active | Mode::Hold if reason.is_fault() => Mode::Fault,
            Mode::Active | Mode::Hold => {
                self.phase = Phase::Leaving;
                Mode::Active
            }
            Mode::Armed => Mode::Bypass,
            other => other,
        };
    }
    /// The command does not belong to the mode; in `Off` with the cause, which the mode alone does not tell.
    pub(super) const fn refusal(&self) -> Refusal {
        match self.mode {
            Mode::Off => Refusal::Off { reason: self.reason },
            mode => Refusal::State(mode),
        }
    }
    /// The setpoint in program coordinates by the frame that was armed.
    #[inline]
    pub(super) fn local(&self, setpoint: &Setpoint) -> Option<Local> {
        self.mapping.as_ref()?.local(&setpoint.axes)
    }
    /// Whether nothing is left of the corrections.
    #[inline]
    pub(super) fn is_at_rest(&self) -> bool {
        self.axes.iter().all(AxisState::is_at_rest_at_zero)
    }
    /// Whether the correction is on its way out.
    #[inline]
    pub(super) fn is_ending(&self) -> bool {
        self.mode == Mode::Fault || (self.mode == Mode::Active && self.phase == Phase::Leaving)
    }
}
