//! Sharp inside corners on the virtual machine: corrected as they are, and with arcs in their place.

use std::path::Path;

use truepath_core::geometry::Block;
use truepath_core::units::Real;
use truepath_correction::correct::{CorrectedPass, correct_pass};
use truepath_correction::fillet;
use truepath_ground::diagnostics::{Failure, Source};
use truepath_ground::units::{mm, nm};
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;
use truepath_plant::Machine;
use truepath_trial::virtual_mill;

const JOB: &str = r#"
version = 1
program = "part.nc"
wall = "left"
[stock]
allowance_mm = 0.5
[tool]
diameter_mm = 12
teeth = 4
helix_deg = 30
[cut]
axial_depth_mm = 20
[force]
material = "al-7075-t6"
[machine]
stiffness_x_n_per_mm = 4000
stiffness_y_n_per_mm = 4000
[probe]
format = "linuxcnc"
ball_diameter_mm = 6
"#;
const PLANT: &str = "
ktc_n_per_mm2 = 850.0
krc_n_per_mm2 = 320.0
kte_n_per_mm = 11.0
kre_n_per_mm = 14.0
size_exponent = 0.12
stiffness_x_n_per_mm = 3400.0
stiffness_y_n_per_mm = 4300.0
bend = 0.25
runout_mm = [0.003, -0.002, 0.001, -0.002]
law = \"helical\"
probe_noise_mm = 0.002
seed = 5
";
const HEAD: &str = "G21 G90 G17\nT1 M6\nS3000 M3\n";
/// Against the cutter's turn along the wall, and with it.
const CONVENTIONAL: &str = "G0 X-60 Y-40 Z5\nG1 Z-20 F1000\nG1 X-60 Y0 F300\nX0\nY-40\nG0 Z5\nX-20\nM2\n";
const CLIMB: &str = "G0 X0 Y-40 Z5\nG1 Z-20 F1000\nG1 X0 Y0 F300\nX-60\nY-40\nG0 Z5\nX-20\nM2\n";
/// A corner of 27 degrees, and one between a line and an arc.
const ACUTE: &str = "G0 X-60 Y0 Z5\nG1 Z-20 F1000\nG1 X0 Y0 F300\nX-40 Y-20\nG0 Z5\nY-40\nM2\n";
const ON_AN_ARC: &str = "G0 X-60 Y0 Z5\nG1 Z-20 F1000\nG1 X0 Y0 F300\nG3 X20 Y-20 I20 J0\nG0 Z5\nX0\nM2\n";
/// Where the walls are touched, mm along the contour.
const PLACES: [f64; 11] = [10.0, 20.0, 30.0, 38.5, 50.0, 58.0, 70.0, 75.0, 82.0, 90.0, 97.5];

fn pass(job: &str, program: &str) -> Pass {
    let source = |name: &str, text: &str| Source::new(name, text.as_bytes().to_vec());
    let job = JobFile::parse(source("job.toml", job), Path::new("")).unwrap();
    Pass::new(job, source("part.nc", program)).unwrap()
}

fn machine() -> Machine {
    toml::from_str(PLANT).unwrap()
}

/// Corrected from touches of the uncorrected part; largest errors of part and corrected part, mean over the height, mm.
fn way(pass: &Pass) -> (CorrectedPass, [f64; 2]) {
    let machine = machine();
    let first = virtual_mill::mill(pass, &machine, None).unwrap();
    let end = |b: &Block| mm(b.s + b.curve.length());
    let length = pass.blocks.last().map_or(0.0, end);
    // Eight millimetres away from sharp corners and ends.
    let turns =
        pass.blocks.windows(2).filter(|b| b[0].curve.end_heading().dot(b[1].curve.start_heading()) < Real::HALF);
    let apart: Vec<f64> = turns.map(|b| end(&b[0])).chain([length]).collect();
    let places = PLACES.into_iter().filter(|s| *s < length && apart.iter().all(|at| (s - at).abs() > 8.0));
    let places: Vec<f64> = places.collect();
    let probe = virtual_mill::probe(pass, &first, &places, &[0.15, 0.5, 0.85], 6.0).unwrap();
    let measurement = Measurement::read(pass, &Source::new("probe.txt", probe.into_bytes())).unwrap();
    let done = correct_pass(pass, &measurement, &[], &[Route::Program], &mut |_| ()).unwrap();
    let corrected = Source::new("corrected.nc", done.program.clone().unwrap());
    let second = virtual_mill::mill_executed(pass, &machine, &corrected).unwrap();
    let errors = [first.score().max_error_mm, second.score().max_error_mm];
    println!("{errors:?} {:?}", done.summary.sharp_corners);
    (done, errors)
}

#[test]
fn beside_a_sharp_corner_half_of_the_error_goes() {
    for program in [CONVENTIONAL, ACUTE] {
        let (done, [before, after]) = way(&pass(JOB, &format!("{HEAD}{program}")));
        assert!(before > 0.1 && after < 0.55 * before, "{before} -> {after}");
        let corners = done.summary.sharp_corners.unwrap();
        assert!(corners.after_mm < 0.5 * corners.before_mm, "{corners:?}");
    }
}

#[test]
fn where_the_cutter_would_spring_back_into_the_wall_it_is_not_sent_there() {
    let (done, [before, after]) = way(&pass(&JOB.replace("left", "right"), &format!("{HEAD}{CLIMB}")));
    assert!(after < 0.6 * before, "{before} -> {after}");
    // Towards the wall never farther than along the straight wall.
    let towards: Vec<f64> = done.rows.iter().filter(|row| row.s_mm <= 40.0).map(|row| row.dx_mm).collect();
    let straight = towards[200];
    assert!(straight > 0.005 && towards.iter().all(|dx| *dx <= straight + 1e-4), "{straight} {towards:?}");
}

#[test]
fn the_corrected_path_has_no_step_in_a_sharp_corner() {
    let (done, _) = way(&pass(JOB, &format!("{HEAD}{CONVENTIONAL}")));
    let steps = done.rows.windows(2).map(|w| (w[1].dx_mm - w[0].dx_mm).hypot(w[1].dy_mm - w[0].dy_mm));
    let largest = steps.fold(0.0, f64::max);
    assert!(largest < 0.05, "{largest}");
    // From the end of one leg to the start of the other, over all that turns on the spot between them.
    let at_end = done.rows.iter().position(|r| r.s_mm >= 40.0).unwrap();
    let behind = done.rows.iter().rposition(|r| r.s_mm <= 40.0).unwrap();
    assert!(behind > at_end + 10);
    let (a, b) = (&done.rows[at_end], &done.rows[behind]);
    assert!((a.dx_mm - b.dx_mm).hypot(a.dy_mm - b.dy_mm) < 0.003, "{a:?} {b:?}");
}

#[test]
fn corners_of_a_slot_share_the_leg_between_them() {
    // 13 mm apart: less than the surroundings of both.
    let slot = "G0 X0 Y-40 Z5\nG1 Z-20 F1000\nG1 X0 Y0 F300\nX13\nY-40\nG0 Z5\nX20\nM2\n";
    let (done, [before, after]) = way(&pass(JOB, &format!("{HEAD}{slot}")));
    assert!(after < 0.7 * before, "{before} -> {after}");
    for s_mm in [40.0, 53.0] {
        let at_end = done.rows.iter().position(|r| r.s_mm >= s_mm).unwrap();
        let behind = done.rows.iter().rposition(|r| r.s_mm <= s_mm).unwrap();
        let (a, b) = (&done.rows[at_end], &done.rows[behind]);
        assert!((a.dx_mm - b.dx_mm).hypot(a.dy_mm - b.dy_mm) < 0.003, "{a:?} {b:?}");
    }
}

/// The program with corners of a radius on the wall, as a pass.
fn rounded(whole: &Pass, job: &str, radius_mm: f64) -> (Pass, Vec<fillet::Corner>) {
    let (written, corners, _) = fillet::rewritten(&[whole], nm(radius_mm)).unwrap();
    (pass(job, std::str::from_utf8(&written.text).unwrap()), corners)
}

#[test]
fn with_arcs_in_the_corners_nearly_all_goes() {
    let whole = pass(JOB, &format!("{HEAD}{CONVENTIONAL}"));
    let (filleted, corners) = rounded(&whole, JOB, 2.0);
    assert!(corners.len() == 2 && corners.iter().all(|c| (c.turn_deg - 90.0).abs() < 1e-6 && c.radius_mm == 2.0));
    assert!((corners[0].left_mm - 2.0 * (2f64.sqrt() - 1.0)).abs() < 1e-9);
    let radii: Vec<i64> =
        filleted.blocks.iter().filter_map(|b| b.curve.signed_radius()).map(|r| r.abs().nm()).collect();
    assert!(!radii.is_empty() && radii.iter().all(|r| (r - 2_000_000).abs() < 2_000), "{radii:?}");
    let (done, [before, after]) = way(&filleted);
    assert!(done.summary.sharp_corners.is_none() && after < 0.005, "{before} -> {after}");
    // It was foretold with the corners still sharp.
    let (sharp, _) = way(&whole);
    let foretold = sharp.summary.sharp_corners.unwrap().with_arcs.unwrap();
    assert!(foretold.corner_radius_mm == 8.0 && foretold.after_mm < 0.01, "{foretold:?}");
    assert!(sharp.summary.warnings.iter().any(|text| text.contains("truepath fillet JOB --corner-radius 8 -o DIR ")));
}

#[test]
fn an_arc_touches_a_leg_that_is_an_arc_itself() {
    let whole = pass(JOB, &format!("{HEAD}{ON_AN_ARC}"));
    let (filleted, corners) = rounded(&whole, JOB, 2.0);
    println!("{corners:?}");
    assert_eq!(corners.len(), 1);
    let arcs: Vec<_> =
        filleted.blocks.iter().filter(|b| b.curve.signed_radius().is_some_and(|r| r.abs().nm() < 3_000_000)).collect();
    assert!(!arcs.is_empty());
    for pair in filleted.blocks.windows(2) {
        let kink = pair[0].curve.end_heading().cross(pair[1].curve.start_heading());
        assert!(truepath_ground::units::float(kink.abs()) < 0.02, "{pair:?}");
    }
}

#[test]
fn arcs_turn_with_the_part() {
    let text = |program: &str, wall: &str| {
        let job = JOB.replace("left", wall);
        let (written, ..) = fillet::rewritten(&[&pass(&job, &format!("{HEAD}{program}"))], nm(2.0)).unwrap();
        let (written, _) = (String::from_utf8(written.text).unwrap(), ());
        let blocks = pass(&job, &written).blocks;
        blocks.iter().map(|b| [b.curve.end().x.nm(), b.curve.end().y.nm()]).collect::<Vec<[i64; 2]>>()
    };
    let plain = text(CONVENTIONAL, "left");
    // Shifted by 1000 mm, turned by 90 degrees, mirrored.
    let shifted = text(&CONVENTIONAL.replace("X-60", "X940").replace("X0", "X1000").replace("X-20", "X980"), "left");
    let turned = "G0 X40 Y-60 Z5\nG1 Z-20 F1000\nG1 X0 Y-60 F300\nY0\nX40\nG0 Z5\nY-20\nM2\n";
    let mirrored = "G0 X60 Y-40 Z5\nG1 Z-20 F1000\nG1 X60 Y0 F300\nX0\nY-40\nG0 Z5\nX20\nM2\n";
    let of = |f: fn(&[i64; 2]) -> [i64; 2]| plain.iter().map(f).collect::<Vec<_>>();
    assert_eq!(shifted, of(|[x, y]| [x + 1_000_000_000, *y]));
    assert_eq!(text(turned, "left"), of(|[x, y]| [-y, *x]));
    assert_eq!(text(mirrored, "right"), of(|[x, y]| [-x, *y]));
}

#[test]
fn without_a_sharp_corner_or_room_there_is_nothing_to_round() {
    let refused = |program: &str| match fillet::rewritten(&[&pass(JOB, &format!("{HEAD}{program}"))], nm(2.0)) {
        Err(Failure::Input(error)) => (error.code().to_owned(), error.found().to_owned()),
        other => panic!("{other:?}"),
    };
    let straight = "G0 X-60 Y0 Z5\nG1 Z-20 F1000\nG1 X0 Y0 F300\nG0 Z5\nM2\n";
    assert_eq!(refused(straight), ("P023".to_owned(), "no sharp inside corner on the contour".to_owned()));
    let short = "G0 X-60 Y0 Z5\nG1 Z-20 F1000\nG1 X-0.01 Y0 F300\nX0 Y-0.01\nY-40\nG0 Z5\nM2\n";
    let (code, found) = refused(short);
    assert!(code == "P023" && found.contains("too short"), "{found}");
    // As much as there is room for.
    let tight = "G0 X-60 Y0 Z5\nG1 Z-20 F1000\nG1 X-1 Y0 F300\nX0 Y-1\nY-40\nG0 Z5\nM2\n";
    let (_, corners, _) = fillet::rewritten(&[&pass(JOB, &format!("{HEAD}{tight}"))], nm(2.0)).unwrap();
    // Half of the chamfer over the tangent of half of the turn.
    let most = 0.5 * 2f64.sqrt() / 22.5f64.to_radians().tan();
    assert!(corners.iter().all(|c| c.radius_mm > 0.9 * most && c.radius_mm <= most), "{corners:?}");
}
