//! A table (CSV) that is read back: named columns of numbers, every mistake with its place.
//!
//! The columns may stand in any order, with others between them.

use std::io::Read;
use std::ops::Range;
use std::path::Path;

use crate::codes::{Row, Z006, Z007, Z008, Z010};
use crate::diagnostics::{InputError, Source};
use crate::files;

/// Most lines of a table.
const LINES: usize = 2_000_000;
/// Most bytes of a table.
const BYTES: u64 = 1_000_000_000;
/// Farthest number.
const FARTHEST: f64 = 1e9;

/// Reads a file that may be large, but not without a bound.
///
/// # Errors
/// `F001` when it cannot be read, `Z010`.
pub fn read_bounded(path: &Path) -> Result<Source, InputError> {
    let unreadable = |e| InputError::unreadable(path, &e);
    let mut bytes = Vec::new();
    files::open(path).map_err(unreadable)?.take(BYTES + 1).read_to_end(&mut bytes).map_err(unreadable)?;
    if bytes.len() as u64 > BYTES {
        let found = format!("{} has more than {BYTES} bytes", path.display());
        return Err(Z010.error(found, "a table of at most 1 GB").in_file(path));
    }
    Ok(Source::new(path.display().to_string(), bytes))
}

/// The names of the columns of a table; none where there is no first line.
pub fn names(source: &Source) -> Vec<String> {
    let first = source.bytes().split(|b| matches!(b, b'\n' | b'\r')).next().unwrap_or_default();
    let first = String::from_utf8_lossy(first);
    first.trim_start_matches('\u{feff}').split(',').map(|name| name.trim().to_owned()).collect()
}

/// One line of a table.
pub struct Line<'a> {
    source: &'a Source,
    record: &'a csv::ByteRecord,
    /// Where the columns asked for stand.
    places: &'a [usize],
    wanted: &'a [&'a str],
}

/// Calls `each` with every line; the columns are numbered as `wanted` names them.
///
/// # Errors
/// `Z006`, `Z010`, and those of `each`.
pub fn each_line(
    source: &Source,
    wanted: &[&str],
    mut each: impl FnMut(&Line) -> Result<(), InputError>,
) -> Result<(), InputError> {
    let head = names(source);
    let header = source.line_span(1);
    let place = |name: &&str| {
        head.iter().position(|n| n == name).ok_or_else(|| {
            let found = match head.iter().all(String::is_empty) {
                true => "the table is empty".to_owned(),
                false => format!("there is no column {name}"),
            };
            let expected = format!("the columns {}", wanted.join(", "));
            let help = "give a table as the commands write it; a table without these columns is of another kind or an \
                        older version: write it again";
            InputError::new(Z006, found, expected, help).at(source, header.clone())
        })
    };
    let places = wanted.iter().map(place).collect::<Result<Vec<usize>, _>>()?;
    let mut reader = csv::ReaderBuilder::new().flexible(true).has_headers(true).from_reader(source.bytes());
    let mut record = csv::ByteRecord::new();
    let mut lines = 0usize;
    while reader.read_byte_record(&mut record).map_err(|e| {
        let found = format!("the table cannot be read ({e})");
        InputError::new(Z006, found, "comma separated values", "write it again").at(source, header.clone())
    })? {
        lines += 1;
        let line = Line { source, record: &record, places: &places, wanted };
        if lines > LINES {
            let found = format!("the table has more than {LINES} lines");
            return Err(Z010.error(found, format!("at most {LINES}")).at(source, line.span(None)));
        }
        if record.len() != head.len() {
            let found = format!("this line has {} fields", record.len());
            let expected = format!("{}, as in the line with the names", head.len());
            let help = "a line that was cut off? write the table again";
            return Err(InputError::new(Z006, found, expected, help).at(source, line.span(None)));
        }
        each(&line)?;
    }
    Ok(())
}

impl Line<'_> {
    /// The text of a column.
    pub fn text(&self, column: usize) -> &str {
        let field = self.places.get(column).and_then(|at| self.record.get(*at)).unwrap_or_default();
        std::str::from_utf8(field).unwrap_or("\u{fffd}").trim()
    }

    /// The number in a column.
    ///
    /// # Errors
    /// `Z007`.
    pub fn number(&self, column: usize) -> Result<f64, InputError> {
        let value = self.text(column).parse().ok().filter(|v: &f64| v.abs() <= FARTHEST);
        value.ok_or_else(|| self.refused(column, Z007, "a number between −1e9 and 1e9"))
    }

    /// The number in a column, or what is not a number in an empty one.
    ///
    /// # Errors
    /// `Z007`.
    pub fn known(&self, column: usize) -> Result<f64, InputError> {
        let text = self.text(column);
        if text.is_empty() || text.eq_ignore_ascii_case("nan") { Ok(f64::NAN) } else { self.number(column) }
    }

    /// The arc length in a column, which does not fall below the one before.
    ///
    /// # Errors
    /// `Z007`, `Z008`.
    pub fn along(&self, column: usize, before: Option<f64>) -> Result<f64, InputError> {
        let s = self.number(column)?;
        match before {
            Some(before) if s < before => {
                Err(self.refused(column, Z008, &format!("no less than the {before} of the line before")))
            }
            _ => Ok(s),
        }
    }

    /// An error at a column.
    pub fn refused(&self, column: usize, row: Row, expected: &str) -> InputError {
        let name = self.wanted.get(column).copied().unwrap_or_default();
        let found = format!("{name} is \"{}\"", self.text(column));
        let span = self.span(self.places.get(column).copied());
        InputError::new(row, found, expected, "correct the field, or write the table again").at(self.source, span)
    }

    /// Where a field of the line stands, or the whole line.
    fn span(&self, field: Option<usize>) -> Range<usize> {
        let number = self.record.position().map_or(1, csv::Position::line);
        let mut number = u32::try_from(number).unwrap_or(u32::MAX);
        // Blank lines before it are counted with it.
        let mut line = self.source.line_span(number);
        while line.is_empty() && line.end < self.source.bytes().len() {
            number = number.saturating_add(1);
            line = self.source.line_span(number);
        }
        let Some(field) = field else { return line };
        let start = line.start + self.record.iter().take(field).map(|f| f.len() + 1).sum::<usize>();
        let end = start + self.record.get(field).map_or(0, <[u8]>::len);
        start.min(line.end)..end.min(line.end)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Vec<(f64, f64)>, InputError> {
        let source = Source::new("t.csv", text.as_bytes().to_vec());
        let mut rows: Vec<(f64, f64)> = Vec::new();
        each_line(&source, &["s_mm", "v"], |line| {
            let s = line.along(0, rows.last().map(|r| r.0))?;
            rows.push((s, line.known(1)?));
            Ok(())
        })?;
        Ok(rows)
    }

    #[test]
    fn columns_stand_in_any_order_and_gaps_are_no_numbers() {
        let rows = read("\u{feff}v, other,s_mm\r\n1.5,x,0\r\n,y,1\nNaN,,1\n-2,\"a, b\",2").expect("rows");
        assert_eq!(rows[0], (0.0, 1.5));
        assert!(rows[1].1.is_nan() && rows[2].1.is_nan());
        assert_eq!(rows[3], (2.0, -2.0));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        for (text, code, place) in [
            ("", "Z006", (1, 1)),
            ("a,b\n", "Z006", (1, 1)),
            ("s_mm;v\n1;2\n", "Z006", (1, 1)),
            ("s_mm,v\n0,1\n1\n", "Z006", (3, 1)),
            ("s_mm,v\n0,one\n", "Z007", (2, 3)),
            ("s_mm,v\n0,inf\n", "Z007", (2, 3)),
            ("s_mm,v\nNaN,1\n", "Z007", (2, 1)),
            ("s_mm,v\n0,1\n\n\n1,2e9\n", "Z007", (5, 3)),
            ("s_mm,v\n0,1\n2,2\n1,3\n", "Z008", (4, 1)),
        ] {
            let error = read(text).expect_err(text);
            assert_eq!((error.code(), error.line_column()), (code, Some(place)), "{error} in\n{text}");
        }
    }
}
