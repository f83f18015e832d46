//! The checked image.

use super::block::{self, Signed};
use super::header::{COUNTER, CRC_BYTES, FLAG_CLOSED, MAGIC, SEMANTICS};
use super::{HEADER_BYTES, Header, ImageError, ImageSettings, NODE_BYTES, Node, SIGNATURE_BYTES, check, crc32, read};

/// Bytes of an image with a number of nodes, not signed.
pub const fn image_bytes(nodes: usize) -> usize {
    nodes.saturating_mul(NODE_BYTES).saturating_add(HEADER_BYTES + CRC_BYTES)
}

/// A checked image, borrowed from the bytes it lies in.
#[derive(Clone, Copy, Debug)]
pub struct Image<'a> {
    header: Header,
    nodes: &'a [[u8; NODE_BYTES]],
    crc: u32,
}

impl<'a> Image<'a> {
    /// Checks bytes once and for all. Time grows with the number of nodes; not for the servo cycle.
    ///
    /// # Errors
    /// An [`ImageError`] that names what is wrong and both sides of it. Bytes after the end are an error.
    pub fn new_checked(bytes: &'a [u8]) -> Result<Self, ImageError> {
        let image = Self::framed(bytes)?;
        check::header(&image.header)?;
        check::nodes(&image.header, image.nodes())?;
        Ok(image)
    }

    /// Magic, versions, lengths and checksum.
    fn framed(bytes: &'a [u8]) -> Result<Self, ImageError> {
        let found = bytes.len();
        let least = HEADER_BYTES.saturating_add(CRC_BYTES);
        if !bytes.starts_with(&MAGIC) && found >= MAGIC.len() {
            return Err(ImageError::Magic);
        }
        let Some((head, rest)) = bytes.split_first_chunk::<HEADER_BYTES>() else {
            return Err(ImageError::Length { expected: least, found });
        };
        let Some((body, stored)) = rest.split_last_chunk::<CRC_BYTES>() else {
            return Err(ImageError::Length { expected: least, found });
        };
        let signed = block::format(read::u16_at(head, 8))?;
        let semantics = read::u32_at(head, 12);
        if semantics != SEMANTICS {
            return Err(ImageError::Semantics { found: semantics, expected: SEMANTICS });
        }
        let expected = read::u32_at(head, 16) as usize;
        if expected != found {
            return Err(ImageError::Length { expected, found });
        }
        let stored = u32::from_le_bytes(*stored);
        let computed = crc32(bytes.get(..found.saturating_sub(CRC_BYTES)).unwrap_or(&[]));
        if stored != computed {
            return Err(ImageError::Checksum { stored, computed });
        }
        let counter = if signed { 0 } else { read::u32_at(head, COUNTER) };
        if read::u16_at(head, 10) != 0 || read::u32_at(head, 20) & !FLAG_CLOSED != 0 || counter != 0 {
            return Err(ImageError::Reserved);
        }
        let header = Header::decode(head);
        let (body, signature) = if signed {
            // The block itself is looked at here, whether its signature is good is another question.
            Signed::of(bytes).ok_or(ImageError::Reserved)?;
            body.split_last_chunk::<SIGNATURE_BYTES>().map_or((body, 0), |(body, _)| (body, SIGNATURE_BYTES))
        } else {
            (body, 0)
        };
        let (nodes, odd) = body.as_chunks::<NODE_BYTES>();
        if !odd.is_empty() || nodes.len() != header.node_count as usize {
            return Err(ImageError::Length {
                expected: image_bytes(header.node_count as usize).saturating_add(signature),
                found,
            });
        }
        Ok(Self { header, nodes, crc: stored })
    }

    /// Its head.
    pub const fn header(&self) -> &Header {
        &self.header
    }
    /// What the maker gave.
    pub const fn settings(&self) -> &ImageSettings {
        &self.header.settings
    }
    /// Its checksum, which also serves as its name.
    pub const fn crc(&self) -> u32 {
        self.crc
    }
    /// Number of nodes, at least 2.
    pub const fn len(&self) -> usize {
        self.nodes.len()
    }
    /// Whether it has no nodes; never, an image has at least two.
    pub const fn is_empty(&self) -> bool {
        self.nodes.is_empty()
    }
    /// The node at an index; a node at the origin without correction beyond the last.
    #[inline]
    pub fn node(&self, index: usize) -> Node {
        self.nodes.get(index).map(Node::decode).unwrap_or_default()
    }
    /// All nodes in the order of travel.
    pub fn nodes(&self) -> impl ExactSizeIterator<Item = Node> + 'a {
        self.nodes.iter().map(Node::decode)
    }
    /// The nodes from an index on as they are stored, to be decoded where they are needed; none beyond the last.
    #[inline]
    pub(crate) fn stored_from(&self, index: u32) -> &'a [[u8; NODE_BYTES]] {
        self.nodes.get(index as usize..).unwrap_or(&[])
    }
}
