//! The correction image: a correction array as bytes, as they lie in a file or in the flash of the device.
//!
//! An image is checked once, by [`Image::new_checked`]: magic, format, [`SEMANTICS`], length, CRC-32, every range of
//! the header, spacing of the nodes, the derived fields, and that no correction within the feed window exceeds the
//! clamp. After that no accessor can fail, so the servo cycle reads it without a branch for bad data.
//!
//! Layout: header ([`HEADER_BYTES`]), nodes ([`NODE_BYTES`] each), in a signed image its signature
//! ([`SIGNATURE_BYTES`]), CRC-32 (ISO-HDLC, 4 bytes) of everything before it. Little endian throughout. A CRC-32 notices every single flipped bit and every burst up to 32 bits.
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

mod block;
mod build;
mod check;
mod checked;
mod dump;
mod error;
mod feed_law;
mod field;
mod fine;
mod header;
mod node;
mod read;
mod rights;
mod signature;

pub use block::{Counted, DeviceClass, DeviceClasses, KeyId, SIGNATURE_BYTES, Signed};
pub use build::{build, peak};
pub use check::{DEVICE_NODES, MAX_CLAMP_NM, MAX_NODES, MAX_SPACING_NM, MIN_SPACING_NM};
pub use checked::{Image, image_bytes};
pub use dump::dump;
pub use error::ImageError;
pub use feed_law::{FACTOR_BITS, FACTOR_NODES, FACTOR_ONE, FeedLaw, RATIO_BITS, RATIO_ONE};
pub use field::Field;
pub use fine::FineOffset;
pub use header::{
    Binding, CorrectionLimits, FLAG_CLOSED, FORMAT, HEADER_BYTES, Header, ImageSettings, MAGIC, PathWindow, SEMANTICS,
    SIGNED_FORMAT,
};
pub use node::{ImageNode, NODE_BYTES, Node};
pub use rights::{Rights, Role};
pub use signature::{
    KeyRing, KeyRingError, MOST_KEYS, MOST_KEYS_EVER, PublicKey, SignatureError, sign, signed_bytes, verify,
};
pub use truepath_units::checksum::crc32;
