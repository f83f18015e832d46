//! Whose images are taken: the keys of a file, and the counters of signed images that were in use.
//!
//! A device has write-once places for both; here the file of keys belongs to who may install it, and the counters lie in
//! the ledger.

use serde::{Deserialize, Serialize};
use truepath_core::image::{Counted, KeyRing, PublicKey};

/// Passes of programs of which a counter is known: a device knows as many.
pub const MOST_COUNTED: usize = 64;
/// In a file of keys without one.
pub const NO_KEY: u32 = u32::MAX;

/// The keys of a file of `truepath key`: lines of `ed25519` and 64 hexadecimal digits, empty ones, and those that begin
/// with `#`.
///
/// # Errors
/// The number of the first line that is none of these, or whose key cannot be used or has no room; [`NO_KEY`].
pub(super) fn keys(file: &[u8]) -> Result<KeyRing, u32> {
    let mut ring = KeyRing::default();
    let mut number = 0u32;
    for line in file.split(|&byte| byte == b'\n') {
        number = number.saturating_add(1);
        let line = line.trim_ascii();
        if line.is_empty() || line.starts_with(b"#") {
            continue;
        }
        let key =
            line.strip_prefix(b"ed25519").filter(|digits| digits.starts_with(b" ")).and_then(key).ok_or(number)?;
        ring.add(key).map_err(|_| number)?;
    }
    if ring.is_open() { Err(NO_KEY) } else { Ok(ring) }
}

fn key(digits: &[u8]) -> Option<PublicKey> {
    let (pairs, odd) = digits.trim_ascii().as_chunks::<2>();
    let mut key = [0; 32];
    if pairs.len() != key.len() || !odd.is_empty() {
        return None;
    }
    for (byte, [high, low]) in key.iter_mut().zip(pairs) {
        let value = |digit: u8| char::from(digit).to_digit(16);
        *byte = (value(*high)? << 4 | value(*low)?) as u8;
    }
    Some(PublicKey(key))
}

/// The counters that were in use. Of more than [`MOST_COUNTED`] passes the lowest becomes that of every pass: what is not
/// known any more can only be signed anew, never go back.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub(super) struct Counters {
    #[serde(with = "postcard::fixint::le")]
    every: u32,
    known: [[Option<Counted>; MOST_COUNTED / 2]; 2],
}

impl Counters {
    fn iter_mut(&mut self) -> impl Iterator<Item = &mut Option<Counted>> {
        self.known.iter_mut().flatten()
    }
    /// The least counter of an image of this pass that is taken.
    pub fn least(&self, of: &Counted) -> u32 {
        let own = self.known.iter().flatten().flatten().find(|known| known.is_same_pass(of));
        own.map_or(0, |own| own.counter).max(self.every)
    }
    /// Raises the counter of a pass: then [`Counters::least`] is that counter or more.
    pub fn raise(&mut self, to: Counted) {
        if self.least(&to) >= to.counter {
            return;
        }
        let is_own = |known: &Option<Counted>| known.is_some_and(|known| known.is_same_pass(&to));
        let is_known = self.iter_mut().any(|known| is_own(known));
        if !is_known && self.iter_mut().all(|known| known.is_some()) {
            let lowest = self.known.iter().flatten().flatten().map(|known| known.counter).min().unwrap_or(0);
            self.every = lowest.min(to.counter);
        }
        let every = self.every;
        let mut place = None;
        for known in self.iter_mut() {
            // What counts for every pass is not kept for one.
            *known = known.filter(|known| known.counter > every);
            if is_own(known) || place.is_none() && known.is_none() {
                place = Some(known);
            }
        }
        if let Some(place) = place.filter(|_| to.counter > every) {
            *place = Some(to);
        }
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::arithmetic_side_effects)]
    extern crate std;
    use super::*;
    use std::format;

    fn of(feature: u32, counter: u32) -> Counted {
        Counted { program_crc: 1, feature, pass: 1, counter }
    }

    #[test]
    fn counters_never_go_back_however_many_passes_there_are() {
        let mut counters = Counters::default();
        for feature in 0..64 {
            counters.raise(of(feature, 1_000 + feature));
        }
        counters.raise(of(3, 5));
        assert_eq!((counters.least(&of(3, 0)), counters.least(&of(99, 0))), (1_003, 0));
        counters.raise(of(99, 7));
        assert_eq!((counters.least(&of(99, 0)), counters.least(&of(98, 0))), (7, 7), "the lowest of all");
        counters.raise(of(99, 5_000));
        assert_eq!((counters.least(&of(99, 0)), counters.least(&of(98, 0))), (5_000, 1_000));
        counters.raise(of(63, 6_000));
        for feature in 0..63 {
            assert_eq!(counters.least(&of(feature, 0)), 1_000 + feature);
        }
        assert_eq!(counters.least(&of(63, 0)), 6_000);
    }

    #[test]
    fn a_file_of_keys_is_read_or_its_wrong_line_named() {
        // The base point, a sound key.
        let good = "5866666666666666666666666666666666666666666666666666666666666666";
        let ring = keys(format!("# of the shop\n\n  ed25519 {good}\r\n").as_bytes()).unwrap();
        assert_eq!(ring.iter().count(), 1);
        for (file, line) in [
            (format!("# a\ned25519 {}\n", &good[2..]), 2),
            (format!("ed25519 {good}\ned25519-seed {good}\n"), 2),
            (format!("ed25519{good}"), 1),
            (format!("ed25519 {}", "00".repeat(32)), 1),
            ("# nothing\n\n".into(), NO_KEY),
            ("".into(), NO_KEY),
        ] {
            assert_eq!(keys(file.as_bytes()), Err(line), "{file}");
        }
    }
}
