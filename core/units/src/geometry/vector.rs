//! Points, displacements and directions of the XY plane.

use core::ops::{Add, Neg, Sub};

use crate::{Offset, Position, Real, hypot_nm, isqrt_rounded, shift_rounded_i63, sin_cos};

/// A place in the plane, nanometres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Point {
    /// First coordinate.
    pub x: Position,
    /// Second coordinate.
    pub y: Position,
}

/// A displacement in the plane, nanometres.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub struct Vector {
    /// First component.
    pub x: Offset,
    /// Second component.
    pub y: Offset,
}

/// A unit vector, components to 2⁻³².
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct Direction {
    /// First component, −1…1.
    pub x: Real,
    /// Second component, −1…1.
    pub y: Real,
}

/// Whether a length is below half a metre: two of its products with parts of a direction add up to less than 2⁶² steps of
/// 2⁻³² nm, which 64 bits hold.
#[inline]
const fn is_short(nm: i64) -> bool {
    nm.wrapping_add(1 << 29) as u64 >> 30 == 0
}

impl Point {
    /// From nanometres.
    #[inline]
    pub const fn from_nm(x: i64, y: i64) -> Self {
        Self { x: Position::from_nm(x), y: Position::from_nm(y) }
    }
    /// The displacement from `from` to here.
    #[inline]
    pub fn from(self, from: Self) -> Vector {
        Vector { x: self.x - from.x, y: self.y - from.y }
    }
    /// The distance to another point, rounded to the nanometre.
    #[inline]
    pub fn distance(self, other: Self) -> Offset {
        self.from(other).length()
    }
}

impl Add<Vector> for Point {
    type Output = Self;
    #[inline]
    fn add(self, by: Vector) -> Self {
        Self { x: self.x + by.x, y: self.y + by.y }
    }
}
impl Sub<Vector> for Point {
    type Output = Self;
    #[inline]
    fn sub(self, by: Vector) -> Self {
        Self { x: self.x - by.x, y: self.y - by.y }
    }
}
impl Add for Vector {
    type Output = Self;
    #[inline]
    fn add(self, by: Self) -> Self {
        Self { x: self.x + by.x, y: self.y + by.y }
    }
}
impl Sub for Vector {
    type Output = Self;
    #[inline]
    fn sub(self, by: Self) -> Self {
        Self { x: self.x - by.x, y: self.y - by.y }
    }
}
impl Neg for Vector {
    type Output = Self;
    #[inline]
    fn neg(self) -> Self {
        Self { x: -self.x, y: -self.y }
    }
}

impl Vector {
    /// No displacement.
    pub const ZERO: Self = Self { x: Offset::ZERO, y: Offset::ZERO };

    /// From nanometres.
    #[inline]
    pub const fn from_nm(x: i64, y: i64) -> Self {
        Self { x: Offset::from_nm(x), y: Offset::from_nm(y) }
    }
    /// Its length, rounded to the nanometre.
    #[inline]
    pub fn length(self) -> Offset {
        hypot_nm(self.x, self.y)
    }
    /// The square of its length, nm², exact.
    #[inline]
    pub const fn length_squared(self) -> u128 {
        let (x, y) = (self.x.nm().unsigned_abs() as u128, self.y.nm().unsigned_abs() as u128);
        x.saturating_mul(x).saturating_add(y.saturating_mul(y))
    }
    /// The scalar product with another displacement, nm², exact.
    #[inline]
    pub const fn dot(self, other: Self) -> i128 {
        // Two products of 63 bits.
        let p = (self.x.nm() as i128).wrapping_mul(other.x.nm() as i128);
        p.wrapping_add((self.y.nm() as i128).wrapping_mul(other.y.nm() as i128))
    }
    /// The vector product (z component) with another displacement, nm², exact.
    #[inline]
    pub const fn cross(self, other: Self) -> i128 {
        let p = (self.x.nm() as i128).wrapping_mul(other.y.nm() as i128);
        p.wrapping_sub((self.y.nm() as i128).wrapping_mul(other.x.nm() as i128))
    }
    /// Its component along a direction, rounded to the nanometre.
    #[inline]
    pub fn along(self, direction: Direction) -> Offset {
        let (x, y) = (self.x.nm(), self.y.nm());
        if is_short(x) && is_short(y) {
            let sum = x.wrapping_mul(direction.x.bits()).wrapping_add(y.wrapping_mul(direction.y.bits()));
            return Offset::from_nm(shift_rounded_i63(sum, Real::FRACTION_BITS));
        }
        self.x.blend(direction.x, self.y, direction.y)
    }
    /// Its components along a direction and to the right of it, each rounded to the nanometre.
    #[inline]
    pub fn along_and_right(self, direction: Direction) -> (Offset, Offset) {
        let (x, y) = (self.x.nm(), self.y.nm());
        if is_short(x) && is_short(y) {
            let part = |a: Real, b: Real| {
                let sum = x.wrapping_mul(a.bits()).wrapping_add(y.wrapping_mul(b.bits()));
                Offset::from_nm(shift_rounded_i63(sum, Real::FRACTION_BITS))
            };
            let right = direction.right();
            return (part(direction.x, direction.y), part(right.x, right.y));
        }
        (self.along(direction), self.along(direction.right()))
    }
    /// Times a number.
    #[inline]
    pub fn scaled(self, factor: Real) -> Self {
        Self { x: self.x.scaled(factor), y: self.y.scaled(factor) }
    }
    /// Its direction; `None` for the zero vector. Components are good to one step of 2⁻³².
    pub fn direction(self) -> Option<Direction> {
        let [x, y] = [self.x.nm().unsigned_abs(), self.y.nm().unsigned_abs()];
        // Scale up so that the length carries 60 significant bits.
        let shift = 60u32.saturating_sub(64u32.saturating_sub(x.max(y).leading_zeros()));
        let [x, y] = [x, y].map(|v| u128::from(v << shift));
        let length = isqrt_rounded(x.wrapping_mul(x).wrapping_add(y.wrapping_mul(y)));
        let part = |magnitude: u128, of: Offset| {
            let share = (magnitude << Real::FRACTION_BITS).wrapping_add(length >> 1).checked_div(length)? as i64;
            Some(Real::from_bits(if of < Offset::ZERO { share.wrapping_neg() } else { share }))
        };
        Some(Direction { x: part(x, self.x)?, y: part(y, self.y)? })
    }
    /// Turned by an angle with the given sine and cosine (counter-clockwise), each component rounded once.
    pub fn turned(self, sine: Real, cosine: Real) -> Self {
        Self { x: self.x.blend(cosine, self.y, -sine), y: self.x.blend(sine, self.y, cosine) }
    }
}

impl Direction {
    /// Along x.
    pub const X: Self = Self { x: Real::ONE, y: Real::ZERO };

    /// A quarter turn counter-clockwise (to the left).
    #[inline]
    pub fn left(self) -> Self {
        Self { x: -self.y, y: self.x }
    }
    /// A quarter turn clockwise (to the right).
    #[inline]
    pub fn right(self) -> Self {
        Self { x: self.y, y: -self.x }
    }
    /// The opposite direction.
    #[inline]
    pub fn reversed(self) -> Self {
        Self { x: -self.x, y: -self.y }
    }
    /// The displacement of the given length along this direction.
    #[inline]
    pub fn times(self, length: Offset) -> Vector {
        let nm = length.nm();
        if is_short(nm) {
            let part = |share: Real| shift_rounded_i63(nm.wrapping_mul(share.bits()), Real::FRACTION_BITS);
            return Vector::from_nm(part(self.x), part(self.y));
        }
        Vector { x: length.scaled(self.x), y: length.scaled(self.y) }
    }
    /// Scalar product, the cosine of the angle between.
    #[inline]
    pub fn dot(self, other: Self) -> Real {
        Real::dot(self.x, other.x, self.y, other.y)
    }
    /// Vector product, the sine of the turn from here to `other`.
    #[inline]
    pub fn cross(self, other: Self) -> Real {
        Real::dot(self.x, other.y, -self.y, other.x)
    }
    /// Turned counter-clockwise by an angle in radians.
    pub fn turned(self, angle: Real) -> Self {
        let (sine, cosine) = sin_cos(angle);
        self.turned_by(sine, cosine)
    }
    /// Turned counter-clockwise by an angle with the given sine and cosine.
    pub fn turned_by(self, sine: Real, cosine: Real) -> Self {
        Self { x: Real::dot(self.x, cosine, -self.y, sine), y: Real::dot(self.x, sine, self.y, cosine) }
    }
    /// The angle from here to `other`, −π…π, counter-clockwise positive.
    pub fn angle_to(self, other: Self) -> Real {
        crate::atan2(self.cross(other).bits(), self.dot(other).bits())
    }
}
