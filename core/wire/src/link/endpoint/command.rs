//! Commands and questions between ticks, from the configuration link.

use super::Endpoint;
use super::pace::Pace;
use crate::link::{Counters, DeviceSettings};
use crate::rewrite::{ArmRequest, Mode, Reason, Refusal, Rewriter, Spent, State};

impl Endpoint {
    /// The controller acknowledges that the drives are disabled: `Off` → `Bypass`.
    ///
    /// # Errors
    /// Not in `Off`; no setpoints arrive; the last one said that the drives are enabled.
    pub fn acknowledge(&mut self, rewriter: &Rewriter<'_>, now_us: u64) -> Result<(), Refusal> {
        if self.state.mode() == Mode::Off && self.is_silent(now_us) {
            return Err(Refusal::NoSetpoints);
        }
        rewriter.acknowledge_drives_disabled(&mut self.state)
    }

    /// What [`arm`](Self::arm) would say, without arming; gives the pass of the part that it would spend.
    ///
    /// # Errors
    /// As [`arm`](Self::arm).
    pub fn check(&self, rewriter: &Rewriter<'_>, request: &ArmRequest) -> Result<Spent, Refusal> {
        // The newest is the one just spent; without any, arming would have failed.
        self.armed(rewriter, request)?.spent().last().ok_or(Refusal::NoImage)
    }

    /// Arms the image for one pass of one part. The pass must have been written to the ledger before.
    ///
    /// # Errors
    /// As [`Rewriter::arm`]; the frame is on an axis that is not sent; setpoints come too fast, or it is not known yet
    /// how fast they come. The state then stays as it is.
    pub fn arm(&mut self, rewriter: &Rewriter<'_>, request: &ArmRequest) -> Result<(), Refusal> {
        self.state = self.armed(rewriter, request)?;
        Ok(())
    }

    fn armed(&self, rewriter: &Rewriter<'_>, request: &ArmRequest) -> Result<State, Refusal> {
        let mut state = self.state;
        rewriter.arm(&mut state, request)?;
        let [x, y, z] = request.frame.axes.map(|map| map.axis);
        // An axis that is not sent reads 0: the height of the cutter, say, would be unknown.
        if x.max(y).max(z) >= self.settings.axes {
            return Err(Refusal::FrameAxes { x, y, z });
        }
        self.pace.check()?;
        Ok(state)
    }

    /// Ends an arming; an active correction ramps out.
    ///
    /// # Errors
    /// Nothing is armed.
    pub fn disarm(&mut self, rewriter: &Rewriter<'_>) -> Result<(), Refusal> {
        rewriter.disarm(&mut self.state)
    }

    /// Uses other settings, which must have passed [`DeviceSettings::check`].
    ///
    /// # Errors
    /// Not in `Off`.
    pub fn configure(&mut self, settings: DeviceSettings) -> Result<(), Refusal> {
        if self.state.mode() != Mode::Off {
            return Err(Refusal::State(self.state.mode()));
        }
        self.settings = settings;
        self.pace = Pace::new(settings.rewriter.tick_hz);
        self.due_us = None;
        self.given = None;
        Ok(())
    }

    /// The settings in use.
    pub const fn settings(&self) -> &DeviceSettings {
        &self.settings
    }
    /// State of the rewriter, to be read.
    pub const fn state(&self) -> &State {
        &self.state
    }
    /// Its mode.
    pub const fn mode(&self) -> Mode {
        self.state.mode()
    }
    /// Whether the drive enable may be passed on.
    pub fn drive_enable(&self) -> bool {
        self.state.mode() != Mode::Off
    }
    /// The last fault since this was asked before: the recorder is to be stopped.
    pub fn take_fault(&mut self) -> Option<Reason> {
        self.fault.take()
    }
    /// The counters.
    pub const fn counters(&self) -> &Counters {
        &self.counters
    }
    /// Sets the counters to zero.
    pub fn clear_counters(&mut self) {
        self.counters = Counters::default();
    }
    /// Counts a message of the configuration link.
    pub fn count_message(&mut self, damaged: bool) {
        let counter = if damaged { &mut self.counters.messages_damaged } else { &mut self.counters.messages };
        Counters::one_more(counter);
    }
}
