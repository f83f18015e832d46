//! `points.csv`: every reading of a probe file and what became of it.

use truepath_core::identify::Observation;
use truepath_core::probe::Contact;
use truepath_core::units::Real;
use truepath_correction::inspection::PointVerdict;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::{Said, Unit};
use truepath_ground::table::table;
use truepath_ground::units::{float, mm, rounded};
use truepath_job::measurement::{Aside, Measurement};
use truepath_job::refusal::why;

/// One reading. `status` is `used`, `outlying` (on the wall, little weight in the fit) or `aside` (not used). Of a used
/// reading x and y are the contact, of one aside what the file says, in work coordinates. The file is in millimetres, its words too.
#[derive(serde::Serialize)]
pub(super) struct Row {
    pub(super) line: u32,
    pub(super) status: &'static str,
    pub(super) s_mm: Option<f64>,
    pub(super) x_mm: f64,
    pub(super) y_mm: f64,
    pub(super) nx: Option<f64>,
    pub(super) ny: Option<f64>,
    pub(super) height: Option<f64>,
    pub(super) error_mm: Option<f64>,
    #[serde(serialize_with = "in_mm")]
    pub(super) reason: Option<Said>,
}

fn in_mm<S: serde::Serializer>(said: &Option<Said>, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(said.as_ref().map_or("", |said| said.in_unit(Unit::Millimetre)))
}

/// Weight below which a point counts as outlying.
const OUTLYING: Real = Real::ratio(3, 10);

/// A contact of a measurement, with what the fit made of it.
pub(super) fn row_of(measurement: &Measurement, c: &Contact, fitted: Option<&Observation>) -> Row {
    let row = row_used(c, fitted);
    let Some(placed) = measurement.dimension(c.line) else { return row };
    let of_two = match (placed.half, placed.across) {
        (Some(_), _) => ", mean error of this wall and one of another contour",
        (None, Some(_)) => ", mean error of both walls",
        (None, None) => "",
    };
    let reason = Said::of(|unit| {
        let more = row.reason.as_ref().map_or_else(String::new, |said| format!("; {}", said.in_unit(unit)));
        format!(
            "{} {:.4} {}, nominal {:.4}{of_two}{more}",
            placed.dimension.name,
            unit.of(mm(placed.dimension.value)),
            unit.name(),
            unit.of(placed.nominal_mm)
        )
    });
    Row { line: placed.file_line, reason: Some(reason), ..row }
}

/// A contact, with what the fit made of it.
fn row_used(c: &Contact, fitted: Option<&Observation>) -> Row {
    let (status, reason) = match fitted.filter(|o| o.weight < OUTLYING) {
        None => ("used", None),
        Some(o) => {
            let said = |unit: Unit| format!("the model expects {:.4} {} here", unit.of(mm(o.predicted)), unit.name());
            ("outlying", Some(Said::of(said)))
        }
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
}

/// A reading set aside.
pub(super) fn row_aside(aside: &Aside) -> Row {
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
        reason: Some(Said::of(|unit| why(&aside.reason, unit))),
    }
}

/// `points.csv`: the contacts in the order of the contour, then what was set aside in the order of the file.
/// `observations` are those of the fit, one for each contact; empty when nothing was fitted.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn points_csv(measurement: &Measurement, observations: &[Observation]) -> Result<Vec<u8>, Failure> {
    let used = measurement.contacts.iter().enumerate().map(|(at, c)| row_of(measurement, c, observations.get(at)));
    table(used.chain(measurement.rejected.iter().map(row_aside)))
}

/// The verdict of a row.
#[derive(serde::Serialize)]
struct Judged {
    verdict: Option<PointVerdict>,
}

/// `points.csv` of a judged part: the same with a last column `verdict`, one verdict for each contact; empty for what was
/// set aside.
///
/// # Errors
/// Internal, when memory cannot be written.
pub fn judged_points_csv(measurement: &Measurement, verdicts: &[PointVerdict]) -> Result<Vec<u8>, Failure> {
    let contacts = measurement.contacts.iter().zip(verdicts);
    let used = contacts.map(|(c, verdict)| (row_of(measurement, c, None), Judged { verdict: Some(*verdict) }));
    table(used.chain(measurement.rejected.iter().map(|aside| (row_aside(aside), Judged { verdict: None }))))
}
