//! The two image slots in flash: what is in them, and uploads into the idle one.
//!
//! Each slot is three sectors of its own. Its first word is the head of the upload, its second the commit word; from
//! byte 64 on lie the bytes of the image as they were sent, the last word filled up with ones.
//!
//! | offset | bytes | head word | commit word |
//! |---:|---:|---|---|
//! | 0 | 4 | `TPH1` | `TPC1`; `TPX1` when the check failed |
//! | 4 | 4 | length of the image | length of the image |
//! | 8 | 4 | checksum of the image | checksum of the image |
//! | 12 | 4 | generation, one more than the greatest in either slot | generation |
//! | 16 | 12 | 0 | 0 |
//! | 28 | 4 | CRC-32 of the 28 bytes before | CRC-32 of the 28 bytes before |
//!
//! Order of an upload: erase the sectors it needs; head; data in rising order; read back and check; commit word. A word of
//! ones is not programmed, it reads the same. An image counts only if head and commit word agree, and it is read and
//! checked as a whole each time before it is used; so whatever an interrupted erase leaves of an old image is never
//! taken for one.
//!
//! An interrupted upload goes on behind the last programmed word. A word that was being programmed when the power
//! failed is torn and would stay so until its sector is erased: then the upload goes on from the start of that
//! sector, or from the beginning if it is the first.
//!
//! The checksum that names an image is the one at its end, in `Begin` too: the CRC-32 of all bytes of an image,
//! checksum included, is the same number for every image and could not tell one upload from another.

mod store;
mod upload;

pub use store::{SLOT_IMAGE_BYTES, read, survey};
pub use upload::Upload;
