//! Programs executed beside a wall with a known error; what they print gives that error back.

use truepath::diagnostics::Source;
use truepath::measurement::Measurement;
use truepath::pass::Pass;
use truepath::verification::{Dialect, Settings, write};

use super::control::{Control, Printed};
use super::parts::{PARTS, POCKET, pass, planned, pocket_in_inches};
use super::wall::Wall;

/// Material left along the wall, mm.
fn error(s: f64) -> f64 {
    0.18 + 0.12 * (s / 9.0).sin()
}

/// Executes the program of a pass beside its wall.
fn touched(pass: &Pass, dialect: Dialect, error: impl Fn(f64) -> f64) -> Result<Printed, String> {
    let plan = planned(pass, &Settings::default());
    let program = write(&plan, dialect, "log.txt").unwrap();
    Control::new(&Wall::of(pass, error), plan.ball_mm / 2.0).run(&program)
}

/// The readings of a LinuxCNC log as PROBEOPEN would have them.
fn probeopen(log: &str) -> String {
    let points = log.lines().filter(|l| !l.starts_with('#')).map(|l| l.split(',').collect::<Vec<_>>());
    points.map(|p| format!("{} {} {} 0 0 0 0 0 0\n", p[5], p[6], p[7])).collect()
}

#[test]
fn what_a_linuxcnc_program_logs_gives_the_wall_error_back() {
    for part in PARTS {
        let pass = pass(part, &[]);
        let printed = touched(&pass, Dialect::Linuxcnc, error).unwrap();
        assert_eq!(printed.touches, 48, "two touches a point");
        assert!(printed.text.ends_with("# end 24\n"));
        recovered(&pass, &probeopen(&printed.text));
    }
}

fn recovered(pass: &Pass, text: &str) {
    let measurement = Measurement::read(pass, &Source::new("probe.txt", text.as_bytes().to_vec())).unwrap();
    assert_eq!((measurement.contacts.len(), measurement.rejected.len()), (24, 0));
    for contact in &measurement.contacts {
        let s = contact.s.nm() as f64 / 1e6;
        let found = contact.error.nm() as f64 / 1e6;
        assert!((found - error(s)).abs() < 0.002, "s = {s}: {found} instead of {}", error(s));
    }
}

#[test]
fn inches_come_back_as_inches() {
    let inches = pocket_in_inches();
    let pass = pass([&inches[0], &inches[1]], &[]);
    recovered(&pass, &probeopen(&touched(&pass, Dialect::Linuxcnc, error).unwrap().text));
}

#[test]
fn every_control_finds_the_wall_at_every_point() {
    let pass = pass(POCKET, &[]);
    let points = |printed: &Printed| printed.text.lines().filter(|l| l.starts_with("G801")).count();
    let haas = touched(&pass, Dialect::Haas, error).unwrap();
    assert_eq!((haas.touches, points(&haas)), (24, 24));
    let fanuc = touched(&pass, Dialect::Fanuc, error).unwrap();
    assert_eq!((fanuc.touches, points(&fanuc)), (48, 24));
    let grbl = touched(&pass, Dialect::Grbl, error).unwrap();
    assert_eq!(grbl.touches, 48);
    assert_eq!(grbl.console.lines().filter(|l| l.ends_with(":1]")).count(), 48);
}

#[test]
fn a_wall_that_is_not_there_is_a_miss_and_not_a_reading() {
    let pass = pass(POCKET, &[]);
    // Cut 3 mm too deep on the second half.
    let gone = |s: f64| if s > 100.0 { -3.0 } else { 0.1 };
    let linuxcnc = touched(&pass, Dialect::Linuxcnc, gone).unwrap();
    let hits = linuxcnc.text.lines().filter(|l| l.ends_with(",1.000000")).count();
    let misses = linuxcnc.text.lines().filter(|l| l.ends_with(",0.000000")).count();
    assert!(hits > 0 && misses > 0 && hits + misses == 24, "{}", linuxcnc.text);
    let fanuc = touched(&pass, Dialect::Fanuc, gone).unwrap();
    assert_eq!(fanuc.text.lines().filter(|l| l.starts_with("G800")).count(), 24);
    assert_eq!(fanuc.text.lines().filter(|l| l.starts_with("G801")).count(), hits);
    assert!(
        touched(&pass, Dialect::Haas, gone).unwrap_err().contains("no surface found"),
        "Inspection Plus stops by itself"
    );
}

#[test]
fn a_wall_in_the_way_down_stops_every_program() {
    let pass = pass(POCKET, &[]);
    // 2.5 mm left: the ball's stand-off is 2 mm before the nominal wall.
    for dialect in [Dialect::Linuxcnc, Dialect::Grbl, Dialect::Fanuc, Dialect::Haas] {
        let stopped = touched(&pass, dialect, |_| 2.5);
        assert!(stopped.is_err(), "{dialect:?}: {stopped:?}");
    }
}
