//! `truepath probe` as a user calls it.

use super::parts::POCKET;
use crate::workplace::truepath;

fn part() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    std::fs::write(folder.path().join("job.toml"), POCKET[0]).unwrap();
    std::fs::write(folder.path().join("program.nc"), POCKET[1]).unwrap();
    folder
}

#[test]
fn the_points_are_listed_with_their_reasons() {
    let folder = part();
    let call = ["probe", "job.toml", "--dialect", "haas", "-o", "verify.nc", "--points", "4", "--heights", "2"];
    let json = truepath(folder.path(), &[&call[..], &["--json"]].concat());
    assert!(json.status.success(), "{}", String::from_utf8_lossy(&json.stderr));
    let report: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    let points = report["points"].as_array().unwrap();
    assert_eq!((points.len(), report["probe_format"].as_str()), (8, Some("dprnt")));
    for point in points {
        assert!(!point["why"].as_str().unwrap().is_empty() && !point["why_height"].as_str().unwrap().is_empty());
    }
    assert!(report["wall_sigma_after_mm"].as_f64() < report["wall_sigma_before_mm"].as_f64());
    let program = std::fs::read_to_string(folder.path().join("verify.nc")).unwrap();
    assert_eq!(program.matches("DPRNT[G801").count(), 8);

    // For people the same, and nothing is overwritten.
    let again = truepath(folder.path(), &call);
    assert_eq!(again.status.code(), Some(1));
    assert!(String::from_utf8_lossy(&again.stderr).contains("F003"));
    let words = truepath(folder.path(), &[&call[..], &["--force"]].concat());
    let words = String::from_utf8_lossy(&words.stdout).into_owned();
    assert!(words.contains("tells stiffness") && words.contains("kept off") && words.contains("Z100.000"), "{words}");
}

#[test]
fn a_wrong_choice_is_named_and_nothing_is_written() {
    let folder = part();
    let call = |more: &[&str]| {
        let said = truepath(folder.path(), &[&["probe", "job.toml", "-o", "verify.nc"], more].concat());
        let shown = String::from_utf8_lossy(&said.stderr).into_owned();
        assert_eq!(
            said.status.code(),
            Some(if shown.contains("C001") || shown.contains("possible values") { 2 } else { 1 }),
            "{shown}"
        );
        shown
    };
    let unknown = call(&["--dialect", "heidenhain"]);
    assert!(unknown.contains("heidenhain") && unknown.contains("haas, fanuc, linuxcnc, grbl"), "{unknown}");
    assert!(
        call(&["--dialect", "grbl", "--clearance", "0.2"])
            .contains("--clearance is 0.2 mm; expected 1 to 50 mm (0.0394 to 1.96 in)")
    );
    assert!(call(&["--dialect", "grbl", "--safe-z", "-3"]).contains("--safe-z -3 is not above the wall"));
    assert!(call(&["--dialect", "grbl", "--probe-tool", "9"]).contains("grbl changes no tools"));
    assert_eq!(std::fs::read_dir(folder.path()).unwrap().count(), 2, "job and program");
}

#[test]
fn further_places_are_listed_without_a_control_and_written_for_one() {
    let folder = part();
    let call = |more: &[&str]| truepath(folder.path(), &[&["probe", "job.toml", "--next"], more].concat());
    let refused = call(&[]);
    assert_eq!(refused.status.code(), Some(2));
    assert!(String::from_utf8_lossy(&refused.stderr).contains("--probe"));
    let pass = super::parts::pass(POCKET, &[]);
    let machine = toml::from_str(include_str!("../../../demo/pocket/plant.toml")).unwrap();
    let milled = truepath_trial::virtual_mill::mill(&pass, &machine, None).unwrap();
    let probe = truepath_trial::virtual_mill::probe(&pass, &milled, &[12.0, 180.0], &[0.3, 0.8], 4.0).unwrap();
    std::fs::write(folder.path().join("probe.txt"), probe).unwrap();
    let measured = ["--probe", "probe.txt", "--points", "2", "--heights", "2"];
    let words = call(&measured);
    let words = String::from_utf8_lossy(&words.stdout).into_owned();
    assert!(words.contains("corrected wall least certain at s =") && !words.contains("written to"), "{words}");
    let json = call(&[&measured[..], &["--dialect", "grbl", "-o", "next.nc", "--json"]].concat());
    let report: serde_json::Value = serde_json::from_slice(&json.stdout).unwrap();
    let gain = &report["points"][0]["gain"];
    assert!(gain["max_sigma_after_mm"].as_f64() < gain["max_sigma_before_mm"].as_f64(), "{report}");
    let program = std::fs::read_to_string(folder.path().join("next.nc")).unwrap();
    assert_eq!(program.matches(";VERIFY").count() - 3, report["points"].as_array().unwrap().len(), "{program}");
}
