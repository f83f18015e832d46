//! A plan of dimensions as a sheet to print and as the file that its numbers are typed into.

use std::fmt::Write;

use truepath_ground::length::Unit;

use super::dimensions::{DimensionPlan, PlannedDimension};

/// The file of dimensions with its values to be typed in, in the unit of the program. `sheet` names the printed
/// sheet.
pub fn table(plan: &DimensionPlan, sheet: &str) -> String {
    let unit = plan.unit;
    let head = format!(
        "# Dimensions of the milled part, in the order of {sheet}: type what was read between the quotation marks.\n\
         # uncertainty_mm is what a reading stays within, ±, at two standard deviations (k = 2): about 95 of 100 readings.\n\
         # A dimension that cannot be taken: delete it, from [[dimension]] to its value_mm.\n\
         version = 1\n"
    );
    let mut text = unit.keys(&head).into_owned();
    for (k, d) in plan.dimensions.iter().enumerate() {
        let key = if d.along == "x" { "y_mm" } else { "x_mm" };
        let across = match unit {
            Unit::Millimetre => d.across_mm.to_string(),
            Unit::Inch => format!("{:.3}", unit.of(d.across_mm)),
        };
        let one = format!(
            "\n[[dimension]]  # {}: {}{}; nominal {:.3} {}\nname = \"{}\"\nkind = \"{}\"\nalong = \"{}\"\n{key} = {across}\nnear_mm = {:.3}\nz_mm = {:.3}\ninstrument = \"{}\"\nuncertainty_mm = {}\nvalue_mm = \"\"\n",
            k + 1,
            of(d),
            d.words(unit),
            unit.of(d.nominal_mm),
            unit.name(),
            k + 1,
            d.kind,
            d.along,
            unit.of(middle(d)),
            unit.of(d.z_mm),
            plan.instrument,
            unit.of(plan.uncertainty_mm),
        );
        text += &unit.keys(&one);
    }
    text
}

/// The contour, or both, with a colon; empty where there is one alone.
fn of(d: &PlannedDimension) -> String {
    let of = d.of();
    if of.is_empty() { of } else { of + ": " }
}

fn middle(d: &PlannedDimension) -> f64 {
    0.5 * (d.walls_mm[0] + d.walls_mm[1])
}

/// The sheet: what to measure where, with room for the numbers, in HTML that needs nothing else. `table` names the file that they
/// are typed into.
pub fn sheet(plan: &DimensionPlan, title: &str, table: &str) -> String {
    let (mut rows, unit, name) = (String::new(), plan.unit, plan.unit.name());
    for (k, d) in plan.dimensions.iter().enumerate() {
        let contour = escaped(&of(d));
        let _ = writeln!(
            rows,
            "<tr><td>{}</td><td>{contour}{}<br><small>{}</small></td><td>{:.2}</td><td>{:.3}</td><td class=room></td></tr>",
            k + 1,
            escaped(&d.words(unit)),
            escaped(&d.why),
            unit.of(d.z_mm),
            unit.of(d.nominal_mm)
        );
    }
    let title = escaped(title);
    let within = match unit {
        Unit::Millimetre => plan.uncertainty_mm.to_string(),
        Unit::Inch => format!("{:.3}", unit.of(plan.uncertainty_mm)),
    };
    let beside = if unit == Unit::Inch { "Twenty thousandths" } else { "Half a millimetre" };
    let [before, after] = plan.wall_sigma_mm.map(|sigma| unit.of(sigma));
    format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>{title}: dimensions</title>\n<style>{STYLE}</style>\n\
         <h1>{title}: dimensions to measure</h1>\n\
         <p>Take them on the part as it was milled, cleaned and cold, with the same instrument ({}, ± {} {name} with k = 2: about 95 of 100 readings stay within). Coordinates are those of the program. {beside} beside the line does not matter. Let only the tips of the jaws touch, at the Z given; read each dimension twice and write down the mean.</p>\n\
         {}\n<table><thead><tr><th>No.</th><th>what</th><th>Z {name}</th><th>nominal {name}</th><th>read {name}</th></tr></thead>\n<tbody>\n{rows}</tbody></table>\n\
         <p>Type the numbers into {}. They leave the predicted wall uncertain by {after:.3} {name} (one standard deviation); {before:.3} {name} without them.</p>\n\
         <p class=sign>part ................................ instrument ................................ date and name ................................</p>\n</html>\n",
        plan.instrument.replace('_', " "),
        within,
        drawing(plan),
        escaped(table)
    )
}

const STYLE: &str = "body{font:11pt/1.4 sans-serif;max-width:190mm;margin:8mm auto;color:#000;background:#fff}\
    h1{font-size:15pt}table{border-collapse:collapse;width:100%}th,td{border:1px solid #777;padding:2mm;text-align:left;vertical-align:top}\
    td.room{width:35mm}small{color:#444}svg{display:block;width:100%;max-height:95mm}.sign{margin-top:12mm}\
    tr{break-inside:avoid}";

/// The walls to scale with a numbered line for each dimension.
fn drawing(plan: &DimensionPlan) -> String {
    let all = || plan.outlines.iter().flatten();
    let bound = |axis: usize, start: f64, of: fn(f64, f64) -> f64| all().map(|p| p[axis]).fold(start, of);
    let [left, bottom] = [0, 1].map(|axis| bound(axis, f64::INFINITY, f64::min));
    let [right, top] = [0, 1].map(|axis| bound(axis, f64::NEG_INFINITY, f64::max));
    let size = (right - left).max(top - bottom).max(1.0);
    let room = 0.06 * size;
    let mut text = format!(
        "<svg viewBox=\"{:.3} {:.3} {:.3} {:.3}\" fill=\"none\" stroke=\"#000\" stroke-width=\"{:.3}\" font-size=\"{:.3}\">",
        left - room,
        -top - room,
        right - left + 2.0 * room,
        top - bottom + 2.0 * room,
        0.004 * size,
        0.04 * size
    );
    for outline in &plan.outlines {
        let every = outline.len().div_ceil(800).max(1);
        let points: Vec<String> =
            outline.iter().step_by(every).chain(outline.last()).map(|[x, y]| format!("{x:.3},{:.3}", -y)).collect();
        let _ = write!(text, "<polyline points=\"{}\"/>", points.join(" "));
    }
    let mut lines: Vec<(&PlannedDimension, Vec<usize>)> = Vec::new();
    for (k, d) in plan.dimensions.iter().enumerate() {
        let same = |other: &&mut (&PlannedDimension, Vec<usize>)| {
            (other.0.along, other.0.across_mm, other.0.walls_mm) == (d.along, d.across_mm, d.walls_mm)
        };
        match lines.iter_mut().find(same) {
            Some((_, numbers)) => numbers.push(k + 1),
            None => lines.push((d, vec![k + 1])),
        }
    }
    for (nth, (d, numbers)) in lines.iter().enumerate() {
        let point = |along: f64| if d.along == "x" { [along, -d.across_mm] } else { [d.across_mm, -along] };
        let [[x1, y1], [x2, y2]] = d.walls_mm.map(point);
        // Numbers of crossing lines stand apart.
        let share = 0.25 + 0.5 * (nth as f64 * 0.37).fract();
        let [x, y] = [x1 + share * (x2 - x1), y1 + share * (y2 - y1)];
        let numbers: Vec<String> = numbers.iter().map(ToString::to_string).collect();
        let _ = write!(
            text,
            "<path stroke=\"#06c\" d=\"M{x1:.3} {y1:.3}L{x2:.3} {y2:.3}\"/><text stroke=\"none\" fill=\"#06c\" x=\"{x:.3}\" y=\"{:.3}\">{}</text>",
            y - 0.01 * size,
            numbers.join(", ")
        );
    }
    text + "</svg>"
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
