//! The tables of the commands, read back into the rows they were written from.

use truepath_correction::rows::CorrectionRow;
use truepath_ground::codes::Z007;
use truepath_ground::diagnostics::{InputError, Source};
use truepath_ground::sheet::{Line, each_line};

use super::wall::WallRow;
use crate::codes::{Z009, Z013};
use crate::tables::{Trace, TraceRow};

/// Columns of `trace.csv` that every one has.
const TRACE: [&str; 11] =
    ["s_mm", "x_mm", "y_mm", "arc_deg", "chip_area_mm2", "force_n", "fx_n", "fy_n", "dx_mm", "dy_mm", "error_mm"];
const CORRECTION: [&str; 8] =
    ["s_mm", "x_mm", "y_mm", "dx_mm", "dy_mm", "predicted_error_before_mm", "predicted_error_after_mm", "sigma_mm"];
const WALL: [&str; 5] = ["s_mm", "x_mm", "y_mm", "nx", "ny"];
const POINTS: [&str; 7] = ["status", "s_mm", "x_mm", "y_mm", "nx", "ny", "error_mm"];
const WALLS: [&str; 5] = ["law", "s_mm", "error_mm", "lowest_mm", "highest_mm"];

/// The wall beside a row, which must be of the same place; not a number without a wall.
fn beside(line: &Line, wall: Option<&[WallRow]>, row: usize, s_mm: f64) -> Result<[f64; 2], InputError> {
    let Some(wall) = wall else { return Ok([f64::NAN; 2]) };
    match wall.get(row) {
        Some(place) if (place.s_mm - s_mm).abs() < 1e-5 => Ok([place.x_mm, place.y_mm]),
        Some(place) => Err(line.refused(0, Z013, &format!("{} as in the same line of wall.csv", place.s_mm))),
        None => Err(line.refused(0, Z013, &format!("no more than the {} lines of wall.csv", wall.len()))),
    }
}

/// At least two places that are not the same.
fn enough(source: &Source, first: Option<f64>, last: Option<f64>) -> Result<(), InputError> {
    if first.zip(last).is_some_and(|(first, last)| last > first) {
        return Ok(());
    }
    let end = source.bytes().len();
    Err(Z009.error("the table has fewer than two places along the contour", "").at(source, end..end))
}

/// `wall.csv`.
///
/// # Errors
/// See the table of `sheet`.
pub fn read_wall(source: &Source) -> Result<Vec<WallRow>, InputError> {
    let mut rows: Vec<WallRow> = Vec::new();
    each_line(source, &WALL, |line| {
        let s_mm = line.along(0, rows.last().map(|r| r.s_mm))?;
        rows.push(WallRow {
            s_mm,
            x_mm: line.number(1)?,
            y_mm: line.number(2)?,
            nx: line.number(3)?,
            ny: line.number(4)?,
        });
        Ok(())
    })?;
    Ok(rows)
}

/// The rows of a table along a contour: `row` makes one of a line, its arc length and the wall beside it.
fn along_contour<R>(
    source: &Source,
    columns: &[&str],
    wall: Option<&[WallRow]>,
    row: impl Fn(&Line, f64, [f64; 2]) -> Result<R, InputError>,
) -> Result<Vec<R>, InputError> {
    let mut rows = Vec::new();
    let (mut first, mut last) = (None, None);
    each_line(source, columns, |line| {
        let s_mm = line.along(0, last)?;
        rows.push(row(line, s_mm, beside(line, wall, rows.len(), s_mm)?)?);
        (first, last) = (first.or(Some(s_mm)), Some(s_mm));
        Ok(())
    })?;
    enough(source, first, last)?;
    Ok(rows)
}

/// `trace.csv`, with the places of its `wall.csv` where they are needed.
///
/// # Errors
/// See the table of `sheet`; `Z013` when the wall is of another table.
pub fn read_trace(source: &Source, wall: Option<&[WallRow]>) -> Result<Trace, InputError> {
    along_contour(source, &TRACE, wall, |line, s_mm, [wall_x_mm, wall_y_mm]| {
        Ok(TraceRow {
            s_mm,
            x_mm: line.number(1)?,
            y_mm: line.number(2)?,
            arc_deg: line.known(3)?,
            chip_area_mm2: line.known(4)?,
            force_n: line.known(5)?,
            fx_n: line.known(6)?,
            fy_n: line.known(7)?,
            dx_mm: line.known(8)?,
            dy_mm: line.known(9)?,
            error_mm: line.known(10)?,
            wall_x_mm,
            wall_y_mm,
        })
    })
}

/// `correction.csv`; `wall` as in [`read_trace`].
///
/// # Errors
/// See the table of `sheet`; `Z013` when the wall is of another table.
pub fn read_correction(source: &Source, wall: Option<&[WallRow]>) -> Result<Vec<CorrectionRow>, InputError> {
    along_contour(source, &CORRECTION, wall, |line, s_mm, [wall_x_mm, wall_y_mm]| {
        let known = |column| line.known(column).map(|v| v.is_finite().then_some(v));
        Ok(CorrectionRow {
            s_mm,
            x_mm: line.number(1)?,
            y_mm: line.number(2)?,
            dx_mm: line.known(3)?,
            dy_mm: line.known(4)?,
            predicted_error_before_mm: known(5)?,
            predicted_error_after_mm: known(6)?,
            sigma_mm: known(7)?,
            wall_x_mm,
            wall_y_mm,
        })
    })
}

/// A reading of `points.csv` that lies on the wall.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PointRow {
    /// Arc length of the contour, mm.
    pub s_mm: f64,
    /// Contact, mm.
    pub contact: [f64; 2],
    /// Normal towards the wall.
    pub normal: [f64; 2],
    /// Wall error, mm.
    pub error_mm: f64,
    /// Of little weight in the fit.
    pub outlying: bool,
}

/// `points.csv` without the readings that were set aside.
///
/// # Errors
/// See the table of `sheet`.
pub fn read_points(source: &Source) -> Result<Vec<PointRow>, InputError> {
    let mut rows = Vec::new();
    each_line(source, &POINTS, |line| {
        let outlying = match line.text(0) {
            "aside" => return Ok(()),
            "used" => false,
            "outlying" => true,
            _ => return Err(line.refused(0, Z007, "used, outlying or aside")),
        };
        rows.push(PointRow {
            s_mm: line.number(1)?,
            contact: [line.number(2)?, line.number(3)?],
            normal: [line.number(4)?, line.number(5)?],
            error_mm: line.number(6)?,
            outlying,
        });
        Ok(())
    })?;
    Ok(rows)
}

/// One law of `walls.csv`: its name; arc length, error, lowest and highest over the height of every place, mm.
pub type LawPlaces = (String, Vec<[f64; 4]>);

/// `walls.csv`.
///
/// # Errors
/// See the table of `sheet`.
pub fn read_walls(source: &Source) -> Result<Vec<LawPlaces>, InputError> {
    let mut laws: Vec<LawPlaces> = Vec::new();
    each_line(source, &WALLS, |line: &Line| {
        if laws.last().is_none_or(|(law, _)| law != line.text(0)) {
            laws.push((line.text(0).to_owned(), Vec::new()));
        }
        if let Some((_, places)) = laws.last_mut() {
            let s = line.along(1, places.last().map(|p: &[f64; 4]| p[0]))?;
            places.push([s, line.known(2)?, line.known(3)?, line.known(4)?]);
        }
        Ok(())
    })?;
    let ends = laws.iter().map(|(_, places)| (places.first().map(|p| p[0]), places.last().map(|p| p[0])));
    let longest = ends.max_by(|a, b| a.1.partial_cmp(&b.1).unwrap_or(std::cmp::Ordering::Equal));
    let (first, last) = longest.unwrap_or_default();
    enough(source, first, last)?;
    Ok(laws)
}
