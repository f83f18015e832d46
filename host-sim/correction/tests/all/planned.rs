//! Every part with the plans that a search may choose.

use truepath_core::cut::Path;
use truepath_correction::planned::PlannedPass;

use super::parts::*;

const PARTS: [Part; 9] = [CORNER, POCKET, HAAS, WEAR, INCH, G64, SIEMENS, SPRING, SUBPROGRAM];

/// What makes a plan from a path.
pub type Plan = fn(&Path<'_>) -> Vec<PlannedPass>;

/// A semi-finishing pass, and the last one the other way at half feed.
pub fn radial(path: &Path<'_>) -> Vec<PlannedPass> {
    vec![pass(path, 0.15, 0.0, false, 1.0), pass(path, 0.0, 0.0, true, 0.5)]
}

/// Two levels, and a spring pass over both.
pub fn levels(path: &Path<'_>) -> Vec<PlannedPass> {
    vec![pass(path, 0.1, 2.0, false, 1.25), pass(path, 0.05, 0.0, false, 1.0), pass(path, 0.0, 0.0, false, 2.0)]
}

/// The lines of a program that were not to change are there, in their order and to the byte: all before the passes but
/// the way to them, and all behind but the way back.
fn others_are_kept(part: &Part, written: &Written) {
    if written.program.warnings.iter().any(|w| w.contains("written out")) {
        return;
    }
    let new: Vec<&str> = written.text().lines().collect();
    let old: Vec<&str> = part.program.lines().collect();
    let mut from = 0;
    let mut changed = Vec::new();
    let replaced = |line: u32| written.program.depths.iter().any(|d| d.replaced[0] <= line && line <= d.replaced[1]);
    for (number, line) in (1u32..).zip(&old).filter(|(number, _)| !replaced(*number)) {
        match new[from..].iter().position(|other| other == line) {
            Some(at) => from += at + 1,
            None => changed.push((number, *line)),
        }
    }
    let ends = 2 * written.program.depths.len();
    assert!(changed.len() <= ends, "{}: {changed:?}\n{}", part.name, written.text());
    let moves = |line: &str| line.to_uppercase().contains('X') || line.to_uppercase().contains('Y');
    assert!(changed.iter().all(|(_, line)| moves(line)), "{}: {changed:?}\n{}", part.name, written.text());
}

#[test]
fn every_part_cuts_its_plan_and_keeps_its_other_lines() {
    for part in PARTS {
        for (plan, name) in [(radial as Plan, "radial"), (levels, "levels")] {
            let written = shown(part.written(plan));
            let off = written.cuts_as_planned(&part);
            println!("{}, {name}: {off:.5} mm from the plan", part.name);
            assert!(off <= 0.0011, "{}: {off} mm\n{}", part.name, written.text());
            others_are_kept(&part, &written);
            let count = written.passes.len();
            for k in 1..=count {
                let remark = format!("TRUEPATH PASS {k} OF {count}");
                assert_eq!(written.text().matches(&remark).count(), written.program.depths.len(), "{}", written.text());
            }
        }
    }
}

#[test]
fn a_plan_of_one_pass_that_moves_nothing_is_the_program_itself() {
    let written = shown(POCKET.written(|path| vec![unmoved(path)]));
    let heads = ["(TRUEPATH", "(ORIGINAL", "(JOB", "(PROBE", "(WRITTEN", "(DO NOT", "(PLANNED"];
    let kept = written.text().lines().filter(|line| !heads.iter().any(|head| line.starts_with(head)));
    let plain = |line: &str| line.replace(". ", " ").trim_end_matches('.').to_owned();
    // The moves are written anew, with both coordinates; what they lead along is the same.
    let numbers = |line: &str| plain(line).split(' ').count();
    assert_eq!(kept.clone().count(), POCKET.program.lines().count() + 1, "{}", written.text());
    assert!(kept.clone().any(|line| line == "(left)") && kept.map(numbers).sum::<usize>() > 60);
    assert!(written.cuts_as_planned(&POCKET) <= 1e-6);
}

#[test]
fn the_cutter_goes_from_pass_to_pass_at_the_height_to_which_the_program_goes_up() {
    let written =
        shown(CORNER.written(|path| vec![pass(path, 0.1, 0.0, false, 1.0), pass(path, 0.0, 0.0, false, 1.0)]));
    let link: Vec<&str> = written.text().lines().skip_while(|line| !line.contains("PASS 2 OF 2")).take(5).collect();
    assert_eq!(link[1], "G00 Z100.", "{}", written.text());
    assert!(link[2].starts_with("G00 X33.9") && link[2].ends_with("Y80."), "{link:?}");
    assert_eq!(link[3..], ["G00 Z10.", "G01 Z-15. F400."]);
}

#[test]
fn where_a_pass_begins_at_the_end_of_the_one_before_it_comes_down_where_that_has_cut() {
    let written = shown(CORNER.written(radial));
    let link: Vec<&str> = written.text().lines().skip_while(|line| !line.contains("PASS 2 OF 2")).take(5).collect();
    // No move in X and Y before it is down; then a step across what is left, at the feed of the pass.
    assert_eq!(link[1..4], ["G00 Z10.", "G01 Z-15. F400.", "G01 X90. Y29.9993 F125."], "{}", written.text());
    let before = written.text().lines().take_while(|line| !line.contains("PASS 2 OF 2")).last();
    assert_eq!(before, Some("G01 X90. Y30.1493"));
}

#[test]
fn a_reversed_pass_under_wear_has_the_other_code_along_a_lead_of_full_length() {
    let written = shown(WEAR.written(radial));
    let pass: Vec<&str> = written.text().lines().skip_while(|line| !line.contains("PASS 2 OF 2")).collect();
    let switched: Vec<&&str> = pass.iter().filter(|line| line.starts_with("G42")).collect();
    // Not along the 0.15 mm between the two passes, which no control would take for a lead.
    assert!(switched.len() == 1 && switched[0].starts_with("G42 D03 G01 X-12."), "{switched:?}");
    assert_eq!(written.text().matches("G41 D03").count(), 1);
    assert_eq!(written.text().matches("G40 G01").count(), 2);
}

#[test]
fn the_head_and_the_report_name_what_was_done() {
    let written = shown(SPRING.written(radial));
    let report = &written.program.report;
    for part in [
        "lines 7-19 of the original became 2 passes",
        "against the programmed direction, feed 50 %",
        "largest deviation",
    ] {
        assert!(report.contains(part), "{report}");
    }
    assert!(truepath_core::gcode::is_marked_corrected(&written.program.text));
    let crc = truepath_core::gcode::program_crc(SPRING.program.as_bytes());
    assert!(
        written.text().contains(&format!("ORIGINAL CRC32 {crc:08X}")) && written.text().contains("PLANNED: 2 PASSES")
    );
}

#[test]
fn depths_in_a_subprogram_are_written_out_and_said_to_be() {
    let written = shown(SUBPROGRAM.written(radial));
    assert_eq!(written.program.depths.iter().map(|d| d.z_mm[0]).collect::<Vec<_>>(), [-4.0, -8.0, -12.0]);
    assert!(written.program.warnings[0].contains("written out"), "{:?}", written.program.warnings);
    assert!(!written.text().contains("M98"));
}
