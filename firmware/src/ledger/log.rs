//! The log of changes: the places of each sector of the ledger between its records and the counters, two words for each
//! entry.
//!
//! The first word of an entry is its seal ([`sealed`], `TPE1`): sequence; boots; change, what is there of `by`, `key` and
//! the host's time (bits 8 to 10), failed logins (bits 16 to 31); the host's time; value; CRC-32 of the second word. The second word: 0 microseconds
//! since the reset, 8 `by`, 16 `key`, 24 counter, 28 zeros. The seal is programmed last; an entry without it is none.
//!
//! An entry is written before what it tells of happens, so there is no change without one; a change that the power or the
//! flash cut off has one all the same. When the journal begins a sector it erases, the newest [`MOST_LOGGED`] are written there before the
//! first record, in their order: what is behind one of them in a sector is newer.
//!
//! What happens where the flash may not be written waits in RAM, up to [`MOST_WAITING`] entries, and is lost with a reset. One
//! more is dropped; its number is missing then.

use embedded_storage::nor_flash::NorFlash;
use heapless::Deque;
use truepath_core::image::{KeyId, crc32};
use truepath_core::link::{Change, LogEntry};

use super::place::{LOG_PLACES, PLACE_BYTES, PLACES};
use crate::flash::{LEDGER_SECTORS, WORD_BYTES, Word, opened, sealed, sector_start};

/// Entries that are kept at least, once there were as many.
pub const MOST_LOGGED: usize = 64;
/// Entries that wait in RAM at most.
pub const MOST_WAITING: usize = 8;
const MAGIC: [u8; 4] = *b"TPE1";
const PAIR_BYTES: usize = 2 * WORD_BYTES;

// Behind those that are kept is room for one entry for each record: with no more of them, the log wears the sectors no faster.
const _: () = assert!(LOG_PLACES * PLACE_BYTES / PAIR_BYTES >= MOST_LOGGED + PLACES);

/// What of the log is not in the flash.
#[derive(Clone, Debug)]
pub(super) struct Log {
    /// Number of the next entry.
    pub next: u32,
    /// Oldest first.
    pub waiting: Deque<LogEntry, MOST_WAITING>,
}

impl Log {
    pub fn behind(newest: Option<LogEntry>) -> Self {
        Self { next: newest.map_or(1, |entry| entry.sequence.saturating_add(1)), waiting: Deque::new() }
    }
    /// Gives an entry its number and lets it wait.
    pub fn keep(&mut self, entry: LogEntry) {
        // One that has no room leaves a gap in the numbers.
        let _ = self.waiting.push_back(LogEntry { sequence: self.next, ..entry });
        self.next = self.next.saturating_add(1);
    }
}

/// Where the entries of a sector lie.
pub(super) fn pairs(sector: usize) -> impl DoubleEndedIterator<Item = u32> {
    let page = sector_start(LEDGER_SECTORS.first + sector) + (PLACES * PLACE_BYTES) as u32;
    (page..page + (LOG_PLACES * PLACE_BYTES) as u32).step_by(PAIR_BYTES)
}

fn encode(entry: &LogEntry) -> [[u8; WORD_BYTES]; 2] {
    let mut word = [0; WORD_BYTES];
    let id = |key: Option<KeyId>| key.unwrap_or(KeyId([0; 8])).0;
    let (fields, _) = word.as_chunks_mut::<8>();
    for (place, field) in fields.iter_mut().zip([entry.uptime_us.to_le_bytes(), id(entry.by), id(entry.key)]) {
        *place = field;
    }
    word[24..28].copy_from_slice(&entry.counter.to_le_bytes());
    let there = [entry.by.is_some(), entry.key.is_some(), entry.host_s.is_some()];
    let there = (8..).zip(there).fold(0, |bits, (bit, is)| bits | u32::from(is) << bit);
    let what = u32::from(entry.change.number()) | there | u32::from(entry.refused) << 16;
    let fields = [entry.sequence, entry.boots, what, entry.host_s.unwrap_or(0), entry.value, crc32(&word)];
    [sealed(MAGIC, fields), word]
}

/// The entry at a place.
pub(super) fn read<F: NorFlash>(flash: &mut F, at: u32) -> Option<LogEntry> {
    let [sequence, boots, what, host_s, value, crc] = opened(MAGIC, &Word::read(flash, at).written()?)?;
    let word = Word::read(flash, at + WORD_BYTES as u32).written().filter(|word| crc32(word) == crc)?;
    let ([uptime_us, by, key, last], _) = word.as_chunks::<8>() else { return None };
    let there = |bit: u32| what >> bit & 1 != 0;
    let [counter, ..] = *last.as_chunks::<4>().0 else { return None };
    Some(LogEntry {
        sequence,
        boots,
        uptime_us: u64::from_le_bytes(*uptime_us),
        host_s: there(10).then_some(host_s),
        by: there(8).then_some(KeyId(*by)),
        change: Change::of(what as u8)?,
        key: there(9).then_some(KeyId(*key)),
        value,
        refused: (what >> 16) as u16,
        counter: u32::from_le_bytes(counter),
    })
}

/// Writes an entry behind those of a sector and reads it back; whether that went well.
pub(super) fn write<F: NorFlash>(flash: &mut F, sector: usize, entry: &LogEntry) -> bool {
    let blank =
        |flash: &mut F, at: u32| [at, at + WORD_BYTES as u32].into_iter().all(|at| Word::read(flash, at).is_blank());
    let last = pairs(sector).rev().find(|&at| !blank(flash, at));
    pairs(sector).find(|&at| last.is_none_or(|last| at > last)).is_some_and(|at| write_at(flash, at, entry))
}

fn write_at<F: NorFlash>(flash: &mut F, at: u32, entry: &LogEntry) -> bool {
    let [seal, word] = encode(entry);
    flash.write(at + WORD_BYTES as u32, &word).is_ok()
        && flash.write(at, &seal).is_ok()
        && read(flash, at).as_ref() == Some(entry)
}

/// Writes the newest entries of a sector into the other one, which was erased; whether that went well.
pub(super) fn copy<F: NorFlash>(flash: &mut F, from: usize, to: usize) -> bool {
    let there = pairs(from).filter(|&at| read(flash, at).is_some()).count();
    let mut places = pairs(to);
    let mut passed = 0;
    pairs(from).all(|at| {
        let Some(entry) = read(flash, at) else { return true };
        passed += 1;
        passed + MOST_LOGGED <= there || places.next().is_some_and(|at| write_at(flash, at, &entry))
    })
}
