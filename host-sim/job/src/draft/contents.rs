//! What a draft holds.

use super::entry::Entry;

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
    /// Its tool, heights and length.
    pub fn words(&self) -> String {
        let ContourNote { tool, z_mm, length_mm, closed, .. } = self;
        let tool = tool.map_or_else(String::new, |t| format!("tool {t}, "));
        let heights: Vec<String> = z_mm.iter().map(f64::to_string).collect();
        let closed = if *closed { "closed" } else { "open" };
        format!("{tool}Z {}, {length_mm:.3} mm, {closed}", heights.join(" "))
    }
}

/// What a program asks for.
#[derive(Clone, Debug)]
pub struct Draft {
    /// Keys of the job, in the order of the file.
    pub entries: Vec<Entry>,
    /// Finishing contours.
    pub contours: Vec<ContourNote>,
    /// The one the job is about, when there are several and not all are taken.
    pub chosen: Option<u32>,
    /// What the program says of the cut, for a comment.
    pub facts: Vec<String>,
    /// What the user should know.
    pub warnings: Vec<String>,
    /// `--dialect` of `truepath probe`.
    pub probe_control: Option<&'static str>,
}
