//! A wall made by passes too shallow for the ball of a probe.

use serde_json::Value;

use crate::workplace::{Workplace, plant, pocket_job};

/// A rounded pocket, cut at depths of 1.5 mm.
fn pocket(depths: u32) -> String {
    let around = "G3 X30 Y4 I2 J0 F700\nG1 X50\nG3 X56 Y10 I0 J6\nG1 Y30\nG3 X50 Y36 I-6 J0\nG1 X10\nG3 X4 Y30 I0 J-6\n\
        G1 Y10\nG3 X10 Y4 I6 J0\nG1 X30\nG3 X32 Y6 I0 J2\n";
    let pass = |k| format!("G0 X28 Y6\nG1 Z{:.1} F300\n{around}", -1.5 * f64::from(k));
    let passes: String = (1..=depths).map(pass).collect();
    format!("G21 G90 G17\nT2 M6\nS9000 M3\nG0 X28 Y6 Z10\n{passes}G0 Z10\nM30\n")
}

fn workplace(depths: u32) -> Workplace {
    let plant = plant("[[0.0016, 0.00002], [0.00002, 0.0014]]");
    Workplace::with(&[("part.nc", &pocket(depths)), ("job.toml", &pocket_job(1.5, 600)), ("plant.toml", &plant)])
}

#[test]
fn shallow_passes_are_touched_over_the_wall_they_make_together() {
    let desk = workplace(8);
    let call = |arguments: &str| desk.call(arguments);
    let plan = call("probe job.toml --dialect linuxcnc -o verify.nc");
    let points = plan["points"].as_array().expect("points");
    for point in points {
        let (z, above) = (point["z_mm"].as_f64().unwrap(), point["height_mm"].as_f64().unwrap());
        // Clear of the floor at Z-12 and below the upper end at Z0; as high above the tip of its pass as it says.
        assert!((-10.5..=-1.0).contains(&z), "{z}");
        let tip = -1.5 * (-z / 1.5).ceil();
        assert!((z - tip - above).abs() < 1e-6, "Z{z} is {above} above the tip at Z{tip}");
        assert!((0.2..=1.3).contains(&above), "{above}");
    }
    let first = call("simulate job.toml --plant plant.toml --touch verify.nc -o first");
    let done = call("correct job.toml --probe first/probe.txt -o out");
    assert_eq!(done["points_used"].as_u64(), Some(points.len() as u64), "no point is set aside");
    assert_eq!(done["feature"]["passes_corrected"].as_array().expect("passes").len(), 8);
    let second = call("simulate job.toml --plant plant.toml --from out -o second");
    let error = |summary: &Value| summary["judged"]["max_error_mm"].as_f64().expect("a wall");
    assert!(error(&second) < 0.25 * error(&first), "{} became {}", error(&first), error(&second));
}

#[test]
fn one_shallow_pass_alone_has_no_room_for_the_ball() {
    let desk = workplace(1);
    let said = desk.run("probe job.toml --dialect linuxcnc -o verify.nc").expect_err("no room");
    assert!(said.contains("V002"), "{said}");
    assert!(!said.contains("as one of"), "no ball has: {said}");
}
