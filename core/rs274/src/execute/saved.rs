//! M70 … M73: saving and restoring the modes, per level of call.
//!
//! Limits: coolant, overrides and cutter radius compensation are not restored, and a tool offset only when it was off.

use super::super::mcode::MCodes;
use super::super::{Canon, GcodeError, SettingError, Span};
use super::Execution;
use super::memory::SavedModes;

impl Execution<'_, '_, '_> {
    /// A call level has ended: what M73 saved in it waits to come back.
    pub(super) fn modes_of_level(&mut self, level: u8) {
        let saved = self.saved.get_mut(usize::from(level)).and_then(Option::take);
        self.returning = saved.filter(|saved| saved.on_return).or(self.returning);
    }
}

impl Execution<'_, '_, '_> {
    /// M70 saves, M71 forgets, M72 restores, M73 saves and restores on return.
    pub(super) fn saved_modes(&mut self, m: &MCodes) -> Result<(), GcodeError> {
        let Some(code) = m.saved else { return Ok(()) };
        let level = usize::from(self.source.depth);
        let saved = match code.number {
            70 | 73 => Some(SavedModes::of(&self.modal, code.number == 73)),
            71 => None,
            _ => {
                let Some(saved) = self.saved.get(level).copied().flatten() else {
                    return Err(self.error(SettingError::NothingSaved.into(), code.span));
                };
                return self.restore(&saved, code.span);
            }
        };
        if let Some(slot) = self.saved.get_mut(level) {
            *slot = saved;
        }
        Ok(())
    }

    /// Brings back what a call that has ended had saved by M73, before the block behind the call.
    pub(super) fn restore_returning(&mut self) -> Result<(), GcodeError> {
        match self.returning.take() {
            Some(saved) => self.restore(&saved, self.block_span()),
            None => Ok(()),
        }
    }

    fn restore(&mut self, saved: &SavedModes, span: Span) -> Result<(), GcodeError> {
        let before = SavedModes::of(&self.modal, saved.on_return);
        self.modal.units = saved.units;
        self.modal.plane = saved.plane;
        self.modal.absolute = saved.absolute;
        self.modal.absolute_centres = saved.absolute_centres;
        self.modal.feed_mode = saved.feed_mode;
        self.modal.retract = saved.retract;
        self.modal.path = saved.path.or(self.modal.path);
        self.modal.feed = saved.feed;
        self.modal.speed = saved.speed;
        if before.units != saved.units {
            self.emit(Canon::Units(saved.units), span)?;
        }
        if before.feed_mode != saved.feed_mode {
            self.emit(Canon::FeedMode(saved.feed_mode), span)?;
        }
        if let Some(feed) = saved.feed.filter(|_| before.feed != saved.feed) {
            self.emit(Canon::FeedRate(feed), span)?;
        }
        if let Some(speed) = saved.speed.filter(|_| before.speed != saved.speed) {
            self.emit(Canon::SpindleSpeed(speed), span)?;
        }
        if before.spindle != saved.spindle {
            self.turn(saved.spindle, span)?;
        }
        if before.plane != saved.plane {
            self.emit(Canon::Plane(saved.plane), span)?;
        }
        if before.length_offset && !saved.length_offset {
            self.length_off(span)?;
        }
        if before.work_offset != saved.work_offset {
            self.select_work_offset(saved.work_offset, span)?;
        }
        match saved.path {
            Some(path) if before.path != saved.path => self.emit(Canon::PathControl(path), span),
            _ => Ok(()),
        }
    }
}
