//! The part program, and which of its cuts the page is about.
//!
//! A program with one cut needs no words on it. Of any other the page tells what was found, which cut it shows and what became
//! of the others, in the words of `feature` in `summary.json`.

use serde::Serialize;
use truepath_ground::length::{Said, Unit};
use truepath_job::feature::{FeatureSummary, Row};
use truepath_job::pass::Pass;

/// Cuts a page lists at most.
const MOST_CUTS: usize = 200;

/// The part program.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Program {
    /// File name, without its folder.
    pub name: String,
    /// CRC-32, eight hexadecimal digits.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub crc32: Option<String>,
    /// What the page is of; absent in a program with one cut and no names.
    #[serde(flatten)]
    pub chosen: Option<Chosen>,
}

/// The cut that was chosen, among the others.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Chosen {
    /// The cut that is shown, in a few words.
    pub shown: Said,
    /// Why that one.
    pub why: String,
    /// Names of the features that this page is not about.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_features: Vec<String>,
    /// Its cuts in the order of execution.
    pub cuts: Vec<ProgramCut>,
    /// Cuts that are not listed.
    #[serde(skip_serializing_if = "is_zero")]
    pub cuts_left_out: usize,
}

/// A run of cutting moves.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProgramCut {
    /// The fields of `feature.candidates` in `summary.json`.
    #[serde(flatten)]
    pub row: Row,
    /// Why it has its role, in inches, where that is said in other words.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub why_in: Option<String>,
    /// What became of it.
    pub became: Became,
}

/// What became of a cut.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Became {
    /// The page shows it.
    Shown,
    /// It gets the correction of the one shown.
    Corrected,
    /// It stays as it is.
    Unchanged,
    /// The command changes nothing, and says nothing of it.
    Elsewhere,
}

#[expect(clippy::trivially_copy_pass_by_ref, reason = "the form serde asks for")]
const fn is_zero(n: &usize) -> bool {
    *n == 0
}

impl Program {
    /// Of a pass; `corrected` are the depths whose correction was written, `None` where nothing is corrected.
    pub fn of(pass: &Pass, corrected: Option<&[u32]>) -> Self {
        let chosen =
            pass.feature(corrected.unwrap_or_default()).map(|feature| Chosen::of(feature, corrected.is_some()));
        Self { name: file_name(pass), crc32: Some(format!("{:08x}", pass.core.program_crc)), chosen }
    }
}

impl Chosen {
    fn of(feature: FeatureSummary, corrects: bool) -> Self {
        let became = |row: &Row| match (row.role, row.level) {
            ("finish", Some(level)) if level == feature.pass => Became::Shown,
            ("finish", Some(level)) if feature.passes_corrected.contains(&level) => Became::Corrected,
            _ if corrects => Became::Unchanged,
            _ => Became::Elsewhere,
        };
        let shown = Said::of(|unit| feature.in_words(unit));
        let cut = |row: Row| {
            let [mm, inches] = [Unit::Millimetre, Unit::Inch].map(|unit| row.why.in_unit(unit));
            ProgramCut { why_in: (inches != mm).then(|| inches.to_owned()), became: became(&row), row }
        };
        let cuts: Vec<ProgramCut> = feature.candidates.into_iter().map(cut).collect();
        let all = cuts.len();
        // Where there are too many, those that make a wall come before the others.
        let mut others = MOST_CUTS.saturating_sub(cuts.iter().filter(|cut| cut.makes_wall()).count());
        let mut listed = |cut: &ProgramCut| {
            let room = cut.makes_wall() || others > 0;
            others = others.saturating_sub(usize::from(!cut.makes_wall()));
            room
        };
        let cuts: Vec<ProgramCut> = cuts.into_iter().filter(|cut| listed(cut)).take(MOST_CUTS).collect();
        Self { shown, why: feature.why, other_features: feature.other_features, cuts_left_out: all - cuts.len(), cuts }
    }
}

impl ProgramCut {
    fn makes_wall(&self) -> bool {
        matches!(self.row.role, "finish" | "spring")
    }
}

/// The name of the program without its folder.
pub(super) fn file_name(pass: &Pass) -> String {
    let name = pass.program.name();
    name.rsplit(['/', '\\']).next().unwrap_or(name).to_owned()
}
