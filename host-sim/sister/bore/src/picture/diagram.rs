//! The profile diagram: radius over angle all round, and a few marks with the curves of the teeth that leave them.

use std::f64::consts::TAU;

use plotters::coord::Shift;
use plotters::prelude::*;
use truepath_ground::diagnostics::Failure;

use super::{BLUE, DARK, FINE, FONT, LIGHT, TEETH, failed, legend, shown};
use crate::envelope::Profile;
use crate::passes::ToothPass;

/// Marks in the enlarged part: this many turns of the cutter.
const TURNS: f64 = 3.0;
const POINTS: usize = 1600;
/// Width and height as shown.
const SHOWN: (i32, i32) = (1000, 700);

type Panel<'a> = DrawingArea<SVGBackend<'a>, Shift>;

/// Draws a profile; `title` names the bore.
///
/// # Errors
/// Internal, when it cannot be drawn.
pub fn diagram(title: &str, profile: &Profile) -> Result<Vec<u8>, Failure> {
    let mut text = String::new();
    {
        let root =
            SVGBackend::with_string(&mut text, ((FINE * SHOWN.0) as u32, (FINE * SHOWN.1) as u32)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let page = root.titled(title, (FONT, FINE * 18)).map_err(failed)?;
        let (top, bottom) = page.split_vertically(FINE * 300);
        whole(&top, profile)?;
        enlarged(&bottom, profile)?;
        root.present().map_err(failed)?;
    }
    Ok(shown(text, SHOWN))
}

/// Deviation from the deepest circle, µm.
fn deviation(profile: &Profile, radius: f64) -> f64 {
    (radius - profile.passes.highest()) * 1e3
}

fn whole(panel: &Panel, profile: &Profile) -> Result<(), Failure> {
    let depth = profile.height() * 1e3;
    let mut chart = ChartBuilder::on(panel)
        .caption("all round", (FONT, FINE * 14))
        .margin(FINE * 8)
        .x_label_area_size(FINE * 36)
        .y_label_area_size(FINE * 70)
        .build_cartesian_2d(0.0..360.0, (-1.12 * depth)..(0.12 * depth))
        .map_err(failed)?;
    mesh(&mut chart, "angle along the travel, degrees")?;
    // Both ends of every stretch and its crest, so that no cusp is lost; where there are more than a line can show, all the same.
    let mut points: Vec<(f64, f64)> = Vec::new();
    let fine = (4000 / profile.stretches.len()).clamp(2, 24);
    for stretch in &profile.stretches {
        let arc = profile.passes.arc(&profile.passes.passes[stretch.pass]);
        for n in 0..=fine {
            let phi = stretch.from + (stretch.to - stretch.from) * n as f64 / fine as f64;
            points.push((phi.to_degrees(), deviation(profile, arc.wall(phi - stretch.crest).0)));
        }
    }
    let shifted = |turn: f64| points.iter().map(move |(x, y)| (x + turn, *y)).filter(|p| (0.0..=360.0).contains(&p.0));
    for turn in [-360.0, 0.0, 360.0] {
        chart.draw_series(LineSeries::new(shifted(turn), BLUE.stroke_width(FINE as u32))).map_err(failed)?;
    }
    Ok(())
}

fn enlarged(panel: &Panel, profile: &Profile) -> Result<(), Failure> {
    let (passes, depth) = (&profile.passes, profile.height() * 1e3);
    // A place away from where the cut begins and ends.
    let half = (TURNS / 2.0 * passes.motion.spacing()).min(TAU / 4.0);
    let middle = TAU / 4.0;
    let high = passes.highest();
    let x = |phi: f64| (phi - middle) * high;
    let mut chart = ChartBuilder::on(panel)
        .caption("near 90°: profile (dark) and the curves of the teeth that leave it", (FONT, FINE * 14))
        .margin(FINE * 8)
        .x_label_area_size(FINE * 36)
        .y_label_area_size(FINE * 70)
        .build_cartesian_2d(x(middle - half)..x(middle + half), (-2.2 * depth)..(0.7 * depth))
        .map_err(failed)?;
    mesh(&mut chart, "along the wall, mm")?;
    for tooth in 0..passes.teeth.len() {
        let (arc, colour) = (&passes.arcs[passes.arc_of[tooth]], TEETH[tooth % TEETH.len()]);
        let reach = (1.6 * passes.reach).min(arc.half_width());
        let mut named = false;
        let near = |p: &&ToothPass| p.tooth == tooth && (p.crest - middle).abs() < half + 1.6 * passes.reach;
        for pass in passes.passes.iter().filter(near) {
            let curve = (0..=120).map(|n| pass.crest + reach * (f64::from(n) / 60.0 - 1.0));
            let curve = curve.map(|phi| (x(phi), deviation(profile, arc.wall(phi - pass.crest).0)));
            let inside: Vec<_> = curve.filter(|p| (p.0 / high).abs() <= half && p.1 >= -2.2 * depth).collect();
            let seen = !inside.is_empty();
            let series =
                chart.draw_series(LineSeries::new(inside, colour.stroke_width(FINE as u32))).map_err(failed)?;
            if seen && !std::mem::replace(&mut named, true) && passes.teeth.len() <= 12 {
                let legend =
                    move |(x, y)| PathElement::new([(x, y), (x + FINE * 18, y)], colour.stroke_width(3 * FINE as u32));
                series.label(format!("tooth {}", tooth + 1)).legend(legend);
            }
        }
    }
    let phis = (0..=POINTS).map(|n| middle + half * (2.0 * n as f64 / POINTS as f64 - 1.0));
    let line = phis.map(|phi| (x(phi), deviation(profile, profile.at(phi).0)));
    chart.draw_series(LineSeries::new(line, DARK.stroke_width(2 * FINE as u32))).map_err(failed)?;
    legend(&mut chart, FINE)
}

type Chart<'a, 'b> = ChartContext<
    'a,
    SVGBackend<'b>,
    Cartesian2d<plotters::coord::types::RangedCoordf64, plotters::coord::types::RangedCoordf64>,
>;

fn mesh(chart: &mut Chart, x: &str) -> Result<(), Failure> {
    chart
        .configure_mesh()
        .light_line_style(WHITE)
        .bold_line_style(LIGHT.stroke_width(FINE as u32))
        .axis_style(DARK.stroke_width(FINE as u32))
        .set_all_tick_mark_size(FINE * 5)
        .x_desc(x)
        .y_desc("radius − largest radius, µm")
        .label_style((FONT, FINE * 13))
        .axis_desc_style((FONT, FINE * 13))
        .draw()
        .map_err(failed)
}
