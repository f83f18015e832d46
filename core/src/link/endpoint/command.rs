//! Commands and questions between ticks, from the configuration link.

use super::Endpoint;
use crate::link::{Counters, DeviceSettings};
use crate::rewrite::{ArmRequest, Mode, Output, Reason, Refusal, Rewriter, Spent, State};

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
    /// As [`Rewriter::arm`].
    pub fn check(&self, rewriter: &Rewriter<'_>, request: &ArmRequest) -> Result<Spent, Refusal> {
        let mut tried = self.state;
        rewriter.arm(&mut tried, request)?;
        // The newest is the one just spent; without any, arming would have failed.
        tried.spent().first().copied().flatten().ok_or(Refusal::NoImage)
    }

    /// Arms the image for one pass of one part. The pass must have been written to the ledger before.
    ///
    /// # Errors
    /// As [`Rewriter::arm`].
    pub fn arm(&mut self, rewriter: &Rewriter<'_>, request: &ArmRequest) -> Result<(), Refusal> {
        rewriter.arm(&mut self.state, request)
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
        self.due_us = None;
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
    /// The answer that is due.
    pub fn due(&self) -> Option<&Output> {
        self.due_us.map(|_| &self.output)
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
