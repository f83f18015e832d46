//! The traces of a pass over the contour; those of several passes over each other.

use truepath_chart::curve::Curve;
use truepath_chart::panel::{Panel, panels};
use truepath_chart::style::{ALONG_X, DARK, INK_AFTER, INK_ALONG_Y, INK_MAGNITUDE, INKS, Ink};
use truepath_chart::view::View;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;

use crate::TraceRow;

/// What a curve shows of a row.
type Of = fn(&TraceRow) -> f64;

/// A quantity of a pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Column {
    /// Engagement angle.
    Arc,
    /// Chip area per tooth.
    Chip,
    /// Mean force; of a single pass also along X and Y.
    Force,
    /// Mean force along X and Y.
    Components,
    /// Mean deflection along X and Y.
    Deflection,
    /// Wall error.
    Error,
}

impl Column {
    /// What is drawn when nothing is said.
    pub const USUAL: [Self; 4] = [Self::Arc, Self::Force, Self::Deflection, Self::Error];

    /// The values with their unit.
    fn named(self, unit: Unit) -> String {
        let name = unit.name();
        match self {
            Self::Arc => "engagement (°)".to_owned(),
            Self::Chip => format!("chip area ({name}²)"),
            Self::Force | Self::Components => "mean force (N)".to_owned(),
            Self::Deflection => format!("deflection ({name})"),
            Self::Error => format!("wall error ({name})"),
        }
    }

    /// A value of a row in a unit of length.
    const fn said(self, unit: Unit, value: f64) -> f64 {
        match self {
            Self::Arc | Self::Force | Self::Components => value,
            Self::Chip => unit.said(unit.said(value)),
            Self::Deflection | Self::Error => unit.said(value),
        }
    }

    /// Curves of a single pass in one diagram.
    fn single(self) -> Vec<(&'static str, Ink, Of)> {
        let x = Ink::from(ALONG_X);
        match self {
            Self::Arc => vec![("engagement angle", DARK.into(), |r| r.arc_deg)],
            Self::Chip => vec![("b·f·(1 − cos φ)", DARK.into(), |r| r.chip_area_mm2)],
            Self::Force => vec![
                ("magnitude", INK_MAGNITUDE, |r| r.force_n),
                ("along X", x, |r| r.fx_n),
                ("along Y", INK_ALONG_Y, |r| r.fy_n),
            ],
            Self::Components => vec![("along X", x, |r| r.fx_n), ("along Y", INK_ALONG_Y, |r| r.fy_n)],
            Self::Deflection => vec![("along X", x, |r| r.dx_mm), ("along Y", INK_ALONG_Y, |r| r.dy_mm)],
            Self::Error => vec![("material left (+), gouge (−)", INK_AFTER, |r| r.error_mm)],
        }
    }

    /// Diagrams of several passes: each shows one value of them all, so that every curve is a pass.
    fn several(self, unit: Unit) -> Vec<(String, Of)> {
        let named = self.named(unit);
        let along = |axis: &str| format!("deflection {axis} ({})", unit.name());
        match self {
            Self::Arc => vec![(named, |r| r.arc_deg)],
            Self::Chip => vec![(named, |r| r.chip_area_mm2)],
            Self::Force => vec![(named, |r| r.force_n)],
            Self::Components => vec![("mean force X (N)".into(), |r| r.fx_n), ("mean force Y (N)".into(), |r| r.fy_n)],
            Self::Deflection => vec![(along("X"), |r| r.dx_mm), (along("Y"), |r| r.dy_mm)],
            Self::Error => vec![(named, |r| r.error_mm)],
        }
    }
}

/// Most passes over each other: one for each colour that can be told apart.
pub const PASSES: usize = INKS.len();

/// Draws the columns of passes with their names; a single one needs none.
///
/// # Errors
/// As [`panels`].
pub fn trace(view: &View, passes: &[(&str, &[TraceRow])], columns: &[Column]) -> Result<Vec<u8>, Failure> {
    let unit = view.unit;
    let over = |column: Column, rows: &[TraceRow], f: Of| {
        rows.iter().map(|r| (unit.said(r.s_mm), column.said(unit, f(r)))).collect::<Vec<_>>()
    };
    let diagrams = |column: &Column| match passes {
        [(_, rows)] => {
            let curve = |(name, ink, f): (&'static str, Ink, Of)| Curve::new(name, ink, over(*column, rows, f));
            vec![Panel::new(column.named(unit), column.single().into_iter().map(curve).collect())]
        }
        several => {
            let curves = |f: Of| {
                let each = several.iter().zip(INKS);
                each.map(move |((name, rows), ink)| Curve::new(*name, ink, over(*column, rows, f))).collect()
            };
            column.several(unit).into_iter().map(|(named, f)| Panel::new(named, curves(f))).collect()
        }
    };
    let title = if passes.len() == 1 { "One pass along the contour" } else { "Passes along the contour" };
    let rows: Vec<Panel> = columns.iter().flat_map(diagrams).collect();
    panels(view, title, &rows)
}
