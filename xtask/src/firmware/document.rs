//! Tables of docs/firmware.md that commands write and check.
//!
//! Sizes and instruction counts follow from source and compiler. The version of the compiler stands in the line above a
//! table; with the same version the numbers have to agree to half a percent (paths of the build are in an image), with
//! another one a difference is reported and no more, because compilers come and go with the machine.

use crate::repository::root;
use crate::step::Failure;
use crate::table;

const DOCUMENT: &str = "docs/firmware.md";
/// Part of a number by which it may differ.
const TOLERANCE: u64 = 200;

/// Writes a table with a head and rows under its name, or compares it with what stands there. Rows that the document
/// has and `rows` has not are left out of the comparison: one board may be built alone.
///
/// # Errors
/// With the same compiler: the rows that differ. Else only when the document cannot be read or written.
pub fn settle(name: &str, head: &[&str], rows: &[Vec<String>], compiler: &str, write: bool) -> Result<(), Failure> {
    let document = root().join(DOCUMENT);
    let text = std::fs::read_to_string(&document).map_err(|e| Failure::found(format!("{DOCUMENT}: {e}")))?;
    let old = between(&text, name).ok_or_else(|| Failure::found(format!("{DOCUMENT}: no markers for {name}")))?;
    if write {
        return table::replace(&document, name, &written(head, rows, compiler, old));
    }
    let changed: Vec<String> =
        rows.iter().map(|row| line(row)).filter(|row| !old.lines().any(|old| agree(old, row))).collect();
    if changed.is_empty() {
        return Ok(());
    }
    let said = format!("{DOCUMENT}, {name}: not as measured, `--write` renews it\n{}", changed.concat());
    if old.contains(&said_compiler(compiler)) {
        return Err(Failure::found(said));
    }
    eprintln!("    another compiler than the document's: {said}");
    Ok(())
}

/// The table; rows of the old one that are not renewed are kept, in their order, when they are of the same compiler.
fn written(head: &[&str], rows: &[Vec<String>], compiler: &str, old: &str) -> String {
    let same = old.contains(&said_compiler(compiler));
    let key = |line: &str| line.split('|').nth(1).map(|cell| cell.trim().to_owned()).unwrap_or_default();
    let mut lines: Vec<String> = if same {
        old.lines().skip_while(|l| !l.starts_with("|---")).skip(1).map(|l| format!("{l}\n")).collect()
    } else {
        Vec::new()
    };
    let new: Vec<String> = rows.iter().map(|row| line(row)).collect();
    if lines.iter().all(|old| new.iter().any(|new| key(new) == key(old))) {
        lines = new;
    } else {
        for new in new {
            match lines.iter_mut().find(|old| key(old) == key(&new)) {
                Some(place) => *place = new,
                None => lines.push(new),
            }
        }
    }
    let rule: String =
        std::iter::once("|---|".to_owned()).chain(head.iter().skip(1).map(|_| "---:|".to_owned())).collect();
    let head: Vec<String> = head.iter().map(|&h| h.to_owned()).collect();
    format!("{}\n\n{}{rule}\n{}", said_compiler(compiler), line(&head), lines.concat())
}

/// Whether two rows have the same first cell and, behind it, the same numbers within the tolerance.
fn agree(old: &str, new: &str) -> bool {
    let cells = |row: &str| row.trim().split('|').map(|cell| cell.trim().to_owned()).collect::<Vec<_>>();
    let (old, new) = (cells(old), cells(new));
    old.len() == new.len()
        && old.get(1) == new.get(1)
        && old.iter().zip(&new).skip(2).all(|(a, b)| {
            let (a, b) = (numbers(a), numbers(b));
            a.len() == b.len() && a.iter().zip(&b).all(|(a, b)| a.abs_diff(*b) <= *a.max(b) / TOLERANCE)
        })
}

/// The whole numbers of a cell, thousands separated by commas.
fn numbers(cell: &str) -> Vec<u64> {
    let digits = cell.replace(',', "");
    digits.split(|c: char| !c.is_ascii_digit()).filter_map(|n| n.parse().ok()).collect()
}

fn said_compiler(compiler: &str) -> String {
    format!("Compiler: rustc {compiler}.")
}

fn line(cells: &[String]) -> String {
    format!("| {} |\n", cells.join(" | "))
}

fn between<'a>(text: &'a str, name: &str) -> Option<&'a str> {
    let (_, rest) = text.split_once(&format!("<!-- {name} begin -->\n"))?;
    Some(rest.split_once(&format!("<!-- {name} end -->"))?.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(cells: [&str; 2]) -> Vec<String> {
        cells.map(str::to_owned).to_vec()
    }

    #[test]
    fn a_row_is_renewed_and_the_others_of_the_same_compiler_stay() {
        let old = written(&["board", "flash"], &[row(["a", "1"]), row(["b", "2"])], "1.96.0", "");
        let new = written(&["board", "flash"], &[row(["b", "3"])], "1.96.0", &old);
        assert!(new.contains("| a | 1 |\n| b | 3 |\n"), "{new}");
        let other = written(&["board", "flash"], &[row(["b", "3"])], "1.97.0", &old);
        assert!(!other.contains("| a |") && other.contains("rustc 1.97.0"), "{other}");
    }

    #[test]
    fn a_row_agrees_when_its_numbers_do_to_half_a_percent() {
        assert!(agree("| a | 1,000 | 5 … 7 |", "| a | 1,005 | 5 … 7 |\n"));
        assert!(!agree("| a | 1,000 | 5 … 7 |", "| a | 1,006 | 5 … 7 |\n"));
        assert!(!agree("| a | 1,000 | 5 … 7 |", "| a | 1,000 | 5 … 8 |\n"));
        assert!(!agree("| a | 1,000 | 5 … 7 |", "| b | 1,000 | 5 … 7 |\n"));
    }

    #[test]
    fn the_text_between_the_markers_is_found() {
        assert_eq!(between("x\n<!-- s begin -->\nrows\n<!-- s end -->\n", "s"), Some("rows\n"));
        assert_eq!(between("x", "s"), None);
    }
}
