//! The data of a page, version 1; what lies along the path is in `contour`, the job in `facts`, the probe points in `points`.
//! Lengths in mm, angles in degrees, forces in N; material left on the wall is a positive
//! error; normals point from the centre of the cutter into the wall.
//!
//! Everything but version, kind and title may be left out; the page shows what it gets. Numbers that stand alone must be finite
//! (a [`Figure`] that is not is not made, see [`Figure::of`]); in columns there may be holes.

use serde::Serialize;
use truepath_ground::length::{Said, Unit};

use super::{Contour, Heights, Inspected, JobFacts, Limits, Outcome, Outlines, Outlook, Point, Program};
use crate::next::Next;

/// Which command made the page.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Kind {
    /// `simulate`.
    Simulate,
    /// `correct`.
    Correct,
    /// `learn`.
    Learn,
    /// `inspect`.
    Inspect,
}

/// All a page shows.
#[derive(Clone, Debug, Serialize)]
pub struct Page {
    version: u32,
    /// The command.
    pub kind: Kind,
    /// Heading.
    pub title: String,
    /// Program that made the page, with its version.
    pub by: String,
    /// `in` of a program in inches: the unit in which the page opens. All numbers of it are in mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unit: Option<&'static str>,
    /// The part program.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub program: Option<Program>,
    /// Tool, cut and set-up.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub job: Option<JobFacts>,
    /// The path and its passes.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<Contour>,
    /// Walls that do not follow from path, radius and allowance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outlines: Option<Outlines>,
    /// Wall error over the height.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub heights: Option<Heights>,
    /// Probe points.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub points: Vec<Point>,
    /// What was identified.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub parameters: Vec<Parameter>,
    /// The contour in a line, for a page of several.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outcome: Option<Outcome>,
    /// How the wall stands and what it will come to, in figures.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub outlook: Option<Outlook>,
    /// What to do next.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<Next>,
    /// How the wall comes out, in a sentence: mean over the height, and the worst at any height.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub told: Option<Said>,
    /// Head figures.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub results: Vec<Figure>,
    /// Half width of the tolerance band.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance_mm: Option<f64>,
    /// Limits of the wall error, where they lie unevenly about zero or come with an uncertainty.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub limits: Option<Limits>,
    /// Verdict on the part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub verdict: Option<Verdict>,
    /// What a page of `inspect` has beside that.
    #[serde(flatten)]
    pub inspected: Option<Inspected>,
    /// What the user should know.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub warnings: Vec<Said>,
}

impl Page {
    /// An empty page of a command, with a heading.
    pub fn new(kind: Kind, title: impl Into<String>) -> Self {
        Self {
            version: 1,
            kind,
            title: title.into(),
            by: format!("truepath {}", env!("CARGO_PKG_VERSION")),
            unit: None,
            program: None,
            job: None,
            contour: None,
            outlines: None,
            heights: None,
            points: Vec::new(),
            parameters: Vec::new(),
            outcome: None,
            outlook: None,
            next: None,
            told: None,
            results: Vec::new(),
            tolerance_mm: None,
            limits: None,
            verdict: None,
            inspected: None,
            warnings: Vec::new(),
        }
    }

    /// The same, opened in the unit of the program.
    #[must_use]
    pub fn told_in(self, unit: Unit) -> Self {
        Self { unit: (unit == Unit::Inch).then_some(unit.name()), ..self }
    }
}

/// An identified quantity.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Parameter {
    /// Its name.
    pub name: String,
    /// The same fields as in `summary.json`.
    #[serde(flatten)]
    pub of: truepath_correction::summary::Parameter,
}

/// A head figure.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Figure {
    /// What it is.
    pub name: String,
    /// Its value.
    pub value: f64,
    /// Digits shown.
    pub decimals: u32,
    /// Unit.
    pub unit: &'static str,
    /// A word on it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub note: Option<Said>,
}

impl Figure {
    /// A figure; `None` for a value that is not finite.
    pub fn of(name: impl Into<String>, value: f64, decimals: u32, unit: &'static str) -> Option<Self> {
        value.is_finite().then(|| Self { name: name.into(), value, decimals, unit, note: None })
    }

    /// A length in mm to a micrometre.
    pub fn mm(name: impl Into<String>, value: f64) -> Option<Self> {
        Self::of(name, value, 3, "mm")
    }

    /// The same with a word on it.
    #[must_use]
    pub fn noted(mut self, note: impl Into<Said>) -> Self {
        self.note = Some(note.into());
        self
    }
}

/// How it came out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// Within tolerance.
    Pass,
    /// Out of tolerance.
    Fail,
    /// Not decided.
    Open,
}

/// A verdict.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Verdict {
    /// How it came out.
    pub state: State,
    /// In a sentence.
    pub text: Said,
}
