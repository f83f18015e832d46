//! `before-after.svg`: the walls of a pocket before and after, along the contour, with the shift that was applied.

use super::design::Designed;
use super::process::{Cutting, Mode};
use super::station::Station;
use crate::diagnostics::Failure;
use crate::plot::{COLOURS, Curve, panels};

/// The picture.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn before_after(
    stations: &[Station],
    designed: &Designed,
    mode: Mode,
    tolerance_mm: f64,
) -> Result<Vec<u8>, Failure> {
    let along = |f: &dyn Fn(usize) -> f64| stations.iter().enumerate().map(|(i, s)| (s.s_mm, f(i))).collect::<Vec<_>>();
    let wall = |cut: &[Cutting], far: bool| along(&|i| if far { cut[i].walls.far } else { cut[i].walls.near });
    let (before, after) = (&designed.before, &designed.after);
    let end = stations.last().map_or(0.0, |s| s.s_mm);
    let limit = |value: f64, name| Curve { name, points: vec![(0.0, value), (end, value)], colour: COLOURS[0] };
    let errors = |far| {
        let mut curves = vec![
            Curve::before("program as it is", wall(before, far)),
            Curve::after("compensated", wall(after, far)),
            limit(tolerance_mm, "band"),
        ];
        // One entry of the legend for both lines.
        curves[2].points.extend([(f64::NAN, f64::NAN), (0.0, -tolerance_mm), (end, -tolerance_mm)]);
        curves
    };
    let engaged = along(&|i| before[i].engaged_rad.to_degrees());
    let shift = along(&|i| designed.shift_mm[i]);
    let plain = |name, points, colour| vec![Curve { name, points, colour }];
    let mut rows = vec![("engaged, degrees", plain("engagement angle", engaged, COLOURS[0]))];
    rows.push((if mode == Mode::Slot { "near wall error, mm" } else { "wall error, mm" }, errors(false)));
    if mode == Mode::Slot {
        rows.push(("far wall error, mm", errors(true)));
    }
    rows.push(("shift, mm", plain("towards the near wall", shift, COLOURS[2])));
    let title = match mode {
        Mode::Wall => "Finishing a pocket: the wall before and after, as predicted",
        Mode::Slot => "Slot: both walls before and after, as predicted",
    };
    panels(title, &rows)
}
