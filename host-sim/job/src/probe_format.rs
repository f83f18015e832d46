//! The format of a probe file, by its contents: where the job names none, and where the file plainly is another than the job
//! says.
//!
//! | in the file | format |
//! |---|---|
//! | an XML document whose root is `QIFDocument` | QIF 3, read as `columns` of surface points in work coordinates |
//! | `# truepath probe log`, or nine columns with commas of which two are a normal and the last 0 or 1 | `linuxcnc-log` |
//! | `[PRB:` | `grbl` |
//! | `G800` or `G801` alone at the start of lines, numbers without padding | `inspection` |
//! | the same with padded numbers, or X Y Z words alone | `dprnt` |
//! | nine numbers a line, blanks between them | `linuxcnc` |
//! | any other numbers in columns, or a header that names x, y and z | `columns` |

use truepath_core::job::Probe;
use truepath_core::probe::Format;
use truepath_ground::diagnostics::{InputError, Source};

use crate::codes::{J043, J044};
use crate::job::{FORMATS, JobFile};
use crate::qif::{as_columns, is_qif};

/// Readings kept at most.
pub(crate) const LARGEST_FILE: usize = 1 << 20;

/// Lines with something on them that are looked at.
const LINES: usize = 60;

/// A probe file whose format is settled.
pub(crate) struct Settled {
    /// The probe of the job, with that format.
    pub(crate) probe: Probe,
    /// What is said of the format, where it is not that of the job.
    pub(crate) read_as: Option<String>,
    /// The text to be read: the file, of a QIF document its points.
    pub(crate) text: Source,
}

/// The probe of a job for a file: in the format that the job names, or that the file shows.
///
/// # Errors
/// `J044` for a file in UTF-16, `J043` when neither job nor file shows a format, `J004` for a job without `[probe]`; what is wrong
/// with a QIF document.
pub(crate) fn settled(job: &JobFile, file: &Source) -> Result<Settled, InputError> {
    let probe = job.require_probe()?;
    if is_qif(file.bytes()) {
        let (layout, text) = as_columns(file)?;
        let probe = Probe { format: Format::Columns, layout: Some(layout), ..probe };
        return Ok(Settled { probe, read_as: None, text });
    }
    let (probe, read_as) = shown(job, probe, file)?;
    Ok(Settled { probe, read_as, text: file.clone() })
}

fn shown(job: &JobFile, probe: Probe, file: &Source) -> Result<(Probe, Option<String>), InputError> {
    if let Some(found) = utf16(file.bytes()) {
        return Err(J044.error(found, "a text in ASCII or UTF-8").at(file, 0..2.min(file.bytes().len())));
    }
    let seen = recognised(file.bytes());
    let name = |format: Format| FORMATS.iter().find(|(_, f)| *f == format).map_or("", |(name, _)| *name);
    match (job.format_stated, seen) {
        (true, Some(Seen { format, certain: true })) if !alike(format, probe.format) => {
            let said = format!(
                "{}: read as format = \"{}\", which it plainly is; [probe] says \"{}\": correct format there",
                file.name(),
                name(format),
                name(probe.format)
            );
            Ok((Probe { format, layout: None, ..probe }, Some(said)))
        }
        (true, _) => Ok((probe, None)),
        (false, Some(Seen { format, .. })) => {
            let layout = if format == Format::Columns { probe.layout.or(Some(Default::default())) } else { None };
            Ok((Probe { format, layout, ..probe }, None))
        }
        (false, None) if file.bytes().iter().all(u8::is_ascii_whitespace) => Ok((probe, None)),
        (false, None) => {
            let names: Vec<String> = FORMATS.iter().map(|(name, _)| format!("\"{name}\"")).collect();
            let found = "the file shows none of the formats, and [probe] of the job names none";
            Err(J043.error(found, format!("one of {}", names.join(", "))).at(file, 0..file.bytes().len().min(1)))
        }
    }
}

/// Inspection text and DPRNT are one language.
fn alike(a: Format, b: Format) -> bool {
    let family = |format| if format == Format::Inspection { Format::Dprnt } else { format };
    family(a) == family(b)
}

/// A format that a file shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Seen {
    format: Format,
    /// Whether no file of another format looks like that.
    certain: bool,
}

/// What a file in UTF-16 shows of it.
fn utf16(bytes: &[u8]) -> Option<String> {
    let zeros = bytes.iter().take(400).filter(|b| **b == 0).count();
    match bytes {
        [0xFF, 0xFE, ..] => Some("the file is in UTF-16: it begins with the bytes FF FE".to_owned()),
        [0xFE, 0xFF, ..] => Some("the file is in UTF-16: it begins with the bytes FE FF".to_owned()),
        // DPRNT may hold a NUL here and there, not behind every letter.
        _ if bytes.len() > 20 && zeros * 5 > bytes.len().min(400) * 2 => {
            Some("the file is in UTF-16: every other byte is 0".to_owned())
        }
        _ => None,
    }
}

fn recognised(bytes: &[u8]) -> Option<Seen> {
    let text = String::from_utf8_lossy(bytes);
    // NUL, DC1 to DC4 and % stand around what a serial line sends.
    let trimmed = |line: &str| line.trim_matches(|c: char| c.is_whitespace() || c.is_control() || c == '%').to_owned();
    let lines: Vec<String> =
        text.split(['\n', '\r']).map(trimmed).filter(|line| !line.is_empty()).take(LINES).collect();
    let any = |holds: &dyn Fn(&str) -> bool| lines.iter().any(|line| holds(line));
    let certain = |format| Some(Seen { format, certain: true });
    if any(&|line| line.starts_with("# truepath probe log")) {
        return certain(Format::LinuxcncLog);
    }
    if any(&|line| line.contains("[PRB:")) {
        return certain(Format::Grbl);
    }
    if any(&|line| line.starts_with("G800 ") || line.starts_with("G801 ")) {
        // Padded: a blank, or a sign and blanks, between a letter and its number.
        let padded =
            any(&|line| line.contains("X ") || line.contains("Y ") || line.contains("Z ") || line.contains("N "));
        return certain(if padded { Format::Dprnt } else { Format::Inspection });
    }
    let rows: Vec<&String> = lines.iter().filter(|line| !line.starts_with(['#', '(', ';'])).collect();
    let words = |line: &&&String| {
        let mut letters = line.chars().filter(char::is_ascii_alphabetic);
        letters.next() == Some('X') && letters.next() == Some('Y')
    };
    if !rows.is_empty() && rows.iter().filter(words).count() * 2 > rows.len() {
        return certain(Format::Dprnt);
    }
    let log = |line: &&&String| is_log_row(line);
    if !rows.is_empty() && rows.iter().filter(log).count() * 2 > rows.len() {
        return certain(Format::LinuxcncLog);
    }
    let nine = |line: &&&String| {
        let numbers: Vec<&str> = line.split_whitespace().collect();
        numbers.len() == 9 && numbers.iter().all(|n| n.parse::<f64>().is_ok())
    };
    if !rows.is_empty() && rows.iter().all(|row| nine(&row)) {
        return certain(Format::Linuxcnc);
    }
    let numbers = |line: &&&String| {
        let split = |c: char| c.is_whitespace() || matches!(c, ';' | ',');
        line.split(split).filter(|n| n.parse::<f64>().is_ok()).count() >= 3
    };
    let columns = rows.iter().filter(numbers).count();
    (columns > 0 && columns + 1 >= rows.len()).then_some(Seen { format: Format::Columns, certain: false })
}

/// `id,nx,ny,xn,yn,xs,ys,zs,hit`.
fn is_log_row(line: &str) -> bool {
    let numbers: Vec<f64> = line.split(',').filter_map(|n| n.trim().parse().ok()).collect();
    let [_, nx, ny, .., hit] = numbers[..] else { return false };
    let normal = (nx.hypot(ny) - 1.0).abs() < 1e-3;
    line.split(',').count() == 9 && numbers.len() == 9 && normal && (hit == 0.0 || hit == 1.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> Option<&'static str> {
        let seen = recognised(text.as_bytes())?;
        FORMATS.iter().find(|(_, f)| *f == seen.format).map(|(name, _)| *name)
    }

    #[test]
    fn every_format_shows_itself() {
        for (text, expected) in [
            ("# truepath probe log 1\n# unit mm\n", Some("linuxcnc-log")),
            ("1,1.000000,0.000000,24.0,50.0,27.088,50.0,-10.0,1\n", Some("linuxcnc-log")),
            ("31.0 60.0 -5.0 0 0 0 0 0 0\n31.002 50.0 -5.0 0 0 0 0 0 0\n", Some("linuxcnc")),
            (">>> $$\n$13=0\n[PRB:-345.420,-190.250,-422.000:1]\nok\n", Some("grbl")),
            ("START\nG800 N1 X24.0 Y60.0 Z-10.0 I1.0 J0.0\nG801 N1 X27.08 Y60. Z-10. R3.\nEND\n", Some("inspection")),
            ("%\nSTART\nG800 N   1 X   24.0000 Y   60.0 Z-  10.0\nEND    1\n%\n", Some("dprnt")),
            ("X   24.080 Y   60.000 Z-  10.000\n", Some("dprnt")),
            ("x_mm,y_mm,z_mm\n1.0,2.0,-3.0\n1.0,2.5,-3.0\n", Some("columns")),
            ("1,0;2,0;-3,0\n1,0;2,5;-3,0\n", Some("columns")),
            ("Punkt;X;Y;Z\n", None),
            ("# only talk\n", None),
        ] {
            assert_eq!(of(text), expected, "{text}");
        }
    }

    #[test]
    fn a_file_in_utf_16_is_seen_with_and_without_its_mark() {
        let wide = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<u8>>();
        assert!(utf16(&wide("\u{feff}1 2 3")).is_some_and(|said| said.contains("FF FE")));
        assert!(utf16(&wide("31.0 60.0 -5.0 0 0 0")).is_some());
        assert_eq!(utf16(b"\0%START\nX   24.080 Y   60.000\0\n"), None);
    }
}
