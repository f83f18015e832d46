//! From program coordinates to machine axes.
//!
//! `axis[k] = offset[k] ± (R·p)[k]` for the program axes k = X, Y, Z: R turns the XY plane, the sign mirrors, the map
//! says which machine axis it is. Work offset, G52/G92 and tool offset are sums in `offset`; the unit is always the
//! nanometre. The controller sends the frame with its own checksum, and the checksum alone with every setpoint.

use serde::{Deserialize, Serialize};

use super::Refusal;
use crate::image::crc32;
use truepath_units::geometry::Point;
use truepath_units::{shift_rounded, shift_rounded_i63};

/// Axes of a setpoint.
pub const AXES: usize = 6;
/// Fraction bits of sine and cosine of a frame.
pub const TURN_BITS: u32 = 30;
/// Cosine 1.
pub const TURN_ONE: i32 = 1 << TURN_BITS;

/// The machine axis a program axis drives.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct AxisMap {
    /// Index of the axis in a setpoint, 0…5.
    pub axis: u8,
    /// Whether it counts the other way round.
    pub reversed: bool,
}

/// The transform, as the controller sends it.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub struct Frame {
    /// Machine coordinate of the program's origin on the axes of X, Y, Z, nm.
    pub offset_nm: [i64; 3],
    /// Cosine of the turn of the XY plane, counter-clockwise, units of 2⁻³⁰.
    pub cosine: i32,
    /// Sine of that turn.
    pub sine: i32,
    /// Axes of X, Y, Z.
    pub axes: [AxisMap; 3],
    /// CRC-32 of all of the above, see [`Frame::checksum`].
    pub crc: u32,
}

impl Frame {
    /// Program coordinates are machine coordinates.
    pub fn identity() -> Self {
        let axis = |axis| AxisMap { axis, reversed: false };
        let axes = [axis(0), axis(1), axis(2)];
        Self { offset_nm: [0; 3], cosine: TURN_ONE, sine: 0, axes, crc: 0 }.sealed()
    }

    /// The same with the right checksum.
    pub fn sealed(mut self) -> Self {
        self.crc = self.checksum();
        self
    }

    /// CRC-32 of offsets (3 × i64), cosine, sine (i32) and for each axis its index and 1 or 0 for reversed, little
    /// endian: 38 bytes.
    pub fn checksum(&self) -> u32 {
        let mut bytes = [0u8; 38];
        let (words, tail) = bytes.as_chunks_mut::<8>();
        for (to, offset) in words.iter_mut().zip(self.offset_nm) {
            *to = offset.to_le_bytes();
        }
        if let Some(to) = words.last_mut() {
            let turn = u64::from(self.cosine as u32) | (u64::from(self.sine as u32) << 32);
            *to = turn.to_le_bytes();
        }
        for (to, map) in tail.as_chunks_mut::<2>().0.iter_mut().zip(self.axes) {
            *to = [map.axis, u8::from(map.reversed)];
        }
        crc32(&bytes)
    }

    /// Machine coordinates of a point in program coordinates on the axes of X, Y, Z, nm, rounded once.
    pub fn machine_nm(&self, x: i64, y: i64, z: i64) -> [i64; 3] {
        let (c, s) = (i128::from(self.cosine), i128::from(self.sine));
        let turned = |a: i128, x: i64, b: i128, y: i64| {
            let sum = a.saturating_mul(x.into()).saturating_add(b.saturating_mul(y.into()));
            shift_rounded(sum, TURN_BITS) as i64
        };
        let [mx, my, mz] = self.axes;
        let [ox, oy, oz] = self.offset_nm;
        [
            ox.saturating_add(mx.signed(turned(c, x, s.saturating_neg(), y))),
            oy.saturating_add(my.signed(turned(s, x, c, y))),
            oz.saturating_add(mz.signed(z)),
        ]
    }

    /// Checked and prepared for the servo cycle. `origin` is the first node of the image, `level` the Z from which
    /// heights are counted, nm.
    ///
    /// # Errors
    /// The checksum is wrong, sine and cosine are not those of one angle, or the axes are not three different ones.
    pub(super) fn mapping(&self, origin: Point, level: i64) -> Result<Mapping, Refusal> {
        let computed = self.checksum();
        if computed != self.crc {
            return Err(Refusal::FrameDamaged { stored: self.crc, computed });
        }
        let (c, s) = (i64::from(self.cosine), i64::from(self.sine));
        let square = c.saturating_mul(c).saturating_add(s.saturating_mul(s));
        // 2⁻²⁷ of the length: 4 nm over half a metre, two steps of sine and cosine.
        if square.abs_diff(1 << (2 * TURN_BITS)) > 1 << (TURN_BITS + 4) {
            return Err(Refusal::FrameNotRigid { cosine: self.cosine, sine: self.sine });
        }
        let [x, y, z] = self.axes.map(|m| m.axis);
        if x == y || y == z || x == z || [x, y, z].iter().any(|&a| usize::from(a) >= AXES) {
            return Err(Refusal::FrameAxes { x, y, z });
        }
        // Within half the range, so that the difference to a setpoint cannot wrap to a small one.
        let anchor =
            self.machine_nm(origin.x.nm(), origin.y.nm(), level).map(|nm| nm.clamp(i64::MIN >> 1, i64::MAX >> 1));
        let [mx, my, mz] = self.axes;
        let signed = |map: AxisMap, value: i32| {
            if map.reversed { value.saturating_neg() } else { value }
        };
        Ok(Mapping {
            anchor,
            matrix: [
                [signed(mx, self.cosine), signed(my, self.sine)],
                [signed(mx, self.sine.saturating_neg()), signed(my, self.cosine)],
            ],
            plane: [mx.axis, my.axis],
            height: mz,
        })
    }
}

impl AxisMap {
    fn signed(self, value: i64) -> i64 {
        if self.reversed { value.saturating_neg() } else { value }
    }
}

/// A frame seen from the first node of an image, with the turn and the signs of X and Y in one matrix.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub(super) struct Mapping {
    /// Machine coordinates of the first node at the level of the image, within ±2⁶² nm.
    anchor: [i64; 3],
    /// Rows: program X, Y; columns: the machine axes of X, Y. Orthogonal, units of 2⁻³⁰.
    matrix: [[i32; 2]; 2],
    /// Indices of the machine axes of X and Y.
    plane: [u8; 2],
    height: AxisMap,
}

/// A setpoint in program coordinates: x and y from the first node of the image, z from its level, nm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub(super) struct Local {
    pub x: i32,
    pub y: i32,
    pub z: i32,
}

impl Mapping {
    /// The setpoint in program coordinates; `None` where a coordinate, of the machine or the program, is farther than
    /// 2.1 m from the first node at its level.
    #[inline(always)]
    pub fn local(&self, axes: &[i64; AXES]) -> Option<Local> {
        let [ax, ay, az] = self.anchor;
        let [mx, my] = self.plane.map(usize::from);
        let (x, y) = (axes.get(mx)?.wrapping_sub(ax), axes.get(my)?.wrapping_sub(ay));
        let z = axes.get(usize::from(self.height.axis))?.wrapping_sub(az);
        let [[xx, xy], [yx, yy]] = self.matrix;
        let (a, b) = (blend(x as i32, xx, y as i32, xy), blend(x as i32, yx, y as i32, yy));
        // One question for all: what is left of a coordinate above 32 bits, 0 when it fits them.
        let beyond = |nm: i64| (nm.wrapping_add(1 << 31) >> 32) as i32;
        if beyond(x) | beyond(y) | beyond(z) | beyond(a) | beyond(b) != 0 {
            return None;
        }
        let z = z as i32;
        Some(Local { x: a as i32, y: b as i32, z: if self.height.reversed { z.saturating_neg() } else { z } })
    }

    /// A correction in program coordinates on the machine axes of X and Y, the unit unchanged.
    #[inline(always)]
    pub fn machine(&self, x: i32, y: i32) -> (i32, i32) {
        let [[xx, xy], [yx, yy]] = self.matrix;
        // In range: corrections are below 2³⁰, turned below 2³¹.
        (blend(x, xx, y, yx) as i32, blend(x, xy, y, yy) as i32)
    }

    /// Indices of the machine axes of X and Y.
    #[inline]
    pub fn plane(&self) -> [usize; 2] {
        self.plane.map(usize::from)
    }
}

/// a·m + b·n with matrix entries, rounded once. In range: products below 2⁶¹, the sum below 2⁶².
#[inline(always)]
fn blend(a: i32, m: i32, b: i32, n: i32) -> i64 {
    let product = |v: i32, by: i32| i64::from(v).wrapping_mul(i64::from(by));
    shift_rounded_i63(product(a, m).wrapping_add(product(b, n)), TURN_BITS)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects, clippy::indexing_slicing, clippy::unwrap_used)]
    use super::*;

    #[test]
    fn machine_coordinates_go_back_to_program_coordinates() {
        // 3-4-5: a turn whose cosine 0.8 is not exact in binary.
        let axes = [(2, true), (0, false), (1, true)].map(|(axis, reversed)| AxisMap { axis, reversed });
        let frame =
            Frame { offset_nm: [1_000_003, -7, 55], cosine: 858_993_459, sine: 644_245_094, axes, crc: 0 }.sealed();
        let mapping = frame.mapping(Point::from_nm(5_000, -6_000), 11).unwrap();
        for (x, y, z) in [(0, 0, 0), (123_456_789, -98_765_432, -4), (-300_000_000, 1, 7)] {
            let [a, b, c] = frame.machine_nm(5_000 + x, -6_000 + y, z);
            let back = mapping.local(&[b, c, a, 9, 9, 9]).unwrap();
            let (bx, by) = (i64::from(back.x), i64::from(back.y));
            assert!((bx - x).abs() <= 2 && (by - y).abs() <= 2, "{back:?}");
            assert_eq!(i64::from(back.z), z - 11);
        }
        assert_eq!(mapping.plane(), [2, 0]);
    }

    #[test]
    fn a_frame_that_is_damaged_bent_or_short_of_an_axis_is_refused() {
        let good = Frame::identity();
        let origin = Point::from_nm(0, 0);
        assert!(good.mapping(origin, 0).is_ok());
        let damaged = Frame { sine: 1, ..good };
        assert!(matches!(damaged.mapping(origin, 0), Err(Refusal::FrameDamaged { .. })));
        let bent = Frame { sine: 1 << 20, ..good }.sealed();
        assert!(matches!(bent.mapping(origin, 0), Err(Refusal::FrameNotRigid { .. })));
    }

    #[test]
    fn no_two_of_x_y_and_z_may_be_one_axis_and_none_may_be_beyond_the_last() {
        let of = |axes: [u8; 3]| {
            let axes = axes.map(|axis| AxisMap { axis, reversed: false });
            Frame { axes, ..Frame::identity() }.sealed().mapping(Point::from_nm(0, 0), 0).map(|_| ())
        };
        for [x, y, z] in [[4, 4, 2], [0, 3, 3], [5, 1, 5], [1, 1, 1], [6, 1, 2], [0, 6, 2], [0, 1, 6], [0, 1, 255]] {
            assert_eq!(of([x, y, z]), Err(Refusal::FrameAxes { x, y, z }));
        }
        assert_eq!((of([5, 0, 3]), of([3, 5, 0])), (Ok(()), Ok(())));
    }

    #[test]
    fn sine_and_cosine_may_be_as_far_from_one_angle_as_stated_and_no_farther() {
        let of = |cosine, sine| Frame { cosine, sine, ..Frame::identity() }.sealed().mapping(Point::from_nm(0, 0), 0);
        // c² + s² is 2⁶⁰ + 2³⁴.
        assert!(of(TURN_ONE, 1 << 17).is_ok() && of(1 << 17, TURN_ONE).is_ok());
        for (cosine, sine) in [(TURN_ONE, (1 << 17) + 1), (TURN_ONE + 8, 100), (TURN_ONE - 9, 0), (0, 0)] {
            assert!(matches!(of(cosine, sine), Err(Refusal::FrameNotRigid { .. })), "{cosine} {sine}");
        }
    }

    #[test]
    fn a_setpoint_in_another_room_is_no_place() {
        let mapping = Frame::identity().mapping(Point::from_nm(0, 0), 0).unwrap();
        let (least, most) = (-(1i64 << 31), (1i64 << 31) - 1);
        assert!([least, most].iter().all(|&nm| mapping.local(&[nm, nm, nm, 0, 0, 0]).is_some()));
        // One coordinate alone, any two, and all of them, equally far or not.
        for far in [least - 1, most + 1, 1 << 40, i64::MIN, i64::MAX] {
            for beyond in 1..8 {
                let axes = [0, 1, 2, 3, 4, 5].map(|k| if beyond >> k & 1 == 1 { far } else { 0 });
                assert!(mapping.local(&axes).is_none(), "{axes:?}");
            }
        }
        assert!(mapping.local(&[0, 0, 0, i64::MAX, i64::MIN, 1 << 40]).is_some(), "other axes do not count");
    }

    #[test]
    fn a_setpoint_whose_program_coordinates_leave_their_range_is_no_place() {
        let (least, most) = (-(1i64 << 31), (1i64 << 31) - 1);
        let local = |cosine, sine, axes: [i64; 3]| {
            let frame = Frame { cosine, sine, ..Frame::identity() }.sealed();
            let [x, y, z] = axes;
            frame.mapping(Point::from_nm(0, 0), 0).unwrap().local(&[x, y, z, 0, 0, 0])
        };
        // Turned by an eighth, a corner of the machine's range lies beyond the program's, in X or in Y, alone or with Z.
        let eighth = 759_250_125;
        for z in [0, least - 1, most + 1] {
            for (x, y) in [(most, most), (least, least), (most, least), (least, most)] {
                assert!(local(eighth, eighth, [x, y, z]).is_none(), "{x} {y} {z}");
            }
        }
        assert!(local(eighth, eighth, [most / 2, most / 2, 0]).is_some());
        // A cosine above 1, as far as it may be, carries the ends of both over the ends of the range.
        assert!(local(TURN_ONE + 7, 0, [least, least, 0]).is_none());
        assert!(local(TURN_ONE + 7, 0, [least + 100, least + 100, 0]).is_some());
    }

    #[test]
    fn a_frame_whose_origin_is_at_an_end_of_the_range_has_no_place_at_the_other_end() {
        for (offset, axis) in [(i64::MAX, i64::MIN), (i64::MIN, i64::MAX)] {
            let frame = Frame { offset_nm: [offset; 3], ..Frame::identity() }.sealed();
            let mapping = frame.mapping(Point::from_nm(0, 0), 0).unwrap();
            assert!(mapping.local(&[axis; AXES]).is_none() && mapping.local(&[offset; AXES]).is_none());
        }
    }

    #[test]
    fn the_checksum_covers_every_value_of_a_frame() {
        let good = Frame::identity();
        let mut others = [good; 11];
        for k in 0..3 {
            others[k].offset_nm[k] = 1 << 40;
            others[3 + k].axes[k].axis ^= 4;
            others[6 + k].axes[k].reversed = true;
        }
        others[9].cosine ^= 1;
        others[10].sine = 1;
        for (k, frame) in others.iter().enumerate() {
            assert_ne!(frame.checksum(), good.crc, "{frame:?}");
            assert!(others[..k].iter().all(|other| other.checksum() != frame.checksum()), "{frame:?}");
        }
    }
}
