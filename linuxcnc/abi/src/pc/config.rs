//! The configuration side: checks images and whose they are, prepares rewriters, keeps the ledger. A thread of its own calls
//! it; a signature is verified there, a pass over the bytes of an image.

use core::sync::atomic::{AtomicU32, Ordering};

use truepath_core::image::{Counted, DeviceClass, Image, KeyRing, SignatureError};
use truepath_core::rewrite::{Rewriter, Spent, SpentList};

use super::ledger::{self, LEDGER_BYTES, Remembered};
use super::limits::{Joints, Limits, OfferError};
use super::mailbox::{ConfigEnds, Loaded};
use super::trust;

/// The configuration side.
pub struct Config {
    ends: ConfigEnds,
    joints: Joints,
    period_ns: &'static AtomicU32,
    now: Remembered,
    /// What is remembered next, while it is written.
    next: Option<Next>,
    keys: KeyRing,
}

/// What is written.
enum Next {
    /// With the part that is about to be armed.
    Part(Remembered),
    /// With the counter of an image that is about to be used.
    Counter(Remembered),
}

impl Config {
    pub(super) fn new(ends: ConfigEnds, joints: Joints, period_ns: &'static AtomicU32, now: Remembered) -> Self {
        Self { ends, joints, period_ns, now, next: None, keys: KeyRing::default() }
    }

    /// From now on only images signed with a key of this file are taken.
    ///
    /// # Errors
    /// The number of the line that is no key, or [`trust::NO_KEY`]; then nothing changes.
    pub fn trust(&mut self, file: &[u8]) -> Result<(), u32> {
        self.keys = trust::keys(file)?;
        Ok(())
    }

    /// Whether an image can be offered: the servo thread runs, and the one before was taken.
    pub fn is_ready(&self) -> bool {
        self.period_ns.load(Ordering::Relaxed) != 0 && self.ends.offer.is_free()
    }

    /// Checks an image and hands it to the servo side, which uses it from the next period in `Off` or `Bypass` on. No
    /// image takes the one in use away.
    ///
    /// # Errors
    /// It cannot be used; then nothing changes.
    pub fn offer(&mut self, limits: &Limits, image: Option<&'static [u8]>) -> Result<(), OfferError> {
        let offer = image.map(|bytes| self.load(limits, bytes)).transpose()?;
        self.ends.offer.send(offer).map_err(|_| OfferError::Busy)
    }

    fn load(&self, limits: &Limits, bytes: &'static [u8]) -> Result<Loaded, OfferError> {
        let image = Image::new_checked(bytes).map_err(OfferError::Image)?;
        let counted = self.verified(&image, bytes).map_err(OfferError::Untrusted)?;
        if counted.is_some_and(|counted| counted.counter > self.now.counters.least(&counted)) {
            return Err(OfferError::NotRemembered);
        }
        let settings = limits.settings(&self.joints, self.period_ns.load(Ordering::Relaxed))?;
        let rewriter = Rewriter::new(settings, Some(image)).map_err(OfferError::Settings)?;
        Ok(Loaded { rewriter, bytes })
    }

    /// The counter of an image, if there are keys and it is to be used with them.
    fn verified(&self, image: &Image<'_>, bytes: &[u8]) -> Result<Option<Counted>, SignatureError> {
        let Some(found) = self.keys.admits(bytes, DeviceClass::LinuxCnc)? else { return Ok(None) };
        let counted = Counted::of(&image.settings().binding, found);
        let least = self.now.counters.least(&counted);
        if found < least { Err(SignatureError::RolledBack { found, least }) } else { Ok(Some(counted)) }
    }

    /// If the counter of an image has to be remembered before it is offered, writes the ledger that does; gives the bytes
    /// of the file, 0 otherwise. [`Config::written`] has to follow.
    pub fn count(&mut self, bytes: &[u8], file: &mut [u8; LEDGER_BYTES]) -> usize {
        let Ok(image) = Image::new_checked(bytes) else { return 0 };
        let Ok(Some(counted)) = self.verified(&image, bytes) else { return 0 };
        let mut next = self.now;
        next.counters.raise(counted);
        if next == self.now {
            return 0;
        }
        self.next = Some(Next::Counter(next));
        ledger::write(&next, file)
    }

    /// An image that is used no more.
    pub fn returned(&mut self) -> Option<&'static [u8]> {
        self.ends.returned.take()
    }

    /// If a part is about to be armed, writes the ledger that remembers it; gives the bytes of the file, 0 otherwise.
    /// [`Config::written`] has to follow.
    pub fn spend(&mut self, file: &mut [u8; LEDGER_BYTES]) -> usize {
        let Some(part) = self.ends.spending.take() else {
            return 0;
        };
        let mut next = self.now;
        remember(&mut next.spent, part);
        self.next = Some(Next::Part(next));
        ledger::write(&next, file)
    }

    /// Whether that file is on the disk; only then the part is armed, or the image can be offered.
    pub fn written(&mut self, done: bool) {
        let Some(next) = self.next.take() else { return };
        // A write that failed may have come through all the same, then it is remembered on the disk alone.
        let (Next::Part(now) | Next::Counter(now)) = next;
        if done {
            self.now = now;
        }
        if let Next::Part(_) = next {
            // There is room: the servo side asks one at a time.
            let _ = self.ends.written.send(done);
        }
    }
}

/// A part whose arming was not completed is asked for again; it is remembered once.
fn remember(list: &mut SpentList, part: Spent) {
    if !list.contains(&part) {
        list.spend(part);
    }
}
