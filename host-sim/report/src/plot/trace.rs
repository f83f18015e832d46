//! The traces of a pass over the contour; those of several passes over each other.

use truepath_chart::curve::Curve;
use truepath_chart::panel::{Panel, panels};
use truepath_chart::style::{ALONG_X, DARK, INK_AFTER, INK_ALONG_Y, INK_MAGNITUDE, INKS, Ink};
use truepath_chart::view::View;
use truepath_ground::diagnostics::Failure;

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
    const fn unit(self) -> &'static str {
        match self {
            Self::Arc => "engagement (°)",
            Self::Chip => "chip area (mm²)",
            Self::Force | Self::Components => "mean force (N)",
            Self::Deflection => "deflection (mm)",
            Self::Error => "wall error (mm)",
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
    fn several(self) -> Vec<(&'static str, Of)> {
        match self {
            Self::Arc => vec![(self.unit(), |r| r.arc_deg)],
            Self::Chip => vec![(self.unit(), |r| r.chip_area_mm2)],
            Self::Force => vec![(self.unit(), |r| r.force_n)],
            Self::Components => vec![("mean force X (N)", |r| r.fx_n), ("mean force Y (N)", |r| r.fy_n)],
            Self::Deflection => vec![("deflection X (mm)", |r| r.dx_mm), ("deflection Y (mm)", |r| r.dy_mm)],
            Self::Error => vec![(self.unit(), |r| r.error_mm)],
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
    let over = |rows: &[TraceRow], f: Of| rows.iter().map(|r| (r.s_mm, f(r))).collect::<Vec<_>>();
    let diagrams = |column: &Column| match passes {
        [(_, rows)] => {
            let curve = |(name, ink, f): (&'static str, Ink, Of)| Curve::new(name, ink, over(rows, f));
            vec![Panel::new(column.unit(), column.single().into_iter().map(curve).collect())]
        }
        several => {
            let curves =
                |f: Of| several.iter().zip(INKS).map(move |((name, rows), ink)| Curve::new(*name, ink, over(rows, f)));
            column.several().into_iter().map(|(unit, f)| Panel::new(unit, curves(f).collect())).collect()
        }
    };
    let title = if passes.len() == 1 { "One pass along the contour" } else { "Passes along the contour" };
    let rows: Vec<Panel> = columns.iter().flat_map(diagrams).collect();
    panels(view, title, &rows)
}
