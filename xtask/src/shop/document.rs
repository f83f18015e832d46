//! What became of the programs: for the terminal, and docs/shop.md.

use std::collections::BTreeMap;
use std::fmt::Write;

use super::table::Program;
use super::way::{End, Run, Way};

/// What the table judges.
const JUDGED: &str = "Judged is the wall all round, the mean over ten heights, but for 6 mm (or two fifths of the cutter's diameter) at \
    the ends of an open contour and 1 mm beside a corner: on a corner there is no one normal to measure along, and a ball \
    cannot touch the wall of an inside corner before the cutter's own rounding has ended. A corner in which a contour begins and ends is such \
    a corner, no less and no more. Where a contour comes back to its start at a corner, or runs over it, the virtual machine \
    remembers what it cut there: the load falls over the last millimetres, as it does in life. A contour that runs on into itself \
    without a corner or overlap is cut as if it had no beginning, and so it is corrected; on a machine that remembered it, the full correction would meet a \
    load that falls to nothing over the last 3 to 8 mm, and up to the size of the correction (0.002 to 0.037 mm in this table) would be cut too \
    deep there; where a program's lap overlaps its start, the fall of the load is known. What the plunge into a corner leaves, the cutter standing there \
    without load, is not milled.";

type Results<'a> = [(&'a Program, &'a Way)];

/// A line for every program.
pub fn table(results: &Results) -> String {
    let mut out = format!(
        "{:<44}{:<22}{:<22}{:>10}{:>9}{:>7}\n",
        "program", "bare job", "lines named", "before mm", "after mm", "s"
    );
    for (program, way) in results {
        let named = way.named.as_ref().map(|run| run.end.word()).unwrap_or_default();
        let [before, after] = numbers(way);
        let _ = writeln!(
            out,
            "{:<44}{:<22}{named:<22}{before:>10}{after:>9}{:>7.1}",
            program.file,
            way.bare.end.word(),
            way.bare.seconds
        );
    }
    out + &counts(results)
}

fn numbers(way: &Way) -> [String; 2] {
    let run = [Some(&way.bare), way.named.as_ref()].into_iter().flatten().find(|run| run.errors_mm.is_some());
    let errors = run.and_then(|run| run.errors_mm);
    errors.map(|errors| errors.map(|error| format!("{error:.4}"))).unwrap_or_default()
}

/// How many go through.
fn counts(results: &Results) -> String {
    let bare = results.iter().filter(|(_, way)| way.bare.end == End::Through).count();
    let other = results.iter().filter(|(_, way)| matches!(way.bare.end, End::OtherContour(_))).count();
    let named = results.iter().filter(|(_, way)| way.named.as_ref().is_some_and(|r| r.end == End::Through)).count();
    format!(
        "\nof {} programs {bare} go through with a bare job, {other} more with another contour than the wall, {named} more \
         with the lines named\n",
        results.len()
    )
}

/// Every way to end that is not through, with how many programs and what was said of the shortest of them.
pub fn refusals(results: &Results) -> String {
    let mut by: BTreeMap<String, Vec<(&Program, &Run)>> = BTreeMap::new();
    for (program, way) in results.iter().filter(|(_, way)| way.bare.end != End::Through) {
        by.entry(way.bare.end.word()).or_default().push((program, &way.bare));
    }
    let mut sorted: Vec<_> = by.into_iter().collect();
    sorted.sort_by_key(|(_, list)| std::cmp::Reverse(list.len()));
    let mut out = String::new();
    for (word, list) in sorted {
        let _ = writeln!(out, "{:>3}  {word}", list.len());
        for (program, run) in list {
            let line = run.line.as_ref().map_or(String::new(), |(n, text)| format!(" line {n} `{text}`"));
            let _ = writeln!(out, "       {}:{line} {}", program.file, run.said);
        }
    }
    out
}

/// docs/shop.md.
pub fn document(results: &Results) -> String {
    let mut out = format!(
        "# Programs as shops write them\n\nWritten by `cargo xtask shop --write`; the command without `--write` fails when a \
         program ends worse than the table in `tests/data/shop/programs.csv` expects, when a wall becomes worse, when a probing \
         program drives into the wall, and when a command has a fault.\n\nThe programs are our own, in the manner of the posts \
         and hands named. Each goes the whole way with a job that says cutter, wall side (where no G41 says it), allowance, and \
         what the format of a job asks for besides: `truepath probe`, touches by `truepath simulate --touch` on a virtual machine \
         that shares no physics with the model and knows the wall from the table, `truepath correct`, and `truepath simulate \
         --from`. *Lines named*: the same with the lines of the wall in `[[feature]]`, where the bare job did not go through.\n\n\
         {JUDGED}\n\n\
         {}\n| program | in the manner of | bare job | lines named | before mm | after mm |\n\
         |---|---|---|---|--:|--:|\n",
        counts(results)
    );
    for (program, way) in results {
        let named = way.named.as_ref().map(|run| run.end.word()).unwrap_or_default();
        let [before, after] = numbers(way);
        let _ = writeln!(
            out,
            "| {} | {} | {} | {named} | {before} | {after} |",
            program.file,
            program.manner,
            way.bare.end.word()
        );
    }
    out += "\n## What does not go through with a bare job\n\n| end | program | line | what was said |\n|---|---|---|---|\n";
    for (program, way) in results.iter().filter(|(_, way)| way.bare.end != End::Through) {
        let cell = |text: &str| text.replace('|', "\\|").replace(['\n', '\r'], " ");
        let line = way.bare.line.as_ref().map_or(String::new(), |(n, text)| format!("{n}: `{}`", cell(text)));
        let _ = writeln!(out, "| {} | {} | {line} | {} |", way.bare.end.word(), program.file, cell(&way.bare.said));
    }
    out
}
