//! Recorded setpoints: `t_s,x_mm,y_mm,z_mm` and optional columns after a first line `# frame = program` or `# frame = machine`.
//!
//! Numbers are read as exact decimals: 0.1 mm is 100,000 nm. The rows are the ticks of a servo cycle, so their times
//! must rise by one and the same period; what does not is an error with its line. The optional columns are in
//! [`columns`]; a controller that writes them all is reproduced to the last bit, whatever happened during the run.

pub mod columns;

use std::ops::Range;

use columns::{Columns, Fields};
use truepath_ground::diagnostics::{InputError, Source};

use crate::codes::{S001, S002, S004, S005};

pub use columns::Row;

/// The coordinates a file is written in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Frame {
    /// Those of the program.
    Program,
    /// Those of the machine.
    Machine,
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
        let mut columns: Option<Columns> = None;
        let (mut times, mut rows) = (Vec::new(), Vec::new());
        while read(&mut reader, &mut record, source)? {
            let fields = Fields { source, record: &record, start: body + start_of(&record, source, body) };
            match &columns {
                None => columns = Some(Columns::read(&fields)?),
                Some(columns) => {
                    let (time, row) = columns.row(&fields)?;
                    times.push((time, fields.span(0)));
                    rows.push(row);
                }
            }
        }
        let end = source.bytes().len();
        let [(first, _), .., (last, _)] = times.as_slice() else {
            return Err(S005.error("the file has fewer than two setpoints", "").at(source, end..end));
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
            let expected = "# frame = program, or # frame = machine";
            Err(S001.error("the first line does not name the frame", expected).at(source, 0..end))
        }
    }
}

fn read(reader: &mut csv::Reader<&[u8]>, record: &mut csv::ByteRecord, source: &Source) -> Result<bool, InputError> {
    reader.read_byte_record(record).map_err(|e| {
        let end = source.bytes().len();
        InputError::new(
            S002,
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
            return Err(S004.error(found, expected).at(source, pair[1].1.clone()));
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use truepath_core::rewrite::Flags;
    use truepath_core::units::Real;

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
    fn optional_columns_stand_in_any_order_and_default_to_an_undisturbed_cut() {
        let plain = parse("# frame = machine\nt_s,x_mm,y_mm,z_mm\n0,1,2,3\n1,1,2,3\n").expect("setpoints").rows[0];
        assert_eq!(plain.flags, Flags::DRIVES_ENABLED.with(Flags::SPINDLE_LOADED));
        assert_eq!((plain.frame_crc, plain.disarm, plain.spindle_rpm), (None, false, None));
        let head = "# frame = machine\nt_s,x_mm,y_mm,z_mm,disarm,flags,frame_crc,spindle_rpm\n";
        let row = parse(&format!("{head}0,1,2,3,0,5,4294967295,1500\n1,1,2,3,1,127,0,0.5\n")).expect("setpoints").rows;
        assert_eq!((row[0].flags, row[0].frame_crc, row[0].disarm), (Flags(5), Some(u32::MAX), false));
        assert_eq!((row[1].flags, row[1].frame_crc, row[1].disarm), (Flags(127), Some(0), true));
        assert_eq!(row[1].spindle_rpm, Some(Real::ratio(1, 2)));
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
            ("# frame = program\nt_s,x_mm,y_mm,z_mm,flags,flags\n".to_owned(), "S002", (2, 26)),
            ("# frame = program\nt_s,x_mm,y_mm,z_mm,load\n".to_owned(), "S002", (2, 20)),
            ("# frame = program\nt_s,x_mm,y_mm,z_mm,flags\n0,0,0,0,128\n".to_owned(), "S003", (3, 9)),
            ("# frame = program\nt_s,x_mm,y_mm,z_mm,disarm\n0,0,0,0,2\n".to_owned(), "S003", (3, 9)),
            ("# frame = program\nt_s,x_mm,y_mm,z_mm,frame_crc\n0,0,0,0,-1\n".to_owned(), "S003", (3, 9)),
            (rows("0,1,2,3\n1,1,2,3\n1,1,2,3\n"), "S004", (5, 1)),
            (rows("0,1,2,3\n1,1,2,3\n2,1,2,3\n4,1,2,3\n5,1,2,3\n"), "S004", (6, 1)),
        ];
        for (text, code, place) in cases {
            let error = parse(&text).expect_err(&text);
            assert_eq!((error.code(), error.line_column()), (code, Some(place)), "{error} in\n{text}");
        }
    }
}
