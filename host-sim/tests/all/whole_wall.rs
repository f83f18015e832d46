//! The error of the whole wall, at every height, in every report: what is expected of it against what the virtual machine leaves.

use serde_json::Value;

use crate::workplace::{Workplace, plant, pocket_job, text, truepath};

/// A pass round a pocket deep enough for a helix to show.
const POCKET: &str = "G21 G90 G17\nT2 M6\nS9000 M3\nG0 X28 Y6 Z10\nG1 Z-8 F300\nG3 X30 Y4 I2 J0 F700\nG1 X50\n\
    G3 X56 Y10 I0 J6\nG1 Y30\nG3 X50 Y36 I-6 J0\nG1 X10\nG3 X4 Y30 I0 J-6\nG1 Y10\nG3 X10 Y4 I6 J0\nG1 X30\n\
    G3 X32 Y6 I0 J2\nG0 Z10\nM30\n";
/// Half a micrometre: how far two ways of reading one wall lie apart.
const READ_MM: f64 = 5e-4;

/// A part that was cut and touched.
fn measured() -> Workplace {
    let plant = plant("[[0.0016, 0.00004], [0.00004, 0.0013]]");
    let desk = Workplace::with(&[("part.nc", POCKET), ("job.toml", &pocket_job(8.0, 900)), ("plant.toml", &plant)]);
    desk.call("probe job.toml --dialect linuxcnc -o verify.nc");
    desk.call("simulate job.toml --plant plant.toml --touch verify.nc -o first");
    desk
}

fn number(of: &Value, keys: &str) -> f64 {
    let found = keys.split('.').fold(of, |value, key| &value[key]);
    found.as_f64().unwrap_or_else(|| panic!("{keys} in {of}"))
}

/// The largest error that the virtual machine left between the lowest and the highest of the twelve heights that are predicted: the
/// wall is 8 mm high with its top at Z 0.
fn left_mm(cut: &Value) -> f64 {
    let outermost = 8.0 / 24.0;
    let slices = cut["surface"]["heights"].as_array().expect("heights").iter();
    let within = slices.filter(|slice| (outermost - 8.0..=-outermost).contains(&number(slice, "z_mm")));
    within.map(|slice| number(slice, "profile_mm")).fold(0.0, f64::max)
}

/// Holds an error that the virtual machine left against what was expected of it.
#[track_caller]
fn came_out(left: f64, expected: &Value, figure: &str, sigma: &str) {
    came_out_within(left, expected, figure, sigma, READ_MM);
}

/// The same where two ways of reading a wall lie farther apart.
#[track_caller]
fn came_out_within(left: f64, expected: &Value, figure: &str, sigma: &str, read_mm: f64) {
    let (mean, sigma) = (number(expected, figure), number(expected, sigma));
    assert!((left - mean).abs() < 2.0 * sigma + read_mm, "{figure}: {left} was cut, {mean} ± {sigma} expected");
}

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn what_is_expected_of_the_wall_at_every_height_is_what_the_machine_leaves() {
    let desk = measured();
    let done = desk.call("correct job.toml --probe first/probe.txt -o out");
    let (before, after) = (&done["surface"]["before"], &done["surface"]["after"]);
    let cut = |program: &str, to: &str| {
        desk.call(&format!("simulate job.toml --plant plant.toml --program {program} -o {to}"))
    };
    let (first, second) = (cut("part.nc", "cut-1"), cut("out/corrected.nc", "cut-2"));
    for (cut, expected) in [(&first, before), (&second, after)] {
        came_out(left_mm(cut), expected, "profile_mm", "sigma_mm");
        came_out(number(cut, "surface.p95_mm"), expected, "p95_mm", "p95_sigma_mm");
        assert!(number(cut, "surface.profile_mm") > number(cut, "surface.p95_mm"));
    }
    // A number that is only the mean would miss the wall by far.
    assert!(number(after, "profile_mm") > 2.0 * number(after, "mean_mm"), "{after}");
    let relative = left_mm(&first) / number(before, "profile_mm");
    assert!((relative - 1.0).abs() < 0.08, "{relative}");
    assert_eq!(done["profile_error_after_mm"], after["profile_mm"]);

    // The parts make up the error, and the helix is the largest of them.
    let causes = &after["causes"];
    let parts = ["mean_mm", "height_mm", "bending_mm"].map(|part| number(causes, part));
    let sum: f64 = parts.iter().sum();
    let largest = parts.iter().copied().fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
    assert!((sum.abs() - number(after, "profile_mm")).abs() < 2.0 * number(after, "sigma_mm"), "{causes}");
    assert_eq!(largest, parts[1], "{causes}");
    assert!(["noise_mm", "not_modelled_mm"].iter().all(|part| number(causes, part) > 0.0), "{causes}");

    let page = desk.read("out/report.html");
    let told = format!(
        "mean over the height {:.3} -> {:.3} mm; worst at any height {:.3} -> {:.3}",
        number(before, "mean_mm"),
        number(after, "mean_mm"),
        number(before, "profile_mm"),
        number(after, "profile_mm")
    );
    // The data of a page escape what a page might take for an element.
    assert!(page.contains(&told) || page.contains(&told.replace('>', "\\u003e")), "{told}");

    // What was learned from the corrected part speaks of it and of the next one.
    desk.call("simulate job.toml --plant plant.toml --program out/corrected.nc --touch verify.nc -o second");
    let learned = desk.call("learn job.toml --probe second/probe.txt --from out -o next");
    came_out(left_mm(&second), &learned["whole_surface"], "profile_mm", "sigma_mm");
    let touched = number(&learned, "measured_surface.profile_mm");
    assert!(touched <= number(&second, "surface.profile_mm") + 0.004, "{touched}");
    let third = cut("next/corrected.nc", "cut-3");
    came_out(left_mm(&third), &learned["surface"]["after"], "profile_mm", "sigma_mm");
}

#[test]
#[ignore = "slow: more than nine seconds of processor time"]
fn one_pass_that_cannot_hold_the_tolerance_is_warned_of_with_the_command_to_type() {
    let desk = measured();
    let warned = |arguments: &str| {
        let done = desk.call(format!("correct job.toml --probe first/probe.txt --force -o out {arguments}").trim_end());
        let lines = done["warnings"].as_array().expect("warnings").iter().filter_map(Value::as_str);
        let said: Vec<String> = lines.filter(|line| line.contains("truepath plan")).map(str::to_owned).collect();
        (number(&done, "surface.after.profile_mm"), number(&done, "surface.after.sigma_mm"), said)
    };
    let (profile, sigma, said) = warned("--tolerance 1");
    assert!(said.is_empty(), "{said:?}");
    // Beyond what is expected, within it with less than two sigma to spare, and with more.
    let beyond = ((profile - 0.001) * 1e4).round() / 1e4;
    let (_, _, said) = warned(&format!("--tolerance {beyond}"));
    assert_eq!(said.len(), 1, "{said:?}");
    let (probe, command) = ("first/probe.txt", said[0].as_str());
    let expected = format!("truepath plan job.toml --probe {probe} --tolerance {beyond}");
    assert!(command.contains("cannot hold") && command.contains(&expected), "{command}");
    let (_, _, said) = warned(&format!("--tolerance {:.4}", profile + sigma));
    assert!(said.len() == 1 && said[0].contains("may not hold"), "{said:?}");
    let (_, _, said) = warned(&format!("--tolerance {:.4}", profile + 2.5 * sigma));
    assert!(said.is_empty(), "{said:?}");
    // The command that is named runs (its search is kept short here), and the limits of the job say the same as the option.
    desk.write("job.toml", desk.read("job.toml") + "[plan]\nmax_cuts = 1\nmax_levels = 1\n");
    let words: Vec<&str> = expected.split(' ').skip(1).collect();
    let planned = truepath(desk.path(), &words);
    assert!(planned.status.success(), "{}", text(&planned.stderr));
    desk.write("job.toml", desk.read("job.toml") + &format!("[part]\ntolerance_mm = {beyond}\n"));
    assert_eq!(warned("").2.len(), 1);

    desk.call("simulate job.toml --plant plant.toml --program out/corrected.nc --touch verify.nc -o second");
    let next = desk.call("learn job.toml --probe second/probe.txt --from out -o next --tolerance 0.001");
    let warnings = next["warnings"].as_array().expect("warnings");
    let of_next = warnings.iter().filter_map(Value::as_str).find(|line| line.contains("truepath plan"));
    assert!(of_next.is_some_and(|line| line.contains("the part cut without correction")), "{warnings:?}");
    for tolerance in ["0", "-0.01", "wide"] {
        let said = desk.run(&format!("correct job.toml --probe first/probe.txt -o none --tolerance {tolerance}"));
        let said = said.expect_err(tolerance);
        assert!(said.contains("C001") && said.contains("0.0001 to 10 mm"), "{said}");
        assert!(!desk.path().join("none").exists());
    }
}

#[test]
fn an_inspection_says_what_was_measured_at_the_touched_heights_and_no_more() {
    // Two heights of one place, +40 and −20 µm, and one touch elsewhere; the wall lies at X = 24, the ball has 6 mm.
    let desk = Workplace::demo("corner", &["program.nc", "job.toml"]);
    desk.write("probe.txt", "27.040 60 -10 0 0 0 0 0 0\n26.980 60 -8 0 0 0 0 0 0\n27.015 50 -8 0 0 0 0 0 0\n");
    let words = "inspect job.toml --probe probe.txt";
    let seen = desk.call(words);
    let wall = &seen["summary"]["surface"];
    let near = |key: &str, value: f64| assert!((number(wall, key) - value).abs() < 2e-6, "{key}: {wall}");
    near("profile_mm", 0.040);
    near("mean_mm", 0.015);
    near("p95_mm", 0.040);
    near("causes.mean_mm", 0.010);
    near("causes.height_mm", 0.030);
    assert_eq!((wall["points"].as_u64(), wall["heights"].as_u64()), (Some(3), Some(2)));
    let statements = seen["summary"]["statements"].to_string();
    assert!(statements.contains("Between the touches nothing is measured"), "{statements}");
    desk.write("job.toml", desk.read("job.toml") + "\n[part]\nuncertainty_mm = 0.006\n");
    let stated = desk.call(words);
    assert!((number(&stated, "summary.surface.sigma_mm") - 0.003).abs() < 1e-9);
    let printed = text(&truepath(desk.path(), &words.split(' ').collect::<Vec<_>>()).stdout);
    assert!(printed.contains("worst at any touched height 0.040 ± 0.006 mm"), "{printed}");
    assert!(printed.contains("+0.0400 mm = mean +0.0100, over the height (helix and bending) +0.0300"), "{printed}");
}

#[test]
fn laws_are_compared_at_every_height_as_the_virtual_machine_judges_itself() {
    let desk = measured();
    let compared = desk.call("compare job.toml --probe first/probe.txt --plant plant.toml");
    let first = desk.call("simulate job.toml --plant plant.toml -o cut");
    let none = &compared["laws"][0];
    let worst = (number(none, "worst_height_mm"), number(&first, "judged.worst_height_mm"));
    assert!((worst.0 - worst.1).abs() < READ_MM, "{worst:?}");
    assert!(number(none, "p95_mm") < worst.0 && number(none, "p95_mm") > 0.3 * worst.0, "{none}");
    assert!(none["expected"].is_null(), "a virtual machine is what it is");
    let parts = ["mean_mm", "height_mm"].map(|part| number(&none["causes"], part));
    assert!((parts.iter().sum::<f64>().abs() - worst.0).abs() < 1e-9, "{none}");
    let identified = desk.call("compare job.toml --probe first/probe.txt");
    let (model, cut) = (&identified["laws"][4], &compared["laws"][4]);
    let wall = &model["expected"];
    came_out_within(number(cut, "worst_height_mm"), wall, "profile_mm", "sigma_mm", 0.004);
    came_out_within(number(cut, "p95_mm"), wall, "p95_mm", "p95_sigma_mm", 0.004);
    assert!(model["causes"].is_null() && number(&wall["causes"], "height_mm").abs() > 0.001, "{wall}");
}

#[test]
fn a_feed_that_the_job_states_goes_for_the_corrected_program_as_well() {
    // The program says F250 and F150, the job 400; and the corrected one has short blocks, in which a control does not slow down.
    let desk = Workplace::demo("corner-helix", &["program.nc", "job.toml", "plant.toml"]);
    desk.call("probe job.toml --dialect linuxcnc -o verify.nc");
    let before = desk.call("simulate job.toml --plant plant.toml --touch verify.nc -o first");
    desk.call("correct job.toml --probe first/probe.txt -o out");
    let after = desk.call("simulate job.toml --plant plant.toml --from out -o second");
    let [before, after] = [&before, &after].map(|cut| number(cut, "max_error_mm").abs());
    assert!(before > 0.2 && after < before / 15.0, "{before} -> {after}");
}
