//! `truepath image` and `truepath replay` from outside.

use std::fmt::Write;
use std::path::Path;

use crate::workplace::truepath;
use truepath_core::geometry::Point;
use truepath_core::image::{
    Binding, CorrectionLimits, FeedLaw, FineOffset, ImageNode, ImageSettings, PathWindow, build, image_bytes,
};
use truepath_core::units::{Offset, Position, Real};

const FEED_NM_PER_TICK: i64 = 10_000;

fn fine(nm: i64) -> FineOffset {
    FineOffset::checked_from_offset(Offset::from_nm(nm)).expect("in range")
}

/// 40 mm along X with 0.05 mm chip correction in Y that swells and fades like a lead.
fn nodes() -> Vec<ImageNode> {
    let node = |i: i64| {
        let ramp = (i.min(400 - i)).clamp(0, 100) * 500;
        let chip = [FineOffset::ZERO, fine(ramp)];
        ImageNode { point: Point::from_nm(i * 100_000, 5_000_000), chip, edge: [FineOffset::ZERO; 2] }
    };
    (0..=400).map(node).collect()
}

/// 10 mm/s at 1500 rev/min and 4 teeth: 0.1 mm a tooth.
fn settings() -> ImageSettings {
    let per_tooth = fine(100_000);
    ImageSettings {
        binding: Binding { program_crc: 0x1234_ABCD, feature: 1, pass: 1, tool: 4, tool_offset: 4, setup: 1 },
        closed: false,
        feed: FeedLaw::new(per_tooth, 4, 1_500_000, Real::ZERO, Real::ratio(1, 4), Real::from_int(2)),
        limits: CorrectionLimits {
            clamp: Offset::from_um(200),
            warn: Offset::from_um(150),
            slew_nm_per_s: 50_000_000,
            acceleration_nm_per_s2: 5_000_000_000,
        },
        window: PathWindow {
            tolerance: Offset::from_um(500),
            z_low: Position::from_nm(-10_000_000),
            z_high: Position::from_nm(-10_000_000),
            gate_height: Offset::from_um(20_000),
        },
        node_step: Offset::from_um(100),
    }
}

/// Down at the start, along the path, up: one row a millisecond. `shift` is added to every position, mm.
fn setpoints(frame: &str, shift: [i64; 3]) -> String {
    let mut text = format!("# frame = {frame}\nt_s,x_mm,y_mm,z_mm,spindle_rpm\n");
    let mut tick = 0;
    let mut put = |x: i64, z: i64| {
        let mm = |nm: i64, by: i64| (nm + by * 1_000_000) as f64 / 1e6;
        let (x, y, z) = (mm(x, shift[0]), mm(5_000_000, shift[1]), mm(z, shift[2]));
        let _ = writeln!(text, "{:.3},{x:.6},{y:.6},{z:.6},1500", f64::from(tick) * 0.001);
        tick += 1;
    };
    for k in 0..=2_000 {
        put(0, -k * 5_000);
    }
    for k in 1..=4_000 {
        put(k * FEED_NM_PER_TICK, -10_000_000);
    }
    for k in 1..=500 {
        put(40_000_000, -10_000_000 + k * 20_000);
    }
    text
}

fn desk() -> tempfile::TempDir {
    let desk = tempfile::tempdir().expect("a folder");
    let nodes = nodes();
    let mut bytes = vec![0; image_bytes(nodes.len())];
    build(&settings(), &nodes, &mut bytes).expect("an image");
    std::fs::write(desk.path().join("correction.tpi"), &bytes).expect("a file");
    bytes[300] ^= 1;
    std::fs::write(desk.path().join("damaged.tpi"), &bytes).expect("a file");
    std::fs::write(desk.path().join("in.csv"), setpoints("program", [0; 3])).expect("a file");
    std::fs::write(desk.path().join("machine.csv"), setpoints("machine", [100, -200, -300])).expect("a file");
    desk
}

fn json(output: &[u8]) -> serde_json::Value {
    serde_json::from_slice(output).unwrap_or_else(|e| panic!("{e}: {}", String::from_utf8_lossy(output)))
}

/// Rows of an output file as X, Y, Z, dX, dY in nanometres, and its state column.
fn rows(file: &Path) -> Vec<([i64; 5], String)> {
    let text = std::fs::read_to_string(file).expect("a file");
    let nm = |text: &str| (text.parse::<f64>().expect("a number") * 1e6).round() as i64;
    let row = |line: &str| {
        let fields: Vec<&str> = line.split(',').collect();
        (std::array::from_fn(|i| nm(fields[i + 1])), fields[6].to_owned())
    };
    text.lines().skip(2).map(row).collect()
}

#[test]
fn the_replayed_correction_is_the_one_of_the_image() {
    let desk = desk();
    let done = truepath(desk.path(), &["replay", "correction.tpi", "--setpoints", "in.csv", "-o", "out.csv", "--json"]);
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    let summary = json(&done.stdout);
    assert_eq!((summary["state"].as_str(), summary["reason"].as_u64()), (Some("Bypass"), Some(1)), "{summary}");
    let max = summary["max_correction_mm"].as_f64().expect("a number");
    assert!((max - 0.05).abs() < 2e-4, "{summary}");
    let rows = rows(&desk.path().join("out.csv"));
    assert_eq!(rows.len(), 6_501);
    for (index, (row, state)) in rows.iter().enumerate() {
        assert_eq!(row[1], 5_000_000 + row[4], "tick {index}: a correction is what was added");
        assert_eq!(row[3], 0);
        if (3_200..5_000).contains(&index) {
            assert_eq!(state, "Active");
            assert!((row[4] - 50_000).abs() <= 200, "tick {index}: {} nm", row[4]);
        }
    }
    let (last, state) = &rows[6_500];
    assert_eq!((last[4], state.as_str()), (0, "Bypass"));

    let done =
        truepath(desk.path(), &["replay", "correction.tpi", "--setpoints", "in.csv", "-o", "inch.csv", "--inch"]);
    let told = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(told.contains("largest 0.00197 in; ") && !told.contains(" mm"), "{told}");
    assert_eq!(self::rows(&desk.path().join("inch.csv")), rows, "files stay in millimetres");
}

#[test]
fn machine_coordinates_give_the_same_correction_where_the_program_stands() {
    let desk = desk();
    let replayed = |arguments: &[&str]| {
        let done = truepath(desk.path(), &[&["replay", "correction.tpi", "--json"], arguments].concat());
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    };
    replayed(&["--setpoints", "in.csv", "-o", "program-out.csv"]);
    replayed(&["--setpoints", "machine.csv", "-o", "machine-out.csv", "--origin-mm", "100,-200,-300"]);
    let program = rows(&desk.path().join("program-out.csv"));
    let machine = rows(&desk.path().join("machine-out.csv"));
    for ((p, _), (m, _)) in program.iter().zip(&machine) {
        assert_eq!([p[0] + 100_000_000, p[1] - 200_000_000, p[2] - 300_000_000], m[..3]);
        assert_eq!(p[3..], m[3..]);
    }
}

#[test]
fn a_file_in_the_wrong_coordinates_is_refused_or_stays_uncorrected() {
    let desk = desk();
    let run =
        |arguments: &[&str]| truepath(desk.path(), &[&["replay", "correction.tpi", "--json"], arguments].concat());
    for arguments in [
        &["--setpoints", "machine.csv", "-o", "a.csv"][..],
        &["--setpoints", "in.csv", "-o", "a.csv", "--origin-mm", "1,2,3"],
    ] {
        let refused = run(arguments);
        assert_eq!(refused.status.code(), Some(1));
        assert_eq!(json(&refused.stderr)["error"]["code"], "R003");
    }
    let elsewhere = run(&["--setpoints", "machine.csv", "-o", "b.csv", "--origin-mm", "0,0,0"]);
    let summary = json(&elsewhere.stdout);
    assert_eq!((summary["corrected_ticks"].as_u64(), summary["state"].as_str()), (Some(0), Some("Armed")));
    assert!(rows(&desk.path().join("b.csv")).iter().all(|(row, _)| row[3..] == [0, 0]));
}

#[test]
fn the_same_ticks_give_the_same_fingerprint_and_others_another() {
    let desk = desk();
    let digest = |setpoints: &str, out: &str| {
        let done = truepath(desk.path(), &["replay", "correction.tpi", "--setpoints", setpoints, "-o", out, "--json"]);
        json(&done.stdout)["digest"].clone()
    };
    let first = digest("in.csv", "1.csv");
    assert_eq!(first, digest("in.csv", "2.csv"));
    let text = std::fs::read_to_string(desk.path().join("in.csv")).expect("a file");
    std::fs::write(desk.path().join("other.csv"), text.replacen(",39.000000,", ",39.000001,", 1)).expect("a file");
    assert_ne!(first, digest("other.csv", "3.csv"));
}

/// The file with a column more, its value from the number of the tick, and a settings option: the summary.
fn disturbed(desk: &Path, name: &str, value: impl Fn(usize) -> u32, options: &[&str]) -> serde_json::Value {
    let text = std::fs::read_to_string(desk.join("in.csv")).expect("a file");
    let mut lines = text.lines();
    let mut out = format!("{}\n{},{name}\n", lines.next().unwrap_or(""), lines.next().unwrap_or(""));
    for (tick, line) in lines.enumerate() {
        let _ = writeln!(out, "{line},{}", value(tick));
    }
    std::fs::write(desk.join("disturbed.csv"), out).expect("a file");
    let usual = ["replay", "correction.tpi", "--setpoints", "disturbed.csv", "-o", "d.csv", "--json", "--force"];
    let done = truepath(desk, &[&usual, options].concat());
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    json(&done.stdout)
}

#[test]
fn what_the_controller_said_besides_the_positions_is_replayed() {
    let desk = desk();
    let usual = json(
        &truepath(desk.path(), &["replay", "correction.tpi", "--setpoints", "in.csv", "-o", "u.csv", "--json"]).stdout,
    );
    let reason = |name: &str, value: &dyn Fn(usize) -> u32| {
        let summary = disturbed(desk.path(), name, value, &[]);
        (summary["reason"].as_u64(), summary["fault"].as_bool(), summary["digest"] == usual["digest"])
    };
    let at = |tick: usize, value: u32, else_: u32| move |t: usize| if t == tick { value } else { else_ };
    // Drives enabled and spindle loaded are what a file without the column stands for.
    assert_eq!(reason("flags", &|_| 5), (Some(1), Some(false), true));
    assert_eq!(reason("flags", &at(4_000, 5 | 16, 5)), (Some(16), Some(true), false), "emergency stop");
    assert_eq!(reason("flags", &at(4_000, 5 | 8, 5)), (Some(17), Some(true), false), "abort");
    assert_eq!(reason("flags", &at(4_000, 5 | 64, 5)), (Some(18), Some(true), false), "tool change");
    assert_eq!(reason("flags", &at(4_000, 4, 5)), (Some(19), Some(true), false), "drives disabled");
    assert_eq!(reason("flags", &at(4_000, 5 | 32, 5)), (Some(3), Some(false), false), "end of the program");
    assert_eq!(reason("disarm", &at(4_000, 1, 0)), (Some(2), Some(false), false));
    let frame = truepath_core::rewrite::Frame::identity().crc;
    assert_eq!(reason("frame_crc", &|_| frame), (Some(1), Some(false), true));
    assert_eq!(reason("frame_crc", &at(4_000, frame ^ 1, frame)), (Some(20), Some(true), false));
}

#[test]
fn settings_of_the_machine_change_what_goes_out_and_wrong_ones_are_refused() {
    let desk = desk();
    let with = |settings: &[&str]| disturbed(desk.path(), "disarm", |_| 0, settings);
    let usual = with(&[]);
    // Y may go up to 5.02 mm: the correction of 0.05 mm does not fit.
    let limits =
        "joint_limits_nm=[[-9e18,9e18],[0,5020000],[0,0],[0,0],[0,0],[0,0]]".replace("9e18", "9000000000000000000");
    let limited = with(&["--setting", &limits]);
    assert_eq!((limited["reason"].as_u64(), usual["reason"].as_u64()), (Some(30), Some(1)));
    let slower = with(&["--setting", "fade_ticks=10", "--setting", "max_step=9999"]);
    assert_eq!(slower["reason"].as_u64(), Some(22), "10 000 nm a tick are a jump then");
    for (settings, code) in [
        (["--setting", "fade_tick=10"], "R004"),
        (["--setting", "fade_ticks"], "R004"),
        (["--setting", "fade_ticks=0"], "R001"),
    ] {
        let arguments = ["replay", "correction.tpi", "--setpoints", "in.csv", "-o", "x.csv", "--json"];
        let refused = truepath(desk.path(), &[&arguments[..], &settings].concat());
        assert_eq!((refused.status.code(), json(&refused.stderr)["error"]["code"].as_str()), (Some(1), Some(code)));
    }
}

#[test]
fn a_turn_in_whole_units_is_the_one_of_the_angle() {
    let desk = desk();
    let digest = |turn: &[&str], out: &str| {
        let place = ["replay", "correction.tpi", "--setpoints", "machine.csv", "-o", out, "--json", "--origin-mm"];
        let done = truepath(desk.path(), &[&place[..], &["105,-240,-300"], turn].concat());
        (json(&done.stdout)["corrected_ticks"].clone(), json(&done.stdout)["digest"].clone())
    };
    // The path of the file runs along +X of the machine; in a program turned by 0 it is the image's.
    let none = digest(&["--cosine", "1073741824", "--sine", "0"], "1.csv");
    assert_eq!(none, digest(&["--rotation-deg", "0"], "2.csv"));
    let refused = truepath(
        desk.path(),
        &[
            "replay",
            "correction.tpi",
            "--setpoints",
            "machine.csv",
            "-o",
            "3.csv",
            "--origin-mm",
            "0,0,0",
            "--cosine",
            "1",
            "--sine",
            "0",
        ],
    );
    assert_eq!(refused.status.code(), Some(1), "no rigid motion");
}

#[test]
fn an_image_is_shown_as_text_and_as_json() {
    let desk = desk();
    let shown = truepath(desk.path(), &["image", "correction.tpi"]);
    let text = String::from_utf8_lossy(&shown.stdout);
    assert!(text.contains("program_crc = 1234abcd\n") && text.contains("clamp_mm = 0.200000\n"), "{text}");
    assert!(text.contains("\n200 20.000000 5.000000 0.000000 0.050000 0.000000 0.000000\n"), "{text}");
    let object = json(&truepath(desk.path(), &["image", "correction.tpi", "--json"]).stdout);
    assert_eq!((object["program_crc"].as_str(), object["tool"].as_u64()), (Some("1234abcd"), Some(4)));
    assert_eq!(object["nodes"].as_array().map(Vec::len), Some(401));
    assert_eq!(object["nodes"][200][3].as_f64(), Some(0.05));
    assert_eq!(object["chip_factor"].as_array().map(Vec::len), Some(33));
}

#[test]
fn wrong_images_are_named_for_what_they_are() {
    let desk = desk();
    std::fs::write(desk.path().join("short.tpi"), b"TRUEPATH").expect("a file");
    for (file, code, words) in [
        ("damaged.tpi", "I006", "is damaged"),
        ("in.csv", "I003", "not a correction image"),
        ("short.tpi", "I002", "cut off"),
        ("missing.tpi", "F001", "cannot be read"),
    ] {
        for command in
            [&["image", file, "--json"][..], &["replay", file, "--setpoints", "in.csv", "-o", "x.csv", "--json"]]
        {
            let refused = truepath(desk.path(), command);
            assert_eq!(refused.status.code(), Some(1));
            let error = &json(&refused.stderr)["error"];
            assert_eq!(error["code"], code, "{error}");
            assert!(error["message"].as_str().is_some_and(|m| m.contains(file) && m.contains(words)), "{error}");
        }
    }
    assert!(!desk.path().join("x.csv").exists());
}
