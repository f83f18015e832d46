//! A draft as a job file.

use std::fmt::Write as _;

use truepath_ground::decimal::Decimal;
use truepath_ground::length::Unit;
use truepath_ground::length::in_inches;

use super::contents::{Draft, Entry, Origin};

/// Tables in the order of the file.
const TABLES: [&str; 11] =
    ["", "stock", "tool", "cut", "force", "machine", "probe", "correct", "feed", "part", "pocket"];
const MM_PER_INCH: f64 = 25.4;
/// Where comments begin.
const COMMENT: usize = 36;

/// What a table is about.
fn about(table: &str) -> &'static str {
    match table {
        "stock" => "what lies on the wall before this pass",
        "tool" => "the cutter",
        "cut" => "depth; speed and feed are those of the program",
        "force" => "of the material, where the fit to the points begins",
        "machine" => "where the fit to the points begins",
        "probe" => "the format of the file shows itself",
        _ => "",
    }
}

/// The whole file, with comments.
pub(super) fn text(draft: &Draft, program: &str) -> String {
    let mut out = format!(
        "# Job of {}, written by `truepath init`. Every key with its range and default: docs/job.md.\n\
         # Behind every value stands where it comes from; what says \"please check\" nobody has said.\n",
        program.replace(|c: char| c.is_control(), " ")
    );
    for table in TABLES {
        let entries: Vec<&Entry> = draft.entries.iter().filter(|entry| entry.place().0 == table).collect();
        if entries.is_empty() && table != "cut" {
            continue;
        }
        out.push('\n');
        if !table.is_empty() {
            line(&mut out, &format!("[{table}]"), about(table));
        }
        if table == "cut" {
            for fact in &draft.facts {
                let _ = writeln!(out, "# {fact}");
            }
        }
        for entry in entries {
            let (key, value) = entry.in_unit(draft.unit);
            match entry.origin {
                Origin::Fixed if key == "program" => {
                    let name = toml::Value::String(program.to_owned()).to_string();
                    line(&mut out, &format!("{key} = {name}"), "relative to this file");
                }
                Origin::Left | Origin::Open => line(&mut out, &format!("# {key} = {value}"), &entry.reason()),
                _ => line(&mut out, &format!("{key} = {value}"), &entry.reason()),
            }
        }
    }
    features(&mut out, draft);
    out
}

/// Decimals of an inch at which a length counts as round.
const ROUND: i32 = 4;

impl Entry {
    /// Key, without its table, and value: in inches where the program is and the length is round in them, since then it was meant so.
    pub fn in_unit(&self, unit: Unit) -> (String, String) {
        let (_, key) = self.place();
        let inches = || {
            let key = in_inches(key).filter(|_| unit == Unit::Inch)?;
            let mm = Decimal::parse(&self.value)?;
            let rounded = (mm.as_f64() / MM_PER_INCH * 10f64.powi(ROUND)).round() / 10f64.powi(ROUND);
            let value = rounded.to_string();
            let same = Decimal::parse(&value)?.of_inches().as_mm() == mm.as_mm() && rounded != 0.0;
            same.then_some((key, value))
        };
        inches().unwrap_or_else(|| (key.to_owned(), self.value.clone()))
    }
}

/// The contours, where there are several: the chosen one in force, the others in comments.
fn features(out: &mut String, draft: &Draft) {
    let Some(chosen) = draft.chosen else { return };
    let _ = writeln!(out, "\n# The program makes {} walls; this job is about the one below.", draft.contours.len());
    for contour in &draft.contours {
        let sign = if contour.number == chosen { "" } else { "# " };
        let id = format!("wall-{}", contour.number);
        let _ = write!(out, "{sign}[[feature]]");
        let _ = writeln!(out, "{}# {}", " ".repeat(COMMENT.saturating_sub(11 + sign.len())), contour.words(draft.unit));
        let _ = writeln!(out, "{sign}id = \"{id}\"\n{sign}lines = [{}, {}]", contour.first_line, contour.last_line);
    }
}

fn line(out: &mut String, text: &str, comment: &str) {
    // A comment of TOML ends with its line and holds no control characters.
    let comment: String = comment.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
    let _ = if comment.is_empty() {
        writeln!(out, "{}", text.trim_end())
    } else {
        writeln!(out, "{text:<width$}# {comment}", width = COMMENT.max(text.len() + 1))
    };
}

/// The keys of a list alone, in the unit of the program, so that what is wrong with one is said in it.
pub(super) fn bare(entries: &[Entry], unit: Unit) -> String {
    let mut out = String::new();
    for table in TABLES {
        let inside: Vec<&Entry> = entries.iter().filter(|entry| entry.place().0 == table).collect();
        if !table.is_empty() && !inside.is_empty() {
            let _ = writeln!(out, "[{table}]");
        }
        for entry in inside {
            if !matches!(entry.origin, Origin::Left | Origin::Open) {
                let (key, value) = entry.in_unit(unit);
                let _ = writeln!(out, "{key} = {value}");
            }
        }
    }
    out
}

/// A text with one more key in a table, which is made where it is missing.
pub(super) fn with_key(text: &str, table: &str, key: &str) -> String {
    let head = format!("[{table}]\n");
    match text.find(&head) {
        Some(at) => format!("{}{key}\n{}", &text[..at + head.len()], &text[at + head.len()..]),
        None => format!("{text}{head}{key}\n"),
    }
}
