//! The block of the signature in an image: what it names and where it lies.
//!
//! A signed image has [`SIGNED_FORMAT`] in its head and a block of [`SIGNATURE_BYTES`] between its nodes and its CRC-32:
//!
//! | offset | bytes | |
//! |---:|---:|---|
//! | 0 | 4 | `TPSG` |
//! | 4 | 4 | classes of device it is for, [`DeviceClasses`], little endian |
//! | 8 | 8 | number of the key, [`KeyId`] |
//! | 16 | 64 | signature |
//!
//! The signature is over everything before it: head, nodes, classes, key number. The head holds format and length, so
//! a signed image without its block is no image, and one made unsigned again has another head. The CRC-32 is over the
//! signature too: signed and unsigned copies of an image have different names.
//!
//! The head of a signed image also holds its counter, in the word that is 0 in an unsigned one. An image that was signed
//! before there were counters has 0 there, and so the least of all.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::header::{COUNTER, CRC_BYTES, FORMAT, HEADER_BYTES, SIGNED_FORMAT};
use super::{Binding, ImageError, read};

/// Bytes of the block of the signature.
pub const SIGNATURE_BYTES: usize = 80;
/// First bytes of the block.
pub(super) const BLOCK: [u8; 4] = *b"TPSG";
/// Bytes of the signature itself, at the end of the block.
pub(super) const RAW_BYTES: usize = 64;

/// The number of a key: the first eight bytes of the public key. It tells which key to try and proves nothing.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct KeyId(pub [u8; 8]);

impl fmt::Display for KeyId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// What kind of device executes an image.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum DeviceClass {
    /// A coprocessor in a machine.
    Board,
    /// The LinuxCNC component.
    LinuxCnc,
    /// A board without a machine: in the emulator, or in the process of the bench.
    Bench,
}

impl DeviceClass {
    /// All of them, in the order of their bits.
    pub const ALL: [Self; 3] = [Self::Board, Self::LinuxCnc, Self::Bench];

    const fn bit(self) -> u32 {
        match self {
            Self::Board => 1,
            Self::LinuxCnc => 2,
            Self::Bench => 4,
        }
    }
    /// Its name in files and options.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Board => "board",
            Self::LinuxCnc => "linuxcnc",
            Self::Bench => "bench",
        }
    }
}

impl fmt::Display for DeviceClass {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}

/// The classes of device an image is for: a bit each, in the order of [`DeviceClass::ALL`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct DeviceClasses(u32);

impl DeviceClasses {
    /// Every class there is.
    pub const ALL: Self = Self(7);

    /// Those of a list; none of an empty one.
    pub fn of(classes: &[DeviceClass]) -> Option<Self> {
        Self::from_bits(classes.iter().fold(0, |bits, class| bits | class.bit()))
    }
    /// The bits, as they lie in the block.
    pub(super) const fn bits(self) -> u32 {
        self.0
    }
    /// Some classes, and none that is unknown.
    const fn from_bits(bits: u32) -> Option<Self> {
        if bits == 0 || bits & !Self::ALL.0 != 0 { None } else { Some(Self(bits)) }
    }
    /// Whether a class is among them.
    pub const fn holds(self, class: DeviceClass) -> bool {
        self.0 & class.bit() != 0
    }
}

impl fmt::Display for DeviceClasses {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut between = "";
        for class in DeviceClass::ALL {
            if self.holds(class) {
                write!(f, "{between}{class}")?;
                between = ",";
            }
        }
        Ok(())
    }
}

/// The signature of an image, not yet verified.
#[derive(Clone, Copy, Debug)]
pub struct Signed<'a> {
    /// What is signed.
    pub(super) message: &'a [u8],
    pub(super) signature: &'a [u8; RAW_BYTES],
    /// Number of the key it names.
    pub key: KeyId,
    /// The classes of device it names.
    pub classes: DeviceClasses,
    /// Rises from one signing to the next: the time of the signing, seconds since 1970. See [`Counted`].
    pub counter: u32,
}

impl<'a> Signed<'a> {
    /// Finds the signature of an image; none if it is not signed, or no image at all.
    pub fn of(image: &'a [u8]) -> Option<Self> {
        let content = image.split_last_chunk::<CRC_BYTES>()?.0;
        if content.len() < HEADER_BYTES || read::u16_at(content, 8) != SIGNED_FORMAT {
            return None;
        }
        let (message, signature) = content.split_last_chunk()?;
        let block = content.last_chunk::<SIGNATURE_BYTES>()?;
        let classes = DeviceClasses::from_bits(read::u32_at(block, 4)).filter(|_| block.starts_with(&BLOCK))?;
        let key = KeyId(block.get(8..)?.first_chunk().copied()?);
        Some(Self { message, signature, key, classes, counter: read::u32_at(content, COUNTER) })
    }
}

/// The counter of an image and the pass it counts for. Where keys are trusted, no image of a pass is taken with a lower
/// counter than one that was in use.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Counted {
    /// CRC-32 of the program.
    #[serde(with = "postcard::fixint::le")]
    pub program_crc: u32,
    /// Feature.
    #[serde(with = "postcard::fixint::le")]
    pub feature: u32,
    /// Pass.
    #[serde(with = "postcard::fixint::le")]
    pub pass: u32,
    /// Counter.
    #[serde(with = "postcard::fixint::le")]
    pub counter: u32,
}

impl Counted {
    /// The counter of an image with this binding.
    pub const fn of(binding: &Binding, counter: u32) -> Self {
        Self { program_crc: binding.program_crc, feature: binding.feature, pass: binding.pass, counter }
    }
    /// The counter of firmware, kept among those of passes; no feature of a program has this number.
    pub const fn firmware(counter: u32) -> Self {
        Self { program_crc: u32::from_le_bytes(*b"TPFW"), feature: u32::MAX, pass: u32::MAX, counter }
    }
    /// Whether both count for the same pass.
    pub const fn is_same_pass(&self, other: &Self) -> bool {
        self.program_crc == other.program_crc && self.feature == other.feature && self.pass == other.pass
    }
}

/// Whether the number of a format is one this version reads, and whether such images are signed.
pub(super) fn format(found: u16) -> Result<bool, ImageError> {
    match found {
        FORMAT => Ok(false),
        SIGNED_FORMAT => Ok(true),
        _ => Err(ImageError::Format { found, expected: FORMAT }),
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::unwrap_used, clippy::indexing_slicing)]
    use super::*;

    #[test]
    fn the_classes_of_a_list_are_those_in_it_however_often() {
        use DeviceClass::{Bench, Board, LinuxCnc};
        assert_eq!(DeviceClasses::of(&[]), None);
        assert_eq!(DeviceClasses::of(&DeviceClass::ALL), Some(DeviceClasses::ALL));
        for class in DeviceClass::ALL {
            let classes = DeviceClasses::of(&[class, class]).unwrap();
            assert!(DeviceClass::ALL.into_iter().all(|other| classes.holds(other) == (other == class)));
        }
        assert_eq!([Board, LinuxCnc, Bench].map(DeviceClass::name), ["board", "linuxcnc", "bench"]);
    }

    #[test]
    fn the_same_pass_is_that_of_the_same_feature_of_the_same_program() {
        let of = Counted { program_crc: 1, feature: 2, pass: 3, counter: 4 };
        assert!(of.is_same_pass(&Counted { counter: 5, ..of }));
        for other in [
            Counted { program_crc: 9, ..of },
            Counted { feature: 9, ..of },
            Counted { pass: 9, ..of },
            Counted { program_crc: 9, feature: 9, ..of },
            Counted { feature: 9, pass: 9, ..of },
            Counted { program_crc: 9, feature: 9, pass: 9, ..of },
            Counted::firmware(4),
        ] {
            assert!(!of.is_same_pass(&other), "{other:?}");
        }
        assert!(Counted::firmware(4).is_same_pass(&Counted::firmware(5)));
        let binding = Binding { program_crc: 1, feature: 2, pass: 3, tool: 9, tool_offset: 9, setup: 9 };
        assert_eq!(Counted::of(&binding, 4), of);
    }

    #[test]
    fn what_is_shorter_than_the_head_or_of_another_format_is_not_signed() {
        let mut bytes = [0; HEADER_BYTES + SIGNATURE_BYTES + CRC_BYTES];
        for (length, format) in [
            (bytes.len(), SIGNED_FORMAT),
            (bytes.len(), FORMAT),
            (HEADER_BYTES + CRC_BYTES - 1, SIGNED_FORMAT),
            (120, FORMAT),
        ] {
            bytes.fill(0);
            bytes[8..10].copy_from_slice(&format.to_le_bytes());
            let block = length - CRC_BYTES - SIGNATURE_BYTES;
            bytes[block..block + 5].copy_from_slice(&[b'T', b'P', b'S', b'G', 1]);
            assert_eq!(
                Signed::of(&bytes[..length]).is_some(),
                length == bytes.len() && format == SIGNED_FORMAT,
                "{length}"
            );
        }
    }
}
