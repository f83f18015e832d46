//! One upload into a slot, from `Begin` to the commit word.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{Binding, SignatureError};
use truepath_core::link::{Denial, Slot};

use super::store::{FlashSlot, Header, Kind, image};
use crate::flash::{BLANK, WORD_BYTES, Word};

/// An upload under way.
#[derive(Clone, Copy, Debug)]
pub struct Upload {
    place: FlashSlot,
    header: Header,
    /// Bytes that have arrived; those of an incomplete word wait in `carry`.
    arrived: u32,
    carry: [u8; WORD_BYTES],
    committed: bool,
}

impl Upload {
    /// Begins an upload, or goes on with an interrupted one of the same length and checksum. Erases what has to be
    /// erased, which takes seconds on a real part. `slots` is what the slots hold; the active one is never taken.
    ///
    /// # Errors
    /// [`Denial::Flash`] with the slot, which may be damaged; nothing was begun then.
    pub fn begin<F: NorFlash>(flash: &mut F, slots: &[Slot; 2], length: u32, crc: u32) -> Result<Self, (u8, Denial)> {
        let slot = idle(slots, length, crc);
        Self::begin_in(flash, slot, slots[usize::from(slot)], length, crc).map_err(|denial| (slot, denial))
    }

    fn begin_in<F: NorFlash>(flash: &mut F, slot: u8, held: Slot, length: u32, crc: u32) -> Result<Self, Denial> {
        let place = FlashSlot(slot);
        let same = |header: &Header| header.length == length && header.crc == crc;
        let upload = |header, arrived, committed| Self { place, header, arrived, carry: BLANK, committed };
        if let (Slot::Image { .. }, Some(header)) = (held, place.committed(flash).filter(same)) {
            return Ok(upload(header, length, true));
        }
        let failed = |address| move |_| Denial::Flash { address };
        if let (true, Some(header)) = (place.commit(flash).is_blank(), place.header(flash).filter(same))
            && let Some(reached) = place.progress(flash, &header)
        {
            if let Some(sector) = reached.erase_from {
                flash.erase(sector, place.end(length)).map_err(failed(sector))?;
            }
            return Ok(upload(header, reached.written, false));
        }
        let newest =
            (0..2).filter_map(|slot| FlashSlot(slot).header(flash)).map(|header| header.generation).max().unwrap_or(0);
        let header = Header { length, crc, generation: newest.saturating_add(1) };
        flash.erase(place.head_offset(), place.end(length)).map_err(failed(place.head_offset()))?;
        program(flash, place.head_offset(), &header.encode(Kind::Head))?;
        Ok(upload(header, 0, false))
    }

    /// Slot it goes to.
    pub const fn slot(&self) -> u8 {
        self.place.0
    }
    /// Where the next chunk goes.
    pub const fn next(&self) -> u32 {
        self.arrived
    }
    /// Checksum of the image.
    pub const fn crc(&self) -> u32 {
        self.header.crc
    }
    /// Whether the image was there before, committed.
    pub const fn is_committed(&self) -> bool {
        self.committed
    }
    /// Whether everything has arrived.
    ///
    /// # Errors
    /// [`Denial::Incomplete`].
    pub const fn is_complete(&self) -> Result<(), Denial> {
        let (length, written) = (self.header.length, self.arrived);
        if written < length { Err(Denial::Incomplete { length, written }) } else { Ok(()) }
    }
    /// What the slot holds meanwhile.
    pub const fn held(&self) -> Slot {
        Slot::Partial { length: self.header.length, crc: self.header.crc, written: self.arrived }
    }

    /// Takes the next bytes; gives where the ones after them go.
    ///
    /// # Errors
    /// [`Denial::Offset`], with nothing changed; [`Denial::Flash`], then the upload has to be begun again.
    pub fn chunk<F: NorFlash>(&mut self, flash: &mut F, offset: u32, bytes: &[u8]) -> Result<u32, Denial> {
        let room = (self.header.length - self.arrived) as usize;
        if offset != self.arrived || bytes.len() > room {
            return Err(Denial::Offset { expected: self.arrived, found: offset, bytes: bytes.len() as u32 });
        }
        for &byte in bytes {
            let at = self.arrived as usize % WORD_BYTES;
            self.carry[at] = byte;
            self.arrived += 1;
            if at == WORD_BYTES - 1 || self.arrived == self.header.length {
                let word = self.place.data(self.arrived - 1 - at as u32);
                program(flash, word, &core::mem::replace(&mut self.carry, BLANK))?;
            }
        }
        Ok(self.arrived)
    }

    /// Reads the image back into `scratch`, checks it, asks whether it is admitted, and programs the commit word; gives what
    /// the slot then holds.
    ///
    /// # Errors
    /// [`Denial::Incomplete`], with nothing changed; [`Denial::Image`], [`Denial::Checksum`] or [`Denial::Untrusted`]: no
    /// usable image, another one, or one that is not admitted, and the slot is marked so; [`Denial::Flash`].
    pub fn commit<F: NorFlash>(
        &mut self,
        flash: &mut F,
        scratch: &mut [u8],
        admit: impl FnOnce(&mut F, &[u8], &Binding) -> Result<(), SignatureError>,
    ) -> Result<Slot, Denial> {
        self.is_complete()?;
        let found = image(flash, self.place, &self.header, scratch).map(|image| image.settings().binding);
        let bytes = scratch.get(..self.header.length as usize).unwrap_or(&[]);
        let found = found.and_then(|binding| match admit(flash, bytes, &binding) {
            Ok(()) => Ok(binding),
            Err(error) => Err(Denial::Untrusted(error)),
        });
        self.seal(flash, found)
    }

    /// The same for an image that is in RAM and was checked there: what is read back must be equal to it.
    ///
    /// # Errors
    /// As [`Upload::commit`], and [`Denial::Flash`] with the place of the difference.
    pub fn commit_equal<F: NorFlash>(&mut self, flash: &mut F, bytes: &[u8], binding: Binding) -> Result<Slot, Denial> {
        self.is_complete()?;
        let mut piece = [0; WORD_BYTES];
        let mut found = Ok(binding);
        for (expected, at) in bytes.chunks(WORD_BYTES).zip((self.place.data(0)..).step_by(WORD_BYTES)) {
            let read = &mut piece[..expected.len()];
            if flash.read(at, read).is_err() || read != expected {
                found = Err(Denial::Flash { address: at });
                break;
            }
        }
        self.seal(flash, found)
    }

    fn seal<F: NorFlash>(&mut self, flash: &mut F, found: Result<Binding, Denial>) -> Result<Slot, Denial> {
        let Header { length, crc, generation } = self.header;
        let kind = if found.is_ok() { Kind::Commit } else { Kind::Rejected };
        if self.place.commit(flash).is_blank() {
            program(flash, self.place.commit_offset(), &self.header.encode(kind))?;
        }
        let binding = found?;
        if self.place.committed(flash) != Some(self.header) {
            return Err(Denial::Flash { address: self.place.commit_offset() });
        }
        self.committed = true;
        Ok(Slot::Image { length, crc, generation, active: false, binding })
    }
}

/// The slot an upload goes to: never the active one; one that holds or has begun the same image; else an empty one,
/// one without an image, the older image.
fn idle(slots: &[Slot; 2], wanted_length: u32, wanted_crc: u32) -> u8 {
    let worth = |slot: &Slot| match *slot {
        Slot::Image { active: true, .. } => u64::MAX,
        Slot::Image { length, crc, .. } | Slot::Partial { length, crc, .. }
            if (length, crc) == (wanted_length, wanted_crc) =>
        {
            0
        }
        Slot::Empty => 1,
        Slot::Partial { .. } | Slot::Damaged => 2,
        Slot::Image { generation, .. } => 3 + u64::from(generation),
    };
    u8::from(worth(&slots[1]) < worth(&slots[0]))
}

/// Programs one word and reads it back; a word of ones stays as the erase left it.
fn program<F: NorFlash>(flash: &mut F, offset: u32, word: &[u8; WORD_BYTES]) -> Result<(), Denial> {
    let found = if *word == BLANK {
        Word::read(flash, offset)
    } else {
        flash.write(offset, word).map_err(|_| Denial::Flash { address: offset })?;
        Word::read(flash, offset)
    };
    let expected = if *word == BLANK { Word::Blank } else { Word::Written(*word) };
    if found == expected { Ok(()) } else { Err(Denial::Flash { address: offset }) }
}
