//! The same five points of one wall in every format give the same contacts; a file in the wrong frame or unit, cut off,
//! or of another ball or program is refused with the right words.

use std::path::Path;

use truepath::diagnostics::{Failure, Form, Source};
use truepath::job::Job;
use truepath::measurement::Measurement;
use truepath::pass::Pass;
use truepath::refusal::why;
use truepath_core::units::Offset;

const PROGRAM: &str = include_str!("../demo/corner/program.nc");
const JOB: &str = include_str!("../demo/corner/job.toml");

/// Bytes of a probe file of `data/probe`.
fn file(name: &str) -> Vec<u8> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/probe").join(name);
    std::fs::read(&path).unwrap_or_else(|e| panic!("{}: {e}", path.display()))
}

/// The corner probed in a format, with the ball of the job replaced.
fn pass(format: &str, ball: &str) -> Pass {
    let job = JOB.replace("format = \"linuxcnc\"", format);
    let job = job.replace("ball_diameter_mm = 6.0", &format!("ball_diameter_mm = {ball}"));
    let job = Job::parse(Source::new("job.toml", job.into_bytes()), Path::new("")).unwrap();
    Pass::new(job, Source::new("program.nc", PROGRAM.as_bytes().to_vec())).unwrap()
}

fn read(format: &str, ball: &str, bytes: Vec<u8>) -> Result<Measurement, Failure> {
    Measurement::read(&pass(format, ball), &Source::new("probe.txt", bytes))
}

fn named(format: &str) -> String {
    format!("format = \"{format}\"")
}

const MACHINE: &str = "format = \"columns\"\ncolumns = \"z,x,y\"\nseparator = \"semicolon\"\ndecimal = \"comma\"\n\
                       frame = \"machine\"\npoint = \"surface\"\nwork_offset_mm = [-372.5, -250.25, -412]";
const SURFACE: &str = "format = \"columns\"\npoint = \"surface\"";

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
        measurement.rejected.iter().map(|a| (a.line, why(&a.reason))).collect::<Vec<_>>()
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
        .filter(|a| why(&a.reason).starts_with("the same point as in line "))
        .map(|a| a.line)
        .collect();
    assert_eq!(repeats, [7, 8, 9, 10, 11]);
}

fn replaced(name: &str, from: &str, to: &str) -> Vec<u8> {
    let text = file(name);
    let text: String = text.iter().map(|b| char::from(*b)).collect();
    assert!(text.contains(from), "{name} has no `{from}`");
    text.replace(from, to).chars().map(|c| c as u8).collect()
}

/// File, format, ball, code, line, and words of the message.
type Case = (&'static str, Vec<u8>, String, &'static str, &'static str, usize, &'static str);

#[test]
fn wrong_frame_and_wrong_unit_are_refused_in_every_format() {
    let shift = "they fit when about X -372.4 and Y -250.2 mm are taken off all of them: they are in another frame";
    let case = |name: &'static str, format: &str, code, line, words| -> Case {
        (name, file(name), named(format), "6.0", code, line, words)
    };
    let inches = "they fit when read as inches";
    let millimetres = "they fit when read as millimetres";
    let cases = vec![
        case("linuxcnc-frame.txt", "linuxcnc", "M014", 1, shift),
        case("linuxcnc-unit.txt", "linuxcnc", "M011", 1, inches),
        case("linuxcnc-log-frame.txt", "linuxcnc-log", "M014", 6, shift),
        case("linuxcnc-log-unit.txt", "linuxcnc-log", "M012", 6, millimetres),
        case("grbl-frame.txt", "grbl", "M014", 24, "they fit when about X -272.4 and Y -150.2 mm are taken off all of them"),
        case("grbl-no-offset.txt", "grbl", "M030", 11, "machine coordinates, and the work offset G54 is not known"),
        case("grbl-unit.txt", "grbl", "M012", 24, millimetres),
        case("inspection-frame.txt", "inspection", "M014", 10, shift),
        case(
            "inspection-unit.txt",
            "inspection",
            "M010",
            10,
            "the ball has a diameter of 0.2362 mm here; expected 6.0000 mm",
        ),
        case("dprnt-frame.txt", "dprnt", "M014", 8, shift),
        case("dprnt-unit.txt", "dprnt", "M011", 8, inches),
        case("columns-frame.csv", "columns", "M014", 2, shift),
        case("columns-unit.csv", "columns", "M011", 2, inches),
    ];
    refused(cases);
}

fn refused(cases: Vec<Case>) {
    for (name, bytes, format, ball, code, row, words) in cases {
        let Err(Failure::Input(error)) = read(&format, ball, bytes) else {
            panic!("{name} with `{words}` was accepted")
        };
        assert_eq!(error.code(), code, "{name}: {error}");
        assert!(error.to_string().contains(words), "{name}: {error}");
        assert_eq!(error.line_column().map(|p| p.0), Some(row), "{name}: {error}");
        let shown = Failure::Input(error).render(Form::Plain);
        assert!(shown.contains("help: ") && shown.contains(&format!("probe.txt:{row}:")), "{name}: {shown}");
    }
}

#[test]
fn files_cut_off_damaged_or_of_another_job_are_refused() {
    let log = || named("linuxcnc-log");
    let insp = || named("inspection");
    let dprnt = || named("dprnt");
    let grbl = || named("grbl");
    let change = |name: &'static str, from: &str, to: &str, format: String, code, line, words| -> Case {
        (name, replaced(name, from, to), format, "6.0", code, line, words)
    };
    let same = |name: &'static str, format: String, code, line, words| -> Case {
        (name, file(name), format, "6.0", code, line, words)
    };
    refused(vec![
        change("linuxcnc-log.txt", "# end 6\n", "", log(), "M007", 11, "the file was cut off here"),
        change("linuxcnc-log.txt", "# end 6", "# end 7", log(), "M008", 12, "6 points stand in the file; expected 7"),
        change(
            "linuxcnc-log.txt",
            "# points 6",
            "# points 9",
            log(),
            "M008",
            12,
            "6 points stand in the file; expected 9",
        ),
        change(
            "linuxcnc-log.txt",
            "# ball 6.0000",
            "# ball 3.0000",
            log(),
            "M010",
            4,
            "3.0000 mm here; expected 6.0000 mm",
        ),
        change("linuxcnc-log.txt", "# program 2", "# program 3", log(), "M009", 2, "expected program 2"),
        change("linuxcnc-log.txt", "# unit mm", "# unit cm", log(), "M033", 3, "expected `unit mm` or `unit inch`"),
        change("linuxcnc-log.txt", ",0.707107,0.707107,", ",7.07107,0.707107,", log(), "M036", 8, "not a normal"),
        change("linuxcnc-log.txt", "1.000000\n2.", "0.500000\n2.", log(), "M033", 6, "expected hit 1 or 0"),
        change(
            "linuxcnc-log.txt",
            "\n5.000000,",
            "\n5.000000,1,",
            log(),
            "M003",
            10,
            "found 10 numbers in this line; expected 9",
        ),
        same("inspection-cut-off.txt", insp(), "M007", 19, "expected END as its last line"),
        same("dprnt-cut-off.txt", dprnt(), "M007", 17, "expected END as its last line"),
        change(
            "inspection.txt",
            "G801 N2",
            "G801 N4",
            insp(),
            "M035",
            12,
            "point 4 is measured here; expected point 2",
        ),
        change("inspection.txt", "R3.", "R6.", insp(), "M010", 10, "12.0000 mm here; expected 6.0000 mm"),
        change("inspection.txt", "Z-8. R3.", "R3.", insp(), "M034", 12, "this line has no Z"),
        change("inspection.txt", "X27.09", "X2?.09", insp(), "M033", 12, "expected words such as X12.345"),
        change("inspection.txt", "START\n", "", insp(), "M033", 8, "expected START before the first point"),
        change("inspection.txt", "G801 N3", "G81 N3", insp(), "M033", 14, "expected START, G800, G801 or END"),
        change("dprnt.txt", "END    6", "END    5", dprnt(), "M008", 18, "6 points stand in the file; expected 5"),
        change("dprnt-words.txt", "Z-10.000", "", dprnt(), "M034", 1, "this line has no Z"),
        change(
            "grbl.txt",
            "[PRB:-345.420,-190.250,-422.000:1]",
            "[PRB:-345.420,-190.2",
            grbl(),
            "M033",
            27,
            "expected [PRB:x,y,z:1]",
        ),
        change("grbl.txt", "[G92:", "[G54:", grbl(), "M031", 16, "[G54:…] has two values"),
        change("grbl-four-decimals.txt", "[PRB:-13.5992,", "[PRB:-13.599,", grbl(), "M032", 22, "cannot be told"),
        change("columns-centre.csv", "z_mm", "height", named("columns"), "M004", 1, "the header names no column for z"),
        change("columns-centre.csv", "x_mm", "x_inch", named("columns"), "M037", 1, "the header names another unit"),
    ]);
}

#[test]
fn mistakes_of_point_ball_axes_and_normals_are_named() {
    let case = |name: &'static str, bytes: Vec<u8>, format: &str, ball: &'static str, code, line, words| -> Case {
        (name, bytes, format.to_owned(), ball, code, line, words)
    };
    let columns = named("columns");
    let swapped = file("columns-centre.csv");
    let swapped =
        String::from_utf8(swapped).unwrap().replace("x_mm,y_mm", "y_mm,x_mm").replace("nx,ny", "a,b").into_bytes();
    let mirrored = String::from_utf8(file("linuxcnc.txt")).unwrap();
    let mirrored: String = mirrored.lines().map(|line| format!("-{line}\n")).collect();
    let turned = replaced("columns-centre.csv", "1.000000,", "-1.000000,");
    let turned =
        String::from_utf8(turned).unwrap().replace(",1.000000", ",-1.000000").replace("0.7", "-0.7").into_bytes();
    refused(vec![
        case(
            "columns-surface.csv",
            file("columns-surface.csv"),
            &columns,
            "6.0",
            "M013",
            2,
            "they fit as surface points",
        ),
        case("columns-centre.csv", file("columns-centre.csv"), SURFACE, "6.0", "M017", 2, "they fit as ball centres"),
        case(
            "linuxcnc.txt",
            file("linuxcnc.txt"),
            &named("linuxcnc"),
            "3.0",
            "M013",
            1,
            "they fit with a ball twice as large",
        ),
        case(
            "linuxcnc.txt",
            file("linuxcnc.txt"),
            &named("linuxcnc"),
            "12.0",
            "M013",
            1,
            "they fit with a ball half as large",
        ),
        case("swapped", swapped, &columns, "6.0", "M018", 2, "they fit with X and Y exchanged"),
        case(
            "mirrored",
            mirrored.into_bytes(),
            &named("linuxcnc"),
            "6.0",
            "M019",
            1,
            "they fit with the sign of X turned",
        ),
        case("turned", turned, &columns, "6.0", "M021", 2, "the normals in the file point into the wall"),
    ]);
}

#[test]
fn a_normal_of_another_wall_sets_its_point_aside() {
    let bytes =
        replaced("columns-centre.csv", "27.080,60.000,-10.000,1.000000,0.000000", "27.080,60.000,-10.000,0.8,0.6");
    let measurement = read(&named("columns"), "6.0", bytes).unwrap();
    assert_eq!(measurement.contacts.len(), 4);
    assert_eq!(
        why(&measurement.rejected[0].reason),
        "its normal in the file is more than 30 degrees off that of the nearest wall"
    );
}

#[test]
fn a_work_offset_in_the_job_stands_in_for_one_that_the_log_lacks() {
    let format = "format = \"grbl\"\nwork_offset_mm = [-372.5, -250.25, -412]";
    let measurement = read(format, "6.0", file("grbl-no-offset.txt")).unwrap();
    assert_eq!(measurement.contacts.iter().map(|c| c.error.nm()).collect::<Vec<_>>(), EXPECTED.map(|e| e[3]));
}
