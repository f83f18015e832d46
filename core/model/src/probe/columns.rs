//! Files of columns: a point a line, with a header or columns named in the job.
//!
//! Lines that begin with `#` are comments. A header is a first line that begins with a letter; it names x, y, z and, if
//! it likes, nx, ny and hit, each alone or followed by its unit (`x_mm`, `X [mm]`). Columns of other names are not read.

use super::error::{ProbeError, ProbeErrorKind};
use super::format::{Columns, DecimalSign, Frame, Given, LengthUnit, PointKind, Separator};
use super::number::{Number, Signs};
use super::reading::{Outcome, Reading, Sink, unit_normal};
use super::row::{Row, is_empty, position};
use truepath_rs274::Lines;
use truepath_units::Offset;

pub(super) fn read(file: &[u8], given: &Given, sink: &mut Sink) -> Result<(), ProbeError> {
    let layout = &given.layout;
    let separator = separator(file, layout.separator, layout.decimal);
    let comma = separator != Some(b',') && layout.decimal != DecimalSign::Point;
    let signs = Signs { point: layout.decimal != DecimalSign::Comma, comma };
    let origin = match layout.frame {
        Frame::Work => [Offset::ZERO; 3],
        Frame::Machine => given.work_offset.ok_or(ProbeError {
            kind: ProbeErrorKind::NoWorkOffset { system: "G54" },
            line: 1,
            column: 1,
            start: 0,
            len: 0,
        })?,
    };
    let mut columns = layout.columns.unwrap_or(Columns::XYZ);
    let mut header_allowed = true;
    for line in Lines::new(file) {
        let begin = line.text.trim_ascii_start().first().copied();
        if is_empty(&line) || begin == Some(b'#') {
            continue;
        }
        let row = Row { line, separator, signs };
        let names = core::mem::take(&mut header_allowed) && begin.is_some_and(|b| b.is_ascii_alphabetic() || b == b'"');
        if names {
            let named = header(&row, layout.unit, layout.columns.is_some())?;
            columns = layout.columns.unwrap_or(named);
            continue;
        }
        let [x, y, z, nx, ny, hit] = numbers(&row, &columns)?;
        let normal = match columns.normal {
            None => None,
            Some(_) => Some(
                unit_normal(nx.real(), ny.real())
                    .ok_or_else(|| ProbeError::of_line(ProbeErrorKind::NoNormal, &line))?,
            ),
        };
        let outcome = match (columns.hit, hit.whole()) {
            (None, _) | (_, Some(1)) => Outcome::Touched,
            (_, Some(0)) => Outcome::Missed,
            _ => return Err(ProbeError::of_line(ProbeErrorKind::Malformed { expected: "hit 1 or 0" }, &line)),
        };
        let radius = match layout.point {
            PointKind::Tip => given.ball_radius(),
            PointKind::Surface => Offset::ZERO,
        };
        let [x, y, z] = position([x, y, z], layout.unit, &line)?;
        let [ox, oy, oz] = origin;
        sink.push(Reading { position: [x - ox, y - oy, z - oz], radius, outcome, normal, line: line.number }, &line)?;
    }
    Ok(())
}

/// The byte that separates columns; `None` for blanks.
fn separator(file: &[u8], stated: Separator, decimal: DecimalSign) -> Option<u8> {
    let has = |byte: u8| file.contains(&byte);
    let inside_number = |w: &[u8]| matches!(w, [a, b',', b] if a.is_ascii_digit() && b.is_ascii_digit());
    match stated {
        Separator::Comma => Some(b','),
        Separator::Semicolon => Some(b';'),
        Separator::Tab => Some(b'\t'),
        Separator::Blank => None,
        Separator::Auto if has(b'\t') => Some(b'\t'),
        Separator::Auto if has(b';') => Some(b';'),
        Separator::Auto => {
            let decimal_comma =
                decimal == DecimalSign::Comma || (has(b' ') && !has(b'.') && file.windows(3).any(inside_number));
            (has(b',') && !decimal_comma).then_some(b',')
        }
    }
}

/// Columns by their names. They need not be there when the job names the columns.
fn header(row: &Row, unit: LengthUnit, named_by_job: bool) -> Result<Columns, ProbeError> {
    let mut found: [Option<u8>; 6] = [None; 6];
    let mut of_other_unit = None;
    row.fields(|at, name, rest| {
        let name = name.strip_prefix(b"\"").unwrap_or(name);
        for (slot, wanted) in found.iter_mut().zip(["x", "y", "z", "nx", "ny", "hit"]) {
            let Some((start, suffix)) = name.split_at_checked(wanted.len()) else { continue };
            let alone = suffix.first().is_none_or(|b| !b.is_ascii_alphanumeric());
            if alone && slot.is_none() && start.eq_ignore_ascii_case(wanted.as_bytes()) {
                *slot = u8::try_from(at).ok();
                if wanted.len() == 1 && names_unit(suffix).is_some_and(|named| named != unit) {
                    of_other_unit =
                        of_other_unit.or(Some(ProbeError::before(ProbeErrorKind::UnitDiffers, &row.line, name, rest)));
                }
            }
        }
        Ok(())
    })?;
    if let Some(error) = of_other_unit {
        return Err(error);
    }
    if named_by_job {
        return Ok(Columns::XYZ);
    }
    let missing = |axis| ProbeError::of_line(ProbeErrorKind::ColumnMissing { axis }, &row.line);
    let [x, y, z, nx, ny, hit] = found;
    let axes = [x.ok_or(missing('x'))?, y.ok_or(missing('y'))?, z.ok_or(missing('z'))?];
    Ok(Columns { axes, normal: nx.zip(ny).map(|(x, y)| [x, y]), hit })
}

/// The unit in the rest of a column's name, `_mm` or ` [in]`.
fn names_unit(suffix: &[u8]) -> Option<LengthUnit> {
    let is_letter = |b: &u8| b.is_ascii_alphabetic();
    let start = suffix.iter().position(is_letter)?;
    let word = suffix.get(start..).unwrap_or_default();
    let word = word.split(|b| !is_letter(b)).next().unwrap_or_default();
    let is = |names: &[&[u8]]| names.iter().any(|name| word.eq_ignore_ascii_case(name));
    if is(&[b"mm"]) {
        Some(LengthUnit::Millimetre)
    } else if is(&[b"in", b"inch", b"inches"]) {
        Some(LengthUnit::Inch)
    } else {
        None
    }
}

/// x, y, z, nx, ny and hit of a line; zero where there is no column.
fn numbers(row: &Row, columns: &Columns) -> Result<[Number; 6], ProbeError> {
    let mut numbers = [Number::ZERO; 6];
    let [x, y, z] = columns.axes.map(Some);
    let [nx, ny] = columns.normal.map_or([None; 2], |n| n.map(Some));
    let places = [x, y, z, nx, ny, columns.hit];
    let found = row.fields(|at, field, rest| {
        for (slot, place) in numbers.iter_mut().zip(places) {
            if place.map(usize::from) == Some(at) {
                *slot = row.number(field, rest)?;
            }
        }
        Ok(())
    })?;
    let expected = columns.least();
    if found < expected { Err(row.wrong_count(expected, found)) } else { Ok(numbers) }
}
