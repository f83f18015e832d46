//! `points.csv`: every reading of a probe file and what became of it.

use truepath_core::identify::Observation;
use truepath_core::units::Real;

use super::tables::{rounded, table};
use super::{float, mm};
use crate::diagnostics::Failure;
use crate::measurement::Measurement;
use crate::refusal::why;

/// One reading. `status` is `used`, `outlying` (on the wall, little weight in the fit) or `aside` (not used). Of a used
/// reading x and y are the contact, of one aside what the file says, in work coordinates.
#[derive(serde::Serialize)]
struct Row {
    line: u32,
    status: &'static str,
    s_mm: Option<f64>,
    x_mm: f64,
    y_mm: f64,
    nx: Option<f64>,
    ny: Option<f64>,
    height: Option<f64>,
    error_mm: Option<f64>,
    reason: String,
}

/// Weight below which a point counts as outlying.
const OUTLYING: Real = Real::ratio(3, 10);

/// `points.csv`: the contacts in the order of the contour, then what was set aside in the order of the file.
/// `observations` are those of the fit, one for each contact; empty when nothing was fitted.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn points_csv(measurement: &Measurement, observations: &[Observation]) -> Result<Vec<u8>, Failure> {
    let used = measurement.contacts.iter().enumerate().map(|(at, c)| {
        let outlying = observations.get(at).filter(|o| o.weight < OUTLYING);
        let (status, reason) = match outlying {
            None => ("used", String::new()),
            Some(o) => ("outlying", format!("the model expects {:.4} mm here", mm(o.predicted))),
        };
        Row {
            line: c.line,
            status,
            s_mm: Some(mm(c.s)),
            x_mm: c.point.x.nm() as f64 / 1e6,
            y_mm: c.point.y.nm() as f64 / 1e6,
            nx: Some(rounded(float(c.normal.x), 9)),
            ny: Some(rounded(float(c.normal.y), 9)),
            height: Some(rounded(float(c.height), 6)),
            error_mm: Some(mm(c.error)),
            reason,
        }
    });
    let aside = measurement.rejected.iter().map(|aside| {
        let [x, y, _] = aside.position;
        Row {
            line: aside.line,
            status: "aside",
            s_mm: None,
            x_mm: x.nm() as f64 / 1e6,
            y_mm: y.nm() as f64 / 1e6,
            nx: None,
            ny: None,
            height: None,
            error_mm: None,
            reason: why(&aside.reason),
        }
    });
    table(used.chain(aside))
}
