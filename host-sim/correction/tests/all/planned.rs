//! Every part with the plans that a search may choose.

use truepath_core::cut::Path;
use truepath_correction::planned::PlannedPass;

use super::parts::*;

const PARTS: [Part; 9] = [CORNER, POCKET, HAAS, WEAR, INCH, G64, SIEMENS, SPRING, SUBPROGRAM];

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
        for (plan, name) in [(radial as fn(&Path<'_>) -> _, "radial"), (levels, "levels")] {
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
fn print_them() {
    for part in PARTS {
        for plan in [radial as fn(&Path<'_>) -> _, levels] {
            let written = shown(part.written(plan));
            println!("=== {}\n{}\n{}\n{:?}", part.name, written.text(), written.program.report, written.program.warnings);
        }
    }
}
