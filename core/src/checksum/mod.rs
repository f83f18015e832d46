//! The checksum of everything that is bound or sent: programs, images, frames.

use crc::{CRC_32_ISO_HDLC, Crc};

static CRC: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// CRC-32 (ISO-HDLC, as in zip and Ethernet) of bytes as they are.
pub fn crc32(bytes: &[u8]) -> u32 {
    CRC.checksum(bytes)
}
