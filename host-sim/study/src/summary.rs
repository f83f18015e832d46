//! The study in numbers: per family and over all, per cell of a grid, and where the method stops working.

use serde::Serialize;

use super::families::FAMILIES;
use super::id::{Axis, CaseId};
use super::outcome::Outcome;
use super::seeds::Set;
use super::statistics::Spread;

/// Below this factor the method is said not to work.
pub const WORKS: f64 = 4.0;

/// Several cases taken together.
#[derive(Clone, Debug, Serialize)]
pub struct Row {
    /// What they have in common.
    pub name: String,
    /// Number of cases.
    pub cases: usize,
    /// Cases refused, or failed in any other way.
    pub failures: usize,
    /// Cases that came out worse than without correction, at any step.
    pub worse: usize,
    /// Largest error before, median, mm.
    pub before_mm: Option<f64>,
    /// Factor of the first correction; failures are not among them.
    pub first: Option<Spread>,
    /// Factor after one more part.
    pub learned: Option<Spread>,
    /// Cases in which learning failed.
    pub learn_failures: usize,
    /// Share of the contour within 2 sigma after the first correction, each case weighted by its length.
    pub coverage: Option<f64>,
    /// The same after one more part.
    pub learned_coverage: Option<f64>,
    /// Median time of the first correction, s.
    pub correct_s: Option<f64>,
}

/// Results of one set of seeds.
#[derive(Clone, Debug, Serialize)]
pub struct SetSummary {
    /// Which.
    pub set: Set,
    /// One row a family.
    pub families: Vec<Row>,
    /// All of them.
    pub all: Row,
    /// Cases grouped by what may matter.
    pub groups: Vec<(&'static str, Vec<Row>)>,
}

/// Results of one grid.
#[derive(Clone, Debug, Serialize)]
pub struct AxisSummary {
    /// What was changed.
    pub axis: &'static str,
    /// One (value, row) a cell.
    pub cells: Vec<(f64, Row)>,
}

/// A case that failed, came out worse or below the factor at which the method works.
#[derive(Clone, Debug, Serialize)]
pub struct Trouble {
    /// Its name.
    pub case: String,
    /// What happened.
    pub what: String,
}

/// `summary.json` of the study.
#[derive(Clone, Debug, Serialize)]
pub struct Summary {
    /// Version of this file.
    pub version: u32,
    /// The program that made the results.
    pub program: String,
    /// One entry a set of seeds.
    pub sets: Vec<SetSummary>,
    /// One entry a grid.
    pub axes: Vec<AxisSummary>,
    /// Sentences: where the method stops working.
    pub limits: Vec<String>,
    /// Failures.
    pub failures: Vec<Trouble>,
    /// Parts made worse.
    pub worse: Vec<Trouble>,
    /// Cases below the factor at which the method works.
    pub weak: Vec<Trouble>,
}

/// Summarises the results of a folder.
pub fn summary(program: &str, outcomes: &[Outcome]) -> Summary {
    let cases: Vec<(CaseId, &Outcome)> = outcomes.iter().filter_map(|o| Some((o.id()?, o))).collect();
    let sets: Vec<SetSummary> = [Set::Tuning, Set::Test, Set::Random]
        .into_iter()
        .filter_map(|set| {
            set_summary(set, &cases.iter().filter(|(id, _)| id.set() == set && id.cell.is_none()).collect::<Vec<_>>())
        })
        .collect();
    let axes: Vec<AxisSummary> = Axis::ALL.into_iter().filter_map(|axis| axis_summary(axis, &cases)).collect();
    let trouble = |what: &dyn Fn(&Outcome) -> Option<String>| -> Vec<Trouble> {
        let each = outcomes.iter().filter_map(|o| Some(Trouble { case: o.case.clone(), what: what(o)? }));
        each.collect()
    };
    let said = |text: &str| (!text.is_empty()).then(|| text.to_owned());
    let mut failures = trouble(&|o| said(&o.failure));
    failures.extend(trouble(&|o| said(&o.learn_failure).map(|text| format!("learning: {text}"))));
    Summary {
        version: 1,
        program: program.trim_start_matches("# ").to_owned(),
        limits: limits(&sets, &axes),
        sets,
        axes,
        failures,
        worse: trouble(&|o| o.worse().then(|| numbers(o))),
        weak: trouble(&|o| (o.cell().is_none() && o.factor.is_some_and(|f| f < WORKS)).then(|| numbers(o))),
    }
}

fn numbers(o: &Outcome) -> String {
    let mm = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.4}"));
    format!("{} mm before, {} mm after, {} mm after learning", mm(o.before_mm), mm(o.after_mm), mm(o.learned_mm))
}

fn set_summary(set: Set, cases: &[&(CaseId, &Outcome)]) -> Option<SetSummary> {
    if cases.is_empty() {
        return None;
    }
    let outcomes: Vec<&Outcome> = cases.iter().map(|(_, o)| *o).collect();
    let families = FAMILIES.iter().filter_map(|family| {
        let these: Vec<&Outcome> = cases.iter().filter(|(id, _)| id.family == family.name).map(|(_, o)| *o).collect();
        (!these.is_empty()).then(|| row(family.name, &these))
    });
    let grouped = |value: fn(&Outcome) -> Option<f64>, edges: &[f64], unit: &str| -> Vec<Row> {
        let bounds: Vec<f64> = std::iter::once(0.0).chain(edges.iter().copied()).chain([f64::INFINITY]).collect();
        let rows = bounds.windows(2).filter_map(|w| {
            let within = |o: &&Outcome| value(o).is_some_and(|v| v >= w[0] && v < w[1]);
            let these: Vec<&Outcome> = outcomes.iter().copied().filter(within).collect();
            let name = match (w[0], w[1]) {
                (0.0, high) => format!("below {high} {unit}"),
                (low, f64::INFINITY) => format!("from {low} {unit} on"),
                (low, high) => format!("{low} to {high} {unit}"),
            };
            (!these.is_empty()).then(|| row(name.trim_end(), &these))
        });
        rows.collect()
    };
    Some(SetSummary {
        set,
        families: families.collect(),
        all: row("all", &outcomes),
        groups: vec![
            ("Error before", grouped(|o| o.before_mm, &[0.08, 0.15, 0.3], "mm")),
            (
                "Stiffness, machine and cutter",
                grouped(|o| o.stiffness_n_per_mm, &[400.0, 800.0, 1600.0, 3200.0], "N/mm"),
            ),
            ("Touches", grouped(|o| o.points.map(|p| p as f64), &[8.0, 11.0, 14.0, 20.0], "")),
        ],
    })
}

fn axis_summary(axis: Axis, cases: &[(CaseId, &Outcome)]) -> Option<AxisSummary> {
    let of = |value: f64| -> Vec<&Outcome> {
        let here = |id: &CaseId| id.cell.is_some_and(|c| c.axis == axis && (c.value - value).abs() < 1e-9);
        cases.iter().filter(|(id, _)| here(id)).map(|(_, o)| *o).collect()
    };
    let cells: Vec<(f64, Row)> = axis
        .values()
        .iter()
        .map(|&value| (value, of(value)))
        .filter(|(_, these)| !these.is_empty())
        .map(|(value, these)| (value, row(&format!("{value}"), &these)))
        .collect();
    (!cells.is_empty()).then_some(AxisSummary { axis: axis.name(), cells })
}

fn row(name: &str, outcomes: &[&Outcome]) -> Row {
    let values = |of: fn(&Outcome) -> Option<f64>| -> Vec<f64> { outcomes.iter().filter_map(|o| of(o)).collect() };
    let weighted = |of: fn(&Outcome) -> Option<f64>| {
        let pairs = outcomes.iter().filter_map(|o| Some((of(o)?, o.length_mm?)));
        let (sum, length) = pairs.fold((0.0, 0.0), |(s, l), (c, length)| (s + c * length, l + length));
        (length > 0.0).then(|| sum / length)
    };
    let median = |of| Spread::of(&values(of)).map(|s| s.median);
    Row {
        name: name.to_owned(),
        cases: outcomes.len(),
        failures: outcomes.iter().filter(|o| !o.failure.is_empty()).count(),
        worse: outcomes.iter().filter(|o| o.worse()).count(),
        before_mm: median(|o| o.before_mm),
        first: Spread::of(&values(|o| o.factor)),
        learned: Spread::of(&values(|o| o.learned_factor)),
        learn_failures: outcomes.iter().filter(|o| !o.learn_failure.is_empty()).count(),
        coverage: weighted(|o| o.coverage),
        learned_coverage: weighted(|o| o.learned_coverage),
        correct_s: median(|o| o.correct_s),
    }
}

/// Where the median factor of the first correction falls below [`WORKS`], or parts came out worse, or cases failed.
fn limits(sets: &[SetSummary], axes: &[AxisSummary]) -> Vec<String> {
    let mut out = Vec::new();
    let mut look = |place: String, row: &Row| {
        if let Some(first) = row.first.filter(|s| s.median < WORKS) {
            out.push(format!(
                "{place}: the median factor of {} cases is {:.1}, the worst {:.1}",
                first.count, first.median, first.worst
            ));
        }
        if row.worse > 0 {
            out.push(format!("{place}: {} of {} parts came out worse", row.worse, row.cases));
        }
        if row.failures > 0 {
            out.push(format!("{place}: {} of {} corrections were refused", row.failures, row.cases));
        }
    };
    for set in sets {
        for row in &set.families {
            look(format!("{} ({} seeds)", row.name, set.set.name()), row);
        }
        for (title, rows) in &set.groups {
            for row in rows.iter().filter(|row| row.first.is_some_and(|s| s.median < WORKS)) {
                look(format!("{title} {} ({} seeds)", row.name, set.set.name()), row);
            }
        }
    }
    for axis in axes {
        for (value, row) in &axis.cells {
            look(format!("{} = {value}", axis.axis), row);
        }
    }
    out
}
