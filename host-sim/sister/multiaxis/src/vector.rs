//! Vectors of three numbers, as plain arrays: only what kinematics needs.

/// A point or a direction: x, y, z.
pub type Vector = [f64; 3];

/// a + b.
pub fn add(a: Vector, b: Vector) -> Vector {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}
/// a − b.
pub fn sub(a: Vector, b: Vector) -> Vector {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}
/// a·k.
pub fn scale(a: Vector, k: f64) -> Vector {
    [a[0] * k, a[1] * k, a[2] * k]
}
/// a + b·k.
pub fn add_scaled(a: Vector, b: Vector, k: f64) -> Vector {
    [a[0] + b[0] * k, a[1] + b[1] * k, a[2] + b[2] * k]
}
/// Scalar product.
pub fn dot(a: Vector, b: Vector) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
/// Vector product.
pub fn cross(a: Vector, b: Vector) -> Vector {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}
/// Length.
pub fn norm(a: Vector) -> f64 {
    dot(a, a).sqrt()
}
/// The unit vector of the same direction; `None` for a vector too short to have one.
pub fn unit(a: Vector) -> Option<Vector> {
    let length = norm(a);
    (length > f64::MIN_POSITIVE.sqrt()).then(|| scale(a, 1.0 / length))
}
/// Angle between two vectors, 0…π, exact near 0 and π too.
pub fn angle(a: Vector, b: Vector) -> f64 {
    norm(cross(a, b)).atan2(dot(a, b))
}
