//! What the commands write: tables (CSV), the summary (JSON), the corrected path for the program and for the image.

mod compare;
mod damped;
mod guard;
mod inspection;
pub mod page;
mod path;
mod points;
mod reading;
pub(crate) mod sheet;
mod summary;
mod tables;
mod wall;

pub use compare::{compare_csv, walls_csv};
pub use damped::{DampedSummary, damped_summary};
pub use guard::{GuardSummary, HeldBack, guard_summary};
pub use inspection::{InspectSummary, ToleranceSummary, inspect_summary};
pub use path::{block_edits, carried_edits};
pub use points::{judged_points_csv, points_csv};
pub use reading::{LawPlaces, PointRow, read_correction, read_points, read_trace, read_wall, read_walls};
pub use summary::{CorrectSummary, Parameter, SimulateSummary, correct_summary, law_name, simulate_summary};
pub use tables::{CorrectionRow, Trace, TraceRow, correction_csv, correction_rows, trace, trace_csv};
pub(crate) use tables::{rounded, table};
pub use wall::{WallRow, wall_csv};

use truepath_core::units::{Offset, Real};

use crate::diagnostics::Failure;

/// Millimetres of a length, for reports.
pub fn mm(v: Offset) -> f64 {
    v.nm() as f64 / 1e6
}

/// A number of the model, for reports.
pub fn float(v: Real) -> f64 {
    v.bits() as f64 / 4_294_967_296.0
}

/// A summary as JSON text.
///
/// # Errors
/// Internal, when it cannot be written.
pub fn json(value: &impl serde::Serialize) -> Result<Vec<u8>, Failure> {
    let mut text = serde_json::to_vec_pretty(value).map_err(|e| Failure::Internal(format!("JSON: {e}")))?;
    text.push(b'\n');
    Ok(text)
}
