//! The height of a part in slices.

use crate::error::{PlantError, require};

/// The wall of a part over the height, program coordinates.
#[derive(Debug, Clone, PartialEq)]
pub struct Heights {
    /// Z of its lower edge, mm.
    pub bottom_z_mm: f64,
    /// Z of its upper edge, mm.
    pub top_z_mm: f64,
    /// Z down to which there is stock, mm: at the lower edge, or below it where deeper runs pass under the wall.
    pub stock_from_z_mm: f64,
    /// Z at which a slice ends besides, mm: the tips of the runs, so that none ends within a slice.
    pub edges_z_mm: Vec<f64>,
    /// Slices over the whole height, 1…400; 30 are enough (`docs/plant.md`).
    pub slices: usize,
}

impl Heights {
    /// A wall cut from its lower edge, in 30 slices.
    pub fn of(bottom_z_mm: f64, top_z_mm: f64) -> Self {
        Self { bottom_z_mm, top_z_mm, stock_from_z_mm: bottom_z_mm, edges_z_mm: Vec::new(), slices: 30 }
    }
}

/// A slice.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Slice {
    pub(super) lower: f64,
    pub(super) upper: f64,
}

impl Slice {
    pub(super) fn middle(self) -> f64 {
        0.5 * (self.lower + self.upper)
    }

    #[cfg(test)]
    pub(super) fn thickness(self) -> f64 {
        self.upper - self.lower
    }

    /// What of it lies above `z`.
    pub(super) fn above(self, z: f64) -> Option<Self> {
        (self.upper > z + 1e-9).then_some(Self { lower: self.lower.max(z), ..self })
    }
}

/// Edges nearer to each other than this are one, mm.
const SAME_MM: f64 = 1e-6;

/// Slices below the wall, which only push, are this much thicker.
const BELOW: f64 = 3.0;
/// Slices at most.
const MOST: f64 = 2000.0;

/// Slices from the lowest to the highest.
pub(super) fn slices(heights: &Heights) -> Result<Vec<Slice>, PlantError> {
    let (bottom, top) = (heights.bottom_z_mm, heights.top_z_mm);
    require(top > bottom && top - bottom <= 500.0, "top_z_mm", top, "above the lower edge, by up to 500 mm")?;
    let count = heights.slices;
    require((1..=400).contains(&count), "slices", count as f64, "1 to 400")?;
    let deepest = heights.stock_from_z_mm;
    let deep = deepest <= bottom && bottom - deepest <= 500.0;
    require(deep, "stock_from_z_mm", deepest, "at the lower edge or up to 500 mm below it")?;
    let mut edges: Vec<f64> = heights.edges_z_mm.iter().copied().filter(|z| *z > deepest && *z < top).collect();
    edges.extend([deepest, bottom, top]);
    edges.sort_unstable_by(f64::total_cmp);
    edges.dedup_by(|b, a| *b - *a < SAME_MM);
    let thickest = (top - bottom) / count as f64;
    let thickest = |lower: f64| if lower < bottom - SAME_MM { BELOW * thickest } else { thickest };
    let pieces: f64 = edges.windows(2).map(|band| ((band[1] - band[0]) / thickest(band[0])).ceil()).sum();
    require(pieces <= MOST, "stock_from_z_mm", deepest, "a height that 2000 slices fill")?;
    let bands = edges.windows(2).flat_map(|band| {
        let (lower, height) = (band[0], band[1] - band[0]);
        let pieces = (height / thickest(lower) - 1e-9).ceil().max(1.0);
        (0..pieces as usize).map(move |k| Slice {
            lower: lower + height * k as f64 / pieces,
            upper: lower + height * (k + 1) as f64 / pieces,
        })
    });
    Ok(bands.collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn slices_fill_the_height_and_end_at_every_tip() {
        let heights = Heights { edges_z_mm: vec![-11.0, -40.0, -15.0], slices: 10, ..Heights::of(-15.0, -5.0) };
        let all = slices(&heights).expect("a height");
        assert_eq!((all[0].lower, all[all.len() - 1].upper), (-15.0, -5.0));
        assert!(all.windows(2).all(|w| w[0].upper == w[1].lower));
        assert!(all.iter().all(|s| s.thickness() <= 1.0 + 1e-9));
        assert!(all.iter().any(|s| (s.upper + 11.0).abs() < 1e-9));
        assert!(slices(&Heights::of(-5.0, -5.0)).is_err());
        let below = slices(&Heights { stock_from_z_mm: -19.5, ..heights.clone() }).expect("a height");
        assert_eq!((below[0].lower, below[0].upper), (-19.5, -17.25));
        assert!(below.iter().any(|s| s.lower == -15.0));
        assert!(slices(&Heights { stock_from_z_mm: -12.0, ..heights }).is_err());
    }

    #[test]
    fn a_slice_under_the_tip_is_not_cut_and_one_across_it_in_part() {
        let slice = Slice { lower: 1.0, upper: 2.0 };
        assert_eq!(slice.above(2.0), None);
        assert_eq!(slice.above(1.25).map(Slice::thickness), Some(0.75));
        assert_eq!(slice.above(0.0), Some(slice));
    }
}
