//! The traces of a pass over the contour; those of several passes over each other.

use plotters::style::RGBColor;

use super::curve::Curve;
use super::panel::{Panel, panels};
use super::style::{AFTER, ALONG_X, ALONG_Y, DARK, IN_ORDER};
use super::view::View;
use crate::diagnostics::Failure;
use crate::report::TraceRow;

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

    const fn unit(self) -> &'static str {
        match self {
            Self::Arc => "engagement (°)",
            Self::Chip => "chip area (mm²)",
            Self::Force | Self::Components => "mean force (N)",
            Self::Deflection => "deflection (mm)",
            Self::Error => "wall error (mm)",
        }
    }

    /// Curves of a single pass, each with its own colour.
    fn single(self) -> Vec<(&'static str, RGBColor, Of)> {
        match self {
            Self::Arc => vec![("engagement angle", DARK, |r| r.arc_deg)],
            Self::Chip => vec![("b·f·(1 − cos φ)", DARK, |r| r.chip_area_mm2)],
            Self::Force => vec![
                ("magnitude", DARK, |r| r.force_n),
                ("along X", ALONG_X, |r| r.fx_n),
                ("along Y", ALONG_Y, |r| r.fy_n),
            ],
            Self::Components => vec![("along X", ALONG_X, |r| r.fx_n), ("along Y", ALONG_Y, |r| r.fy_n)],
            Self::Deflection => vec![("along X", ALONG_X, |r| r.dx_mm), ("along Y", ALONG_Y, |r| r.dy_mm)],
            Self::Error => vec![("material left (+), gouge (−)", AFTER, |r| r.error_mm)],
        }
    }

    /// Curves of one of several passes: what each is named after the pass, and whether it is dashed.
    fn one_of_several(self) -> Vec<(&'static str, bool, Of)> {
        match self {
            Self::Arc => vec![("", false, |r| r.arc_deg)],
            Self::Chip => vec![("", false, |r| r.chip_area_mm2)],
            Self::Force => vec![("", false, |r| r.force_n)],
            Self::Components => vec![(", X", false, |r| r.fx_n), (", Y", true, |r| r.fy_n)],
            Self::Deflection => vec![(", X", false, |r| r.dx_mm), (", Y", true, |r| r.dy_mm)],
            Self::Error => vec![("", false, |r| r.error_mm)],
        }
    }
}

/// Most passes over each other: one for each colour that can be told apart.
pub const PASSES: usize = IN_ORDER.len();

/// Draws the columns of passes with their names; a single one needs none.
///
/// # Errors
/// As [`panels`].
pub fn trace(view: &View, passes: &[(&str, &[TraceRow])], columns: &[Column]) -> Result<Vec<u8>, Failure> {
    let over = |rows: &[TraceRow], f: Of| rows.iter().map(|r| (r.s_mm, f(r))).collect::<Vec<_>>();
    let curves = |column: &Column| match passes {
        [(_, rows)] => {
            let curve = |(name, colour, f): (&'static str, _, _)| Curve::new(name, colour, over(rows, f));
            column.single().into_iter().map(curve).collect()
        }
        several => several
            .iter()
            .zip(IN_ORDER)
            .flat_map(|((name, rows), colour)| {
                column.one_of_several().into_iter().map(move |(what, dashed, f)| Curve {
                    name: format!("{name}{what}"),
                    dashed,
                    ..Curve::new("", colour, over(rows, f))
                })
            })
            .collect(),
    };
    let title = if passes.len() == 1 { "One pass along the contour" } else { "Passes along the contour" };
    let rows: Vec<Panel> = columns.iter().map(|column| Panel::new(column.unit(), curves(column))).collect();
    panels(view, title, &rows)
}
