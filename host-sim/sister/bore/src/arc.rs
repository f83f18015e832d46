//! The curve that one pass of one tooth leaves on the wall, seen from the crest of the pass.
//!
//! Tooth `i` is at `R·e(ω₁τ) + a·e(ω₂τ + β)` with `e(θ) = (sin θ, cos θ)` (Urinov 2020, eqs 2 and 6). With `u = ω₂τ + β − ω₁τ`,
//! the angle of the tooth against the direction of the cutter's centre, its polar radius and angle are
//!
//! `ρ(u) = √(R² + a² + 2Ra cos u)`,  `φ(u) = θ₀ + k·u + A(u)`,  `A(u) = atan2(a sin u, R + a cos u)`,  `k = ω₁/(ω₂ − ω₁)`,
//!
//! with `θ₀` the direction of the centre when the tooth points straight at the wall (`u = 0`, the crest, `ρ = R + a`). So one
//! curve serves all passes of teeth of one radius, `ρ` falls on either side of the crest, and since
//! `φ′ = k + a(a + R cos u)/ρ²` vanishes for at most one `cos u`, one turn of `u` has at most three pieces on which `φ` is
//! monotone. That is what makes "all roots" and "the whole envelope" certain instead of sampled.

use std::f64::consts::PI;

/// The curve of one pass. Lengths in mm, angles in rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Arc {
    /// Radius of the path of the cutter's centre, `R`.
    pub path: f64,
    /// Distance of the edge from the spindle axis, `a`.
    pub edge: f64,
    /// `k = ω₁/(ω₂ − ω₁)`: how far the centre moves while the tooth turns by one radian against it.
    pub advance: f64,
    /// Where `φ(u)` turns, `0 < u* ≤ π`; π when it does not.
    turn: f64,
    /// `φ(u*)`, the half width of the piece around the crest.
    half_width: f64,
}

impl Arc {
    /// The curve of an edge at `edge` mm from the spindle axis that goes round at `path` mm. Both positive and finite.
    pub fn new(path: f64, edge: f64, advance: f64) -> Self {
        // φ′ = 0: k(R² + a²) + a² + (2k + 1)·aR·cos u = 0.
        let cosine = -(advance * (path * path + edge * edge) + edge * edge) / ((2.0 * advance + 1.0) * path * edge);
        let turn = if cosine.abs() < 1.0 { cosine.acos() } else { PI };
        let mut arc = Self { path, edge, advance, turn, half_width: 0.0 };
        arc.half_width = arc.angle(turn);
        arc
    }
    /// Polar radius of the tooth, mm.
    pub fn radius(&self, u: f64) -> f64 {
        // (R + a)² − 4Ra sin²(u/2): no cancellation at the crest.
        let s = (u / 2.0).sin();
        let sum = self.path + self.edge;
        (sum * sum - 4.0 * self.path * self.edge * s * s).max(0.0).sqrt()
    }
    /// Polar angle of the tooth against that of the crest, rad.
    pub fn angle(&self, u: f64) -> f64 {
        self.advance * u + (self.edge * u.sin()).atan2(self.path + self.edge * u.cos())
    }
    /// `dφ/du`.
    pub fn turning(&self, u: f64) -> f64 {
        let rho = self.radius(u);
        self.advance + self.edge * (self.edge + self.path * u.cos()) / (rho * rho)
    }
    /// Where `φ(u)` turns back, rad in (0, π]; π when it does not.
    pub const fn turn(&self) -> f64 {
        self.turn
    }
    /// How far to either side of the crest the piece around it reaches, rad; not positive when the edge runs backwards
    /// at the crest, which is no cut.
    pub const fn half_width(&self) -> f64 {
        self.half_width
    }
    /// The `u` in `[from, to]`, on which φ is monotone and takes both sides of `angle`, where `φ(u) = angle`.
    /// `guess` is where the search begins. Newton's steps inside a bracket that every step shrinks; ends at machine precision.
    pub fn solve(&self, angle: f64, from: f64, to: f64, guess: f64) -> f64 {
        let rising = self.angle(to) >= self.angle(from);
        let (mut low, mut high) = (from, to);
        let mut u = if guess > from && guess < to { guess } else { 0.5 * (low + high) };
        // 100 bisections exhaust any f64 bracket; Newton needs about six steps.
        for _ in 0..100 {
            let miss = self.angle(u) - angle;
            if (miss < 0.0) == rising {
                low = u;
            } else {
                high = u;
            }
            let newton = u - miss / self.turning(u);
            let next = if newton > low.min(high) && newton < low.max(high) { newton } else { 0.5 * (low + high) };
            if (next - u).abs() <= 2.0 * f64::EPSILON * u.abs().max(1e-6) {
                return next;
            }
            u = next;
        }
        u
    }
    /// The tooth's angle `u` where the piece around the crest is `x` rad from it; `|x|` beyond its half width counts as there.
    pub fn at(&self, x: f64) -> f64 {
        if x == 0.0 || x.abs() >= self.half_width {
            return if x == 0.0 { 0.0 } else { self.turn.copysign(x) };
        }
        self.solve(x.abs(), 0.0, self.turn, x.abs() / self.turning(0.0)).copysign(x)
    }
    /// Wall radius `x` rad from the crest, mm, with its derivative, mm/rad.
    pub fn wall(&self, x: f64) -> (f64, f64) {
        let u = self.at(x);
        let radius = self.radius(u);
        (radius, -self.path * self.edge * u.sin() / radius / self.turning(u))
    }
    /// Depth of the wall `x` rad from the crest below the crest, mm: `R + a − ρ` without cancellation.
    pub fn below_crest(&self, x: f64) -> f64 {
        let u = self.at(x);
        let s = (u / 2.0).sin();
        4.0 * self.path * self.edge * s * s / (self.path + self.edge + self.radius(u))
    }
    /// A bound of the wall's second derivative within `x` rad of the crest, mm/rad²; infinite where there is none.
    pub fn curvature_bound(&self, x: f64) -> f64 {
        let u = self.at(x.abs());
        let slowest = self.turning(0.0).min(self.turning(u));
        let (radius, product) = (self.radius(u), self.path * self.edge);
        let sine = if u > PI / 2.0 { 1.0 } else { u.sin() };
        let first = product * sine / radius;
        let second = product / radius + first * first / radius;
        let bend = product * sine * (self.edge * self.edge - self.path * self.path).abs() / radius.powi(4);
        if slowest > 0.0 && radius > 0.0 {
            second / (slowest * slowest) + first * bend / slowest.powi(3)
        } else {
            f64::INFINITY
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_wall_is_symmetric_and_falls_from_the_crest() {
        let arc = Arc::new(80.0, 10.0, 1.0 / 99.0);
        assert_eq!(arc.wall(0.0).0, 90.0);
        let mut before = 90.0;
        for n in 1..=100 {
            let x = arc.half_width() * f64::from(n) / 100.0;
            let (radius, slope) = arc.wall(x);
            assert!(radius < before && (slope < 0.0 || n == 100), "{x}: {radius} {slope}");
            assert_eq!(arc.wall(-x).0, radius);
            assert!((90.0 - arc.below_crest(x) - radius).abs() < 1e-13);
            before = radius;
        }
    }

    #[test]
    fn derivatives_agree_with_differences_and_stay_within_the_bound() {
        for (path, edge, advance) in [(80.0, 10.0, 1.0 / 99.0), (80.0, 10.0, -1.0 / 101.0), (5.0, 10.0, 0.004)] {
            let arc = Arc::new(path, edge, advance);
            let (h, bound) = (1e-5, arc.curvature_bound(0.06));
            for n in -50..=50 {
                let x = f64::from(n) * 1e-3;
                let (low, at, high) = (arc.wall(x - h), arc.wall(x), arc.wall(x + h));
                assert!(((high.0 - low.0) / (2.0 * h) - at.1).abs() < 1e-4 * (1.0 + at.1.abs()), "{x}");
                assert!(((high.1 - low.1) / (2.0 * h)).abs() <= bound, "{x}: {bound}");
            }
        }
    }
}
