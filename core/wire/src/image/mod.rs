//! The correction image: a correction array as bytes, as they lie in a file or in the flash of the device.
//!
//! An image is checked once, by [`Image::new_checked`]: magic, format, [`SEMANTICS`], length, CRC-32, every range of
//! the header, spacing of the nodes, the derived fields, and that no correction within the feed window exceeds the
//! clamp. After that no accessor can fail, so the servo cycle reads it without a branch for bad data.
//!
//! Layout: header ([`HEADER_BYTES`]), nodes ([`NODE_BYTES`] each), CRC-32 (ISO-HDLC, 4 bytes) of everything before
//! it. Little endian throughout. A CRC-32 notices every single flipped bit and every burst up to 32 bits.
//!
//! Coordinates are program coordinates. Nodes stand along the nominal path in the order of travel, about 0.1 mm
//! apart; corners of the path are nodes. The path includes lead-in and lead-out if the correction should be full at
//! the first and last contact with the wall.
//!
//! ```
//! use truepath_units::geometry::Point;
//! use truepath_units::{Offset, Position, Real};
//! use truepath_wire::image::{
//!     Binding, CorrectionLimits, FeedLaw, FineOffset, Image, ImageNode, ImageSettings, PathWindow, build, image_bytes,
//! };
//!
//! let fine = |um| FineOffset::checked_from_offset(Offset::from_um(um)).unwrap();
//! let settings = ImageSettings {
//!     binding: Binding { program_crc: 0x1234_5678, feature: 1, pass: 1, tool: 3, tool_offset: 3, setup: 1 },
//!     closed: false,
//!     // 44 µm a tooth, six teeth, 1500 rpm; the feed may lie between a quarter and one and a half times that.
//!     feed: FeedLaw::new(fine(44), 6, 1_500_000, Real::ZERO, Real::ratio(1, 4), Real::ratio(3, 2)),
//!     limits: CorrectionLimits {
//!         clamp: Offset::from_um(500),
//!         warn: Offset::from_um(200),
//!         slew_nm_per_s: 20_000_000,
//!         acceleration_nm_per_s2: 1_000_000_000,
//!     },
//!     window: PathWindow {
//!         tolerance: Offset::from_um(200),
//!         z_low: Position::from_nm(-10_000_000),
//!         z_high: Position::from_nm(-10_000_000),
//!         gate_height: Offset::from_um(5_000),
//!     },
//!     node_step: Offset::from_um(100),
//! };
//! // Along X, 0.1 mm apart; everywhere 50 µm in Y.
//! let nodes: Vec<ImageNode> = (0..=100)
//!     .map(|i| ImageNode { point: Point::from_nm(i * 100_000, 0), chip: [fine(0), fine(50)], edge: [fine(0), fine(0)] })
//!     .collect();
//! let mut bytes = vec![0; image_bytes(nodes.len())];
//!
//! let image = build(&settings, &nodes, &mut bytes).unwrap();
//! assert_eq!((image.len(), image.settings().binding.tool), (101, 3));
//!
//! bytes[300] ^= 1;
//! assert!(Image::new_checked(&bytes).is_err());
//! ```

mod build;
mod check;
mod dump;
mod error;
mod feed_law;
mod field;
mod fine;
mod header;
mod node;
mod read;

pub use build::{build, image_bytes, peak};
pub(crate) use check::scaled;
pub use dump::dump;
pub use error::ImageError;
pub use feed_law::{FACTOR_BITS, FACTOR_NODES, FACTOR_ONE, FeedLaw, RATIO_BITS, RATIO_ONE};
pub use field::Field;
pub use fine::FineOffset;
pub use header::{Binding, CorrectionLimits, HEADER_BYTES, Header, ImageSettings, PathWindow};
pub use node::{ImageNode, NODE_BYTES, Node};
pub use truepath_units::checksum::crc32;

/// First bytes of an image.
pub const MAGIC: [u8; 8] = *b"TRUEPATH";
/// Layout of the bytes.
pub const FORMAT: u16 = 1;
/// Meaning of the numbers: raised whenever the same image and setpoints would give other bits.
/// 2: the walk along the path looks ahead once a tick, a joint limit is judged by the correction that is on.
/// 3: nothing is added for a cutter that does not turn at the gate, and the fade rests while the axes stand.
pub const SEMANTICS: u32 = 3;
/// Bit of the flags word: the path ends where it starts.
pub const FLAG_CLOSED: u32 = 1;
/// Shortest way between neighbouring nodes.
pub const MIN_SPACING_NM: i64 = 1_000;
/// Longest way between neighbouring nodes.
pub const MAX_SPACING_NM: i64 = 1_000_000;
/// Largest clamp; keeps every sum of corrections within 32 bits of 2⁻⁸ nm.
pub const MAX_CLAMP_NM: i64 = 4_000_000;
/// Most nodes of an image: 100 m of path at 0.1 mm.
pub const MAX_NODES: usize = 1 << 20;
/// Most nodes of an image that a coprocessor holds. A slot of its flash is three sectors of 128 KiB; less one flash
/// word for the commit and one for the head of the slot (32 bytes each) that is room for 12,276 nodes, rounded down
/// so that the head may grow. 1.2 m of path at 0.1 mm.
pub const DEVICE_NODES: usize = 12_000;
/// Bytes of the checksum at the end.
const CRC_BYTES: usize = 4;

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
        check::nodes(&image)?;
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
        let format = read::u16_at(head, 8);
        if format != FORMAT {
            return Err(ImageError::Format { found: format, expected: FORMAT });
        }
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
        if read::u16_at(head, 10) != 0 || read::u32_at(head, 20) & !FLAG_CLOSED != 0 || read::u32_at(head, 268) != 0 {
            return Err(ImageError::Reserved);
        }
        let header = Header::decode(head);
        let (nodes, odd) = body.as_chunks::<NODE_BYTES>();
        if !odd.is_empty() || nodes.len() != header.node_count as usize {
            return Err(ImageError::Length { expected: image_bytes(header.node_count as usize), found });
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
    /// Never: an image has at least two nodes.
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
}
