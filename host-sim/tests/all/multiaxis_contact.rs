//! `truepath multiaxis --normal`: where a ball end touches a surface, told of a whole program.

use std::process::{Command, Output};

const MACHINE: &str = "version = 1\nkind = \"table-table\"\n[[rotary]]\naxis = \"A\"\n[[rotary]]\naxis = \"C\"\n";
const BALL: &str = "[tool]\nball_radius_mm = 4\nhelix_deg = 30\n";
/// A tilts the part by 10 to 40 degrees under the upright tool.
const PROGRAM: &str = "G21 G90 G94 F500\nG0 X0 Y0 Z10 A10 C0\nG1 X1 A20\nG1 X2 A40 C5\nG1 X3 A30\nM2\n";

fn run(machine: &str, more: &[&str]) -> Output {
    let folder = tempfile::tempdir().expect("a folder");
    let (program, file) = (folder.path().join("p.nc"), folder.path().join("m.toml"));
    std::fs::write(&program, PROGRAM).expect("written");
    std::fs::write(&file, machine).expect("written");
    let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
    command.arg("multiaxis").arg(program).arg("--machine").arg(file).args(["--tolerance", "0.01", "--json"]);
    command.args(more).output().expect("started")
}

#[test]
fn the_contact_point_on_a_floor_is_as_far_from_the_tip_as_the_part_tilts() {
    let output = run(&format!("{MACHINE}{BALL}"), &["--normal", "0,0,1"]);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a summary");
    let contact = &summary["contact"];
    let near = |value: &serde_json::Value, expected: f64| (value.as_f64().expect("a number") - expected).abs() < 1e-9;
    // Three moves have six ends; θ is the tilt, the cutting radius R sin θ, the lag tan β₀ (1 − cos θ).
    assert_eq!((contact["places"].as_u64(), contact["on_shank"].as_u64()), (Some(6), Some(0)));
    for (i, tilt) in [10f64, 40.0].into_iter().enumerate() {
        let tilt_rad = tilt.to_radians();
        let lag = 30f64.to_radians().tan() * (1.0 - tilt_rad.cos());
        assert!(near(&contact["polar_deg"][i], tilt), "{contact}");
        assert!(near(&contact["cutting_radius_mm"][i], 4.0 * tilt_rad.sin()), "{contact}");
        assert!(near(&contact["lag_deg"][i], lag.to_degrees()), "{contact}");
    }
}

#[test]
fn without_a_normal_there_is_no_contact_point() {
    let output = run(&format!("{MACHINE}{BALL}"), &[]);
    let summary: serde_json::Value = serde_json::from_slice(&output.stdout).expect("a summary");
    assert!(output.status.success() && summary["contact"].is_null());
}

#[test]
fn a_normal_of_no_use_is_an_error() {
    for (machine, normal, said) in [
        (MACHINE.to_owned(), "0,0,1", "A014"),
        (format!("{MACHINE}{BALL}"), "0,0,0", "A014"),
        (format!("{MACHINE}{BALL}"), "0,1", "three numbers"),
        (format!("{MACHINE}{BALL}"), "nan,0,1", "three numbers"),
        (format!("{MACHINE}{BALL}"), "0,0,1,2", "three numbers"),
    ] {
        let output = run(&machine, &["--normal", normal]);
        let error = String::from_utf8_lossy(&output.stderr).into_owned();
        let usage = said == "three numbers";
        assert_eq!(output.status.code(), Some(if usage { 2 } else { 1 }), "{normal}: {error}");
        assert!(error.contains(said), "{normal}: {error}");
    }
}
