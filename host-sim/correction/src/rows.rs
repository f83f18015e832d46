//! A correction along its contour, one row for every sample: `correction.csv` and `wall.csv`.

use truepath_core::correct::{Profile, Target};
use truepath_core::cut::{Loop, Path, Sample};
use truepath_ground::units::mm;

use crate::correction::Correction;

/// One place of a correction.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct CorrectionRow {
    /// Arc length of the contour.
    pub s_mm: f64,
    /// Nominal centre.
    pub x_mm: f64,
    /// Nominal centre.
    pub y_mm: f64,
    /// The correction along x.
    pub dx_mm: f64,
    /// The correction along y.
    pub dy_mm: f64,
    /// Wall error of the target quantity without it; none where an outside corner leaves no wall.
    pub predicted_error_before_mm: Option<f64>,
    /// The same with it.
    pub predicted_error_after_mm: Option<f64>,
    /// One standard deviation of that.
    pub sigma_mm: Option<f64>,
    /// Nominal wall beside it; in `wall.csv`.
    #[serde(skip)]
    pub wall_x_mm: f64,
    /// Nominal wall beside it; in `wall.csv`.
    #[serde(skip)]
    pub wall_y_mm: f64,
}

/// A correction along the contour, one row for every sample.
pub fn correction_rows(machine: &Loop, correction: &Correction) -> Vec<CorrectionRow> {
    let path = machine.path;
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let aim = |p: &Profile, target: Target| p.on_wall.then(|| mm(p.aim(target, None)));
    let rows = samples.iter().enumerate().map(|(i, sample)| {
        let total = correction.nodes[i].total();
        let predicted = &correction.predicted[i];
        let wall = wall_mm(path, sample);
        CorrectionRow {
            s_mm: mm(sample.s),
            x_mm: sample.point.x.nm() as f64 / 1e6,
            y_mm: sample.point.y.nm() as f64 / 1e6,
            dx_mm: mm(total.x),
            dy_mm: mm(total.y),
            predicted_error_before_mm: aim(&predicted.before, correction.wanted.target),
            predicted_error_after_mm: aim(&predicted.after, correction.wanted.target),
            sigma_mm: predicted.after.on_wall.then(|| mm(correction.sigma[i])),
            wall_x_mm: wall[0],
            wall_y_mm: wall[1],
        }
    });
    rows.collect()
}

/// The nominal wall beside a sample, mm.
pub fn wall_mm(path: &Path, sample: &Sample) -> [f64; 2] {
    let wall = sample.point + sample.normal.times(path.setup().radius);
    [wall.x.nm() as f64 / 1e6, wall.y.nm() as f64 / 1e6]
}
