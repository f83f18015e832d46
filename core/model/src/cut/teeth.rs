//! Teeth that do not all reach equally far: what each of them cuts, and which of them makes the wall.
//!
//! An axis that is offset by ρ towards the angle λ lets tooth j reach `R_j = ρ cos(2πj/N − λ)` farther. It cuts what the
//! teeth before it have left (Kline & DeVor 1983; Altintas, *Manufacturing Automation*, ch. 2),
//! `h_j = max(0, min over k = 1…N of (k·f·sin φ + R_j − R_(j−k)))`, and has no edge force where that is nothing. Over sin φ
//! this is a concave chain of straight pieces, so that its antiderivatives over φ are closed forms. Every tooth passes the
//! wall at every height with the force of its own instant; the one that ends deepest makes it.
//!
//! Limits: the mean over a revolution is that of a cutter that runs true (while all teeth cut, their chips add up to the
//! same; a tooth that lifts off loses its edge force, which the mean keeps). The size effect of what runout adds to a
//! chip is that of a little more chip, its slope taken as falling evenly with sin φ. Of a chain of more than
//! [`PIECES`] pieces the thinnest chips are left out, where only the longest teeth cut.

use super::force::{Basis, Flutes, SplitForce, Stretch};
use super::setup::{Coefficients, CutSetup, MAX_TEETH, Milling};
use truepath_units::{Offset, Real, atan2, sin_cos};

/// Pieces of a chain that are kept, from the thickest chip down.
const PIECES: usize = 4;

/// What is kept of a cutter from place to place while walls are read, of one machine: the flutes at one height, and the
/// teeth, where they reach differently far, at one feed. 1.5 KB, not in the elastic loop.
#[derive(Clone, Debug)]
pub struct Teeth {
    /// The flutes in the stock at a height.
    pub(super) flutes: Flutes,
    /// The chip scale that they are made for; nothing yet.
    chip_scale: Option<Real>,
    /// What a little more chip adds to the force over what it would without size effect.
    weight: Weight,
    teeth: [Tooth; MAX_TEETH],
}

/// A tooth.
#[derive(Clone, Copy, Debug)]
struct Tooth {
    /// How much farther than the middle of the cutter it reaches, nm.
    reach: i32,
    /// What it cuts.
    pieces: [Piece; PIECES],
    /// What the flutes in the stock cut more than those of a cutter that runs true while this tooth makes the wall.
    more: More,
}

/// A stretch of sin φ over which the chip is `f·(times·sin φ + offset)`, from its lower end up to that of the piece before;
/// `times` = 0 where the chain is over. Numbers are [`Real`]s cut to 32 bits.
#[derive(Clone, Copy, Debug)]
struct Piece {
    /// Lower end: φ, sin φ and cos φ in units of 2⁻³⁰.
    angle: i32,
    sine: i32,
    cosine: i32,
    /// In units of 2⁻²⁶; at most 12.
    offset: i32,
    times: u8,
}

/// (1 − m)·sin^(−m) φ as `even − falling·sin φ`: 1 without a size exponent m.
#[derive(Clone, Copy, Debug)]
struct Weight {
    even: Real,
    falling: Real,
}

/// Antiderivatives of sin², sin·cos, sin and cos at an angle.
#[derive(Clone, Copy, Debug)]
struct Primitive {
    angle: Real,
    square: Real,
    product: Real,
    minus_cosine: Real,
    sine: Real,
}

/// An angle with its sine and cosine.
#[derive(Clone, Copy, Debug)]
struct Angle {
    angle: Real,
    sine: Real,
    cosine: Real,
}

/// Sums over the immersion, of which each pair belongs to a sine and a cosine.
#[derive(Clone, Copy, Debug)]
struct More {
    /// Chip that goes with the feed.
    chip: (Real, Real),
    /// Chip that a difference in reach makes, the same at every feed.
    reach: (Real, Real),
    /// Edge in contact.
    edge: (Real, Real),
}

/// Cuts a number below 2 to 32 bits, and one below 32.
const fn fine(value: Real) -> i32 {
    (value.bits() >> 2) as i32
}
const fn coarse(value: Real) -> i32 {
    (value.bits() >> 6) as i32
}
const fn from_fine(cut: i32) -> Real {
    Real::from_bits((cut as i64) << 2)
}

impl Primitive {
    fn at(angle: Real) -> Self {
        let (sine, cosine) = sin_cos(angle);
        Self::of(angle, sine, cosine)
    }
    fn of(angle: Real, sine: Real, cosine: Real) -> Self {
        let square = Real::dot(angle, Real::HALF, -(sine * Real::HALF), cosine);
        Self { angle, square, product: sine * sine * Real::HALF, minus_cosine: -cosine, sine }
    }
}

impl Angle {
    fn primitive(self) -> Primitive {
        Primitive::of(self.angle, self.sine, self.cosine)
    }
}

impl Weight {
    /// For a size exponent; within 0.05 from sin φ = 0.3 up, for exponents up to 0.2.
    const fn of(size_exponent: Real) -> Self {
        let less = Real::from_bits(Real::ONE.bits().saturating_sub(size_exponent.bits()));
        let falling = less.times(size_exponent).times(Real::ratio(3, 2));
        Self { even: Real::from_bits(less.bits().saturating_add(falling.bits())), falling }
    }
}

impl Piece {
    const NONE: Self = Self { angle: 0, sine: 0, cosine: 0, offset: 0, times: 0 };

    /// Its lower end on the way in and on the way out.
    fn ends(&self) -> (Angle, Angle) {
        let (angle, sine, cosine) = (from_fine(self.angle), from_fine(self.sine), from_fine(self.cosine));
        (Angle { angle, sine, cosine }, Angle { angle: Real::PI - angle, sine, cosine: -cosine })
    }
}

impl More {
    const NOTHING: Self = {
        const NONE: (Real, Real) = (Real::ZERO, Real::ZERO);
        Self { chip: NONE, reach: NONE, edge: NONE }
    };

    /// Adds what lies between two angles where the chip is `f·(times·sin φ + offset)`; out of contact for 0 `times`.
    fn add(&mut self, from: &Primitive, to: &Primitive, times: u8, (offset, weight): (Real, &Weight)) {
        let more = Real::from_int(i32::from(times).saturating_sub(1));
        let (sine, cosine) = (to.minus_cosine - from.minus_cosine, to.sine - from.sine);
        let (square, product) = (to.square - from.square, to.product - from.product);
        self.chip.0 += square * more;
        self.chip.1 += product * more;
        if times == 0 {
            self.edge.0 -= sine;
            self.edge.1 -= cosine;
        } else {
            self.reach.0 += Real::dot(sine, weight.even, -square, weight.falling) * offset;
            self.reach.1 += Real::dot(cosine, weight.even, -product, weight.falling) * offset;
        }
    }

    /// Adds another.
    fn join(&mut self, other: &Self) {
        let pair = |own: &mut (Real, Real), other: (Real, Real)| {
            own.0 += other.0;
            own.1 += other.1;
        };
        pair(&mut self.chip, other.chip);
        pair(&mut self.reach, other.reach);
        pair(&mut self.edge, other.edge);
    }

    /// The force of it, N for a basis in mm/rad.
    fn force(
        &self,
        milling: Milling,
        coefficients: &Coefficients,
        (mm_per_lag, chip_scale): (Real, Real),
    ) -> SplitForce {
        let basis = |chip: (Real, Real), edge: (Real, Real)| {
            let all = Basis { chip_sine: chip.0, chip_cosine: chip.1, sine: edge.0, cosine: edge.1 };
            all.scaled(mm_per_lag).force(milling, coefficients)
        };
        let own = basis(self.chip, self.edge);
        // What does not grow with the feed counts with the edges.
        let by_reach = basis(self.reach, (Real::ZERO, Real::ZERO)).total(chip_scale);
        SplitForce { edge_n: own.edge_n + by_reach.0, edge_t: own.edge_t + by_reach.1, ..own }
    }
}

impl Tooth {
    const BLANK: Self = Self { reach: 0, pieces: [Piece::NONE; PIECES], more: More::NOTHING };

    /// Sets its chain: of `count` chips that the teeth before it leave, over sin φ from 1 down, the least. The k-th has the
    /// slope k and is `offset(k)` at 0, in feeds per tooth.
    fn follow(&mut self, count: usize, offset: impl Fn(usize) -> Real) {
        self.pieces = [Piece::NONE; PIECES];
        let of = |k: usize| Real::from_int(i32::try_from(k).unwrap_or(i32::MAX));
        let thickest = |k: usize| (of(k) + offset(k), count.saturating_sub(k));
        let Some(mut times) = (1..=count).min_by_key(|k| thickest(*k)) else { return };
        let mut upper = Real::ONE;
        for (n, piece) in self.pieces.iter_mut().enumerate() {
            let own = offset(times);
            let mut lower = (-own / of(times)).max(Real::ZERO);
            if lower >= upper {
                return;
            }
            let mut next = None;
            for k in times.saturating_add(1)..=count {
                // A steeper one that crosses it is the lesser below.
                let crossing = ((own - offset(k)) / of(k.saturating_sub(times))).min(upper);
                if n.saturating_add(1) < PIECES && crossing > Real::ZERO && crossing >= lower {
                    (lower, next) = (crossing, Some(k));
                }
            }
            let cosine = Real::dot(Real::ONE, Real::ONE, -lower, lower).max(Real::ZERO).sqrt();
            *piece = Piece {
                angle: fine(atan2(lower.bits(), cosine.bits())),
                sine: fine(lower),
                cosine: fine(cosine),
                offset: coarse(own),
                times: u8::try_from(times).unwrap_or(u8::MAX),
            };
            let Some(k) = next else { return };
            (upper, times) = (lower, k);
        }
    }

    /// Adds to a sum what it cuts more between two angles within 0…π than a tooth of a cutter that runs true.
    fn cut(&self, low: &Primitive, high: &Primitive, weight: &Weight, sum: &mut More) {
        let mut between = |from: Angle, to: Angle, times: u8, offset: Real| {
            if high.angle.min(to.angle) > low.angle.max(from.angle) {
                // Of most pieces neither end lies between.
                let from = if low.angle > from.angle { *low } else { from.primitive() };
                let to = if high.angle < to.angle { *high } else { to.primitive() };
                sum.add(&from, &to, times, (offset, weight));
            }
        };
        // From the middle of the arc outwards on both sides; what is left at the ends is out of contact.
        let middle = Angle { angle: Real::FRAC_PI_2, sine: Real::ONE, cosine: Real::ZERO };
        let (mut inner, mut outer) = (middle, middle);
        for piece in self.pieces.iter().take_while(|piece| piece.times > 0) {
            let (before, behind) = piece.ends();
            let offset = Real::from_bits(i64::from(piece.offset) << 6);
            between(before, inner, piece.times, offset);
            between(outer, behind, piece.times, offset);
            (inner, outer) = (before, behind);
        }
        between(Angle { angle: Real::ZERO, sine: Real::ZERO, cosine: Real::ONE }, inner, 0, Real::ZERO);
        between(outer, Angle { angle: Real::PI, sine: Real::ZERO, cosine: -Real::ONE }, 0, Real::ZERO);
    }
}

impl Teeth {
    /// Teeth of no cutter yet.
    pub const BLANK: Self = Self {
        flutes: Flutes::NONE,
        chip_scale: None,
        weight: Weight::of(Real::ZERO),
        teeth: [Tooth::BLANK; MAX_TEETH],
    };

    /// Makes them those of a cutter at a chip scale.
    #[inline(never)]
    pub(super) fn set(&mut self, setup: &CutSetup, coefficients: &Coefficients, chip_scale: Real) {
        if self.chip_scale == Some(chip_scale) {
            return;
        }
        self.chip_scale = Some(chip_scale);
        self.weight = Weight::of(coefficients.size_exponent);
        let count = usize::from(setup.teeth).min(MAX_TEETH);
        let mut reaches = [0; MAX_TEETH];
        for (j, (reach, tooth)) in reaches.iter_mut().zip(&mut self.teeth).enumerate().take(count) {
            let own = setup.runout.reach(u8::try_from(j).unwrap_or(0), setup.teeth).nm();
            tooth.reach = i32::try_from(own).unwrap_or(0);
            *reach = tooth.reach;
        }
        let feed = coefficients.feed_of(chip_scale);
        for (j, tooth) in self.teeth.iter_mut().enumerate().take(count) {
            let offset = |k: usize| {
                let before = j.saturating_add(count).saturating_sub(k).checked_rem(count).unwrap_or(0);
                let [own, other] = [j, before].map(|tooth| reaches.get(tooth).copied().unwrap_or(0));
                Offset::from_nm(i64::from(own).saturating_sub(other.into())).mm() / feed
            };
            tooth.follow(count, offset);
        }
    }

    /// What the flutes in the stock, `stretches` with their immersions, cut more while each tooth makes the wall.
    pub(super) fn immerse(&mut self, setup: &CutSetup, stretches: impl Iterator<Item = Stretch>) {
        for tooth in &mut self.teeth {
            tooth.more = More::NOTHING;
        }
        let (count, weight) = (i64::from(setup.teeth), self.weight);
        for Stretch { flute, low, high } in stretches {
            let (low, high) = (Primitive::at(low), Primitive::at(high));
            for maker in 0..count {
                // In climb milling the flute that stands a pitch further into the stock comes next.
                let which = match setup.milling {
                    Milling::Climb => maker.saturating_add(flute),
                    Milling::Conventional => maker.saturating_sub(flute),
                };
                let which = which.checked_rem_euclid(count).and_then(|j| self.teeth.get(j as usize));
                let Some(cutting) = which else { continue };
                let mut more = More::NOTHING;
                cutting.cut(&low, &high, &weight, &mut more);
                if let Some(maker) = self.teeth.get_mut(maker as usize) {
                    maker.more.join(&more);
                }
            }
        }
    }

    /// The teeth with how far each reaches and what its wall feels more of force, N.
    pub(super) fn makers(
        &self,
        setup: &CutSetup,
        coefficients: &Coefficients,
        mm_per_lag: Real,
    ) -> impl Iterator<Item = (Offset, SplitForce)> {
        let scales = (mm_per_lag, self.chip_scale.unwrap_or_default());
        let teeth = self.teeth.iter().take(setup.teeth.into());
        teeth.map(move |tooth| {
            (Offset::from_nm(tooth.reach.into()), tooth.more.force(setup.milling, coefficients, scales))
        })
    }
}
