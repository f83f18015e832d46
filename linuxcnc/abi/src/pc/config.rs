//! The configuration side: checks images, prepares rewriters, keeps the ledger. A thread of its own calls it.

use core::sync::atomic::{AtomicU32, Ordering};

use truepath_core::image::Image;
use truepath_core::rewrite::{Rewriter, Spent, SpentList};

use super::ledger::{self, LEDGER_BYTES};
use super::limits::{Joints, Limits, OfferError};
use super::mailbox::{ConfigEnds, Loaded};

/// The configuration side.
pub struct Config {
    ends: ConfigEnds,
    joints: Joints,
    period_ns: &'static AtomicU32,
    spent: SpentList,
    /// The list with the part that is about to be armed, while it is written.
    next: Option<SpentList>,
}

impl Config {
    pub(super) const fn new(ends: ConfigEnds, joints: Joints, period_ns: &'static AtomicU32, spent: SpentList) -> Self {
        Self { ends, joints, period_ns, spent, next: None }
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
        let settings = limits.settings(&self.joints, self.period_ns.load(Ordering::Relaxed))?;
        let rewriter = Rewriter::new(settings, Some(image)).map_err(OfferError::Settings)?;
        Ok(Loaded { rewriter, bytes })
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
        let mut next = self.spent;
        remember(&mut next, part);
        self.next = Some(next);
        ledger::write(&next, file)
    }

    /// Whether that file is on the disk; only then the part is armed.
    pub fn written(&mut self, done: bool) {
        if let Some(next) = self.next.take() {
            // A write that failed may have come through all the same, then the part is spent on the disk alone.
            if done {
                self.spent = next;
            }
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
