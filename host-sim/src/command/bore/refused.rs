//! Refusals of a bore as errors of the command line.

use truepath_bore::Refusal;
use truepath_bore::codes::{B001, B002, B003, B004, B005, B006};
use truepath_ground::diagnostics::{Failure, InputError};

/// The error with its code, what was expected and what to do.
pub(super) fn refused(refusal: &Refusal) -> Failure {
    let (row, expected, help) = match refusal {
        Refusal::Range { unit, low, high, .. } => {
            let gap = if unit.is_empty() || *unit == "°" { "" } else { " " };
            (B001, format!("{low} to {high}{gap}{unit}"), "correct the number")
        }
        Refusal::NoRelativeTurn => (B002, "a cutter that turns against its path".to_owned(), "check --rpm and --feed"),
        Refusal::Apart { .. } => (
            B003,
            "passes of every tooth that meet".to_owned(),
            "lower the feed, raise the speed, or mill conventionally",
        ),
        Refusal::Passes { limit, .. } => (
            B004,
            format!("at most {limit}"),
            "use fewer laps, or a higher feed: the height of the waviness falls with the square of the feed",
        ),
        Refusal::Comparisons { limit } => (
            B005,
            format!("at most {limit} steps"),
            "use fewer laps, no runout, or a feed farther from where passes part",
        ),
        Refusal::OutOfReach { .. } => (B006, "a height within reach".to_owned(), "name a smaller height"),
        Refusal::Unfinished => return Failure::Internal(refusal.to_string()),
    };
    InputError::new(row, refusal.to_string(), expected, help).into()
}
