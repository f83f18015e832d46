//! The same five points of one wall in every format give the same contacts; what is not used is set aside.

use truepath_core::units::Offset;
use truepath_ground::diagnostics::Form;
use truepath_ground::length::Unit;
use truepath_job::refusal::why;

use crate::probe_files::{MACHINE, SURFACE, file, named, read, replaced};

/// File, format, and how exactly its digits tell the place, nm.
fn formats() -> Vec<(&'static str, String, i64)> {
    vec![
        ("linuxcnc.txt", named("linuxcnc"), 0),
        ("linuxcnc-log.txt", named("linuxcnc-log"), 0),
        ("linuxcnc-log-inch.txt", named("linuxcnc-log"), 13),
        ("grbl.txt", named("grbl"), 0),
        ("grbl-inch.txt", named("grbl"), 3_000),
        ("grbl-four-decimals.txt", named("grbl"), 3_000),
        ("inspection.txt", named("inspection"), 0),
        ("dprnt.txt", named("dprnt"), 60),
        ("dprnt-words.txt", named("dprnt"), 600),
        ("columns-centre.csv", named("columns"), 0),
        ("columns-machine-surface.csv", MACHINE.to_owned(), 1),
        ("columns-surface.csv", SURFACE.to_owned(), 60),
    ]
}

/// Contact x and y, nm; height above the tip, nm; error, nm.
const EXPECTED: [[i64; 4]; 5] = [
    [24_080_000, 60_000_000, 5_000_000, 80_000],
    [24_090_000, 50_000_000, 7_000_000, 90_000],
    // 39 − 15 mm·√½ and 35 − 15 mm·√½, moved out of the wall by 15 − 8.415·√2 − 3 mm.
    [28_463_680, 24_463_680, 5_000_000, 99_393],
    [61_100_000, 20_090_000, 5_000_000, 90_000],
    [70_000_000, 20_080_000, 3_000_000, 80_000],
];

#[test]
fn the_same_points_give_the_same_contacts_in_every_format() {
    for (name, format, digits) in formats() {
        let measurement =
            read(&format, "6.0", file(name)).unwrap_or_else(|e| panic!("{name}: {}", e.render(Form::Plain)));
        assert_eq!(measurement.contacts.len(), 5, "{name}");
        for (contact, expected) in measurement.contacts.iter().zip(EXPECTED) {
            let height = Offset::from_mm(contact.height).nm() * 10;
            let found = [contact.point.x.nm(), contact.point.y.nm(), height, contact.error.nm()];
            // Half a nanometre of rounding in each step, and what the digits of the file leave open.
            let near = found.iter().zip(expected).all(|(a, b)| (a - b).abs() <= digits + 10);
            assert!(near, "{name}: {found:?} instead of {expected:?}");
        }
    }
}

#[test]
fn misses_and_first_touches_are_set_aside_with_their_line() {
    let aside = |name: &str, format: &str| {
        let measurement = read(&named(format), "6.0", file(name)).unwrap();
        measurement.rejected.iter().map(|a| (a.line, why(&a.reason, Unit::Millimetre))).collect::<Vec<_>>()
    };
    let miss = || "a miss: the probe did not touch".to_owned();
    assert_eq!(aside("linuxcnc-log.txt", "linuxcnc-log"), [(11, miss())]);
    assert_eq!(aside("inspection.txt", "inspection"), [(19, miss())]);
    assert_eq!(aside("dprnt.txt", "dprnt"), [(17, miss())]);
    assert_eq!(aside("columns-centre.csv", "columns"), [(7, miss())]);
    // PROBEOPEN does not say that it missed.
    let [(6, reason)] = &aside("linuxcnc.txt", "linuxcnc")[..] else { panic!("line 6 is a miss") };
    assert_eq!(reason, "-4.000 mm from the nominal wall");
    let grbl = aside("grbl.txt", "grbl");
    let approach = "an approach: the next touch is of the same place and counts";
    assert_eq!(grbl.iter().filter(|(_, why)| why == approach).count(), 5, "{grbl:?}");
    assert_eq!(grbl.last().map(|(_, why)| why.clone()), Some(miss()));
}

#[test]
fn a_point_that_stands_twice_in_the_file_counts_once() {
    let mut text = file("linuxcnc.txt");
    text.extend(file("linuxcnc.txt"));
    let measurement = read(&named("linuxcnc"), "6.0", text).unwrap();
    assert_eq!(measurement.contacts.len(), 5);
    let repeats: Vec<_> = measurement
        .rejected
        .iter()
        .filter(|a| why(&a.reason, Unit::Millimetre).starts_with("the same point as in line "))
        .map(|a| a.line)
        .collect();
    assert_eq!(repeats, [7, 8, 9, 10, 11]);
}

#[test]
fn a_normal_of_another_wall_sets_its_point_aside() {
    let bytes =
        replaced("columns-centre.csv", "27.080,60.000,-10.000,1.000000,0.000000", "27.080,60.000,-10.000,0.8,0.6");
    let measurement = read(&named("columns"), "6.0", bytes).unwrap();
    assert_eq!(measurement.contacts.len(), 4);
    assert_eq!(
        why(&measurement.rejected[0].reason, Unit::Millimetre),
        "its normal in the file is more than 30 degrees off that of the nearest wall"
    );
}

#[test]
fn a_work_offset_in_the_job_stands_in_for_one_that_the_log_lacks() {
    let format = "format = \"grbl\"\nwork_offset_mm = [-372.5, -250.25, -412]";
    let measurement = read(format, "6.0", file("grbl-no-offset.txt")).unwrap();
    assert_eq!(measurement.contacts.iter().map(|c| c.error.nm()).collect::<Vec<_>>(), EXPECTED.map(|e| e[3]));
}
