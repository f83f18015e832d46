//! Tables of `compare`: one line a law, and the wall of every law along the contour.

use truepath_ground::diagnostics::Failure;
use truepath_ground::table::table;
use truepath_ground::units::rounded;
use truepath_trial::compare::{Row, Walls};

/// `compare.csv`.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn compare_csv(laws: &[Row]) -> Result<Vec<u8>, Failure> {
    let short = |v: Option<f64>| v.map(|v| rounded(v, 6));
    table(laws.iter().map(|row| Row {
        max_error_mm: short(row.max_error_mm),
        rms_error_mm: short(row.rms_error_mm),
        worst_height_mm: short(row.worst_height_mm),
        gouge_mm: short(row.gouge_mm),
        factor: row.factor.map(|f| rounded(f, 2)),
        ..row.clone()
    }))
}

/// One place of one law. `error_mm` is that of the target quantity, the other two are over the engaged depth.
#[derive(serde::Serialize)]
struct WallRow<'a> {
    law: &'a str,
    s_mm: f64,
    error_mm: Option<f64>,
    lowest_mm: Option<f64>,
    highest_mm: Option<f64>,
}

/// `walls.csv`: every law after the other.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn walls_csv(walls: &[(&str, &Walls)]) -> Result<Vec<u8>, Failure> {
    let known = |v: f64| v.is_finite().then(|| rounded(v, 6));
    table(walls.iter().flat_map(|(law, walls)| {
        walls.places.iter().map(move |p| WallRow {
            law,
            s_mm: rounded(p.s_mm, 6),
            error_mm: known(p.error_mm),
            lowest_mm: known(p.lowest_mm),
            highest_mm: known(p.highest_mm),
        })
    }))
}
