//! What cannot be cut in several passes is refused by name, with a way on.

use truepath_correction::planned::{can_repeat_pass, can_reverse};
use truepath_ground::diagnostics::Failure;

use super::parts::*;
use super::planned::Plan;

fn changed(part: Part, from: &str, to: &str) -> Part {
    assert!(part.program.contains(from));
    Part { program: Box::leak(part.program.replacen(from, to, 1).into_boxed_str()), ..part }
}

/// The code and the line of what is answered to a first pass so much above the depth of the program, forwards or backwards.
fn refused(part: &Part, raise: f64, reversed: bool) -> (String, usize) {
    let answer = part.written(|path| vec![pass(path, 0.1, raise, reversed, 1.0), pass(path, 0.0, 0.0, false, 1.0)]);
    let Err(Failure::Input(error)) = answer.map(|_| ()) else { panic!("{} is written", part.name) };
    (error.code().to_owned(), error.line_column().map_or(0, |place| place.0))
}

#[test]
fn a_first_pass_does_not_come_down_at_an_end_where_stock_is_left() {
    assert_eq!(refused(&CORNER, 0.0, true), ("P010".to_owned(), 11));
    // The lead-out of the pocket ends 8 mm off the wall.
    assert!(POCKET.written(|path| vec![pass(path, 0.0, 0.0, true, 1.0)]).is_ok());
    // A deeper reversed pass would come down beside the level that was cut.
    let plan: Plan = |path| vec![pass(path, 0.1, 5.0, false, 1.0), pass(path, 0.0, 0.0, true, 1.0)];
    let Err(Failure::Input(error)) = CORNER.written(plan).map(|_| ()) else { panic!("written") };
    assert_eq!(error.code(), "P010");
}

#[test]
fn what_stands_along_the_contour_and_acts_is_named() {
    for (from, to, code, line) in [
        ("N60 G1 X10", "N60 M0 G1 X10", "P009", 10),
        ("(left)\n", "(left)\nM8\n", "P009", 11),
        ("G1 X50\n", "G61 G1 X50\n", "P009", 14),
    ] {
        let answer = refused(&changed(POCKET, from, to), 0.0, false);
        assert_eq!(answer.0, code, "{to}");
        assert!(answer.1.abs_diff(line) <= 1, "{to}: {answer:?}");
    }
}

#[test]
fn a_ramp_stays_for_a_first_pass_at_its_depth_and_is_no_way_to_another() {
    let ramp = changed(POCKET, "G1 Z-8 F300\n", "G1 X20 Z-8 F300\nG1 X30\n");
    let ramp = changed(ramp, "G1 X30\n", "");
    assert_eq!(refused(&ramp, 2.0, false).0, "P009");
    let plan: Plan = |path| vec![pass(path, 0.1, 0.0, false, 1.0), pass(path, 0.0, 0.0, false, 1.0)];
    let written = shown(ramp.written(plan));
    assert!(written.text().contains("G1 X20 Z-8 F300\n") || written.text().contains("Z-8 F300"), "{}", written.text());
    assert!(written.cuts_as_planned(&ramp) <= 0.0011);
}

#[test]
fn where_the_origin_is_set_behind_the_contour_the_leads_stay() {
    let shifted = changed(SIEMENS, "N160 SUPA", "N155 TRANS\nN160 SUPA");
    let plan: Plan = |path| vec![pass(path, 0.15, 0.0, false, 1.0), pass(path, 0.02, 0.0, false, 1.0)];
    let written = shown(shifted.written(plan));
    assert!(written.program.warnings.iter().any(|said| said.contains("leads begin and end where they did")));
    assert!(written.cuts_as_planned(&shifted) <= 0.0011);
    assert!(written.text().contains("N155 TRANS\nN160 SUPA"));
}

#[test]
fn feeds_of_a_plan_are_refused_where_the_job_overrides_those_of_the_program() {
    let mut overridden = CORNER.job();
    overridden.numbers.cut.feed_mm_per_min = Some(truepath_core::units::Real::from_int(400));
    let pass = shown(truepath_job::pass::Pass::new(overridden, CORNER.source()));
    let mut buffer = truepath_job::pass::PathBuffer::default();
    let path = shown(pass.sample(&mut buffer));
    let plan = [super::parts::pass(&path, 0.1, 0.0, false, 1.0), super::parts::pass(&path, 0.0, 0.0, false, 0.5)];
    let Err(Failure::Input(error)) = truepath_correction::planned::write(&pass, &path, &plan, None) else {
        panic!("written")
    };
    assert!(error.code() == "J008" && error.found().contains("F words"), "{}", error.found());
}

#[test]
fn the_search_can_ask_before_it_plans() {
    for part in [CORNER, POCKET, HAAS, WEAR, INCH, G64, SIEMENS, SPRING, SUBPROGRAM] {
        assert!(can_repeat_pass(&part.pass()).is_ok() && can_reverse(&part.pass()).is_ok(), "{}", part.name);
    }
    // G40 behind the lead-out: there is no move along which G42 could be switched on.
    let late = changed(WEAR, "G40 X-20. Y-20.\nG00 Z25. M09", "X-20. Y-20.\nG00 Z25. M09\nG40");
    assert!(can_repeat_pass(&late.pass()).is_ok());
    let Err(Failure::Input(error)) = can_reverse(&late.pass()) else { panic!("a reversed pass") };
    assert_eq!(error.code(), "P010");
}

#[test]
fn a_plan_that_does_not_finish_the_wall_is_none() {
    let answer = CORNER.written(|path| vec![pass(path, 0.0, 1.0, false, 1.0)]).map(|_| ());
    assert!(matches!(answer, Err(Failure::Internal(_))));
}
