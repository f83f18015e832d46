//! The head of an image: what it belongs to, what it may do, how it is laid out.
//!
//! 288 bytes, little endian; places are listed in [`Header::encode`]. Lengths are nanometres unless said otherwise.

use serde::{Deserialize, Serialize};

use super::feed_law::FeedLaw;
use super::{FACTOR_NODES, FineOffset, read};
use truepath_units::geometry::Point;
use truepath_units::{Offset, Position};

/// First bytes of an image.
pub const MAGIC: [u8; 8] = *b"TRUEPATH";
/// Layout of the bytes.
pub const FORMAT: u16 = 1;
/// Layout of the bytes of a signed image: that of [`FORMAT`] with a block of [`SIGNATURE_BYTES`](super::SIGNATURE_BYTES)
/// between the nodes and the checksum. A program that knows only [`FORMAT`] refuses it by this number.
pub const SIGNED_FORMAT: u16 = 2;
/// Meaning of the numbers: raised whenever the same image and setpoints would give other bits.
/// 2: the walk along the path looks ahead once a tick, a joint limit is judged by the correction that is on.
/// 3: nothing is added for a cutter that does not turn at the gate, and the fade rests while the axes stand.
pub const SEMANTICS: u32 = 3;
/// Bit of the flags word: the path ends where it starts.
pub const FLAG_CLOSED: u32 = 1;
/// Where the [counter](super::Signed::counter) of a signed image lies; 0 in one without a signature.
pub(super) const COUNTER: usize = 268;
/// Bytes of the checksum at the end.
pub(super) const CRC_BYTES: usize = 4;
/// Bytes of the head; the nodes follow.
pub const HEADER_BYTES: usize = 288;

/// What an image belongs to. Arming compares every field with what the controller sends.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Binding {
    /// CRC-32 (ISO-HDLC) of the bytes of the original program.
    pub program_crc: u32,
    /// Number of the feature (finishing contour) in the program.
    pub feature: u32,
    /// Number of the pass of the feature.
    pub pass: u32,
    /// Tool number.
    pub tool: u32,
    /// Number of the tool offset in force, 0 for none.
    pub tool_offset: u32,
    /// Number of the setup (clamping) of the part.
    pub setup: u32,
}

/// What the correction may do at most, per machine axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct CorrectionLimits {
    /// Largest correction, above 0, at most 4 mm.
    pub clamp: Offset,
    /// Level that raises the warning flag, at most the clamp.
    pub warn: Offset,
    /// Largest speed of the correction, nm/s, 1 … 4 × 10⁹.
    pub slew_nm_per_s: u32,
    /// Largest acceleration of the correction, nm/s², 1 … 10¹².
    pub acceleration_nm_per_s2: u64,
}

/// Where setpoints are taken to belong to the feature.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct PathWindow {
    /// Greatest distance of a setpoint from the path (blending + wear + margin), 1 µm … 5 mm.
    pub tolerance: Offset,
    /// Lowest Z of the pass, program coordinates.
    pub z_low: Position,
    /// Highest Z of the pass, program coordinates.
    pub z_high: Position,
    /// How far above `z_high` the gate at the start of the feature reaches, 0 … 1 m.
    pub gate_height: Offset,
}

/// Everything about an image but its nodes, as its maker gives it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ImageSettings {
    /// What it belongs to.
    pub binding: Binding,
    /// Whether the path ends where it starts; the last node then repeats the place of the first.
    pub closed: bool,
    /// Nominal feed and chip factor.
    pub feed: FeedLaw,
    /// Limits of the correction.
    pub limits: CorrectionLimits,
    /// Limits of place.
    pub window: PathWindow,
    /// Nominal distance of nodes, for the record; true distances are 1 µm … 1 mm.
    pub node_step: Offset,
}

/// The decoded head.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Header {
    /// What the maker gave.
    pub settings: ImageSettings,
    /// Place of the first node, program coordinates; nodes are counted from it.
    pub origin: Point,
    /// Number of nodes.
    pub node_count: u32,
}

impl Header {
    /// Its bytes, with the length of the whole image.
    pub fn encode(&self, length: u32) -> [u8; HEADER_BYTES] {
        let s = &self.settings;
        let mut w = Writer { bytes: [0; HEADER_BYTES], at: 0 };
        w.put(&MAGIC); //                                              0
        w.put(&FORMAT.to_le_bytes()); //                               8
        w.put(&0u16.to_le_bytes()); //                                10 reserved
        w.u32(SEMANTICS); //                                          12
        w.u32(length); //                                             16
        w.u32(if s.closed { FLAG_CLOSED } else { 0 }); //             20
        w.u32(s.binding.program_crc); //                              24
        w.u32(s.binding.feature); //                                  28
        w.u32(s.binding.pass); //                                     32
        w.u32(s.binding.tool); //                                     36
        w.u32(s.binding.tool_offset); //                              40
        w.u32(s.binding.setup); //                                    44
        w.u32(s.feed.per_tooth.bits() as u32); //                     48, 2⁻⁸ nm
        w.u32(s.feed.teeth); //                                       52
        w.u32(s.feed.spindle_millirpm); //                            56
        w.u32(s.feed.size_exponent); //                               60, 2⁻¹⁶
        w.u32(s.feed.ratio_low); //                                   64, 2⁻¹⁶
        w.u32(s.feed.ratio_high); //                                  68, 2⁻¹⁶
        w.i64(s.limits.clamp.nm()); //                                72
        w.i64(s.limits.warn.nm()); //                                 80
        w.put(&s.limits.acceleration_nm_per_s2.to_le_bytes()); //     88
        w.u32(s.limits.slew_nm_per_s); //                             96
        w.u32(self.node_count); //                                   100
        w.i64(s.window.tolerance.nm()); //                           104
        w.i64(s.window.z_low.nm()); //                               112
        w.i64(s.window.z_high.nm()); //                              120
        w.u32(to_u32(s.window.gate_height)); //                      128
        w.u32(to_u32(s.node_step)); //                               132
        for entry in s.feed.factor {
            w.u32(entry); //                                         136 … 267, 2⁻²⁴
        }
        w.u32(0); //                                                 268 counter, see COUNTER
        w.i64(self.origin.x.nm()); //                                272
        w.i64(self.origin.y.nm()); //                                280
        w.bytes
    }

    /// Decodes the bytes written by [`Header::encode`], without judging them.
    pub fn decode(bytes: &[u8; HEADER_BYTES]) -> Self {
        let u32_at = |at| read::u32_at(bytes, at);
        let i64_at = |at| read::i64_at(bytes, at);
        let mut factor = [0; FACTOR_NODES];
        for (k, entry) in factor.iter_mut().enumerate() {
            *entry = u32_at(k.saturating_mul(4).saturating_add(136));
        }
        Self {
            settings: ImageSettings {
                binding: Binding {
                    program_crc: u32_at(24),
                    feature: u32_at(28),
                    pass: u32_at(32),
                    tool: u32_at(36),
                    tool_offset: u32_at(40),
                    setup: u32_at(44),
                },
                closed: u32_at(20) & FLAG_CLOSED != 0,
                feed: FeedLaw {
                    per_tooth: FineOffset::from_bits(u32_at(48) as i32),
                    teeth: u32_at(52),
                    spindle_millirpm: u32_at(56),
                    size_exponent: u32_at(60),
                    ratio_low: u32_at(64),
                    ratio_high: u32_at(68),
                    factor,
                },
                limits: CorrectionLimits {
                    clamp: Offset::from_nm(i64_at(72)),
                    warn: Offset::from_nm(i64_at(80)),
                    acceleration_nm_per_s2: read::u64_at(bytes, 88),
                    slew_nm_per_s: u32_at(96),
                },
                window: PathWindow {
                    tolerance: Offset::from_nm(i64_at(104)),
                    z_low: Position::from_nm(i64_at(112)),
                    z_high: Position::from_nm(i64_at(120)),
                    gate_height: Offset::from_nm(i64::from(u32_at(128))),
                },
                node_step: Offset::from_nm(i64::from(u32_at(132))),
            },
            origin: Point::from_nm(i64_at(272), i64_at(280)),
            node_count: u32_at(100),
        }
    }
}

/// A length that the check of the image holds below 2³² nm; anything else becomes a value which that check refuses.
fn to_u32(length: Offset) -> u32 {
    u32::try_from(length.nm()).unwrap_or(u32::MAX)
}

/// Numbers one after the other.
struct Writer {
    bytes: [u8; HEADER_BYTES],
    at: usize,
}

impl Writer {
    fn put(&mut self, field: &[u8]) {
        let end = self.at.saturating_add(field.len());
        if let Some(place) = self.bytes.get_mut(self.at..end) {
            place.copy_from_slice(field);
        }
        self.at = end;
    }
    fn u32(&mut self, value: u32) {
        self.put(&value.to_le_bytes());
    }
    fn i64(&mut self, value: i64) {
        self.put(&value.to_le_bytes());
    }
}
