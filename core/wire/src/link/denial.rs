//! Why the device does not do what a request asks.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::access::AccessError;
use super::device::Item;
use super::settings::DeviceSettingsError;
use crate::image::{ImageError, MOST_KEYS, MOST_KEYS_EVER, SignatureError};
use crate::rewrite::{Mode, Refusal};
use crate::update::UpdateError;

/// Why a request had no effect; a mismatch carries both sides. The order of the variants is the number on the wire.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Denial {
    /// Not in this mode.
    Mode(Mode),
    /// The state machine refuses: acknowledge, check, arm, disarm.
    Refused(Refusal),
    /// The bytes are no image that can be used.
    Image(ImageError),
    /// The settings are out of range.
    Settings(DeviceSettingsError),
    /// The request is undamaged but unknown to this version.
    Unknown,
    /// Something else is under way: an upload, a computation.
    Busy,
    /// No upload was begun.
    NoUpload,
    /// The item is longer than its place, or has no bytes.
    TooLong {
        /// What was to be sent.
        item: Item,
        /// Its bytes.
        length: u32,
        /// Most it may have.
        most: u32,
    },
    /// The chunk goes elsewhere, is too long, or reaches beyond the end.
    Offset {
        /// Where the next chunk goes.
        expected: u32,
        /// Where this one would go.
        found: u32,
        /// Its bytes.
        bytes: u32,
    },
    /// Not everything has arrived.
    Incomplete {
        /// Bytes in all.
        length: u32,
        /// Bytes that are there.
        written: u32,
    },
    /// What was read back is not what was sent.
    Checksum {
        /// CRC-32 that `Begin` named.
        expected: u32,
        /// CRC-32 of what is there.
        found: u32,
    },
    /// The slot holds no image, or there is no such slot.
    NoImage {
        /// The slot asked for.
        slot: u8,
    },
    /// The slot holds another image than the one that is meant.
    OtherImage {
        /// The slot asked for.
        slot: u8,
        /// Checksum asked for.
        expected: u32,
        /// Checksum of the image that is there.
        found: u32,
    },
    /// `Compute` needs an item that was not uploaded.
    Missing(Item),
    /// There is no such frame, or the recorder still runs.
    NoRecording {
        /// Frames recorded.
        total: u32,
    },
    /// The flash does not take or give what it should.
    Flash {
        /// Where, bytes from the start of the store.
        address: u32,
    },
    /// The device has no settings of its own: it was never configured, or what it had stored is damaged. Check and arm
    /// are refused until `Configure`, because joint limits that nobody has set protect nothing.
    NotConfigured,
    /// A key is provisioned, and the image is not signed with it for this class of device; or the key itself is none.
    Untrusted(SignatureError),
    /// A key can be provisioned or revoked only by somebody who is at the device: its button was not held at the last reset.
    NotPresent,
    /// There is no room for another key.
    KeysFull,
    /// Whoever asks may not, or is not let in.
    Access(AccessError),
    /// A firmware update is not taken, or is in the way.
    Update(UpdateError),
}

impl fmt::Display for Denial {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Mode(mode) => write!(f, "not possible in state {mode}"),
            Self::Refused(refusal) => refusal.fmt(f),
            Self::Image(error) => error.fmt(f),
            Self::Settings(error) => error.fmt(f),
            Self::Unknown => f.write_str("the device does not know this request: another version of the firmware?"),
            Self::Busy => f.write_str("an upload or a computation is under way"),
            Self::NoUpload => f.write_str("no upload was begun"),
            Self::TooLong { item, length, most } => write!(f, "{item} of {length} bytes, the device takes 1 to {most}"),
            Self::Offset { expected, found, bytes } => {
                write!(f, "{bytes} bytes at {found}, the next ones should go to {expected}")
            }
            Self::Incomplete { length, written } => write!(f, "only {written} of {length} bytes have arrived"),
            Self::Checksum { expected, found } => {
                write!(f, "the bytes read back have CRC-32 {found:08x}, sent {expected:08x}")
            }
            Self::NoImage { slot } => write!(f, "slot {slot} holds no image"),
            Self::OtherImage { slot, expected, found } => {
                write!(f, "slot {slot} holds image {found:08x}, meant is {expected:08x}")
            }
            Self::Missing(item) => write!(f, "{item} has not been uploaded"),
            Self::NoRecording { total } => write!(f, "no such frame, or the recorder still runs ({total} frames)"),
            Self::Flash { address } => write!(f, "the flash failed at 0x{address:x}"),
            Self::NotConfigured => f.write_str("the device has no settings of its own: it is to be configured first"),
            Self::Untrusted(error) => error.fmt(f),
            Self::NotPresent => f.write_str("nobody is at the device: its button was not held at the last reset"),
            Self::Access(error) => error.fmt(f),
            Self::Update(error) => error.fmt(f),
            Self::KeysFull => {
                write!(
                    f,
                    "the device trusts {MOST_KEYS} keys already, or has known {MOST_KEYS_EVER}, those revoked among them"
                )
            }
        }
    }
}

impl core::error::Error for Denial {}

impl fmt::Display for Item {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Image => "an image",
            Self::Program => "a program",
            Self::Job => "a job",
            Self::Probe => "a probe log",
            Self::Firmware => "a firmware update",
        })
    }
}
