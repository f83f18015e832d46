//! Why bytes are no frame and no message.

use truepath_units::errors;

errors! {
    /// What is wrong with received bytes, or with a buffer to send from. The sentence of each variant is the text shown.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum LinkError {
        /// The buffer lent is too small, or the message is longer than [`MESSAGE_BYTES`](super::MESSAGE_BYTES).
        Buffer = "K101", "the message does not fit into the buffer";
        /// The bytes are not a COBS frame.
        Stuffing = "K102", "the bytes are not a COBS frame";
        /// The length is another one than this kind of frame has.
        Length {
            /// Bytes it should have, or the least it can have.
            expected: usize,
            /// Bytes it has.
            found: usize,
        } = "K103", "the frame should have {expected} bytes and has {found}";
        /// Another kind of frame.
        Kind {
            /// First byte.
            found: u8,
        } = "K104", "a frame of unknown kind 0x{found:02x}";
        /// Another version of the link.
        Version {
            /// Second byte.
            found: u8,
        } = "K105", "version {found} of the link, only {ours} can be read", ours = super::LINK_VERSION;
        /// Another number of axes than the settings of the device say.
        Axes {
            /// Number of the settings.
            expected: u8,
            /// Number in the frame.
            found: u8,
        } = "K106", "a frame for {found} axes, the device has {expected}";
        /// A reserved byte or bit is set, or a number stands for nothing.
        Reserved = "K107", "a reserved byte is set or a number stands for nothing";
        /// The frame is damaged.
        Checksum {
            /// CRC-32 that came with it.
            stored: u32,
            /// CRC-32 of its bytes.
            computed: u32,
        } = "K108", "the frame is damaged: CRC-32 {computed:08x}, sent {stored:08x}";
        /// The message is undamaged but cannot be read: a request or reply of another version.
        Content {
            /// The `id` it begins with, 0 when not even that can be read.
            id: u16,
        } = "K109", "message {id} is undamaged but cannot be read: another version?";
    }
}

impl core::error::Error for LinkError {}
