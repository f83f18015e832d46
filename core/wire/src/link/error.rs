//! Why bytes are no frame and no message.

use core::fmt;

/// What is wrong with received bytes, or with a buffer to send from. The sentence of each variant is the text shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum LinkError {
    /// The buffer lent is too small, or the message is longer than [`MESSAGE_BYTES`](super::MESSAGE_BYTES).
    Buffer,
    /// The bytes are not a COBS frame.
    Stuffing,
    /// The length is another one than this kind of frame has.
    Length {
        /// Bytes it should have, or the least it can have.
        expected: usize,
        /// Bytes it has.
        found: usize,
    },
    /// Another kind of frame.
    Kind {
        /// First byte.
        found: u8,
    },
    /// Another version of the link.
    Version {
        /// Second byte.
        found: u8,
    },
    /// Another number of axes than the settings of the device say.
    Axes {
        /// Number of the settings.
        expected: u8,
        /// Number in the frame.
        found: u8,
    },
    /// A reserved byte or bit is set, or a number stands for nothing.
    Reserved,
    /// The frame is damaged.
    Checksum {
        /// CRC-32 that came with it.
        stored: u32,
        /// CRC-32 of its bytes.
        computed: u32,
    },
    /// The message is undamaged but cannot be read: a request or reply of another version.
    Content {
        /// The `id` it begins with, 0 when not even that can be read.
        id: u16,
    },
}

impl fmt::Display for LinkError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Buffer => f.write_str("the message does not fit into the buffer"),
            Self::Stuffing => f.write_str("the bytes are not a COBS frame"),
            Self::Length { expected, found } => write!(f, "the frame should have {expected} bytes and has {found}"),
            Self::Kind { found } => write!(f, "a frame of unknown kind 0x{found:02x}"),
            Self::Version { found } => {
                write!(f, "version {found} of the link, only {} can be read", super::LINK_VERSION)
            }
            Self::Axes { expected, found } => write!(f, "a frame for {found} axes, the device has {expected}"),
            Self::Reserved => f.write_str("a reserved byte is set or a number stands for nothing"),
            Self::Checksum { stored, computed } => {
                write!(f, "the frame is damaged: CRC-32 {computed:08x}, sent {stored:08x}")
            }
            Self::Content { id } => write!(f, "message {id} is undamaged but cannot be read: another version?"),
        }
    }
}

impl core::error::Error for LinkError {}
