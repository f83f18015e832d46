//! The passes of a page agree with each other and with what was cut.

use std::fs;

use serde_json::Value;
use truepath::command::demo;
use truepath_plant::judged_trim_mm;

use super::part::{Part, pocket};
use super::reading::{column, data, full, table};

fn at(values: &Value) -> Vec<f64> {
    full(values)
}

/// Deviation of the centre from the programmed path along the normal.
fn towards_the_wall(contour: &Value, pass: &str, with_correction: bool) -> Vec<f64> {
    let [nx, ny] = ["nx", "ny"].map(|name| at(&contour[name]));
    let [dx, dy] = ["dx_mm", "dy_mm"].map(|name| at(&contour[pass][name]));
    let [cx, cy] = ["correction_x_mm", "correction_y_mm"].map(|name| at(&contour[name]));
    let share = f64::from(u8::from(with_correction));
    (0..nx.len()).map(|i| (dx[i] + share * cx[i]) * nx[i] + (dy[i] + share * cy[i]) * ny[i]).collect()
}

#[test]
fn the_corrected_pass_is_the_one_that_leaves_the_wall_shown() {
    // With the mean force and a stiff cutter the wall of a straight stretch is where the centre passes.
    let part = Part::of_the_demonstration("corner", "");
    let file = part.at("probe.txt");
    part.touched(&part.milled(None), &[30.0, 75.0], "probe.txt");
    assert!(file.exists());
    part.correct("probe.txt", "out", None);
    let page = data(&part.at("out/report.html"));
    let contour = &page["contour"];
    let s = at(&contour["s_mm"]);
    for (pass, with_correction) in [("before", false), ("after", true)] {
        let moved = towards_the_wall(contour, pass, with_correction);
        let errors = at(&contour[pass]["error_mm"]);
        let straight = |i: &usize| (5.0..32.0).contains(&s[*i]) || (60.0..95.0).contains(&s[*i]);
        let apart = (0..s.len()).filter(straight).map(|i| (errors[i] + moved[i]).abs()).fold(0.0, f64::max);
        assert!(apart < 1e-3, "{pass}: {apart}");
    }
    let force = |pass: &str| at(&contour[pass]["force_n"]);
    // The corrected cutter is deeper in the stock and is pushed harder, everywhere along the walls.
    let harder = force("before").iter().zip(force("after")).zip(&s).filter(|((b, a), _)| a > *b).count();
    assert!(harder * 10 > s.len() * 9, "{harder} of {}", s.len());
    let [fx, fy, f] = ["fx_n", "fy_n", "force_n"].map(|name| at(&contour["after"][name]));
    assert!((0..f.len()).all(|i| (fx[i].hypot(fy[i]) - f[i]).abs() < 2e-4));
}

#[test]
fn the_wall_over_the_height_has_the_mean_of_the_error_shown() {
    let part = pocket("");
    part.correct("probe.txt", "out", None);
    let page = data(&part.at("out/report.html"));
    let heights = &page["heights"];
    let z = heights["z_mm"].as_array().unwrap();
    assert_eq!((z.len(), z[0].as_f64(), z[8].as_f64()), (9, Some(0.0), Some(12.0)));
    let stride = heights["stride"].as_u64().unwrap() as usize;
    for pass in ["before", "after"] {
        let errors = column(&page["contour"][pass]["error_mm"]);
        let nodes = column(&heights[pass]);
        assert_eq!(nodes.len(), 9 * errors.len().div_ceil(stride));
        for (node, wall) in nodes.as_chunks::<9>().0.iter().enumerate() {
            let wall: Vec<f64> = wall.iter().map(|e| e.unwrap()).collect();
            // Trapezoids over the height, against the twelve slices of the core.
            let inner: f64 = wall[1..8].iter().sum();
            let mean = (inner + (wall[0] + wall[8]) / 2.0) / 8.0;
            let spread = wall.iter().fold(0.0f64, |m, e| m.max((e - mean).abs()));
            let error = errors[node * stride].unwrap();
            assert!((mean - error).abs() < 0.15 * spread + 1e-4, "{pass} node {node}: {mean} and {error}");
        }
    }
}

#[test]
fn the_pages_of_the_demonstration_show_what_was_cut() {
    let folder = tempfile::tempdir().unwrap();
    let options = demo::Options { output: folder.path().to_owned(), keep: false, force: true };
    let outcomes = demo::run(&options, &mut |_| ()).unwrap();
    for outcome in outcomes {
        let page = data(&outcome.folder.join("report.html"));
        assert_eq!(page["title"], outcome.title);
        let contour = &page["contour"];
        let largest =
            |pass: &str| column(&contour[pass]["error_mm"]).into_iter().flatten().map(f64::abs).fold(0.0, f64::max);
        // Taken between the samples of the virtual machine: a little off where the error has its peak.
        assert!((largest("before") - outcome.before_mm).abs() < 0.02 * outcome.before_mm, "{}", outcome.name);
        assert!((largest("after") - outcome.after_mm).abs() < 0.1 * outcome.after_mm, "{}", outcome.name);
        let trim = judged_trim_mm(page["job"]["tool"]["diameter_mm"].as_f64().unwrap() / 2.0);
        let s = at(&contour["s_mm"]);
        let end = s[s.len() - 1];
        for (s, error) in s.iter().zip(column(&contour["before"]["error_mm"])) {
            let inside = (s - trim).min(end - trim - s);
            assert!(error.is_some() == (inside > 0.0) || inside.abs() < 1e-3, "{} at {s}", outcome.name);
        }
        let file = outcome.folder.join("correction.csv");
        assert_eq!(column(&contour["correction_x_mm"]), table(&file, "dx_mm"));
        assert!(page.get("points").is_some() && page.get("parameters").is_some());
        assert!(fs::metadata(outcome.folder.join("report.html")).unwrap().len() < 2_000_000);
    }
}
