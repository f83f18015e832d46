//! Why an image is refused.

use core::fmt;

use serde::{Deserialize, Serialize};

use super::Field;

/// Why bytes are not an image, or why an image cannot be made. The sentence of each variant is the text shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ImageError {
    /// The buffer is too small for the image.
    Buffer {
        /// Bytes the image takes.
        needed: usize,
        /// Bytes lent.
        found: usize,
    },
    /// The file is cut off or has something behind its end.
    Length {
        /// Bytes the header names (or the least an image can have).
        expected: usize,
        /// Bytes there are.
        found: usize,
    },
    /// The file is not a correction image.
    Magic,
    /// The layout of the image is another one.
    Format {
        /// The number in the file.
        found: u16,
        /// The number this program reads.
        expected: u16,
    },
    /// The image was made for another meaning of its numbers.
    Semantics {
        /// The number in the file.
        found: u32,
        /// The number this program computes with.
        expected: u32,
    },
    /// The image is damaged.
    Checksum {
        /// CRC-32 in the file.
        stored: u32,
        /// CRC-32 of its bytes.
        computed: u32,
    },
    /// A reserved or unknown bit is set.
    Reserved,
    /// A value of the header is outside its range.
    Range {
        /// Name and unit of the value.
        name: Field,
        /// The value.
        value: i64,
        /// Least permitted.
        low: i64,
        /// Greatest permitted.
        high: i64,
    },
    /// The table of the chip factor falls or does not pass through 1 at the nominal feed.
    FactorTable {
        /// Index of the entry.
        entry: usize,
    },
    /// A node lies farther than 2.1 m from the first.
    NodeFar {
        /// Index of the node.
        node: usize,
    },
    /// Two neighbouring nodes are too close or too far apart.
    Spacing {
        /// Index of the first of the two.
        node: usize,
        /// Their distance, nm.
        found_nm: i64,
        /// Least permitted, nm.
        low_nm: i64,
        /// Greatest permitted, nm.
        high_nm: i64,
    },
    /// The stored length or reciprocal of a node does not belong to its neighbour.
    Derived {
        /// Index of the node.
        node: usize,
    },
    /// A correction is larger than the clamp.
    OverClamp {
        /// Index of the node.
        node: usize,
        /// The largest correction within the feed window, nm.
        correction_nm: i64,
        /// The clamp, nm.
        clamp_nm: i64,
    },
    /// A contour marked as closed does not end where it starts.
    NotClosed,
}

impl ImageError {
    /// A number that stays the same from version to version.
    pub const fn code(self) -> u16 {
        match self {
            Self::Buffer { .. } => 1,
            Self::Length { .. } => 2,
            Self::Magic => 3,
            Self::Format { .. } => 4,
            Self::Semantics { .. } => 5,
            Self::Checksum { .. } => 6,
            Self::Reserved => 7,
            Self::Range { .. } => 8,
            Self::FactorTable { .. } => 9,
            Self::NodeFar { .. } => 10,
            Self::Spacing { .. } => 11,
            Self::Derived { .. } => 12,
            Self::OverClamp { .. } => 13,
            Self::NotClosed => 14,
        }
    }
}

impl fmt::Display for ImageError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::Buffer { needed, found } => write!(f, "the image takes {needed} bytes, the buffer has {found}"),
            Self::Length { expected, found } => {
                write!(f, "the image should have {expected} bytes and has {found}: cut off or extended")
            }
            Self::Magic => f.write_str("not a correction image: the first eight bytes are not TRUEPATH"),
            Self::Format { found, expected } => {
                write!(f, "image format {found} cannot be read, only {expected}: make the image again")
            }
            Self::Semantics { found, expected } => write!(
                f,
                "the image was made for semantics {found}, this program computes with {expected}: make the image again"
            ),
            Self::Checksum { stored, computed } => {
                write!(f, "the image is damaged: CRC-32 {computed:08x}, stored {stored:08x}")
            }
            Self::Reserved => f.write_str("a reserved bit of the image is set"),
            Self::Range { name, value, low, high } => write!(f, "{name} is {value}, permitted {low} to {high}"),
            Self::FactorTable { entry } => write!(f, "entry {entry} of the chip factor table is wrong"),
            Self::NodeFar { node } => write!(f, "node {node} lies more than 2.1 m from the first"),
            Self::Spacing { node, found_nm, low_nm, high_nm } => write!(
                f,
                "nodes {node} and {} are {found_nm} nm apart, permitted {low_nm} to {high_nm} nm",
                node.saturating_add(1)
            ),
            Self::Derived { node } => write!(f, "length or reciprocal of node {node} does not fit its neighbour"),
            Self::OverClamp { node, correction_nm, clamp_nm } => write!(
                f,
                "the correction at node {node} reaches {correction_nm} nm within the feed window, the clamp is {clamp_nm} nm"
            ),
            Self::NotClosed => f.write_str("the contour is marked as closed but does not end where it starts"),
        }
    }
}

impl core::error::Error for ImageError {}
