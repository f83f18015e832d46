//! Probe files in the wrong frame or unit, cut off, damaged, or of another ball or program are refused with the right words.

use truepath_ground::diagnostics::{Failure, Form};

use crate::probe_files::{SURFACE, file, named, read, replaced};

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
        case(
            "grbl-frame.txt",
            "grbl",
            "M014",
            27,
            "they fit when about X -272.4 and Y -150.2 mm are taken off all of them",
        ),
        case("grbl-no-offset.txt", "grbl", "M030", 11, "machine coordinates, and the work offset G54 is not known"),
        case("grbl-unit.txt", "grbl", "M012", 27, millimetres),
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
