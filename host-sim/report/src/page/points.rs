//! Probe points of a page: the rows of `points.csv`.

use serde::Serialize;
use truepath_core::identify::Observation;
use truepath_core::probe::Contact;
use truepath_correction::inspection::PointVerdict;
use truepath_ground::length::Said;
use truepath_ground::units::{float, rounded};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use crate::points::{Row, row_aside, row_of};

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
    pub reason: Option<Said>,
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
    /// Whether it is within the tolerance, where that was judged.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<PointVerdict>,
}

/// The points of a measurement with the numbers of `points.csv`, and a sentence when there are more than the
/// page shows: then of neighbouring contacts the one with the largest deviation is shown.
///
/// `observations` are those of the fit, one for each contact; empty when nothing was fitted.
pub fn points(pass: &Pass, measurement: &Measurement, observations: &[Observation]) -> (Vec<Point>, Option<String>) {
    shown(pass, measurement, |at, c| (row_of(measurement, c, observations.get(at)), None))
}

/// The same of a judged part, with the verdict of each contact; empty when there is no tolerance. Of neighbours the one shown is
/// one that fails, then one that is undecided, then the one with the largest deviation.
pub fn judged_points(
    pass: &Pass,
    measurement: &Measurement,
    verdicts: &[PointVerdict],
) -> (Vec<Point>, Option<String>) {
    shown(pass, measurement, |at, c| (row_of(measurement, c, None), verdicts.get(at).copied()))
}

fn shown(
    pass: &Pass,
    measurement: &Measurement,
    row: impl Fn(usize, &Contact) -> (Row, Option<PointVerdict>),
) -> (Vec<Point>, Option<String>) {
    let depth_mm = float(pass.core.setup.axial_depth);
    let contacts = &measurement.contacts;
    let together = contacts.len().div_ceil(MOST_SHOWN).max(1);
    let rank = |verdict| match verdict {
        Some(PointVerdict::Fail) => 2,
        Some(PointVerdict::Open) => 1,
        Some(PointVerdict::Pass) | None => 0,
    };
    let all: Vec<(usize, &Contact)> = contacts.iter().enumerate().collect();
    let worst = all.chunks(together).filter_map(|some| {
        some.iter()
            .map(|(at, c)| (row(*at, c), c.error.abs()))
            .max_by_key(|((_, verdict), size)| (rank(*verdict), *size))
    });
    let used = worst.map(|((row, verdict), _)| Point { verdict, ..point(row, depth_mm) });
    let aside = measurement.rejected.iter().take(MOST_SHOWN).map(|aside| point(row_aside(aside), depth_mm));
    let points: Vec<Point> = used.chain(aside).collect();
    let all = contacts.len() + measurement.rejected.len();
    let left_out = (points.len() < all).then(|| {
        let shown = points.len();
        format!("the report shows {shown} of {all} probe points, of neighbours the worst one; points.csv has all")
    });
    (points, left_out)
}

fn point(row: Row, depth_mm: f64) -> Point {
    Point {
        line: row.line,
        status: if row.error_mm.is_some() { PointStatus::Used } else { PointStatus::Aside },
        reason: row.reason,
        s_mm: row.s_mm,
        x_mm: row.x_mm,
        y_mm: row.y_mm,
        z_mm: row.height.map(|height| rounded(height * depth_mm, 6)),
        nx: row.nx,
        ny: row.ny,
        error_mm: row.error_mm,
        verdict: None,
    }
}
