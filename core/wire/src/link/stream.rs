//! From a byte stream to packets: whatever lies between two 0x00.

use super::stuffing::has_zero;

/// Collects the bytes of a stream, in pieces of any size, until a packet is complete. Packets have at most N bytes
/// without their 0x00; what is longer is dropped up to the next 0x00. Empty packets are passed over. After a loss it
/// is in step again at the next 0x00.
#[derive(Clone, Debug)]
pub struct Deframer<const N: usize> {
    packet: [u8; N],
    length: usize,
    /// The packet was handed out; the next byte begins another.
    done: bool,
    /// It is longer than N: wait for 0x00.
    overlong: bool,
}

/// What the deframer found.
#[derive(Debug, PartialEq, Eq)]
pub enum Framed<'a> {
    /// A whole packet, COBS still in, without its 0x00.
    Packet(&'a mut [u8]),
    /// The end of a packet that was too long; to be counted as damaged.
    Overlong,
}

impl<const N: usize> Deframer<N> {
    /// At the start of a stream.
    pub const fn new() -> Self {
        Self { packet: [0; N], length: 0, done: false, overlong: false }
    }

    /// Takes bytes off the front of `bytes` up to and including the end of the next packet. `None`: all bytes are
    /// taken and no packet is complete. Each byte is looked at once, most of them four at a time.
    #[inline]
    pub fn feed(&mut self, bytes: &mut &[u8]) -> Option<Framed<'_>> {
        if core::mem::take(&mut self.done) {
            self.length = 0;
        }
        loop {
            self.words(bytes);
            let (&byte, rest) = bytes.split_first()?;
            *bytes = rest;
            if byte != 0 {
                match self.packet.get_mut(self.length) {
                    Some(place) => {
                        *place = byte;
                        self.length = self.length.wrapping_add(1);
                    }
                    None => self.overlong = true,
                }
            } else if core::mem::take(&mut self.overlong) {
                self.length = 0;
                return Some(Framed::Overlong);
            } else if self.length > 0 {
                self.done = true;
                return self.packet.get_mut(..self.length).map(Framed::Packet);
            }
        }
    }

    /// Four bytes at a time while none is zero and there is room.
    #[inline]
    fn words(&mut self, bytes: &mut &[u8]) {
        let Some(room) = self.packet.get_mut(self.length..) else { return };
        let mut taken = 0usize;
        for (place, word) in room.as_chunks_mut::<4>().0.iter_mut().zip(bytes.as_chunks::<4>().0) {
            if has_zero(u32::from_le_bytes(*word)) {
                break;
            }
            *place = *word;
            taken = taken.wrapping_add(4);
        }
        self.length = self.length.wrapping_add(taken);
        *bytes = bytes.get(taken..).unwrap_or(&[]);
    }
}

impl<const N: usize> Default for Deframer<N> {
    fn default() -> Self {
        Self::new()
    }
}
