//! The end mill as a stepped cantilever: a shank and a fluted part of an equivalent diameter, clamped in the collet.
//!
//! LG03 takes the tip deflection of a uniform beam under a load at its tip, δ = PL³/3EI. Here the load lies where the
//! chip is: spread evenly over the engaged depth, and the deflection is known at every height. It follows from the
//! unit-load (Mohr) integral `w(x) = ∫₀ˣ (x − ξ) M(ξ)/EI(ξ) dξ`, x from the clamp (Gere & Timoshenko, *Mechanics of
//! Materials*, ch. 9). Between the clamp, the step, the ends of the load and x the integrand is a cubic, which two
//! Gauss points integrate exactly: the result is a closed form but for rounding.
//!
//! Limits: slender beam (Euler–Bernoulli, no shear: it would add 0.54·(d/L)², 6 % at a free length of 3 diameters), rigid clamp,
//! small deflection.

use truepath_ground::rows::ascending;

/// A clamped beam of two diameters.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Beam {
    length: f64,
    shank: f64,
    stiff: [f64; 2],
}

/// Where a load acts, in mm above the tip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Load {
    /// At one height.
    At(f64),
    /// Evenly between two heights, low and high.
    Spread(f64, f64),
}

/// Second moment of area of a round bar, mm⁴.
pub fn second_moment(diameter_mm: f64) -> f64 {
    std::f64::consts::PI / 64.0 * diameter_mm.powi(4)
}

impl Beam {
    /// A shank of `shank_mm` at the clamp and a fluted part to the free length `length_mm`, with their bending stiffnesses
    /// E·I in N·mm². `0 ≤ shank_mm ≤ length_mm`; stiffnesses above 0.
    pub const fn new(length_mm: f64, shank_mm: f64, stiff_n_mm2: [f64; 2]) -> Self {
        Self { length: length_mm, shank: shank_mm, stiff: stiff_n_mm2 }
    }

    /// Free length, mm.
    pub const fn length_mm(&self) -> f64 {
        self.length
    }

    /// Deflection in mm at a height above the tip (0 to the free length) under 1 N.
    pub fn deflection(&self, height_mm: f64, load: Load) -> f64 {
        let x = (self.length - height_mm).clamp(0.0, self.length);
        let (from, to) = match load {
            Load::At(h) => (self.length - h, self.length - h),
            Load::Spread(low, high) => (self.length - high, self.length - low),
        };
        let mut bounds = [0.0, self.shank, from, to, x];
        ascending(&mut bounds);
        let pieces = bounds.windows(2).filter(|w| w[1] > w[0] && w[0] < x && w[0] < to);
        pieces.map(|w| self.piece(w[0], w[1].min(x), x, [from, to])).sum()
    }

    /// Two Gauss points over a piece on which moment and stiffness have one form.
    fn piece(&self, a: f64, b: f64, x: f64, load: [f64; 2]) -> f64 {
        let (middle, half) = (f64::midpoint(a, b), 0.5 * (b - a));
        let stiff = if middle < self.shank { self.stiff[0] } else { self.stiff[1] };
        let at = |xi: f64| (x - xi) * moment(xi, load);
        let node = half / 3f64.sqrt();
        half * (at(middle - node) + at(middle + node)) / stiff
    }

    /// The mean over the engaged depth of the deflection under a load spread over it, mm/N.
    pub fn mean_over_depth(&self, depth_mm: f64) -> f64 {
        // The deflection is of fifth order in the height within the load: three Gauss points, and twice for the step.
        let halves = [(0.0, 0.5), (0.5, 1.0)];
        let nodes = [(-0.6f64.sqrt(), 5.0 / 18.0), (0.0, 8.0 / 18.0), (0.6f64.sqrt(), 5.0 / 18.0)];
        let load = Load::Spread(0.0, depth_mm);
        let at = |(a, b): (f64, f64), node: f64| depth_mm * (f64::midpoint(a, b) + 0.5 * (b - a) * node);
        let half =
            |part| nodes.iter().map(|(node, weight)| weight * self.deflection(at(part, *node), load)).sum::<f64>();
        halves.into_iter().map(half).sum::<f64>() / 2.0
    }
}

/// Bending moment at ξ from the clamp of 1 N between two places.
fn moment(xi: f64, [from, to]: [f64; 2]) -> f64 {
    if xi <= from {
        f64::midpoint(from, to) - xi
    } else if xi < to {
        0.5 * (to - xi).powi(2) / (to - from)
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const STIFF: f64 = 2.0e6;

    fn uniform(length: f64) -> Beam {
        Beam::new(length, 0.0, [STIFF, STIFF])
    }

    #[test]
    fn a_load_at_the_tip_of_a_uniform_beam_deflects_it_by_pl3_over_3ei() {
        for length in [12.0f64, 45.0, 60.0, 123.4] {
            let exact = length.powi(3) / (3.0 * STIFF);
            let found = uniform(length).deflection(0.0, Load::At(0.0));
            assert!((found / exact - 1.0).abs() < 1e-12, "{length}: {found} {exact}");
        }
    }

    #[test]
    fn a_load_at_mid_depth_moves_the_tip_by_u2_3_minus_u_over_2_of_the_tip_load() {
        let length = 60.0;
        let tip = uniform(length).deflection(0.0, Load::At(0.0));
        let mut seen = Vec::new();
        for depth in [10.0, 15.0, 20.0, 22.5] {
            let u = 1.0 - depth / (2.0 * length);
            let ratio = uniform(length).deflection(0.0, Load::At(depth / 2.0)) / tip;
            assert!((ratio / (u * u * (3.0 - u) / 2.0) - 1.0).abs() < 1e-12);
            // Spread over the depth the tip moves a little more than by its resultant at mid-depth: by less than 2 %.
            let spread = uniform(length).deflection(0.0, Load::Spread(0.0, depth)) / tip;
            assert!(spread > ratio && spread < 1.02 * ratio, "{depth}: {spread} {ratio}");
            seen.push(ratio);
        }
        // 0.88 at b/L = 1/6, 0.72 at 3/8.
        assert!((seen[0] - 0.8753).abs() < 1e-4 && (seen[3] - 0.7221).abs() < 1e-4, "{seen:?}");
    }

    #[test]
    fn a_spread_load_agrees_with_its_closed_form() {
        // q over the last b of L (superposition of two uniformly loaded cantilevers): tip deflection
        // q/24EI·(8·L³·b − 6·L²·b² + b⁴) by integrating q·(L−h)²·(2L+h)/6EI over h from 0 to b.
        let (length, depth) = (60.0f64, 18.0f64);
        let integral = |h: f64| {
            // ∫ (L−h)²(2L+h) dh = 2L³h − 3L²h²/2 + h⁴/4
            2.0 * length.powi(3) * h - 1.5 * length.powi(2) * h * h + h.powi(4) / 4.0
        };
        let exact = integral(depth) / depth / (6.0 * STIFF);
        let found = uniform(length).deflection(0.0, Load::Spread(0.0, depth));
        assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    }

    #[test]
    fn a_step_in_diameter_agrees_with_the_closed_form_of_two_cantilevers() {
        // Tip load: (L³ − l³)/3EI₁ + l³/3EI₂ with l the length of the fluted part (Gere & Timoshenko, ex. 9-13).
        let (length, fluted, stiff) = (60.0f64, 26.0f64, [5.0e6, 1.7e6]);
        let beam = Beam::new(length, length - fluted, stiff);
        let exact = (length.powi(3) - fluted.powi(3)) / (3.0 * stiff[0]) + fluted.powi(3) / (3.0 * stiff[1]);
        let found = beam.deflection(0.0, Load::At(0.0));
        assert!((found / exact - 1.0).abs() < 1e-12, "{found} {exact}");
    }

    #[test]
    fn influence_is_reciprocal_and_the_tip_moves_most() {
        let beam = Beam::new(50.0, 24.0, [4.0e6, 1.2e6]);
        for (a, b) in [(0.0, 10.0), (3.0, 30.0), (22.0, 40.0)] {
            let (ab, ba) = (beam.deflection(a, Load::At(b)), beam.deflection(b, Load::At(a)));
            assert!((ab / ba - 1.0).abs() < 1e-12);
        }
        let load = Load::Spread(0.0, 12.0);
        let along: Vec<f64> = (0..=50).map(|h| beam.deflection(f64::from(h), load)).collect();
        assert!(along.windows(2).all(|w| w[0] > w[1]) && along[50] == 0.0);
    }

    #[test]
    fn the_mean_over_the_depth_is_that_of_many_heights() {
        for shank in [0.0, 20.0, 43.0] {
            let beam = Beam::new(50.0, shank, [4.0e6, 1.2e6]);
            let many = 4000;
            let load = Load::Spread(0.0, 12.0);
            let at = |k| beam.deflection(12.0 * (f64::from(k) + 0.5) / f64::from(many), load);
            let mean: f64 = (0..many).map(at).sum::<f64>() / f64::from(many);
            let found = beam.mean_over_depth(12.0);
            // A step within the depth breaks the smoothness of the integrand.
            let limit = if shank > 38.0 { 1e-5 } else { 1e-7 };
            assert!((found / mean - 1.0).abs() < limit, "{shank}: {found} {mean}");
        }
    }

    /// Independent check: cubic Hermite elements with the consistent load, solved by elimination.
    fn by_finite_elements(length: f64, shank: f64, stiff: [f64; 2], depth: f64, elements: usize) -> Vec<f64> {
        let size = length / elements as f64;
        let n = 2 * (elements + 1);
        let mut k = vec![vec![0.0; n]; n];
        let mut f = vec![0.0; n];
        for e in 0..elements {
            let middle = (e as f64 + 0.5) * size;
            let ei = if middle < shank { stiff[0] } else { stiff[1] };
            let (s, l) = (ei / size.powi(3), size);
            let own = [
                [12.0, 6.0 * l, -12.0, 6.0 * l],
                [6.0 * l, 4.0 * l * l, -6.0 * l, 2.0 * l * l],
                [-12.0, -6.0 * l, 12.0, -6.0 * l],
                [6.0 * l, 2.0 * l * l, -6.0 * l, 4.0 * l * l],
            ];
            let q = if middle > length - depth { 1.0 / depth } else { 0.0 };
            let push = [q * l / 2.0, q * l * l / 12.0, q * l / 2.0, -q * l * l / 12.0];
            for i in 0..4 {
                f[2 * e + i] += push[i];
                for j in 0..4 {
                    k[2 * e + i][2 * e + j] += s * own[i][j];
                }
            }
        }
        // The clamp takes the first two unknowns out.
        for i in 2..n {
            let (above, below) = k.split_at_mut(i + 1);
            let pivot = &above[i];
            for (row, other) in (i + 1..n.min(i + 4)).zip(below) {
                let share = other[i] / pivot[i];
                other.iter_mut().zip(pivot).for_each(|(a, b)| *a -= share * b);
                f[row] -= share * f[i];
            }
        }
        let mut w = vec![0.0; n];
        for i in (2..n).rev() {
            let sum: f64 = (i + 1..n.min(i + 4)).map(|j| k[i][j] * w[j]).sum();
            w[i] = (f[i] - sum) / k[i][i];
        }
        w.iter().step_by(2).copied().collect()
    }

    #[test]
    fn a_stepped_beam_under_a_spread_load_agrees_with_finite_elements() {
        let (length, shank, stiff, depth) = (60.0, 36.0, [5.0e6, 1.7e6], 18.0);
        let beam = Beam::new(length, shank, stiff);
        let nodes = by_finite_elements(length, shank, stiff, depth, 60);
        for (k, w) in nodes.iter().enumerate().skip(1) {
            let found = beam.deflection(length - k as f64, Load::Spread(0.0, depth));
            assert!((found / w - 1.0).abs() < 1e-6, "{k}: {found} {w}");
        }
    }
}
