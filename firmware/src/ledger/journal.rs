//! An append-only journal of whole records in two sectors: the newest undamaged record counts.
//!
//! A record has a place of 1,024 bytes: one head word, then the payload. The payload is programmed first, the head
//! last; so the head is the commit word. When a sector is full, the other one is erased and the next record begins
//! it; the sector with the newest record is never erased. Power may fail anywhere: the newest record whose head was
//! programmed is found again, a place that was begun is passed over, and a sector whose erase was interrupted is
//! erased again before it is used, because the newest record is not in it.
//!
//! The last place of a sector is for the keys ([`keys`]), those before it for the counters of images ([`counters`]) and for
//! the log of changes ([`log`]). What of them counts is written before its first record.
//!
//! A sector is good for 10,000 erases (DS12110), the journal so for 2.5 million records.
//!
//! Why not the map of `sequential-storage` 8: it takes a page for open when its first and last words are blank, so
//! what an interrupted erase left between them would be read as its newest items; and it gives up on a word that
//! fails its ECC instead of passing it over.
//!
//! Fields of the head word ([`sealed`], `TPL2`): sequence, bytes of the payload, CRC-32 of the payload, zeros.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{Counted, KeyId, KeyRing, PublicKey, Rights, crc32};
use truepath_core::link::LogEntry;

use super::place::{ALL_PLACES, PLACE_BYTES, PLACES};
use super::{counters, keys, log};
use crate::flash::{BLANK, LEDGER_SECTORS, SECTOR_BYTES, WORD_BYTES, Word, opened, sealed, sector_start};

/// Most bytes of a payload.
pub const PAYLOAD_BYTES: usize = PLACE_BYTES - WORD_BYTES;
const _: () = assert!(WORD_BYTES + PAYLOAD_BYTES == PLACE_BYTES, "a record with its head fills its place");
/// Places that are tried when programming fails, before the journal gives up.
const ATTEMPTS: usize = 3;
/// Its digit is the version of the record: one of another version is no record.
const MAGIC: [u8; 4] = *b"TPL2";

/// Where a record lies: sector of the journal (0 or 1) and place in it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Place {
    sector: usize,
    index: usize,
}

impl Place {
    fn offset(self) -> u32 {
        sector_start(LEDGER_SECTORS.first + self.sector) + (self.index * PLACE_BYTES) as u32
    }
}

#[derive(Clone, Copy)]
struct Head {
    sequence: u32,
    length: usize,
    crc: u32,
}

impl Head {
    fn encode(self) -> [u8; WORD_BYTES] {
        sealed(MAGIC, [self.sequence, self.length as u32, self.crc, 0, 0, 0])
    }
    fn decode(word: &[u8; WORD_BYTES]) -> Option<Self> {
        let [sequence, length, crc, ..] = opened(MAGIC, word)?;
        let head = Self { sequence, length: length as usize, crc };
        (head.length <= PAYLOAD_BYTES).then_some(head)
    }
}

/// The journal. It knows its place; the flash is lent for each call.
#[derive(Clone, Copy, Debug)]
pub struct Journal {
    /// Where the next record goes; none when the other sector has to be erased first.
    next: Option<Place>,
    /// Sector of the newest record; none before the first.
    current: Option<usize>,
    sequence: u32,
}

/// The record could not be written; the newest one before it still counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct JournalFailed;

impl Journal {
    /// Finds the newest record and copies its payload; gives the journal and the length of the payload, if any.
    pub fn open<F: NorFlash>(flash: &mut F, payload: &mut [u8; PAYLOAD_BYTES]) -> (Self, Option<usize>) {
        let mut newest: Option<(Place, Head)> = None;
        // In the places behind there may be a record of a firmware that had neither log nor keys nor counters.
        let places = |sector| (0..ALL_PLACES).map(move |index| Place { sector, index });
        for place in (0..LEDGER_SECTORS.count).flat_map(places) {
            let Some(head) = read_head(flash, place) else { continue };
            let newer = newest.is_none_or(|(_, n)| head.sequence > n.sequence);
            if newer && read_payload(flash, place, head, payload) {
                newest = Some((place, head));
            }
        }
        let Some((place, head)) = newest else {
            return (Self { next: None, current: None, sequence: 0 }, None);
        };
        // A newer head with a damaged payload may have been read over it.
        read_payload(flash, place, head, payload);
        let last = (place.index..PLACES).rev().find(|&index| !is_blank(flash, Place { index, ..place }));
        let index = last.map_or(place.index, |last| last) + 1;
        let next = (index < PLACES).then_some(Place { index, ..place });
        (Self { next, current: Some(place.sector), sequence: head.sequence }, Some(head.length))
    }

    /// Writes a record and reads it back. It counts from the moment at which this returns, at the latest.
    ///
    /// # Errors
    /// The payload is longer than [`PAYLOAD_BYTES`] or the flash failed at several places.
    pub fn append<F: NorFlash>(&mut self, flash: &mut F, payload: &[u8], keys: &KeyRing) -> Result<(), JournalFailed> {
        if payload.len() > PAYLOAD_BYTES {
            return Err(JournalFailed);
        }
        // Counted up even if it fails: what a failed attempt may have left must be older than the next record.
        self.sequence += 1;
        let head = Head { sequence: self.sequence, length: payload.len(), crc: crc32(payload) };
        for _ in 0..ATTEMPTS {
            let place = match self.next {
                Some(place) => place,
                None => self.begin_sector(flash, keys)?,
            };
            // Whatever becomes of it, this place is not tried again.
            self.next = (place.index + 1 < PLACES).then_some(Place { index: place.index + 1, ..place });
            if program(flash, place, head, payload) {
                self.current = Some(place.sector);
                return Ok(());
            }
        }
        Err(JournalFailed)
    }

    /// Writes a key beside those of the sector of the newest record; whether that went well.
    pub fn write_key<F: NorFlash>(&self, flash: &mut F, key: &PublicKey, rights: Rights) -> bool {
        self.current.is_some_and(|sector| keys::write(flash, sector, key, rights))
    }
    /// Writes beside them that a key is taken back; whether that went well.
    pub fn write_revoked<F: NorFlash>(&self, flash: &mut F, key: KeyId) -> bool {
        self.current.is_some_and(|sector| keys::write_revoked(flash, sector, key))
    }
    /// Raises a counter in the sector of the newest record; whether that went well.
    pub fn raise<F: NorFlash>(&self, flash: &mut F, to: &Counted) -> bool {
        self.current.is_some_and(|sector| counters::raise(flash, sector, to))
    }
    /// Writes an entry of the log in the sector of the newest record; whether that went well.
    pub fn log<F: NorFlash>(&self, flash: &mut F, entry: &LogEntry) -> bool {
        self.current.is_some_and(|sector| log::write(flash, sector, entry))
    }
    /// The entries of the log, oldest first.
    pub fn logged<F: NorFlash>(&self, flash: &mut F) -> impl Iterator<Item = LogEntry> {
        self.current.into_iter().flat_map(log::pairs).filter_map(move |at| log::read(flash, at))
    }
    /// Lets the next record begin the other sector.
    pub fn leave_sector(&mut self) {
        self.next = None;
    }

    /// Erases the sector that does not hold the newest record, and writes keys, counters and log there; slow, once in [`PLACES`]
    /// records.
    fn begin_sector<F: NorFlash>(&mut self, flash: &mut F, keys: &KeyRing) -> Result<Place, JournalFailed> {
        let sector = self.current.map_or(0, |current| 1 - current);
        let start = sector_start(LEDGER_SECTORS.first + sector);
        flash.erase(start, start + SECTOR_BYTES as u32).map_err(|_| JournalFailed)?;
        let written = keys::write_all(flash, sector, keys)
            && self
                .current
                .is_none_or(|current| counters::copy(flash, current, sector) && log::copy(flash, current, sector));
        if written { Ok(Place { sector, index: 0 }) } else { Err(JournalFailed) }
    }
}

fn read_head<F: NorFlash>(flash: &mut F, place: Place) -> Option<Head> {
    Word::read(flash, place.offset()).written().as_ref().and_then(Head::decode)
}

fn read_payload<F: NorFlash>(flash: &mut F, place: Place, head: Head, payload: &mut [u8; PAYLOAD_BYTES]) -> bool {
    let payload = &mut payload[..head.length];
    flash.read(place.offset() + WORD_BYTES as u32, payload).is_ok() && crc32(payload) == head.crc
}

fn is_blank<F: NorFlash>(flash: &mut F, place: Place) -> bool {
    (0..PLACE_BYTES).step_by(WORD_BYTES).all(|at| Word::read(flash, place.offset() + at as u32).is_blank())
}

/// Payload, then head, then the proof that both can be read.
fn program<F: NorFlash>(flash: &mut F, place: Place, head: Head, payload: &[u8]) -> bool {
    let body = place.offset() + WORD_BYTES as u32;
    for (piece, at) in payload.chunks(WORD_BYTES).zip((body..).step_by(WORD_BYTES)) {
        let mut word = [0; WORD_BYTES];
        word[..piece.len()].copy_from_slice(piece);
        // A word of ones reads the same unprogrammed.
        if word != BLANK && flash.write(at, &word).is_err() {
            return false;
        }
    }
    let mut back = [0; PAYLOAD_BYTES];
    flash.write(place.offset(), &head.encode()).is_ok()
        && read_head(flash, place).is_some_and(|found| found.sequence == head.sequence && found.crc == head.crc)
        && read_payload(flash, place, head, &mut back)
}
