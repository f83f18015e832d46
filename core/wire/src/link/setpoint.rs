//! The setpoint frame: what the controller sends once a tick.

use super::LINK_VERSION;
use super::error::LinkError;
use super::stuffing::stuff;
use crate::rewrite::{AXES, Flags, Setpoint};
use truepath_units::checksum::crc32;

/// First byte of a setpoint frame.
pub(super) const KIND: u8 = b'S';
/// Bytes before the positions.
const HEAD: usize = 20;
/// Bytes of the checksum.
pub(super) const CRC_BYTES: usize = 4;
/// Bytes of a setpoint frame for all six axes, without COBS.
pub const MAX_SETPOINT_BYTES: usize = setpoint_bytes(AXES as u8);

/// Bytes of a setpoint frame, without COBS: 24 + 8 for each axis.
pub const fn setpoint_bytes(axes: u8) -> usize {
    (axes as usize).wrapping_mul(8).wrapping_add(HEAD + CRC_BYTES)
}

/// A setpoint with the number of axes it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SetpointFrame {
    /// 1 … 6; the others of the setpoint are not sent.
    pub axes: u8,
    /// The setpoint. Its age of the spindle speed is sent as at most 65 535.
    pub setpoint: Setpoint,
}

impl SetpointFrame {
    /// Writes the frame as it travels on SPI; gives its bytes.
    ///
    /// # Errors
    /// [`LinkError::Buffer`] when `raw` is too short or the number of axes is not 1 … 6.
    pub fn encode(&self, raw: &mut [u8]) -> Result<usize, LinkError> {
        if !(1..=AXES as u8).contains(&self.axes) {
            return Err(LinkError::Buffer);
        }
        let bytes = setpoint_bytes(self.axes);
        let frame = raw.get_mut(..bytes).ok_or(LinkError::Buffer)?;
        let (content, crc) = frame.split_last_chunk_mut::<CRC_BYTES>().ok_or(LinkError::Buffer)?;
        let (head, places) = content.split_first_chunk_mut::<HEAD>().ok_or(LinkError::Buffer)?;
        let s = &self.setpoint;
        let age = u16::try_from(s.spindle_age_ticks).unwrap_or(u16::MAX);
        let words = [
            u32::from_le_bytes([KIND, LINK_VERSION, self.axes, 0]),
            s.sequence,
            u32::from(s.flags.0) | (u32::from(age) << 16),
            s.spindle_millirpm,
            s.frame_crc,
        ];
        for (to, word) in head.as_chunks_mut::<4>().0.iter_mut().zip(words) {
            *to = word.to_le_bytes();
        }
        for (to, place) in places.as_chunks_mut::<8>().0.iter_mut().zip(s.axes) {
            *to = place.to_le_bytes();
        }
        *crc = crc32(content).to_le_bytes();
        Ok(bytes)
    }

    /// Writes the frame as it travels on a byte stream, with COBS and the 0x00 at its end; gives the bytes to send.
    ///
    /// # Errors
    /// As [`encode`](Self::encode); two bytes more are needed.
    pub fn encode_packet(&self, packet: &mut [u8]) -> Result<usize, LinkError> {
        let bytes = self.encode(packet.get_mut(1..).ok_or(LinkError::Buffer)?)?;
        Ok(stuff(packet.get_mut(..bytes.wrapping_add(2)).ok_or(LinkError::Buffer)?))
    }

    /// Reads a frame for a device with a number of axes; axes that are not sent are at 0.
    ///
    /// # Errors
    /// Another length, damaged, another kind, version or number of axes, or the reserved byte is set.
    #[inline(never)]
    pub fn decode(raw: &[u8], axes: u8) -> Result<Setpoint, LinkError> {
        let length = LinkError::Length { expected: setpoint_bytes(axes), found: raw.len() };
        if raw.len() != setpoint_bytes(axes) {
            return Err(length);
        }
        let (content, stored) = raw.split_last_chunk::<CRC_BYTES>().ok_or(length)?;
        let (stored, computed) = (u32::from_le_bytes(*stored), crc32(content));
        if stored != computed {
            return Err(LinkError::Checksum { stored, computed });
        }
        let (head, places) = content.split_first_chunk::<HEAD>().ok_or(length)?;
        let &[first, sequence, flags_and_age, spindle, frame_crc] = head.as_chunks::<4>().0 else {
            return Err(length);
        };
        // One question for all that is right; only what is wrong is looked at piece by piece.
        if first != [KIND, LINK_VERSION, axes, 0] {
            let [kind, version, count, _] = first;
            check_head(kind, KIND, version, count, axes)?;
            return Err(LinkError::Reserved);
        }
        let flags_and_age = u32::from_le_bytes(flags_and_age);
        let places = places.as_chunks::<8>().0;
        let place = |axis: usize| places.get(axis).map_or(0, |bytes| i64::from_le_bytes(*bytes));
        Ok(Setpoint {
            // Written out: a loop becomes a call of the copying routine, which takes five instructions a byte.
            axes: [place(0), place(1), place(2), place(3), place(4), place(5)],
            spindle_millirpm: u32::from_le_bytes(spindle),
            spindle_age_ticks: flags_and_age >> 16,
            sequence: u32::from_le_bytes(sequence),
            frame_crc: u32::from_le_bytes(frame_crc),
            flags: Flags(flags_and_age as u16),
        })
    }
}

/// The first three bytes of either frame.
#[inline]
pub(super) fn check_head(kind: u8, wanted: u8, version: u8, count: u8, axes: u8) -> Result<(), LinkError> {
    if kind != wanted {
        Err(LinkError::Kind { found: kind })
    } else if version != LINK_VERSION {
        Err(LinkError::Version { found: version })
    } else if count != axes {
        Err(LinkError::Axes { expected: axes, found: count })
    } else {
        Ok(())
    }
}
