//! How good the wall is: the numbers by which a correction is judged.

use serde::Serialize;

use super::error::PlantError;
use super::mill::{Milled, mill};
use super::vector::Point;

/// Heights at which the wall is judged.
const HEIGHTS: usize = 10;

/// The ten heights at which a wall is judged, mid-points of equal bands, 0 tip … 1 top.
pub fn judged_levels() -> [f64; HEIGHTS] {
    std::array::from_fn(|k| (k as f64 + 0.5) / HEIGHTS as f64)
}

/// Wall error of a pass; the ends, max(6 mm, 0.8·r) each, are left out.
#[derive(Debug, Default, Clone, Copy, PartialEq, Serialize)]
pub struct Score {
    /// Largest absolute value of the mean over ten heights, mm.
    pub max_error_mm: f64,
    /// Root mean square of the mean over ten heights, mm.
    pub rms_error_mm: f64,
    /// Largest absolute value at any of the ten heights, mm.
    pub worst_height_mm: f64,
    /// What 95 of 100 errors at the ten heights are within, mm.
    pub p95_mm: f64,
    /// Deepest cut into the part, of the mean over ten heights, mm; negative when material is left everywhere.
    pub gouge_mm: f64,
    /// Largest difference between two heights at a place, mm: what no correction in X and Y can remove.
    pub axial_form_mm: f64,
}

/// The same contour cut without and with a correction.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Comparison {
    /// Nominal program.
    pub before: Score,
    /// Corrected program.
    pub after: Score,
    /// `before.max_error_mm / after.max_error_mm`.
    pub factor: f64,
}

/// What is left out at the ends of a contour when it is judged, mm.
pub fn judged_trim_mm(radius_mm: f64) -> f64 {
    (0.8 * radius_mm).max(6.0)
}

/// A judged wall.
#[derive(Debug, Default, Clone, PartialEq)]
pub struct Judged {
    /// The numbers.
    pub score: Score,
    /// (place along the contour, mean wall error over the ten heights), mm, where the score looks.
    pub mean_mm: Vec<(f64, f64)>,
}

impl Milled {
    /// Mean wall error over the ten heights at each nominal sample, mm; NaN where undefined.
    pub fn mean_errors(&self) -> Vec<f64> {
        mean_over(&self.wall_errors(&judged_levels()))
    }

    /// Judges the wall.
    pub fn score(&self) -> Score {
        self.judge().score
    }

    /// Judges the wall and keeps the errors that are judged.
    pub fn judge(&self) -> Judged {
        let errors = self.wall_errors(&judged_levels());
        let mean = mean_over(&errors);
        let trim = judged_trim_mm(self.cut.radius_mm);
        let (lo, hi) = (trim, self.path.length_mm - trim);
        let mut score = Score {
            max_error_mm: 0.0,
            rms_error_mm: 0.0,
            worst_height_mm: 0.0,
            p95_mm: 0.0,
            gouge_mm: f64::NEG_INFINITY,
            axial_form_mm: 0.0,
        };
        let (mut mean_mm, mut all) = (Vec::new(), Vec::new());
        for (i, &m) in mean.iter().enumerate() {
            let s = self.path.s_mm[i];
            if s <= lo || s >= hi || !m.is_finite() {
                continue;
            }
            score.max_error_mm = score.max_error_mm.max(m.abs());
            score.gouge_mm = score.gouge_mm.max(-m);
            mean_mm.push((s, m));
            let (mut least, mut most) = (f64::INFINITY, f64::NEG_INFINITY);
            for e in errors.iter().map(|row| row[i]).filter(|e| e.is_finite()) {
                score.worst_height_mm = score.worst_height_mm.max(e.abs());
                all.push(e.abs());
                least = least.min(e);
                most = most.max(e);
            }
            score.axial_form_mm = score.axial_form_mm.max(most - least);
        }
        if mean_mm.is_empty() {
            let none = f64::NAN;
            score = Score {
                max_error_mm: none,
                rms_error_mm: none,
                worst_height_mm: none,
                p95_mm: none,
                gouge_mm: none,
                axial_form_mm: none,
            };
        } else {
            let squares: f64 = mean_mm.iter().map(|(_, m)| m * m).sum();
            score.rms_error_mm = (squares / mean_mm.len() as f64).sqrt();
            score.p95_mm = p95(&mut all);
        }
        Judged { score, mean_mm }
    }

    /// Cuts the same contour on the same machine along `commanded` and compares.
    ///
    /// # Errors
    /// As [`mill`].
    pub fn compare(&self, commanded: &[Point]) -> Result<Comparison, PlantError> {
        let after = mill(&self.path, &self.cut, &self.machine, Some(commanded))?.score();
        let before = self.score();
        Ok(Comparison { before, after, factor: before.max_error_mm / after.max_error_mm.max(1e-9) })
    }
}

/// What 95 of 100 magnitudes are within; not a number of none. Their order is lost.
pub(crate) fn p95(magnitudes: &mut [f64]) -> f64 {
    let at = magnitudes.len() * 95 / 100;
    if magnitudes.is_empty() { f64::NAN } else { *magnitudes.select_nth_unstable_by(at, f64::total_cmp).1 }
}

/// Mean over the rows, undefined values left out.
fn mean_over(rows: &[Vec<f64>]) -> Vec<f64> {
    let n = rows.first().map_or(0, Vec::len);
    (0..n)
        .map(|i| {
            let values = rows.iter().map(|r| r[i]).filter(|e| e.is_finite());
            let (sum, count) = values.fold((0.0, 0.0), |(s, c), e| (s + e, c + 1.0));
            sum / count
        })
        .collect()
}
