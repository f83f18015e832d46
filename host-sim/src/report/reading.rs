//! The tables of the commands, read back into the rows they were written from.

use super::sheet::{Line, each_line};
use super::tables::{CorrectionRow, Trace, TraceRow};
use crate::diagnostics::{InputError, Source};

/// Columns of `trace.csv` that every one has.
const TRACE: [&str; 11] =
    ["s_mm", "x_mm", "y_mm", "arc_deg", "chip_area_mm2", "force_n", "fx_n", "fy_n", "dx_mm", "dy_mm", "error_mm"];
const CORRECTION: [&str; 8] =
    ["s_mm", "x_mm", "y_mm", "dx_mm", "dy_mm", "predicted_error_before_mm", "predicted_error_after_mm", "sigma_mm"];
const WALL: [&str; 2] = ["wall_x_mm", "wall_y_mm"];
const POINTS: [&str; 7] = ["status", "s_mm", "x_mm", "y_mm", "nx", "ny", "error_mm"];
const WALLS: [&str; 5] = ["law", "s_mm", "error_mm", "lowest_mm", "highest_mm"];

/// The columns with those of the wall, where the table must have them.
fn with_wall<'a>(columns: &[&'a str], wall: bool) -> Vec<&'a str> {
    columns.iter().copied().chain(WALL.into_iter().filter(|_| wall)).collect()
}

/// At least two places that are not the same.
fn enough(source: &Source, first: Option<f64>, last: Option<f64>) -> Result<(), InputError> {
    if first.zip(last).is_some_and(|(first, last)| last > first) {
        return Ok(());
    }
    let end = source.bytes().len();
    let help = "give the table of a whole contour";
    Err(InputError::new("Z009", "the table has fewer than two places along the contour", "", help).at(source, end..end))
}

/// `trace.csv`; with `wall` the nominal wall must be in it, without it is not read.
///
/// # Errors
/// See the table of [`sheet`](super::sheet).
pub fn read_trace(source: &Source, wall: bool) -> Result<Trace, InputError> {
    let mut rows: Trace = Vec::new();
    each_line(source, &with_wall(&TRACE, wall), |line| {
        let on_wall = |column| if wall { line.number(column) } else { Ok(f64::NAN) };
        rows.push(TraceRow {
            s_mm: line.along(0, rows.last().map(|r| r.s_mm))?,
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
            wall_x_mm: on_wall(11)?,
            wall_y_mm: on_wall(12)?,
        });
        Ok(())
    })?;
    enough(source, rows.first().map(|r| r.s_mm), rows.last().map(|r| r.s_mm))?;
    Ok(rows)
}

/// `correction.csv`; `wall` as in [`read_trace`].
///
/// # Errors
/// See the table of [`sheet`](super::sheet).
pub fn read_correction(source: &Source, wall: bool) -> Result<Vec<CorrectionRow>, InputError> {
    let mut rows: Vec<CorrectionRow> = Vec::new();
    each_line(source, &with_wall(&CORRECTION, wall), |line| {
        let on_wall = |column| if wall { line.number(column) } else { Ok(f64::NAN) };
        let known = |column| line.known(column).map(|v| v.is_finite().then_some(v));
        rows.push(CorrectionRow {
            s_mm: line.along(0, rows.last().map(|r| r.s_mm))?,
            x_mm: line.number(1)?,
            y_mm: line.number(2)?,
            dx_mm: line.known(3)?,
            dy_mm: line.known(4)?,
            predicted_error_before_mm: known(5)?,
            predicted_error_after_mm: known(6)?,
            sigma_mm: known(7)?,
            wall_x_mm: on_wall(8)?,
            wall_y_mm: on_wall(9)?,
        });
        Ok(())
    })?;
    enough(source, rows.first().map(|r| r.s_mm), rows.last().map(|r| r.s_mm))?;
    Ok(rows)
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
/// See the table of [`sheet`](super::sheet).
pub fn read_points(source: &Source) -> Result<Vec<PointRow>, InputError> {
    let mut rows = Vec::new();
    each_line(source, &POINTS, |line| {
        let outlying = match line.text(0) {
            "aside" => return Ok(()),
            "used" => false,
            "outlying" => true,
            _ => return Err(line.refused(0, "Z007", "used, outlying or aside")),
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
/// See the table of [`sheet`](super::sheet).
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
