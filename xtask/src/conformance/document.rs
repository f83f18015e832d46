//! docs/conformance.md: counts, goals, exclusions, and every program that is not the same.

use std::fmt::Write;

use super::corpus::Origin;
use super::rule::Rule;
use super::verdict::{Class, Verdict};

/// Share of the accepted programs that must be identical, percent.
const LEAST_SAME: f64 = 98.0;

/// A goal and how it stands.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Goal {
    /// What is asked.
    pub name: &'static str,
    /// The numbers.
    pub stands: String,
    /// Whether it is reached.
    pub reached: bool,
}

/// The goals, with how they stand.
pub fn goals(verdicts: &[Verdict]) -> Vec<Goal> {
    let counted = |v: &&Verdict| v.rule.is_none();
    let accepted: Vec<&Verdict> = verdicts.iter().filter(counted).filter(|v| v.they_accept()).collect();
    let same = accepted.iter().filter(|v| v.is_same()).count();
    let share = 100.0 * same as f64 / accepted.len().max(1) as f64;
    let refused: Vec<&Verdict> = verdicts.iter().filter(|v| v.origin == Origin::Reject).collect();
    let right = refused.iter().filter(|v| v.class == Class::BothSameLine).count();
    // What is refused even when mended lacks more than that.
    let lacking: Vec<&Verdict> = verdicts
        .iter()
        .filter(counted)
        .filter(|v| v.lack.is_some() && v.origin != Origin::Reject && v.mended.is_some())
        .collect();
    let warned = lacking.iter().filter(|v| v.class == Class::OnlyWe && v.warned).count();
    let moved = lacking.iter().filter(|v| v.mended == Some(true)).count();
    let died = verdicts.iter().filter(|v| v.class == Class::WeCrash).count();
    vec![
        Goal {
            name: "of the programs the reference accepts, at least 98 % have identical motion",
            stands: format!("{same} of {} ({share:.1} %)", accepted.len()),
            reached: share >= LEAST_SAME,
        },
        Goal {
            name: "of the programs it must refuse, all are refused at its line",
            stands: format!("{right} of {}", refused.len()),
            reached: right == refused.len(),
        },
        Goal {
            name: "of those it refuses only for a missing end, a missing F or an unknown M, all are accepted with a warning",
            stands: format!("{warned} of {}", lacking.len()),
            reached: warned == lacking.len(),
        },
        Goal {
            name: "of the same, with that mended for both, at least 98 % have identical motion",
            stands: format!("{moved} of {}", lacking.len()),
            reached: moved as f64 >= LEAST_SAME / 100.0 * lacking.len() as f64,
        },
        Goal { name: "none kills ours or keeps it from ending", stands: format!("{died} do"), reached: died == 0 },
    ]
}

/// The part that is compared with the committed document.
pub fn counts(verdicts: &[Verdict]) -> String {
    let mut out = String::from("| |");
    for origin in Origin::ALL {
        let _ = write!(out, " {} |", origin.name());
    }
    out += "\n|---|";
    out += &"--:|".repeat(Origin::ALL.len());
    out.push('\n');
    let mut row = |name: &str, holds: &dyn Fn(&Verdict) -> bool| {
        let numbers = Origin::ALL.map(|o| verdicts.iter().filter(|v| v.origin == o && holds(v)).count());
        if numbers.iter().any(|n| *n > 0) {
            let _ = writeln!(out, "| {name} | {} |", numbers.map(|n| n.to_string()).join(" | "));
        }
    };
    row("programs", &|_| true);
    for class in Class::ALL {
        row(class.name(), &|v| v.class == class && v.rule.is_none());
    }
    row("excluded by rule", &|v| v.rule.is_some());
    out
}

/// The whole document.
pub fn document(verdicts: &[Verdict], version: &str) -> String {
    let mut out = format!(
        "# Conformance\n\nWritten by `cargo xtask conformance --write`; the command without `--write` fails when a goal is \
         missed or the counts have changed.\n\nThe reference is `rs274 -g` of LinuxCNC {version}. It and `truepath canon` run \
         on every `.ngc` file its package ships, on a caller for every file that only defines the subroutine it is named \
         after, and on our own programs in `tests/data/conformance/`, with the same tool table and parameters. Numbers agree \
         within one unit of the fourth printed decimal. Motion is every call that places the tool or says what its numbers \
         mean: moves, feed, plane, units, offsets, rotation, dwell.\n\n## Goals\n\n| | | |\n|---|---|---|\n"
    );
    for goal in goals(verdicts) {
        let _ =
            writeln!(out, "| {} | {} | {} |", goal.name, goal.stands, if goal.reached { "reached" } else { "missed" });
    }
    let _ = write!(out, "\n## Counts\n\nWithout what is excluded by rule.\n\n{}", counts(verdicts));
    out += "\n## Excluded by rule\n\n| rule | programs | of these identical | only we accept | both refuse, same line |\n\
            |---|--:|--:|--:|--:|\n";
    for rule in Rule::ALL {
        let under: Vec<&Verdict> = verdicts.iter().filter(|v| v.rule == Some(rule)).collect();
        let count = |class: Class| under.iter().filter(|v| v.class == class).count();
        let same = under.iter().filter(|v| v.is_same()).count();
        let (we, both) = (count(Class::OnlyWe), count(Class::BothSameLine));
        let _ = writeln!(out, "| {} | {} | {same} | {we} | {both} |", rule.name(), under.len());
    }
    out += "\n## Not the same\n\nKnown reasons. Run without a machine, the reference reads its place back after M6: where G43 stands in \
            the same block the place keeps its old name, and after a G40 without a move the path of the cutter's centre counts \
            as programmed. It does not find the tool that M61 names. A move that waits for its corner is told in the unit that \
            comes after it.\n\n";
    for class in [Class::Differs, Class::OnlyThey, Class::OnlyWe, Class::BothOtherLine, Class::WeCrash] {
        let here: Vec<&Verdict> = verdicts.iter().filter(|v| v.class == class).collect();
        if here.is_empty() {
            continue;
        }
        let _ = writeln!(out, "### {}\n\n| program | reason |\n|---|---|", class.name());
        for v in here {
            let why = v.lack.map(|l| l.name()).or_else(|| v.rule.map(Rule::name));
            let why = why.map_or(String::new(), |w| format!("{w}. "));
            let _ = writeln!(out, "| {} | {why}{} |", v.name, cell(&v.detail));
        }
        out.push('\n');
    }
    out.truncate(out.trim_end().len());
    out + "\n"
}

fn cell(text: &str) -> String {
    text.replace('|', "\\|").replace('<', "&lt;").replace(['\n', '\r'], " ")
}
