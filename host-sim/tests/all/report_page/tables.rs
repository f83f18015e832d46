//! Figures of the page are those of the tables and the summary beside it.

use std::fs;
use std::path::Path;

use serde_json::Value;
use truepath_job::job::Route;

use super::part::{Part, pocket};
use super::reading::{column, data, in_mm, table, words};

/// The columns of the page and those of `correction.csv`.
fn same_as_correction(page: &Value, folder: &Path) {
    let file = folder.join("correction.csv");
    let contour = &page["contour"];
    let pairs = [
        (&contour["s_mm"], "s_mm"),
        (&contour["x_mm"], "x_mm"),
        (&contour["y_mm"], "y_mm"),
        (&contour["correction_x_mm"], "dx_mm"),
        (&contour["correction_y_mm"], "dy_mm"),
        (&contour["before"]["error_mm"], "predicted_error_before_mm"),
        (&contour["after"]["error_mm"], "predicted_error_after_mm"),
        (&contour["after"]["sigma_mm"], "sigma_mm"),
    ];
    for (shown, name) in pairs {
        assert_eq!(column(shown), table(&file, name), "{name}");
        assert_eq!(shown["decimals"], 6, "{name}");
    }
    let rows = table(&file, "s_mm").len();
    for pass in ["before", "after"] {
        for name in ["arc_deg", "chip_area_mm2", "force_n", "fx_n", "fy_n", "dx_mm", "dy_mm", "feed_mm_per_min"] {
            let values = column(&contour[pass][name]);
            assert!(values.len() == rows && values.iter().all(Option::is_some), "{pass} {name}");
        }
    }
}

/// The points of the page and those of `points.csv`.
fn same_as_points(page: &Value, folder: &Path, depth_mm: f64) {
    let file = folder.join("points.csv");
    let points = page["points"].as_array().unwrap();
    let (status, reason) = (words(&file, "status"), words(&file, "reason"));
    assert_eq!(points.len(), status.len());
    for name in ["line", "s_mm", "x_mm", "y_mm", "nx", "ny", "error_mm"] {
        let shown: Vec<Option<f64>> = points.iter().map(|p| p[name].as_f64()).collect();
        assert_eq!(shown, table(&file, name), "{name}");
    }
    for ((point, height), (status, reason)) in points.iter().zip(table(&file, "height")).zip(status.iter().zip(&reason))
    {
        assert_eq!(point["status"], if status == "aside" { "aside" } else { "used" });
        assert_eq!(in_mm(&point["reason"]), reason);
        let z = point["z_mm"].as_f64();
        assert_eq!(z.is_some(), height.is_some());
        assert!(z.zip(height).is_none_or(|(z, height)| (z - height * depth_mm).abs() < 1e-5));
    }
}

/// Warnings and parameters of the page and those of `summary.json`.
fn same_as_summary(page: &Value, folder: &Path) -> Value {
    let summary: Value = serde_json::from_slice(&fs::read(folder.join("summary.json")).unwrap()).unwrap();
    // The page names files without their folders; all of a test lie in one.
    let parent = format!("{}/", folder.parent().unwrap().display());
    // What has lengths is said in both units, first in that of the program, which is the millimetre.
    let of_text = |text: &Value| text.as_str().or_else(|| text[0].as_str()).unwrap().to_owned();
    let words = |of: &Value| -> Vec<String> { of.as_array().into_iter().flatten().map(of_text).collect() };
    let told: Vec<String> = words(&summary["warnings"]).iter().map(|text| text.replace(&parent, "")).collect();
    assert_eq!(page.get("warnings").map(words).unwrap_or_default(), told);
    for parameter in page["parameters"].as_array().unwrap() {
        let told = &summary["identified"][parameter["name"].as_str().unwrap()];
        for key in ["value", "sigma", "prior", "prior_sigma", "unit", "observable"] {
            assert_eq!(parameter[key], told[key]);
        }
    }
    assert_eq!(page["parameters"].as_array().unwrap().len(), summary["identified"].as_object().unwrap().len());
    assert_eq!(page["program"]["crc32"], summary["program_crc32"]);
    summary
}

fn figure(page: &Value, name: &str) -> f64 {
    let results = page["results"].as_array().unwrap();
    results.iter().find(|r| r["name"] == name).unwrap_or_else(|| panic!("no figure {name}"))["value"].as_f64().unwrap()
}

#[test]
fn a_correction_shows_what_its_tables_hold() {
    let part = pocket("");
    // A reading far from every wall, one in the air above it.
    let probe = fs::read_to_string(part.at("probe.txt")).unwrap();
    let stray = "-900 400 -6 0 0 0 0 0 0\n";
    fs::write(part.at("probe.txt"), probe + stray).unwrap();
    part.correct("probe.txt", "out", None);
    let page = data(&part.at("out/report.html"));
    assert_eq!((&page["version"], &page["kind"]), (&Value::from(1), &Value::from("correct")));
    same_as_correction(&page, &part.at("out"));
    same_as_points(&page, &part.at("out"), 12.0);
    assert_eq!(page["points"].as_array().unwrap().last().unwrap()["status"], "aside");
    let summary = same_as_summary(&page, &part.at("out"));
    assert_eq!(figure(&page, "largest error without correction"), summary["max_error_before_mm"].as_f64().unwrap());
    assert_eq!(figure(&page, "largest error with it"), summary["max_error_after_mm"].as_f64().unwrap());
    for (pass, words) in [("before", "without correction, predicted"), ("after", "with the correction, predicted")] {
        assert!(page["contour"][pass]["label"].as_str().unwrap().starts_with(words));
    }
    assert_eq!(page["job"]["tool"]["diameter_mm"], 10.0);
    assert!(page.get("verdict").is_none() && page.get("tolerance_mm").is_none());
    assert!(fs::metadata(part.at("out/report.html")).unwrap().len() < 2_000_000);
}

#[test]
fn the_same_files_give_the_same_page_wherever_they_lie() {
    let [one, other] = ["", ""].map(|more| {
        let part = pocket(more);
        part.correct("probe.txt", "out", None);
        fs::read(part.at("out/report.html")).unwrap()
    });
    assert_eq!(one, other);
}

#[test]
fn a_part_learned_from_is_told_with_how_it_came_out() {
    let part = pocket("");
    part.correct("probe.txt", "one", None);
    part.touched(&part.milled(Some("one/corrected.nc")), &[20.0, 48.0, 66.0, 100.0, 150.0], "probe-2.txt");
    part.learn("probe-2.txt", "one", "two");
    let page = data(&part.at("two/report.html"));
    assert_eq!(page["kind"], "learn");
    assert_eq!(page["title"], "program.nc: part 2 measured, correction of part 3");
    same_as_correction(&page, &part.at("two"));
    same_as_points(&page, &part.at("two"), 12.0);
    let summary = same_as_summary(&page, &part.at("two"));
    let told = summary["measured_error_mm"]["max_mm"].as_f64().unwrap();
    assert_eq!(figure(&page, "part 2 measured, largest error"), told);
    let facts = page["job"]["facts"].to_string();
    assert!(facts.contains("of part 2, as cut with the correction made for it"), "{facts}");
}

#[test]
fn a_simulated_pass_shows_its_trace() {
    for (plant, label) in [(false, "predicted by the core from the job's values"), (true, "cut by the virtual machine")]
    {
        let part = Part::of_the_demonstration("corner-helix", "");
        part.simulate(plant, "out");
        let page = data(&part.at("out/report.html"));
        assert_eq!(page["kind"], "simulate");
        let (contour, file) = (&page["contour"], part.at("out/trace.csv"));
        assert_eq!(contour["before"]["label"], label);
        assert!(contour.get("after").is_none() && contour.get("correction_x_mm").is_none());
        for name in ["s_mm", "x_mm", "y_mm"] {
            assert_eq!(column(&contour[name]), table(&file, name), "{name}");
        }
        for name in ["arc_deg", "chip_area_mm2", "force_n", "fx_n", "fy_n", "dx_mm", "dy_mm", "error_mm"] {
            assert_eq!(column(&contour["before"][name]), table(&file, name), "{name}");
        }
        // Whoever receives the page is not told where the files lie.
        assert!(page["warnings"].to_string().contains("\"program.nc: line 3"), "{}", page["warnings"]);
        let text = fs::read_to_string(part.at("out/report.html")).unwrap();
        assert!(!text.contains(part.at("").to_str().unwrap()));
        // The page looks places up by arc length.
        let s = super::reading::full(&contour["s_mm"]);
        assert!(s.windows(2).all(|pair| pair[0] <= pair[1]));
    }
}

#[test]
fn the_route_of_a_coprocessor_and_the_limits_of_the_job_are_told() {
    let part = pocket("[part]\nname = \"Lid\"\ntolerance_mm = 0.2\n");
    part.correct("probe.txt", "out", Some(Route::Coprocessor));
    let page = data(&part.at("out/report.html"));
    assert_eq!(page["title"], "Correction of Lid");
    assert!(page["job"]["facts"].to_string().contains("coprocessor: the program stays as it is"));
    assert_eq!(page["tolerance_mm"], 0.2);
    assert_eq!(page["verdict"]["state"], "open");
    assert!(in_mm(&page["verdict"]["text"]).contains("within -0.2 to +0.2 mm everywhere"));
    assert!(page["verdict"]["text"][1].as_str().unwrap().contains("within -0.007874 to +0.007874 in everywhere"));
}
