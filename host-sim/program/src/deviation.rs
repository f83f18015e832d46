//! How far a written line or arc is from the samples it stands for.

use truepath_core::geometry::{Curve, Shape};

use super::vector::{cross, dot, length, minus};

/// The distance of a sample from a curve, nanometres.
pub(super) fn distance(sample: [i64; 2], curve: &Curve) -> f64 {
    // Relative to the start, so that large coordinates cost no digits.
    let origin = [curve.start().x.nm(), curve.start().y.nm()];
    let local = |x: i64, y: i64| [(x - origin[0]) as f64, (y - origin[1]) as f64];
    let p = local(sample[0], sample[1]);
    let b = local(curve.end().x.nm(), curve.end().y.nm());
    let ends = length(p).min(length(minus(p, b)));
    match curve.shape() {
        Shape::Line => {
            let u = (dot(p, b) / dot(b, b)).clamp(0.0, 1.0);
            length([p[0] - u * b[0], p[1] - u * b[1]])
        }
        Shape::Arc { centre, sweep } => {
            let c = local(centre.x.nm(), centre.y.nm());
            let (from, to, spoke) = (minus([0.0, 0.0], c), minus(b, c), minus(p, c));
            let sense = if sweep.bits() < 0 { -1.0 } else { 1.0 };
            let (after_start, before_end) = (sense * cross(from, spoke) >= 0.0, sense * cross(spoke, to) >= 0.0);
            let short = sense * cross(from, to) > 0.0;
            let beside = if b == [0.0, 0.0] {
                true
            } else if short {
                after_start && before_end
            } else {
                after_start || before_end
            };
            let radius = 0.5 * (length(from) + length(to));
            if beside { ends.min((length(spoke) - radius).abs()) } else { ends }
        }
    }
}

#[cfg(test)]
mod tests {
    use truepath_core::geometry::Point;

    use super::*;

    fn deviation(samples: &[[i64; 2]], curve: &Curve) -> f64 {
        samples.iter().map(|&sample| distance(sample, curve)).fold(0.0, f64::max)
    }

    const MM: i64 = 1_000_000;

    fn arc(end: (i64, i64), ccw: bool) -> Curve {
        Curve::arc(Point::from_nm(10 * MM, 0), Point::from_nm(end.0, end.1), Point::from_nm(0, 0), ccw).expect("an arc")
    }

    #[test]
    fn a_sample_beside_an_arc_is_measured_along_the_radius_and_beyond_it_from_its_end() {
        let quarter = arc((0, 10 * MM), true);
        assert_eq!(deviation(&[[0, 10 * MM + 700]], &quarter), 700.0);
        assert!((deviation(&[[8 * MM, 6 * MM + 500]], &quarter) - 300.0).abs() < 0.1);
        assert_eq!(deviation(&[[-3_000, 10 * MM]], &quarter), 3_000.0);
        let rest = arc((0, 10 * MM), false);
        assert!((deviation(&[[-8 * MM, -6 * MM - 500]], &rest) - 300.0).abs() < 0.1);
        assert!(deviation(&[[8 * MM, 6 * MM]], &rest) > 6e6);
    }
}
