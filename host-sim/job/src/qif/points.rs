//! The points of a QIF document as a file of columns, which the one reader of probe files then reads.
//!
//! Points with coordinates are `PointFeatureMeasurement` and `EdgePointFeatureMeasurement` with a `Location`: places of the surface. Where
//! there are none, the `MeasuredPointSet` are taken, which are of the surface when they are compensated for the ball's radius.

use std::fmt::Write;

use roxmltree::Node;
use truepath_core::probe::{Columns, DecimalSign, Frame, Layout, LengthUnit, PointKind, Separator};
use truepath_ground::decimal::Decimal;
use truepath_ground::diagnostics::{InputError, Source};

use super::{Qif, child, children, start};
use crate::codes::M053;

/// How the columns of [`as_columns`] are to be read.
pub(crate) const LAYOUT: Layout = Layout {
    columns: Some(Columns::XYZ),
    separator: Separator::Comma,
    decimal: DecimalSign::Point,
    frame: Frame::Work,
    point: PointKind::Surface,
    unit: LengthUnit::Millimetre,
};

/// The points of a document as a text of columns under its name. Every point stands in the line that it has in the document, so that
/// errors name it; where a line of the document holds several, those behind the first follow in the lines after it.
///
/// # Errors
/// `M052` for what is no QIF 3 document, `M053` for one without points of the surface.
pub(crate) fn as_columns(file: &Source) -> Result<(Layout, Source), InputError> {
    let qif = Qif::read(file)?;
    let mut text = String::new();
    let mut line = 1;
    for (at, [x, y, z]) in points(&qif)? {
        let (own, _) = file.line_column(at);
        while line < own {
            text.push('\n');
            line += 1;
        }
        // Writing to a string cannot fail.
        let _ = writeln!(text, "{},{},{}", exact(x), exact(y), exact(z));
        line += 1;
    }
    Ok((LAYOUT, Source::new(file.name(), text.into_bytes())))
}

/// Points with the place where they stand.
fn points(qif: &Qif<'_>) -> Result<Vec<(usize, [Decimal; 3])>, InputError> {
    let located = |results: Node<'_, '_>| {
        child(results, "MeasuredFeatures").is_some_and(|all| all.children().any(|one| location(one).is_some()))
    };
    let mut found = Vec::new();
    if let Some(results) = qif.results(located)? {
        let all = child(results, "MeasuredFeatures").into_iter().flat_map(|all| all.children());
        for place in all.filter_map(location) {
            found.push((place.range().start, qif.triple(place)?));
        }
        return Ok(found);
    }
    if let Some(results) = qif.results(|results| child(results, "MeasuredPointSets").is_some())? {
        let sets = child(results, "MeasuredPointSets").into_iter().flat_map(|all| children(all, "MeasuredPointSet"));
        for set in sets {
            let compensated = child(set, "Compensated").and_then(|node| node.text()).map(str::trim);
            if !matches!(compensated, Some("true" | "1")) {
                let error = M053.error("measured points that are not compensated for the ball", "Compensated true");
                return Err(error.at(qif.source, start(set)));
            }
            let Some(points) = child(set, "Points") else { continue };
            found.extend(rows(qif, points)?);
        }
    }
    if found.is_empty() {
        let error = M053.error(
            format!("{} holds no point with coordinates", qif.source.name()),
            "PointFeatureMeasurement with a Location, or a MeasuredPointSet",
        );
        return Err(error.at(qif.source, start(qif.tree.root_element())));
    }
    Ok(found)
}

/// Where a measured point lies.
fn location<'t, 'a>(node: Node<'t, 'a>) -> Option<Node<'t, 'a>> {
    let is_point = matches!(node.tag_name().name(), "PointFeatureMeasurement" | "EdgePointFeatureMeasurement");
    child(node, "Location").filter(|_| is_point)
}

/// The points of a set, three numbers each.
fn rows(qif: &Qif<'_>, points: Node<'_, '_>) -> Result<Vec<(usize, [Decimal; 3])>, InputError> {
    let text = points.text().unwrap_or_default();
    let wrong = || {
        let error = M053.error("Points that are no list of coordinates", "three numbers for each point");
        error.at(qif.source, start(points))
    };
    let all: Option<Vec<Decimal>> = text.split_ascii_whitespace().map(|number| qif.decimal(number)).collect();
    let all = all.filter(|all| all.len() % 3 == 0).ok_or_else(wrong)?;
    let place = points.range().start;
    Ok(all.chunks_exact(3).map(|row| (place, [row[0], row[1], row[2]])).collect())
}

/// Millimetres with all their nanometres.
fn exact(value: Decimal) -> String {
    let nm = value.as_mm().nm();
    let sign = if nm < 0 { "-" } else { "" };
    format!("{sign}{}.{:06}", nm.unsigned_abs() / 1_000_000, nm.unsigned_abs() % 1_000_000)
}
