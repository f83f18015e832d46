//! `report.html`: one page without scripts, which opens from disk: coefficients, mean force over feed, and a revolution of
//! every record.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use plotters::prelude::*;
use truepath_chart::style::{AFTER, BEFORE, DARK, FONT, LIGHT, failed, legend};
use truepath_ground::diagnostics::Failure;
use truepath_job::job::MATERIALS;

use crate::analysis::{Analysis, CutResult};
use crate::cut::Cut;
use crate::fit::{Along, average};

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;max-width:56rem;margin:2rem auto;padding:0 1rem;color:#222}\
    table{border-collapse:collapse;margin:1rem 0}td,th{padding:.2rem .7rem;text-align:right;border-bottom:1px solid #ddd}\
    td:first-child,th:first-child{text-align:left}svg{max-width:100%;height:auto}.soft{color:#666}li{margin:.3rem 0}";
const NAMES: [&str; 4] = ["Ktc, N/mm²", "Krc, N/mm²", "Kte, N/mm", "Kre, N/mm"];

/// The page.
///
/// # Errors
/// Internal, when a picture cannot be drawn.
pub fn page(analysis: &Analysis) -> Result<String, Failure> {
    let over_feed = over_feed(analysis)?;
    let turns = analysis.cuts.iter().filter_map(|cut| revolution(cut).transpose()).collect::<Result<Vec<_>, _>>()?;
    Ok(html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "Measured forces" }
                style { (PreEscaped(STYLE)) }
            }
            body {
                h1 { "Measured forces" }
                @if let Some(axes) = &analysis.axes { p.soft { "Columns taken as " code { (axes) } } }
                h2 { "Coefficients for the job" }
                (coefficients(analysis))
                @if !analysis.warnings.is_empty() {
                    h2 { "What the records leave open" }
                    ul { @for warning in &analysis.warnings { li { (warning) } } }
                }
                h2 { "Mean force over feed" }
                (PreEscaped(over_feed))
                (means(analysis))
                h2 { "Laws" }
                (laws(analysis))
                @if !turns.is_empty() { h2 { "Over a revolution" } }
                @for turn in &turns { (PreEscaped(turn)) }
            }
        }
    }
    .into_string())
}

fn coefficients(analysis: &Analysis) -> Markup {
    let linear = &analysis.linear;
    html! {
        table {
            thead { tr { th { "" } @for name in NAMES { th { (name) } } } }
            tbody {
                tr { td { b { "measured" } } @for c in linear.coefficients { td { b { (format!("{:.1} ± {:.1}", c.value, c.sigma)) } } } }
                @for material in MATERIALS {
                    tr {
                        td { (material.name) @if material.name == analysis.nearest.0 { (format!(" (nearest: forces within {:.0} %)", analysis.nearest.1)) } }
                        @for c in material.coefficients { td { (c) } }
                    }
                }
            }
        }
        p.soft { (format!("Between {:.4} and {:.4} mm per tooth. Correlation: ", linear.feeds_mm[0], linear.feeds_mm[1]))
            @for (i, j) in [(0, 2), (1, 3), (0, 1)] { (format!("{} with {} {:.2}; ", &NAMES[i][..3], &NAMES[j][..3], linear.correlation[i][j])) }
        }
    }
}

fn means(analysis: &Analysis) -> Markup {
    html! {
        table {
            thead { tr { th { "cut" } th { "mm/tooth" } th { "" } th { "measured" } th { "laws" } th { "linear" } th { "laws off" } } }
            tbody {
                @for cut in &analysis.cuts { @for m in &cut.means {
                    tr {
                        td { (cut.name) @if !cut.fitted { " (predicted)" } }
                        td { (format!("{:.4}", cut.cut.feed_per_tooth_mm)) }
                        td { (match m.measured.along { Along::Feed => "feed, N", Along::Across => "across, N", Along::Torque => "torque, N·m" }) }
                        td { (format!("{:.2} ± {:.2}", m.measured.value, m.measured.sigma)) }
                        td { (format!("{:.2} ± {:.2}", m.law, m.law_sigma)) }
                        td { (format!("{:.2}", m.linear)) }
                        td { (format!("{:+.1} %", 100.0 * (m.law / m.measured.value - 1.0))) }
                    }
                } }
            }
        }
    }
}

fn laws(analysis: &Analysis) -> Markup {
    html! {
        table {
            thead { tr { th { "tangential" } th { "radial" } th { "probability" } th { "χ²" } th { "means within" } } }
            tbody {
                @for law in analysis.laws.iter().take(8) {
                    tr {
                        td { (law.model.laws[0].words()) } td { (law.model.laws[1].words()) }
                        td { (format!("{:.1} %", 100.0 * law.weight)) } td { (format!("{:.1}", law.chi2)) }
                        td { (format!("{:.1} %", 100.0 * law.worst)) }
                    }
                }
            }
        }
    }
}

/// Name, colour and points of a line.
type Series = (String, RGBColor, Vec<(f64, f64)>);

/// A diagram of series of points joined by lines, with marks that carry standard deviations.
fn diagram(caption: &str, [x, y]: [&str; 2], lines: &[Series], marks: &[(f64, f64, f64)]) -> Result<String, Failure> {
    let all = || {
        lines
            .iter()
            .flat_map(|l| l.2.iter().copied())
            .chain(marks.iter().flat_map(|m| [(m.0, m.1 - m.2), (m.0, m.1 + m.2)]))
    };
    let (x0, x1) = all().fold((f64::MAX, f64::MIN), |(l, h), p| (l.min(p.0), h.max(p.0)));
    let (y0, y1) = all().fold((0.0f64, 0.0f64), |(l, h), p| (l.min(p.1), h.max(p.1)));
    let margin = 0.06 * (y1 - y0).max(1e-9);
    let mut text = String::new();
    {
        let root = SVGBackend::with_string(&mut text, (860, 340)).into_drawing_area();
        root.fill(&WHITE).map_err(failed)?;
        let mut chart = ChartBuilder::on(&root)
            .caption(caption, (FONT, 15))
            .margin(8)
            .x_label_area_size(38)
            .y_label_area_size(64)
            .build_cartesian_2d(x0..x1.max(x0 + 1e-9), y0 - margin..y1 + margin)
            .map_err(failed)?;
        chart
            .configure_mesh()
            .light_line_style(WHITE)
            .bold_line_style(LIGHT)
            .x_desc(x)
            .y_desc(y)
            .label_style((FONT, 13))
            .axis_desc_style((FONT, 13))
            .draw()
            .map_err(failed)?;
        for (name, colour, points) in lines {
            let colour = *colour;
            chart
                .draw_series(LineSeries::new(points.iter().copied(), colour.stroke_width(2)))
                .map_err(failed)?
                .label(name)
                .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(2)));
        }
        for (x, y, sigma) in marks {
            let bar = PathElement::new([(*x, y - sigma), (*x, y + sigma)], DARK.stroke_width(2));
            chart.draw_series([bar]).map_err(failed)?;
            chart.draw_series([Circle::new((*x, *y), 4, DARK.filled())]).map_err(failed)?;
        }
        if !lines.is_empty() {
            legend(&mut chart, 1)?;
        }
        root.present().map_err(failed)?;
    }
    Ok(text)
}

/// Mean forces at the engagement of the first cut.
fn over_feed(analysis: &Analysis) -> Result<String, Failure> {
    let Some(first) = analysis.cuts.first() else { return Ok(String::new()) };
    let same = |c: &&CutResult| (c.cut.arc_rad, c.cut.axial_depth_mm) == (first.cut.arc_rad, first.cut.axial_depth_mm);
    let most = analysis.cuts.iter().filter(same).map(|c| c.cut.feed_per_tooth_mm).fold(0.0, f64::max);
    let model = analysis.linear.model();
    let mut lines = Vec::new();
    for (along, colour) in first.means.iter().map(|m| m.measured.along).zip([AFTER, BEFORE]) {
        let name = match along {
            Along::Feed => "feed",
            Along::Across => "across",
            Along::Torque => "torque",
        };
        let over = |value: &dyn Fn(&Cut) -> f64| -> Vec<(f64, f64)> {
            (1..=60)
                .map(|k| 1.1 * most * f64::from(k) / 60.0)
                .map(|f| (f, value(&Cut { feed_per_tooth_mm: f, ..first.cut.clone() })))
                .collect()
        };
        lines.push((format!("{name}, laws"), colour, over(&|cut| average(&analysis.laws, cut, along).0)));
        lines.push((format!("{name}, linear"), DARK, over(&|cut| model.mean(cut, along))));
    }
    let marks = analysis
        .cuts
        .iter()
        .filter(same)
        .flat_map(|c| c.means.iter().map(|m| (c.cut.feed_per_tooth_mm, m.measured.value, m.measured.sigma)));
    let unit = if first.means.iter().any(|m| m.measured.along == Along::Torque) {
        "N·m"
    } else {
        "mean force on the tool, N"
    };
    diagram(
        "measured, with one standard deviation, and the laws",
        ["feed per tooth, mm", unit],
        &lines,
        &marks.collect::<Vec<_>>(),
    )
}

/// The mean revolution of a record, and what is fitted over it.
fn revolution(cut: &CutResult) -> Result<Option<String>, Failure> {
    let Some(turn) = &cut.turn else { return Ok(None) };
    let degrees = |k: usize, n: usize| 360.0 * k as f64 / n as f64;
    let mut lines = Vec::new();
    for (k, (name, colour)) in [("feed", AFTER), ("across", BEFORE)].into_iter().enumerate() {
        let over =
            |values: &[f64]| values.iter().enumerate().map(|(n, v)| (degrees(n, values.len()), *v)).collect::<Vec<_>>();
        lines.push((format!("{name}, recorded"), colour, over(&turn.recorded[k])));
        if let Some(fit) = &turn.fitted {
            lines.push((format!("{name}, fit"), DARK, over(&fit[k])));
            let rest: Vec<f64> = turn.recorded[k].iter().zip(&fit[k]).map(|(a, b)| a - b).collect();
            lines.push((format!("{name}, residual"), LIGHT, over(&rest)));
        }
    }
    let runout = cut.shape.as_ref().map_or_else(String::new, |s| {
        if s.believed {
            format!(": runout {:.4} ± {:.4} mm", s.runout_mm, s.runout_sigma_mm)
        } else {
            format!(": the fit explains {:.0} %", 100.0 * s.explained)
        }
    });
    diagram(&format!("{}{runout}", cut.name), ["angle of the spindle, degrees", "force on the tool, N"], &lines, &[])
        .map(Some)
}
