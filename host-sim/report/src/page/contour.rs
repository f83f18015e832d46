//! What lies along the path: contour, passes, outlines, wall error over the height.

use serde::Serialize;

use super::Column;

/// The path, columns of one length.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Contour {
    /// Arc length.
    pub s_mm: Column,
    /// Centre of the cutter as programmed.
    pub x_mm: Column,
    /// The same.
    pub y_mm: Column,
    /// Unit normal into the wall.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub nx: Option<Column>,
    /// The same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub ny: Option<Column>,
    /// Correction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction_x_mm: Option<Column>,
    /// The same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction_y_mm: Option<Column>,
    /// The pass without the correction, or the only one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<PassColumns>,
    /// The pass of a part that was cut with an earlier correction and measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub milled: Option<PassColumns>,
    /// The pass with the correction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<PassColumns>,
}

/// One pass along the path, columns of its length.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct PassColumns {
    /// What it is called in buttons and tables; otherwise the page says before and after.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// What this pass is and who says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub label: Option<String>,
    /// Wall error.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub error_mm: Option<Column>,
    /// Its standard deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sigma_mm: Option<Column>,
    /// Engagement.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub arc_deg: Option<Column>,
    /// Chip area.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chip_area_mm2: Option<Column>,
    /// Mean force on the tool.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub force_n: Option<Column>,
    /// Its component along x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fx_n: Option<Column>,
    /// Its component along y.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub fy_n: Option<Column>,
    /// Deflection along x.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dx_mm: Option<Column>,
    /// Deflection along y.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub dy_mm: Option<Column>,
    /// Feed.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feed_mm_per_min: Option<Column>,
    /// The correction it was cut with, where that is not the one of the contour.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction_x_mm: Option<Column>,
    /// The same.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub correction_y_mm: Option<Column>,
}

/// Lines that the page draws instead of its own.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Outlines {
    /// Finished wall.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub wall: Vec<Polyline>,
    /// Surface before this pass.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub stock: Vec<Polyline>,
}

/// A line of points.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Polyline {
    /// Abscissae.
    pub x_mm: Column,
    /// Ordinates.
    pub y_mm: Column,
}

/// Wall error over the height: node after node, in each every height.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Heights {
    /// Heights above the tip of the cutter, rising.
    pub z_mm: Vec<f64>,
    /// A node is every so many samples of the contour, 1 or more.
    pub stride: usize,
    /// Without the correction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub before: Option<Column>,
    /// Of the part that was measured.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub milled: Option<Column>,
    /// With the correction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after: Option<Column>,
}
