//! Refusals of a bore as errors of the command line.

use truepath_bore::Refusal;
use truepath_bore::codes::{B001, B002, B003, B004, B005, B006};
use truepath_ground::diagnostics::Failure;

/// The error with its code, what was expected and what to do.
pub(super) fn refused(refusal: &Refusal) -> Failure {
    let (row, expected) = match refusal {
        Refusal::Range { unit, low, high, .. } => {
            let gap = if unit.is_empty() || *unit == "°" { "" } else { " " };
            (B001, format!("{low} to {high}{gap}{unit}"))
        }
        Refusal::NoRelativeTurn => (B002, "a cutter that turns against its path".to_owned()),
        Refusal::Apart { .. } => (B003, "passes of every tooth that meet".to_owned()),
        Refusal::Passes { limit, .. } => (B004, format!("at most {limit}")),
        Refusal::Comparisons { limit } => (B005, format!("at most {limit} steps")),
        Refusal::OutOfReach { .. } => (B006, "a height within reach".to_owned()),
        Refusal::Unfinished => return Failure::Internal(refusal.to_string()),
    };
    row.error(refusal.to_string(), expected).into()
}
