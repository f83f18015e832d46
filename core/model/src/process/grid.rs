//! The immersion angles at which engagement is looked at, and the force up to each of them.

use crate::cut::{Coefficients, ForceTable, Milling};
use truepath_units::{Real, sin_cos};

/// Cells between the angles.
pub(super) const CELLS: usize = 80;
/// Angles.
pub(super) const ANGLES: usize = CELLS + 1;
/// Even bins over 0…π that tell the cell of an angle.
const BINS: usize = 256;

/// Angles φ = π·(k/80)², so that they lie close together where thin stock is left, with sine and cosine.
#[derive(Clone, Debug)]
pub struct ImmersionGrid {
    pub(super) angle: [Real; ANGLES],
    pub(super) sine: [Real; ANGLES],
    pub(super) cosine: [Real; ANGLES],
    /// 1/(width of a cell), 1/rad.
    inverse: [Real; CELLS],
    /// The cell in which every even bin begins.
    bins: [u8; BINS + 1],
}

/// ∫₀^φ of the force of one tooth and unit depth over φ at every angle, (normal, in travel), N/mm·rad.
#[derive(Clone, Debug)]
pub(super) struct Cumulative([Force; ANGLES]);

/// A force (or its integral), normal and in travel, as bits of [`Real`]: plain sums of whole numbers, which is what most of the
/// work of a pass is.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Force {
    pub(super) normal: i64,
    pub(super) travel: i64,
}

/// A share of a number of any magnitude, both as bits of [`Real`], rounded down.
#[inline]
pub(super) const fn share_of(bits: i64, share: Real) -> i64 {
    ((bits as i128).saturating_mul(share.bits() as i128) >> Real::FRACTION_BITS) as i64
}

impl Force {
    #[inline]
    pub(super) const fn plus(self, other: Self) -> Self {
        let normal = self.normal.saturating_add(other.normal);
        Self { normal, travel: self.travel.saturating_add(other.travel) }
    }
    #[inline]
    pub(super) const fn minus(self, other: Self) -> Self {
        let normal = self.normal.saturating_sub(other.normal);
        Self { normal, travel: self.travel.saturating_sub(other.travel) }
    }
    #[inline]
    pub(super) const fn part(self, share: Real) -> Self {
        Self { normal: share_of(self.normal, share), travel: share_of(self.travel, share) }
    }
    /// Times a factor, as numbers.
    pub(super) fn scaled(self, factor: Real) -> (Real, Real) {
        (Real::from_bits(self.normal) * factor, Real::from_bits(self.travel) * factor)
    }
}

impl ImmersionGrid {
    /// The grid.
    pub fn new() -> Self {
        let mut grid = Self {
            angle: [Real::ZERO; ANGLES],
            sine: [Real::ZERO; ANGLES],
            cosine: [Real::ONE; ANGLES],
            inverse: [Real::ZERO; CELLS],
            bins: [0; BINS + 1],
        };
        let places = grid.angle.iter_mut().zip(grid.sine.iter_mut()).zip(grid.cosine.iter_mut());
        for (k, ((angle, sine), cosine)) in places.enumerate() {
            let k = k as i64;
            *angle = Real::PI * Real::ratio(k.saturating_mul(k), (CELLS * CELLS) as i64);
            (*sine, *cosine) = sin_cos(*angle);
        }
        for (inverse, ends) in grid.inverse.iter_mut().zip(grid.angle.windows(2)) {
            if let [a, b] = ends {
                *inverse = Real::ONE / (*b - *a);
            }
        }
        for (k, bin) in grid.bins.iter_mut().enumerate() {
            let begins = Real::PI * Real::ratio(k as i64, BINS as i64);
            *bin = grid.angle.partition_point(|a| *a <= begins).saturating_sub(1).min(CELLS.saturating_sub(1)) as u8;
        }
        grid
    }

    /// The cell of an angle (limited to 0…π) and how far into it it lies, 0…1.
    pub(super) fn locate(&self, angle: Real) -> (usize, Real) {
        const PER_RADIAN: Real = Real::from_int(BINS as i32).over(Real::PI);
        let angle = angle.max(Real::ZERO).min(Real::PI);
        let bin = ((share_of(angle.bits(), PER_RADIAN) >> Real::FRACTION_BITS).unsigned_abs() as usize).min(BINS);
        let mut cell = usize::from(self.bins.get(bin).copied().unwrap_or(0));
        while cell.saturating_add(1) < CELLS
            && self.angle.get(cell.saturating_add(1)).is_some_and(|next| *next <= angle)
        {
            cell = cell.saturating_add(1);
        }
        let (Some(begins), Some(inverse)) = (self.angle.get(cell), self.inverse.get(cell)) else {
            return (cell, Real::ZERO);
        };
        let share = Real::from_bits(share_of((angle - *begins).bits(), *inverse));
        (cell, share.max(Real::ZERO).min(Real::ONE))
    }
}

impl Default for ImmersionGrid {
    fn default() -> Self {
        Self::new()
    }
}

impl Cumulative {
    /// Of a cutter at a chip scale (see [`Coefficients::chip_scale`]).
    pub(super) fn new(
        grid: &ImmersionGrid,
        table: &ForceTable,
        (coefficients, milling): (&Coefficients, Milling),
        chip_scale: Real,
    ) -> Self {
        let mut sums = [Force::default(); ANGLES];
        for (sum, angle) in sums.iter_mut().zip(grid.angle) {
            let (normal, travel) = table.one_tooth(milling, coefficients, angle).total(chip_scale);
            *sum = Force { normal: normal.bits(), travel: travel.bits() };
        }
        Self(sums)
    }

    /// At an angle of the grid.
    #[inline]
    pub(super) fn at(&self, index: usize) -> Force {
        self.0.get(index).copied().unwrap_or_default()
    }

    /// Within a cell.
    #[inline]
    pub(super) fn within(&self, cell: usize, share: Real) -> Force {
        let (a, b) = (self.at(cell), self.at(cell.saturating_add(1)));
        a.plus(b.minus(a).part(share))
    }
}
