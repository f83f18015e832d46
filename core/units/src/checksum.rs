//! The checksum of everything that is bound or sent: programs, images, frames.
//!
//! Every frame of the setpoint link is checked in the servo cycle, so four bytes are taken at a time (Kounavis and
//! Berry, "A systematic approach to building high performance software-based CRC generators", 2005), with tables of
//! the `crc` crate, 4 KiB. On a Cortex-M7 that is about 4 instructions a byte; the crate's own loops take 6.5 with
//! one table of 1 KiB and the same with sixteen, whose 16 KiB would also fill the data cache.
//!
//! ```
//! assert_eq!(truepath_units::checksum::crc32(b"123456789"), 0xCBF4_3926);
//! ```

use crc::{CRC_32_ISO_HDLC, Crc, Table};

/// What a byte does to the checksum, with 0 … 3 bytes behind it.
const TABLES: [[u32; 256]; 4] = {
    let [a, b, c, d, ..] = *Crc::<u32, Table<16>>::new(&CRC_32_ISO_HDLC).table();
    [a, b, c, d]
};

// Each by itself: as parts of one their places would be sums, made anew for every word.
static LAST: [u32; 256] = table(0);
static THIRD: [u32; 256] = table(1);
static SECOND: [u32; 256] = table(2);
static FIRST: [u32; 256] = table(3);

#[expect(clippy::indexing_slicing, reason = "evaluated by the compiler only")]
const fn table(behind: usize) -> [u32; 256] {
    TABLES[behind]
}

/// CRC-32 (ISO-HDLC, as in zip and Ethernet) of bytes as they are.
///
/// Never part of its caller: the four tables and the sum need all registers there are, and in a larger function they would not stay in
/// them.
#[inline(never)]
pub fn crc32(bytes: &[u8]) -> u32 {
    let entry = |table: &[u32; 256], byte: u8| table.get(usize::from(byte)).copied().unwrap_or(0);
    let (words, rest) = bytes.as_chunks::<4>();
    let mut crc = CRC_32_ISO_HDLC.init;
    for word in words {
        let [a, b, c, d] = (u32::from_le_bytes(*word) ^ crc).to_le_bytes();
        crc = entry(&FIRST, a) ^ entry(&SECOND, b) ^ entry(&THIRD, c) ^ entry(&LAST, d);
    }
    for byte in rest {
        crc = (crc >> 8) ^ entry(&LAST, crc as u8 ^ byte);
    }
    crc ^ CRC_32_ISO_HDLC.xorout
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn the_check_value_of_the_catalogue_is_met() {
        assert_eq!(crc32(b"123456789"), CRC_32_ISO_HDLC.check);
        assert_eq!(crc32(b""), 0);
    }

    proptest! {
        #[test]
        fn four_bytes_at_a_time_give_what_the_crate_gives(bytes in proptest::collection::vec(any::<u8>(), 0..200)) {
            prop_assert_eq!(crc32(&bytes), Crc::<u32, Table<1>>::new(&CRC_32_ISO_HDLC).checksum(&bytes));
        }
    }
}
