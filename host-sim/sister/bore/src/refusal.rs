//! Why a bore cannot be computed, with the limit it met.

use truepath_ground::diagnostics::Failure;

use super::codes::{B001, B002, B003, B004, B005, B006};

/// What is wrong with the numbers of a bore.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Refusal {
    /// A number that is not finite or out of its range.
    #[error("{name} {found}{gap}{unit}", gap = gap(unit))]
    Range {
        /// What the number is.
        name: &'static str,
        /// Its unit.
        unit: &'static str,
        /// The number.
        found: f64,
        /// Smallest one accepted.
        low: f64,
        /// Largest one accepted.
        high: f64,
    },
    /// The cutter turns exactly with the path of its centre, so no tooth ever passes the wall.
    #[error("the cutter turns exactly as fast as its centre goes round: no tooth passes the wall")]
    NoRelativeTurn,
    /// The edge does not move forward against the wall, or its passes lie so far apart that they do not meet.
    #[error(
        "passes of a tooth lie {spacing_mm:.3} mm apart on the wall and reach {reach_mm:.3} mm: they do not meet, \
         so no wall is formed"
    )]
    Apart {
        /// Distance of passes, mm.
        spacing_mm: f64,
        /// What a pass covers, mm.
        reach_mm: f64,
    },
    /// More passes than the limit.
    #[error("{found:.0} passes of a tooth along the wall")]
    Passes {
        /// How many there would be.
        found: f64,
        /// How many are allowed.
        limit: usize,
    },
    /// More comparisons of passes than the limit.
    #[error("comparing passes of unequal edges takes more than {limit} steps")]
    Comparisons {
        /// How many are allowed.
        limit: u64,
    },
    /// No feed gives the wanted waviness.
    #[error(
        "a waviness of {wanted_mm} mm is out of reach: {largest_mm:.6} mm at the highest feed at which a wall is formed"
    )]
    OutOfReach {
        /// What was asked for, mm.
        wanted_mm: f64,
        /// The most there can be, mm.
        largest_mm: f64,
    },
    /// A bound of a search was met, which would be a fault of the program.
    #[error("the envelope of these passes did not close")]
    Unfinished,
}

impl Refusal {
    /// Accepts finite numbers from `low` to `high`.
    ///
    /// # Errors
    /// [`Refusal::Range`] for any other.
    pub fn unless_in(name: &'static str, unit: &'static str, found: f64, low: f64, high: f64) -> Result<(), Self> {
        if (low..=high).contains(&found) { Ok(()) } else { Err(Self::Range { name, unit, found, low, high }) }
    }
}

impl From<Refusal> for Failure {
    /// The error with its code, what was expected and what to do.
    fn from(refusal: Refusal) -> Self {
        let (row, expected) = match &refusal {
            Refusal::Range { unit, low, high, .. } => (B001, format!("{low} to {high}{}{unit}", gap(unit))),
            Refusal::NoRelativeTurn => (B002, "a cutter that turns against its path".to_owned()),
            Refusal::Apart { .. } => (B003, "passes of every tooth that meet".to_owned()),
            Refusal::Passes { limit, .. } => (B004, format!("at most {limit}")),
            Refusal::Comparisons { limit } => (B005, format!("at most {limit} steps")),
            Refusal::OutOfReach { .. } => (B006, "a height within reach".to_owned()),
            Refusal::Unfinished => return Self::Internal(refusal.to_string()),
        };
        row.error(refusal.to_string(), expected).into()
    }
}

fn gap(unit: &str) -> &'static str {
    if unit.is_empty() || unit == "°" { "" } else { " " }
}
