//! `truepath pocket` from outside: the examples, their numbers, and what an independent machine makes of them.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use serde_json::Value;

fn examples() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/pocket")
}

fn truepath(arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_truepath")).args(arguments).output().expect("the program runs")
}

/// A desk with job and program; `change` edits the job's text.
fn desk(example: &str, change: impl Fn(String) -> String) -> tempfile::TempDir {
    let desk = tempfile::tempdir().expect("a folder");
    for entry in std::fs::read_dir(examples().join(example)).expect("the example") {
        let path = entry.expect("an entry").path();
        if path.is_file() {
            let text = std::fs::read_to_string(&path).expect("a text");
            let job = path.ends_with("job.toml");
            let text = if job { change(text) } else { text };
            std::fs::write(desk.path().join(path.file_name().expect("a name")), text).expect("written");
        }
    }
    desk
}

/// Runs the command on a desk, into `out`.
fn pocket(desk: &Path, more: &[&str]) -> Output {
    let (job, out) = (desk.join("job.toml"), desk.join("out"));
    let mut arguments = vec!["pocket", job.to_str().expect("UTF-8"), "-o", out.to_str().expect("UTF-8"), "--json"];
    arguments.extend(more);
    truepath(&arguments)
}

fn summary(desk: &Path, more: &[&str]) -> Value {
    let done = pocket(desk, more);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    serde_json::from_slice(&done.stdout).expect("JSON")
}

fn number(value: &Value) -> f64 {
    value.as_f64().unwrap_or(f64::NAN)
}

fn sections<'a>(summary: &'a Value, kind: &str) -> Vec<&'a Value> {
    summary["sections"].as_array().expect("sections").iter().filter(|s| s["kind"] == kind).collect()
}

/// The numbers of correction.csv; NaN where there is none.
fn rows(desk: &Path) -> Vec<Vec<f64>> {
    let table = std::fs::read_to_string(desk.join("out/correction.csv")).expect("a table");
    let numbers = |line: &str| line.split(',').map(|t| t.parse().unwrap_or(f64::NAN)).collect();
    table.lines().skip(1).map(numbers).collect()
}

fn unchanged(text: String) -> String {
    text
}

#[test]
fn the_slot_of_the_paper_is_shifted_back_to_its_place_on_both_walls() {
    let desk = desk("slot", unchanged);
    let summary = summary(desk.path(), &[]);
    for straight in sections(&summary, "straight") {
        // Both walls are displaced by the same in opposite senses, by what the cutter bends under 324 N.
        let (near, far) = (number(&straight["error_before_mm"]), number(&straight["far_error_before_mm"]));
        assert!((near - 0.0438).abs() < 2e-4 && (near + far).abs() < 2e-4, "{straight}");
        assert!((number(&straight["force_n"]) - 323.7).abs() < 0.5, "{straight}");
        assert_eq!((&straight["in_band_before"], &straight["shifted"]), (&Value::Bool(false), &Value::Bool(true)));
        assert!((number(&straight["shift_max_mm"]) - 0.0438).abs() < 3e-3, "{straight}");
        assert!(number(&straight["error_after_mm"]).abs() < 0.005, "{straight}");
        // An even number of teeth keeps the width, but for where the slot runs into its beginning.
        let last = straight["section"] == "S5";
        assert!(last || number(&straight["narrower_mm"]).abs() < 2e-4, "{straight}");
    }
    let corners = sections(&summary, "corner");
    assert_eq!(corners.len(), 4);
    // On an arc tighter than the cutter the engagement lies between that of a wall and of a slot.
    for corner in corners {
        let least = number(&corner["engaged_min_deg"]);
        assert!((140.0..170.0).contains(&least), "{corner}");
    }
    assert_eq!(sections(&summary, "change").len(), 1, "the end of the loop runs into its beginning");
    assert_eq!(summary["in_band"], true);
    for name in ["corrected.nc", "difference.txt", "correction.csv", "sections.csv", "summary.json", "before-after.svg"]
    {
        assert!(desk.path().join("out").join(name).is_file(), "{name}");
    }
}

#[test]
fn the_straight_walls_of_the_finishing_pass_stay_and_its_corners_are_shifted() {
    let desk = desk("finish", unchanged);
    let summary = summary(desk.path(), &[]);
    let (straights, corners) = (sections(&summary, "straight"), sections(&summary, "corner"));
    assert_eq!((straights.len(), corners.len()), (5, 4));
    for straight in straights {
        assert_eq!((&straight["shifted"], &straight["in_band_after"]), (&Value::Bool(false), &Value::Bool(true)));
        assert_eq!((number(&straight["shift_min_mm"]), number(&straight["shift_max_mm"])), (0.0, 0.0));
        assert_eq!(straight["error_before_mm"], straight["error_after_mm"]);
    }
    for corner in corners {
        assert!((number(&corner["error_before_mm"]) - 0.031).abs() < 5e-4, "{corner}");
        assert_eq!((&corner["shifted"], &corner["in_band_after"]), (&Value::Bool(true), &Value::Bool(true)));
    }
    // Away from the corners the corrected program runs on the very path of the original.
    let job = truepath_job::job::JobFile::read(&desk.path().join("job.toml")).expect("a job");
    let pass = truepath_job::pass::Pass::read(job).expect("a pass");
    let text = std::fs::read(desk.path().join("out/corrected.nc")).expect("a program");
    let path = truepath_trial::virtual_mill::commanded(&pass, &text).expect("a contour");
    let walls = path.iter().filter(|p| p[0].abs() < 24.0 || p[1].abs() < 14.0);
    let off = walls.map(|p| if p[0].abs() < 24.0 { (p[1].abs() - 20.0).abs() } else { (p[0].abs() - 30.0).abs() });
    // A written path lies within correct.tolerance_mm, 1 µm, of the wanted one.
    assert!(off.fold(0.0, f64::max) < 0.001);
    // No jump: two points 0.02 mm apart on the program are nowhere farther apart on the path.
    let steps = path.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]));
    assert!(steps.fold(0.0, f64::max) < 0.021);
}

#[test]
fn a_wide_band_leaves_everything_as_it_is_and_writes_no_program() {
    let desk = desk("finish", unchanged);
    let summary = summary(desk.path(), &["--tolerance", "0.2"]);
    assert_eq!((number(&summary["sections_shifted"]), &summary["program"]), (0.0, &Value::Null));
    assert!(!desk.path().join("out/corrected.nc").exists() && desk.path().join("out/sections.csv").is_file());
}

#[test]
fn a_narrow_band_shifts_all_sections_and_brings_them_into_it() {
    for tolerance in [0.008, 0.003] {
        let desk = desk("finish", |job| job.replace("tolerance_mm = 0.02", &format!("tolerance_mm = {tolerance}")));
        let summary = summary(desk.path(), &[]);
        assert_eq!(number(&summary["sections_shifted"]), 9.0);
        assert!(number(&summary["max_error_after_mm"]) < tolerance, "{tolerance}: {}", summary["max_error_after_mm"]);
    }
}

#[test]
fn one_value_a_section_does_for_straight_walls_and_less_for_corners() {
    let desk = desk("finish", |job| job.replace("tolerance_mm = 0.02", "tolerance_mm = 0.008"));
    let summary = summary(desk.path(), &["--per-section", "constant"]);
    for straight in sections(&summary, "straight") {
        assert!(number(&straight["error_after_mm"]).abs() < 0.008, "{straight}");
    }
    for corner in sections(&summary, "corner") {
        let (before, after) = (number(&corner["error_before_mm"]), number(&corner["error_after_mm"]));
        assert!(after.abs() < 0.5 * before && after.abs() > 0.002, "{corner}");
    }
}

#[test]
fn the_mean_force_in_a_slot_and_its_shift_are_the_reference_ones() {
    // D25, 2 teeth, 45 degrees, 3 mm deep, 0.125 mm per tooth, wall on the left: mean -84.152 N along the feed and
    // 209.882 N along the normal. The cutter alone bends: its wall is cut deeper by exactly the mean deflection.
    let desk = tempfile::tempdir().expect("a folder");
    let program = "%\nG21 G90 G17\nS1000 M03\nG00 X0 Y0 Z5\nG01 Z-3 F100\nG01 X60 F250\nG00 Z5\nM30\n%\n";
    let job = "version = 1\nprogram = \"slot.nc\"\nwall = \"left\"\n[tool]\ndiameter_mm = 25\nteeth = 2\nhelix_deg = 45\n\
               material = \"HSS\"\nstickout_mm = 70\n[cut]\naxial_depth_mm = 3\n[force]\nktc_n_per_mm2 = 958.86\n\
               krc_n_per_mm2 = 250.863\nkte_n_per_mm = 15.758\nkre_n_per_mm = 19.434\nmodel = \"mean\"\n\
               [pocket]\nmode = \"slot\"\ntolerance_mm = 0.002\n";
    std::fs::write(desk.path().join("slot.nc"), program).expect("written");
    std::fs::write(desk.path().join("job.toml"), job).expect("written");
    let summary = summary(desk.path(), &[]);
    let straight = sections(&summary, "straight")[0];
    assert!((number(&straight["force_n"]) - 84.152f64.hypot(209.882)).abs() < 0.01, "{straight}");
    // P·L³/3EI of the equivalent diameter, for a load in the middle of the depth, and the mean over the depth instead of
    // the tip: u²(3 − u)/2 and, to first order in b/L, the same once more.
    let (d, length, depth) = (0.89 * 25.0f64, 70.0f64, 3.0f64);
    let tip = length.powi(3) / (3.0 * 215_000.0 * std::f64::consts::PI / 64.0 * d.powi(4));
    let u = 1.0 - depth / (2.0 * length);
    let mean = tip * u.powi(3);
    let deflection = number(&straight["deflection_mm"]);
    assert!((deflection / (209.882 * mean) - 1.0).abs() < 2e-3, "{deflection} {}", 209.882 * mean);
    assert!((number(&straight["error_before_mm"]) + deflection).abs() < 2e-5, "{straight}");
    assert!((number(&straight["far_error_before_mm"]) - deflection).abs() < 2e-5, "{straight}");
    assert!((number(&straight["shift_min_mm"]) + deflection).abs() < 2e-5, "{straight}");
    assert!(number(&straight["error_after_mm"]).abs() < 2e-5, "{straight}");
}

#[test]
fn an_odd_number_of_teeth_changes_the_width_of_the_slot_and_no_shift_corrects_that() {
    let desk = desk("slot", |job| job.replace("teeth = 4", "teeth = 3"));
    let summary = summary(desk.path(), &[]);
    // In the middle of the longest wall.
    let row = rows(desk.path()).into_iter().find(|row| row[0] > 128.0).expect("a station");
    let [before, after] = [[row[8], row[10]], [row[9], row[11]]];
    assert!((before[0] + before[1]).abs() > 0.005, "{before:?}");
    assert!((before[0] + before[1] - after[0] - after[1]).abs() < 2e-5, "{before:?} {after:?}");
    // The position is corrected: what is left is the same on both walls.
    assert!((after[0] - after[1]).abs() < 2e-4, "{after:?}");
    assert!(number(&sections(&summary, "straight")[2]["narrower_mm"]).abs() > 0.005);
}

#[test]
fn a_slot_with_square_corners_keeps_its_path_in_one_piece() {
    let desk = desk("slot", unchanged);
    let program =
        "%\nG21 G90 G17\nS2000 M03\nG00 X0 Y0 Z5\nG01 Z-6 F60\nG01 X50 F400\nG01 Y40\nG01 X0\nG00 Z5\nM30\n%\n";
    std::fs::write(desk.path().join("slot.nc"), program).expect("written");
    let summary = summary(desk.path(), &[]);
    let least = sections(&summary, "sharp").iter().map(|s| number(&s["engaged_min_deg"])).fold(f64::MAX, f64::min);
    assert!(least < 110.0, "{least}");
    // What is left there is not passed over in silence.
    let left = number(&summary["max_error_sharp_mm"]);
    assert_eq!(summary["in_band"] == true, left <= 0.02, "{left}");
    assert!(left > 0.001, "{left}");
    let points: Vec<[f64; 2]> = rows(desk.path()).iter().map(|row| [row[1] + row[3], row[2] + row[4]]).collect();
    let steps = points.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]));
    assert!(steps.fold(0.0, f64::max) < 0.12);
}

#[test]
fn correct_without_a_probe_is_the_same_command() {
    let desk = desk("slot", unchanged);
    summary(desk.path(), &[]);
    let (job, out) = (desk.path().join("job.toml"), desk.path().join("same"));
    let arguments = ["correct", job.to_str().expect("UTF-8"), "--no-probe", "-o", out.to_str().expect("UTF-8")];
    let done = truepath(&arguments);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let read = |folder: &str| std::fs::read(desk.path().join(folder).join("corrected.nc")).expect("a program");
    assert_eq!(read("out"), read("same"));
    let text = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(text.contains("C1        corner") && text.contains("coefficients +20 %"), "{text}");
}

#[test]
fn what_cannot_be_compensated_is_said_with_its_code_and_nothing_is_written() {
    let cases: [(&str, &str, &str, &[&str], &str); 8] = [
        ("finish", "stickout_mm = 42.0\nflute_length_mm = 26.0\n", "", &[], "J008"),
        ("finish", "material = \"carbide\"\nstickout_mm = 42.0\nflute_length_mm = 26.0\n", "", &[], "D001"),
        ("finish", "stickout_mm = 42.0", "stickout_mm = 150.0", &[], "D002"),
        ("finish", "stickout_mm = 42.0", "stickout_mm = 20.0", &[], "J008"),
        ("slot", "tolerance_mm", "clamp_mm = 0.01 # ", &[], "J003"),
        ("slot", "[pocket]", "[correct]\nclamp_mm = 0.01\n[pocket]", &[], "D006"),
        ("slot", "", "", &["--tolerance", "0"], "D004"),
        ("slot", "", "", &["--tolerance", "-0.01"], "D004"),
    ];
    for (example, from, to, more, code) in cases {
        let desk = desk(example, |job| if from.is_empty() { job } else { job.replace(from, to) });
        let failed = pocket(desk.path(), more);
        let text = String::from_utf8_lossy(&failed.stderr).into_owned();
        assert_eq!(failed.status.code(), Some(1), "{code}: {text}");
        let error: Value = serde_json::from_str(text.lines().last().unwrap_or_default()).expect("JSON");
        assert_eq!(error["error"]["code"], code, "{text}");
        assert!(!desk.path().join("out").exists(), "{code}");
    }
    for tolerance in ["nan", "inf", "1e9", "1e-12"] {
        let desk = desk("slot", unchanged);
        let failed = pocket(desk.path(), &["--tolerance", tolerance]);
        assert_eq!(failed.status.code(), Some(1), "{tolerance}");
    }
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn unusual_numbers_end_in_an_answer_or_an_error_of_the_input() {
    let cases = [
        ("slot", "stickout_mm = 45.0", "stickout_mm = 499.0"),
        ("slot", "flute_length_mm = 26.0", "flute_length_mm = 0.001"),
        ("slot", "axial_depth_mm = 6.0", "axial_depth_mm = 0.000001"),
        ("slot", "axial_depth_mm = 6.0", "axial_depth_mm = 45.0"),
        ("slot", "ktc_n_per_mm2 = 774", "ktc_n_per_mm2 = 20000"),
        ("slot", "kre_n_per_mm = 7.83", "kre_n_per_mm = 500"),
        ("slot", "teeth = 4", "teeth = 1"),
        ("slot", "diameter_mm = 12.0", "diameter_mm = 100.0"),
        ("slot", "diameter_mm = 12.0", "diameter_mm = 0.1"),
        ("finish", "allowance_mm = 0.3", "allowance_mm = 9.9"),
        ("finish", "allowance_mm = 0.3", "allowance_mm = 0.000001"),
        ("finish", "diameter_mm = 10.0", "diameter_mm = 1.0"),
        ("finish", "stiffness_x_n_per_mm = 9000", "stiffness_x_n_per_mm = 10"),
        ("finish", "tolerance_mm = 0.02", "tolerance_mm = 0.000001"),
    ];
    for (example, from, to) in cases {
        let desk = desk(example, |job| job.replace(from, to));
        let done = pocket(desk.path(), &[]);
        let code = done.status.code();
        assert!(code == Some(0) || code == Some(1), "{to}: {code:?} {}", String::from_utf8_lossy(&done.stderr));
    }
}

#[test]
fn materials_are_listed_with_their_sources() {
    let done = truepath(&["pocket", "--materials"]);
    let text = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(text.contains("al-6061-t6         243.77") && text.contains("10.1186/s10033-021-00536-9"), "{text}");
    assert!(text.contains("600…1319"), "{text}");
    let rows: Value = serde_json::from_slice(&truepath(&["pocket", "--materials", "--json"]).stdout).expect("JSON");
    let named = |row: &Value| row["source"].as_str().is_some_and(|s| s.len() > 10);
    assert!(rows.as_array().is_some_and(|rows| rows.len() >= 7 && rows.iter().all(named)), "{rows}");
}
