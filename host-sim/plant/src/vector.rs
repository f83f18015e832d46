//! Plane vectors as `[x, y]` in mm, N or plain numbers.
//!
//! Arrays instead of a type of their own, because positions cross the border of this module as arrays.

/// A place or a direction in the XY plane.
pub type Point = [f64; 2];

pub(super) fn add(a: Point, b: Point) -> Point {
    [a[0] + b[0], a[1] + b[1]]
}

pub(super) fn sub(a: Point, b: Point) -> Point {
    [a[0] - b[0], a[1] - b[1]]
}

pub(super) fn scaled(a: Point, k: f64) -> Point {
    [a[0] * k, a[1] * k]
}

/// `a + k·b`.
pub(super) fn along(a: Point, b: Point, k: f64) -> Point {
    [a[0] + b[0] * k, a[1] + b[1] * k]
}

pub(super) fn dot(a: Point, b: Point) -> f64 {
    a[0] * b[0] + a[1] * b[1]
}

/// z component of `a × b`; positive when `b` lies to the left of `a`.
pub(super) fn cross(a: Point, b: Point) -> f64 {
    a[0] * b[1] - a[1] * b[0]
}

pub(super) fn norm(a: Point) -> f64 {
    a[0].hypot(a[1])
}

pub(super) fn distance(a: Point, b: Point) -> f64 {
    norm(sub(a, b))
}

pub(super) fn squared_distance(a: Point, b: Point) -> f64 {
    let d = sub(a, b);
    dot(d, d)
}

/// Quarter turn to the left.
pub(super) fn left_of(a: Point) -> Point {
    [-a[1], a[0]]
}

pub(super) fn mix(a: Point, b: Point, u: f64) -> Point {
    [a[0] + (b[0] - a[0]) * u, a[1] + (b[1] - a[1]) * u]
}

pub(super) fn unit(a: Point) -> Point {
    let n = norm(a);
    [a[0] / n, a[1] / n]
}

pub(super) fn turned(a: Point, angle: f64) -> Point {
    let (s, c) = angle.sin_cos();
    [c * a[0] - s * a[1], s * a[0] + c * a[1]]
}

/// Signed angle from `a` to `b`, rad, positive to the left.
pub(super) fn turn(a: Point, b: Point) -> f64 {
    cross(a, b).atan2(dot(a, b))
}
