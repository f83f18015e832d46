//! The verdict about a part: from its points, and in words that say what it rests on.

use truepath_core::units::Offset;
use truepath_ground::length::Unit;
use truepath_ground::units::mm;

use super::coverage::Coverage;
use super::rule::{PointVerdict, Rule, limits_text};
use super::set_aside::SetAside;

/// What is known of the part.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "lowercase")]
pub enum State {
    /// Every point is proven within the limits.
    Pass,
    /// At least one point is proven outside.
    Fail,
    /// Neither; or there are no limits.
    Open,
}

/// State and reason.
#[derive(Clone, Debug, PartialEq, Eq, serde::Serialize)]
pub struct Verdict {
    /// The state.
    pub state: State,
    /// Why, in one line.
    pub text: String,
}

/// Points by verdict.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Count {
    /// Proven within.
    pub pass: usize,
    /// Proven outside.
    pub fail: usize,
    /// Undecided.
    pub open: usize,
}

/// The verdict and everything it rests on.
#[derive(Clone, Debug, PartialEq)]
pub struct Judgement {
    /// The verdict.
    pub verdict: Verdict,
    /// Verdict of each point, in the order given; empty without limits.
    pub points: Vec<PointVerdict>,
    /// How many are what; absent without limits.
    pub count: Option<Count>,
    /// Decimals with which the deviations are told, as those of a millimetre.
    pub decimals: usize,
    /// Sentences for the report: decision rule, what the verdict holds for, what no point speaks for.
    pub statements: Vec<String>,
}

/// Judges a part by one wall, and says it in a unit. Readings `aside` were not judged; those that may be of its wall keep it from passing.
pub fn judge(rule: Option<Rule>, deviations: &[Offset], aside: SetAside, coverage: &Coverage, unit: Unit) -> Judgement {
    let mut judgement = judge_points(rule, deviations, aside, unit);
    judgement.statements.push(coverage.words(unit));
    judgement.statements.push(coverage.face.words(unit, coverage.length_mm));
    judgement
}

/// One of several walls of a part: its name, and what no point speaks for; `None` where it was not touched.
pub type NamedWall<'a> = (&'a str, Option<&'a Coverage>);

/// Judges a part by several walls, in a unit, of whose points `deviations` are all. It does not pass while one of them is not touched.
pub fn judge_every(
    rule: Option<Rule>,
    deviations: &[Offset],
    aside: SetAside,
    walls: &[NamedWall<'_>],
    unit: Unit,
) -> Judgement {
    let mut judgement = judge_points(rule, deviations, aside, unit);
    for (name, coverage) in walls {
        judgement.statements.push(match coverage {
            Some(coverage) => {
                format!("{name}: {} {}", coverage.words(unit), coverage.face.words(unit, coverage.length_mm))
            }
            None => format!("{name}: not touched, nothing is said of it."),
        });
    }
    let untouched: Vec<&str> = walls.iter().filter(|(_, coverage)| coverage.is_none()).map(|(name, _)| *name).collect();
    let verdict = &mut judgement.verdict;
    if let Some(said) = verdict.text.strip_prefix("pass:").filter(|_| !untouched.is_empty()) {
        verdict.text = format!("open, though{said}; not touched: {}", untouched.join(", "));
        verdict.state = State::Open;
    }
    judgement
}

/// What the points say, and what they rest on.
fn judge_points(rule: Option<Rule>, deviations: &[Offset], aside: SetAside, unit: Unit) -> Judgement {
    let points: Vec<PointVerdict> = rule.iter().flat_map(|rule| deviations.iter().map(|d| rule.point(*d))).collect();
    let of = |verdict| points.iter().filter(|p| **p == verdict).count();
    let count = rule.map(|_| Count {
        pass: of(PointVerdict::Pass),
        fail: of(PointVerdict::Fail),
        open: of(PointVerdict::Open),
    });
    let verdict = match (rule, count) {
        (Some(rule), Some(count)) => verdict(&rule, count, deviations, aside, unit),
        _ => Verdict { state: State::Open, text: "open: no tolerance given".to_owned() },
    };
    let mut statements: Vec<String> = rule.iter().map(|rule| rule.words(unit)).collect();
    if rule.is_some_and(|rule| rule.proves_nothing()) {
        statements.push(
            "The uncertainty is more than half the width of the tolerance: no point can be proven within it."
                .to_owned(),
        );
    }
    statements.push(match deviations.len() {
        1 => "What is said here holds at the one measured place only.".to_owned(),
        all => format!("What is said here holds at the {all} measured places only."),
    });
    if aside.all > 0 {
        let (readings, they) = if aside.all == 1 { ("reading was", "it is") } else { ("readings were", "they are") };
        statements.push(format!("{} {readings} set aside and not judged; {they} listed with the reason.", aside.all));
    }
    if rule.is_some() && aside.doubtful > 0 {
        statements.push(
            "With a reading set aside that may be of this wall, far off, the part does not pass whatever its points say."
                .to_owned(),
        );
    }
    let decimals = rule.map_or(4, |rule| rule.decimals(deviations, unit));
    Judgement { verdict, points, count, decimals, statements }
}

fn verdict(rule: &Rule, count: Count, deviations: &[Offset], aside: SetAside, unit: Unit) -> Verdict {
    let Count { pass, fail, open } = count;
    let all = deviations.len();
    let limits = limits_text(rule.tolerance, unit);
    // The deviation that reaches farthest beyond its limit, or comes closest to it.
    let excess = |d: &Offset| (*d - rule.tolerance.upper).max(rule.tolerance.lower - *d);
    let worst = deviations.iter().copied().max_by_key(excess).map_or(0.0, mm);
    let worst = format!("{:+.*} {}", rule.decimals(deviations, unit), unit.of(worst), unit.name());
    let with = if rule.uncertainty.is_some() { "" } else { ", simple acceptance without uncertainty" };
    let (state, text) = if fail > 0 {
        let undecided = if open > 0 { format!(", {open} undecided") } else { String::new() };
        let verb = if fail == 1 { "is" } else { "are" };
        (
            State::Fail,
            format!("fail: {fail} of {all} points {verb} outside {limits}{undecided}, the worst {worst}{with}"),
        )
    } else if all > 0 && pass == all {
        let points = if all == 1 { "the point lies".to_owned() } else { format!("all {all} points lie") };
        let (state, said) = if aside.doubtful > 0 { (State::Open, "open, though") } else { (State::Pass, "pass:") };
        (state, format!("{said} {points} within {limits}, closest to a limit {worst}{with}"))
    } else {
        let verb = if open == 1 { "is" } else { "are" };
        (
            State::Open,
            format!(
                "open: {open} of {all} points {verb} within the uncertainty of a limit of {limits}, none proven outside"
            ),
        )
    };
    let readings = |n: usize| if n == 1 { "reading" } else { "readings" };
    let text = match aside {
        SetAside { all: 0, .. } => text,
        SetAside { all, doubtful: 0 } => format!("{text}; {all} {} set aside and not judged", readings(all)),
        SetAside { all, doubtful } => format!(
            "{text}; {doubtful} of {all} {} set aside may be of a wall that is far off: look at the list, touch there again",
            readings(all)
        ),
    };
    Verdict { state, text }
}

#[cfg(test)]
mod tests {
    use truepath_job::job::Tolerance;

    use super::super::coverage::{Extent, Reach, coverage};
    use super::*;

    /// Of a wall of ten by ten millimetres that nobody touched.
    fn untouched() -> Coverage {
        let far = Offset::from_um(10_000);
        coverage(&[], Extent { length: far, depth: far, closed: false }, Reach { along: far, height: far })
    }

    fn judged(uncertainty: Option<i64>, nm: &[i64]) -> Judgement {
        let tolerance = Tolerance { lower: Offset::ZERO, upper: Offset::from_nm(20_000), from_command_line: false };
        let rule = Rule { tolerance, uncertainty: uncertainty.map(Offset::from_nm) };
        let deviations: Vec<Offset> = nm.iter().map(|v| Offset::from_nm(*v)).collect();
        judge(Some(rule), &deviations, SetAside::default(), &untouched(), Unit::Millimetre)
    }

    #[test]
    fn one_point_proven_outside_fails_the_part_whatever_the_others_say() {
        let judgement = judged(Some(1_000), &[5_000, 19_500, 21_001, 10_000]);
        assert_eq!(judgement.verdict.state, State::Fail);
        assert_eq!(judgement.count, Some(Count { pass: 2, fail: 1, open: 1 }));
        assert!(
            judgement.verdict.text.contains("1 of 4 points is outside +0 to +0.02 mm, 1 undecided, the worst +0.0210"),
            "{}",
            judgement.verdict.text
        );
    }

    #[test]
    fn the_worst_point_of_a_part_that_fails_is_not_told_as_on_the_limit() {
        let judgement = judged(None, &[20_040]);
        assert!(judgement.verdict.text.contains("the worst +0.020040 mm"), "{}", judgement.verdict.text);
        assert_eq!((judgement.decimals, judged(None, &[20_100]).decimals), (6, 4));
    }

    #[test]
    fn a_verdict_says_that_readings_were_not_judged() {
        let rule = |tolerance| Rule { tolerance, uncertainty: None };
        let tolerance = Tolerance { lower: Offset::ZERO, upper: Offset::from_nm(20_000), from_command_line: false };
        let judged = |all, doubtful| {
            let aside = SetAside { all, doubtful };
            judge(Some(rule(tolerance)), &[Offset::ZERO], aside, &untouched(), Unit::Millimetre).verdict
        };
        let text = |all| judged(all, 0).text;
        assert!(
            text(1).starts_with("pass: ") && text(1).ends_with("; 1 reading set aside and not judged"),
            "{}",
            text(1)
        );
        assert!(text(2).ends_with("; 2 readings set aside and not judged") && !text(0).contains("set aside"));
        let doubted = judged(3, 1);
        assert_eq!(doubted.state, State::Open);
        assert!(doubted.text.starts_with("open, though the point lies within"), "{}", doubted.text);
        assert!(
            doubted.text.contains("1 of 3 readings set aside may be of a wall that is far off"),
            "{}",
            doubted.text
        );
    }

    #[test]
    fn a_part_passes_only_when_every_point_is_proven_within() {
        assert_eq!(judged(Some(1_000), &[1_000, 19_000]).verdict.state, State::Pass);
        assert_eq!(judged(Some(1_000), &[999, 19_000]).verdict.state, State::Open);
        assert_eq!(judged(None, &[0, 20_000]).verdict.state, State::Pass);
        assert_eq!(judged(None, &[0, 20_001]).verdict.state, State::Fail);
        assert_eq!(judged(None, &[]).verdict.state, State::Open);
    }

    #[test]
    fn a_part_with_a_wall_that_was_not_touched_does_not_pass() {
        let tolerance = Tolerance { lower: Offset::ZERO, upper: Offset::from_nm(20_000), from_command_line: false };
        let rule = Some(Rule { tolerance, uncertainty: None });
        let all = |second: Option<&Coverage>, nm: i64| {
            let walls = [("contour-1", Some(&untouched())), ("contour-2", second)].map(|(name, c)| (name, c.cloned()));
            let walls: Vec<NamedWall<'_>> = walls.iter().map(|(name, c)| (*name, c.as_ref())).collect();
            judge_every(rule, &[Offset::from_nm(nm)], SetAside::default(), &walls, Unit::Millimetre)
        };
        assert_eq!(all(Some(&untouched()), 1).verdict.state, State::Pass);
        let open = all(None, 1);
        assert_eq!(open.verdict.state, State::Open);
        assert!(open.verdict.text.starts_with("open, though the point lies"), "{}", open.verdict.text);
        assert!(open.verdict.text.ends_with("; not touched: contour-2"), "{}", open.verdict.text);
        assert_eq!(all(None, 30_000).verdict.state, State::Fail, "one bad point is enough");
    }

    #[test]
    fn the_statements_name_rule_readings_set_aside_and_what_was_not_touched() {
        let none = judge(None, &[Offset::ZERO], SetAside { all: 2, doubtful: 0 }, &untouched(), Unit::Millimetre);
        assert_eq!(none.verdict.text, "open: no tolerance given");
        assert!(none.points.is_empty() && none.count.is_none());
        let said = none.statements.join("\n");
        for words in [
            "at the one measured place only",
            "2 readings were set aside",
            "10.0 of 10.0 mm of the contour lie farther",
            "No height of the wall was touched",
        ] {
            assert!(said.contains(words), "{words}: {said}");
        }
        assert!(judged(None, &[0]).statements[0].starts_with("Simple acceptance"));
        assert!(judged(Some(1), &[0]).statements[0].contains("ISO 14253-1"));
        assert!(judged(Some(15_000), &[0]).statements[1].contains("no point can be proven within"));
    }
}
