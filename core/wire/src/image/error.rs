//! Why an image is refused.

use serde::{Deserialize, Serialize};

use super::Field;
use truepath_units::errors;

errors! {
    /// Why bytes are not an image, or why an image cannot be made. The sentence of each variant is the text shown.
    #[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
    pub enum ImageError {
        /// The buffer is too small for the image.
        Buffer {
            /// Bytes the image takes.
            needed: usize,
            /// Bytes lent.
            found: usize,
        } = "I001", "the image takes {needed} bytes, the buffer has {found}";
        /// The file is cut off or has something behind its end.
        Length {
            /// Bytes the header names (or the least an image can have).
            expected: usize,
            /// Bytes there are.
            found: usize,
        } = "I002", "the image should have {expected} bytes and has {found}: cut off or extended";
        /// The file is not a correction image.
        Magic = "I003", "not a correction image: the first eight bytes are not TRUEPATH";
        /// The layout of the image is another one.
        Format {
            /// The number in the file.
            found: u16,
            /// The number this program reads.
            expected: u16,
        } = "I004", "image format {found} cannot be read, only {expected}: make the image again";
        /// The image was made for another meaning of its numbers.
        Semantics {
            /// The number in the file.
            found: u32,
            /// The number this program computes with.
            expected: u32,
        } = "I005", "the image was made for semantics {found}, this program computes with {expected}: make the image again";
        /// The image is damaged.
        Checksum {
            /// CRC-32 in the file.
            stored: u32,
            /// CRC-32 of its bytes.
            computed: u32,
        } = "I006", "the image is damaged: CRC-32 {computed:08x}, stored {stored:08x}";
        /// A reserved or unknown bit is set.
        Reserved = "I007", "a reserved bit of the image is set";
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
        } = "I008", "{name} is {value}, permitted {low} to {high}";
        /// The table of the chip factor falls or does not pass through 1 at the nominal feed.
        FactorTable {
            /// Index of the entry.
            entry: usize,
        } = "I009", "entry {entry} of the chip factor table is wrong";
        /// A node lies farther than 2.1 m from the first.
        NodeFar {
            /// Index of the node.
            node: usize,
        } = "I010", "node {node} lies more than 2.1 m from the first";
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
        } = "I011",
            "nodes {node} and {next} are {found_nm} nm apart, permitted {low_nm} to {high_nm} nm",
                next = node.saturating_add(1);
        /// The stored length or reciprocal of a node does not belong to its neighbour.
        Derived {
            /// Index of the node.
            node: usize,
        } = "I012", "length or reciprocal of node {node} does not fit its neighbour";
        /// A correction is larger than the clamp.
        OverClamp {
            /// Index of the node.
            node: usize,
            /// The largest correction within the feed window, nm.
            correction_nm: i64,
            /// The clamp, nm.
            clamp_nm: i64,
        } = "I013",
            "the correction at node {node} reaches {correction_nm} nm within the feed window, the clamp is {clamp_nm} nm";
        /// A contour marked as closed does not end where it starts.
        NotClosed = "I014", "the contour is marked as closed but does not end where it starts";
    }
}

impl core::error::Error for ImageError {}
