//! Tables in a document, between markers, so that a command can renew them and leave the text alone.

use std::path::Path;

use crate::step::Failure;

/// A table in Markdown with numbers on the right.
pub fn table(head: [&str; 2], rows: impl IntoIterator<Item = (String, String)>) -> String {
    let rows = rows.into_iter().map(|(name, number)| format!("| {name} | {number} |\n"));
    // The second may be several columns.
    let numbers = "---:|".repeat(head[1].split('|').count());
    format!("| {} | {} |\n|---|{numbers}\n{}", head[0], head[1], rows.collect::<String>())
}

/// Puts a text between `<!-- NAME begin -->` and `<!-- NAME end -->` of a document.
///
/// # Errors
/// When the document cannot be read or written, or lacks the markers.
pub fn replace(document: &Path, name: &str, text: &str) -> Result<(), Failure> {
    let said = |e: std::io::Error| Failure::found(format!("{}: {e}", document.display()));
    let old = std::fs::read_to_string(document).map_err(said)?;
    let new = replaced(&old, name, text)
        .ok_or_else(|| Failure::found(format!("{}: no markers for {name}", document.display())))?;
    std::fs::write(document, new).map_err(said)
}

fn replaced(old: &str, name: &str, text: &str) -> Option<String> {
    let (begin, end) = (format!("<!-- {name} begin -->\n"), format!("<!-- {name} end -->"));
    let (before, rest) = old.split_once(&begin)?;
    let (_, after) = rest.split_once(&end)?;
    Some(format!("{before}{begin}{text}{end}{after}"))
}

/// A whole number in groups of three digits.
pub fn thousands(number: u64) -> String {
    let digits = number.to_string();
    let mut out = String::new();
    for (i, digit) in digits.chars().enumerate() {
        if i > 0 && (digits.len() - i).is_multiple_of(3) {
            out.push(',');
        }
        out.push(digit);
    }
    out
}

/// A time in the unit that suits it, three significant digits.
pub fn nanoseconds(ns: f64) -> String {
    let (value, unit) = match ns {
        v if v < 1e3 => (v, "ns"),
        v if v < 1e6 => (v / 1e3, "µs"),
        v if v < 1e9 => (v / 1e6, "ms"),
        v => (v / 1e9, "s"),
    };
    let decimals = if value < 10.0 { 2 } else { usize::from(value < 100.0) };
    format!("{value:.decimals$} {unit}")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_written_for_people() {
        assert_eq!([7, 999, 1000, 1_234_567].map(thousands), ["7", "999", "1,000", "1,234,567"]);
        assert_eq!(
            [7.123, 41.5, 415.2, 4152.0, 9.3e7].map(nanoseconds),
            ["7.12 ns", "41.5 ns", "415 ns", "4.15 µs", "93.0 ms"]
        );
    }

    #[test]
    fn a_table_replaces_what_stood_between_its_markers_and_nothing_else() {
        let old = "a\n<!-- x begin -->\nold\n<!-- x end -->\n<!-- y begin -->\nkept\n<!-- y end -->\n";
        let text = table(["k", "n"], [("e".to_owned(), "1".to_owned())]);
        let new = replaced(old, "x", &text).unwrap();
        assert_eq!(
            new,
            "a\n<!-- x begin -->\n| k | n |\n|---|---:|\n| e | 1 |\n<!-- x end -->\n<!-- y begin -->\nkept\n<!-- y end -->\n"
        );
        assert_eq!(replaced(old, "z", &text), None);
    }
}
