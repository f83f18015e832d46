//! Records of force as text: DynoWare and LabVIEW exports, and plain columns.
//!
//! * DynoWare (Kistler): `DynoWare,Version …`, lines `key:,value` among them `Sampling rate [Hz]:`, a line of names that begins
//!   with `Time`, a line of units, and numbers; separated by commas, semicolons or tabs.
//! * LabVIEW measurement (.lvm): `LabVIEW Measurement`, a header of the file and one of the segment, both ended by
//!   `***End_of_Header***`, with `Delta_X` and `Y_Unit_Label`; names begin with `X_Value`. Of several segments the first is
//!   taken. `X_Columns` may be `No`, `One` or `Multi`.
//! * Columns: an optional line of names (`Fx`, `Fx [N]`, `Fx (kN)`), an optional line of units, then numbers; lines that begin
//!   with `#` are skipped. A decimal comma is read where commas do not separate.

use truepath_ground::diagnostics::{InputError, Source};

use crate::codes::E001;

/// Columns of numbers over time.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Record {
    /// Kind of file, in words.
    pub kind: &'static str,
    /// Names, without units; `1`, `2`, … where there are none.
    pub names: Vec<String>,
    /// Unit of each column, as far as it is written.
    pub units: Vec<Option<String>>,
    /// The numbers, column by column.
    pub columns: Vec<Vec<f64>>,
    /// Sampling rate, Hz, as far as the file says it.
    pub rate_hz: Option<f64>,
    /// Column of time, if there is one.
    pub time: Option<usize>,
}

/// Most samples of a record.
const MOST: usize = 20_000_000;
/// Lines searched for the first numbers.
const HEAD: usize = 400;

impl Record {
    /// Reads a record of any of the three kinds.
    ///
    /// # Errors
    /// `E001` with the line.
    pub fn read(source: &Source) -> Result<Self, InputError> {
        let bytes = source.bytes();
        if bytes.starts_with(&[0xff, 0xfe]) || bytes.starts_with(&[0xfe, 0xff]) {
            let help = "save it as UTF-8";
            return Err(InputError::new(E001, "the record is UTF-16", "text in UTF-8 or ASCII", help).at(source, 0..2));
        }
        let text = String::from_utf8_lossy(bytes);
        let text = text.trim_start_matches('\u{feff}');
        let head: Vec<&str> = text.lines().take(HEAD).collect();
        let first = head.first().copied().unwrap_or_default();
        if first.starts_with("LabVIEW Measurement") {
            labview(source, text, &head)
        } else if first.trim_start_matches(['"', ' ']).starts_with("DynoWare") {
            dynoware(source, text, &head)
        } else {
            plain(source, text, &head)
        }
    }

    /// The column of a name, whatever its case.
    pub fn column(&self, name: &str) -> Option<usize> {
        self.names.iter().position(|n| n.eq_ignore_ascii_case(name.trim()))
    }

    /// Samples.
    pub fn samples(&self) -> usize {
        self.columns.first().map_or(0, Vec::len)
    }

    /// The rate, from the file or from its column of time, Hz.
    pub fn rate(&self) -> Option<f64> {
        let from_time = || {
            let times = self.columns.get(self.time?)?;
            let (first, last) = (times.first()?, times.last()?);
            let rate = (times.len() - 1) as f64 / (last - first);
            (rate.is_finite() && rate > 0.0).then_some(rate)
        };
        self.rate_hz.or_else(from_time)
    }

    /// Time of the first sample, s.
    pub fn start_s(&self) -> f64 {
        self.time.and_then(|t| self.columns.get(t)?.first().copied()).unwrap_or(0.0)
    }
}

/// How numbers are written.
#[derive(Clone, Copy, Debug)]
struct Notation {
    separator: u8,
    decimal_comma: bool,
}

impl Notation {
    /// What a line of numbers shows.
    fn of(line: &str) -> Option<Self> {
        let tried = [(b'\t', true), (b';', true), (b',', false), (b' ', true), (b' ', false)];
        let reads = |&(separator, comma): &(u8, bool)| {
            let notation = Self { separator, decimal_comma: comma && line.contains(',') };
            let row = notation.numbers(line)?;
            (row.iter().filter(|v| v.is_some()).count() >= if separator == b' ' { 1 } else { 2 }).then_some(notation)
        };
        tried.iter().find_map(reads)
    }

    fn fields(self, line: &str) -> Vec<&str> {
        let fields =
            line.trim_end_matches(['\r', '\n']).split(char::from(self.separator)).map(|f| f.trim().trim_matches('"'));
        if self.separator == b' ' { fields.filter(|f| !f.is_empty()).collect() } else { fields.collect() }
    }

    fn number(self, field: &str) -> Option<f64> {
        let value: f64 = if self.decimal_comma { field.replace(',', ".").parse() } else { field.parse() }.ok()?;
        value.is_finite().then_some(value)
    }

    /// The numbers of a line, none where a field is empty; `None` if one is something else.
    fn numbers(self, line: &str) -> Option<Vec<Option<f64>>> {
        let fields = self.fields(line);
        let row: Vec<Option<f64>> = fields
            .iter()
            .map(|f| if f.is_empty() { Some(None) } else { self.number(f).map(Some) })
            .collect::<Option<_>>()?;
        row.first()?.is_some().then_some(row)
    }
}

/// The numbers from line `from` (counted from 0) on, with as many columns as there are names.
fn body(
    source: &Source,
    text: &str,
    from: usize,
    notation: Notation,
    names: Vec<String>,
    kind: &'static str,
) -> Result<Record, InputError> {
    let mut columns: Vec<Vec<f64>> = vec![Vec::new(); names.len()];
    for (at, line) in text.lines().enumerate().skip(from) {
        if line.trim().is_empty() || line.starts_with('#') {
            continue;
        }
        if line.starts_with("Channels") || line.starts_with("LabVIEW") || line.starts_with("***") {
            break;
        }
        let refused = |found: String| {
            let span = source.line_span(u32::try_from(at + 1).unwrap_or(u32::MAX));
            E001.error(found, format!("{} numbers", names.len())).at(source, span)
        };
        let fields = notation.fields(line);
        if fields.len() < names.len() {
            return Err(refused(format!("this line has {} fields", fields.len())));
        }
        // A comment of LabVIEW stands behind the numbers; two numbers for each name are halves at a decimal comma.
        let beyond = fields.iter().skip(names.len()).filter(|field| notation.number(field).is_some()).count();
        if beyond > 0 && notation.separator == b',' {
            let found = format!("this line has {} numbers for {} names", names.len() + beyond, names.len());
            let help = "a decimal comma needs another separator than the comma: export with decimal points, or with tabs or semicolons";
            let span = source.line_span(u32::try_from(at + 1).unwrap_or(u32::MAX));
            return Err(InputError::new(E001, found, format!("{} numbers", names.len()), help).at(source, span));
        }
        for (column, field) in columns.iter_mut().zip(&fields) {
            column.push(notation.number(field).ok_or_else(|| refused(format!("\"{field}\" is no number")))?);
        }
        if columns[0].len() > MOST {
            return Err(refused(format!("the record has more than {MOST} samples")));
        }
    }
    let units = vec![None; names.len()];
    if columns.first().is_none_or(Vec::is_empty) {
        return Err(E001.error("the record holds no numbers", "columns of numbers").at(source, source.line_span(1)));
    }
    let time = names.iter().position(|n| {
        let n = n.to_lowercase();
        ["time", "t", "t_s", "time_s", "zeit", "x_value", "seconds"].contains(&n.as_str())
    });
    Ok(Record { kind, names, units, columns, rate_hz: None, time })
}

/// `Fx [N]`, `Fx (N)` and `Fx_N` into name and unit.
fn named(field: &str) -> (String, Option<String>) {
    for (open, close) in [('[', ']'), ('(', ')')] {
        if let Some((name, rest)) = field.split_once(open) {
            return (name.trim().to_owned(), rest.split(close).next().map(|unit| unit.trim().to_owned()));
        }
    }
    for unit in ["kN", "N", "kn", "n"] {
        if let Some(name) = field.strip_suffix(unit).and_then(|f| f.strip_suffix('_')) {
            return (name.to_owned(), Some(unit.to_owned()));
        }
    }
    (field.to_owned(), None)
}

/// The first line of numbers, with how it is written.
fn first_numbers(head: &[&str], from: usize) -> Option<(usize, Notation)> {
    let lines =
        head.iter().enumerate().skip(from).filter(|(_, line)| !line.trim().is_empty() && !line.starts_with('#'));
    lines.filter_map(|(at, line)| Some((at, Notation::of(line)?))).next()
}

fn no_numbers(source: &Source, kind: &str) -> InputError {
    let found = format!("no line of numbers follows the head of this {kind}");
    E001.error(found, "columns of numbers").at(source, source.line_span(1))
}

fn dynoware(source: &Source, text: &str, head: &[&str]) -> Result<Record, InputError> {
    const KIND: &str = "DynoWare export";
    let begins = |line: &&str| {
        let line = line.trim_start_matches('"').to_lowercase();
        (line.starts_with("time") || line.starts_with("zeit")) && !line.contains(':')
    };
    let names_at = head.iter().position(begins).ok_or_else(|| no_numbers(source, KIND))?;
    let (from, notation) = first_numbers(head, names_at + 1).ok_or_else(|| no_numbers(source, KIND))?;
    let names: Vec<String> =
        notation.fields(head[names_at]).iter().filter(|f| !f.is_empty()).map(|f| named(f).0).collect();
    let mut record = body(source, text, from, notation, names, KIND)?;
    if from > names_at + 1 {
        let units = notation.fields(head[names_at + 1]);
        record.units =
            (0..record.names.len()).map(|k| units.get(k).map(|u| u.trim_matches(['[', ']']).to_owned())).collect();
    }
    let rate = head.iter().take(names_at).find(|line| line.to_lowercase().contains("sampling rate"));
    record.rate_hz = rate.and_then(|line| notation.fields(line).iter().rev().find_map(|f| notation.number(f)));
    Ok(record)
}

fn labview(source: &Source, text: &str, head: &[&str]) -> Result<Record, InputError> {
    const KIND: &str = "LabVIEW measurement";
    const END: &str = "***End_of_Header***";
    let ends: Vec<usize> = head.iter().enumerate().filter(|(_, l)| l.starts_with(END)).map(|(k, _)| k).collect();
    let &[file, segment, ..] = ends.as_slice() else { return Err(no_numbers(source, KIND)) };
    let separator =
        if head.iter().take(file).any(|l| l.starts_with("Separator") && l.contains("Comma")) { b',' } else { b'\t' };
    let decimal_comma =
        separator == b'\t' && head.iter().take(file).any(|l| l.starts_with("Decimal_Separator") && l.contains(','));
    let notation = Notation { separator, decimal_comma };
    let of = |key: &str| {
        let line = head.get(file..segment)?.iter().find(|l| l.starts_with(key))?;
        Some(notation.fields(line).into_iter().skip(1).map(str::to_owned).collect::<Vec<String>>())
    };
    let names_at =
        (segment + 1..head.len()).find(|k| !head[*k].trim().is_empty()).ok_or_else(|| no_numbers(source, KIND))?;
    let titled = notation.numbers(head[names_at]).is_none();
    let row = notation.fields(head[if titled { names_at + 1 } else { names_at }.min(head.len() - 1)]);
    let count = row.iter().filter(|f| !f.is_empty()).count();
    let mut names: Vec<String> = if titled {
        notation.fields(head[names_at]).iter().filter(|f| **f != "Comment").map(|f| named(f).0).collect()
    } else {
        (1..=count).map(|k| k.to_string()).collect()
    };
    let timed = head.iter().take(file).find(|l| l.starts_with("X_Columns")).is_none_or(|l| !l.contains("No"));
    // Without a column of time its name stands there all the same.
    if !timed && names.first().is_some_and(|n| n == "X_Value") {
        // The field before the first value is empty.
        if row.first().is_some_and(|f| !f.is_empty()) {
            names.remove(0);
        }
    }
    let empty_time = !timed && row.first().is_some_and(|f| f.is_empty());
    while names.last().is_some_and(String::is_empty) {
        names.pop();
    }
    let mut record = if empty_time {
        let shifted: String =
            text.lines().map(|l| format!("{}\n", l.strip_prefix(char::from(separator)).unwrap_or(l))).collect();
        names.remove(0);
        body(source, &shifted, names_at + usize::from(titled), notation, names, KIND)?
    } else {
        body(source, text, names_at + usize::from(titled), notation, names, KIND)?
    };
    let step = of("Delta_X").and_then(|steps| steps.iter().find_map(|f| notation.number(f))).filter(|dx| *dx > 0.0);
    record.rate_hz = step.map(|dx| 1.0 / dx);
    let labels: Vec<String> = of("Y_Unit_Label").unwrap_or_default().into_iter().filter(|u| !u.is_empty()).collect();
    let mut labels = labels.into_iter();
    record.units = record.names.iter().map(|n| if n == "X_Value" { None } else { labels.next() }).collect();
    Ok(record)
}

fn plain(source: &Source, text: &str, head: &[&str]) -> Result<Record, InputError> {
    let (from, notation) = first_numbers(head, 0).ok_or_else(|| no_numbers(source, "text"))?;
    let fields = notation.fields(head[from]);
    // A separator may stand at the end of a line, too.
    let mut count = fields.iter().rposition(|field| !field.trim().is_empty()).map_or(0, |last| last + 1);
    // Names for half of the numbers: the others are behind decimal commas, which `body` refuses.
    let is_half = |line: &&str| !line.starts_with('#') && 2 * notation.fields(line).len() == count;
    if notation.separator == b',' && count > 2 && head[..from].iter().any(is_half) {
        count /= 2;
    }
    let before: Vec<Vec<&str>> = head[..from]
        .iter()
        .filter(|l| !l.trim().is_empty() && !l.starts_with('#'))
        .map(|l| notation.fields(l))
        .filter(|f| f.len() >= count)
        .collect();
    let (names, units) = match before.as_slice() {
        [] => ((1..=count).map(|k| k.to_string()).collect(), vec![None; count]),
        [only] => only.iter().take(count).map(|f| named(f)).unzip(),
        [.., names, units] => {
            let unit = |k: usize| units.get(k).map(|u| u.trim_matches(['[', ']', '(', ')']).to_owned());
            (names.iter().take(count).map(|f| named(f).0).collect(), (0..count).map(unit).collect())
        }
    };
    let mut record = body(source, text, from, notation, names, "columns")?;
    record.units = units;
    Ok(record)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Result<Record, InputError> {
        Record::read(&Source::new("r.txt", text.as_bytes().to_vec()))
    }

    #[test]
    fn dynoware_is_read_with_names_units_and_rate() {
        for separator in [",", "\t", ";"] {
            let text = "DynoWare,Version 2.5.1.2\r\nPath:,C:\\data\\\r\nDate:, \r\nSampling rate [Hz]:,10000\r\nCycles:,1\r\n\
                        Time,Fx,Fy,Fz\r\ns,N,N,N\r\n5,276.031,40.1917,94.7571\r\n5.0001,257.538,40.3748,95.7642\r\n";
            let record = read(&text.replace(',', separator)).expect(separator);
            assert_eq!((record.kind, record.rate(), record.start_s()), ("DynoWare export", Some(10_000.0), 5.0));
            assert_eq!(record.names, ["Time", "Fx", "Fy", "Fz"]);
            assert_eq!(record.units[1].as_deref(), Some("N"));
            assert_eq!(record.columns[2], [40.1917, 40.3748]);
        }
    }

    #[test]
    fn labview_is_read_with_one_several_or_no_columns_of_time() {
        let head = "LabVIEW Measurement\t\nWriter_Version\t2\nSeparator\tTab\nDecimal_Separator\t.\nX_Columns\tONE\n***End_of_Header***\t\n\t\n\
                    Channels\t2\t\t\nSamples\t2\t2\t\nY_Unit_Label\tN\tN\t\nX0\t0.0\t0.0\t\nDelta_X\t0.000250\t0.000250\t\n\
                    ***End_of_Header***\t\t\t\n";
        let one =
            read(&format!("{}X_Value\tFx\tFy\tComment\n0.0\t1.5\t-2\n0.00025\t2.5\t-3\n", head.replace("ONE", "One")))
                .expect("one");
        assert_eq!((one.names.join(" "), one.rate()), ("X_Value Fx Fy".to_owned(), Some(4000.0)));
        assert_eq!((one.columns[2].as_slice(), one.units[1].as_deref()), ([-2.0, -3.0].as_slice(), Some("N")));
        let none = read(&format!("{}X_Value\tFx\tFy\tComment\n\t1.5\t-2\n\t2.5\t-3\n", head.replace("ONE", "No")))
            .expect("none");
        assert_eq!((none.names.join(" "), none.rate()), ("Fx Fy".to_owned(), Some(4000.0)));
        assert_eq!(none.columns[0], [1.5, 2.5]);
        let comma = head
            .replace("ONE", "One")
            .replace("Decimal_Separator\t.", "Decimal_Separator\t,")
            .replace("0.000250", "0,000250");
        let comma = read(&format!("{comma}X_Value\tFx\tFy\tComment\n0,0\t1,5\t-2\n0,00025\t2,5\t-3\n")).expect("comma");
        assert_eq!((comma.columns[1].as_slice(), comma.rate()), ([1.5, 2.5].as_slice(), Some(4000.0)));
    }

    #[test]
    fn plain_columns_are_read_with_and_without_names() {
        let record = read("# made by hand\ntime_s,Fx [N],Fy (kN)\n0,1,2\n0.001,3,4\n").expect("names");
        assert_eq!((record.names.join(" "), record.rate()), ("time_s Fx Fy".to_owned(), Some(1000.0)));
        assert_eq!(record.units[2].as_deref(), Some("kN"));
        let record = read("1,5;2\n2,5;3\n").expect("decimal comma");
        assert_eq!((record.names.join(" "), record.columns[0].as_slice()), ("1 2".to_owned(), [1.5, 2.5].as_slice()));
        let record = read("  0.0   1.0  2.0\n  0.1   1.5  2.5\n").expect("blanks");
        assert_eq!(record.columns[2], [2.0, 2.5]);
        let error = read("Fx,Fy\n1,2\n3\n").expect_err("short");
        assert_eq!((error.code(), error.line_column()), ("E001", Some((3, 1))));
        assert_eq!(read("Fx,Fy\nnone\n").expect_err("nothing").code(), "E001");
    }

    #[test]
    fn decimal_commas_between_commas_are_named() {
        let dynoware = "DynoWare,Version 2.5\nSampling rate [Hz]:,10000\nTime,Fx,Fy\ns,N,N\n0,00000,2,172,-2,496\n0,00010,3,1,-2,5\n";
        for (text, line) in [(dynoware, 5), ("t,Fx\n0,0,1,5\n0,1,2,5\n", 2)] {
            let error = read(text).expect_err("halves of numbers");
            assert_eq!((error.code(), error.line_column()), ("E001", Some((line, 1))), "{error}");
            assert!(error.to_json()["error"]["help"].to_string().contains("decimal comma"), "{error}");
        }
        // What stands there that is no number does no harm, nor a comma at the end.
        assert_eq!(read("t,Fx\n0,1.5,\n1,2.5,\n").expect("a comma at the end").columns[1], [1.5, 2.5]);
    }
}
