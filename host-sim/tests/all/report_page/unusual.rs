//! Pages of a second pass, and of scheduled feeds.

use std::fs;

use truepath::command::{simulate, split};
use truepath_job::job::JobFile;
use truepath_job::pass::Pass;
use truepath_trial::virtual_mill;

use super::part::{Part, ROUND, pocket, shown};
use super::reading::{column, data, full, table};

#[test]
fn a_second_pass_is_shown_over_the_surface_that_the_first_has_left() {
    let part = Part::of_the_demonstration("pocket", "");
    let options = split::Options { job: part.at("job.toml"), output: part.at("split"), ..split::Options::default() };
    let first = shown(split::run(&options)).job;
    let pass = shown(JobFile::read(&first).map_err(Into::into).and_then(Pass::read));
    let machine = shown(simulate::read_machine(&part.at("plant.toml")));
    part.touched_along(&pass, &shown(virtual_mill::mill(&pass, &machine, None)), &ROUND, "probe.txt");
    part.correct_after(Some(&first), "probe.txt", "out", None);
    let page = data(&part.at("out/report.html"));
    let stock = &page["outlines"]["stock"][0];
    for (axis, name) in [("x_mm", "x_mm"), ("y_mm", "y_mm")] {
        assert_eq!(column(&stock[axis]), table(&part.at("out/first-pass-surface.csv"), name));
    }
    let allowance = page["job"]["stock"]["allowance_mm"].as_f64().unwrap();
    assert!((0.4..0.6).contains(&allowance), "{allowance}");
    assert_eq!(column(&page["contour"]["correction_y_mm"]), table(&part.at("out/correction.csv"), "dy_mm"));
    assert!(page["job"]["facts"].to_string().contains("of the first pass, which left the stock of this one"));
}

#[test]
fn scheduled_feeds_are_those_of_both_passes() {
    let part = pocket("[feed]\nmin_percent = 50\nmax_force_n = 180\n");
    part.correct("probe.txt", "out", None);
    let page = data(&part.at("out/report.html"));
    let summary: serde_json::Value = serde_json::from_slice(&fs::read(part.at("out/summary.json")).unwrap()).unwrap();
    let used = &summary["feed"]["used_percent"];
    for pass in ["before", "after"] {
        let feeds = full(&page["contour"][pass]["feed_mm_per_min"]);
        let (low, high) = feeds.iter().fold((f64::MAX, 0.0f64), |(l, h), f| (l.min(*f), h.max(*f)));
        assert!((low - 6.0 * used[0].as_f64().unwrap()).abs() < 0.01 && low < 600.0, "{low}");
        assert!((high - 6.0 * used[1].as_f64().unwrap()).abs() < 0.01, "{high}");
        let force = full(&page["contour"][pass]["force_n"]);
        let free = pocket_force(pass);
        assert!(force.iter().copied().fold(0.0, f64::max) < 0.95 * free, "{pass}");
    }
    assert!(page["job"]["facts"].to_string().contains("scheduled feed"));
}

/// The largest force of a pass at the feeds of the program.
fn pocket_force(pass: &str) -> f64 {
    let part = pocket("");
    part.correct("probe.txt", "out", None);
    full(&data(&part.at("out/report.html"))["contour"][pass]["force_n"]).into_iter().fold(0.0, f64::max)
}
