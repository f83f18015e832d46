//! The study: distributions that do not depend on what is studied, results that survive an interruption, a page with
//! everything on it.

use clap::Parser;
use truepath::command::study::{Options, cases, run};
use truepath_study::case::Case;
use truepath_study::case_table::NAME;
use truepath_study::families::FAMILIES;
use truepath_study::id::{Axis, CaseId};
use truepath_study::nuisance::Nuisance;
use truepath_study::seeds::Set;

#[derive(Parser)]
struct Asked {
    #[command(flatten)]
    options: Options,
}

fn options(words: &[&str]) -> Options {
    let usual = ["study", "--seeds", "1", "--threads", "2", "-o"];
    Asked::try_parse_from(usual.iter().chain(words)).unwrap_or_else(|e| panic!("{e}")).options
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn two_cases_go_the_whole_way_and_an_interrupted_study_goes_on() {
    let folder = tempfile::tempdir().expect("a folder");
    let families = ["corner-papers", "bore"];
    let asked = options(&[folder.path().to_str().expect("a name"), "--families", &families.join(",")]);
    let studied = run(&asked, &mut |_, _| ()).expect("two cases");
    for outcome in &studied.outcomes {
        assert_eq!((outcome.failure.as_str(), outcome.learn_failure.as_str()), ("", ""), "{}", outcome.case);
        assert!(outcome.before_mm.is_some_and(|b| b > 0.045), "{outcome:?}");
        assert!(outcome.factor.is_some() && outcome.learned_factor.is_some() && outcome.coverage.is_some());
    }
    // Stopped while the second line was being written.
    let table = folder.path().join(NAME);
    let whole = std::fs::read(&table).expect("the table");
    std::fs::write(&table, &whole[..whole.len() - 30]).expect("writable");
    let mut steps = Vec::new();
    let again = run(&asked, &mut |done, all| steps.push((done, all))).expect("the rest");
    assert_eq!(steps, [(1, 2), (2, 2)], "one case was left to do");
    let without_time = |outcomes: &[truepath_study::outcome::Outcome]| -> Vec<String> {
        outcomes.iter().map(|o| format!("{} {:?} {:?}", o.case, o.after_mm, o.learned_mm)).collect()
    };
    assert_eq!(without_time(&again.outcomes), without_time(&studied.outcomes), "a case is the same every time");
    let page = std::fs::read_to_string(folder.path().join("study.html")).expect("the page");
    for name in families.into_iter().chain(["Where it stops working", "<svg"]) {
        assert!(page.contains(name), "{name} is not on the page");
    }
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn every_family_draws_cases_that_can_be_milled_and_touched() {
    for family in FAMILIES {
        let id: CaseId = format!("{}/{}", family.name, Set::Tuning.seeds().start).parse().expect("an id");
        let case = Case::draw(&id).unwrap_or_else(|e| panic!("{id}: {e}"));
        let error = case.before.score.max_error_mm;
        assert!((0.03..0.75).contains(&error), "{id}: {error} mm before");
        assert!(case.places_mm.len() >= 2, "{id}: {:?}", case.places_mm);
        assert!(!case.more_mm.is_empty(), "{id}");
        let touches = case.probe(1, &case.first, &case.places_mm).unwrap_or_else(|e| panic!("{id}: {e}"));
        assert_eq!(touches.lines().count(), case.places_mm.len() * case.levels.len(), "{id}");
        if ["pocket", "boss", "bore", "ellipse"].iter().any(|closed| family.name.starts_with(closed)) {
            assert!(case.part.contour.closed(), "{id} is not closed");
        }
    }
}

#[test]
fn no_two_sets_share_a_case_and_every_family_is_in_each() {
    let names = |set: Set, seeds: u64| -> Vec<String> {
        let asked = Options { set, seeds, ..options(&["nowhere"]) };
        cases(&asked).expect("cases").iter().map(ToString::to_string).collect()
    };
    let (tuning, test) = (names(Set::Tuning, 3), names(Set::Test, 3));
    assert!(FAMILIES.len() >= 24);
    assert_eq!(tuning.len(), 3 * FAMILIES.len());
    assert!(tuning.iter().all(|name| !test.contains(name)));
    let random = names(Set::Random, FAMILIES.len() as u64);
    assert!(FAMILIES.iter().all(|family| random.iter().any(|name| name.starts_with(family.name))));
    let grid = Options { axis: Some(Axis::Noise), ..options(&["nowhere"]) };
    assert_eq!(cases(&grid).expect("cases").len(), FAMILIES.len() * Axis::Noise.values().len());
}

#[test]
fn every_nuisance_is_a_case_of_its_own_beside_none_and_all() {
    let names = |words: &[&str]| -> Vec<String> {
        let asked = options(&[&["nowhere", "--families", "bore"], words].concat());
        cases(&asked).expect("cases").iter().map(ToString::to_string).collect()
    };
    let each = names(&["--nuisance", "each"]);
    assert_eq!(each.len(), Nuisance::EACH.len() + 2);
    assert_eq!((each[0].as_str(), each[each.len() - 1].as_str()), ("bore/1001", "bore/1001/all"));
    for nuisance in Nuisance::EACH {
        assert_eq!(names(&["--nuisance", nuisance.name()]), [format!("bore/1001/{}", nuisance.name())]);
    }
    let chosen = names(&["--nuisance", "all,none,all", "--touches", "chosen"]);
    assert_eq!(chosen, ["bore/1001/chosen", "bore/1001/all/chosen"]);
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn a_nuisance_leaves_the_case_beneath_as_it_is() {
    let draw = |id: &str| Case::draw(&id.parse().expect("an id")).unwrap_or_else(|e| panic!("{id}: {e}"));
    let plain = draw("pocket-climb/1001");
    for (id, differs) in [("pocket-climb/1001/stock-step", true), ("pocket-climb/1001/wild", false)] {
        let case = draw(id);
        assert_eq!((&case.job, &case.program, &case.machine), (&plain.job, &plain.program, &plain.machine));
        assert_eq!(case.places_mm, plain.places_mm);
        assert_eq!(case.before != plain.before, differs, "{id}");
        let touched = |case: &Case| case.probe(1, &case.first, &case.places_mm).expect("a wall");
        let lines = |text: &str| text.lines().map(str::to_owned).collect::<Vec<_>>();
        let apart = lines(&touched(&case)).iter().zip(lines(&touched(&plain))).filter(|(a, b)| **a != *b).count();
        // One wild touch; a step moves what lies behind it, and a little before it.
        assert!(if differs { apart > 2 } else { apart == 1 }, "{id}: {apart}");
    }
    let chosen = draw("pocket-climb/1001/chosen");
    assert_eq!((chosen.places_mm.len(), chosen.levels.len()), (8, 3));
}
