//! Force on the tool, in the frame of the wall normal n and the travel direction t.
//!
//! Per tooth and unit depth `dFt = Ktc·h + Kte`, `dFr = Krc·h + Kre` with the chip h = f·sin φ (P23 eq. 3 with edge
//! terms); P23 eq. (1) as printed is the force on the workpiece in one case only. The antiderivatives over the
//! immersion angle φ are tabulated once per set of coefficients; from them follow, exactly up to interpolation,
//! * the mean over a revolution, `N·b/2π · G(φ₁)`, and
//! * the force at the instant the wall at height z is generated, where a tooth at z stands at φ = 0 and every flute
//!   is a stretch of φ.
//!
//! Limits: teeth that reach equally far, what runout changes is of [`super::Teeth`]; chip thickness from the circular path; 0 ≤ φ₁ ≤ π.

use super::setup::{Coefficients, CutSetup, Helix, MAX_FLUTES, Milling};
use truepath_units::{Real, pow, sin_cos};

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

/// Antiderivatives over the immersion angle of what the force of one tooth is made of. They depend on the size
/// exponent alone; the coefficients enter when a force is read off.
#[derive(Clone, Debug)]
pub struct ForceTable {
    sums: [Basis; INTERVALS + 1],
    density: [Basis; INTERVALS + 1],
    size_exponent: Real,
}

/// σ sin φ, σ cos φ, sin φ and cos φ with σ = sin^(1−m) φ, or their antiderivatives.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) struct Basis {
    pub(super) chip_sine: Real,
    pub(super) chip_cosine: Real,
    pub(super) sine: Real,
    pub(super) cosine: Real,
}

/// What of a flute is in the stock while the wall at a height is made.
#[derive(Clone, Copy, Debug)]
pub(super) struct Stretch {
    /// Pitches by which its immersion is ahead of that of the flute which makes the wall.
    pub(super) flute: i64,
    /// Least immersion, rad.
    pub(super) low: Real,
    /// Largest immersion, rad.
    pub(super) high: Real,
}

/// The sum over the flutes in the stock while the wall at a height is made: the same but for the flutes that the end of the
/// arc cuts off, as long as it lies between the same ends of flutes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Flutes {
    height: Real,
    /// The arc ends above this and at most at that, rad.
    arc: (Real, Real),
    /// The sum but for the antiderivative at the end of the arc.
    whole: Basis,
    /// How often that counts.
    cut_off: i32,
}

impl Flutes {
    /// Of no height yet.
    pub(super) const NONE: Self =
        Self { height: Real::ZERO, arc: (Real::MAX, Real::ZERO), whole: Basis::NOTHING, cut_off: 0 };
}

impl SplitForce {
    /// (normal, tangential) for a chip scale from [`Coefficients::chip_scale`].
    #[inline]
    pub fn total(self, chip_scale: Real) -> (Real, Real) {
        (self.chip_n * chip_scale + self.edge_n, self.chip_t * chip_scale + self.edge_t)
    }
    /// The sum of two.
    pub(super) fn plus(self, o: Self) -> Self {
        Self {
            chip_n: self.chip_n + o.chip_n,
            chip_t: self.chip_t + o.chip_t,
            edge_n: self.edge_n + o.edge_n,
            edge_t: self.edge_t + o.edge_t,
        }
    }
}

impl Basis {
    const NOTHING: Self = Self { chip_sine: Real::ZERO, chip_cosine: Real::ZERO, sine: Real::ZERO, cosine: Real::ZERO };

    #[inline]
    fn zip(self, o: Self, f: impl Fn(Real, Real) -> Real) -> Self {
        Self {
            chip_sine: f(self.chip_sine, o.chip_sine),
            chip_cosine: f(self.chip_cosine, o.chip_cosine),
            sine: f(self.sine, o.sine),
            cosine: f(self.cosine, o.cosine),
        }
    }
    #[inline]
    fn plus(self, other: Self) -> Self {
        self.zip(other, |a, b| a + b)
    }
    #[inline]
    fn minus(self, other: Self) -> Self {
        self.zip(other, |a, b| a - b)
    }
    #[inline]
    pub(super) fn scaled(self, factor: Real) -> Self {
        self.zip(self, |a, _| a * factor)
    }
    /// As far behind the middle of the arc as it is before it.
    fn mirrored(self) -> Self {
        Self { chip_cosine: -self.chip_cosine, cosine: -self.cosine, ..self }
    }
    fn at(size_exponent: Real, angle: Real) -> Self {
        let (sine, cosine) = sin_cos(angle);
        let chip = if size_exponent == Real::ZERO { sine } else { pow(sine, Real::ONE - size_exponent) };
        Self { chip_sine: chip * sine, chip_cosine: chip * cosine, sine, cosine }
    }
    /// The force in the wall frame on the tool (physics of P23 eq. 3; eq. 1 as printed is the force on the workpiece).
    #[inline]
    pub(super) fn force(self, milling: Milling, k: &Coefficients) -> SplitForce {
        let (chip_n, chip_t) = in_wall_frame(milling, (k.ktc, k.krc), (self.chip_sine, self.chip_cosine));
        let (edge_n, edge_t) = in_wall_frame(milling, (k.kte, k.kre), (self.sine, self.cosine));
        SplitForce { chip_n, chip_t, edge_n, edge_t }
    }
}

/// (normal, tangential) for a tangential and a radial coefficient.
#[inline]
fn in_wall_frame(milling: Milling, (tangential, radial): (Real, Real), (sine, cosine): (Real, Real)) -> (Real, Real) {
    match milling {
        Milling::Climb => (-Real::dot(tangential, sine, radial, cosine), Real::dot(tangential, cosine, -radial, sine)),
        Milling::Conventional => {
            (Real::dot(tangential, sine, -radial, cosine), -Real::dot(tangential, cosine, radial, sine))
        }
    }
}

impl ForceTable {
    /// An empty table, to be [tabulated](Self::tabulate) where it lies.
    pub const BLANK: Self = Self {
        sums: [Basis::NOTHING; INTERVALS + 1],
        density: [Basis::NOTHING; INTERVALS + 1],
        size_exponent: Real::ZERO,
    };

    /// Tabulates the antiderivatives for a size exponent (0…0.5).
    pub fn new(size_exponent: Real) -> Self {
        let mut table = Self::BLANK;
        table.tabulate(size_exponent);
        table
    }

    /// Makes it the table for another size exponent, in place: a table takes 16 KiB.
    #[inline(never)]
    pub fn tabulate(&mut self, size_exponent: Real) {
        // Behind the middle of the arc sines are those before it and cosines their opposites: half of the powers are enough.
        let step = Real::PI / Real::from_int(INTERVALS as i32);
        for near in 0..=INTERVALS / 2 {
            let far = INTERVALS.saturating_sub(near);
            let angle = Real::PI * Real::ratio(near as i64, INTERVALS as i64);
            let here = Basis::at(size_exponent, angle);
            for (at, density) in [(far, here.mirrored()), (near, here)] {
                if let Some(slot) = self.density.get_mut(at) {
                    *slot = density;
                }
            }
            if near < far {
                let cell = cell(size_exponent, angle, step);
                for (at, cell) in [(near.saturating_add(1), cell), (far, cell.mirrored())] {
                    if let Some(slot) = self.sums.get_mut(at) {
                        *slot = cell;
                    }
                }
            }
        }
        let mut running = Basis::NOTHING;
        if let Some(first) = self.sums.first_mut() {
            *first = running;
        }
        for sum in self.sums.iter_mut().skip(1) {
            running = running.plus(*sum);
            *sum = running;
        }
        self.size_exponent = size_exponent;
    }

    /// The size exponent it was made for.
    pub const fn size_exponent(&self) -> Real {
        self.size_exponent
    }

    /// The antiderivatives from 0 to an angle, which is limited to 0…π.
    fn antiderivative(&self, angle: Real) -> Basis {
        const PER_RADIAN: Real = Real::from_int(INTERVALS as i32).over(Real::PI);
        const INTERVAL: Real = Real::PI.over(Real::from_int(INTERVALS as i32));
        let x = angle.max(Real::ZERO).min(Real::PI) * PER_RADIAN;
        let index = (x.floor().unsigned_abs() as usize).min(INTERVALS.saturating_sub(1));
        let u = x - Real::from_int(index as i32);
        let next = index.saturating_add(1);
        let (Some(&a), Some(&b), Some(&da), Some(&db)) =
            (self.sums.get(index), self.sums.get(next), self.density.get(index), self.density.get(next))
        else {
            return Basis::default();
        };
        // Cubic Hermite interpolation: the slope of the sum is the density.
        let v = Real::ONE - u;
        let times = Real::times_within;
        let (u2, v2) = (times(u, u), times(v, v));
        let (wa, wb) = (times(v2, Real::ONE + u + u), times(u2, Real::ONE + v + v));
        let (wda, wdb) = (times(times(INTERVAL, u), v2), -times(times(INTERVAL, v), u2));
        // No sum of the table is above 4, no density and no weight above 1.
        let sum = |a: Real, b: Real, da: Real, db: Real| {
            let ends = times(a, wa).bits().wrapping_add(times(b, wb).bits());
            Real::from_bits(ends.wrapping_add(times(da, wda).bits()).wrapping_add(times(db, wdb).bits()))
        };
        Basis {
            chip_sine: sum(a.chip_sine, b.chip_sine, da.chip_sine, db.chip_sine),
            chip_cosine: sum(a.chip_cosine, b.chip_cosine, da.chip_cosine, db.chip_cosine),
            sine: sum(a.sine, b.sine, da.sine, db.sine),
            cosine: sum(a.cosine, b.cosine, da.cosine, db.cosine),
        }
    }

    /// ∫₀^φ of the force of one tooth over the immersion angle, for a unit of depth, N/mm·rad.
    pub(crate) fn one_tooth(&self, milling: Milling, coefficients: &Coefficients, angle: Real) -> SplitForce {
        self.antiderivative(angle).force(milling, coefficients)
    }

    /// Mean force over a revolution with the arc 0…φ₁ engaged, `N·b/2π · ∫₀^φ₁`, N.
    pub fn mean(&self, (setup, helix): (&CutSetup, &Helix), coefficients: &Coefficients, engaged: Real) -> SplitForce {
        self.antiderivative(engaged).scaled(helix.mm_in_mean).force(setup.milling, coefficients)
    }

    /// Force at the instant the wall at a height (mm above the tip) is generated, N.
    ///
    /// In climb milling the tooth that generates height z has its upper part still in the stock, in conventional
    /// milling its lower part: the stretch of φ above φ = 0 is (b − z) or z high. The other flutes are whole pitches
    /// away.
    pub fn at_height(
        &self,
        cutter: (&CutSetup, &Helix),
        coefficients: &Coefficients,
        engaged: Real,
        height: Real,
    ) -> SplitForce {
        let mut nothing = Flutes::NONE;
        self.at_height_again(cutter, coefficients, engaged, height, (&mut nothing, &mut None))
    }

    /// The same, from the sum that was made at the place before, and with the antiderivatives at the end of the arc, which are those of
    /// all heights of a place; of another table or cutter they are of no use.
    pub(super) fn at_height_again(
        &self,
        cutter: (&CutSetup, &Helix),
        coefficients: &Coefficients,
        engaged: Real,
        height: Real,
        (known, end): (&mut Flutes, &mut Option<Basis>),
    ) -> SplitForce {
        if engaged <= Real::ZERO {
            return SplitForce::default();
        }
        let (above, to) = known.arc;
        if known.height != height || engaged <= above || engaged > to {
            *known = self.summed(cutter, engaged, height);
        }
        let mut at_the_end = || *end.get_or_insert_with(|| self.antiderivative(engaged));
        let sum = match known.cut_off {
            0 => known.whole,
            1 => known.whole.plus(at_the_end()),
            // Exact: a whole number of times.
            times => known.whole.plus(at_the_end().scaled(Real::from_int(times))),
        };
        sum.scaled(cutter.1.mm_per_lag).force(cutter.0.milling, coefficients)
    }

    #[inline(never)]
    fn summed(&self, cutter: (&CutSetup, &Helix), engaged: Real, height: Real) -> Flutes {
        let mut sum = Flutes { height, arc: (Real::ZERO, Real::MAX), ..Flutes::NONE };
        for Stretch { low, high, .. } in flutes(cutter, height) {
            if low >= engaged {
                sum.arc.1 = sum.arc.1.min(low);
                break;
            }
            sum.arc.0 = sum.arc.0.max(low);
            // The antiderivative from 0 to 0 is nothing.
            let below = if low > Real::ZERO { self.antiderivative(low) } else { Basis::NOTHING };
            if high > engaged {
                sum.arc.1 = sum.arc.1.min(high);
                sum.cut_off = sum.cut_off.saturating_add(1);
                sum.whole = sum.whole.minus(below);
            } else if high > low.max(Real::ZERO) {
                sum.arc.0 = sum.arc.0.max(high);
                sum.whole = sum.whole.plus(self.antiderivative(high).minus(below));
            }
        }
        sum
    }
}

/// The flutes, from the first that may be in the stock on, while the wall at a height is made: the stretches
/// `bottom + k·pitch … top + k·pitch` of immersion.
fn flutes((setup, helix): (&CutSetup, &Helix), height: Real) -> impl Iterator<Item = Stretch> + use<> {
    let behind = match setup.milling {
        Milling::Climb => setup.axial_depth - height,
        Milling::Conventional => height,
    };
    let (lag, pitch) = (helix.lag_per_mm, helix.pitch);
    let top = behind * lag;
    let bottom = top - setup.axial_depth * lag;
    let first = (top / pitch).floor().saturating_neg();
    (first..first.saturating_add(MAX_FLUTES)).map(move |flute| {
        let shift = pitch * Real::from_int(flute as i32);
        Stretch { flute, low: bottom + shift, high: top + shift }
    })
}

/// What of the [`flutes`] is in the stock, 0…φ₁.
pub(super) fn stretches(
    cutter: (&CutSetup, &Helix),
    engaged: Real,
    height: Real,
) -> impl Iterator<Item = Stretch> + use<> {
    flutes(cutter, height)
        .take_while(move |flute| flute.low < engaged)
        .map(move |s| Stretch { low: s.low.max(Real::ZERO), high: s.high.min(engaged), ..s })
        .filter(|s| s.high > s.low)
}

/// Gauss–Legendre quadrature (three points) of the basis over one interval.
fn cell(size_exponent: Real, from: Real, step: Real) -> Basis {
    /// √(3/5)/2
    const NODE: Real = Real::from_bits(1_663_433_681);
    let middle = from + step * Real::HALF;
    let at = |offset: Real| Basis::at(size_exponent, middle + step * offset);
    let ends = at(-NODE).plus(at(NODE)).scaled(step * Real::ratio(5, 18));
    ends.plus(at(Real::ZERO).scaled(step * Real::ratio(8, 18)))
}

/// P23's analogue of the removal rate, b·f·(1 − cos φ₁), mm² per tooth.
pub fn chip_area(setup: &CutSetup, feed_per_tooth: Real, engaged: Real) -> Real {
    let (_, cosine) = sin_cos(engaged);
    setup.axial_depth * feed_per_tooth * (Real::ONE - cosine)
}
