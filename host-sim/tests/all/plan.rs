//! `plan`: from the points of one pass to a program of several, cut on a machine that shares no code with the plan.

use serde_json::Value;

use crate::workplace::{Workplace, plant, pocket_job};

/// One pass round a pocket, as deep as the cutter is wide and more.
const POCKET: &str = "G21 G90 G17\nT2 M6\nS9000 M3\nG0 X28 Y6 Z10\nG1 Z-12 F300\nG3 X30 Y4 I2 J0 F700\n\
    G1 X50\nG3 X56 Y10 I0 J6\nG1 Y30\nG3 X50 Y36 I-6 J0\nG1 X10\nG3 X4 Y30 I0 J-6\nG1 Y10\nG3 X10 Y4 I6 J0\nG1 X30\n\
    G3 X32 Y6 I0 J2\nG0 Z10\nM30\n";
const PLAN: &str = "plan job.toml --probe first/probe.txt";

/// A soft machine that the job does not state, its first part and the points of it.
fn measured() -> Workplace {
    let plant = plant("[[0.0016, 0.00004], [0.00004, 0.0013]]");
    let desk = Workplace::with(&[("part.nc", POCKET), ("job.toml", &pocket_job(12.0, 900)), ("plant.toml", &plant)]);
    desk.call("probe job.toml --dialect linuxcnc -o verify.nc");
    desk.call("simulate job.toml --plant plant.toml --touch verify.nc -o first");
    desk
}

fn number(of: &Value, keys: &[&str]) -> f64 {
    let found = keys.iter().fold(of, |value, key| &value[*key]);
    found.as_f64().unwrap_or_else(|| panic!("{keys:?} in {of}"))
}

#[test]
fn a_planned_program_holds_at_every_height_what_one_pass_does_not() {
    let desk = measured();
    // What one corrected pass is expected to reach is asked for with 95 %: that takes several.
    let loose = desk.call(&format!("{PLAN} --tolerance 1"));
    let one = &loose["choices"][0];
    assert_eq!(loose["recommended"].as_u64(), Some(1), "one pass holds a millimetre");
    let tolerance = number(one, &["profile_mm"]);
    let done = desk.call(&format!("{PLAN} --tolerance {tolerance:.4} --write -o plan"));
    let chosen = done["written"]["choice"].as_u64().expect("a choice") as usize;
    assert!(chosen > 1 && Some(chosen as u64) == done["recommended"].as_u64());
    let choice = &done["choices"][chosen - 1];
    assert!(number(choice, &["within_tolerance"]) >= 0.95);

    let cut = |program: &str, to: &str| {
        desk.call(&format!("simulate job.toml --plant plant.toml --program {program} -o {to}"))
    };
    let before = number(&cut("part.nc", "before"), &["surface", "profile_mm"]);
    let after = number(&cut("plan/planned.nc", "after"), &["surface", "profile_mm"]);
    assert!(after < tolerance && after < before / 4.0, "{before} became {after}, {tolerance} was asked");
    let (mean, sigma) = (number(choice, &["profile_mm"]), number(choice, &["sigma_mm"]));
    assert!((after - mean).abs() < 3.0 * sigma, "{after}, predicted {mean} +- {sigma}");
    assert_eq!(desk.read("plan/planned.nc"), desk.read("plan/part.planned.nc"));
    let page = desk.read("plan/report.html");
    assert!(
        page.contains("holds ±") && page.matches("<figure").count() == 1 + done["choices"].as_array().unwrap().len()
    );
    assert!(desk.read("plan/wall-map.csv").starts_with("s_mm,height_mm,error_mm\n"));

    // The wall is the same: its probing program serves, and the points say what the map says.
    desk.call("simulate job.toml --plant plant.toml --program plan/planned.nc --touch verify.nc -o touched");
    let seen = desk.call("inspect job.toml --probe touched/probe.txt -o seen");
    assert!(number(&seen, &["summary", "max_error_mm"]) < tolerance + 0.004);
}

#[test]
fn limits_of_the_job_are_kept() {
    let desk = measured();
    let job = desk.read("job.toml");
    desk.write(
        "job.toml",
        job + "[plan]\nmax_cuts = 2\nmax_levels = 1\nreverse = \"no\"\nmax_percent = 100\nmax_time_ratio = 2.1\n",
    );
    let plan = desk.call(&format!("{PLAN} --tolerance 0.01"));
    for choice in plan["choices"].as_array().expect("choices") {
        let words = choice["process"].as_str().expect("words");
        assert!(!words.contains("reversed") && !words.contains("levels") && !words.contains("200 %"), "{words}");
        assert!(choice["passes"].as_u64().expect("passes") <= 2 && number(choice, &["time_ratio"]) <= 2.1);
    }
    desk.write("job.toml", desk.read("job.toml") + "max_force_n = 1\n");
    let none = desk.call(&format!("{PLAN} --tolerance 0.01"));
    assert_eq!(none["choices"].as_array().map(Vec::len), Some(0));
    assert!(none["recommended"].is_null());
}

#[test]
fn what_cannot_be_planned_is_said_and_nothing_is_written() {
    let desk = measured();
    for (arguments, code, said) in [
        ("--tolerance 0", "C001", "0.0001 to 10 mm"),
        ("--tolerance much", "C001", "--tolerance"),
        ("", "J004", "no tolerance to plan for"),
        ("--tolerance 0.02 --confidence 100", "C001", "50 to 99.9 %"),
        ("--tolerance 0.5 --write 17 -o plan", "C001", "the number of a choice"),
        ("--tolerance 0.0001 --write -o plan", "C001", "no choice holds the tolerance"),
    ] {
        let answer = desk.run(format!("{PLAN} {arguments}").trim_end()).expect_err(arguments);
        assert!(answer.contains(code) && answer.contains(said), "{arguments}: {answer}");
        assert!(!desk.path().join("plan").exists(), "{arguments}");
    }
}
