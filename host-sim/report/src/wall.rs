//! `wall.csv`: the nominal wall beside every row of `trace.csv` or `correction.csv`, row by row.

use truepath_correction::rows::CorrectionRow;
use truepath_ground::diagnostics::Failure;
use truepath_ground::table::table;
use truepath_ground::units::rounded;

use crate::tables::TraceRow;

/// A place of the nominal wall.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct WallRow {
    /// Arc length of the contour.
    pub s_mm: f64,
    /// The wall.
    pub x_mm: f64,
    /// The wall.
    pub y_mm: f64,
    /// Unit normal from the cutter's centre into the wall.
    pub nx: f64,
    /// Unit normal from the cutter's centre into the wall.
    pub ny: f64,
}

impl WallRow {
    fn new(s_mm: f64, [x, y]: [f64; 2], [cx, cy]: [f64; 2]) -> Self {
        let length = (x - cx).hypot(y - cy);
        let normal = |v: f64| rounded(v / length, 9);
        Self {
            s_mm: rounded(s_mm, 6),
            x_mm: rounded(x, 6),
            y_mm: rounded(y, 6),
            nx: normal(x - cx),
            ny: normal(y - cy),
        }
    }
}

impl From<&TraceRow> for WallRow {
    fn from(r: &TraceRow) -> Self {
        Self::new(r.s_mm, [r.wall_x_mm, r.wall_y_mm], [r.x_mm, r.y_mm])
    }
}

impl From<&CorrectionRow> for WallRow {
    fn from(r: &CorrectionRow) -> Self {
        Self::new(r.s_mm, [r.wall_x_mm, r.wall_y_mm], [r.x_mm, r.y_mm])
    }
}

/// `wall.csv` beside a table of these rows.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn wall_csv<'a, Row: 'a>(rows: &'a [Row]) -> Result<Vec<u8>, Failure>
where
    WallRow: From<&'a Row>,
{
    table(rows.iter().map(WallRow::from))
}
