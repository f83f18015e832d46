//! The study in numbers: per family and over all, per cell of a grid, and where the method stops working.

use std::collections::BTreeSet;

use serde::Serialize;

use super::families::FAMILIES;
use super::id::{Axis, CaseId, Touches};
use super::nuisance::Nuisance;
use super::outcome::Outcome;
use super::seeds::Set;
use super::statistics::{Spread, quantile, share};

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
    /// Factor of the largest error at any height, the profile error, after the first correction.
    pub any_height: Option<Spread>,
    /// The share of cases in which that came out within 2 sigma of what had been expected.
    pub any_height_held: Option<f64>,
    /// Its factor after one more part.
    pub learned_any_height: Option<Spread>,
    /// The share of cases in which that came out within 2 sigma of what had been expected.
    pub learned_any_height_held: Option<f64>,
    /// What is left at any height.
    pub whole_wall: WholeWall,
    /// What exact knowledge of the part before would have reached.
    pub limits: Limits,
    /// Median time of the first correction, s.
    pub correct_s: Option<f64>,
}

/// What a part cut with exact knowledge of the one before reaches, and how near to it the method comes.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Limits {
    /// Factor of the second part.
    pub first: Option<Spread>,
    /// Median share of it that the first correction reached.
    pub first_reached: Option<f64>,
    /// Factor of the third part.
    pub learned: Option<Spread>,
    /// Median share of it that learning reached.
    pub learned_reached: Option<f64>,
}

impl Limits {
    fn of(outcomes: &[&Outcome]) -> Self {
        let spread =
            |of: fn(&Outcome) -> Option<f64>| Spread::of(&outcomes.iter().filter_map(|o| of(o)).collect::<Vec<f64>>());
        let reached = |of: fn(&Outcome) -> Option<(f64, f64)>| {
            let shares: Vec<f64> =
                outcomes.iter().filter_map(|o| of(o)).map(|(factor, limit)| factor / limit).collect();
            quantile(&shares, 0.5)
        };
        Self {
            first: spread(|o| o.limit_factor),
            first_reached: reached(|o| o.factor.zip(o.limit_factor)),
            learned: spread(|o| o.learned_limit_factor),
            learned_reached: reached(|o| o.learned_factor.zip(o.learned_limit_factor)),
        }
    }
}

/// The walls of several cases at every height: medians in mm; what is left is said of the first correction.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WholeWall {
    /// Largest error at any height before.
    pub profile_before_mm: Option<f64>,
    /// After the first correction.
    pub profile_mm: Option<f64>,
    /// After one more part.
    pub learned_profile_mm: Option<f64>,
    /// What 95 of 100 errors are within before.
    pub p95_before_mm: Option<f64>,
    /// After the first correction.
    pub p95_mm: Option<f64>,
    /// The share of cases in which that came out within 2 sigma of what had been expected.
    pub p95_held: Option<f64>,
    /// After one more part.
    pub learned_p95_mm: Option<f64>,
    /// The share of cases in which that did.
    pub learned_p95_held: Option<f64>,
    /// What makes the largest error at any height, the sign aside, as the model splits it: the mean over the height …
    pub mean_mm: Option<f64>,
    /// … the helix …
    pub height_mm: Option<f64>,
    /// … bending of the cutter …
    pub bending_mm: Option<f64>,
    /// … and one standard deviation of what the points leave open …
    pub noise_mm: Option<f64>,
    /// … and of what the model lacks.
    pub not_modelled_mm: Option<f64>,
}

impl WholeWall {
    /// Of the outcomes of cases.
    fn of(outcomes: &[&Outcome]) -> Self {
        let median = |of: fn(&Outcome) -> Option<f64>| {
            let values: Vec<f64> = outcomes.iter().filter_map(|o| of(o)).map(f64::abs).collect();
            quantile(&values, 0.5)
        };
        Self {
            profile_before_mm: median(|o| o.worst_height_before_mm),
            profile_mm: median(|o| o.worst_height_mm),
            learned_profile_mm: median(|o| o.learned_worst_height_mm),
            p95_before_mm: median(|o| o.p95_before_mm),
            p95_mm: median(|o| o.p95_mm),
            p95_held: share(outcomes.iter().filter_map(|o| o.p95_held())),
            learned_p95_mm: median(|o| o.learned_p95_mm),
            learned_p95_held: share(outcomes.iter().filter_map(|o| o.learned_p95_held())),
            mean_mm: median(|o| o.cause_mean_mm),
            height_mm: median(|o| o.cause_height_mm),
            bending_mm: median(|o| o.cause_bending_mm),
            noise_mm: median(|o| o.cause_noise_mm),
            not_modelled_mm: median(|o| o.cause_not_modelled_mm),
        }
    }

    /// In a line.
    pub fn words(&self) -> String {
        let named = Self::COLUMNS.into_iter().zip(self.cells());
        let told: Vec<String> = named.map(|(name, cell)| format!("{name} {cell}")).collect();
        format!("the whole wall, at any height (medians, um): {}", told.join(", "))
    }

    /// Names of the columns of [`WholeWall::cells`], um where nothing else is said.
    pub const COLUMNS: [&str; 13] = [
        "worst before",
        "after",
        "learned",
        "95 % before",
        "after",
        "in 2σ",
        "learned",
        "in 2σ",
        "mean",
        "helix",
        "bending",
        "σ of noise",
        "σ not modelled",
    ];

    /// The figures of a line of a table.
    pub fn cells(&self) -> [String; 13] {
        let um = |mm: Option<f64>| mm.map_or_else(|| "–".to_owned(), |mm| format!("{:.1}", 1e3 * mm));
        let percent =
            |share: Option<f64>| share.map_or_else(|| "–".to_owned(), |share| format!("{:.0} %", 100.0 * share));
        [
            um(self.profile_before_mm),
            um(self.profile_mm),
            um(self.learned_profile_mm),
            um(self.p95_before_mm),
            um(self.p95_mm),
            percent(self.p95_held),
            um(self.learned_p95_mm),
            percent(self.learned_p95_held),
            um(self.mean_mm),
            um(self.height_mm),
            um(self.bending_mm),
            um(self.noise_mm),
            um(self.not_modelled_mm),
        ]
    }
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

/// Cases with nuisances of one set of seeds and one way to touch.
#[derive(Clone, Debug, Serialize)]
pub struct NuisanceSummary {
    /// Which seeds.
    pub set: Set,
    /// Where the parts are touched.
    pub touches: Touches,
    /// One row a nuisance, the first the same cases without any.
    pub rows: Vec<Row>,
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
    /// One entry a set of seeds and a way to touch, where there are cases with nuisances.
    pub nuisances: Vec<NuisanceSummary>,
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
            set_summary(set, &cases.iter().filter(|(id, _)| id.set() == set && id.is_plain()).collect::<Vec<_>>())
        })
        .collect();
    let axes: Vec<AxisSummary> = Axis::ALL.into_iter().filter_map(|axis| axis_summary(axis, &cases)).collect();
    let nuisances = [Set::Tuning, Set::Test, Set::Random].into_iter().flat_map(|set| {
        let of = |touches| nuisance_summary(set, touches, &cases);
        Touches::ALL.into_iter().filter_map(of).collect::<Vec<_>>()
    });
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
        nuisances: nuisances.collect(),
        failures,
        worse: trouble(&|o| o.worse().then(|| numbers(o))),
        weak: trouble(&|o| {
            (o.id().is_some_and(|id| id.is_plain()) && o.factor.is_some_and(|f| f < WORKS)).then(|| numbers(o))
        }),
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

fn nuisance_summary(set: Set, touches: Touches, cases: &[(CaseId, &Outcome)]) -> Option<NuisanceSummary> {
    let these: Vec<&(CaseId, &Outcome)> =
        cases.iter().filter(|(id, _)| id.set() == set && id.touches == touches && id.cell.is_none()).collect();
    let disturbed: BTreeSet<(&str, u64)> =
        these.iter().filter(|(id, _)| id.nuisance.is_some()).map(|(id, _)| (id.family.as_str(), id.seed)).collect();
    // The families as they are have tables of their own.
    if disturbed.is_empty() && touches == Touches::Family {
        return None;
    }
    let compared = |id: &CaseId| disturbed.is_empty() || disturbed.contains(&(id.family.as_str(), id.seed));
    let rows = std::iter::once(None).chain(Nuisance::EACH.map(Some)).chain([Some(Nuisance::All)]);
    let rows = rows.filter_map(|nuisance| {
        let of = these.iter().filter(|(id, _)| id.nuisance == nuisance && compared(id));
        let outcomes: Vec<&Outcome> = of.map(|(_, o)| *o).collect();
        (!outcomes.is_empty()).then(|| row(nuisance.map_or("none", Nuisance::name), &outcomes))
    });
    let rows: Vec<Row> = rows.collect();
    (!rows.is_empty()).then_some(NuisanceSummary { set, touches, rows })
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
        any_height: Spread::of(&values(|o| o.worst_height_factor)),
        any_height_held: share(outcomes.iter().filter_map(|o| o.worst_height_held())),
        learned_any_height: Spread::of(&values(|o| o.learned_worst_height_factor)),
        learned_any_height_held: share(outcomes.iter().filter_map(|o| o.learned_worst_height_held())),
        whole_wall: WholeWall::of(outcomes),
        limits: Limits::of(outcomes),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_reached_is_a_share_of_what_exact_knowledge_would() {
        let outcome = |factor, limit| Outcome {
            case: "bore/1001/all".to_owned(),
            factor: Some(factor),
            limit_factor: Some(limit),
            ..Outcome::default()
        };
        // One that was refused has a limit and no factor.
        let refused = Outcome { factor: None, ..outcome(0.0, 8.0) };
        let outcomes = [outcome(5.0, 10.0), outcome(9.0, 12.0), outcome(3.0, 30.0), refused];
        let limits = Limits::of(&outcomes.iter().collect::<Vec<_>>());
        assert_eq!(limits.first.map(|first| (first.count, first.worst)), Some((4, 8.0)));
        assert_eq!((limits.first_reached, limits.learned_reached), (Some(0.5), None));
    }

    #[test]
    fn the_whole_wall_is_told_by_medians_in_which_a_sign_does_not_count() {
        let outcome = |helix, after| Outcome {
            case: "bore/1001".to_owned(),
            p95_mm: Some(after),
            p95_predicted_mm: Some(0.020),
            p95_sigma_mm: Some(0.002),
            cause_height_mm: Some(helix),
            ..Outcome::default()
        };
        let outcomes = [outcome(-0.030, 0.021), outcome(0.010, 0.025), outcome(-0.020, 0.017)];
        let wall = WholeWall::of(&outcomes.iter().collect::<Vec<_>>());
        assert_eq!((wall.height_mm, wall.p95_mm, wall.learned_p95_mm), (Some(0.020), Some(0.021), None));
        assert!(wall.p95_held.is_some_and(|held| (held - 2.0 / 3.0).abs() < 1e-9));
        let cells: Vec<(&str, String)> = WholeWall::COLUMNS.into_iter().zip(wall.cells()).collect();
        assert!(cells.contains(&("helix", "20.0".to_owned())) && cells.contains(&("in 2σ", "67 %".to_owned())));
    }

    #[test]
    fn nuisances_have_a_table_of_their_own_beside_the_same_cases_without_any() {
        let outcome = |case: &str, factor| Outcome {
            case: case.to_owned(),
            before_mm: Some(0.1),
            factor: Some(factor),
            ..Outcome::default()
        };
        let outcomes = [
            outcome("bore/1001", 20.0),
            outcome("boss/1001", 30.0),
            outcome("bore/1001/all", 3.0),
            outcome("bore/1001/stock-wave", 9.0),
            outcome("bore/7001/all/chosen", 2.0),
        ];
        let summary = summary("# program", &outcomes);
        // The families as they are stay what they were.
        assert_eq!(summary.sets.len(), 1);
        assert_eq!(summary.sets[0].all.cases, 2);
        let rows: Vec<_> = summary
            .nuisances
            .iter()
            .map(|one| (one.set, one.touches, one.rows.iter().map(|row| (row.name.as_str(), row.cases)).collect()))
            .collect();
        let family = vec![("none", 1), ("stock-wave", 1), ("all", 1)];
        assert_eq!(rows, [(Set::Tuning, Touches::Family, family), (Set::Test, Touches::Chosen, vec![("all", 1)])]);
        assert!(summary.weak.is_empty(), "a factor of 3 with all nuisances is no weakness of the family");
    }
}
