//! What was found in a program, for people and for machines.

use truepath_core::gcode::{Found, Idle, LineRange, Role};
use truepath_ground::length::{Said, Unit};
use truepath_ground::units::mm;

/// Contours that were found by search are called by their number.
pub(super) const CONTOUR: &str = "contour-";

/// One run of cutting moves and what it is taken for.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Row {
    /// `finish`, `spring`, `semi`, `rough`, `travel`, `facing` or `other tool`.
    pub role: &'static str,
    /// Number of the finishing contour among those found; `None` for what makes no wall.
    pub contour: Option<u32>,
    /// Number of its level.
    pub level: Option<u32>,
    /// First line, leads left out.
    pub first_line: u32,
    /// Last line.
    pub last_line: u32,
    /// The tool in the spindle.
    pub tool: Option<u32>,
    /// Its height, program coordinates, mm.
    pub z_mm: Option<f64>,
    /// Its length, mm.
    pub length_mm: f64,
    /// Whether it ends where it starts.
    pub closed: bool,
    /// Why it has its role.
    #[serde(serialize_with = "in_mm")]
    #[schemars(with = "String")]
    pub why: Said,
}

/// Files are in millimetres, their words too.
fn in_mm<S: serde::Serializer>(said: &Said, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(said.in_unit(Unit::Millimetre))
}

/// One pass of the feature.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct PassRow {
    /// Level, from 1.
    pub pass: u32,
    /// `finish` or `spring`.
    pub role: &'static str,
    /// First line.
    pub first_line: u32,
    /// Last line.
    pub last_line: u32,
    /// Its height, mm.
    pub z_mm: Option<f64>,
}

/// The feature a command was about.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct FeatureSummary {
    /// Its name, when it has one.
    pub id: Option<String>,
    /// Its number, which the coprocessor is armed with.
    pub number: u32,
    /// `search`, `job` or `markers`.
    pub chosen_by: &'static str,
    /// Why it was chosen.
    pub why: String,
    /// The pass that was simulated, inspected or probed.
    pub pass: u32,
    /// Its passes.
    pub passes: Vec<PassRow>,
    /// Passes whose correction was written; empty where nothing is corrected.
    pub passes_corrected: Vec<u32>,
    /// Names of the other features of the program; each of them is a correction of its own.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub other_features: Vec<String>,
    /// What else lies in the program, or on the lines of the feature.
    pub candidates: Vec<Row>,
}

/// The rows of a list of runs.
pub(super) fn rows(runs: &[Found], allowance_mm: f64) -> Vec<Row> {
    let row = |found: &Found| {
        let (role, contour, level, why) = match found.role {
            Role::Idle(Idle::Travel) => ("travel", None, None, "a move between cuts, above all that is cut".into()),
            Role::Idle(Idle::Facing) => {
                ("facing", None, None, "to and fro nearer than the cutter is wide, above all else".into())
            }
            Role::OtherTool => ("other tool", None, None, "cut with another tool".into()),
            Role::Rough { nearer, gap, parallel } => {
                let role = if parallel && mm(gap) <= 1.2 * allowance_mm { "semi" } else { "rough" };
                let kind = if parallel { "all along" } else { "or more" };
                let by = runs.get(nearer).map_or_else(String::new, |n| lines_of(n.run.lines));
                let far = |unit: Unit| {
                    format!("{:.3} {} {kind} farther from the wall than {by}", unit.of(mm(gap)), unit.name())
                };
                (role, None, None, Said::of(far))
            }
            Role::Finish { contour, level } => {
                ("finish", Some(contour), Some(level), "no other run takes its wall away".into())
            }
            Role::Spring { contour, level } => {
                ("spring", Some(contour), Some(level), "the same path at the same height again".into())
            }
        };
        Row {
            role,
            contour,
            level,
            first_line: found.run.lines.first,
            last_line: found.run.lines.last,
            tool: found.run.tool,
            z_mm: found.run.z.map(|z| z.nm() as f64 / 1e6),
            length_mm: mm(found.run.length),
            closed: found.run.closed,
            why,
        }
    };
    runs.iter().map(row).collect()
}

/// Lines in words.
pub(super) fn lines_of(lines: LineRange) -> String {
    if lines.first == lines.last {
        format!("line {}", lines.first)
    } else {
        format!("lines {}-{}", lines.first, lines.last)
    }
}

impl Row {
    /// One line of a table, without the reason.
    pub(super) fn short(&self, unit: Unit) -> String {
        let tool = self.tool.map_or_else(|| "no tool".to_owned(), |t| format!("tool {t}"));
        let z = self.z_mm.map_or_else(|| "Z unknown".to_owned(), |z| format!("Z {}", unit.of(z)));
        let lines = lines_of(LineRange { first: self.first_line, last: self.last_line });
        let closed = if self.closed { "closed" } else { "open" };
        let (length, name) = (unit.of(self.length_mm), unit.name());
        format!("{:<10} {lines:<14} {tool:<8} {z:<10} {length:>9.3} {name}  {closed}", self.role)
    }
}

/// Most rows in an error; all are in the JSON of a run that succeeds.
const MOST_ROWS: usize = 20;

/// A list inside an error.
pub(super) fn listed<'r>(rows: impl Iterator<Item = &'r Row>, unit: Unit) -> String {
    let name = |row: &Row| row.contour.map_or_else(String::new, |n| format!("  {CONTOUR}{n}"));
    let all: Vec<String> = rows.map(|row| format!("\n  {}{}", row.short(unit), name(row))).collect();
    let mut text = all.iter().take(MOST_ROWS).cloned().collect::<String>();
    if all.len() > MOST_ROWS {
        text += &format!("\n  and {} more", all.len() - MOST_ROWS);
    }
    text
}

impl FeatureSummary {
    /// What it is called in sentences.
    fn name(&self) -> String {
        self.id.as_ref().map_or_else(|| "the finishing contour".to_owned(), |id| format!("feature \"{id}\""))
    }

    /// Its finishing passes.
    fn finishing(&self) -> impl Iterator<Item = &PassRow> {
        self.passes.iter().filter(|p| p.role == "finish")
    }

    /// The pass that was simulated, inspected or corrected, among how many, and where it is.
    pub fn in_words(&self, unit: Unit) -> String {
        let mut text = self.name();
        if let Some(own) = self.finishing().find(|p| p.pass == self.pass) {
            let levels = self.finishing().count();
            if levels > 1 {
                text += &format!(", pass {} of {levels}", self.pass);
            }
            text += &own.z_mm.map_or_else(String::new, |z| format!(", Z {} {}", unit.of(z), unit.name()));
            text += &format!(", {}", lines_of(LineRange { first: own.first_line, last: own.last_line }));
        }
        text
    }
}

impl FeatureSummary {
    /// What a report on this pass says nothing of; `None` when the program makes no other wall that is known.
    pub fn not_judged(&self, unit: Unit) -> Option<String> {
        let place = |p: &PassRow| match p.z_mm {
            None => format!("pass {}", p.pass),
            Some(z) => format!("pass {} (Z {} {})", p.pass, unit.of(z), unit.name()),
        };
        let passes = self.finishing().filter(|p| p.pass != self.pass).map(place);
        let features = self.other_features.iter().map(|id| format!("feature \"{id}\""));
        let others: Vec<String> = passes.chain(features).collect();
        (!others.is_empty())
            .then(|| format!("Judged is the wall of {}; not those of {}.", self.in_words(unit), others.join(", ")))
    }
}

/// What was chosen and why, for people.
pub fn listing(feature: &FeatureSummary, unit: Unit) -> String {
    let mut text = format!("{}, by {}: {}\n", feature.name(), feature.chosen_by, feature.why);
    if !feature.other_features.is_empty() {
        text += &format!("  other features, each a correction of its own: {}\n", feature.other_features.join(", "));
    }
    for row in &feature.candidates {
        text += &format!("  {}  {}\n", row.short(unit), row.why.in_unit(unit));
    }
    let levels = feature.finishing().count();
    text += &format!("pass {} of {levels}", feature.pass);
    if feature.passes_corrected.is_empty() {
        text += "\n\n";
    } else {
        let numbers: Vec<String> = feature.passes_corrected.iter().map(u32::to_string).collect();
        text += &format!("; corrected: {}; every other line of the program stays as it is\n\n", numbers.join(", "));
    }
    text
}
