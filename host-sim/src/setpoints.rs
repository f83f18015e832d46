//! Recorded setpoints: `t_s,x_mm,y_mm,z_mm[,spindle_rpm]` after a first line `# frame = program` or `# frame = machine`.
//!
//! Numbers are read as exact decimals: 0.1 mm is 100,000 nm. The rows are the ticks of a servo cycle, so their times
//! must rise by one and the same period; what does not is an error with its line.
//!
//! | code | meaning |
//! |---|---|
//! | S001 | the first line does not name the frame |
//! | S002 | columns |
//! | S003 | a field that is no number, or out of range |
//! | S004 | times that do not rise evenly |
//! | S005 | fewer than two rows |

use std::ops::Range;

use truepath_core::units::{Offset, Real};

use crate::diagnostics::{InputError, Source};
use crate::job::Decimal;

/// The coordinates a file is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// Those of the program.
    Program,
    /// Those of the machine.
    Machine,
}

/// One tick.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Row {
    /// X, Y, Z, nm.
    pub position_nm: [i64; 3],
    /// Spindle speed, rev/min; `None` when the file has no such column.
    pub spindle_rpm: Option<Real>,
}

/// A file of setpoints.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Setpoints {
    /// Its coordinates.
    pub frame: Frame,
    /// Time of the first row, ns.
    pub start_ns: i64,
    /// Time between rows, ns.
    pub period_ns: i64,
    /// The rows.
    pub rows: Vec<Row>,
}

/// How far the time between two rows may be from the period: times are printed with few decimals.
const PERIOD_TOLERANCE_PERCENT: i64 = 10;
const COLUMNS: [&str; 5] = ["t_s", "x_mm", "y_mm", "z_mm", "spindle_rpm"];
/// The farthest coordinate: 4 m.
const FARTHEST: Offset = Offset::from_um(4_000_000);
/// The fastest spindle, rev/min.
const FASTEST: Real = Real::from_int(200_000);

impl Setpoints {
    /// Reads a file.
    ///
    /// # Errors
    /// See the table of this module.
    pub fn parse(source: &Source) -> Result<Self, InputError> {
        let (frame, body) = frame(source)?;
        let mut reader = csv::ReaderBuilder::new()
            .flexible(true)
            .has_headers(false)
            .comment(Some(b'#'))
            .trim(csv::Trim::None)
            .from_reader(source.bytes().get(body..).unwrap_or_default());
        let mut record = csv::ByteRecord::new();
        let mut columns = None;
        let (mut times, mut rows) = (Vec::new(), Vec::new());
        while read(&mut reader, &mut record, source)? {
            let fields = Fields { source, record: &record, start: body + start_of(&record, source, body) };
            match columns {
                None => columns = Some(fields.header()?),
                Some(count) => {
                    let (time, row) = fields.row(count)?;
                    times.push((time, fields.span(0)));
                    rows.push(row);
                }
            }
        }
        let end = source.bytes().len();
        let [(first, _), .., (last, _)] = times.as_slice() else {
            let help = "record at least two ticks";
            return Err(InputError::new("S005", "the file has fewer than two setpoints", "", help).at(source, end..end));
        };
        let period_ns = (last - first) / (times.len() as i64 - 1);
        even(source, &times)?;
        Ok(Self { frame, start_ns: *first, period_ns, rows })
    }
}

/// The frame, and where the rest of the file begins.
fn frame(source: &Source) -> Result<(Frame, usize), InputError> {
    let end = source.bytes().iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(source.bytes().len());
    let line = source.excerpt(0..end);
    let name = line.trim().strip_prefix('#').and_then(|l| l.trim().strip_prefix("frame")).map(str::trim_start);
    match name.and_then(|n| n.strip_prefix('=')).map(str::trim) {
        Some("program") => Ok((Frame::Program, end)),
        Some("machine") => Ok((Frame::Machine, end)),
        _ => {
            let help = "say which coordinates the file holds: those of the program or those of the machine";
            let expected = "# frame = program, or # frame = machine";
            Err(InputError::new("S001", "the first line does not name the frame", expected, help).at(source, 0..end))
        }
    }
}

fn read(reader: &mut csv::Reader<&[u8]>, record: &mut csv::ByteRecord, source: &Source) -> Result<bool, InputError> {
    reader.read_byte_record(record).map_err(|e| {
        let end = source.bytes().len();
        InputError::new(
            "S002",
            format!("the file cannot be read as a table ({e})"),
            "comma separated values",
            "export it again",
        )
        .at(source, end..end)
    })
}

/// Where a record begins, from `body`; blank lines and remarks before it are skipped.
fn start_of(record: &csv::ByteRecord, source: &Source, body: usize) -> usize {
    let from = record.position().map_or(0, |p| p.byte() as usize);
    let rest = source.bytes().get(body + from..).unwrap_or_default();
    let mut at = 0;
    while let Some(&byte) = rest.get(at) {
        match byte {
            b'\r' | b'\n' => at += 1,
            b'#' => at += rest[at..].iter().position(|&b| b == b'\n').unwrap_or(rest.len() - at),
            _ => break,
        }
    }
    from + at
}

/// The fields of one line.
struct Fields<'a> {
    source: &'a Source,
    record: &'a csv::ByteRecord,
    start: usize,
}

impl Fields<'_> {
    /// Where a field stands; the whole line for one that is missing.
    fn span(&self, index: usize) -> Range<usize> {
        let before: usize = self.record.iter().take(index).map(|f| f.len() + 1).sum();
        match self.record.get(index) {
            Some(field) => self.start + before..self.start + before + field.len(),
            None => self.start..self.start + self.record.as_slice().len() + self.record.len().saturating_sub(1),
        }
    }

    /// How many columns the file has.
    fn header(&self) -> Result<usize, InputError> {
        let names: Vec<String> = self.record.iter().map(|f| String::from_utf8_lossy(f).trim().to_owned()).collect();
        if names == COLUMNS[..4] || names == COLUMNS {
            return Ok(names.len());
        }
        let wrong = names.iter().zip(COLUMNS).position(|(name, column)| name != column).unwrap_or(names.len().min(5));
        let found = match names.get(wrong) {
            Some(name) => format!("column {} is \"{name}\"", wrong + 1),
            None => format!("there are {} columns", names.len()),
        };
        let expected = "t_s,x_mm,y_mm,z_mm or t_s,x_mm,y_mm,z_mm,spindle_rpm";
        let help = "name the columns in the second line of the file";
        Err(InputError::new("S002", found, expected, help).at(self.source, self.span(wrong)))
    }

    fn row(&self, columns: usize) -> Result<(i64, Row), InputError> {
        if self.record.len() != columns {
            let found = format!("this line has {} fields", self.record.len());
            let expected = format!("{columns}, as in the line with the names");
            let help = "a line that was cut off? remove it or record again";
            return Err(InputError::new("S002", found, expected, help).at(self.source, self.span(usize::MAX)));
        }
        let time_ns = self.number(0)?.as_billionths();
        let mut position_nm = [0; 3];
        for (axis, nm) in position_nm.iter_mut().enumerate() {
            let length = self.number(axis + 1)?.as_mm();
            if length.abs() > FARTHEST {
                return Err(self.refused(axis + 1, "-4000 to 4000 mm"));
            }
            *nm = length.nm();
        }
        let spindle_rpm = if columns == 5 { Some(self.number(4)?.as_real()) } else { None };
        if spindle_rpm.is_some_and(|rpm| rpm < 0 || rpm > FASTEST) {
            return Err(self.refused(4, "0 to 200000 rev/min"));
        }
        Ok((time_ns, Row { position_nm, spindle_rpm }))
    }

    fn number(&self, index: usize) -> Result<Decimal, InputError> {
        let text = self.record.get(index).and_then(|f| std::str::from_utf8(f).ok()).map(str::trim);
        text.and_then(Decimal::parse).ok_or_else(|| self.refused(index, "a decimal number"))
    }

    fn refused(&self, index: usize, expected: &str) -> InputError {
        let span = self.span(index);
        let found = format!("{} is \"{}\"", COLUMNS[index.min(4)], self.source.excerpt(span.clone()));
        InputError::new("S003", found, expected, "correct the field").at(self.source, span)
    }
}

/// Times rise by one period; the median step is it, so that a gap is found where it is.
fn even(source: &Source, times: &[(i64, Range<usize>)]) -> Result<(), InputError> {
    let mut steps: Vec<i64> = times.windows(2).map(|pair| pair[1].0.saturating_sub(pair[0].0)).collect();
    let middle = steps.len() / 2;
    let usual = *steps.select_nth_unstable(middle).1;
    for pair in times.windows(2) {
        let step = pair[1].0.saturating_sub(pair[0].0);
        if step <= 0 || (step - usual).abs() > usual * PERIOD_TOLERANCE_PERCENT / 100 {
            let found = format!("the time rises by {} s here", step as f64 / 1e9);
            let expected = format!("{} s as from tick to tick elsewhere", usual as f64 / 1e9);
            let help = "replay needs every tick of the servo cycle: record without gaps, or cut the file at the gap";
            return Err(InputError::new("S004", found, expected, help).at(source, pair[1].1.clone()));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn parse(text: &str) -> Result<Setpoints, InputError> {
        Setpoints::parse(&Source::new("in.csv", text.as_bytes().to_vec()))
    }

    #[test]
    fn rows_are_exact_and_the_period_is_theirs() {
        let text = "# frame = machine\n# remark\nt_s,x_mm,y_mm,z_mm,spindle_rpm\n0.000,0.1,-0.3,-15,1500\r\n0.001,0.2, -0.3,-15,1500\n";
        let read = parse(text).expect("setpoints");
        assert_eq!((read.frame, read.start_ns, read.period_ns), (Frame::Machine, 0, 1_000_000));
        assert_eq!(read.rows[1].position_nm, [200_000, -300_000, -15_000_000]);
        assert_eq!(read.rows[0].spindle_rpm, Some(Real::from_int(1500)));
    }

    #[test]
    fn what_is_wrong_is_named_with_its_place() {
        let rows = |body: &str| format!("# frame = program\nt_s,x_mm,y_mm,z_mm\n{body}");
        let cases = [
            (String::new(), "S001", (1, 1)),
            ("# frame = world\n".to_owned(), "S001", (1, 1)),
            ("# frame = program\nt,x,y,z\n".to_owned(), "S002", (2, 1)),
            ("# frame = program\nt_s,x_mm,y_mm,z\n".to_owned(), "S002", (2, 15)),
            (rows("0,1,2,3\n"), "S005", (4, 1)),
            (rows("0,1,2,3\n1,1,2\n"), "S002", (4, 1)),
            (rows("0,1,2,3\n1,1,2,3,4\n"), "S002", (4, 1)),
            (rows("0,1,2,3\n\n# gap\n1,1,two,3\n"), "S003", (6, 5)),
            (rows("0,1,2,3\n1,1,2,5000\n"), "S003", (4, 7)),
            (rows("0,1,2,3\n1,1,2,3\n1,1,2,3\n"), "S004", (5, 1)),
            (rows("0,1,2,3\n1,1,2,3\n2,1,2,3\n4,1,2,3\n5,1,2,3\n"), "S004", (6, 1)),
        ];
        for (text, code, place) in cases {
            let error = parse(&text).expect_err(&text);
            assert_eq!((error.code(), error.line_column()), (code, Some(place)), "{error} in\n{text}");
        }
    }
}
