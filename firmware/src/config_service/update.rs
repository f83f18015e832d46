//! Firmware updates, as requests: upload over both image slots, hand-over to the loader, confirmation.
//!
//! All of it in `Off` alone: the drives are not enabled, and nothing is forwarded, so that an erase that holds the processor up
//! holds nothing else up. While an update waits for its start or its confirmation both slots belong to the loader, which
//! has the program before in them.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{Counted, Rights};
use truepath_core::link::{Change, Denial, Firmware, LogEntry, Reply, Slot, TRIAL_US, UpdateStage, UpdateStatus};
use truepath_core::rewrite::Mode;
use truepath_core::update::{Label, UpdateError, UpdateHead};

use super::handler::{Handler, Restart};
use crate::flash::{FLASH_BYTES, LOADER_SECTORS};
use crate::ledger::Ledger;
use crate::loader::{self, LoaderFailed, Start};
use crate::program::{self, PROGRAM_BYTES, ProgramUpload, Terms};
use crate::servo::ServoAccess;

impl From<LoaderFailed> for Denial {
    fn from(_: LoaderFailed) -> Self {
        Self::Flash { address: LOADER_SECTORS.start() }
    }
}

/// Where an update stands behind a reset.
pub(super) fn stage<F: NorFlash>(flash: &mut F) -> UpdateStage {
    if flash.capacity() < FLASH_BYTES {
        return UpdateStage::NoLoader;
    }
    match loader::started(flash) {
        Ok(Start::Trial) => UpdateStage::Trial,
        Ok(Start::RolledBack) => UpdateStage::RolledBack,
        Ok(Start::Settled) | Err(LoaderFailed) => UpdateStage::Settled,
    }
}

/// Makes good the counter of a program that was confirmed, where the power failed in between.
pub(super) fn count<F: NorFlash>(flash: &mut F, ledger: &mut Ledger, stage: UpdateStage) {
    if stage == UpdateStage::Settled
        && let Some(head) = program::running(flash)
    {
        // What cannot be written here is tried again at the next start.
        let _ = ledger.raise(flash, &Counted::firmware(head.counter));
    }
}

impl<'a, F: NorFlash> Handler<'a, F> {
    pub fn update(&mut self) -> UpdateStatus {
        let signs = self.ledger.keys().rights().map(|Rights { firmware, .. }| firmware);
        let most = if self.stage == UpdateStage::NoLoader { 0 } else { PROGRAM_BYTES };
        let running = program::running(&mut self.flash).as_ref().map(Firmware::from);
        UpdateStatus { stage: self.stage, most, running, least: self.least(), signs }
    }

    /// The least counter of firmware that is taken.
    fn least(&mut self) -> u32 {
        self.ledger.least(&mut self.flash, &Counted::firmware(0))
    }

    /// Refused while the slots belong to the loader.
    pub fn slots_are_free(&self) -> Result<(), Denial> {
        match self.stage {
            UpdateStage::Installed | UpdateStage::Trial => Err(Denial::Update(UpdateError::Pending)),
            UpdateStage::NoLoader | UpdateStage::Settled | UpdateStage::RolledBack => Ok(()),
        }
    }

    /// Refused unless in `Off`, with a loader.
    fn replaceable(&self, servo: &mut impl ServoAccess<'a>) -> Result<(), Denial> {
        match servo.with(|servo| servo.mode()) {
            Mode::Off => self.not_computing()?,
            mode => return Err(Denial::Mode(mode)),
        }
        if self.stage == UpdateStage::NoLoader { Err(Denial::Update(UpdateError::NoLoader)) } else { Ok(()) }
    }

    pub fn begin_update(&mut self, length: u32, servo: &mut impl ServoAccess<'a>) -> Result<u32, Denial> {
        self.replaceable(servo)?;
        self.slots_are_free()?;
        let upload = ProgramUpload::begin(length).map_err(Denial::Update)?;
        let next = upload.next();
        self.program_upload = Some(upload);
        Ok(next)
    }

    /// What was begun is given up with every error but that the chunk belongs elsewhere.
    #[inline(never)]
    pub fn update_chunk(&mut self, offset: u32, bytes: &[u8], servo: &mut impl ServoAccess<'a>) -> Result<u32, Denial> {
        self.replaceable(servo)?;
        let mut upload = self.program_upload.ok_or(Denial::NoUpload)?;
        let done = self.take_chunk(&mut upload, offset, bytes, servo);
        self.program_upload = match done {
            Ok(()) | Err(Denial::Offset { .. }) => Some(upload),
            Err(_) => None,
        };
        done.map(|()| upload.next())
    }

    fn take_chunk(
        &mut self,
        upload: &mut ProgramUpload,
        offset: u32,
        bytes: &[u8],
        servo: &mut impl ServoAccess<'a>,
    ) -> Result<(), Denial> {
        let had_head = upload.head().is_some();
        let least = if had_head { 0 } else { self.least() };
        let terms = Terms { keys: self.ledger.keys(), board: board(self.board.name), least };
        let program = upload.head_of(offset, bytes, &terms)?;
        if upload.head().is_some() && !had_head {
            // From here on the images are lost.
            self.deactivate(servo)?;
            self.slots = [Slot::Damaged; 2];
        }
        upload.program(&mut self.flash, program)
    }

    #[inline(never)]
    pub fn commit_update(&mut self, servo: &mut impl ServoAccess<'a>) -> Result<u32, Denial> {
        self.replaceable(servo)?;
        let upload = self.program_upload.ok_or(Denial::NoUpload)?;
        let done = upload.commit(&mut self.flash);
        if !matches!(done, Err(Denial::Incomplete { .. })) {
            self.program_upload = None;
            self.current = None;
        }
        done.map(|head| head.name())
    }

    /// Verifies the whole update anew, from the flash, and has the loader start it at the next reset.
    #[inline(never)]
    pub fn install<'s>(&mut self, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        self.replaceable(servo)?;
        match self.stage {
            UpdateStage::Installed => return Ok(Reply::Done),
            UpdateStage::Trial => return Err(Denial::Update(UpdateError::Pending)),
            _ => {}
        }
        let least = self.least();
        let terms = Terms { keys: self.ledger.keys(), board: board(self.board.name), least };
        let head = program::uploaded(&mut self.flash, &terms).map_err(Denial::Update)?;
        self.note_update(Change::Installed, &head)?;
        loader::install(&mut self.flash)?;
        self.stage = UpdateStage::Installed;
        self.program_upload = None;
        Ok(Reply::Done)
    }

    /// Keeps the program on trial, and takes none that was signed before it from then on.
    #[inline(never)]
    pub fn confirm<'s>(&mut self, servo: &mut impl ServoAccess<'a>) -> Result<Reply<'s>, Denial> {
        self.replaceable(servo)?;
        match self.stage {
            UpdateStage::Trial => {}
            UpdateStage::Settled => return Ok(Reply::Done),
            UpdateStage::Installed => return Err(Denial::Update(UpdateError::Pending)),
            UpdateStage::NoLoader | UpdateStage::RolledBack => return Err(Denial::Update(UpdateError::Nothing)),
        }
        let head = program::running(&mut self.flash).ok_or(Denial::Update(UpdateError::Nothing))?;
        self.note_update(Change::Confirmed, &head)?;
        loader::confirm(&mut self.flash)?;
        self.stage = UpdateStage::Settled;
        self.ledger.raise(&mut self.flash, &Counted::firmware(head.counter))?;
        Ok(Reply::Done)
    }

    fn note_update(&mut self, change: Change, head: &UpdateHead) -> Result<(), Denial> {
        let (value, counter) = (head.name(), head.counter);
        self.note(LogEntry { value, counter, key: Some(head.key), ..self.entry(change) })
    }

    /// The restart that ends a trial which nobody has confirmed: not before the drives are off.
    pub fn trial_is_over(&self, now_us: u64, servo: &mut impl ServoAccess<'a>) -> Option<Restart> {
        let over = self.stage == UpdateStage::Trial
            && now_us.saturating_sub(self.started_us) >= TRIAL_US
            && !servo.with(|servo| servo.drive_enable());
        over.then_some(Restart { watchdog: false })
    }
}

/// A board in the head of an update.
fn board(name: &str) -> Label {
    Label::of(name).unwrap_or_default()
}
