//! The page of `learn`: the part as it was milled, the next one, and the one without correction.

use std::fs;

use serde_json::Value;
use truepath_plant::judged_trim_mm;

use super::part::{Part, pocket};
use super::reading::{column, data, full, table};

/// Places of the second part.
const PLACES: [f64; 5] = [20.0, 48.0, 66.0, 100.0, 150.0];

/// The pocket, corrected into "one".
fn corrected_once() -> Part {
    let part = pocket("");
    part.correct("probe.txt", "one", None);
    part
}

fn names(page: &Value) -> Vec<(&str, &str)> {
    let passes = ["before", "milled", "after"].into_iter().filter_map(|pass| page["contour"].get(pass));
    passes.map(|pass| (pass["name"].as_str().unwrap(), pass["label"].as_str().unwrap())).collect()
}

#[test]
fn the_part_as_milled_stands_between_the_uncorrected_one_and_the_next() {
    let part = corrected_once();
    let milled = part.milled(Some("one/corrected.nc"));
    part.touched(&milled, &PLACES, "probe-2.txt");
    part.learn("probe-2.txt", "one", "two");
    let page = data(&part.at("two/report.html"));
    assert_eq!(
        names(&page),
        [
            ("uncorrected", "along the path of the program, predicted"),
            ("part 2", "as milled with its correction, by the model of all parts"),
            ("part 3", "the next one, with the new correction, predicted"),
        ]
    );
    // Each pass has the correction it is cut with: part 2 that of --from, digit by digit.
    let contour = &page["contour"];
    let (cut, own) = (&contour["milled"], part.at("two/milled.csv"));
    for (axis, name) in [("correction_x_mm", "dx_mm"), ("correction_y_mm", "dy_mm")] {
        assert_eq!(column(&cut[axis]), table(&part.at("one/correction.csv"), name), "{name}");
        assert_eq!(column(&cut[axis]), table(&own, name), "{name}");
        assert_eq!(column(&contour[axis]), table(&part.at("two/correction.csv"), name), "{name}");
        assert!(contour["before"].get(axis).is_none());
    }
    assert_eq!(column(&cut["error_mm"]), table(&own, "predicted_error_after_mm"));
    assert_eq!(column(&cut["sigma_mm"]), table(&own, "sigma_mm"));
    assert_eq!(table(&own, "predicted_error_before_mm"), column(&contour["before"]["error_mm"]));
    // The largest error is told in the summary and in a figure.
    let summary: Value = serde_json::from_slice(&fs::read(part.at("two/summary.json")).unwrap()).unwrap();
    let whole = &summary["whole_contour_error_mm"];
    let errors = full(&cut["error_mm"]);
    let largest = errors.iter().map(|e| e.abs()).fold(0.0, f64::max);
    assert_eq!(whole["max_mm"], largest);
    let s = full(&contour["s_mm"]);
    let at = s.iter().position(|s| whole["s_mm"] == *s).expect("a place of the contour");
    assert!((errors[at].abs() - largest).abs() < 1e-9);
    assert_eq!(whole["sigma_mm"], full(&cut["sigma_mm"])[at]);
    let figures = page["results"].as_array().unwrap();
    assert_eq!(figures.iter().find(|f| f["name"] == "part 2, whole contour").unwrap()["value"], largest);

    // In a line, as a page of several contours tells it.
    let outcome = &page["outcome"];
    for (name, told) in [
        ("before_mm", &summary["max_error_before_mm"]),
        ("measured_mm", &summary["measured_error_mm"]["max_mm"]),
        ("after_mm", &summary["max_error_after_mm"]),
        ("sigma_mm", &summary["sigma_at_max_error_mm"]),
        ("gouge_mm", &summary["worst_gouge_mm"]),
    ] {
        assert!(told.as_f64().is_some_and(f64::is_finite), "{name}: {summary}");
        assert!((outcome[name].as_f64().unwrap() - told.as_f64().unwrap()).abs() < 1e-6, "{name}");
    }

    // What the page says of part 2 is what the virtual machine has cut, and far from the part without correction.
    let truth = milled.mean_errors();
    let length = milled.path.length_mm;
    let trim = judged_trim_mm(milled.cut.radius_mm);
    let cut_at = |s: f64| truth[milled.path.s_mm.partition_point(|x| *x < s).min(truth.len() - 1)];
    let inside = |s: &f64| *s > trim && *s < length - trim;
    let off = |errors: &[f64]| {
        let each = s.iter().zip(errors).filter(|(s, _)| inside(s)).map(|(s, e)| (e - cut_at(*s)).powi(2));
        let squares: Vec<f64> = each.collect();
        (squares.iter().sum::<f64>() / squares.len() as f64).sqrt()
    };
    let [uncorrected, as_milled] = ["before", "milled"].map(|pass| off(&full(&contour[pass]["error_mm"])));
    assert!(as_milled < 0.003, "{as_milled} mm (rms) from the part that was cut");
    assert!(uncorrected > 20.0 * as_milled, "{uncorrected} and {as_milled}");
    // So do the points: they are of part 2.
    for point in page["points"].as_array().unwrap() {
        let (s, error) = (point["s_mm"].as_f64().unwrap(), point["error_mm"].as_f64().unwrap());
        let at = s_index(&contour["s_mm"], s);
        let [before, milled] = ["before", "milled"].map(|pass| full(&contour[pass]["error_mm"])[at]);
        assert!((error - milled).abs() < (error - before).abs(), "{error} at {s}: {milled}, {before}");
    }
    // Over the height as well.
    let heights = &page["heights"];
    let nodes = column(&heights["after"]).len();
    assert!(["before", "milled"].iter().all(|pass| column(&heights[*pass]).len() == nodes));
}

fn s_index(column: &Value, s: f64) -> usize {
    full(column).partition_point(|x| *x < s).saturating_sub(1)
}

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn a_part_that_is_set_aside_and_one_cut_without_correction_are_called_so() {
    let part = corrected_once();
    part.touched(&part.milled(Some("one/corrected.nc")), &PLACES, "probe-2.txt");
    // Points that contradict each other: the part is set aside, and the next one is cut along the program.
    let moved = |(k, line): (usize, &str)| {
        let mut numbers: Vec<f64> = line.split_whitespace().map(|word| word.parse().unwrap()).collect();
        numbers[0] += if k % 2 == 0 { -0.15 } else { 0.15 };
        numbers[1] += if k % 3 == 0 { -0.12 } else { 0.12 };
        numbers.iter().map(f64::to_string).collect::<Vec<_>>().join(" ")
    };
    let text = fs::read_to_string(part.at("probe-2.txt")).unwrap();
    fs::write(part.at("odd.txt"), text.lines().enumerate().map(moved).collect::<Vec<_>>().join("\n")).unwrap();
    part.learn("odd.txt", "one", "two");
    let page = data(&part.at("two/report.html"));
    let aside = "as milled with its correction, by the model of the parts before; this one is set aside";
    assert_eq!(names(&page)[1..], [("part 2", aside), ("part 3", "the next one, without correction, predicted")]);
    assert_eq!(column(&page["contour"]["after"]["error_mm"]), column(&page["contour"]["before"]["error_mm"]));
    part.touched(&part.milled(Some("two/corrected.nc")), &PLACES, "probe-3.txt");
    part.learn("probe-3.txt", "two", "three");
    let page = data(&part.at("three/report.html"));
    // There is no uncorrected part beside the one that was cut without correction.
    assert_eq!(
        names(&page),
        [
            ("part 3", "as milled without correction, by the model of all parts"),
            ("part 4", "the next one, with the new correction, predicted"),
        ]
    );
    assert!(full(&page["contour"]["milled"]["correction_x_mm"]).iter().all(|v| *v == 0.0));
}
