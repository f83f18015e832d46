//! What is told about a slot beyond its shift: where its coefficients come from, heights of one wall, a table that is not
//! used, what one value leaves.

use std::path::Path;
use std::process::Command;

use serde_json::Value;

/// The slot of the examples with its job changed: the summary and what was said beside it.
fn slot(change: impl Fn(String) -> String, more: &[&str]) -> (Value, String) {
    let example = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/pocket/slot");
    let desk = tempfile::tempdir().expect("a folder");
    let job = std::fs::read_to_string(example.join("job.toml")).expect("a job");
    std::fs::write(desk.path().join("job.toml"), change(job)).expect("a job");
    std::fs::copy(example.join("slot.nc"), desk.path().join("slot.nc")).expect("a program");
    let done = Command::new(env!("CARGO_BIN_EXE_truepath"))
        .args(["--json", "pocket", "job.toml", "-o", "out"])
        .args(more)
        .current_dir(desk.path())
        .output()
        .expect("the program runs");
    let said = String::from_utf8_lossy(&done.stderr).into_owned();
    assert_eq!(done.status.code(), Some(0), "{said}");
    (serde_json::from_slice(&done.stdout).expect("JSON"), said)
}

#[test]
fn the_error_over_the_height_is_that_of_one_wall_and_not_the_distance_of_two() {
    // Independent sums over rotation, height and teeth, cutter by integrating M/EI twice: over 12 heights the walls of a
    // straight slot spread by 0.021535 mm with two teeth, by 0.003750 (near) and 0.025266 (far) with three.
    for (teeth, spread) in [(2, 0.021535), (3, 0.025266)] {
        let (summary, _) = slot(|job| job.replace("teeth = 4", &format!("teeth = {teeth}")), &[]);
        let straight = &summary["sections"][0];
        let found = straight["height_error_mm"].as_f64().expect("a number");
        assert!((found - spread).abs() < 2e-4, "{teeth} teeth: {found}, {spread}");
    }
}

#[test]
fn an_allowance_for_a_slot_is_said_to_be_unused() {
    let (plain, said) = slot(|job| job, &[]);
    assert!(!said.contains("[stock]"), "{said}");
    let (with, said) = slot(|job| format!("{job}\n[stock]\nallowance_mm = 0.3\n"), &[]);
    assert!(said.contains("[stock] is not used"), "{said}");
    assert_eq!(plain["sections"], with["sections"]);
}

#[test]
fn what_one_value_a_section_leaves_is_not_blamed_on_the_cutter() {
    let (summary, _) = slot(|job| job, &["--per-section", "constant", "--tolerance", "0.005"]);
    let rows = summary["sections"].as_array().expect("sections");
    let out: Vec<&Value> = rows.iter().filter(|row| row["in_band_after"] == false).collect();
    assert!(!out.is_empty());
    // Four teeth: a slot as wide as the cutter, whatever a jump of the shift leaves at its ends.
    assert!(rows.iter().all(|row| row["narrower_mm"].as_f64().is_some_and(|v| v.abs() < 0.001)), "{rows:?}");
    for row in out {
        assert!(row["reason"].as_str().is_some_and(|r| r.contains("one value is not enough")), "{row}");
    }
}

#[test]
fn the_coefficients_of_the_papers_case_follow_from_its_strength() {
    // Shear strength of 469 MPa by von Mises, Merchant's shear angle 45° − (β − α)/2 with rake α 10° and friction β 30°.
    let shear = 469.0 / 3f64.sqrt();
    let difference = 20f64.to_radians();
    let angle = std::f64::consts::FRAC_PI_4 - difference / 2.0;
    let common = shear / (angle.sin() * (angle + difference).cos());
    let [ktc, krc] = [common * difference.cos(), common * difference.sin()];
    assert!((ktc - 774.0).abs() < 1.0 && (krc - 282.0).abs() < 1.0, "{ktc} {krc}");
}
