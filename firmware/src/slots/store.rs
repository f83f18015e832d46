//! Reading slots: what a slot holds after any history, and its image.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{DEVICE_NODES, Image, image_bytes};
use truepath_core::link::{Denial, Slot};

use super::word::{Kind, Label};
use crate::flash::{Region, SECTOR_BYTES, SLOT_BYTES, SLOT_SECTORS, WORD_BYTES, Word};

/// Where the commit word lies in a slot.
const COMMIT: u32 = WORD_BYTES as u32;
/// Where the image begins in a slot.
pub(super) const DATA: u32 = 2 * WORD_BYTES as u32;
/// Most bytes of an image.
pub const SLOT_IMAGE_BYTES: usize = image_bytes(DEVICE_NODES);

const _: () = assert!(SLOT_IMAGE_BYTES + DATA as usize <= SLOT_BYTES);

/// A slot in the flash, by its number. A number above 1 is that of the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Bay(pub u8);

impl Bay {
    pub fn region(self) -> Region {
        SLOT_SECTORS[usize::from(self.0 > 0)]
    }
    fn start(self) -> u32 {
        self.region().start()
    }
    /// The end of the sectors that an image of a length needs. The others are neither erased nor looked at.
    pub fn end(self, length: u32) -> u32 {
        self.start() + (DATA + length).next_multiple_of(SECTOR_BYTES as u32)
    }
    /// Where a byte of the image lies in the bank.
    pub fn data(self, offset: u32) -> u32 {
        self.start() + DATA + offset
    }
    pub fn head_offset(self) -> u32 {
        self.start()
    }
    pub fn commit_offset(self) -> u32 {
        self.start() + COMMIT
    }
    pub fn head<F: NorFlash>(self, flash: &mut F) -> Word {
        Word::read(flash, self.head_offset())
    }
    pub fn commit<F: NorFlash>(self, flash: &mut F) -> Word {
        Word::read(flash, self.commit_offset())
    }
    /// The label of its head.
    pub fn label<F: NorFlash>(self, flash: &mut F) -> Option<Label> {
        let label = Label::decode(Kind::Head, &self.head(flash).written()?)?;
        (1..=SLOT_IMAGE_BYTES as u32).contains(&label.length).then_some(label)
    }
    /// The label, if head and commit word agree.
    pub fn committed<F: NorFlash>(self, flash: &mut F) -> Option<Label> {
        let label = self.label(flash)?;
        let commit = Label::decode(Kind::Commit, &self.commit(flash).written()?)?;
        (commit == label).then_some(label)
    }
    /// How far an uncommitted upload has come; none if nothing in the slot can be continued.
    pub fn progress<F: NorFlash>(self, flash: &mut F, label: &Label) -> Option<Reached> {
        let words = (self.start()..self.end(label.length)).step_by(WORD_BYTES).skip(2);
        let last = words.clone().rev().find(|&at| !Word::read(flash, at).is_blank());
        let Some(last) = last else { return Some(Reached { written: 0, erase_from: None }) };
        let end = last - self.data(0) + WORD_BYTES as u32;
        if end > label.length.next_multiple_of(WORD_BYTES as u32) {
            return None;
        }
        let torn = words.take_while(|&at| at <= last).find(|&at| Word::read(flash, at) == Word::Torn);
        let Some(torn) = torn else {
            return Some(Reached { written: end.min(label.length), erase_from: None });
        };
        let sector = torn - (torn - self.start()) % SECTOR_BYTES as u32;
        // The first sector holds the head as well.
        (sector > self.start()).then(|| Reached { written: sector - self.data(0), erase_from: Some(sector) })
    }
}

/// How far an upload has come.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Reached {
    /// Bytes of the image that are there.
    pub written: u32,
    /// From this sector (its offset in the bank) on the slot must be erased before the upload goes on.
    pub erase_from: Option<u32>,
}

/// What a slot holds. `scratch` of [`SLOT_IMAGE_BYTES`] is for the image; whether it is in use, the caller knows.
pub fn survey<F: NorFlash>(flash: &mut F, slot: u8, scratch: &mut [u8]) -> Slot {
    let bay = Bay(slot);
    if let Some(label) = bay.committed(flash) {
        let Label { length, crc, generation } = label;
        return match image(flash, bay, &label, scratch) {
            Ok(image) => Slot::Image { length, crc, generation, active: false, binding: image.settings().binding },
            Err(_) => Slot::Damaged,
        };
    }
    match (bay.head(flash), bay.commit(flash), bay.label(flash)) {
        (_, Word::Blank, Some(label)) => match bay.progress(flash, &label) {
            Some(reached) => Slot::Partial { length: label.length, crc: label.crc, written: reached.written },
            None => Slot::Damaged,
        },
        (Word::Blank, Word::Blank, _) => {
            let mut words = (bay.region().start()..bay.region().end()).step_by(WORD_BYTES);
            if words.all(|at| Word::read(flash, at).is_blank()) { Slot::Empty } else { Slot::Damaged }
        }
        _ => Slot::Damaged,
    }
}

/// Reads the committed image of a slot into `into` and checks it; gives its length.
///
/// # Errors
/// [`Denial::NoImage`], [`Denial::OtherImage`] if it is not the one with this checksum, [`Denial::Image`] or
/// [`Denial::Flash`] if it does not pass the check any more.
pub fn read<F: NorFlash>(flash: &mut F, slot: u8, crc: u32, into: &mut [u8]) -> Result<usize, Denial> {
    let label = (slot < 2).then(|| Bay(slot).committed(flash)).flatten().ok_or(Denial::NoImage { slot })?;
    if label.crc != crc {
        return Err(Denial::OtherImage { slot, expected: crc, found: label.crc });
    }
    image(flash, Bay(slot), &label, into)?;
    Ok(label.length as usize)
}

/// The image of a slot, read and checked, whether committed or not.
pub(super) fn image<'b, F: NorFlash>(
    flash: &mut F,
    bay: Bay,
    label: &Label,
    into: &'b mut [u8],
) -> Result<Image<'b>, Denial> {
    let address = bay.data(0);
    let bytes = into.get_mut(..label.length as usize).ok_or(Denial::Flash { address })?;
    flash.read(address, bytes).map_err(|_| Denial::Flash { address })?;
    let image = Image::new_checked(bytes).map_err(Denial::Image)?;
    if image.crc() != label.crc {
        return Err(Denial::Checksum { expected: label.crc, found: image.crc() });
    }
    Ok(image)
}
