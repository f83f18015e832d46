//! `study.html`: the results of a folder on one page that needs nothing else.

use std::fmt::Write;

use truepath_ground::diagnostics::Failure;

use super::families::family;
use super::id::{Axis, CaseId};
use super::outcome::Outcome;
use super::plots::{Group, along, by_group};
use super::seeds::Set;
use super::summary::{Row, SetSummary, Summary, Trouble, WORKS, WholeWall};

const STYLE: &str = "body{font:15px/1.5 system-ui,sans-serif;max-width:72rem;margin:2rem auto;padding:0 1rem;color:#222}\
table{border-collapse:collapse;margin:1rem 0;font-size:14px}th,td{padding:.2rem .6rem;border-bottom:1px solid #ddd;\
text-align:right;vertical-align:top}th:first-child,td:first-child,td.text{text-align:left}thead th{border-bottom:2px solid \
#888}tr.all{font-weight:600}td.bad{background:#fbe3d6}code{font-size:13px}svg{max-width:100%;height:auto}\
.first{color:#d55e00}.learned{color:#0072b2}";

/// Most cases listed of a kind; the table has all of them.
const LISTED: usize = 60;

/// Makes the page.
///
/// # Errors
/// Internal, when a picture cannot be drawn.
pub fn page(summary: &Summary, outcomes: &[Outcome]) -> Result<String, Failure> {
    let mut text = format!(
        "<!doctype html>\n<html lang=\"en\"><meta charset=\"utf-8\"><title>Truepath study</title><style>{STYLE}</style>\n\
         <h1>Truepath study</h1>\n<p>Virtual machines with effects the model does not have mill a first part; it is \
         touched in a few places, the program is corrected, and the next part is milled and judged. Factor = largest wall \
         error before / after, mean over ten heights; any height: the same of the largest error at any of the heights, and the \
         share of parts in which that came out within 2σ of what had been predicted. <span class=\"first\">First correction</span>, <span \
         class=\"learned\">after one more part was touched and learned from</span>. Made by {}; {} cases.</p>\n",
        escaped(&summary.program),
        outcomes.len()
    );
    for set in &summary.sets {
        text += &section(set, outcomes)?;
    }
    for axis in &summary.axes {
        let Some(which) = Axis::ALL.into_iter().find(|a| a.name() == axis.axis) else { continue };
        let _ = write!(text, "<h2>Factor against {}</h2>\n{}", axis.axis, grid(which, outcomes)?);
        text += &table(which.title(), axis.cells.iter().map(|(_, row)| row));
    }
    for one in &summary.nuisances {
        let _ = writeln!(text, "<h2>With nuisances, {} seeds, touched {}</h2>", one.set.name(), one.touches.words());
        text += &table("Nuisance", one.rows.iter());
    }
    text += "<h2>Where it stops working</h2>\n";
    let _ = writeln!(
        text,
        "<p>From the results above: where the median factor of the first correction is below {WORKS}, parts came out worse, \
         or corrections were refused.</p>"
    );
    text += &list(&summary.limits);
    text += &troubles("Failures", &summary.failures);
    text += &troubles("Worse than before", &summary.worse);
    text += &troubles(&format!("First correction below {WORKS}"), &summary.weak);
    text += "<p><code>truepath study --case ID</code> reruns one; <code>--export DIR</code> writes its job, program, machine \
             and probe file.</p>\n</html>\n";
    Ok(text)
}

fn section(set: &SetSummary, outcomes: &[Outcome]) -> Result<String, Failure> {
    let title = match set.set {
        Set::Tuning => "Seeds for tuning",
        Set::Test => "Seeds for judging",
        Set::Random => "Random machines",
    };
    let groups: Vec<Group> = set
        .families
        .iter()
        .map(|row| group(&row.name, outcomes, |id| id.set() == set.set && id.is_plain() && id.family == row.name))
        .collect();
    let mut text = format!("<h2>{title}</h2>\n{}", by_group(&groups)?);
    text += &table("Family", set.families.iter().chain([&set.all]));
    text += &whole_walls(set.families.iter().chain([&set.all]));
    for (title, rows) in &set.groups {
        text += &table(title, rows.iter());
    }
    Ok(text)
}

fn group(name: &str, outcomes: &[Outcome], is_in: impl Fn(&CaseId) -> bool) -> Group {
    let these: Vec<&Outcome> = outcomes.iter().filter(|o| o.id().is_some_and(|id| is_in(&id))).collect();
    Group {
        name: name.to_owned(),
        first: these.iter().filter_map(|o| o.factor).collect(),
        learned: these.iter().filter_map(|o| o.learned_factor).collect(),
    }
}

fn grid(axis: Axis, outcomes: &[Outcome]) -> Result<String, Failure> {
    let at = |value: f64| move |id: &CaseId| id.cell.is_some_and(|c| c.axis == axis && (c.value - value).abs() < 1e-9);
    let cells: Vec<(f64, Group)> = axis.values().iter().map(|&value| (value, group("", outcomes, at(value)))).collect();
    along(axis.title(), &cells)
}

fn table<'a>(first: &str, rows: impl Iterator<Item = &'a Row>) -> String {
    let mut text = format!(
        "<table><thead><tr><th>{first}<th>cases<th>before, mm<th>median<th>P10<th>worst<th>within 2σ\
         <th>any height<th>within 2σ<th>learned<th>P10<th>worst<th>within 2σ<th>any height<th>within 2σ<th>refused<th>worse<th>time, s</tr></thead>\n"
    );
    for row in rows {
        let number = |value: Option<f64>, digits: usize| value.map_or_else(|| "–".into(), |v| format!("{v:.digits$}"));
        let percent = |value: Option<f64>| value.map_or_else(|| "–".into(), |v| format!("{:.1} %", 100.0 * v));
        let count = |n: usize| if n == 0 { "<td>0".to_owned() } else { format!("<td class=\"bad\">{n}") };
        let weak = |value: Option<f64>| if value.is_some_and(|v| v < WORKS) { "<td class=\"bad\">" } else { "<td>" };
        let class = if row.name == "all" { " class=\"all\"" } else { "" };
        let hint = family(&row.name).map_or("", |f| f.title);
        let (f, l) = (row.first, row.learned);
        let _ = write!(text, "<tr{class}><td title=\"{}\">{}<td>{}", escaped(hint), escaped(&row.name), row.cases);
        let _ = write!(text, "<td>{}", number(row.before_mm, 3));
        for (spread, coverage, any, held) in [
            (f, row.coverage, row.any_height, row.any_height_held),
            (l, row.learned_coverage, row.learned_any_height, row.learned_any_height_held),
        ] {
            let values = [spread.map(|s| s.median), spread.map(|s| s.p10), spread.map(|s| s.worst)];
            for value in values {
                let _ = write!(text, "{}{}", weak(value), number(value, 1));
            }
            let any = number(any.map(|s| s.median), 1);
            let _ = write!(text, "<td>{}<td>{any}<td>{}", percent(coverage), percent(held));
        }
        let refused = row.failures + row.learn_failures;
        let _ = writeln!(text, "{}{}<td>{}</tr>", count(refused), count(row.worse), number(row.correct_s, 2));
    }
    text + "</table>\n"
}

/// What is left at any height, and what makes it.
fn whole_walls<'a>(rows: impl Iterator<Item = &'a Row>) -> String {
    let heads: String = WholeWall::COLUMNS.iter().map(|head| format!("<th>{head}")).collect();
    let mut text = format!(
        "<p>The whole wall, at any height: medians, µm.</p>\n<table><thead><tr><th>Family{heads}</tr></thead>\n"
    );
    for row in rows {
        let class = if row.name == "all" { " class=\"all\"" } else { "" };
        let cells: String = row.whole_wall.cells().iter().map(|cell| format!("<td>{cell}")).collect();
        let _ = writeln!(text, "<tr{class}><td>{}{cells}</tr>", escaped(&row.name));
    }
    text + "</table>\n"
}

fn list(sentences: &[String]) -> String {
    if sentences.is_empty() {
        return "<p>Nowhere in these results.</p>\n".to_owned();
    }
    let items: String = sentences.iter().map(|s| format!("<li>{}\n", escaped(s))).collect();
    format!("<ul>{items}</ul>\n")
}

fn troubles(title: &str, cases: &[Trouble]) -> String {
    let mut text = format!("<h3>{} ({})</h3>\n", escaped(title), cases.len());
    if cases.is_empty() {
        return text + "<p>None.</p>\n";
    }
    text += "<table>\n";
    for one in cases.iter().take(LISTED) {
        let _ =
            writeln!(text, "<tr><td><code>{}</code><td class=\"text\">{}</tr>", escaped(&one.case), escaped(&one.what));
    }
    text += "</table>\n";
    if cases.len() > LISTED {
        let _ = writeln!(text, "<p>and {} more in cases.csv.</p>", cases.len() - LISTED);
    }
    text
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}
