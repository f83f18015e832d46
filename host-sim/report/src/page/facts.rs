//! The block on the job: tool, cut, stock, and anything else worth a line.

use serde::Serialize;
use truepath_ground::length::Said;

/// Tool, cut and set-up.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct JobFacts {
    /// Side of travel on which the wall lies: `left` or `right`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub wall: Option<&'static str>,
    /// `climb` or `conventional`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub milling: Option<&'static str>,
    /// Material of the part.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub material: Option<String>,
    /// The cutter.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tool: Option<Tool>,
    /// The cut.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub cut: Option<Cut>,
    /// What stands on the wall before this pass.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stock: Option<Stock>,
    /// Anything else worth a line.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub facts: Vec<Fact>,
}

/// The cutter.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Tool {
    /// Number in the tool table.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub number: Option<u32>,
    /// Diameter, above 0.
    pub diameter_mm: f64,
    /// Teeth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub teeth: Option<u8>,
    /// Helix angle.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub helix_deg: Option<f64>,
    /// Free length.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub stickout_mm: Option<f64>,
}

/// The cut.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Cut {
    /// Axial depth.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub axial_depth_mm: Option<f64>,
    /// Feed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feed_mm_per_min: Option<f64>,
    /// Spindle speed, rev/min.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub spindle_rpm: Option<f64>,
}

/// What stands on the wall before this pass.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Stock {
    /// Its thickness.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub allowance_mm: Option<f64>,
}

/// A line of the job's block.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Fact {
    /// What it is.
    pub name: String,
    /// Its value, in words.
    pub value: Said,
}

impl Fact {
    /// A line.
    pub fn new(name: impl Into<String>, value: impl Into<Said>) -> Self {
        Self { name: name.into(), value: value.into() }
    }
}
