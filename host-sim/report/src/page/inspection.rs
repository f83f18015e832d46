//! What a page of `inspect` has beside points and figures: the part, the files, what the verdict rests on; and limits.

use serde::Serialize;
use truepath_correction::inspection::Coverage;
use truepath_ground::length::Said;
use truepath_job::job::PartNames;

use crate::InspectSummary;

/// The inspection of a part; its fields are fields of the page.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Inspected {
    /// What the part is called.
    pub part: PartNames,
    /// What the report rests on.
    pub files: Vec<InputFile>,
    /// Decision rule and what the verdict does not cover.
    pub statements: Vec<Said>,
    /// Which stretches no point speaks for.
    pub coverage: Option<Coverage>,
}

/// A file that the report rests on.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct InputFile {
    /// `program`, `probe file` or `job`.
    pub what: &'static str,
    /// Its name without its folder.
    pub name: String,
    /// CRC-32, eight hexadecimal digits.
    pub crc32: String,
}

impl InputFile {
    /// Of a file, without its folder.
    pub fn new(what: &'static str, path: &str, crc32: &str) -> Self {
        let name = path.rsplit(['/', '\\']).next().unwrap_or(path);
        Self { what, name: name.to_owned(), crc32: crc32.to_owned() }
    }
}

/// Limits of the wall error.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Limits {
    /// The deepest cut.
    pub lower_mm: f64,
    /// The most material left.
    pub upper_mm: f64,
    /// Expanded uncertainty (k = 2) of a deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub uncertainty_mm: Option<f64>,
    /// Who gave them, when it is not the job.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub from: Option<&'static str>,
}

impl Limits {
    /// Those of a summary.
    pub fn of(summary: &InspectSummary) -> Option<Self> {
        let tolerance = summary.tolerance?;
        Some(Self {
            lower_mm: tolerance.lower_mm,
            upper_mm: tolerance.upper_mm,
            uncertainty_mm: summary.uncertainty_mm,
            from: (tolerance.from != "job").then_some("as asked for on the command line"),
        })
    }
}
