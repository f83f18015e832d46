//! `before-after.svg`: the walls of a pocket before and after, along the contour, with the shift that was applied.

use truepath_chart::curve::Curve;
use truepath_chart::panel::{Panel, panels};
use truepath_chart::style::{ALONG_X, DARK};
use truepath_chart::view::View;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;
use truepath_job::job::Mode;

use super::design::Designed;
use super::process::Cutting;
use super::station::Station;

/// The picture, with lengths in a unit.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn before_after(
    stations: &[Station],
    designed: &Designed,
    mode: Mode,
    (tolerance_mm, unit): (f64, Unit),
) -> Result<Vec<u8>, Failure> {
    let along = |f: &dyn Fn(usize) -> f64| {
        stations.iter().enumerate().map(|(i, s)| (unit.said(s.s_mm), f(i))).collect::<Vec<_>>()
    };
    let name = unit.name();
    let wall =
        |cut: &[Cutting], far: bool| along(&|i| unit.said(if far { cut[i].walls.far } else { cut[i].walls.near }));
    let (before, after) = (&designed.before, &designed.after);
    let end = stations.last().map_or(0.0, |s| s.s_mm);
    let limit =
        |value: f64, name| Curve::new(name, DARK, [0.0, end].map(|s| (unit.said(s), unit.said(value))).to_vec());
    let errors = |far| {
        let mut curves = vec![
            Curve::before("program as it is", wall(before, far)),
            Curve::after("compensated", wall(after, far)),
            limit(tolerance_mm, "band"),
        ];
        // One entry of the legend for both lines.
        curves.push(limit(-tolerance_mm, ""));
        curves
    };
    let engaged = along(&|i| before[i].engaged_rad.to_degrees());
    let shift = along(&|i| unit.said(designed.shift_mm[i]));
    let plain = |name, points, colour| vec![Curve::new(name, colour, points)];
    let mut rows = vec![Panel::new("engagement (°)", plain("engagement angle", engaged, DARK))];
    let near = if mode == Mode::Slot { "near wall error" } else { "wall error" };
    rows.push(Panel::new(format!("{near} ({name})"), errors(false)));
    if mode == Mode::Slot {
        rows.push(Panel::new(format!("far wall error ({name})"), errors(true)));
    }
    rows.push(Panel::new(format!("shift ({name})"), plain("towards the near wall", shift, ALONG_X)));
    let title = match mode {
        Mode::Wall => "Finishing a pocket: the wall before and after, as predicted",
        Mode::Slot => "Slot: both walls before and after, as predicted",
    };
    panels(&View { unit, ..View::default() }, title, &rows)
}
