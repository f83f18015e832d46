//! A slot in the flash: its head and commit word, what it holds after any history, and its image.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{Binding, DEVICE_NODES, Image, SIGNATURE_BYTES, image_bytes};
use truepath_core::link::{Denial, Slot};

use crate::flash::{Region, SECTOR_BYTES, SLOT_BYTES, SLOT_SECTORS, WORD_BYTES, Word, opened, sealed};

/// Where the commit word lies in a slot.
const COMMIT: u32 = WORD_BYTES as u32;
/// Where the image begins in a slot.
pub(super) const DATA: u32 = 2 * WORD_BYTES as u32;
/// Most bytes of an image, signed.
pub const SLOT_IMAGE_BYTES: usize = image_bytes(DEVICE_NODES) + SIGNATURE_BYTES;

const _: () = assert!(SLOT_IMAGE_BYTES + DATA as usize <= SLOT_BYTES);

/// What a head or commit word says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Header {
    /// Bytes of the image.
    pub length: u32,
    /// Its checksum.
    pub crc: u32,
    /// Number of the upload.
    pub generation: u32,
}

/// Which word it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    /// An upload was begun.
    Head,
    /// The image is complete and was checked.
    Commit,
    /// The upload was complete and no usable image.
    Rejected,
}

impl Kind {
    const fn magic(self) -> [u8; 4] {
        match self {
            Self::Head => *b"TPH1",
            Self::Commit => *b"TPC1",
            Self::Rejected => *b"TPX1",
        }
    }
}

impl Header {
    /// The word.
    pub fn encode(self, kind: Kind) -> [u8; WORD_BYTES] {
        sealed(kind.magic(), [self.length, self.crc, self.generation, 0, 0, 0])
    }
    /// What a word says, if it is an undamaged one of this kind.
    pub fn decode(kind: Kind, word: &[u8; WORD_BYTES]) -> Option<Self> {
        let [length, crc, generation, ..] = opened(kind.magic(), word)?;
        Some(Self { length, crc, generation })
    }
}

/// A slot in the flash, by its number. A number above 1 is that of the second.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct FlashSlot(pub u8);

impl FlashSlot {
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
    /// What its head says.
    pub fn header<F: NorFlash>(self, flash: &mut F) -> Option<Header> {
        let header = Header::decode(Kind::Head, &self.head(flash).written()?)?;
        (1..=SLOT_IMAGE_BYTES as u32).contains(&header.length).then_some(header)
    }
    /// What both say, if head and commit word agree.
    pub fn committed<F: NorFlash>(self, flash: &mut F) -> Option<Header> {
        let header = self.header(flash)?;
        let commit = Header::decode(Kind::Commit, &self.commit(flash).written()?)?;
        (commit == header).then_some(header)
    }
    /// How far an uncommitted upload has come; none if nothing in the slot can be continued.
    pub fn progress<F: NorFlash>(self, flash: &mut F, header: &Header) -> Option<Reached> {
        let words = (self.start()..self.end(header.length)).step_by(WORD_BYTES).skip(2);
        let last = words.clone().rev().find(|&at| !Word::read(flash, at).is_blank());
        let Some(last) = last else { return Some(Reached { written: 0, erase_from: None }) };
        let end = last - self.data(0) + WORD_BYTES as u32;
        if end > header.length.next_multiple_of(WORD_BYTES as u32) {
            return None;
        }
        let torn = words.take_while(|&at| at <= last).find(|&at| Word::read(flash, at) == Word::Torn);
        let Some(torn) = torn else {
            return Some(Reached { written: end.min(header.length), erase_from: None });
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
    let place = FlashSlot(slot);
    if let Some(header) = place.committed(flash) {
        let Header { length, crc, generation } = header;
        return match image(flash, place, &header, scratch) {
            Ok(image) => Slot::Image { length, crc, generation, active: false, binding: image.settings().binding },
            Err(_) => Slot::Damaged,
        };
    }
    match (place.head(flash), place.commit(flash), place.header(flash)) {
        (_, Word::Blank, Some(header)) => match place.progress(flash, &header) {
            Some(reached) => Slot::Partial { length: header.length, crc: header.crc, written: reached.written },
            None => Slot::Damaged,
        },
        (Word::Blank, Word::Blank, _) => {
            let mut words = (place.region().start()..place.region().end()).step_by(WORD_BYTES);
            if words.all(|at| Word::read(flash, at).is_blank()) { Slot::Empty } else { Slot::Damaged }
        }
        _ => Slot::Damaged,
    }
}

/// Reads the committed image of a slot into `into` and checks it; gives its length and what it belongs to.
///
/// # Errors
/// [`Denial::NoImage`], [`Denial::OtherImage`] if it is not the one with this checksum, [`Denial::Image`] or
/// [`Denial::Flash`] if it does not pass the check any more.
pub fn read<F: NorFlash>(flash: &mut F, slot: u8, crc: u32, into: &mut [u8]) -> Result<(usize, Binding), Denial> {
    let header = (slot < 2).then(|| FlashSlot(slot).committed(flash)).flatten().ok_or(Denial::NoImage { slot })?;
    if header.crc != crc {
        return Err(Denial::OtherImage { slot, expected: crc, found: header.crc });
    }
    let binding = image(flash, FlashSlot(slot), &header, into)?.settings().binding;
    Ok((header.length as usize, binding))
}

/// The image of a slot, read and checked, whether committed or not.
pub(super) fn image<'b, F: NorFlash>(
    flash: &mut F,
    place: FlashSlot,
    header: &Header,
    into: &'b mut [u8],
) -> Result<Image<'b>, Denial> {
    let address = place.data(0);
    let bytes = into.get_mut(..header.length as usize).ok_or(Denial::Flash { address })?;
    flash.read(address, bytes).map_err(|_| Denial::Flash { address })?;
    let image = Image::new_checked(bytes).map_err(Denial::Image)?;
    if image.crc() != header.crc {
        return Err(Denial::Checksum { expected: header.crc, found: image.crc() });
    }
    Ok(image)
}
