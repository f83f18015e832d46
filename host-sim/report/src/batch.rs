//! The page of a batch: what asks for action, what moves from part to part, the chart of every place.
//!
//! One file without scripts, which opens from disk.

use maud::{DOCTYPE, Markup, PreEscaped, html};
use truepath_batch::batch::{Batch, Known, PlaceChart, State};
use truepath_batch::series::Event;
use truepath_chart::curve::{Band, Curve};
use truepath_chart::panel::{Mark, Panel, panels_over};
use truepath_chart::style::{DARK, INK_AFTER, INK_BEFORE, Ink, NOMINAL};
use truepath_chart::view::View;
use truepath_ground::count::counted;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;

const STYLE: &str = include_str!("planned.css");
/// Places come first, and all columns of theirs are numbers.
const OWN_STYLE: &str = ".places th:first-child, .places td:first-child { text-align: left; white-space: normal; min-width: 9rem } \
    .places th:last-child, .places td:last-child { text-align: right; white-space: nowrap; min-width: 0 } figure svg { background: #fff }";
/// The axis of the charts.
const PARTS: &str = "part";

/// The page of a batch, with lengths in a unit.
///
/// # Errors
/// Internal, when a chart cannot be drawn.
pub fn batch_page(batch: &Batch, name: &str, unit: Unit) -> Result<String, Failure> {
    let worst = batch.worst();
    // A chart of one part has no width.
    let level = if batch.states.len() > 1 { Some(moves(batch, unit)?) } else { None };
    let chart = worst
        .filter(|place| place.deviations_mm.len() > 1)
        .map(|place| control_chart(batch, place, unit))
        .transpose()?;
    let nearest =
        if batch.tolerance_mm.is_some() { "The place nearest to its limit" } else { "The place that is farthest off" };
    let page = html! {
        (DOCTYPE)
        html lang="en" {
            head {
                meta charset="utf-8";
                meta name="viewport" content="width=device-width, initial-scale=1";
                title { "Batch: " (name) }
                style { (PreEscaped(STYLE)) (PreEscaped(OWN_STYLE)) }
            }
            body {
                main {
                    h1 { "Batch: " (name) }
                    p.verdict { (verdict(batch)) }
                    ul { @for text in batch.words(unit) { li { (text) } } }
                    p.soft {
                        (counted(batch.touched, "part")) " touched, " (batch.parts[0]) " to " (batch.parts[1]) "; a reading repeats to ± "
                        (um(2.0 * batch.noise_mm, unit)) " " (unit.small_name()) " (2 sigma) beside what is told here"
                    }
                    @if let Some(svg) = level {
                        h2 { "What moves from part to part" }
                        figure { (PreEscaped(svg)) figcaption { "with two standard deviations to either side; since the first part" } }
                    }
                    @if let (Some(place), Some(svg)) = (worst, chart) {
                        h2 { (nearest) }
                        figure { (PreEscaped(svg)) figcaption { (place.place.words(unit)) ", individuals and exponentially weighted mean" } }
                    }
                    h2 { "Every place" }
                    div.scroll tabindex="0" role="region" aria-label="Every place" { (places(batch, unit)) }
                    h2 { "Part by part" }
                    div.scroll tabindex="0" role="region" aria-label="Part by part" { (parts(batch, unit)) }
                    p.soft {
                        "Standard deviations of places are those from part to part (moving range); limits are exceeded by chance once in thousands of parts. "
                        "Cpk with the interval that holds it with 95 %. Force level and radius count from the first part of the batch; ± is two standard deviations."
                    }
                }
            }
        }
    };
    Ok(page.into_string())
}

fn um(mm: f64, unit: Unit) -> String {
    format!("{:.1}", unit.small(mm))
}

/// How many of what the charts show are a millimetre: micrometres or inches.
fn per_mm(unit: Unit) -> f64 {
    if unit == Unit::Inch { unit.said(1.0) } else { 1e3 }
}

fn verdict(batch: &Batch) -> String {
    let parts = batch.alarms.len();
    match (parts, batch.next_in_tolerance, batch.leaves_at_part) {
        (0, Some(share), Some(part)) => {
            let percent = (100.0 * share).floor().min(99.0);
            format!(
                "Go on: the next part holds its tolerance everywhere with at least {percent:.0} %, until about part {part}."
            )
        }
        (0, Some(share), None) => {
            format!(
                "Go on: the next part holds its tolerance everywhere with at least {:.0} %.",
                (100.0 * share).floor().min(99.0)
            )
        }
        (0, None, _) => "Nothing asks for action. With a tolerance the page would say how long it is held.".to_owned(),
        (1, ..) => "Look at this batch before the next part:".to_owned(),
        (count, ..) => format!("Look at this batch before the next part, for {count} reasons:"),
    }
}

/// A curve: its name, its ink, and what of a state it shows.
type OfState = (&'static str, Ink, fn(&State) -> Known);

/// A state over the parts, with two standard deviations.
fn of_state(batch: &Batch, name: impl Into<String>, scale: f64, curves: &[OfState]) -> Panel {
    let points =
        |of: fn(&State) -> Known| batch.states.iter().map(|s| (f64::from(s.part), scale * of(s).value)).collect();
    let lines = curves.iter().map(|(name, ink, of)| Curve::new(*name, *ink, points(*of))).collect();
    let band = curves.first().map(|(_, _, of)| {
        let edges = batch.states.iter().map(|s| {
            let Known { value, sigma } = of(s);
            (f64::from(s.part), scale * (value - 2.0 * sigma), scale * (value + 2.0 * sigma))
        });
        Band { name: String::new(), colour: NOMINAL, edges: edges.collect() }
    });
    Panel { band, ..Panel::new(name, lines) }
}

fn moves(batch: &Batch, unit: Unit) -> Result<String, Failure> {
    let (known, small) = (batch.is_pushed(), unit.small_name());
    let mut rows = Vec::new();
    if known {
        rows.push(of_state(batch, "force level (%)", 100.0, &[("", INK_BEFORE, |s| s.force_level)]));
    }
    rows.push(of_state(
        batch,
        format!("radius lost ({small})"),
        per_mm(unit),
        &[("", INK_AFTER, |s| s.radius_lost_mm)],
    ));
    let datum: [OfState; 2] = [("X", INK_AFTER, |s| s.datum_mm[0]), ("Y", INK_BEFORE, |s| s.datum_mm[1])];
    rows.push(of_state(batch, format!("datum ({small})"), per_mm(unit), &datum));
    text(
        panels_over(&View { title: Some(String::new()), ..View::default() }, "", PARTS, &rows)?,
        "Force level, radius and datum over the parts",
    )
}

/// Individuals with their limits, and the weighted mean with its own.
fn control_chart(batch: &Batch, place: &PlaceChart, unit: Unit) -> Result<String, Failure> {
    let all = &place.deviations_mm;
    let (small, scale) = (unit.small_name(), per_mm(unit));
    let ends = [all.first(), all.last()].map(|p| p.map_or(0.0, |(part, _)| f64::from(*part)));
    let level =
        |name: &str, ink: Ink, value: f64| Curve::new(name, ink, ends.map(|part| (part, scale * value)).to_vec());
    let limit = Ink { colour: DARK, dashes: truepath_chart::style::DASHES };
    let tolerance = |name: &str, value: f64| level(name, INK_BEFORE, value);
    let both =
        |name: &str, limits: [f64; 2], of: &dyn Fn(&str, f64) -> Curve| vec![of(name, limits[0]), of("", limits[1])];
    let mut singles = Vec::new();
    if let Some(limits) = batch.tolerance_mm {
        singles.extend(both("tolerance", limits, &tolerance));
    }
    let mut rows = Vec::new();
    let points: Vec<(f64, f64)> = all.iter().map(|(part, d)| (f64::from(*part), scale * d)).collect();
    singles.push(Curve::new("deviation", INK_AFTER, points.clone()));
    let marks = points.iter().map(|(part, d)| Mark { s_mm: *part, value: *d, outlying: false }).collect();
    if let Some(chart) = &place.chart {
        singles.extend(both("control limits", chart.limits_mm, &|name, value| level(name, limit, value)));
        rows.push(Panel { marks, ..Panel::new(format!("deviation ({small})"), singles) });
        let weighted = all.iter().zip(&chart.ewma_mm).map(|((part, _), d)| (f64::from(*part), scale * d)).collect();
        let mut means = vec![Curve::new("weighted mean", INK_AFTER, weighted)];
        means.extend(both("control limits", chart.ewma_limits_mm, &|name, value| level(name, limit, value)));
        rows.push(Panel::new(format!("weighted mean ({small})"), means));
    } else {
        rows.push(Panel { marks, ..Panel::new(format!("deviation ({small})"), singles) });
    }
    text(
        panels_over(&View { title: Some(String::new()), ..View::default() }, "", PARTS, &rows)?,
        "Deviations of one place over the parts, with their limits",
    )
}

/// A chart as an element of the page, with its name for who cannot see it.
fn text(svg: Vec<u8>, name: &str) -> Result<String, Failure> {
    let svg = String::from_utf8(svg).map_err(|e| Failure::Internal(format!("a chart is no text: {e}")))?;
    let element = svg.find("<svg").map_or("", |at| &svg[at..]);
    Ok(element.replacen("<title></title>", &format!("<title>{name}</title>"), 1))
}

fn places(batch: &Batch, unit: Unit) -> Markup {
    let small = unit.small_name();
    html! {
        table.places {
            thead { tr {
                th { "place" } th { "parts" } th { "mean, " (small) } th { "sigma, " (small) } th { "next, " (small) } th { "Cp" } th { "Cpk" } th { "Cpk, 95 %" }
            } }
            tbody {
                @for p in &batch.places {
                    @let capable = p.chart.as_ref().and_then(|chart| chart.capability);
                    tr {
                        td { (p.place.words(unit)) }
                        td { (p.deviations_mm.len()) }
                        td { @if let Some(chart) = &p.chart { (um(chart.mean_mm, unit)) } }
                        td { @if let Some(chart) = &p.chart { (um(chart.sigma_mm, unit)) } }
                        td { (um(p.next_mm.value, unit)) " ± " (um(2.0 * p.next_mm.sigma, unit)) }
                        td { @if let Some(c) = capable { (format!("{:.2}", c.cp)) } }
                        td class=(if capable.is_none_or(|c| c.cpk >= 1.33) { "" } else { "no" }) { @if let Some(c) = capable { (format!("{:.2}", c.cpk)) } }
                        td { @if let Some(c) = capable { (format!("{:.2} to {:.2}", c.cpk_95[0], c.cpk_95[1])) } }
                    }
                }
            }
        }
    }
}

fn parts(batch: &Batch, unit: Unit) -> Markup {
    let small = unit.small_name();
    let pushed = batch.is_pushed();
    let event = |e: &Event| match e {
        Event::Cutter => "new cutter",
        Event::Lot => "new lot",
        Event::Setup => "set up anew",
    };
    html! {
        table {
            thead { tr { th { "part" } @if pushed { th { "force level" } } th { "radius lost, " (small) } th { "datum X, " (small) } th { "datum Y, " (small) } th { "remarks" } } }
            tbody {
                @for s in &batch.states {
                    tr {
                        td { (s.part) }
                        @if pushed {
                            td { (format!("{:+.1} ± {:.1} %", 100.0 * s.force_level.value, 200.0 * s.force_level.sigma)) }
                        }
                        @for known in [&s.radius_lost_mm, &s.datum_mm[0], &s.datum_mm[1]] {
                            td { (um(known.value, unit)) " ± " (um(2.0 * known.sigma, unit)) }
                        }
                        td {
                            @for e in &s.events { (event(e)) " " }
                            @if s.step { span.no { "does not go on as those before " } }
                            @if s.wild > 0 { (counted(s.wild, "wild reading")) }
                        }
                    }
                }
            }
        }
    }
}
