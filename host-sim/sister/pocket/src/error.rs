//! Why a pocket cannot be compensated.

use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;
use truepath_job::job::JobFile;

use crate::codes::{D001, D002, D003, D004, D005, D006};

/// A refusal.
#[derive(Clone, Debug, PartialEq)]
pub enum PocketError {
    /// No stick-out, no tool material.
    NoCutter,
    /// Deflection beyond what is to be cut, mm: deflection, limit, place.
    TooSoft {
        /// Deflection, mm.
        deflection_mm: f64,
        /// What there is to cut: the allowance, or the radius in a slot, mm.
        limit_mm: f64,
        /// Arc length, mm.
        s_mm: f64,
    },
    /// The loop stayed open by this, mm, at so many places.
    Unsettled {
        /// Places.
        places: usize,
        /// Largest residual, mm.
        worst_mm: f64,
    },
    /// A tolerance on the command line, mm.
    Tolerance(f64),
    /// Samples of the path, and how many are possible.
    TooLong {
        /// Samples needed.
        needed: usize,
        /// Samples possible.
        most: usize,
    },
    /// A shift beyond the clamp, mm.
    Clamp {
        /// Largest shift, mm.
        shift_mm: f64,
        /// The clamp, mm.
        clamp_mm: f64,
        /// Arc length, mm.
        s_mm: f64,
    },
}

impl PocketError {
    /// As the user meets it, pointing into the job, said in a unit.
    pub fn failure(&self, job: &JobFile, unit: Unit) -> Failure {
        let (row, found, expected, key) = match self {
            Self::NoCutter => (
                D001,
                "tool.stickout_mm and tool.material are missing".to_owned(),
                "the cutter's free length and what it is made of".to_owned(),
                "tool.diameter_mm",
            ),
            Self::TooSoft { deflection_mm, limit_mm, s_mm } => (
                D002,
                format!("the cutter would bend by {deflection_mm:.3} mm at {s_mm:.1} mm of the contour"),
                format!("less than there is to cut, {limit_mm:.3} mm"),
                "tool.stickout_mm",
            ),
            Self::Unsettled { places, worst_mm } => (
                D003,
                format!("force and deflection do not settle at {places} places (residual {worst_mm:.4} mm)"),
                "a cutter stiff enough for this cut".to_owned(),
                "tool.stickout_mm",
            ),
            Self::Tolerance(value) => {
                (D004, format!("the tolerance is {value} mm"), "0.000001 to 1 mm".to_owned(), "pocket.tolerance_mm")
            }
            Self::TooLong { needed, most } => (
                D005,
                format!("the path of the slot has {needed} samples"),
                format!("at most {most}: 40 m at 0.1 mm"),
                "program",
            ),
            Self::Clamp { shift_mm, clamp_mm, s_mm } => (
                D006,
                format!("the path would be shifted by {shift_mm:.3} mm at {s_mm:.1} mm of the contour"),
                format!("at most correct.clamp_mm, {clamp_mm} mm"),
                "correct.clamp_mm",
            ),
        };
        let error = row.error(found, expected).told_in(unit);
        let span = job.span(key);
        if span.is_empty() {
            error.in_file(std::path::Path::new(job.source().name())).into()
        } else {
            error.at(job.source(), span).into()
        }
    }
}
