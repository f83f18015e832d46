//! What `truepath batch` writes, as far as it is told.

use std::path::Path;

use serde::Deserialize;
use truepath_batch::batch::{Alarm, Known, State};
use truepath_batch::series::Place;
use truepath_ground::diagnostics::InputError;

use crate::codes::Q013;

/// A summary.
#[derive(Clone, Debug, PartialEq, Deserialize)]
pub struct Summary {
    /// How many parts were touched.
    pub touched: usize,
    /// Standard deviation of a reading, mm.
    pub noise_mm: f64,
    /// Tolerance, mm.
    pub tolerance_mm: Option<[f64; 2]>,
    /// Part after part; at least one.
    pub states: Vec<State>,
    /// Change of the force level per part.
    pub wear_per_part: Known,
    /// First part that is more likely out of tolerance than in it.
    pub leaves_at_part: Option<u32>,
    /// Probability that the next part is in tolerance.
    pub next_in_tolerance: Option<f64>,
    /// Places.
    pub places: Vec<Place>,
    /// What asks for action.
    pub alarms: Vec<Alarm>,
    /// What to do about it.
    pub next: Option<String>,
}

impl Summary {
    /// Of the bytes of a file.
    ///
    /// # Errors
    /// `Q013` where they are none.
    pub fn parse(bytes: &[u8], file: &Path) -> Result<Self, InputError> {
        let expected = "a summary as truepath batch writes it";
        let wrong = |found: String| Q013.error(format!("{}: {found}", file.display()), expected).in_file(file);
        let summary: Self = serde_json::from_slice(bytes).map_err(|e| wrong(e.to_string()))?;
        if summary.states.is_empty() { Err(wrong("no part".to_owned())) } else { Ok(summary) }
    }

    /// Whether the force level can be told from the radius.
    pub fn is_pushed(&self) -> bool {
        self.places.iter().any(|place| place.deflection_mm != 0.0)
    }
}
