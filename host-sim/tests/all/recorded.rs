//! `truepath simulate --setpoints`: the plant along the path and at the feeds of a recording.

use std::f64::consts::PI;
use std::fmt::Write;

use truepath::command::placement::PlacementOptions;
use truepath::command::simulate::{Options, run};
use truepath_core::units::Real;
use truepath_ground::diagnostics::Failure;
use truepath_report::SimulateSummary;

const PROGRAM: &str = "G21 G17 G90 G94\nT1 M6\nS1500 M3\nG0 X34 Y80\nG1 Z-15 F400\nG1 X34 Y35\n\
                       G3 X39 Y30 I5 J0\nG1 X90 Y30\nG0 Z30\nM30\n";
const JOB: &str = "version = 1\nprogram = \"corner.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 3.0\n[tool]\n\
                   diameter_mm = 20.0\nteeth = 6\nhelix_deg = 30.0\n[cut]\naxial_depth_mm = 10.0\nCUT\n[force]\n\
                   ktc_n_per_mm2 = 1200\nkrc_n_per_mm2 = 345\nkte_n_per_mm = 0\nkre_n_per_mm = 0\n[machine]\n\
                   stiffness_x_n_per_mm = 880\nstiffness_y_n_per_mm = 1500\n[probe]\nball_diameter_mm = 6.0\n\
                   format = \"linuxcnc\"\nz_reference = \"centre\"\n";
const PLANT: &str = "ktc_n_per_mm2 = 1147.7\nkrc_n_per_mm2 = 344.3\nkte_n_per_mm = 8\nkre_n_per_mm = 8\n\
                     stiffness_x_n_per_mm = 1150\nstiffness_y_n_per_mm = 1150\nsize_exponent = 0.2\n";

/// The centre of the cutter along the corner, `s` mm from its start, moved away from the wall by `off` mm.
fn corner(s: f64, off: f64) -> [f64; 2] {
    let (first, arc) = (45.0, 2.5 * PI);
    if s < first {
        [34.0 + off, 80.0 - s]
    } else if s < first + arc {
        let turned = PI + (s - first) / 5.0;
        [39.0 + (5.0 - off) * turned.cos(), 35.0 + (5.0 - off) * turned.sin()]
    } else {
        [39.0 + s - first - arc, 30.0 + off]
    }
}

const LENGTH_MM: f64 = 45.0 + 2.5 * PI + 51.0;

/// Rows of one pass at a feed in mm/min, one a millisecond, down at its start and up at its end.
fn pass(off: f64, feed: f64, rpm: f64) -> Vec<[f64; 4]> {
    let ticks = (LENGTH_MM / (feed / 60_000.0)) as usize;
    let deep = (0..=ticks).map(|k| {
        let [x, y] = corner(k as f64 * feed / 60_000.0, off);
        [x, y, -15.0, rpm]
    });
    let ([x, y], [u, v]) = (corner(0.0, off), corner(LENGTH_MM, off));
    let down = (0..500).map(|k| [x, y, 10.0 - f64::from(k) * 0.05, rpm]);
    let up = (0..500).map(|k| [u, v, -15.0 + f64::from(k) * 0.05, rpm]);
    down.chain(deep).chain(up).collect()
}

fn setpoints(frame: &str, rows: &[[f64; 4]]) -> String {
    let mut text = format!("# frame = {frame}\nt_s,x_mm,y_mm,z_mm,spindle_rpm\n");
    for (k, [x, y, z, rpm]) in rows.iter().enumerate() {
        let _ = writeln!(text, "{:.3},{x:.6},{y:.6},{z:.6},{rpm}", k as f64 / 1e3);
    }
    text
}

/// Cuts along a recording, or along the program with other keys in `[cut]`.
fn cut(recording: Option<(&str, PlacementOptions)>, keys: &str) -> Result<SimulateSummary, Failure> {
    let desk = tempfile::tempdir().expect("a folder");
    let put = |name: &str, text: &str| std::fs::write(desk.path().join(name), text).expect("a file");
    put("corner.nc", PROGRAM);
    put("job.toml", &JOB.replace("CUT", keys));
    put("plant.toml", PLANT);
    let at = |name: &str| desk.path().join(name);
    let setpoints = recording.as_ref().map(|_| at("in.csv"));
    let (text, placement) = recording.unwrap_or_default();
    put("in.csv", text);
    let (job, plant, output) = (at("job.toml"), Some(at("plant.toml")), at("out"));
    run(&Options { job, plant, setpoints, placement, probed_wall: true, output, ..Options::default() })
}

fn largest(summary: &SimulateSummary) -> f64 {
    summary.judged.expect("judged").max_error_mm
}

#[test]
fn a_recording_of_the_program_itself_gives_its_wall() {
    let usual = cut(None, "").expect("a wall");
    assert!(usual.recorded.is_none());
    let rows = setpoints("program", &pass(0.0, 400.0, 1500.0));
    let recorded = cut(Some((&rows, PlacementOptions::default())), "").expect("a wall");
    assert!((largest(&usual) - largest(&recorded)).abs() < 5e-4, "{} {}", largest(&usual), largest(&recorded));
    let facts = recorded.recorded.expect("facts");
    assert!(facts.passes == 1 && facts.farthest_mm < 1e-3, "{facts:?}");
    assert!((facts.from_s - 0.5).abs() < 0.011 && (facts.to_s - 0.5 - LENGTH_MM * 0.15).abs() < 0.02, "{facts:?}");
    assert!((facts.least_feed - 1.0).abs() < 1e-3 && (facts.greatest_feed - 1.0).abs() < 1e-3, "{facts:?}");
}

#[test]
fn the_chip_follows_the_recorded_feed_and_the_recorded_spindle() {
    let at = |feed: f64, rpm: f64| {
        let rows = setpoints("program", &pass(0.0, feed, rpm));
        largest(&cut(Some((&rows, PlacementOptions::default())), "").expect("a wall"))
    };
    let usual = at(400.0, 1500.0);
    let half = largest(&cut(None, "feed_mm_per_min = 200").expect("a wall"));
    assert!(usual - half > 0.05, "{usual} {half}");
    assert!((at(200.0, 1500.0) - half).abs() < 1e-3, "half the feed: {} {half}", at(200.0, 1500.0));
    assert!((at(400.0, 3000.0) - half).abs() < 1e-3, "twice the speed: {} {half}", at(400.0, 3000.0));
    assert!((at(200.0, 750.0) - usual).abs() < 1e-3, "the same chip");
}

#[test]
fn a_place_at_which_the_cutter_stops_carries_the_mark_of_it() {
    let mut rows = pass(0.0, 400.0, 1500.0);
    // 20 mm from the start: without a chip only the edges push, and less material is left there than anywhere else.
    let stop = rows[500 + 3_000];
    rows.splice(3_500..3_500, std::iter::repeat_n(stop, 400));
    let recorded = cut(Some((&setpoints("program", &rows), PlacementOptions::default())), "").expect("a wall");
    assert!(recorded.recorded.as_ref().expect("facts").least_feed < 0.01);
    let usual = cut(None, "").expect("a wall");
    let left = |summary: &SimulateSummary| -summary.judged.expect("judged").gouge_mm;
    assert!(left(&usual) > 0.05 && left(&recorded) < 0.5 * left(&usual), "{} {}", left(&usual), left(&recorded));
    assert!((largest(&recorded) - largest(&usual)).abs() < 1e-3, "the arc, far from it, is as before");
}

#[test]
fn machine_coordinates_of_a_turned_program_give_the_same_wall() {
    let rows = pass(0.0, 400.0, 1500.0);
    let placement = PlacementOptions {
        origin_mm: Some([150_000_000, 100_000_000, -120_000_000]),
        rotation_deg: Some(Real::from_int(30)),
        ..PlacementOptions::default()
    };
    let (sine, cosine) = (PI / 6.0).sin_cos();
    let turned: Vec<[f64; 4]> = rows
        .iter()
        .map(|[x, y, z, rpm]| [150.0 + cosine * x - sine * y, 100.0 + sine * x + cosine * y, z - 120.0, *rpm])
        .collect();
    let program = cut(Some((&setpoints("program", &rows), PlacementOptions::default())), "").expect("a wall");
    let machine = cut(Some((&setpoints("machine", &turned), placement)), "").expect("a wall");
    assert!((largest(&program) - largest(&machine)).abs() < 1e-5);
}

#[test]
fn of_several_passes_the_nearest_to_the_contour_is_the_finishing_one() {
    let rows = [pass(1.5, 800.0, 1500.0), pass(0.05, 400.0, 1500.0)].concat();
    let summary = cut(Some((&setpoints("program", &rows), PlacementOptions::default())), "").expect("a wall");
    let facts = summary.recorded.expect("facts");
    assert_eq!(facts.passes, 2);
    assert!((facts.farthest_mm - 0.05).abs() < 1e-3 && facts.from_s > 8.0, "{facts:?}");
    assert!(summary.warnings.iter().any(|w| w.contains("2 times")), "{:?}", summary.warnings);
}

#[test]
fn a_recording_without_the_pass_and_a_spindle_that_stands_are_told() {
    let code = |rows: &[[f64; 4]]| {
        let Err(Failure::Input(error)) = cut(Some((&setpoints("program", rows), PlacementOptions::default())), "")
        else {
            panic!("a wall")
        };
        error.code().to_owned()
    };
    let rows = pass(0.0, 400.0, 1500.0);
    assert_eq!(code(&rows[..rows.len() / 2]), "S006", "half a pass");
    let raised: Vec<[f64; 4]> = rows.iter().map(|[x, y, z, rpm]| [*x, *y, z + 1.0, *rpm]).collect();
    assert_eq!(code(&raised), "S006", "at another depth");
    let stopped: Vec<[f64; 4]> = rows.iter().map(|[x, y, z, _]| [*x, *y, *z, 0.0]).collect();
    assert_eq!(code(&stopped), "S007");
}
