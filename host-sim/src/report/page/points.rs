//! Probe points of a page: the rows of `points.csv`.

use serde::Serialize;

use crate::measurement::Measurement;
use crate::pass::Pass;
use crate::report::float;
use crate::report::points::{Row, row_aside, row_used};
use crate::report::tables::rounded;
use truepath_core::identify::Observation;

/// Contacts on a page at most, and as many readings set aside: a table that a reader and a browser can still take.
pub const MOST_SHOWN: usize = 2_000;

/// What became of a reading.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum PointStatus {
    /// It counts.
    Used,
    /// It does not.
    Aside,
}

/// A probe point.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Point {
    /// Line of the probe file.
    pub line: u32,
    /// What became of it.
    pub status: PointStatus,
    /// Why, where there is something to say.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub reason: Option<String>,
    /// Arc length of the contour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub s_mm: Option<f64>,
    /// Touched place of the wall; of a reading set aside what the file says.
    pub x_mm: f64,
    /// The same.
    pub y_mm: f64,
    /// Height above the tip of the cutter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub z_mm: Option<f64>,
    /// Unit normal into the wall; absent where no wall is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nx: Option<f64>,
    /// The same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ny: Option<f64>,
    /// Wall error; absent where no wall is known.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_mm: Option<f64>,
}

/// The points of a measurement with the numbers of `points.csv`, and a sentence when there are more than the
/// page shows: then of neighbouring contacts the one with the largest deviation is shown.
///
/// `observations` are those of the fit, one for each contact; empty when nothing was fitted.
pub fn points(pass: &Pass, measurement: &Measurement, observations: &[Observation]) -> (Vec<Point>, Option<String>) {
    let depth_mm = float(pass.core.setup.axial_depth);
    let contacts = &measurement.contacts;
    let together = contacts.len().div_ceil(MOST_SHOWN).max(1);
    let indices: Vec<usize> = (0..contacts.len()).collect();
    let largest = indices.chunks(together).filter_map(|some| some.iter().max_by_key(|at| contacts[**at].error.abs()));
    let used = largest.map(|at| row_used(&contacts[*at], observations.get(*at)));
    let aside = measurement.rejected.iter().take(MOST_SHOWN).map(row_aside);
    let points: Vec<Point> = used.chain(aside).map(|row| point(row, depth_mm)).collect();
    let all = contacts.len() + measurement.rejected.len();
    let left_out = (points.len() < all).then(|| {
        let shown = points.len();
        format!("the report shows {shown} of {all} probe points, of neighbours the one that deviates most; points.csv has all")
    });
    (points, left_out)
}

fn point(row: Row, depth_mm: f64) -> Point {
    Point {
        line: row.line,
        status: if row.error_mm.is_some() { PointStatus::Used } else { PointStatus::Aside },
        reason: (!row.reason.is_empty()).then_some(row.reason),
        s_mm: row.s_mm,
        x_mm: row.x_mm,
        y_mm: row.y_mm,
        z_mm: row.height.map(|height| rounded(height * depth_mm, 6)),
        nx: row.nx,
        ny: row.ny,
        error_mm: row.error_mm,
    }
}
