//! Programs, jobs and probe files without names and comments: numbers stay what they are, and lines keep their numbers.
//!
//! Limits: features keep their names, which tie markers of the program to tables of the job; what a control is told to print
//! (`MSG`, `DPRNT`) stays. Whoever takes comments out makes the corrections anew, which shows whether any of them was read.

use toml::{Table, Value};

/// Comments that a control or Truepath acts on.
const MARKS: [&str; 5] = ["TRUEPATH", "PROBEOPEN", "PROBECLOSE", "LOGOPEN", "LOGCLOSE"];
/// Keys of `[part]` that are names.
const NAMES: [&str; 6] = ["name", "drawing", "serial", "material_batch", "customer", "date"];

/// A program without comments. `parentheses` are comments, and not those of an expression.
pub fn program(bytes: &[u8], parentheses: bool) -> Vec<u8> {
    let lines = bytes.split_inclusive(|byte| matches!(byte, b'\n' | b'\r'));
    lines.flat_map(|line| without_comments(line, parentheses)).collect()
}

fn without_comments(line: &[u8], parentheses: bool) -> Vec<u8> {
    let end = line.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(line.len());
    let (mut rest, ending) = line.split_at(end);
    let mut kept = Vec::new();
    while let Some((&byte, behind)) = rest.split_first() {
        let comment = match byte {
            b';' => rest.len(),
            b'(' if parentheses => rest.iter().position(|b| *b == b')').map_or(rest.len(), |at| at + 1),
            _ => {
                kept.push(byte);
                rest = behind;
                continue;
            }
        };
        let (comment, behind) = rest.split_at(comment);
        if is_mark(comment) {
            kept.extend_from_slice(comment);
        } else if byte == b';' {
            // A control may want its end of block.
            kept.push(byte);
        }
        rest = behind;
    }
    kept.extend_from_slice(ending);
    kept
}

fn is_mark(comment: &[u8]) -> bool {
    let text: String =
        comment.iter().skip(1).map(|b| char::from(*b).to_ascii_uppercase()).filter(|c| *c != ' ').collect();
    MARKS.iter().any(|mark| text.starts_with(mark))
}

/// What the log of a verification program says of itself; the checksums of program and correction are not among it, since both
/// become others.
const HEADS: [&str; 5] = ["truepath probe log", "unit ", "ball ", "points ", "end "];

/// A file of dimensions without names and comments; `None` for one that is no TOML, or that names another file.
pub fn dimensions(bytes: &[u8]) -> Option<Vec<u8>> {
    let mut table: Table = std::str::from_utf8(bytes).ok()?.parse().ok()?;
    let all = table.get_mut("dimension")?.as_array_mut()?;
    all.iter_mut().filter_map(Value::as_table_mut).for_each(|one| drop(one.remove("name")));
    (!table.contains_key("values")).then(|| table.to_string().into_bytes())
}

/// A probe file without its lines of comment, which are left empty; `None` for XML, whose names are everywhere.
pub fn probe(bytes: &[u8]) -> Option<Vec<u8>> {
    if bytes.trim_ascii_start().starts_with(b"<") {
        return None;
    }
    let lines = bytes.split_inclusive(|byte| matches!(byte, b'\n' | b'\r'));
    let kept = lines.flat_map(|line| {
        let end = line.iter().position(|byte| matches!(byte, b'\n' | b'\r')).unwrap_or(line.len());
        let mut text = String::from_utf8_lossy(line).trim().to_lowercase();
        let comment = text.starts_with(['(', ';', '#']);
        text = text.trim_start_matches(['(', ';', '#', ' ']).to_owned();
        let head = HEADS.iter().any(|head| text.starts_with(head));
        if comment && !head { &line[end..] } else { line }
    });
    Some(kept.copied().collect())
}

/// A job without comments, without the names of `[part]` and without `[store]`, which names other files. `renamed` gives the new name for each old
/// one: program, stock surface, stock probe, measured forces.
///
/// # Errors
/// The text is no TOML.
pub fn job(text: &str, renamed: impl Fn(&str) -> String) -> Result<String, toml::de::Error> {
    let mut table: Table = text.parse()?;
    if let Some(Value::Table(part)) = table.get_mut("part") {
        NAMES.iter().for_each(|key| drop(part.remove(*key)));
    }
    // Nothing of it says how a part is cut.
    table.remove("store");
    for (section, key) in FILES {
        let place = match section {
            "" => Some(&mut table),
            section => table.get_mut(section).and_then(Value::as_table_mut),
        };
        if let Some(Value::String(name)) = place.and_then(|place| place.get_mut(key)) {
            *name = renamed(name);
        }
    }
    Ok(table.to_string())
}

/// Keys of a job that name files, with their tables.
pub const FILES: [(&str, &str); 5] =
    [("", "program"), ("stock", "surface"), ("stock", "probe"), ("force", "from"), ("tool", "runout_from")];

/// The files that a job names; none where the text is no job.
pub fn named(text: &str) -> Vec<(&'static str, String)> {
    let Ok(table) = text.parse::<Table>() else { return Vec::new() };
    let of = |(section, key): (&str, &'static str)| {
        let place = if section.is_empty() { &table } else { table.get(section)?.as_table()? };
        Some((key, place.get(key)?.as_str()?.to_owned()))
    };
    FILES.into_iter().filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_go_and_what_a_control_acts_on_stays() {
        let text = b"%\nO1000 (BRACKET FOR ACME)\nT4 M6 ( D=10 )\r\n(TRUEPATH BEGIN a)\nG1 X1 (half) Y2 ; by hand\n( ProbeOpen p.txt )\nG0 Z5;\n";
        let kept = "%\nO1000 \nT4 M6 \r\n(TRUEPATH BEGIN a)\nG1 X1  Y2 ;\n( ProbeOpen p.txt )\nG0 Z5;\n";
        assert_eq!(String::from_utf8(program(text, true)).expect("text"), kept);
        assert_eq!(program(b"R1=SIN(30) ; own\n", false), b"R1=SIN(30) ;\n");
        assert_eq!(program(b"G1 X1 (never closed\nG1 X2\n", true), b"G1 X1 \nG1 X2\n");
    }

    #[test]
    fn a_probe_file_keeps_its_numbers_on_their_lines() {
        let text = b"(part 7, Miller)\n1.0 2.0 3.0\r\n  # again\r\n4.0 5.0 6.0\n";
        assert_eq!(probe(text).unwrap(), b"\n1.0 2.0 3.0\r\n\r\n4.0 5.0 6.0\n");
        let log = b"# truepath probe log 1\n# program 23d6c628\n# unit mm\n# points 1\n1,2\n# end 1\n";
        assert_eq!(probe(log).unwrap(), b"# truepath probe log 1\n\n# unit mm\n# points 1\n1,2\n# end 1\n");
    }

    #[test]
    fn a_job_keeps_its_numbers_and_loses_names() {
        let text = "# Miller\nversion = 1\nprogram = \"../acme/b.nc\"\n[stock]\nallowance_mm = 0.8\nprobe = \"s.txt\" # own\n\
                    [part]\nname = \"bracket\"\ntolerance_mm = 0.02\n[store]\nurl = \"postgres://Miller@acme/own\"\n";
        assert_eq!(named(text), [("program", "../acme/b.nc".to_owned()), ("probe", "s.txt".to_owned())]);
        let bare = job(text, |old| format!("new-{}", old.len())).expect("TOML");
        for gone in ["Miller", "acme", "bracket", "own"] {
            assert!(!bare.contains(gone), "{bare}");
        }
        let table: Table = bare.parse().expect("TOML");
        assert_eq!(table["stock"]["allowance_mm"].as_float(), Some(0.8));
        assert_eq!(table["part"]["tolerance_mm"].as_float(), Some(0.02));
        assert_eq!((table["program"].as_str(), table["stock"]["probe"].as_str()), (Some("new-12"), Some("new-5")));
        assert!(job("version = ", str::to_owned).is_err());
    }
}
