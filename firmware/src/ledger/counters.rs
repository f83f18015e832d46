//! The page of counters: the places of each sector of the ledger behind its records, one word for each counter that was
//! raised.
//!
//! Fields of the word ([`sealed`], `TPV1`): program, feature, pass, zeros if it counts for every pass; the counter below which
//! no image is taken, of the pass or of every pass; 0 for one pass, 1 for every pass; 0.
//!
//! A word is whole or it is none, and what counts is the greatest number: so every word that is programmed raises what is
//! permitted from one value to the next, whatever the power does, and no order of words matters. When the journal begins
//! a sector it erases, what still counts is written there before the first record, as the keys are.
//!
//! The counters of [`MOST_COUNTED`] passes are known each for itself. When another one comes, the lowest of all becomes
//! that of every pass, and its own is forgotten: what is not known any more can only be signed anew, never go back.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::Counted;

use super::place::{COUNTER_PLACES, FIRST_COUNTER_PLACE, PLACE_BYTES};
use crate::flash::{LEDGER_SECTORS, WORD_BYTES, Word, opened, sealed, sector_start};

/// Passes of programs of which a counter is known.
pub const MOST_COUNTED: usize = 64;
const MAGIC: [u8; 4] = *b"TPV1";
/// Words of the page.
const WORDS: u32 = (COUNTER_PLACES * PLACE_BYTES / WORD_BYTES) as u32;

// All that counts, the counter of every pass, and what is raised next.
const _: () = assert!(MOST_COUNTED + 3 <= WORDS as usize);

/// A word.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Entry {
    Pass(Counted),
    Every(u32),
}

impl Entry {
    fn encode(self) -> [u8; WORD_BYTES] {
        let fields = match self {
            Self::Pass(of) => [of.program_crc, of.feature, of.pass, of.counter, 0, 0],
            Self::Every(counter) => [0, 0, 0, counter, 1, 0],
        };
        sealed(MAGIC, fields)
    }
    fn decode(word: &[u8; WORD_BYTES]) -> Option<Self> {
        let [program_crc, feature, pass, counter, every, _] = opened(MAGIC, word)?;
        Some(match every {
            0 => Self::Pass(Counted { program_crc, feature, pass, counter }),
            _ => Self::Every(counter),
        })
    }
    /// The least counter that it leaves to a pass.
    fn least(&self, of: &Counted) -> u32 {
        match self {
            Self::Pass(counted) if counted.is_same_pass(of) => counted.counter,
            Self::Pass(_) => 0,
            Self::Every(counter) => *counter,
        }
    }
}

fn at(sector: usize, word: u32) -> u32 {
    sector_start(LEDGER_SECTORS.first + sector) + (FIRST_COUNTER_PLACE * PLACE_BYTES) as u32 + word * WORD_BYTES as u32
}

fn read<F: NorFlash>(flash: &mut F, sector: usize, word: u32) -> Option<Entry> {
    Word::read(flash, at(sector, word)).written().as_ref().and_then(Entry::decode)
}

/// The least counter of an image of this pass that is taken; of [`Counted::counter`] nothing matters here.
pub(super) fn least<F: NorFlash>(flash: &mut F, of: &Counted) -> u32 {
    let mut least = 0;
    for sector in 0..LEDGER_SECTORS.count {
        for word in 0..WORDS {
            least = least.max(read(flash, sector, word).map_or(0, |entry| entry.least(of)));
        }
    }
    least
}

/// The counter of every pass.
fn every<F: NorFlash>(flash: &mut F, sector: usize) -> u32 {
    let of_every = |entry| if let Some(Entry::Every(counter)) = entry { counter } else { 0 };
    (0..WORDS).map(|word| of_every(read(flash, sector, word))).max().unwrap_or(0)
}

/// Shows each counter of a pass that still counts, until that says false; whether it never did. Reads the page once for
/// each word of it at most.
fn each<F: NorFlash>(flash: &mut F, sector: usize, mut show: impl FnMut(&mut F, Counted) -> bool) -> bool {
    let every = every(flash, sector);
    (0..WORDS).all(|word| {
        let Some(Entry::Pass(counted)) = read(flash, sector, word) else { return true };
        // A pass is only ever raised.
        let later = |entry| matches!(entry, Some(Entry::Pass(later)) if later.is_same_pass(&counted));
        let counts = counted.counter > every && !(word + 1..WORDS).any(|word| later(read(flash, sector, word)));
        !counts || show(flash, counted)
    })
}

/// Raises the counter of a pass in a sector; whether that went well. Then [`least`] is that counter or more.
pub(super) fn raise<F: NorFlash>(flash: &mut F, sector: usize, to: &Counted) -> bool {
    if least(flash, to) >= to.counter {
        return true;
    }
    let (mut known, mut lowest, mut is_known) = (0, to.counter, false);
    each(flash, sector, |_, counted| {
        known += 1;
        lowest = lowest.min(counted.counter);
        is_known |= counted.is_same_pass(to);
        true
    });
    if known >= MOST_COUNTED && !is_known {
        if !write(flash, sector, Entry::Every(lowest)) {
            return false;
        }
        if lowest == to.counter {
            return true;
        }
    }
    write(flash, sector, Entry::Pass(*to))
}

/// Writes what counts in a sector into the other one, which was erased; whether that went well.
pub(super) fn copy<F: NorFlash>(flash: &mut F, from: usize, to: usize) -> bool {
    let every = every(flash, from);
    (every == 0 || write(flash, to, Entry::Every(every)))
        && each(flash, from, |flash, counted| write(flash, to, Entry::Pass(counted)))
}

fn write<F: NorFlash>(flash: &mut F, sector: usize, entry: Entry) -> bool {
    let blank = (0..WORDS).map(|word| at(sector, word)).find(|&at| Word::read(flash, at).is_blank());
    let Some(at) = blank else { return false };
    let word = entry.encode();
    flash.write(at, &word).is_ok() && Word::read(flash, at) == Word::Written(word)
}
