//! Acknowledge, arm, disarm, configure.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::crc32;
use truepath_core::link::{Change, Denial, DeviceSettings, DeviceSettingsError, LogEntry, Reply};
use truepath_core::rewrite::{ArmRequest, Mode, Refusal, Rewriter, Spent};

use super::handler::Handler;
use crate::flash::LEDGER_SECTORS;
use crate::ledger::JournalFailed;
use crate::servo::ServoAccess;

impl From<JournalFailed> for Denial {
    fn from(_: JournalFailed) -> Self {
        Self::Flash { address: LEDGER_SECTORS.start() }
    }
}

impl<'a, F: NorFlash> Handler<'a, F> {
    pub fn acknowledge<'s>(&mut self, now_us: u64, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        servo.with(|servo| servo.acknowledge(now_us)).map_err(Denial::Refused)?;
        self.keep(self.entry(Change::Acknowledged));
        Ok(Reply::Done)
    }

    pub fn check<'s>(&self, request: &ArmRequest, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        self.would_spend(request, servo)?;
        Ok(Reply::Done)
    }

    /// The pass of the part that arming would spend. The ledger is asked as well as the servo: it also knows of
    /// armings that failed after they were written.
    fn would_spend(&self, request: &ArmRequest, servo: &mut impl ServoAccess<'a>) -> Result<Spent, Denial> {
        self.not_computing()?;
        if self.ledger.now().settings.is_none() {
            return Err(Denial::NotConfigured);
        }
        let pass = servo.with(|servo| servo.check(request)).map_err(Denial::Refused)?;
        if self.ledger.now().is_spent(&pass) {
            return Err(Denial::Refused(Refusal::PartRepeated { part_serial: pass.part_serial }));
        }
        Ok(pass)
    }

    /// The pass of the part is spent in the ledger before the arming can have any effect; should the arming then fail
    /// (the link fell silent meanwhile), it stays spent.
    pub fn arm<'s>(&mut self, request: &ArmRequest, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        let pass = self.would_spend(request, servo)?;
        self.note(LogEntry { value: pass.part_serial, ..self.entry(Change::Armed) })?;
        self.ledger.change(&mut self.flash, |now| now.spend(pass))?;
        servo.with(|servo| servo.arm(request)).map_err(Denial::Refused)?;
        Ok(Reply::Done)
    }

    pub fn disarm<'s>(&mut self, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        servo.with(|servo| servo.disarm()).map_err(Denial::Refused)?;
        self.keep(self.entry(Change::Disarmed));
        Ok(Reply::Done)
    }

    pub fn configure<'s>(
        &mut self,
        settings: DeviceSettings,
        servo: &mut impl ServoAccess<'a>,
    ) -> Result<Reply<'s>, Denial> {
        match servo.with(|servo| servo.mode()) {
            Mode::Off => self.not_computing()?,
            mode => return Err(Denial::Mode(mode)),
        }
        settings.check().map_err(Denial::Settings)?;
        let before = self.settings();
        // The image must go with the new settings before they are kept.
        self.reload(&settings.rewriter, servo).or_else(|denial| {
            self.reload(&before.rewriter, servo)?;
            Err(denial)
        })?;
        if let Err(denial) = self.keep_settings(settings) {
            self.reload(&before.rewriter, servo)?;
            return Err(denial);
        }
        take_over(settings, servo)?;
        self.restart_timing(servo);
        Ok(Reply::Done)
    }

    fn keep_settings(&mut self, settings: DeviceSettings) -> Result<(), Denial> {
        if self.ledger.now().settings != Some(settings) || self.ledger.is_in_doubt() {
            let mut bytes = [0; SETTINGS_BYTES];
            let value = postcard::to_slice(&settings, &mut bytes).map_or(0, |bytes| crc32(bytes));
            self.note(LogEntry { value, ..self.entry(Change::Configured) })?;
        }
        Ok(self.ledger.change(&mut self.flash, |now| now.settings = Some(settings))?)
    }
}

/// Gives the servo settings that were checked. On its own: the rewriter made here is not to stand on the stack under every other
/// request.
#[inline(never)]
fn take_over<'a>(settings: DeviceSettings, servo: &mut impl ServoAccess<'a>) -> Result<(), Denial> {
    let wrong = |error| Denial::Settings(DeviceSettingsError::Rewriter(error));
    let bare = Rewriter::new(settings.rewriter, None).map_err(wrong)?;
    servo.with(|servo| servo.configure(settings, bare)).map_err(Denial::Refused)
}

/// Room for the encoding of any settings: 32 numbers of ten bytes at most.
const SETTINGS_BYTES: usize = 320;
