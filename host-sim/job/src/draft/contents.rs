//! What a draft holds: the keys of a job in the making, and the contours of its program.

use truepath_ground::length::{Remark, Unit};

/// Where a value comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Origin {
    /// It belongs to every job.
    Fixed,
    /// The program shows it.
    Program,
    /// Nobody has said it.
    Default,
    /// The user said it.
    Given,
    /// Nobody has said it, and it is left out: what is taken then is wide.
    Left,
    /// Nobody has said it, and nothing can be taken for it.
    Open,
}

/// A key with its value.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Entry {
    /// With its table.
    pub key: String,
    /// As TOML; of what is open or left out, a proposal or nothing.
    pub value: String,
    /// Where it comes from.
    pub origin: Origin,
    /// In words.
    pub why: String,
    /// The line of the program that shows it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub line: Option<u32>,
    /// Whether the user should look at it before metal is cut.
    pub check: bool,
}

impl Entry {
    fn new(key: &str, value: &str, origin: Origin, why: &str) -> Self {
        let (key, value, why) = (key.to_owned(), value.to_owned(), why.to_owned());
        Self { key, value, origin, why, line: None, check: false }
    }
    pub(super) fn fixed(key: &str, value: &str) -> Self {
        Self::new(key, value, Origin::Fixed, "")
    }
    pub(super) fn given(key: &str, value: &str) -> Self {
        Self::new(key, &toml_value(value), Origin::Given, "as you said")
    }
    /// Shown by a line of the program; 0 for none.
    pub(super) fn read(key: &str, value: &str, why: &str, line: u32) -> Self {
        Self::new(key, value, Origin::Program, why).at_line(Some(line).filter(|line| *line > 0))
    }
    pub(super) fn default(key: &str, value: &str, why: &str, check: bool) -> Self {
        Self { check, ..Self::new(key, value, Origin::Default, why) }
    }
    pub(super) fn open(key: &str, proposal: &str, why: &str) -> Self {
        Self { check: true, ..Self::new(key, proposal, Origin::Open, why) }
    }
    pub(super) fn left(key: &str, why: &str) -> Self {
        Self::new(key, "", Origin::Left, why)
    }
    pub(super) fn at_line(self, line: Option<u32>) -> Self {
        Self { line, ..self }
    }
    pub(super) fn doubtful(self) -> Self {
        Self { check: true, ..self }
    }

    /// The name of its table, empty at the top of the file, and the key in it.
    pub fn place(&self) -> (&str, &str) {
        self.key.split_once('.').unwrap_or(("", &self.key))
    }

    /// Why it stands there, for the comment behind it.
    pub fn reason(&self) -> String {
        let line = self.line.map_or_else(String::new, |line| format!("line {line}: "));
        match self.origin {
            Origin::Default => format!("default, please check: {}", self.why),
            Origin::Program if self.check => format!("{line}{}; please check", self.why),
            _ => format!("{line}{}", self.why),
        }
    }
}

/// A value as TOML has it: what is no number, list or word of TOML is a text.
pub(super) fn toml_value(value: &str) -> String {
    let plain = value.trim();
    let is_toml = !plain.contains(['\n', '\r']) && format!("x = {plain}").parse::<toml::Table>().is_ok();
    if is_toml { plain.to_owned() } else { toml::Value::String(plain.to_owned()).to_string() }
}

/// A finishing contour of the program.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct ContourNote {
    /// Its number, from 1.
    pub number: u32,
    /// First line of its first level.
    pub first_line: u32,
    /// Last line of its last level.
    pub last_line: u32,
    /// The tool in the spindle.
    pub tool: Option<u32>,
    /// Heights of its levels, mm.
    pub z_mm: Vec<f64>,
    /// Length of one level, mm.
    pub length_mm: f64,
    /// Whether it ends where it starts.
    pub closed: bool,
    /// Lines and arcs that lead to it, and away from it, in its first level.
    pub leads: [usize; 2],
}

impl ContourNote {
    /// Its tool, heights and length, in a unit.
    pub fn words(&self, unit: Unit) -> String {
        let ContourNote { tool, z_mm, length_mm, closed, .. } = self;
        let tool = tool.map_or_else(String::new, |t| format!("tool {t}, "));
        let heights: Vec<String> = z_mm.iter().map(|z| unit.of(*z).to_string()).collect();
        let closed = if *closed { "closed" } else { "open" };
        format!("{tool}Z {}, {:.3} {}, {closed}", heights.join(" "), unit.of(*length_mm), unit.name())
    }
}

/// What a program asks for.
#[derive(Clone, Debug)]
pub struct Draft {
    /// The unit of the program: what is round in inches of a program in inches stands in the job file so.
    pub unit: Unit,
    /// Keys of the job, in the order of the file.
    pub entries: Vec<Entry>,
    /// Finishing contours.
    pub contours: Vec<ContourNote>,
    /// The one the job is about, when there are several and not all are taken.
    pub chosen: Option<u32>,
    /// What the program says of the cut, for a comment.
    pub facts: Vec<String>,
    /// What the user should know.
    pub warnings: Vec<Remark>,
    /// `--dialect` of `truepath probe`.
    pub probe_control: Option<&'static str>,
}
