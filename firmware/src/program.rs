//! The program of the device: its place in the flash, and the upload of an update.
//!
//! A program lies at the start of its sectors, as it was linked; the head it was signed with ([`UpdateHead`]) in their last
//! words. An update lies in the same way in the sectors of both image slots, and its head is its commit word: the last that is
//! programmed, once the program was read back and has the digest of the head. A sector is erased when the upload comes to it,
//! so that no request erases more than one.
//!
//! An upload is not resumed behind a reset: the head, which says what is to come, is in RAM until the end.

use embedded_storage::nor_flash::{NorFlash, ReadNorFlash};
use sha2::{Digest, Sha512};
use truepath_core::image::KeyRing;
use truepath_core::link::Denial;
use truepath_core::update::{Label, UPDATE_DIGEST_BYTES, UPDATE_HEAD_BYTES, UpdateError, UpdateHead};

use crate::flash::{BLANK, PROGRAM_SECTORS, Region, SECTOR_BYTES, UPDATE_SECTORS, WORD_BYTES, Word};

/// Where the head lies, from the start of the program.
const HEAD: u32 = (PROGRAM_SECTORS.len() - UPDATE_HEAD_BYTES) as u32;
/// Most bytes of a program.
pub const PROGRAM_BYTES: u32 = HEAD;
const HEAD_BYTES: u32 = UPDATE_HEAD_BYTES as u32;
const WORD: u32 = WORD_BYTES as u32;

const _: () = assert!(HEAD.is_multiple_of(WORD) && HEAD_BYTES.is_multiple_of(WORD));

/// Who may sign what for whom.
#[derive(Clone, Copy)]
pub struct Terms<'k> {
    /// The keys of the device.
    pub keys: &'k KeyRing,
    /// Its board.
    pub board: Label,
    /// The least counter.
    pub least: u32,
}

impl Terms<'_> {
    fn admit(&self, head: &[u8; UPDATE_HEAD_BYTES]) -> Result<UpdateHead, UpdateError> {
        let head = UpdateHead::verified(head, self.keys, self.board, PROGRAM_BYTES)?;
        if head.counter < self.least {
            return Err(UpdateError::RolledBack { found: head.counter, least: self.least });
        }
        Ok(head)
    }
}

/// The bytes of a head in a region; none where a word cannot be read.
fn head<F: ReadNorFlash>(flash: &mut F, region: Region) -> Option<[u8; UPDATE_HEAD_BYTES]> {
    let mut bytes = [0; UPDATE_HEAD_BYTES];
    flash.read(region.start() + HEAD, &mut bytes).ok()?;
    Some(bytes)
}

/// SHA-512 of the first bytes of a region; none where a word cannot be read.
#[inline(never)]
fn digest<F: ReadNorFlash>(flash: &mut F, region: Region, length: u32) -> Option<[u8; UPDATE_DIGEST_BYTES]> {
    let mut hash = Sha512::new();
    let mut piece = [0; 8 * WORD_BYTES];
    for at in (0..length).step_by(8 * WORD_BYTES) {
        let left = piece.len().min((length - at) as usize);
        let piece = &mut piece[..left];
        flash.read(region.start() + at, piece).ok()?;
        hash.update(piece);
    }
    Some(hash.finalize().into())
}

/// The head of the program that runs; none of one that came through the debug port, and without a loader.
pub fn running<F: ReadNorFlash>(flash: &mut F) -> Option<UpdateHead> {
    UpdateHead::read(&head(flash, PROGRAM_SECTORS)?)
}

/// Whether the program in its place is the one that its head was signed for.
pub fn running_is_whole<F: ReadNorFlash>(flash: &mut F) -> bool {
    let Some(head) = running(flash).filter(|head| head.length <= PROGRAM_BYTES) else { return false };
    digest(flash, PROGRAM_SECTORS, head.length) == Some(head.digest)
}

/// The update that was uploaded as a whole, verified anew.
///
/// # Errors
/// There is none, or it is not admitted.
pub fn uploaded<F: ReadNorFlash>(flash: &mut F, terms: &Terms<'_>) -> Result<UpdateHead, UpdateError> {
    let bytes = head(flash, UPDATE_SECTORS).ok_or(UpdateError::Nothing)?;
    UpdateHead::read(&bytes).ok_or(UpdateError::Nothing)?;
    let head = terms.admit(&bytes)?;
    if digest(flash, UPDATE_SECTORS, head.length) == Some(head.digest) { Ok(head) } else { Err(UpdateError::Digest) }
}

/// An upload under way: head, then program.
#[derive(Clone, Copy, Debug)]
pub struct ProgramUpload {
    /// Bytes of head and program, as announced.
    length: u32,
    /// Bytes that have arrived.
    arrived: u32,
    bytes: [u8; UPDATE_HEAD_BYTES],
    head: Option<UpdateHead>,
    carry: [u8; WORD_BYTES],
}

impl ProgramUpload {
    /// An upload of so many bytes, head included. Nothing is erased yet.
    ///
    /// # Errors
    /// It has no place.
    pub fn begin(length: u32) -> Result<Self, UpdateError> {
        match length.checked_sub(HEAD_BYTES) {
            Some(1..=PROGRAM_BYTES) => {}
            program => return Err(UpdateError::Length { length: program.unwrap_or(0), most: PROGRAM_BYTES }),
        }
        Ok(Self { length, arrived: 0, bytes: [0; UPDATE_HEAD_BYTES], head: None, carry: BLANK })
    }
    /// Where the next chunk goes.
    pub const fn next(&self) -> u32 {
        self.arrived
    }
    /// The head, once it is there and was admitted.
    pub const fn head(&self) -> Option<&UpdateHead> {
        self.head.as_ref()
    }

    /// Takes what of the next bytes belongs to the head; gives the rest. The head is admitted when it is whole.
    ///
    /// # Errors
    /// [`Denial::Offset`], with nothing changed; [`Denial::Update`], then the upload has to be begun again.
    pub fn head_of<'b>(&mut self, offset: u32, bytes: &'b [u8], terms: &Terms<'_>) -> Result<&'b [u8], Denial> {
        if offset != self.arrived || bytes.len() > (self.length - self.arrived) as usize {
            return Err(Denial::Offset { expected: self.arrived, found: offset, bytes: bytes.len() as u32 });
        }
        let places = self.bytes.get_mut(self.arrived as usize..).unwrap_or_default();
        let (head, rest) = bytes.split_at(bytes.len().min(places.len()));
        for (place, byte) in places.iter_mut().zip(head) {
            *place = *byte;
        }
        self.arrived += head.len() as u32;
        if self.arrived == HEAD_BYTES && self.head.is_none() {
            let head = terms.admit(&self.bytes).map_err(Denial::Update)?;
            let length = self.length - HEAD_BYTES;
            if head.length != length {
                return Err(Denial::Update(UpdateError::Length { length, most: head.length }));
            }
            self.head = Some(head);
        }
        Ok(rest)
    }

    /// Takes the next bytes of the program, which [`ProgramUpload::head_of`] has left.
    ///
    /// # Errors
    /// [`Denial::Flash`]: the upload has to be begun again.
    pub fn program<F: NorFlash>(&mut self, flash: &mut F, bytes: &[u8]) -> Result<(), Denial> {
        for &byte in bytes {
            let at = self.arrived - HEAD_BYTES;
            self.carry[(at % WORD) as usize] = byte;
            self.arrived += 1;
            if at % WORD == WORD - 1 || self.arrived == self.length {
                let word = core::mem::replace(&mut self.carry, BLANK);
                let offset = at - at % WORD;
                if offset.is_multiple_of(SECTOR_BYTES as u32) {
                    erase(flash, offset)?;
                }
                write(flash, offset, &word)?;
            }
        }
        Ok(())
    }

    /// Reads the program back, and programs the head if it is the one that was signed.
    ///
    /// # Errors
    /// [`Denial::Incomplete`], with nothing changed; [`Denial::Update`] and [`Denial::Flash`]: it has to be begun again.
    pub fn commit<F: NorFlash>(&self, flash: &mut F) -> Result<UpdateHead, Denial> {
        let (length, written) = (self.length, self.arrived);
        let head = self.head.filter(|_| written == length).ok_or(Denial::Incomplete { length, written })?;
        let last = HEAD - HEAD % SECTOR_BYTES as u32;
        if head.length <= last {
            erase(flash, last)?;
        }
        if digest(flash, UPDATE_SECTORS, head.length) != Some(head.digest) {
            return Err(Denial::Update(UpdateError::Digest));
        }
        for (word, offset) in self.bytes.as_chunks::<WORD_BYTES>().0.iter().zip((HEAD..).step_by(WORD_BYTES)) {
            write(flash, offset, word)?;
        }
        Ok(head)
    }
}

/// Erases a sector of the update.
fn erase<F: NorFlash>(flash: &mut F, offset: u32) -> Result<(), Denial> {
    let address = UPDATE_SECTORS.start() + offset;
    flash.erase(address, address + SECTOR_BYTES as u32).map_err(|_| Denial::Flash { address })
}

/// Programs a word of the update and reads it back; one of ones reads the same unprogrammed.
fn write<F: NorFlash>(flash: &mut F, offset: u32, word: &[u8; WORD_BYTES]) -> Result<(), Denial> {
    let address = UPDATE_SECTORS.start() + offset;
    let failed = Denial::Flash { address };
    if *word == BLANK {
        return if Word::read(flash, address).is_blank() { Ok(()) } else { Err(failed) };
    }
    flash.write(address, word).map_err(|_| failed)?;
    if Word::read(flash, address) == Word::Written(*word) { Ok(()) } else { Err(failed) }
}
