//! The wall that a process leaves, and what makes its error.

use truepath_core::cut::Path;
use truepath_core::process::Slices;
use truepath_core::units::Offset;
use truepath_ground::units::{float, mm};

/// What is judged of a wall, mm. Errors are positive where material is left.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize)]
pub struct WallFigures {
    /// The largest error anywhere on the wall, the sign aside: its profile error.
    pub profile_mm: f64,
    /// The most material left.
    pub left_mm: f64,
    /// The deepest cut, positive.
    pub gouge_mm: f64,
    /// 95 of 100 places are nearer to the nominal wall than this.
    pub p95_mm: f64,
    /// The largest mean over the height: what a shift in x and y cures.
    pub mean_mm: f64,
    /// At the worst place: the mean over the height.
    pub worst_mean_mm: f64,
    /// There: the lean of the wall from tip to top, which bending of the cutter makes, as the error at its ends.
    pub worst_tilt_mm: f64,
    /// There: what is left over the height beside both, which the helix makes.
    pub worst_height_mm: f64,
    /// Where it is along the contour.
    pub worst_s_mm: f64,
    /// Its height above the tip as a share of the wall's.
    pub worst_fraction: f64,
}

/// Where the wall of a contour counts: not within 6 mm, or 0.8 radii if that is more, of the ends of an open contour, where leads
/// decide; nor in the reach of a sharp inside corner, which no correction of a path cures.
pub fn judged(path: &Path) -> impl Iterator<Item = (usize, f64)> {
    let trim = if path.is_closed() { 0.0 } else { (0.8 * mm(path.setup().radius)).max(6.0) };
    let length = mm(path.length());
    let first = path.first();
    let samples = path.samples()[first..first + path.count()].iter().enumerate();
    samples.filter_map(move |(k, sample)| {
        let s = mm(sample.s);
        let counts = sample.on_wall && !sample.near_corner && s >= trim && s <= length - trim;
        counts.then_some((first + k, s))
    })
}

impl WallFigures {
    /// Of what is left, all slices of a sample side by side.
    pub fn of(path: &Path, slices: Slices, left: &[Offset]) -> Self {
        let count = slices.count();
        let mut figures = Self::default();
        let mut all: Vec<f64> = Vec::new();
        for (index, s) in judged(path) {
            let column: Vec<f64> = left[index * count..(index + 1) * count].iter().map(|e| mm(*e)).collect();
            let mean = column.iter().sum::<f64>() / count as f64;
            figures.mean_mm = figures.mean_mm.max(mean.abs());
            for (k, error) in column.iter().enumerate() {
                figures.left_mm = figures.left_mm.max(*error);
                figures.gouge_mm = figures.gouge_mm.max(-*error);
                if error.abs() > figures.profile_mm {
                    figures.profile_mm = error.abs();
                    (figures.worst_s_mm, figures.worst_fraction) = (s, (k as f64 + 0.5) / count as f64);
                    figures.split(&column, mean);
                }
                all.push(error.abs());
            }
        }
        let at = (all.len() * 95 / 100).min(all.len().saturating_sub(1));
        if !all.is_empty() {
            figures.p95_mm = *all.select_nth_unstable_by(at, f64::total_cmp).1;
        }
        figures
    }

    /// Splits the errors over the height at one place: mean, straight line, rest.
    fn split(&mut self, column: &[f64], mean: f64) {
        let count = column.len() as f64;
        let place = |k: usize| (2.0 * k as f64 + 1.0) / count - 1.0;
        let moment: f64 = column.iter().enumerate().map(|(k, e)| place(k) * (e - mean)).sum();
        let square: f64 = (0..column.len()).map(|k| place(k) * place(k)).sum();
        let tilt = if square > 0.0 { moment / square } else { 0.0 };
        let rest = column.iter().enumerate().map(|(k, e)| (e - mean - tilt * place(k)).abs());
        (self.worst_mean_mm, self.worst_tilt_mm) = (mean, tilt);
        self.worst_height_mm = rest.fold(0.0, f64::max);
    }
}

/// What is left of a wall, unrolled, mm.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct WallMap {
    /// Arc length of every place.
    pub s_mm: Vec<f64>,
    /// Middle of every slice above the tip of the program's pass.
    pub height_mm: Vec<f64>,
    /// Errors of every place, slice by slice.
    pub error_mm: Vec<Vec<f64>>,
}

impl WallMap {
    /// Of what is left, all slices of a sample side by side.
    pub fn of(path: &Path, slices: Slices, left: &[Offset]) -> Self {
        let count = slices.count();
        let thick = float(slices.thickness(path.setup().axial_depth));
        let mut map = Self { height_mm: (0..count).map(|k| (k as f64 + 0.5) * thick).collect(), ..Self::default() };
        for (index, s) in judged(path) {
            map.s_mm.push(s);
            map.error_mm.push(left[index * count..(index + 1) * count].iter().map(|e| mm(*e)).collect());
        }
        map
    }
}
