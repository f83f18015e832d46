//! What came out of the study of a shop.

use std::fmt::Write;

use serde::Serialize;

use super::outcome::ShopOutcome;
use crate::statistics::{Spread, number, percent};

/// A correction is worse than the one by itself when it leaves more than this times as much, and more by a micrometre.
const WORSE: f64 = 1.05;
const WORSE_MM: f64 = 0.001;

/// First corrections that knew the same.
#[derive(Clone, Debug, Serialize)]
pub struct ShopRow {
    /// What they knew.
    pub name: String,
    /// Largest wall error before over after.
    pub factor: Option<Spread>,
    /// Share of the contours within 2 sigma, mean over the jobs.
    pub coverage: Option<f64>,
    /// Jobs that came out worse than by themselves.
    pub worse: usize,
    /// Jobs whose points contradicted what others say.
    pub contradicted: usize,
}

/// The summary of a shop.
#[derive(Clone, Debug, Serialize)]
pub struct ShopSummary {
    /// Which program made it.
    pub program: String,
    /// Jobs that came to their end.
    pub jobs: usize,
    /// Corrections by what they knew.
    pub rows: Vec<ShopRow>,
    /// Jobs that failed: name and reason.
    pub failures: Vec<(String, String)>,
}

type Of = fn(&ShopOutcome) -> Option<f64>;

/// The summary of outcomes.
pub fn summary(program: &str, outcomes: &[ShopOutcome]) -> ShopSummary {
    let done: Vec<&ShopOutcome> = outcomes.iter().filter(|o| o.failure.is_empty()).collect();
    let row = |name: &str, after: Of, coverage: Of, kept: fn(&ShopOutcome) -> Option<bool>| {
        let factors: Vec<f64> = done.iter().filter_map(|o| Some(o.before_mm? / after(o)?.max(1e-6))).collect();
        let covered: Vec<f64> = done.iter().filter_map(|o| coverage(o)).collect();
        let is_worse = |o: &&&ShopOutcome| {
            let (Some(after), Some(alone)) = (after(o), o.alone_mm) else { return false };
            after > alone * WORSE && after > alone + WORSE_MM
        };
        ShopRow {
            name: name.to_owned(),
            factor: Spread::of(&factors),
            coverage: (!covered.is_empty()).then(|| covered.iter().sum::<f64>() / covered.len() as f64),
            worse: done.iter().filter(is_worse).count(),
            contradicted: done.iter().filter(|o| kept(o) == Some(false)).count(),
        }
    };
    let failed = outcomes.iter().filter(|o| !o.failure.is_empty());
    ShopSummary {
        program: program.to_owned(),
        jobs: done.len(),
        rows: vec![
            row("what the job states", |o| o.alone_mm, |o| o.alone_coverage, |_| None),
            row("and jobs of other machines", |o| o.others_mm, |o| o.others_coverage, |o| o.others_kept),
            row("and those of the same machine", |o| o.all_mm, |o| o.all_coverage, |o| o.all_kept),
        ],
        failures: failed.map(|o| (o.case.clone(), o.failure.clone())).collect(),
    }
}

const HEADS: [&str; 6] = ["median", "P10", "worst", "in 2 sg", "worse", "contradicted"];

fn columns(row: &ShopRow) -> [String; 6] {
    [
        number(row.factor.map(|f| f.median), 1),
        number(row.factor.map(|f| f.p10), 1),
        number(row.factor.map(|f| f.worst), 1),
        percent(row.coverage),
        row.worse.to_string(),
        row.contradicted.to_string(),
    ]
}

/// The summary in words.
pub fn words(summary: &ShopSummary) -> String {
    let mut text = format!("{:<32}", format!("{} jobs; factor of:", summary.jobs));
    // Writing to a string cannot fail.
    HEADS.iter().for_each(|head| _ = write!(text, " {head:>12}"));
    text.push('\n');
    for row in &summary.rows {
        let _ = write!(text, "{:<32}", row.name);
        columns(row).iter().for_each(|value| _ = write!(text, " {value:>12}"));
        text.push('\n');
    }
    for (case, why) in &summary.failures {
        let _ = writeln!(text, "{case}: {why}");
    }
    text
}

/// The summary as a table of a Markdown file.
pub fn markdown(summary: &ShopSummary) -> String {
    let mut text = "| the first correction knows | factor: median | P10 | worst | in 2σ | worse than by itself | contradicted by the points |\n\
        |---|---:|---:|---:|---:|---:|---:|\n"
        .to_owned();
    for row in &summary.rows {
        // Writing to a string cannot fail.
        let _ = writeln!(text, "| {} | {} |", row.name, columns(row).join(" | "));
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
    fn worse_is_what_leaves_clearly_more_than_by_itself() {
        let job = |others_mm: f64| ShopOutcome {
            before_mm: Some(0.2),
            alone_mm: Some(0.02),
            others_mm: Some(others_mm),
            others_kept: Some(others_mm < 0.03),
            ..ShopOutcome::default()
        };
        let failed = ShopOutcome { failure: "no wall".to_owned(), ..ShopOutcome::default() };
        let summary = summary("", &[job(0.01), job(0.0209), job(0.022), job(0.04), failed]);
        let [alone, others, _] = &summary.rows[..] else { panic!("three rows") };
        assert_eq!((summary.jobs, summary.failures.len()), (4, 1));
        assert_eq!((alone.worse, others.worse, others.contradicted), (0, 2, 1));
        assert!(others.factor.is_some_and(|f| (f.worst - 5.0).abs() < 1e-9 && f.count == 4));
        assert!(markdown(&summary).contains("| 2 | 1 |"), "{}", markdown(&summary));
    }
}
