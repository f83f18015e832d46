//! Where a setpoint is, computed the plain way: floating point, every segment of the path looked at.

use truepath_core::image::Image;
use truepath_core::rewrite::{AXES, Frame};

/// A place in program coordinates: X and Y from the first node, Z from the upper end of the pass, nm.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Place {
    pub x: f64,
    pub y: f64,
    pub z: f64,
}

impl Place {
    /// Distance in X and Y.
    pub fn away(&self, from: &Self) -> f64 {
        (self.x - from.x).hypot(self.y - from.y)
    }
}

/// The path of an image.
#[derive(Clone, Debug)]
pub(super) struct Path {
    nodes: Vec<[f64; 2]>,
    /// Way from the first node.
    reached: Vec<f64>,
    origin: [i64; 2],
    level: i64,
}

/// What of the path is nearest.
#[derive(Clone, Copy, Debug)]
pub(super) struct Nearest {
    pub distance: f64,
    /// Way along the path to it.
    pub along: f64,
}

impl Path {
    pub fn of(image: &Image<'_>) -> Self {
        let origin = image.header().origin;
        let nodes: Vec<[f64; 2]> = image.nodes().map(|n| [f64::from(n.x), f64::from(n.y)]).collect();
        let mut way = 0.0;
        let mut reached = vec![0.0];
        for pair in nodes.windows(2) {
            way += (pair[1][0] - pair[0][0]).hypot(pair[1][1] - pair[0][1]);
            reached.push(way);
        }
        let level = image.settings().window.z_high.nm();
        Self { nodes, reached, origin: [origin.x.nm(), origin.y.nm()], level }
    }

    /// Of a setpoint by a frame.
    pub fn place(&self, frame: &Frame, axes: &[i64; AXES]) -> Place {
        const ONE: f64 = (1u64 << 30) as f64;
        let (c, s) = (f64::from(frame.cosine) / ONE, f64::from(frame.sine) / ONE);
        let [x0, y0] = self.origin.map(|nm| nm as f64);
        // Where the first node is on the axes, as seen from the offsets: only differences are large numbers.
        let first = [c * x0 - s * y0, s * x0 + c * y0, self.level as f64];
        let mut from_first = [0.0; 3];
        for (k, to) in from_first.iter_mut().enumerate() {
            let map = frame.axes[k];
            let read = axes.get(usize::from(map.axis)).copied().unwrap_or(0);
            let nm = (i128::from(read) - i128::from(frame.offset_nm[k])) as f64;
            *to = if map.reversed { -nm } else { nm } - first[k];
        }
        let [x, y, z] = from_first;
        Place { x: c * x + s * y, y: c * y - s * x, z }
    }

    /// Whether it has no corner: nowhere do two neighbouring segments turn by more than a tenth of a radian or so.
    pub fn is_smooth(&self) -> bool {
        self.nodes.windows(3).all(|three| {
            let [[ax, ay], [bx, by], [cx, cy]] = [three[0], three[1], three[2]];
            let (u, v) = ([bx - ax, by - ay], [cx - bx, cy - by]);
            (u[0] * v[1] - u[1] * v[0]).abs() < 0.1 * u[0].hypot(u[1]) * v[0].hypot(v[1])
        })
    }

    /// The nearest of the whole path.
    pub fn nearest(&self, at: &Place) -> Nearest {
        let mut best = Nearest { distance: f64::INFINITY, along: 0.0 };
        for (pair, reached) in self.nodes.windows(2).zip(&self.reached) {
            let ([ax, ay], [bx, by]) = (pair[0], pair[1]);
            let (ux, uy) = (bx - ax, by - ay);
            let length = ux.hypot(uy);
            let along = (((at.x - ax) * ux + (at.y - ay) * uy) / length).clamp(0.0, length);
            let distance = (at.x - ax - ux * along / length).hypot(at.y - ay - uy * along / length);
            if distance < best.distance {
                best = Nearest { distance, along: reached + along };
            }
        }
        best
    }
}

#[cfg(test)]
mod tests {
    use truepath_core::rewrite::AxisMap;

    use super::*;

    #[test]
    fn a_turned_mirrored_and_moved_frame_gives_program_coordinates_back() {
        let path = Path { nodes: vec![], reached: vec![], origin: [3_000_000, -2_000_000], level: 500 };
        let axes = [(4, true), (1, false), (0, true)].map(|(axis, reversed)| AxisMap { axis, reversed });
        let frame = Frame { offset_nm: [7, -9_000_000, 123], cosine: 858_993_459, sine: 644_245_094, axes, crc: 0 };
        let [a, b, c] = frame.machine_nm(3_100_000, -2_200_000, 400);
        let place = path.place(&frame, &[c, b, 0, 0, a, 0]);
        assert!((place.x - 100_000.0).abs() < 2.0 && (place.y + 200_000.0).abs() < 2.0, "{place:?}");
        assert!((place.z + 100.0).abs() < 1e-6);
    }

    #[test]
    fn the_nearest_of_a_path_is_found_on_any_segment() {
        let nodes = vec![[0.0, 0.0], [100.0, 0.0], [100.0, 100.0]];
        let path = Path { nodes, reached: vec![0.0, 100.0, 200.0], origin: [0, 0], level: 0 };
        let near = path.nearest(&Place { x: 103.0, y: 40.0, z: 9.0 });
        assert!((near.distance - 3.0).abs() < 1e-9 && (near.along - 140.0).abs() < 1e-9);
        let behind = path.nearest(&Place { x: -3.0, y: -4.0, z: 0.0 });
        assert!((behind.distance - 5.0).abs() < 1e-9 && behind.along == 0.0);
    }
}
