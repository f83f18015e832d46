//! Dimensions on the walls of a pocket and of a bore.

use std::path::Path;

use truepath_core::identify::Observation;
use truepath_ground::diagnostics::{Failure, Form, Source};
use truepath_job::job::JobFile;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

const JOB: &str = include_str!("../../../demo/pocket/job.toml");
const POCKET: &str = include_str!("../../../demo/pocket/program.nc");
/// A bore of 50 mm about X10 Y5.
const BORE: &str = "G21 G90 G17\nT2 M6\nS3200 M3\nG0 X10 Y5 Z10\nG1 Z-12 F600\nG1 X30 Y5\nG3 X30 Y5 I-20 J0\n\
    G0 Z10\nM30\n";

/// A pass of somebody who owns no probe.
fn pass(program: &str) -> Pass {
    let job = JOB.split("[probe]").next().expect("a job").to_owned();
    let job = JobFile::parse(Source::new("job.toml", job.into_bytes()), Path::new("")).unwrap();
    Pass::new(job, Source::new("part.nc", program.as_bytes().to_vec())).unwrap()
}

fn read(program: &str, dimensions: &str) -> Result<Measurement, Failure> {
    let file = Source::new("widths.toml", format!("version = 1\n{dimensions}").into_bytes());
    Measurement::of_one_with(pass(program), None, Some(&file)).map(|(_, measurement)| measurement)
}

/// A `[[dimension]]` with a place and a value.
fn dimension(kind: &str, place: &str, value: &str) -> String {
    format!(
        "[[dimension]]\nkind = \"{kind}\"\nalong = \"x\"\n{place}\nz_mm = -6.0\ninstrument = \"micrometer\"\nvalue_mm = {value}\n"
    )
}

fn width(value: &str) -> String {
    dimension("width", "y_mm = 0.0", value)
}

/// (error in nm, x of the contact in nm, noise in nm, whether a wall lies across) of the only reading.
fn only(program: &str, dimensions: &str) -> (i64, i64, i64, bool) {
    let measurement = read(program, dimensions).unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)));
    let observations = measurement.observations().unwrap();
    assert_eq!((observations.len(), measurement.contacts.len()), (1, 1));
    let (o, contact) = (observations[0], measurement.contacts[0]);
    assert_eq!(o.error, contact.error);
    (o.error.nm(), contact.point.x.nm(), o.noise.nm(), o.across().is_some())
}

#[test]
fn a_width_is_half_its_deviation_on_each_of_two_walls() {
    // 70 mm nominal, 0.18 mm too narrow: 0.09 mm are left on each wall; ± 8 µm are 2 µm of the mean at one sigma.
    assert_eq!(only(POCKET, &width("69.820")), (90_000, -34_910_000, 2_000, true));
    assert_eq!(only(POCKET, &width("\"69,820\"")), (90_000, -34_910_000, 2_000, true));
    let middle = dimension("width", "through = \"middle\"", "70.04").replace("micrometer", "calliper");
    assert_eq!(only(POCKET, &middle), (-20_000, -35_020_000, 7_500, true));
    let stated = width("69.820").replace("value_mm", "uncertainty_mm = 0.02\nvalue_mm");
    assert_eq!(only(POCKET, &stated).2, 5_000);
    let above = width("69.820").replace("z_mm = -6.0", "height_mm = 6.0");
    let height = |text: &str| read(POCKET, text).unwrap().contacts[0].height.bits();
    assert_eq!((height(&above), height(&width("69.820"))), (1 << 31, 1 << 31));
}

#[test]
fn a_bore_has_a_diameter_through_its_middle() {
    assert_eq!(only(BORE, &dimension("diameter", "", "49.900")), (50_000, -14_950_000, 2_000, true));
    let along_y = dimension("diameter", "x_mm = 10.0", "50.020").replace("\"x\"", "\"y\"");
    assert_eq!(only(BORE, &along_y).0, -10_000);
}

#[test]
fn a_distance_sees_one_wall_and_what_its_face_may_be_off() {
    // The wall at X-35 stands 0.05 mm too far out.
    let distance = dimension("distance", "y_mm = 0.0\nface_mm = -50.0", "14.950");
    // ± 8 µm of the reading, ± 20 µm of the face.
    assert_eq!(only(POCKET, &distance), (-50_000, -35_050_000, 10_770, false));
    let wall = dimension("thickness", "y_mm = 0.0\nface_mm = 50.0", "15.030");
    assert_eq!(only(POCKET, &wall), (30_000, 34_970_000, 10_770, false));
    let near = dimension("distance", "y_mm = 0.0\nface_mm = 0.0\nnear_mm = 20", "34.980");
    assert_eq!(only(POCKET, &near).1, 34_980_000);
    // Two distances from a face share what it is off: they say no more of it than it allows.
    let both = format!("{distance}{}", distance.replace("y_mm = 0.0", "y_mm = 5.0"));
    let noise = read(POCKET, &both).unwrap().observations().unwrap()[0].noise.nm();
    assert_eq!(noise, 14_697);
}

#[test]
fn dimensions_stand_beside_a_probe_file_and_both_are_read() {
    let job = JobFile::parse(Source::new("job.toml", JOB.as_bytes().to_vec()), Path::new("")).unwrap();
    let pass = Pass::new(job, Source::new("part.nc", POCKET.as_bytes().to_vec())).unwrap();
    let probe = Source::new("probe.txt", b"0 22.9 -6 0 0 0 0 0 0\n0 22.9 -8 0 0 0 0 0 0\n".to_vec());
    let file = Source::new("widths.toml", format!("version = 1\n{}", width("69.820")).into_bytes());
    let measurement = Measurement::of_one_with(pass, Some(&probe), Some(&file)).unwrap().1;
    let mut names: Vec<String> = measurement.contacts.iter().map(|c| measurement.name_of(c.line)).collect();
    names.sort();
    assert_eq!(names, ["\"width along X at Y0, Z-6\" (widths.toml, line 8)", "line 1 (point 1)", "line 2 (point 2)"]);
    let noises: Vec<i64> = measurement.observations().unwrap().iter().map(|o| o.noise.nm()).collect();
    assert_eq!(noises.len(), 3);
    assert!(noises.iter().all(|noise| *noise == 2_000), "{noises:?}");
}

/// Code, place and help of what is refused.
fn refused(dimensions: &str) -> (String, (usize, usize), String) {
    match read(POCKET, dimensions) {
        Err(Failure::Input(error)) => {
            let json = error.to_json();
            assert_eq!(json["error"]["file"], "widths.toml");
            let text = format!("{} {}", json["error"]["expected"], json["error"]["help"]);
            (error.code().to_owned(), error.line_column().expect("a place"), text)
        }
        other => panic!("{dimensions}: {other:?}"),
    }
}

#[test]
fn what_cannot_be_is_refused_with_its_place_and_what_to_do() {
    let at = |place: &str| dimension("width", place, "69.820");
    for (text, code, place, said) in [
        (width("\"\""), "M043", (8, 12), "measure it and type the number"),
        (width(""), "M043", (8, 10), "measure it and type the number"),
        (width("-69.82"), "J006", (8, 12), "above 0"),
        (width("2.7488"), "M047", (8, 12), "inches"),
        (width("34.910"), "M047", (8, 12), "radius"),
        (width("698.2"), "M047", (8, 12), "decimal point"),
        (width("0.18"), "M047", (8, 12), "not its deviation"),
        (width("61.0"), "M047", (8, 12), "70.000 mm (X-35.000 to X35.000)"),
        (width("\"about 70\""), "J005", (8, 12), "type the number alone"),
        (at("y_mm = 40.0"), "M045", (5, 8), "Y-25.000 to Y25.000"),
        (at("y_mm = 19.0"), "M046", (5, 8), "square"),
        (at("x_mm = 0.0"), "J008", (5, 8), "y_mm"),
        (at("through = \"corner\""), "J007", (5, 11), "middle"),
        (at("y_mm = 0.0\nface_mm = -50.0"), "J008", (6, 11), "distance"),
        (at(""), "J004", (2, 1), "through"),
        (dimension("thickness", "y_mm = 0.0", "69.8"), "M045", (5, 8), "kind = \\\"width\\\""),
        (dimension("diameter", "y_mm = 0.0", "69.8"), "M045", (5, 8), "straight"),
        (dimension("distance", "y_mm = 0.0", "15.0"), "J004", (2, 1), "face_mm"),
        (dimension("distance", "y_mm = 0.0\nface_mm = 0.0", "34.95"), "M049", (5, 8), "near_mm"),
        (dimension("depth", "y_mm = 0.0", "12.0"), "M044", (3, 8), "nothing here corrects Z"),
        (dimension("widht", "y_mm = 0.0", "69.8"), "J007", (3, 8), "did you mean"),
        (width("69.82").replace("micrometer", "ruler"), "J007", (7, 14), "calliper"),
        (width("69.82").replace("-6.0", "-12.5"), "M048", (6, 8), "z_mm from -12 to 0"),
        (width("69.82").replace("z_mm = -6.0", "height_mm = 12.5"), "M048", (6, 13), "height_mm from 0 to 12"),
        (width("69.82").replace("value_mm", "uncertainty_mm = -0.01\nvalue_mm"), "J006", (8, 18), "above 0"),
        (width("69.82").replace("value_mm", "uncertainty_mm = 30\nvalue_mm"), "J006", (8, 18), "unit"),
        (width("69.82").replace("value_mm", "valeu_mm"), "J004", (8, 1), "did you mean value_mm"),
        (String::new(), "J004", (1, 1), "[[dimension]]"),
    ] {
        let (found, found_place, text_said) = refused(&text);
        assert_eq!((found.as_str(), found_place), (code, place), "{text}\n{text_said}");
        assert!(text_said.contains(said), "{text}\n{text_said}");
    }
}

/// Dimensions of two pockets, the second one 80 mm further along X and cut with other heights: 10 mm stand between them.
fn of_two_pockets(deeper: &str, dimensions: &str) -> Result<Vec<Measurement>, Failure> {
    let shifted = |word: &str| match word.strip_prefix('X').and_then(|x| x.trim_end_matches('.').parse::<i32>().ok()) {
        Some(x) => format!("X{}.", x + 80),
        None => word.to_owned(),
    };
    let second: String =
        POCKET.lines().map(|line| line.split_whitespace().map(shifted).collect::<Vec<_>>().join(" ") + "\n").collect();
    let second = second.replace("Z-12.", deeper);
    let file = Source::new("widths.toml", format!("version = 1\n{dimensions}").into_bytes());
    let measured = Measurement::of_files(vec![pass(POCKET), pass(&second)], None, Some(&file))?;
    Ok(measured.into_iter().map(|(_, measurement)| measurement).collect())
}

#[test]
fn the_rib_between_two_pockets_is_a_reading_of_both() {
    let rib = dimension("thickness", "y_mm = 0.0", "10.02");
    let own = dimension("width", "y_mm = 5.0\nnear_mm = 0.0", "69.98");
    let measured = of_two_pockets("Z-12.", &(rib + &own)).unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)));
    let [first, second] = [0, 1].map(|k: usize| measured[k].observations().unwrap());
    assert_eq!((first.len(), second.len()), (2, 1));
    let half = |o: &[Observation]| *o.iter().find(|o| o.pair().is_some()).expect("a half of the rib");
    let halves = [half(&first), half(&second)];
    for half in halves {
        // 0.02 mm too thick: 0.01 mm are left on either wall; ± 8 µm are 2 µm of the mean, and √2 times that of each half.
        assert_eq!((half.error.nm(), half.noise.nm(), half.across()), (10_000, 2_828, None));
    }
    assert_eq!((halves[0].pair(), halves[0].normal.x), (halves[1].pair(), -halves[1].normal.x));
    let at = |k: usize| {
        let contacts = &measured[k].contacts;
        contacts.iter().find(|c| measured[k].dimension(c.line).is_some_and(|p| p.half.is_some())).unwrap().point.x.nm()
    };
    assert_eq!([at(0), at(1)], [34_990_000, 45_010_000], "either wall stands where the mean has it");
    assert!(!first.iter().any(|o| o.across().is_none() && o.pair().is_none()), "a width is a width as before");
    let line = measured[0].contacts.iter().map(|c| c.line).find(|line| measured[1].is_second_half(*line));
    assert!(line.is_some_and(|line| !measured[0].is_second_half(line)), "one of the two is counted");
}

#[test]
fn between_contours_the_height_is_that_of_the_program_and_what_fits_nothing_is_refused_as_before() {
    let above = dimension("thickness", "y_mm = 0.0", "10.02").replace("z_mm = -6.0", "height_mm = 4.0");
    assert!(of_two_pockets("Z-12.", &above).is_ok());
    let Err(Failure::Input(refused)) = of_two_pockets("Z-9.", &above) else { panic!("one height of two") };
    assert_eq!((refused.code(), refused.line_column()), ("M051", Some((6, 13))));
    assert!(of_two_pockets("Z-9.", &dimension("thickness", "y_mm = 0.0", "10.02")).is_ok());
    assert!(of_two_pockets("Z-12.", &dimension("width", "y_mm = 0.0\nnear_mm = 80.0", "69.98")).is_ok());
    for (text, code) in [
        (dimension("thickness", "y_mm = 0.0", "14.0"), "M047"),
        (dimension("width", "y_mm = 0.0", "10.02"), "M047"),
        (dimension("width", "y_mm = 0.0", "69.98"), "M049"),
    ] {
        let Err(Failure::Input(refused)) = of_two_pockets("Z-12.", &text) else { panic!("{text} is read") };
        assert_eq!(refused.code(), code, "{text}");
    }
}

#[test]
fn near_mm_tells_the_ring_from_the_pocket_around_it_and_one_ring_from_the_other() {
    let island = "G21 G90 G17\nT2 M6\nS3200 M3\nG0 X0 Y-15 Z10\nG1 Z-12 F600\nG1 X-20\nG1 Y15\nG1 X20\nG1 Y-15\nG1 X0\nG0 Z10\nM30\n";
    let of_both = |text: &str| {
        let file = Source::new("widths.toml", format!("version = 1\n{text}").into_bytes());
        Measurement::of_files(vec![pass(POCKET), pass(island)], None, Some(&file))
            .map(|all| all.into_iter().map(|(_, measurement)| measurement.observations().unwrap()).collect::<Vec<_>>())
    };
    let is_pair = |all: &[Vec<Observation>]| all.iter().all(|own| own.len() == 1 && own[0].pair().is_some());
    // The island reaches from X-15 to X15: a ring of 20 mm to either side of it, and 70 mm across.
    let ring = |near: f64| dimension("width", &format!("y_mm = 0.0\nnear_mm = {near}"), "19.96");
    for near in [-25.0, -16.0, 34.0] {
        assert!(is_pair(&of_both(&ring(near)).unwrap_or_else(|e| panic!("{}", e.render(Form::Plain)))), "{near}");
    }
    let pocket = of_both(&dimension("width", "y_mm = 0.0\nnear_mm = -16.0", "69.96")).unwrap();
    assert!(pocket[0].len() == 1 && pocket[0][0].across().is_some() && pocket[1].is_empty());
    let Err(Failure::Input(refused)) = of_both(&dimension("width", "y_mm = 0.0", "19.96")) else { panic!("two rings") };
    assert_eq!(refused.code(), "M049");
}
