//! The LinuxCNC program through LinuxCNC's own interpreter, when it is installed.
//!
//! `rs274` stands alone: its probing moves touch nothing, and after one it believes the axes 0.254 mm before the end. So
//! heights are compared with that slack, and every point is a miss. It prints four decimals, 0.0001 in as well.

use std::process::{Command, Stdio};

use truepath_correction::verification::{Plan, ProbeDialect, Settings, write};

use super::parts::{PARTS, pass, planned, pocket_in_inches};

/// What the interpreter says; `None` when it is not installed.
fn interpreted(program: &str) -> Option<(String, String)> {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("verify.ngc"), program).unwrap();
    std::fs::write(folder.path().join("tool.tbl"), "T20 P20 Z55 D6\n").unwrap();
    let mut command = Command::new("rs274");
    // The interpreter keeps its tool table in a file in the home folder, which others may be using.
    command.env("HOME", folder.path());
    command.args(["-t", "tool.tbl", "-g", "verify.ngc"]).current_dir(folder.path()).stdin(Stdio::null());
    match command.output() {
        Ok(output) => {
            let text = |bytes| String::from_utf8(bytes).unwrap();
            Some((text(output.stdout), text(output.stderr)))
        }
        Err(error) if error.kind() == std::io::ErrorKind::NotFound => {
            eprintln!("skipped: rs274 of LinuxCNC is not installed");
            None
        }
        Err(error) => panic!("{error}"),
    }
}

/// The numbers in the call of a line.
fn numbers(line: &str) -> Vec<f64> {
    let inside = line.split_once('(').unwrap().1.trim_end_matches([')', '"']).trim_start_matches('"');
    inside.split(',').filter_map(|n| n.trim().parse().ok()).collect()
}

fn agrees(plan: &Plan, said: &str, unit: f64) {
    let searches: Vec<Vec<f64>> = said.lines().filter(|l| l.contains(" STRAIGHT_PROBE(")).map(numbers).collect();
    assert_eq!(searches.len(), 3 * plan.touches().count(), "down, fast, slow");
    let logged: Vec<Vec<f64>> =
        said.lines().filter(|l| l.contains(" LOG(\"") && !l.contains('#')).map(numbers).collect();
    assert_eq!(logged.len(), plan.touches().count());
    let near = |a: f64, b: f64, slack: f64| assert!((a * unit - b).abs() < slack, "{} instead of {b}", a * unit);
    for (touch, (moves, logged)) in plan.touches().zip(searches.chunks(3).zip(&logged)) {
        let (from, to) = (plan.stand_off(touch.place), plan.search_end(touch.place));
        for (number, expected) in moves.iter().zip([from, to, to]) {
            near(number[0], expected[0], 0.002);
            near(number[1], expected[1], 0.002);
            near(number[2], touch.height.z_mm, 0.256);
        }
        assert_eq!((logged[0], logged[8]), (touch.id as f64, 0.0));
        near(logged[3], touch.place.wall[0], 0.001);
        near(logged[5], to[0], 0.001);
        near(logged[6], to[1], 0.001);
    }
}

#[test]
fn linuxcnc_accepts_the_program_without_a_message_and_moves_as_planned() {
    for part in PARTS {
        for probe_tool in [None, Some(20)] {
            let plan = planned(&pass(part, &[]), &Settings { probe_tool, ..Settings::default() });
            let Some((said, message)) = interpreted(&write(&plan, ProbeDialect::Linuxcnc, "log.txt").unwrap()) else {
                return;
            };
            assert_eq!(message.trim(), "executing", "a message of the interpreter");
            assert!(said.contains("PROGRAM_END()") && said.contains("LOG(\"# end 24\")"), "{said}");
            agrees(&plan, &said, 1.0);
        }
    }
}

#[test]
fn linuxcnc_accepts_the_program_in_inches() {
    let inches = pocket_in_inches();
    let plan = planned(&pass([&inches[0], &inches[1]], &[]), &Settings::default());
    let Some((said, message)) = interpreted(&write(&plan, ProbeDialect::Linuxcnc, "log.txt").unwrap()) else { return };
    assert_eq!(message.trim(), "executing");
    agrees(&plan, &said, 25.4);
}
