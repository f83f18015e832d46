//! Programs executed beside a wall with a known error; what they print gives that error back.

use truepath_correction::verification::{ProbeDialect, Settings, write};
use truepath_ground::diagnostics::Source;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_trial::probing::{Control, Printed};

use super::parts::{PARTS, POCKET, pass, planned, pocket_in_inches};
use super::wall::Wall;

/// Material left along the wall, mm.
fn error(s: f64) -> f64 {
    0.18 + 0.12 * (s / 9.0).sin()
}

/// Executes the program of a pass beside its wall.
fn touched(pass: &Pass, dialect: ProbeDialect, error: impl Fn(f64) -> f64) -> Result<Printed, String> {
    let plan = planned(pass, &Settings::default());
    let program = write(&plan, dialect, "log.txt").unwrap();
    Control::new(&mut Wall::of(pass, error), plan.ball_mm / 2.0).run(&program)
}

/// The same pass, its job saying that the probe file is of this dialect.
fn read_as(part: [&str; 2], dialect: ProbeDialect) -> Pass {
    pass(part, &[("format = \"linuxcnc\"", &format!("format = \"{}\"", dialect.probe_format()))])
}

fn recovered(pass: &Pass, text: &str) -> Measurement {
    let file = Source::new("probe.txt", text.as_bytes().to_vec());
    let measurement = Measurement::read(pass, &file).unwrap_or_else(|e| panic!("{e}\n{text}"));
    assert_eq!(measurement.contacts.len(), 24, "{:?}", measurement.remarks(&file));
    for contact in &measurement.contacts {
        let s = contact.s.nm() as f64 / 1e6;
        let found = contact.error.nm() as f64 / 1e6;
        assert!((found - error(s)).abs() < 0.002, "s = {s}: {found} instead of {}", error(s));
    }
    measurement
}

#[test]
fn what_every_program_prints_gives_the_wall_error_back() {
    for part in PARTS {
        for dialect in [ProbeDialect::Linuxcnc, ProbeDialect::Grbl, ProbeDialect::Fanuc, ProbeDialect::Haas] {
            let printed = touched(&pass(part, &[]), dialect, error).unwrap();
            let measurement = recovered(&read_as(part, dialect), &printed.file());
            // Of grbl's reports those of the way down and of the first touch are set aside: they were not the measurement.
            let aside = if dialect == ProbeDialect::Grbl { 48 } else { 0 };
            assert_eq!(measurement.rejected.len(), aside, "{dialect:?}");
        }
    }
}

#[test]
fn results_of_another_part_or_cut_off_are_refused() {
    let printed = |dialect| touched(&pass(POCKET, &[]), dialect, error).unwrap().file();
    for (dialect, footer) in
        [(ProbeDialect::Linuxcnc, "# end 24"), (ProbeDialect::Haas, "END 24"), (ProbeDialect::Fanuc, "END 24")]
    {
        let text = printed(dialect);
        let refused = |pass: &Pass, text: &str| {
            Measurement::read(pass, &Source::new("probe.txt", text.as_bytes().to_vec())).unwrap_err().to_string()
        };
        let cut = text.split(footer).next().unwrap();
        assert!(refused(&read_as(POCKET, dialect), cut).contains("cut off"), "{dialect:?}");
        let other = [POCKET[0], &POCKET[1].replace("S3200", "S3201")];
        assert!(refused(&read_as(other, dialect), &text).contains("program"), "{dialect:?}");
    }
}

#[test]
fn inches_come_back_as_inches() {
    let inches = pocket_in_inches();
    let inches = [inches[0].as_str(), inches[1].as_str()];
    for dialect in [ProbeDialect::Linuxcnc, ProbeDialect::Haas, ProbeDialect::Fanuc] {
        let printed = touched(&pass(inches, &[]), dialect, error).unwrap();
        recovered(&read_as(inches, dialect), &printed.file());
    }
}

#[test]
fn every_control_finds_the_wall_at_every_point() {
    let pass = pass(POCKET, &[]);
    let points = |printed: &Printed| printed.text.lines().filter(|l| l.starts_with("G801")).count();
    let haas = touched(&pass, ProbeDialect::Haas, error).unwrap();
    assert_eq!((haas.touches, points(&haas)), (24, 24));
    let fanuc = touched(&pass, ProbeDialect::Fanuc, error).unwrap();
    assert_eq!((fanuc.touches, points(&fanuc)), (48, 24));
    let grbl = touched(&pass, ProbeDialect::Grbl, error).unwrap();
    assert_eq!(grbl.touches, 48);
    assert_eq!(grbl.console.lines().filter(|l| l.ends_with(":1]")).count(), 48);
}

#[test]
fn a_wall_that_is_not_there_is_a_miss_and_not_a_reading() {
    let pass = pass(POCKET, &[]);
    // Cut 3 mm too deep on the second half.
    let gone = |s: f64| if s > 100.0 { -3.0 } else { 0.1 };
    let linuxcnc = touched(&pass, ProbeDialect::Linuxcnc, gone).unwrap();
    let hits = linuxcnc.text.lines().filter(|l| l.ends_with(",1.000000")).count();
    let misses = linuxcnc.text.lines().filter(|l| l.ends_with(",0.000000")).count();
    assert!(hits > 0 && misses > 0 && hits + misses == 24, "{}", linuxcnc.text);
    let fanuc = touched(&pass, ProbeDialect::Fanuc, gone).unwrap();
    assert_eq!(fanuc.text.lines().filter(|l| l.starts_with("G800")).count(), 24);
    assert_eq!(fanuc.text.lines().filter(|l| l.starts_with("G801")).count(), hits);
    assert!(
        touched(&pass, ProbeDialect::Haas, gone).unwrap_err().contains("no surface found"),
        "Inspection Plus stops by itself"
    );
}

#[test]
fn a_wall_in_the_way_down_stops_every_program() {
    let pass = pass(POCKET, &[]);
    // 2.5 mm left: the ball's stand-off is 2 mm before the nominal wall.
    for dialect in [ProbeDialect::Linuxcnc, ProbeDialect::Grbl, ProbeDialect::Fanuc, ProbeDialect::Haas] {
        let stopped = touched(&pass, dialect, |_| 2.5);
        assert!(stopped.is_err(), "{dialect:?}: {stopped:?}");
    }
}
