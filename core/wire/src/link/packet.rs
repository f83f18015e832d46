//! A message as a packet: postcard, CRC-32, COBS, 0x00.

use serde::{Deserialize, Serialize};

use super::error::LinkError;
use super::message::{MESSAGE_BYTES, Request};
use truepath_units::checksum::crc32;

/// Bytes of the checksum.
const CRC_BYTES: usize = 4;

/// Writes a [`Request`](super::Request) or [`Response`](super::Response) with its CRC-32 as a COBS frame and the 0x00
/// at its end; gives the bytes used. `packet` of [`PACKET_BYTES`](super::PACKET_BYTES) is always enough.
///
/// # Errors
/// [`LinkError::Buffer`]: the message is longer than [`MESSAGE_BYTES`], or `packet` is too short for it.
pub fn encode<T: Serialize>(message: &T, packet: &mut [u8]) -> Result<usize, LinkError> {
    encode_before(message, &[], packet)
}

/// The same of a request of a session: its number, 8 bytes, little endian, stands behind the message, before the CRC-32.
///
/// # Errors
/// As [`encode`].
pub fn encode_request(request: &Request<'_>, session: Option<u64>, packet: &mut [u8]) -> Result<usize, LinkError> {
    match session {
        Some(session) => encode_before(request, &session.to_le_bytes(), packet),
        None => encode(request, packet),
    }
}

/// A message with something behind it.
fn encode_before<T: Serialize>(message: &T, behind: &[u8], packet: &mut [u8]) -> Result<usize, LinkError> {
    let mut raw = [0; MESSAGE_BYTES];
    let (content, _) = raw.split_last_chunk_mut::<CRC_BYTES>().ok_or(LinkError::Buffer)?;
    let used = postcard::to_slice(message, content).map_err(|_| LinkError::Buffer)?.len();
    let end = used.saturating_add(behind.len());
    content.get_mut(used..end).ok_or(LinkError::Buffer)?.copy_from_slice(behind);
    let crc = crc32(content.get(..end).ok_or(LinkError::Buffer)?).to_le_bytes();
    let whole = end.saturating_add(CRC_BYTES);
    raw.get_mut(end..whole).ok_or(LinkError::Buffer)?.copy_from_slice(&crc);
    let (delimiter, room) = packet.split_last_mut().ok_or(LinkError::Buffer)?;
    let source = raw.get(..whole).ok_or(LinkError::Buffer)?;
    let used = cobs::try_encode(source, room).map_err(|_| LinkError::Buffer)?;
    *room.get_mut(used).unwrap_or(delimiter) = 0;
    Ok(used.saturating_add(1))
}

/// Reads a message from a COBS frame, with or without the 0x00 at its end. The frame is decoded in place, and what
/// the message borrows lies in it.
///
/// # Errors
/// No COBS frame, too short, damaged, or undamaged but of another version ([`LinkError::Content`]).
pub fn decode<'a, T: Deserialize<'a>>(packet: &'a mut [u8]) -> Result<T, LinkError> {
    let content = undamaged(packet)?;
    match postcard::take_from_bytes(content) {
        Ok((message, [])) => Ok(message),
        _ => Err(unreadable(content)),
    }
}

/// The same of a request, with the number of its session, if it has one.
///
/// # Errors
/// As [`decode`].
pub fn decode_request(packet: &mut [u8]) -> Result<(Request<'_>, Option<u64>), LinkError> {
    let content = undamaged(packet)?;
    match postcard::take_from_bytes(content) {
        Ok((request, [])) => Ok((request, None)),
        Ok((request, behind)) => {
            let session = behind.try_into().map_err(|_| unreadable(content))?;
            Ok((request, Some(u64::from_le_bytes(session))))
        }
        Err(_) => Err(unreadable(content)),
    }
}

fn unreadable(content: &[u8]) -> LinkError {
    LinkError::Content { id: postcard::take_from_bytes(content).map_or(0, |(id, _)| id) }
}

/// The content of a frame that arrived whole.
fn undamaged(packet: &mut [u8]) -> Result<&[u8], LinkError> {
    let length = cobs::decode_in_place(packet).map_err(|_| LinkError::Stuffing)?;
    let short = LinkError::Length { expected: CRC_BYTES.saturating_add(2), found: length };
    let whole: &[u8] = packet.get(..length).ok_or(LinkError::Stuffing)?;
    let (content, stored) = whole.split_last_chunk::<CRC_BYTES>().ok_or(short)?;
    let (stored, computed) = (u32::from_le_bytes(*stored), crc32(content));
    if stored != computed {
        return Err(LinkError::Checksum { stored, computed });
    }
    Ok(content)
}
