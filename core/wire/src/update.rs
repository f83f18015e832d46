//! A firmware update: its signed head, and why one is not taken.
//!
//! An update is a head of [`UPDATE_HEAD_BYTES`] and the program behind it, as it lies in the flash. Little endian:
//!
//! | offset | bytes | |
//! |---:|---:|---|
//! | 0 | 4 | `TPFW` |
//! | 4 | 4 | format, 1 |
//! | 8 | 4 | length of the program, bytes |
//! | 12 | 4 | counter: the time of the signing, seconds since 1970; none below that of a confirmed one is taken |
//! | 16 | 16 | name of the board, as in `Hello`, behind it zeros |
//! | 32 | 16 | version of the program, behind it zeros |
//! | 48 | 8 | number of the key |
//! | 56 | 8 | zeros |
//! | 64 | 64 | SHA-512 of the program |
//! | 128 | 64 | Ed25519 signature of the 128 bytes before |
//!
//! The head alone is signed, so it is known to be good before anything is erased for the program; the digest binds the
//! program to it. No image and no login begins with its first bytes, so a signature of one is none of another.

use core::fmt;

use serde::{Deserialize, Serialize};
use truepath_units::errors;

use crate::image::{KeyId, KeyRing};

/// Bytes of the head.
pub const UPDATE_HEAD_BYTES: usize = 192;
/// Bytes of the digest of the program, and of the signature.
pub const UPDATE_DIGEST_BYTES: usize = 64;
const SIGNED_BYTES: usize = UPDATE_HEAD_BYTES.wrapping_sub(UPDATE_DIGEST_BYTES);
const MAGIC: [u8; 4] = *b"TPFW";
const FORMAT: u32 = 1;
const LABEL_BYTES: usize = 16;

/// A name of 1 to 16 printable ASCII characters.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Label([u8; LABEL_BYTES]);

impl Label {
    /// A name; none of one that is empty, too long or not ASCII.
    pub fn of(name: &str) -> Option<Self> {
        let mut bytes = [0; LABEL_BYTES];
        bytes.get_mut(..name.len())?.copy_from_slice(name.as_bytes());
        Self::of_bytes(bytes)
    }
    fn of_bytes(bytes: [u8; LABEL_BYTES]) -> Option<Self> {
        let label = Self(bytes);
        let (name, rest) = bytes.split_at_checked(label.text().len())?;
        (!name.is_empty() && name.iter().all(u8::is_ascii_graphic) && rest.iter().all(|&byte| byte == 0))
            .then_some(label)
    }
    /// Its characters; none of what is no name.
    pub fn text(&self) -> &str {
        let name = self.0.split(|&byte| byte == 0).next().unwrap_or_default();
        core::str::from_utf8(name).unwrap_or_default()
    }
}

impl fmt::Display for Label {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.text())
    }
}

errors! {
    /// Why an update is not taken. The sentence of each variant is the text shown.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum UpdateError {
        /// The bytes are no head of an update.
        Format = "K120", "this is no firmware update of a format known here"
            => "send a file that truepath firmware sign wrote";
        /// Its key may not sign firmware here.
        UnknownKey {
            /// Number of the key in the head.
            key: KeyId,
        } = "K121", "the update is signed with key {key}, which is not provisioned here for firmware"
            => "sign it with a key that is, or provision this one with truepath device provision --firmware, at the device";
        /// The signature is not one of these bytes by this key.
        Forged {
            /// Number of the key in the head.
            key: KeyId,
        } = "K122", "the signature does not belong to key {key}: the update was changed, or signed by somebody else"
            => "do not use it, and find out where it came from";
        /// The key is trusted no more.
        Revoked {
            /// Its number.
            key: KeyId,
        } = "K123", "key {key} was revoked here, and signs nothing any more"
            => "sign with another key, and find out what else this one has signed";
        /// It is for another board.
        OtherBoard {
            /// What it is for.
            found: Label,
            /// What this is.
            expected: Label,
        } = "K124", "the update is for the board {found}, this is {expected}"
            => "send the update of this board";
        /// One that was signed later was confirmed.
        RolledBack {
            /// Its counter.
            found: u32,
            /// The least that is taken.
            least: u32,
        } = "K125", "the update has counter {found}, and a later one was in use: less than {least} is not taken"
            => "use the latest one; to go back on purpose, sign the older program again";
        /// It has no place.
        Length {
            /// Bytes of its program.
            length: u32,
            /// Most there is room for.
            most: u32,
        } = "K126", "the program of the update has {length} bytes, the board has room for 1 to {most}"
            => "build it smaller";
        /// The program is not the one that was signed.
        Digest = "K127", "the program that was read back is not the one that was signed"
            => "send the update again; if it happens again, the file or the flash is damaged";
        /// Nothing was uploaded.
        Nothing = "K128", "no whole update is there to be installed"
            => "send it again: truepath device update";
        /// The slots of the images belong to the loader.
        Pending = "K129", "an update waits for its start or for its confirmation: until then there is no room for images"
            => "confirm the update with truepath device update --confirm, or restart the device to go back to the program before";
        /// Nothing could start another program.
        NoLoader = "K130", "no loader starts the program of this device: it is replaced through the debug port"
            => "flash the loader and the program (docs/bringup.md)";
    }
}

impl core::error::Error for UpdateError {}

/// What the head of an update says.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct UpdateHead {
    /// Bytes of the program.
    pub length: u32,
    /// Rises from one signing to the next: the time of the signing, seconds since 1970.
    pub counter: u32,
    /// The board it is for.
    pub board: Label,
    /// Version of the program.
    pub version: Label,
    /// Number of the key it is signed with.
    pub key: KeyId,
    /// SHA-512 of the program.
    pub digest: [u8; UPDATE_DIGEST_BYTES],
}

impl UpdateHead {
    /// Reads a head; none of other bytes. Nothing is verified.
    pub fn read(bytes: &[u8; UPDATE_HEAD_BYTES]) -> Option<Self> {
        let (fields, rest) = bytes.split_first_chunk::<UPDATE_DIGEST_BYTES>()?;
        let digest = *rest.first_chunk()?;
        let &[magic, format, length, counter, ref rest @ ..] = fields.as_chunks::<4>().0 else { return None };
        let &[board, version, last] = rest.as_flattened().as_chunks::<LABEL_BYTES>().0 else { return None };
        let (key, zeros) = last.split_first_chunk()?;
        let known = magic == MAGIC && u32::from_le_bytes(format) == FORMAT && zeros.iter().all(|&byte| byte == 0);
        Some(Self {
            length: u32::from_le_bytes(length),
            counter: u32::from_le_bytes(counter),
            board: Label::of_bytes(board)?,
            version: Label::of_bytes(version)?,
            key: KeyId(*key),
            digest,
        })
        .filter(|_| known)
    }

    /// Its bytes; `sign` makes the signature of the key's owner.
    pub fn signed(&self, sign: impl FnOnce(&[u8]) -> [u8; UPDATE_DIGEST_BYTES]) -> [u8; UPDATE_HEAD_BYTES] {
        let mut bytes = [0; UPDATE_HEAD_BYTES];
        let words = [u32::from_le_bytes(MAGIC), FORMAT, self.length, self.counter].map(u32::to_le_bytes);
        let fields = words.as_flattened().iter().chain(&self.board.0).chain(&self.version.0).chain(&self.key.0);
        for (place, byte) in bytes.iter_mut().zip(fields.chain(&[0; 8]).chain(&self.digest)) {
            *place = *byte;
        }
        if let Some((message, signature)) = bytes.split_first_chunk_mut::<SIGNED_BYTES>() {
            signature.copy_from_slice(&sign(message));
        }
        bytes
    }

    /// Reads a head that one of the keys signed for a board; of a program of at most `most` bytes.
    ///
    /// # Errors
    /// An [`UpdateError`], whatever the bytes are.
    #[inline(never)]
    pub fn verified(
        bytes: &[u8; UPDATE_HEAD_BYTES],
        keys: &KeyRing,
        board: Label,
        most: u32,
    ) -> Result<Self, UpdateError> {
        let head = Self::read(bytes).ok_or(UpdateError::Format)?;
        let key = head.key;
        let unknown = if keys.is_revoked(key) { UpdateError::Revoked { key } } else { UpdateError::UnknownKey { key } };
        let (trusted, _) = keys.find(key).filter(|(_, rights)| rights.firmware).ok_or(unknown)?;
        let (message, signature) = bytes.split_first_chunk::<SIGNED_BYTES>().ok_or(UpdateError::Format)?;
        if !signature.first_chunk().is_some_and(|signature| trusted.signed(message, signature)) {
            return Err(UpdateError::Forged { key });
        }
        // Behind the signature, so that what is said of board and length is what the signer said.
        if head.board != board {
            return Err(UpdateError::OtherBoard { found: head.board, expected: board });
        }
        if head.length == 0 || head.length > most {
            return Err(UpdateError::Length { length: head.length, most });
        }
        Ok(head)
    }

    /// The program in one number: the first bytes of its digest.
    pub fn name(&self) -> u32 {
        self.digest.first_chunk().map_or(0, |bytes| u32::from_le_bytes(*bytes))
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::indexing_slicing, clippy::unwrap_used)]
    use super::*;

    #[test]
    fn a_head_comes_back_from_its_bytes_and_a_change_of_any_byte_before_the_signature_is_seen_or_changes_a_field() {
        let head = UpdateHead {
            length: 600_000,
            counter: 1_700_000_000,
            board: Label::of("nucleo-h743zi2").unwrap(),
            version: Label::of("0.2.0").unwrap(),
            key: KeyId([7; 8]),
            digest: core::array::from_fn(|at| at as u8),
        };
        let bytes = head.signed(|message| {
            assert_eq!(message.len(), SIGNED_BYTES);
            [0x5A; 64]
        });
        assert_eq!(UpdateHead::read(&bytes), Some(head));
        assert_eq!(bytes[SIGNED_BYTES..], [0x5A; 64]);
        for at in 0..SIGNED_BYTES {
            let mut changed = bytes;
            changed[at] ^= 1;
            assert_ne!(UpdateHead::read(&changed), Some(head), "byte {at}");
        }
        assert_eq!(UpdateHead::read(&[0xFF; UPDATE_HEAD_BYTES]), None);
    }

    #[test]
    fn a_label_is_printable_and_not_longer_than_its_place() {
        for name in ["", "seventeen letters", "a b", "a\0b", "ä", "tab\t"] {
            assert_eq!(Label::of(name), None, "{name:?}");
        }
        assert_eq!(Label::of("sixteen-letters!").unwrap().text(), "sixteen-letters!");
        assert_eq!(Label::default().text(), "");
    }
}
