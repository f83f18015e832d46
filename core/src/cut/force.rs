//! Force on the tool, in the frame of the wall normal n and the travel direction t.
//!
//! Per tooth and unit depth `dFt = Ktc·h + Kte`, `dFr = Krc·h + Kre` with the chip h = f·sin φ (P23 eq. 3 with edge
//! terms); P23 eq. (1) as printed is the force on the workpiece in one case only. The antiderivatives over the
//! immersion angle φ are tabulated once per set of coefficients; from them follow, exactly up to interpolation,
//! * the mean over a revolution, `N·b/2π · G(φ₁)`, and
//! * the force at the instant the wall at height z is generated, where a tooth at z stands at φ = 0 and every flute
//!   is a stretch of φ.
//!
//! Limits: rigid tooth spacing (no runout); chip thickness from the circular path; 0 ≤ φ₁ ≤ π.

use super::setup::{Coefficients, CutSetup, Milling};
use crate::units::{Offset, Real, pow, sin_cos};

/// Intervals of the table over 0…π. With cubic interpolation the error is below 10⁻⁹ of the coefficients.
const INTERVALS: usize = 256;

/// A force or its antiderivative, split by origin; N (or N/mm·rad) in the wall frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct SplitForce {
    /// Normal component that scales with the chip.
    pub chip_n: Real,
    /// Tangential component that scales with the chip.
    pub chip_t: Real,
    /// Normal component of the edge.
    pub edge_n: Real,
    /// Tangential component of the edge.
    pub edge_t: Real,
}

/// Antiderivatives of the force of one tooth over the immersion angle.
#[derive(Clone, Debug)]
pub struct ForceTable {
    sums: [SplitForce; INTERVALS + 1],
    density: [SplitForce; INTERVALS + 1],
    lag_per_mm: Real,
    pitch: Real,
    depth: Real,
    teeth: Real,
    milling: Milling,
}

impl SplitForce {
    fn zip(self, o: Self, f: impl Fn(Real, Real) -> Real) -> Self {
        Self {
            chip_n: f(self.chip_n, o.chip_n),
            chip_t: f(self.chip_t, o.chip_t),
            edge_n: f(self.edge_n, o.edge_n),
            edge_t: f(self.edge_t, o.edge_t),
        }
    }
    /// Sum.
    pub fn plus(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
    /// Difference.
    pub fn minus(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
    /// Times a number.
    pub fn scaled(self, factor: Real) -> Self {
        self.zip(self, |a, _| a * factor)
    }
    /// (normal, tangential) for a chip scale from [`Coefficients::chip_scale`].
    pub fn total(self, chip_scale: Real) -> (Real, Real) {
        (self.chip_n * chip_scale + self.edge_n, self.chip_t * chip_scale + self.edge_t)
    }
}

impl ForceTable {
    /// Tabulates the antiderivatives for a set of coefficients.
    pub fn new(setup: &CutSetup, coefficients: &Coefficients) -> Self {
        let step = Real::PI / Real::from_int(INTERVALS as i32);
        let mut sums = [SplitForce::default(); INTERVALS + 1];
        let mut density = [SplitForce::default(); INTERVALS + 1];
        let mut running = SplitForce::default();
        for (i, (sum, d)) in sums.iter_mut().zip(density.iter_mut()).enumerate() {
            let angle = Real::PI * Real::ratio(i as i64, INTERVALS as i64);
            *d = per_tooth(setup.milling, coefficients, angle);
            *sum = running;
            running = running.plus(cell(setup.milling, coefficients, angle, step));
        }
        Self {
            sums,
            density,
            lag_per_mm: setup.lag_per_mm(),
            pitch: setup.pitch(),
            depth: setup.axial_depth,
            teeth: Real::from_int(setup.teeth.into()),
            milling: setup.milling,
        }
    }

    /// ∫₀^φ of the force per unit depth, N/mm·rad; φ is limited to 0…π.
    pub fn antiderivative(&self, angle: Real) -> SplitForce {
        let x = angle.max(Real::ZERO).min(Real::PI) * Real::from_int(INTERVALS as i32) / Real::PI;
        let index = (x.floor().unsigned_abs() as usize).min(INTERVALS.saturating_sub(1));
        let u = x - Real::from_int(index as i32);
        let next = index.saturating_add(1);
        let (Some(&a), Some(&b), Some(&da), Some(&db)) =
            (self.sums.get(index), self.sums.get(next), self.density.get(index), self.density.get(next))
        else {
            return SplitForce::default();
        };
        // Cubic Hermite interpolation: the slope of the sum is the density.
        let h = Real::PI / Real::from_int(INTERVALS as i32);
        let v = Real::ONE - u;
        let (u2, v2) = (u * u, v * v);
        let (wa, wb) = (v2 * (Real::ONE + u + u), u2 * (Real::ONE + v + v));
        let (wda, wdb) = (h * u * v2, -(h * v * u2));
        a.scaled(wa).plus(b.scaled(wb)).plus(da.scaled(wda)).plus(db.scaled(wdb))
    }

    /// Mean force over a revolution with the arc 0…φ₁ engaged (physics: `A = N·b/2π`), N.
    pub fn mean(&self, engaged: Real) -> SplitForce {
        self.antiderivative(engaged).scaled(self.teeth * self.depth / Real::TAU)
    }

    /// Force at the instant the wall at a height (mm above the tip) is generated, N.
    ///
    /// In climb milling the tooth that generates height z has its upper part still in the stock, in conventional
    /// milling its lower part: the stretch of φ above φ = 0 is (b − z) or z high. The other flutes are whole pitches
    /// away.
    pub fn at_height(&self, engaged: Real, height: Real) -> SplitForce {
        let behind = match self.milling {
            Milling::Climb => self.depth - height,
            Milling::Conventional => height,
        };
        let top = behind * self.lag_per_mm;
        let bottom = top - self.depth * self.lag_per_mm;
        // Flutes whose stretch bottom+k·pitch … top+k·pitch meets 0…φ₁.
        let first = (top / self.pitch).floor().saturating_neg();
        let mut sum = SplitForce::default();
        let mut k = first;
        loop {
            let shift = self.pitch * Real::from_int(k as i32);
            let (low, high) = ((bottom + shift).max(Real::ZERO), (top + shift).min(engaged));
            if bottom + shift >= engaged || k > first.saturating_add(64) {
                return sum.scaled(Real::ONE / self.lag_per_mm);
            }
            if high > low {
                sum = sum.plus(self.antiderivative(high).minus(self.antiderivative(low)));
            }
            k = k.saturating_add(1);
        }
    }
}

/// Force of one tooth per unit depth at an immersion angle, chip part per unit of chip scale, on the tool.
fn per_tooth(milling: Milling, k: &Coefficients, angle: Real) -> SplitForce {
    let (sine, cosine) = sin_cos(angle);
    let chip = if k.size_exponent == Real::ZERO { sine } else { pow(sine, Real::ONE - k.size_exponent) };
    let part = |tangential: Real, radial: Real| match milling {
        Milling::Climb => {
            (-Real::dot(tangential, sine, radial, cosine), Real::dot(tangential, cosine, -radial, sine))
        }
        Milling::Conventional => {
            (Real::dot(tangential, sine, -radial, cosine), -Real::dot(tangential, cosine, radial, sine))
        }
    };
    let (chip_n, chip_t) = part(k.ktc * chip, k.krc * chip);
    let (edge_n, edge_t) = part(k.kte, k.kre);
    SplitForce { chip_n, chip_t, edge_n, edge_t }
}

/// Gauss–Legendre quadrature (three points) of [`per_tooth`] over one interval.
fn cell(milling: Milling, k: &Coefficients, from: Real, step: Real) -> SplitForce {
    /// √(3/5)/2
    const NODE: Real = Real::from_bits(1_663_433_681);
    let middle = from + step * Real::HALF;
    let at = |offset: Real| per_tooth(milling, k, middle + step * offset);
    let ends = at(-NODE).plus(at(NODE)).scaled(step * Real::ratio(5, 18));
    ends.plus(at(Real::ZERO).scaled(step * Real::ratio(8, 18)))
}

/// P23's analogue of the removal rate, b·f·(1 − cos φ₁), mm² per tooth.
pub fn chip_area(setup: &CutSetup, feed_per_tooth: Real, engaged: Real) -> Real {
    let (_, cosine) = sin_cos(engaged);
    setup.axial_depth * feed_per_tooth * (Real::ONE - cosine)
}

/// Volume removed per tooth, chip area × cutter radius, mm³.
pub fn chip_volume(setup: &CutSetup, feed_per_tooth: Real, engaged: Real) -> Real {
    chip_area(setup, feed_per_tooth, engaged) * radius_mm(setup.radius)
}

fn radius_mm(radius: Offset) -> Real {
    radius.mm()
}
