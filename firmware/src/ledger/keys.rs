//! The page of keys: the last place of each sector of the ledger, write-once. It has places of two words.
//!
//! A key takes two words: the 32 bytes of the public key, then its seal ([`sealed`], `TPK1`: CRC-32 of the key, its rights
//! ([`Rights::bits`]: 0, as before there were rights, is everything), zeros). The
//! seal is programmed last; a key without it is none, and its two words are passed over. A key is taken back by a further
//! place, of which only the first word is programmed (`TPR1`: number of the key in two fields, zeros); both words count
//! wherever they lie. Nothing here is ever programmed twice: when the journal begins a sector it erases, it writes all keys
//! there, and all that were taken back, before the first record. So the sector with the newest record, which is never
//! erased, holds all of them, whatever the power does.
//!
//! Keys are not in the records: those have no room for them, and a firmware that cannot read a record of another version
//! still finds the keys.

use embedded_storage::nor_flash::NorFlash;
use truepath_core::image::{KeyId, KeyRing, PublicKey, Rights, crc32};

use super::place::{ALL_PLACES, PLACE_BYTES};
use crate::flash::{BLANK, LEDGER_SECTORS, WORD_BYTES, Word, opened, sealed, sector_start};

const MAGIC: [u8; 4] = *b"TPK1";
const REVOKED: [u8; 4] = *b"TPR1";
/// Bytes of a key and its seal.
const PAIR_BYTES: usize = 2 * WORD_BYTES;

/// Where the pairs of a sector of the ledger lie.
fn pairs(sector: usize) -> impl Iterator<Item = u32> {
    let page = sector_start(LEDGER_SECTORS.first + sector) + ((ALL_PLACES - 1) * PLACE_BYTES) as u32;
    (page..page + PLACE_BYTES as u32).step_by(PAIR_BYTES)
}

fn seal(key: &PublicKey, rights: Rights) -> [u8; WORD_BYTES] {
    sealed(MAGIC, [crc32(&key.0), rights.bits(), 0, 0, 0, 0])
}

fn revocation(KeyId([a, b, c, d, e, f, g, h]): KeyId) -> [u8; WORD_BYTES] {
    sealed(REVOKED, [u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h]), 0, 0, 0, 0])
}

/// The keys of both sectors. What was taken back first: a key may still stand where it was written.
pub(super) fn read<F: NorFlash>(flash: &mut F) -> KeyRing {
    let mut ring = KeyRing::default();
    for at in (0..LEDGER_SECTORS.count).flat_map(pairs) {
        let Some(word) = Word::read(flash, at).written() else { continue };
        let key = KeyId(word[4..].first_chunk().copied().unwrap_or_default());
        if word == revocation(key) {
            // There is room for all that a device has known.
            let _ = ring.revoke(key);
        }
    }
    for at in (0..LEDGER_SECTORS.count).flat_map(pairs) {
        let Some(key) = Word::read(flash, at).written().map(PublicKey) else { continue };
        let seal = Word::read(flash, at + WORD_BYTES as u32).written().and_then(|word| opened(MAGIC, &word));
        if let Some([crc, rights, ..]) = seal
            && crc == crc32(&key.0)
        {
            // One that is in both sectors counts once. What was sealed had passed the check, and may be revoked.
            let _ = ring.add_with(key, Rights::of(rights));
        }
    }
    ring
}

/// Writes a key behind those of a sector and reads it back; whether that went well.
pub(super) fn write<F: NorFlash>(flash: &mut F, sector: usize, key: &PublicKey, rights: Rights) -> bool {
    key.0 != BLANK && write_pair(flash, sector, &[key.0, seal(key, rights)])
}

/// Writes that a key is taken back, and reads it back.
pub(super) fn write_revoked<F: NorFlash>(flash: &mut F, sector: usize, key: KeyId) -> bool {
    write_pair(flash, sector, &[revocation(key)])
}

/// The first words of the first place that nothing was written to.
fn write_pair<F: NorFlash>(flash: &mut F, sector: usize, words: &[[u8; WORD_BYTES]]) -> bool {
    let blank =
        |flash: &mut F, at: u32| [at, at + WORD_BYTES as u32].into_iter().all(|at| Word::read(flash, at).is_blank());
    let Some(first) = pairs(sector).find(|&at| blank(flash, at)) else { return false };
    words
        .iter()
        .zip((first..).step_by(WORD_BYTES))
        .all(|(word, at)| flash.write(at, word).is_ok() && Word::read(flash, at) == Word::Written(*word))
}

/// Writes all of a ring into a sector that was erased.
pub(super) fn write_all<F: NorFlash>(flash: &mut F, sector: usize, ring: &KeyRing) -> bool {
    let known = |key: &PublicKey| ring.find(key.id()).is_some_and(|(key, rights)| write(flash, sector, key, rights));
    ring.iter().all(known) && ring.revoked().all(|key| write_revoked(flash, sector, key))
}
