//! The answer frame: what goes back in the same tick.

use super::LINK_VERSION;
use super::error::LinkError;
use super::setpoint::{CRC_BYTES, check_head};
use super::stuffing::stuff;
use crate::rewrite::{AXES, Mode, Output, Place, Reason, Status};
use truepath_units::checksum::crc32;

/// First byte of an answer frame.
const KIND: u8 = b'C';
/// Bytes before the corrections.
const HEAD: usize = 20;
/// Status bit of an answer: its positions are for the drives. Without it the drive enable is to be dropped.
pub const FORWARD: u16 = 1 << 15;
/// Bytes of an answer frame for all six axes, without COBS.
pub const MAX_ANSWER_BYTES: usize = answer_bytes(AXES as u8);

/// Bytes of an answer frame, without COBS: 24 + 12 for each axis.
pub const fn answer_bytes(axes: u8) -> usize {
    (axes as usize).wrapping_mul(12).wrapping_add(HEAD + CRC_BYTES)
}

/// An output of the rewriter with the number of axes it is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct AnswerFrame {
    /// 1 … 6; the others of the output are not sent.
    pub axes: u8,
    /// What the rewriter gave.
    pub output: Output,
}

impl AnswerFrame {
    /// Writes the frame as it travels on SPI; gives its bytes.
    ///
    /// # Errors
    /// [`LinkError::Buffer`] when `raw` is too short or the number of axes is not 1 … 6.
    #[inline]
    pub fn encode(&self, raw: &mut [u8]) -> Result<usize, LinkError> {
        write(&self.output, self.axes, raw)
    }

    /// Writes the frame as it travels on a byte stream, with COBS and the 0x00 at its end; gives the bytes to send.
    ///
    /// # Errors
    /// As [`encode`](Self::encode); two bytes more are needed.
    #[inline]
    pub fn encode_packet(&self, packet: &mut [u8]) -> Result<usize, LinkError> {
        write_packet(&self.output, self.axes, packet)
    }

    /// Reads an answer to a controller with a number of axes; those that are not sent are at 0.
    ///
    /// # Errors
    /// Another length, damaged, another kind, version or number of axes, a mode or reason that does not exist.
    pub fn decode(raw: &[u8], axes: u8) -> Result<Self, LinkError> {
        let length = LinkError::Length { expected: answer_bytes(axes), found: raw.len() };
        if raw.len() != answer_bytes(axes) {
            return Err(length);
        }
        let (content, stored) = raw.split_last_chunk::<CRC_BYTES>().ok_or(length)?;
        let (stored, computed) = (u32::from_le_bytes(*stored), crc32(content));
        if stored != computed {
            return Err(LinkError::Checksum { stored, computed });
        }
        let (head, body) = content.split_first_chunk::<HEAD>().ok_or(length)?;
        let &[[kind, version, count, mode], sequence, [r0, r1, s0, s1], node, fraction] = head.as_chunks::<4>().0
        else {
            return Err(length);
        };
        check_head(kind, KIND, version, count, axes)?;
        let reason = Reason::try_from(u16::from_le_bytes([r0, r1])).map_err(|_| LinkError::Reserved)?;
        let status = u16::from_le_bytes([s0, s1]);
        let mut output = Output {
            axes: [0; AXES],
            correction_nm: [0; AXES],
            forward: status & FORWARD != 0,
            mode: mode_of(mode).ok_or(LinkError::Reserved)?,
            reason,
            status: Status(status & !FORWARD),
            place: Place { node: u32::from_le_bytes(node), fraction: u32::from_le_bytes(fraction) },
            sequence: u32::from_le_bytes(sequence),
        };
        let (corrections, places) = body.split_at_checked(usize::from(axes).wrapping_mul(4)).ok_or(length)?;
        for (to, correction) in output.correction_nm.iter_mut().zip(corrections.as_chunks::<4>().0) {
            *to = i32::from_le_bytes(*correction);
        }
        for (to, place) in output.axes.iter_mut().zip(places.as_chunks::<8>().0) {
            *to = i64::from_le_bytes(*place);
        }
        Ok(Self { axes, output })
    }
}

/// [`AnswerFrame::encode`] of an output that lies elsewhere.
#[inline]
pub(super) fn write(output: &Output, axes: u8, raw: &mut [u8]) -> Result<usize, LinkError> {
    if !(1..=AXES as u8).contains(&axes) {
        return Err(LinkError::Buffer);
    }
    let bytes = answer_bytes(axes);
    let frame = raw.get_mut(..bytes).ok_or(LinkError::Buffer)?;
    let (content, crc) = frame.split_last_chunk_mut::<CRC_BYTES>().ok_or(LinkError::Buffer)?;
    let (head, body) = content.split_first_chunk_mut::<HEAD>().ok_or(LinkError::Buffer)?;
    let forward = if output.forward { FORWARD } else { 0 };
    let words = [
        u32::from_le_bytes([KIND, LINK_VERSION, axes, output.mode as u8]),
        output.sequence,
        u32::from(output.reason.code()) | (u32::from(output.status.0 | forward) << 16),
        output.place.node,
        output.place.fraction,
    ];
    for (to, word) in head.as_chunks_mut::<4>().0.iter_mut().zip(words) {
        *to = word.to_le_bytes();
    }
    let corrections = usize::from(axes).wrapping_mul(4);
    let (corrections, places) = body.split_at_mut_checked(corrections).ok_or(LinkError::Buffer)?;
    let (corrections, places) = (corrections.as_chunks_mut::<4>().0, places.as_chunks_mut::<8>().0);
    // Written out: a loop becomes a call of the copying routine, which takes five instructions a byte. Each is loaded where it is written.
    let mut put = |axis: usize, correction: &i32, position: &i64| {
        if let (Some(to), Some(place)) = (corrections.get_mut(axis), places.get_mut(axis)) {
            *to = correction.to_le_bytes();
            *place = position.to_le_bytes();
        }
    };
    let ([c0, c1, c2, c3, c4, c5], [p0, p1, p2, p3, p4, p5]) = (&output.correction_nm, &output.axes);
    put(0, c0, p0);
    put(1, c1, p1);
    put(2, c2, p2);
    put(3, c3, p3);
    put(4, c4, p4);
    put(5, c5, p5);
    *crc = crc32(content).to_le_bytes();
    Ok(bytes)
}

/// [`AnswerFrame::encode_packet`] of an output that lies elsewhere.
#[inline]
pub(super) fn write_packet(output: &Output, axes: u8, packet: &mut [u8]) -> Result<usize, LinkError> {
    let bytes = write(output, axes, packet.get_mut(1..).ok_or(LinkError::Buffer)?)?;
    Ok(stuff(packet.get_mut(..bytes.wrapping_add(2)).ok_or(LinkError::Buffer)?))
}

fn mode_of(number: u8) -> Option<Mode> {
    [Mode::Off, Mode::Bypass, Mode::Armed, Mode::Active, Mode::Hold, Mode::Fault].get(usize::from(number)).copied()
}
