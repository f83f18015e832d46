//! The results of a folder as tables in a Markdown file, between two marks.

use std::fmt::Write;

use truepath_ground::diagnostics::{Failure, Source};

use super::reference::Reached;
use super::summary::{Row, Summary, Trouble, WORKS};
use crate::codes::Y005;

/// Where the results begin.
pub const BEGIN: &str = "<!-- results of truepath study -->";

/// Where they end.
pub const END: &str = "<!-- end of results -->";

/// The text of a file with its results replaced.
///
/// # Errors
/// `Y005` when the file has no marks for them.
pub fn written_into(file: &Source, results: &str) -> Result<String, Failure> {
    let text = String::from_utf8_lossy(file.bytes());
    let marks = text.find(BEGIN).and_then(|begin| Some((begin + BEGIN.len(), text.find(END)?)));
    match marks.filter(|(begin, end)| begin <= end) {
        Some((begin, end)) => Ok(format!("{}\n\n{results}\n{}", &text[..begin], &text[end..])),
        None => {
            let expected = format!("a line `{BEGIN}` and after it a line `{END}`");
            Err(Y005.error("no place for results", expected).in_file(file.name().as_ref()).into())
        }
    }
}

/// The results.
pub fn results(summary: &Summary, reached: &[Reached]) -> String {
    let mut text = String::new();
    // Writing to a string cannot fail.
    for set in &summary.sets {
        let _ = writeln!(text, "### {} seeds, {} cases\n", set.set.name(), set.all.cases);
        text += &table("family", set.families.iter().chain([&set.all]));
        for (title, rows) in &set.groups {
            text += &table(&title.to_lowercase(), rows.iter());
        }
    }
    for axis in &summary.axes {
        let _ = writeln!(text, "### Against {}\n", axis.axis);
        text += &table(axis.axis, axis.cells.iter().map(|(_, row)| row));
    }
    if !reached.is_empty() {
        text += "### Reference goals: the papers' corner, 2 µm of noise\n\n| what is wrong in the job | places, mm | seeds | before | median | goal | P90 | goal | refused |\n|---|---|---:|---:|---:|---:|---:|---:|---:|\n";
    }
    for one in reached {
        let mm = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |v| format!("{v:.4}"));
        let places: Vec<String> = one.places_mm.iter().map(ToString::to_string).collect();
        let [median, goal, p90, goal90] = [one.median_mm, one.goal_median_mm, one.p90_mm, one.goal_p90_mm].map(mm);
        let (title, seeds, before, refused) = (&one.title, one.seeds, one.before_mm, one.failures);
        let places = places.join(", ");
        let _ = writeln!(
            text,
            "| {title} | {places} | {seeds} | {before:.4} | {median} | {goal} | {p90} | {goal90} | {refused} |"
        );
    }
    let _ = writeln!(text, "\n### Where it stops working\n");
    text += &listed(summary.limits.iter().map(|s| s.to_owned()));
    let weak = format!("First correction below {WORKS}");
    for (title, cases) in
        [("Failures", &summary.failures), ("Worse than before", &summary.worse), (&weak, &summary.weak)]
    {
        let _ = writeln!(text, "\n{title}: {}.\n", cases.len());
        let one = |t: &Trouble| format!("`{}`: {}", t.case, t.what.replace('\n', " "));
        text += &listed(cases.iter().map(one));
    }
    text
}

fn listed(sentences: impl Iterator<Item = String>) -> String {
    sentences.map(|s| format!("* {s}\n")).collect()
}

fn table<'a>(first: &str, rows: impl Iterator<Item = &'a Row>) -> String {
    let mut text = format!(
        "| {first} | cases | median | P10 | worst | in 2σ | learned: median | P10 | worst | in 2σ | refused | worse |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |v| format!("{v:.1}"));
    for row in rows {
        let _ = write!(text, "| {} | {} |", row.name, row.cases);
        for (spread, coverage) in [(row.first, row.coverage), (row.learned, row.learned_coverage)] {
            for value in [spread.map(|s| s.median), spread.map(|s| s.p10), spread.map(|s| s.worst)] {
                let _ = write!(text, " {} |", number(value));
            }
            let percent = coverage.map_or_else(|| "–".to_owned(), |c| format!("{:.1} %", 100.0 * c));
            let _ = write!(text, " {percent} |");
        }
        let _ = writeln!(text, " {} | {} |", row.failures + row.learn_failures, row.worse);
    }
    text + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_replace_what_lay_between_the_marks() {
        let file = |text: &str| Source::new("study.md", text.as_bytes().to_vec());
        let text = written_into(&file(&format!("a\n{BEGIN}\nold\n{END}\nb\n")), "new\n").expect("marks");
        assert_eq!(text, format!("a\n{BEGIN}\n\nnew\n\n{END}\nb\n"));
        assert_eq!(written_into(&file(&text), "new\n").expect("marks"), text);
        assert!(written_into(&file("a"), "new").is_err());
    }
}
