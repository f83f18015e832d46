//! Where on the nominal path a point near it belongs: the place whose normal line runs through the point.

use super::path::{FACET_RAD, Path};
use super::vector::{Point, dot, left_of, mix, scaled, squared_distance, sub, unit};

/// Nominal place and frame of a point near the path.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Place {
    /// Sample at or before the place.
    pub index: usize,
    /// Distance along the path, mm.
    pub s_mm: f64,
    /// Unit direction of travel.
    pub tangent: Point,
    /// Unit normal towards the wall.
    pub normal: Point,
}

impl Path {
    /// Nominal place of `point`, searched `window_mm` of path to either side of the sample `near`; place, heading and normal
    /// are interpolated between samples. The search does not pass a corner: the place stays on the leg of `near`, or a centre that
    /// the force pushes out of an inside corner would belong now to one leg, now to the other.
    pub fn place(&self, point: Point, near: usize, window_mm: f64) -> Place {
        let reach = (window_mm / self.step_mm).ceil() as usize;
        let near = near.min(self.len() - 1);
        let mut lo = near;
        while lo > 0 && near - lo < reach && !self.corner_between(lo - 1, lo) {
            lo -= 1;
        }
        let mut hi = near;
        while hi + 1 < self.len() && hi - near < reach && !self.corner_between(hi, hi + 1) {
            hi += 1;
        }
        let mut index = near;
        let mut best = f64::INFINITY;
        for k in lo..=hi {
            let d = squared_distance(self.centre[k], point);
            if d < best {
                (best, index) = (d, k);
            }
        }
        // How far the point lies ahead of a sample's normal line; it falls along the path, and its zero is the place. Unlike the
        // foot on the chord this is continuous from one pair of samples to the next, which the elastic loop needs.
        let ahead = |k: usize| dot(sub(point, self.centre[k]), self.tangent[k]);
        while index > lo && ahead(index) < 0.0 {
            index -= 1;
        }
        while index < hi && ahead(index + 1) >= 0.0 {
            index += 1;
        }
        let mut place =
            Place { index, s_mm: self.s_mm[index], tangent: self.tangent[index], normal: self.normal[index] };
        if index < hi && ahead(index) > 0.0 {
            let (here, next) = (ahead(index), ahead(index + 1));
            let u = here / (here - next);
            place.s_mm += (self.s_mm[index + 1] - self.s_mm[index]) * u;
            place.tangent = unit(mix(self.tangent[index], self.tangent[index + 1], u));
            place.normal = scaled(left_of(place.tangent), self.side.sign());
        }
        place
    }

    /// The heading jumps between two neighbouring samples.
    fn corner_between(&self, k: usize, next: usize) -> bool {
        dot(self.tangent[k], self.tangent[next]) <= FACET_RAD.cos()
    }
}

#[cfg(test)]
mod tests {
    use super::super::path::Side;
    use super::super::segment::Segment;
    use super::*;

    #[test]
    fn a_point_inside_an_arc_belongs_to_the_place_on_its_ray() {
        let arc = Segment::Arc { from: [5.0, 0.0], to: [0.0, 5.0], centre: [0.0, 0.0], ccw: true };
        let path = Path::new(&[arc], Side::Right, 0.1).expect("valid");
        for k in 1..200 {
            let angle = 1.5 * f64::from(k) / 200.0;
            let place = path.place([3.0 * angle.cos(), 3.0 * angle.sin()], path.index_at(5.0 * angle), 6.0);
            assert!((place.s_mm - 5.0 * angle).abs() < 1e-4, "{angle}: {}", place.s_mm);
            assert!((place.normal[0] - angle.cos()).abs() < 1e-4, "{angle}");
        }
    }

    #[test]
    fn the_place_stays_on_its_leg_of_an_inside_corner() {
        let legs =
            [Segment::Line { from: [0.0, 20.0], to: [0.0, 0.0] }, Segment::Line { from: [0.0, 0.0], to: [20.0, 0.0] }];
        let path = Path::new(&legs, Side::Right, 0.1).expect("valid");
        let before = path.place([0.5, 0.4], path.index_at(19.9), 6.0);
        let after = path.place([0.5, 0.4], path.index_at(20.1), 6.0);
        assert!((before.s_mm - 19.6).abs() < 1e-9 && before.normal == [-1.0, 0.0], "{before:?}");
        assert!((after.s_mm - 20.5).abs() < 1e-9 && after.normal[1] == -1.0, "{after:?}");
    }
}
