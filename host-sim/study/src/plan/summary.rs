//! What came out of the study of plans.

use std::fmt::Write;

use serde::Serialize;

use super::outcome::PlanOutcome;
use crate::statistics::{Spread, number, percent, quantile};

/// Several cases taken together.
#[derive(Clone, Debug, Serialize)]
pub struct PlanRow {
    /// What they have in common.
    pub name: String,
    /// Number of cases.
    pub cases: usize,
    /// Cases refused, or failed in any other way.
    pub failures: usize,
    /// Profile error of the part as programmed, median, mm.
    pub before_mm: Option<f64>,
    /// Of the planned part.
    pub after_mm: Option<f64>,
    /// Factor of the profile error at every height.
    pub factor: Option<Spread>,
    /// Share of the cases within their tolerance.
    pub within_tolerance: Option<f64>,
    /// Share of those of which a choice was expected to hold it.
    pub within_of_recommended: Option<f64>,
    /// Machining time over that of the program.
    pub time_ratio: Option<Spread>,
    /// Share of the cases whose profile error lies within 2 sigma of the predicted one.
    pub coverage: Option<f64>,
    /// Share of those that are not worse than predicted by more than 2 sigma.
    pub not_worse: Option<f64>,
    /// Standard deviation over predicted profile error, median.
    pub relative_sigma: Option<f64>,
    /// Root mean square of the distances from the predictions, in standard deviations.
    pub rms_sigma: Option<f64>,
    /// Time of a plan, median, s.
    pub plan_s: Option<f64>,
}

/// The summary of a folder.
#[derive(Clone, Debug, Serialize)]
pub struct PlanSummary {
    /// Which program made it.
    pub program: String,
    /// All cases together.
    pub all: PlanRow,
    /// Cases grouped by what may matter.
    pub groups: Vec<PlanRow>,
    /// Cases that failed: name and reason.
    pub failures: Vec<(String, String)>,
}

/// The summary of outcomes.
pub fn summary(program: &str, outcomes: &[PlanOutcome]) -> PlanSummary {
    let mut groups = Vec::new();
    let mut group = |name: &str, of: &dyn Fn(&PlanOutcome) -> bool| {
        let own: Vec<&PlanOutcome> = outcomes.iter().filter(|o| of(o)).collect();
        if !own.is_empty() {
            groups.push(row(name, &own));
        }
    };
    let mut kinds: Vec<&str> = outcomes.iter().map(|o| o.kind.as_str()).filter(|kind| !kind.is_empty()).collect();
    kinds.sort_unstable();
    kinds.dedup();
    for kind in kinds {
        group(kind, &|o| o.kind == kind);
    }
    for law in ["alike", "maxwell"] {
        group(&format!("bending law {law}"), &|o| o.bend_law == law);
    }
    let ratio = |o: &PlanOutcome, low: f64, high: f64| o.contact_ratio.is_some_and(|r| (low..high).contains(&r));
    group("wall up to 0.8 contact ratios", &|o| ratio(o, 0.0, 0.8));
    group("wall of 0.8 to 1.2", &|o| ratio(o, 0.8, 1.2));
    group("wall above 1.2", &|o| ratio(o, 1.2, f64::INFINITY));
    let failed = outcomes.iter().filter(|o| !o.failure.is_empty());
    PlanSummary {
        program: program.to_owned(),
        all: row("all", &outcomes.iter().collect::<Vec<_>>()),
        groups,
        failures: failed.map(|o| (o.case.clone(), o.failure.clone())).collect(),
    }
}

fn row(name: &str, cases: &[&PlanOutcome]) -> PlanRow {
    let all = |of: &dyn Fn(&PlanOutcome) -> Option<f64>| -> Vec<f64> { cases.iter().filter_map(|o| of(o)).collect() };
    let median = |of: &dyn Fn(&PlanOutcome) -> Option<f64>| quantile(&all(of), 0.5);
    let share = |of: &dyn Fn(&PlanOutcome) -> Option<bool>| {
        let known: Vec<bool> = cases.iter().filter_map(|o| of(o)).collect();
        (!known.is_empty()).then(|| known.iter().filter(|yes| **yes).count() as f64 / known.len() as f64)
    };
    let off = all(&PlanOutcome::off_by_sigma);
    PlanRow {
        name: name.to_owned(),
        cases: cases.len(),
        failures: cases.iter().filter(|o| !o.failure.is_empty()).count(),
        before_mm: median(&|o| o.before_mm),
        after_mm: median(&|o| o.after_mm),
        factor: Spread::of(&all(&|o| o.factor)),
        within_tolerance: share(&PlanOutcome::holds),
        within_of_recommended: share(&|o| o.holds().filter(|_| o.recommended == Some(true))),
        time_ratio: Spread::of(&all(&|o| o.time_ratio)),
        coverage: share(&|o| o.off_by_sigma().map(|off| off.abs() <= 2.0)),
        not_worse: share(&|o| o.off_by_sigma().map(|off| off <= 2.0)),
        relative_sigma: median(&|o| Some(o.sigma_mm? / o.predicted_mm?)),
        rms_sigma: (!off.is_empty()).then(|| (off.iter().map(|o| o * o).sum::<f64>() / off.len() as f64).sqrt()),
        plan_s: median(&|o| o.plan_s),
    }
}

/// The rows of the table: all cases first.
fn rows(summary: &PlanSummary) -> impl Iterator<Item = &PlanRow> {
    std::iter::once(&summary.all).chain(&summary.groups)
}

/// The columns of a row: factor median, P10, worst, within, time ratio median and largest, in 2 sigma, sigma over prediction.
fn columns(row: &PlanRow) -> [String; 9] {
    let (factor, time) = (row.factor, row.time_ratio);
    [
        number(factor.map(|f| f.median), 1),
        number(factor.map(|f| f.p10), 1),
        number(factor.map(|f| f.worst), 1),
        percent(row.within_tolerance),
        number(time.map(|t| t.median), 2),
        number(time.map(|t| t.p90), 2),
        percent(row.coverage),
        percent(row.not_worse),
        percent(row.relative_sigma),
    ]
}

/// The summary in words.
pub fn words(summary: &PlanSummary) -> String {
    let heads = ["median", "P10", "worst", "within", "time", "P90", "in 2 sg", "not worse", "sigma"];
    let mut text = format!("{:<32} {:>5}", "", "cases");
    // Writing to a string cannot fail.
    heads.iter().for_each(|head| _ = write!(text, " {head:>9}"));
    text.push('\n');
    for row in rows(summary) {
        let _ = write!(text, "{:<32} {:>5}", row.name, row.cases);
        columns(row).iter().for_each(|value| _ = write!(text, " {value:>9}"));
        text.push('\n');
    }
    for (case, why) in &summary.failures {
        let _ = writeln!(text, "{case}: {why}");
    }
    text
}

/// The summary as a table of a Markdown file.
pub fn markdown(summary: &PlanSummary) -> String {
    let mut text = "| | cases | factor: median | P10 | worst | within the tolerance | time ratio: median | P90 | in 2σ | not worse than 2σ | σ of the prediction |\n\
        |---|---:|---:|---:|---:|---:|---:|---:|---:|---:|---:|\n"
        .to_owned();
    for row in rows(summary) {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| {} | {} | {} |", row.name, row.cases, columns(row).join(" | "));
    }
    for (case, why) in &summary.failures {
        let _ = writeln!(text, "\n`{case}`: {why}");
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn coverage_counts_both_ways_and_the_tolerance_one() {
        let case = |after: f64| PlanOutcome {
            before_mm: Some(0.3),
            after_mm: Some(after),
            factor: Some(0.3 / after),
            tolerance_mm: Some(0.04),
            predicted_mm: Some(0.03),
            sigma_mm: Some(0.005),
            recommended: Some(true),
            ..PlanOutcome::default()
        };
        let all = summary("", &[case(0.015), case(0.025), case(0.035), case(0.045)]).all;
        assert_eq!((all.coverage, all.not_worse, all.within_tolerance), (Some(0.5), Some(0.75), Some(0.75)));
        assert!(all.rms_sigma.is_some_and(|rms| (rms - 5f64.sqrt()).abs() < 1e-9));
        assert!(all.factor.is_some_and(|f| (f.worst - 0.3 / 0.045).abs() < 1e-9 && f.count == 4));
    }
}
