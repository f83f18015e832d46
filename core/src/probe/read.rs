//! Reading of measurement files, line by line, with nom and without memory of its own.

use nom::bytes::complete::{take_till1, take_while};
use nom::{IResult, Parser};

use super::error::{ProbeError, ProbeErrorKind};
use crate::gcode::{Line, Lines};
use crate::units::{Position, div_rounded};

/// The unit of the numbers in a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum LengthUnit {
    /// Millimetres.
    Millimetre,
    /// Inches.
    Inch,
}

/// Places of the coordinates in a file of columns.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Columns {
    /// Index of the columns of x, y and z.
    pub axes: [usize; 3],
}

/// The format of a file.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Format {
    /// LinuxCNC's `(PROBEOPEN file)`: nine numbers X Y Z A B C U V W, no header.
    Linuxcnc,
    /// Columns separated by commas, semicolons, tabs or blanks, with a header that names x, y and z (`x_mm` and the
    /// like), or without one when the first three columns are x, y and z. A decimal comma is understood where the
    /// separator is not a comma. Lines that begin with `#` are comments.
    Columns,
}

/// One line of a file: where the probe was when it touched.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Reading {
    /// X, Y, Z as in the file.
    pub position: [Position; 3],
    /// Line, counted from 1.
    pub line: u32,
}

impl LengthUnit {
    const fn nm(self) -> i128 {
        match self {
            Self::Millimetre => 1_000_000,
            Self::Inch => 25_400_000,
        }
    }
}

/// Reads a file into `readings`; returns how many there are.
///
/// # Errors
/// [`ProbeError`] with line and column at the first line that does not fit the format, when the file holds no point,
/// and when it holds more than `readings` can take. Nothing is skipped in silence.
pub fn read(file: &[u8], format: Format, unit: LengthUnit, readings: &mut [Reading]) -> Result<usize, ProbeError> {
    let mut columns = Columns { axes: [0, 1, 2] };
    let mut count = 0usize;
    let mut header_allowed = format == Format::Columns;
    let comma_separates = comma_separates(file);
    for line in Lines::new(file) {
        let text = line.text;
        let blank = text.iter().all(|b| is_blank(*b));
        let comment = format == Format::Columns && text.trim_ascii_start().starts_with(b"#");
        if blank || comment {
            continue;
        }
        if header_allowed {
            header_allowed = false;
            if text.trim_ascii_start().first().is_some_and(|b| b.is_ascii_alphabetic() || *b == b'"') {
                columns = header(&line, comma_separates)?;
                continue;
            }
        }
        let reading = match format {
            Format::Linuxcnc => numbers(&line, unit, &[0, 1, 2], Some(9), false)?,
            Format::Columns => numbers(&line, unit, &columns.axes, None, comma_separates)?,
        };
        let Some(slot) = readings.get_mut(count) else {
            return Err(at(ProbeErrorKind::TooManyPoints { limit: readings.len() }, &line, 0, text.len()));
        };
        *slot = reading;
        count = count.saturating_add(1);
    }
    if count == 0 {
        return Err(ProbeError { kind: ProbeErrorKind::Empty, line: 1, column: 1, start: 0, len: 0 });
    }
    Ok(count)
}

/// A comma separates columns unless semicolons or tabs do, or it stands inside numbers that blanks separate.
fn comma_separates(file: &[u8]) -> bool {
    let has = |byte: u8| file.contains(&byte);
    let inside_number = |w: &[u8]| matches!(w, [a, b',', b] if a.is_ascii_digit() && b.is_ascii_digit());
    let decimal = has(b' ') && !has(b'.') && file.windows(3).any(inside_number);
    has(b',') && !decimal && !has(b';') && !has(b'\t')
}

const fn is_blank(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\r')
}

/// The next field of a line: separators before it are skipped.
fn field(input: &[u8], comma_separates: bool) -> IResult<&[u8], &[u8]> {
    let separator = move |b: u8| is_blank(b) || b == b';' || (comma_separates && b == b',');
    let (rest, _) = take_while(separator).parse(input)?;
    take_till1(separator).parse(rest)
}

fn header(line: &Line, comma_separates: bool) -> Result<Columns, ProbeError> {
    let mut axes = [None; 3];
    let mut rest = line.text;
    let mut index = 0usize;
    while let Ok((after, name)) = field(rest, comma_separates) {
        let name = name.trim_ascii();
        let name = name.strip_prefix(b"\"").unwrap_or(name);
        let first = name.first().map(u8::to_ascii_lowercase);
        let alone = name.get(1).is_none_or(|b| !b.is_ascii_alphanumeric());
        for (slot, letter) in axes.iter_mut().zip(*b"xyz") {
            if first == Some(letter) && alone && slot.is_none() {
                *slot = Some(index);
            }
        }
        index = index.saturating_add(1);
        rest = after;
    }
    let missing = |axis| at(ProbeErrorKind::ColumnMissing { axis }, line, 0, line.text.len());
    let [x, y, z] = axes;
    Ok(Columns { axes: [x.ok_or(missing('x'))?, y.ok_or(missing('y'))?, z.ok_or(missing('z'))?] })
}

fn numbers(
    line: &Line,
    unit: LengthUnit,
    axes: &[usize; 3],
    exactly: Option<usize>,
    comma_separates: bool,
) -> Result<Reading, ProbeError> {
    let mut position = [None; 3];
    let mut rest = line.text;
    let mut count = 0usize;
    while let Ok((after, text)) = field(rest, comma_separates) {
        let wanted = exactly.is_some() || axes.contains(&count);
        if wanted {
            let offset = line.text.len().saturating_sub(after.len()).saturating_sub(text.len());
            let nm = number(text, unit, !comma_separates).map_err(|kind| at(kind, line, offset, text.len()))?;
            for (slot, axis) in position.iter_mut().zip(axes) {
                if *axis == count {
                    *slot = Some(Position::from_nm(nm));
                }
            }
        }
        count = count.saturating_add(1);
        rest = after;
    }
    let least = axes.iter().copied().max().unwrap_or(0).saturating_add(1);
    let expected = exactly.unwrap_or(least);
    if (exactly.is_some() && count != expected) || count < expected {
        return Err(at(ProbeErrorKind::WrongCount { expected, found: count }, line, 0, line.text.len()));
    }
    let [x, y, z] = position.map(Option::unwrap_or_default);
    Ok(Reading { position: [x, y, z], line: line.number })
}

/// A plain decimal number in nanometres, rounded once.
fn number(text: &[u8], unit: LengthUnit, decimal_comma: bool) -> Result<i64, ProbeErrorKind> {
    let (negative, digits) = match text {
        [b'-', rest @ ..] => (true, rest),
        [b'+', rest @ ..] => (false, rest),
        _ => (false, text),
    };
    let (mut mantissa, mut scale, mut whole, mut any) = (0i128, 1i128, 0u32, false);
    let mut behind_point = false;
    for byte in digits {
        match byte {
            b'0'..=b'9' => {
                any = true;
                // Digits finer than 10⁻¹⁵ are below any length.
                if !behind_point || scale < 1_000_000_000_000_000 {
                    mantissa = mantissa.saturating_mul(10).saturating_add(i128::from(byte.saturating_sub(b'0')));
                    if behind_point {
                        scale = scale.saturating_mul(10);
                    } else if mantissa != 0 {
                        whole = whole.saturating_add(1);
                    }
                }
            }
            b'.' if !behind_point => behind_point = true,
            b',' if !behind_point && decimal_comma => behind_point = true,
            _ => return Err(ProbeErrorKind::NotANumber),
        }
    }
    if !any {
        return Err(ProbeErrorKind::NotANumber);
    }
    if whole > 12 {
        return Err(ProbeErrorKind::NumberTooLarge);
    }
    let nm = div_rounded(mantissa.saturating_mul(unit.nm()), scale);
    let nm = i64::try_from(nm).map_err(|_| ProbeErrorKind::NumberTooLarge)?;
    Ok(if negative { nm.saturating_neg() } else { nm })
}

fn at(kind: ProbeErrorKind, line: &Line, offset: usize, len: usize) -> ProbeError {
    let column = u32::try_from(offset.saturating_add(1)).unwrap_or(u32::MAX);
    ProbeError { kind, line: line.number, column, start: line.start.saturating_add(offset), len }
}
