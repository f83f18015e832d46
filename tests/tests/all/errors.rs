//! docs/errors.md: every error code, what it means and what to do.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::Path;

use truepath_ground::codes::Row;

/// The rooms of the host with their rows, in the order of the document; those of the core follow.
const CATALOGUES: [(&str, &[Row]); 17] = [
    ("Files, tables and the command line", truepath_ground::codes::CATALOGUE),
    ("The job and its features", truepath_job::codes::CATALOGUE),
    ("Programs and machine tables", truepath_program::codes::CATALOGUE),
    ("Corrections, learning and verification programs", truepath_correction::codes::CATALOGUE),
    ("The virtual machine and recorded setpoints", truepath_trial::codes::CATALOGUE),
    ("Pictures", truepath_chart::codes::CATALOGUE),
    ("Tables that are drawn", truepath_report::codes::CATALOGUE),
    ("Batches of parts", truepath_batch::codes::CATALOGUE),
    ("Bench and board", truepath_bench::codes::CATALOGUE),
    ("Stories of parts", truepath_story::codes::CATALOGUE),
    ("The shop store", truepath_store::codes::CATALOGUE),
    ("Publishing", truepath_publish::codes::CATALOGUE),
    ("Studies", truepath_study::codes::CATALOGUE),
    ("Bores", truepath_bore::codes::CATALOGUE),
    ("Measured forces", truepath_forces::codes::CATALOGUE),
    ("Five-axis programs", truepath_multiaxis::codes::CATALOGUE),
    ("Pockets", truepath_pocket::codes::CATALOGUE),
];

/// The core's rows by the letter of their codes.
const OF_THE_CORE: [(&str, char); 6] = [
    ("Reading a program", 'G'),
    ("Reading a measurement", 'M'),
    ("Warnings, and full buffers of a device", 'W'),
    ("A job on the device", 'J'),
    ("Correction images", 'I'),
    ("The setpoint link", 'K'),
];

/// Text in a cell of a table.
fn cell(text: &str) -> String {
    text.replace('|', "\\|")
}

/// The document.
fn document() -> String {
    let mut text = "# Error codes\n\nEvery error has a code that stays. Beside it a message names the place, what was \
                    found there and what was expected, and often knows a better remedy than the general one below. \
                    Written by `cargo xtask errors --write` from the rows in the sources.\n"
        .to_owned();
    for (title, rows) in CATALOGUES {
        let _ = write!(text, "\n## {title}\n\n| code | meaning | what to do |\n|---|---|---|\n");
        for Row { code, says, remedy, .. } in rows {
            let _ = writeln!(text, "| {code} | {} | {} |", cell(says), cell(remedy));
        }
    }
    text += "\nThe core says with the error itself what to do; names in braces stand for what it found.\n";
    for (title, letter) in OF_THE_CORE {
        let _ = write!(text, "\n## {title}\n\n| code | what is said | what to do |\n|---|---|---|\n");
        let mut rows: Vec<_> = truepath_core::errors::CATALOGUE.into_iter().flatten().collect();
        rows.retain(|row| row.code.starts_with(letter));
        rows.sort_by_key(|row| row.code);
        for row in rows {
            // A sentence without help of its own ends in what to do.
            let parted = |says: &'static str| says.rsplit_once("; ").unwrap_or((says, ""));
            let parts = row.says.iter().map(|says| if row.help.is_empty() { parted(says) } else { (*says, row.help) });
            let (says, mut help): (Vec<_>, Vec<_>) = parts.map(|(says, help)| (cell(says), cell(help))).unzip();
            help.dedup();
            let _ = writeln!(text, "| {} | {} | {} |", row.code, says.join("<br>"), help.join("<br>"));
        }
    }
    text
}

#[test]
fn a_code_is_a_letter_and_three_digits_and_means_one_thing() {
    let mut known = BTreeMap::new();
    for (title, row) in CATALOGUES.iter().flat_map(|(title, rows)| rows.iter().map(move |row| (title, row))) {
        let (letter, digits) = row.code.split_at(1);
        assert!(letter.bytes().all(|b| b.is_ascii_uppercase()) && digits.len() == 3, "{}", row.code);
        assert!(digits.bytes().all(|b| b.is_ascii_digit()), "{}", row.code);
        assert!(!row.says.is_empty() && !row.remedy.is_empty(), "{}", row.code);
        assert_eq!(known.insert(row.code, title), None, "{} stands twice", row.code);
    }
    // Of one meaning inside the core: its own test.
    for row in truepath_core::errors::CATALOGUE.into_iter().flatten() {
        assert!(!known.contains_key(row.code), "{} is the host's, too", row.code);
        assert!(OF_THE_CORE.iter().any(|(_, letter)| row.code.starts_with(*letter)), "{} has no section", row.code);
    }
}

/// `cargo xtask errors --write` renews it.
#[test]
fn the_document_is_that_of_the_rows() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../docs/errors.md");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(&path, document()).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(kept == document(), "docs/errors.md is not that of the rows; cargo xtask errors --write renews it");
}
