//! The pace of accepted frames, so that limits per tick are limits per second.
//!
//! Measured over windows of 32 frames, one after the other. A window that takes less than two thirds of its nominal
//! time is too fast. Frames count, not sequences: the correction moves once for a frame that is followed, so lost ones
//! make it slower. Too slow a pace needs no judgement: the limits hold, and the feed leaves its window.
//!
//! A pace that becomes too fast is noticed at the end of the first window that lies in it for the most part, within 63
//! frames. The bounds are prepared, nothing is divided while frames come.

use crate::rewrite::Refusal;

/// So many refused frames in a row that follow each other are the controller counting anew, not late ones, provided
/// they came at a pace at which a controller sends and none was accepted in their time.
pub const RESTART_AFTER: u32 = 4;

/// Frames of a window, and so many times the interval between two.
const WINDOW: u32 = 32;

/// A window under way and what the last one was.
#[derive(Clone, Debug)]
pub(super) struct Pace {
    tick_hz: u32,
    /// A window that is shorter is too fast, µs.
    shortest_us: u64,
    /// So long no frame is accepted when the controller counts anew, and so long its first frames take, µs.
    restart_us: (u64, u64),
    /// When the window began, and frames since.
    since_us: Option<u64>,
    frames: u32,
    /// What the last whole window took.
    took_us: Option<u64>,
}

impl Pace {
    /// Nothing is known; `tick_hz` is the nominal rate.
    pub fn new(tick_hz: u32) -> Self {
        // Thirds of the time between two frames, µs, rounded up.
        let periods =
            |thirds: u32| u64::from(thirds.saturating_mul(1_000_000).div_ceil(tick_hz.saturating_mul(3).max(1)));
        let restart = RESTART_AFTER.saturating_sub(1);
        Self {
            tick_hz,
            shortest_us: periods(2 * WINDOW),
            restart_us: (periods(restart.saturating_mul(3)), periods(restart.saturating_mul(2))),
            since_us: None,
            frames: 0,
            took_us: None,
        }
    }

    /// The link is silent, or the controller counts anew, perhaps another one: nothing is known any more.
    #[inline]
    pub fn forget(&mut self) {
        self.since_us = None;
        self.took_us = None;
    }

    /// A window begins with this frame.
    #[inline]
    fn begin(&mut self, arrived_us: u64) {
        self.since_us = Some(arrived_us);
        self.frames = 0;
    }

    /// Takes the arrival of a frame; says whether a window ends with it that was too fast.
    #[inline]
    pub fn is_too_fast(&mut self, arrived_us: u64) -> bool {
        let Some(since_us) = self.since_us else {
            self.begin(arrived_us);
            return false;
        };
        self.frames = self.frames.wrapping_add(1);
        if self.frames < WINDOW {
            return false;
        }
        let took_us = arrived_us.saturating_sub(since_us);
        self.took_us = Some(took_us);
        self.begin(arrived_us);
        took_us < self.shortest_us
    }

    /// Whether a run of refused frames is one of a controller that counts anew: it took `taken_us` at a permitted
    /// pace, and none was accepted for `silent_us`, the ticks between its frames.
    #[inline]
    pub const fn is_restart(&self, silent_us: u64, taken_us: u64) -> bool {
        silent_us >= self.restart_us.0 && taken_us >= self.restart_us.1
    }

    /// Arming needs one whole window, the last one, at a permitted pace.
    ///
    /// # Errors
    /// There was none yet, or it was too fast.
    pub fn check(&self) -> Result<(), Refusal> {
        if self.took_us.is_some_and(|took_us| took_us >= self.shortest_us) {
            return Ok(());
        }
        // 1000/32 in lowest terms.
        let interval_ns = self.took_us.map_or(0, |took_us| took_us.saturating_mul(125) >> 2);
        Err(Refusal::FrameRate { tick_hz: self.tick_hz, interval_ns: u32::try_from(interval_ns).unwrap_or(u32::MAX) })
    }
}
