//! The figures of a wall that is known at every height.

use truepath_core::cut::Path;
use truepath_core::process::Slices;
use truepath_core::units::Offset;
use truepath_ground::rows::p95;
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
    /// Where it is along the contour.
    pub worst_s_mm: f64,
    /// Its height above the tip as a share of the wall's.
    pub worst_fraction: f64,
    /// Which of the errors it is, counted place by place, all heights of a place side by side.
    #[serde(skip)]
    pub worst: usize,
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

/// The error at a height, a share of the wall's, mm: between the middles of the slices, and beyond the last of them as at it. `error` is
/// that of a slice.
pub fn at_height(slices: Slices, height: f64, error: impl Fn(usize) -> Option<f64>) -> Option<f64> {
    let last = slices.count() - 1;
    let at = (height * slices.count() as f64 - 0.5).clamp(0.0, last as f64);
    let (below, over) = (at as usize, at.fract());
    Some(error(below)? * (1.0 - over) + error((below + 1).min(last))? * over)
}

impl WallFigures {
    /// Of what is left, all slices of a sample side by side.
    pub fn of(path: &Path, slices: Slices, left: &[Offset]) -> Self {
        let count = slices.count();
        let column = |index: usize| left[index * count..(index + 1) * count].iter().map(|e| mm(*e)).collect();
        Self::over(judged(path).map(|(index, s)| (s, column(index))))
    }

    /// Of the errors at places along the contour, mm, each with its arc length and the errors over its height from the tip up, as
    /// many at every place.
    pub fn over(places: impl Iterator<Item = (f64, Vec<f64>)>) -> Self {
        let mut figures = Self::default();
        let mut all: Vec<f64> = Vec::new();
        for (s, column) in places {
            let count = column.len() as f64;
            let mean = column.iter().sum::<f64>() / count.max(1.0);
            figures.mean_mm = figures.mean_mm.max(mean.abs());
            for (k, error) in column.iter().enumerate() {
                figures.left_mm = figures.left_mm.max(*error);
                figures.gouge_mm = figures.gouge_mm.max(-*error);
                if error.abs() > figures.profile_mm {
                    figures.profile_mm = error.abs();
                    (figures.worst_s_mm, figures.worst_fraction) = (s, (k as f64 + 0.5) / count);
                    figures.worst = all.len();
                }
                all.push(error.abs());
            }
        }
        figures.p95_mm = p95(&mut all);
        figures
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
