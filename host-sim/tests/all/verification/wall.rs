//! A wall with a known error, and the ball that meets it: geometry of its own, no code of the planner.

use truepath_core::geometry::Side;
use truepath_core::units::Offset;
use truepath_job::pass::Pass;
use truepath_trial::probing::{self, Xy};

/// Points of the wall as it is, 0.02 mm apart.
pub struct Wall {
    points: Vec<Xy>,
    /// Where it ends, Z.
    pub top: f64,
}

impl Wall {
    /// The wall of a pass with the error `error(s)`, positive where material is left, mm.
    pub fn of(pass: &Pass, error: impl Fn(f64) -> f64) -> Self {
        let contour = pass.path_contour();
        let radius = pass.core.setup.radius.nm() as f64 / 1e6;
        let length = contour.length().nm() as f64 / 1e6;
        let count = (length / 0.02) as i64;
        let points = (0..=count).map(|k| {
            let s = length * k as f64 / count as f64;
            let place = contour.at(Offset::from_nm((s * 1e6) as i64), 0).unwrap();
            let heading = [place.heading.x, place.heading.y].map(|v| v.bits() as f64 / 4_294_967_296.0);
            let n = match pass.core.setup.wall {
                Side::Left => [-heading[1], heading[0]],
                Side::Right => [heading[1], -heading[0]],
            };
            let centre = [place.point.x.nm() as f64 / 1e6, place.point.y.nm() as f64 / 1e6];
            let d = radius - error(s);
            [centre[0] + n[0] * d, centre[1] + n[1] * d]
        });
        let depth = pass.core.setup.axial_depth.bits() as f64 / 4_294_967_296.0;
        Self { points: points.collect(), top: pass.core.contour.z.nm() as f64 / 1e6 + depth }
    }

    /// The share of the way from `from` to `to` at which a ball of a radius meets the wall first.
    pub fn meets(&self, from: Xy, to: Xy, radius: f64) -> Option<f64> {
        let (dx, dy) = (to[0] - from[0], to[1] - from[1]);
        let a = dx * dx + dy * dy;
        let first = |w: &Xy| {
            let (px, py) = (from[0] - w[0], from[1] - w[1]);
            let c = px * px + py * py - radius * radius;
            if c <= 0.0 {
                return Some(0.0);
            }
            let b = px * dx + py * dy;
            let root = b * b - a * c;
            (a > 0.0 && root >= 0.0 && b < 0.0).then(|| (-b - root.sqrt()) / a).filter(|t| *t <= 1.0)
        };
        self.points.iter().filter_map(first).min_by(f64::total_cmp)
    }

    /// Distance of a point from the wall.
    pub fn distance(&self, p: Xy) -> f64 {
        self.points.iter().map(|w| (w[0] - p[0]).hypot(w[1] - p[1])).fold(f64::INFINITY, f64::min)
    }
}

impl probing::Wall for Wall {
    fn top(&self) -> f64 {
        self.top
    }
    fn meets(&mut self, _: f64, from: Xy, to: Xy, radius: f64) -> Option<f64> {
        Self::meets(self, from, to, radius)
    }
    fn distance(&mut self, _: f64, point: Xy) -> f64 {
        Self::distance(self, point)
    }
}
