//! Probe files of every kind: read, set aside with a reason, or refused with the right words.

use std::path::Path;

use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::job::JobFile;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

const PROGRAM: &str = include_str!("../../../demo/corner/program.nc");
const JOB: &str = include_str!("../../../demo/corner/job.toml");

/// The corner's pass, with changes to the job and a program in another unit if wanted.
fn pass(change: &[(&str, &str)], program: &str) -> Pass {
    let mut job = JOB.to_owned();
    for (from, to) in change {
        assert!(job.contains(from), "the job has no `{from}`");
        job = job.replace(from, to);
    }
    let job = JobFile::parse(Source::new("job.toml", job.into_bytes()), Path::new("")).unwrap();
    Pass::new(job, Source::new("program.nc", program.as_bytes().to_vec())).unwrap()
}

fn read(pass: &Pass, text: &str) -> Result<Measurement, Failure> {
    Measurement::read(pass, &Source::new("probe.txt", text.as_bytes().to_vec()))
}

/// Contact 0.09 mm short of the wall at X24, ball of 6 mm: centre at X27.09.
fn line(x: f64, y: f64, z: f64) -> String {
    format!("{x:.6} {y:.6} {z:.6} 0 0 0 0 0 0\n")
}

/// Two points on each leg.
fn good() -> String {
    line(27.09, 50.0, -10.0) + &line(27.08, 60.0, -10.0) + &line(61.1, 23.09, -10.0) + &line(70.0, 23.08, -10.0)
}

#[test]
fn the_contact_lies_on_the_wall_side_of_the_ball_and_material_left_is_positive() {
    let measurement = read(&pass(&[], PROGRAM), &good()).unwrap();
    let first = &measurement.contacts[0];
    assert_eq!((first.point.x.nm(), first.point.y.nm()), (24_080_000, 60_000_000));
    let errors: Vec<i64> = measurement.contacts.iter().map(|c| c.error.nm()).collect();
    assert_eq!(errors, [80_000, 90_000, 90_000, 80_000]);
    assert_eq!(measurement.contacts[0].height.bits(), 1 << 31);
}

#[test]
fn columns_are_read_with_commas_semicolons_blanks_and_decimal_commas() {
    let columns = pass(&[("format = \"linuxcnc\"", "format = \"columns\"")], PROGRAM);
    let expected: Vec<i64> = vec![90_000, 90_000];
    for text in [
        "x_mm,y_mm,z_mm\n27.09,50,-10\n61.1,23.09,-10\n",
        "# a comment\nX;Y;Z\n27,09;50;-10\n61,1;23,09;-10\n",
        "27.09 50 -10\n61.1 23.09 -10\n",
        "27,09 50,0 -10,0\n61,1 23,09 -10,0\n",
        "id,Z,Y,X\n1,-10,50,27.09\n2,-10,23.09,61.1\n",
        "\"x\"\t\"y\"\t\"z\"\r\n27,09\t50\t-10\r\n61,1\t23,09\t-10\r\n",
    ] {
        let measurement = read(&columns, text).unwrap_or_else(|e| panic!("{text}: {}", e.render(Form::Plain)));
        assert_eq!(measurement.contacts.iter().map(|c| c.error.nm()).collect::<Vec<_>>(), expected, "{text}");
    }
}

#[test]
fn a_stray_point_is_set_aside_with_a_reason_and_the_rest_is_used() {
    let text = good() + &line(500.0, 500.0, -10.0) + &line(27.09, 55.0, 20.0);
    let pass = pass(&[], PROGRAM);
    let file = Source::new("probe.txt", text.into_bytes());
    let measurement = Measurement::read(&pass, &file).unwrap();
    assert_eq!(measurement.contacts.len(), 4);
    let remarks = measurement.remarks(&file);
    assert!(remarks[0].starts_with("probe.txt:5: point 5 set aside: "), "{}", remarks[0]);
    assert_eq!(
        &*remarks[1],
        "probe.txt:6: point 6 set aside: 35.000 mm above the cutter's tip, outside the engaged depth"
    );
}

#[test]
fn the_tip_of_the_ball_is_lifted_by_its_radius() {
    let tip = pass(&[("z_reference = \"centre\"", "z_reference = \"tip\"")], PROGRAM);
    let measurement = read(&tip, &line(27.09, 50.0, -13.0)).unwrap();
    assert_eq!(measurement.contacts[0].height.bits(), 1 << 31);
}

/// What is refused, where, and in which words.
#[test]
fn wrong_files_are_refused_with_their_place_and_what_to_do() {
    let metric = pass(&[], PROGRAM);
    let inch = {
        // The same corner in inches (25.4 times smaller numbers).
        let program = "%\nG20 G90\nS1500 M03\nG00 X1.338583 Y3.149606 Z1\nG01 Z-0.590551 F20\nG01 X1.338583 Y1.377953\n\
                       G03 X1.535433 Y1.181102 I0.19685 J0\nG01 X3.543307 Y1.181102\nG00 Z4\nM30\n%\n";
        pass(&[], program)
    };
    let scale = |factor: f64| {
        line(27.09 * factor, 50.0 * factor, -10.0 * factor) + &line(61.1 * factor, 23.09 * factor, -10.0 * factor)
    };
    let cases: Vec<(&str, &Pass, String, &str, usize, &str)> = vec![
        ("empty", &metric, String::new(), "M005", 1, "the file holds no probe point"),
        ("blank lines", &metric, "\n\n  \n".to_owned(), "M005", 1, "the file holds no probe point"),
        ("cut off", &metric, good() + "27.09 50", "M003", 5, "`27.09 50`: found 2 numbers in this line; expected 9"),
        (
            "a word",
            &metric,
            "27.09 fifty -10 0 0 0 0 0 0\n".to_owned(),
            "M001",
            1,
            "`fifty`: this is not a number; expected a coordinate",
        ),
        (
            "an exponent",
            &metric,
            "2.7e1 50 -10 0 0 0 0 0 0\n".to_owned(),
            "M001",
            1,
            "`2.7e1`: this is not a number; expected a coordinate",
        ),
        (
            "huge",
            &metric,
            "1234567890123456 50 -10 0 0 0 0 0 0\n".to_owned(),
            "M002",
            1,
            "`1234567890123456`: this number has more than 12 digits before its point; expected a coordinate",
        ),
        (
            "millimetres after an inch program",
            &inch,
            scale(1.0),
            "M012",
            1,
            "most readings are farther than 0.039 in from the nominal wall; they fit when read as millimetres; expected readings on the wall of this contour",
        ),
        (
            "inches after a metric program",
            &metric,
            scale(1.0 / 25.4),
            "M011",
            1,
            "most readings are farther than 1 mm from the nominal wall; they fit when read as inches; expected readings on the wall of this contour",
        ),
        (
            "machine coordinates",
            &metric,
            line(-372.91, -250.0, -410.0) + &line(-338.9, -276.91, -410.0),
            "M014",
            1,
            "most readings are farther than 1 mm from the nominal wall; probably they are in another frame; expected readings on the wall of this contour",
        ),
        (
            "above the cut",
            &metric,
            line(27.09, 50.0, 10.0),
            "M015",
            1,
            "no reading can be used; the first one is 25.000 mm above the cutter's tip, outside the engaged depth; expected ball centres between Z -15 and Z -5 beside the wall",
        ),
    ];
    for (name, pass, text, code, row, sentence) in cases {
        let Err(Failure::Input(error)) = read(pass, &text) else { panic!("{name} was accepted") };
        assert_eq!(error.code(), code, "{name}: {error}");
        assert_eq!(error.to_string(), sentence, "{name}");
        assert_eq!(error.line_column().map(|p| p.0), Some(row), "{name}");
        let shown = Failure::Input(error).render(Form::Plain);
        assert!(shown.contains("help: ") && shown.contains(&format!("probe.txt:{row}:")), "{name}: {shown}");
    }
}

#[test]
fn a_wall_on_the_wrong_side_is_named() {
    let left = pass(&[("wall = \"right\"", "wall = \"left\"")], PROGRAM);
    let Err(Failure::Input(error)) = read(&left, &good()) else { panic!("accepted") };
    assert_eq!(error.code(), "M016");
}

#[test]
fn surface_points_given_as_ball_centres_are_named() {
    // A ball of 16 mm: surface points lie 8 mm behind where centres would.
    let big = pass(&[("ball_diameter_mm = 6.0", "ball_diameter_mm = 16.0")], PROGRAM);
    let Err(Failure::Input(error)) = read(&big, &(line(24.09, 50.0, -10.0) + &line(61.1, 20.09, -10.0))) else {
        panic!("accepted")
    };
    assert_eq!(error.code(), "M013");
}

#[test]
fn a_scan_of_more_points_than_a_fit_takes_is_refused_by_name_and_inspected_all_the_same() {
    let scan = |points: usize| -> String {
        (0..points).map(|k| line(27.09, 45.0 + 20.0 * k as f64 / points as f64, -10.0)).collect()
    };
    let pass = pass(&[], PROGRAM);
    let most = truepath_job::measurement::MOST_POINTS;
    assert_eq!(read(&pass, &scan(most)).unwrap().observations().unwrap().len(), most);
    let larger = read(&pass, &scan(most + 1)).unwrap();
    assert_eq!(larger.contacts.len(), most + 1);
    let text = larger.observations().unwrap_err().render(Form::Plain);
    for part in ["M040", "probe.txt", "2001 points", "at most 2000", "every n-th"] {
        assert!(text.contains(part), "{part}: {text}");
    }
}
