//! What became of a case: one line of `cases.csv`.

use serde::{Deserialize, Serialize};

use super::id::{CaseId, Cell};

/// One line of the table. Lengths are in mm; what was not reached is empty.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Outcome {
    /// Name of the case.
    pub case: String,
    /// Why it failed; empty when it did not.
    pub failure: String,
    /// Why the second correction failed; empty when it did not, or was not asked for.
    pub learn_failure: String,
    /// Length of the contour.
    pub length_mm: Option<f64>,
    /// Touches of the first part.
    pub points: Option<u64>,
    /// Mean stiffness of the machine with its cutter, N/mm.
    pub stiffness_n_per_mm: Option<f64>,
    /// Largest wall error of the first part, mean over ten heights.
    pub before_mm: Option<f64>,
    /// The same after the first correction.
    pub after_mm: Option<f64>,
    /// before/after.
    pub factor: Option<f64>,
    /// What the model expected to remain.
    pub predicted_mm: Option<f64>,
    /// Largest sigma of the correction.
    pub sigma_mm: Option<f64>,
    /// Share of the contour where the error after lies within 2 sigma.
    pub coverage: Option<f64>,
    /// Root mean square before.
    pub rms_before_mm: Option<f64>,
    /// Root mean square after.
    pub rms_after_mm: Option<f64>,
    /// Deepest gouge after, of the mean over the heights; negative when material is left everywhere.
    pub gouge_mm: Option<f64>,
    /// Largest error at any height before.
    pub worst_height_before_mm: Option<f64>,
    /// Largest error at any height after.
    pub worst_height_mm: Option<f64>,
    /// Largest spread over the height after.
    pub axial_form_mm: Option<f64>,
    /// Wall law found.
    pub law: String,
    /// Parameters that the points decided.
    pub identified: String,
    /// Time of the correction, s.
    pub correct_s: Option<f64>,
    /// Largest wall error after one more part was probed and learned from.
    pub learned_mm: Option<f64>,
    /// before/learned.
    pub learned_factor: Option<f64>,
    /// What was expected to remain.
    pub learned_predicted_mm: Option<f64>,
    /// Share of the contour where the error after learning lies within 2 sigma.
    pub learned_coverage: Option<f64>,
    /// Deepest gouge after learning, of the mean over the heights.
    pub learned_gouge_mm: Option<f64>,
    /// Whether learning went back to an earlier correction.
    pub rolled_back: Option<bool>,
    /// Time of learning, s.
    pub learn_s: Option<f64>,
}

impl Outcome {
    /// A case that could not be carried through.
    pub fn failed(case: &CaseId, why: impl Into<String>) -> Self {
        Self { case: case.to_string(), failure: one_line(&why.into()), ..Self::default() }
    }

    /// The name, read back.
    pub fn id(&self) -> Option<CaseId> {
        self.case.parse().ok()
    }

    /// The cell of a grid it belongs to.
    pub fn cell(&self) -> Option<Cell> {
        self.id().and_then(|id| id.cell)
    }

    /// Whether a correction made the part worse.
    pub fn worse(&self) -> bool {
        let worse = |after: Option<f64>| matches!((self.before_mm, after), (Some(b), Some(a)) if a > b);
        worse(self.after_mm) || worse(self.learned_mm)
    }

    /// The columns of the table.
    pub fn header() -> String {
        line(&Self::default(), true).lines().next().unwrap_or_default().to_owned() + "\n"
    }

    /// The line of the table, with its end.
    pub fn line(&self) -> String {
        line(self, false)
    }
}

fn line(outcome: &Outcome, header: bool) -> String {
    let mut writer = csv::WriterBuilder::new().has_headers(header).from_writer(Vec::new());
    // Serialising flat text and numbers into memory cannot fail.
    let _ = writer.serialize(outcome);
    writer.into_inner().ok().and_then(|bytes| String::from_utf8(bytes).ok()).unwrap_or_default()
}

/// Text on one line, for the table.
pub fn one_line(text: &str) -> String {
    text.split_whitespace().collect::<Vec<_>>().join(" ")
}
