//! The page of keys: the last place of each sector of the ledger, write-once.
//!
//! A key takes two words: the 32 bytes of the public key, then its seal (0 magic `TPK1`, 4 CRC-32 of the key, 8 zeros,
//! 28 CRC-32 of the 28 bytes before). The seal is programmed last; a key without it is none, and its two words are
//! passed over. Nothing here is ever programmed twice, and no key is taken away: when the journal begins a sector it
//! erases, it writes all keys there before the first record. So the sector with the newest record, which is never erased,
//! holds all of them, whatever the power does.
//!
//! Keys are not in the records: those have no room for them, and a firmware that cannot read a record of another version
//! still finds the keys.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{KeyRing, PublicKey, crc32};

use super::place::{PLACE_BYTES, PLACES};
use crate::flash::{BLANK, LEDGER_SECTORS, WORD_BYTES, Word, sector_start};

const MAGIC: [u8; 4] = *b"TPK1";
/// Bytes of a key and its seal.
const PAIR_BYTES: usize = 2 * WORD_BYTES;

/// Where the pairs of a sector of the ledger lie.
fn pairs(sector: usize) -> impl Iterator<Item = u32> {
    let page = sector_start(LEDGER_SECTORS.first + sector) + (PLACES * PLACE_BYTES) as u32;
    (page..page + PLACE_BYTES as u32).step_by(PAIR_BYTES)
}

fn seal(key: &PublicKey) -> [u8; WORD_BYTES] {
    let mut word = [0; WORD_BYTES];
    word[..4].copy_from_slice(&MAGIC);
    word[4..8].copy_from_slice(&crc32(&key.0).to_le_bytes());
    let sum = crc32(&word[..WORD_BYTES - 4]);
    word[WORD_BYTES - 4..].copy_from_slice(&sum.to_le_bytes());
    word
}

/// The keys of both sectors.
pub(super) fn read<F: NorFlash>(flash: &mut F) -> KeyRing {
    let mut ring = KeyRing::default();
    for at in (0..LEDGER_SECTORS.count).flat_map(pairs) {
        let Some(key) = Word::read(flash, at).written().map(PublicKey) else { continue };
        if Word::read(flash, at + WORD_BYTES as u32) == Word::Written(seal(&key)) {
            // One that is in both sectors counts once. What was sealed had passed the check.
            let _ = ring.add(key);
        }
    }
    ring
}

/// Writes a key behind those of a sector and reads it back; whether that went well.
pub(super) fn write<F: NorFlash>(flash: &mut F, sector: usize, key: &PublicKey) -> bool {
    let seal_at = |at: u32| at + WORD_BYTES as u32;
    let blank = |flash: &mut F, at| Word::read(flash, at).is_blank() && Word::read(flash, seal_at(at)).is_blank();
    let Some(at) = pairs(sector).find(|&at| blank(flash, at)).filter(|_| key.0 != BLANK) else { return false };
    [(at, key.0), (seal_at(at), seal(key))]
        .iter()
        .all(|(at, word)| flash.write(*at, word).is_ok() && Word::read(flash, *at) == Word::Written(*word))
}
