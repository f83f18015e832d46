//! The results of a folder as tables in a Markdown file, between two marks.

use std::fmt::Write;

use truepath_ground::diagnostics::{Failure, Source};

use super::reference::Reached;
use super::summary::{Row, Summary, Trouble, WORKS, WholeWall};
use crate::codes::Y005;

/// Where results begin and end.
pub type Marks = (&'static str, &'static str);

/// Of the families and grids.
pub const RESULTS: Marks = ("<!-- results of truepath study -->", "<!-- end of results -->");

/// Of the nuisances.
pub const NUISANCES: Marks = ("<!-- nuisances of truepath study -->", "<!-- end of nuisances -->");

/// Of a shop.
pub const SHOP: Marks = ("<!-- shop of truepath study -->", "<!-- end of shop -->");

/// The text of a file with what lies between two marks replaced.
///
/// # Errors
/// `Y005` when the file does not have them.
pub fn written_into(file: &Source, (from, to): Marks, results: &str) -> Result<String, Failure> {
    let text = String::from_utf8_lossy(file.bytes());
    let marks = text.find(from).and_then(|begin| Some((begin + from.len(), text.find(to)?)));
    match marks.filter(|(begin, end)| begin <= end) {
        Some((begin, end)) => Ok(format!("{}\n\n{results}\n{}", &text[..begin], &text[end..])),
        None => {
            let expected = format!("a line `{from}` and after it a line `{to}`");
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
        text += &whole_walls("family", set.families.iter().chain([&set.all]));
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

/// The results with nuisances.
pub fn nuisances(summary: &Summary) -> String {
    let mut text = String::new();
    for one in &summary.nuisances {
        let seeds = one.set.name();
        // Writing to a string cannot fail.
        let _ = writeln!(text, "### {seeds} seeds, touched {}\n", one.touches.words());
        text += &table("nuisance", one.rows.iter());
        text += &limits(&one.rows);
        text += &whole_walls("nuisance", one.rows.iter());
    }
    text
}

/// What exact knowledge of the part before would have reached.
fn limits(rows: &[Row]) -> String {
    let mut text = "What exact knowledge of the part before would have reached, and the median share of it that was.\n\n\
        | nuisance | first: median | P10 | reached | learned: median | P10 | reached |\n|---|---:|---:|---:|---:|---:|---:|\n"
        .to_owned();
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |v| format!("{v:.1}"));
    let percent = |share: Option<f64>| share.map_or_else(|| "–".to_owned(), |c| format!("{:.0} %", 100.0 * c));
    for row in rows {
        let of = &row.limits;
        let each = [(of.first, of.first_reached), (of.learned, of.learned_reached)].map(|(limit, reached)| {
            let [median, p10] = [limit.map(|l| l.median), limit.map(|l| l.p10)].map(number);
            format!("{median} | {p10} | {}", percent(reached))
        });
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| {} | {} |", row.name, each.join(" | "));
    }
    text + "\n"
}

fn listed(sentences: impl Iterator<Item = String>) -> String {
    sentences.map(|s| format!("* {s}\n")).collect()
}

fn table<'a>(first: &str, rows: impl Iterator<Item = &'a Row>) -> String {
    let mut text = format!(
        "| {first} | cases | median | P10 | worst | in 2σ | any height | in 2σ | learned: median | P10 | worst | in 2σ | any height | in 2σ | refused | worse |\n\
         |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n"
    );
    let number = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), |v| format!("{v:.1}"));
    let percent = |share: Option<f64>| share.map_or_else(|| "–".to_owned(), |c| format!("{:.1} %", 100.0 * c));
    for row in rows {
        let _ = write!(text, "| {} | {} |", row.name, row.cases);
        for (spread, coverage, any, held) in [
            (row.first, row.coverage, row.any_height, row.any_height_held),
            (row.learned, row.learned_coverage, row.learned_any_height, row.learned_any_height_held),
        ] {
            for value in [spread.map(|s| s.median), spread.map(|s| s.p10), spread.map(|s| s.worst)] {
                let _ = write!(text, " {} |", number(value));
            }
            let any = number(any.map(|s| s.median));
            let _ = write!(text, " {} | {any} | {} |", percent(coverage), percent(held));
        }
        let _ = writeln!(text, " {} | {} |", row.failures + row.learn_failures, row.worse);
    }
    text + "\n"
}

/// What is left at any height, and what makes it.
fn whole_walls<'a>(first: &str, rows: impl Iterator<Item = &'a Row>) -> String {
    let columns = WholeWall::COLUMNS;
    let mut text = "The whole wall, at any height: medians, µm.\n\n".to_owned();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "| {first} | {} |\n|---|{}", columns.join(" | "), "---:|".repeat(columns.len()));
    for row in rows {
        let _ = writeln!(text, "| {} | {} |", row.name, row.whole_wall.cells().join(" | "));
    }
    text + "\n"
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn results_replace_what_lay_between_the_marks() {
        let file = |text: &str| Source::new("study.md", text.as_bytes().to_vec());
        for (begin, end) in [RESULTS, NUISANCES, SHOP] {
            let old = file(&format!("a\n{begin}\nold\n{end}\nb\n"));
            let text = written_into(&old, (begin, end), "new\n").expect("marks");
            assert_eq!(text, format!("a\n{begin}\n\nnew\n\n{end}\nb\n"));
            assert_eq!(written_into(&file(&text), (begin, end), "new\n").expect("marks"), text);
        }
        assert!(written_into(&file(&format!("{}\n{}", RESULTS.0, RESULTS.1)), NUISANCES, "new").is_err());
    }
}
