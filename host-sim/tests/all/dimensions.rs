//! `--dimensions`: a sheet to fill in, and corrections, inspections and learning from what was typed.

use serde_json::Value;

use crate::workplace::Workplace;

/// A pocket whose owner has no probe.
fn workplace() -> Workplace {
    let desk = Workplace::demo("pocket", &["job.toml", "program.nc"]);
    let job = desk.read("job.toml");
    desk.write("job.toml", job.split("[probe]").next().expect("a job"));
    desk
}

/// Types values into a file: nominal and so much more or less, mm.
fn typed(desk: &Workplace, from: &str, to: &str, plan: &Value, larger_mm: impl Fn(&Value) -> f64) {
    let mut text = desk.read(from);
    for d in plan["dimensions"].as_array().expect("dimensions") {
        let value = d["nominal_mm"].as_f64().expect("a nominal") + larger_mm(d);
        text = text.replacen("value_mm = \"\"", &format!("value_mm = \"{value:.3}\""), 1);
    }
    desk.write(to, text);
}

#[test]
fn from_the_sheet_to_the_next_part_without_a_probe() {
    let desk = workplace();
    let plan = desk.call("probe job.toml --dimensions --instrument micrometer -o widths.html");
    let all = plan["dimensions"].as_array().expect("dimensions");
    let along = |axis: &str| all.iter().filter(|d| d["along"] == axis).count();
    assert!(all.len() == 8 && along("x") >= 2 && along("y") >= 2, "{plan}");
    let sigma = |k: usize| plan["wall_sigma_mm"][k].as_f64().expect("a sigma");
    assert!(sigma(1) < 0.2 * sigma(0), "{} {}", sigma(0), sigma(1));
    let sheet = desk.read("widths.html");
    assert_eq!((sheet.matches("class=room").count(), sheet.contains("widths.toml")), (8, true));
    assert!(sheet.contains("<svg") && !sheet.contains("<script") && !sheet.contains("http"));

    // Not filled in: the first value is named with its place.
    let refused = desk.run("correct job.toml --dimensions widths.toml -o out").unwrap_err();
    let error: Value = serde_json::from_str(&refused).expect("one object");
    let line = desk.read("widths.toml").lines().position(|line| line.starts_with("value_mm")).expect("a value") + 1;
    let place = [&error["error"]["code"], &error["error"]["line"], &error["error"]["column"]];
    assert_eq!(place, [&Value::from("M043"), &Value::from(line), &Value::from(12)]);
    assert!(refused.contains("widths.toml"), "{refused}");

    // X is 0.16 mm too narrow and Y 0.10 mm, as a machine leaves it that is stiffer along Y.
    let narrow = |d: &Value| if d["along"] == "x" { -0.16 } else { -0.10 };
    typed(&desk, "widths.toml", "first.toml", &plan, narrow);
    let report = desk.call("inspect job.toml --dimensions first.toml --tolerance 0.05 -o inspected");
    assert_eq!((&report["summary"]["points"], &report["summary"]["verdict"]["state"]), (&8.into(), &"fail".into()));
    let done = desk.call("correct job.toml --dimensions first.toml -o out");
    assert_eq!((&done["points_used"], &done["points_outlying"]), (&8.into(), &0.into()));
    let before = done["max_error_before_mm"].as_f64().expect("an error");
    assert!((0.07..0.16).contains(&before), "{before}");
    assert!(done["max_error_after_mm"].as_f64().expect("an error") < 0.2 * before);
    // Widths tell the machine and nothing of the datum.
    let told = |name: &str, key: &str| done["identified"][name][key].as_f64().expect("a number");
    let left = |name: &str| told(name, "sigma") / told(name, "prior_sigma");
    assert!(left("compliance") < 0.8 && left("datum_x") > 0.999, "{}", done["identified"]);
    assert!(desk.read("out/dimensions-raw.toml").contains("value_mm = \"69.8"), "as it was given");
    assert!(!desk.path().join("out/probe-raw.txt").exists());
    let warnings = done["warnings"].to_string();
    assert!(warnings.contains("8 readings are dimensions between two walls"), "{warnings}");

    // The corrected part comes out nearly right; learning takes dimensions as well.
    typed(&desk, "widths.toml", "second.toml", &plan, |_| -0.006);
    let learned = desk.call("learn job.toml --dimensions second.toml --from out -o next");
    assert_eq!((&learned["part"], &learned["points_used"]), (&2.into(), &8.into()));
    assert!(learned["measured_error_mm"]["max_mm"].as_f64().expect("an error") < 0.004, "{learned}");
    let again = desk.run("learn job.toml --dimensions first.toml --from out -o other").unwrap_err();
    assert!(again.contains("Q003") || again.contains("Q007"), "{again}");
}

#[test]
fn a_measuring_machine_gives_the_values_and_gets_the_inspection_in_its_own_format() {
    let desk = workplace();
    let place = |name: &str, along: &str, across: &str| {
        format!(
            "[[dimension]]\nname = \"{name}\"\nkind = \"width\"\nalong = \"{along}\"\n{across} = 0\nz_mm = -6\ninstrument = \"cmm\"\n"
        )
    };
    let both = place("length", "x", "y_mm") + &place("breadth", "y", "x_mm");
    desk.write("widths.toml", format!("version = 1\nvalues = \"part.dfq\"\n{both}"));
    desk.write(
        "part.dfq",
        "K0100 2\nK1001 1\nK2002/1 breadth\nK2002/2 length\nK2142/0 mm\n49.900\u{14}0\u{f}69.840\u{14}0\n",
    );
    let told = desk.call("inspect job.toml --dimensions widths.toml --tolerance 0.1 --aqdef out.dfq");
    let errors: Vec<f64> =
        told["contacts"].as_array().expect("contacts").iter().filter_map(|c| c["error_mm"].as_f64()).collect();
    assert!(errors.contains(&0.08) && errors.contains(&0.05), "{errors:?}");
    let written = desk.read("out.dfq");
    for line in ["K0100 2", "K2001/2 2", "K2101/1 0", "K2110/1 -0.1", "K2111/1 0.1", "K2142/2 mm"] {
        assert!(written.lines().any(|l| l == line), "{line}\n{written}");
    }
    let values: Vec<&str> = written.lines().last().expect("values").split('\u{f}').collect();
    assert!(values.contains(&"0.08\u{14}0") && values.contains(&"0.05\u{14}0"), "{values:?}");
    assert!(desk.run("inspect job.toml --dimensions widths.toml --aqdef out.dfq").unwrap_err().contains("F003"));
    desk.write("part.dfq", "K2002/1 breadth\n49.9\n");
    let refused = desk.run("inspect job.toml --dimensions widths.toml").unwrap_err();
    assert!(refused.contains("M050") && refused.contains("length"), "{refused}");
}

#[test]
fn widths_that_leave_two_walls_apart_name_the_measurement_that_tells() {
    let desk = workplace();
    let width = |y: f64, value: f64| {
        format!(
            "[[dimension]]\nkind = \"width\"\nalong = \"x\"\ny_mm = {y}\nz_mm = -6\ninstrument = \"micrometer\"\nvalue_mm = {value}\n"
        )
    };
    let text: String = [(-8.0, 69.84), (0.0, 69.838), (8.0, 69.842)].map(|(y, value)| width(y, value)).concat();
    desk.write("widths.toml", format!("version = 1\n{text}"));
    let apart = |dimensions: &str| {
        let _ = std::fs::remove_dir_all(desk.path().join("out"));
        let done = desk.call(&format!("correct job.toml --dimensions {dimensions} -o out"));
        done["warnings"].as_array().expect("warnings").iter().filter_map(Value::as_str).map(str::to_owned).collect()
    };
    let said: Vec<String> = apart("widths.toml");
    let said: Vec<&String> = said.iter().filter(|said| said.contains("see the sum of two walls")).collect();
    assert_eq!(said.len(), 1, "{said:?}");
    assert!(
        said[0].contains("along X") && said[0].contains("kind = \"distance\"") && said[0].contains("X-34.9"),
        "{said:?}"
    );

    let distance = "[[dimension]]\nkind = \"distance\"\nalong = \"x\"\ny_mm = 4\nface_mm = -50\nz_mm = -6\ninstrument = \"cmm\"\nvalue_mm = 15.08\n";
    desk.write("both.toml", format!("version = 1\n{text}{distance}"));
    let said: Vec<String> = apart("both.toml");
    assert!(said.iter().all(|said| !said.contains("see the sum of two walls")), "{said:?}");
}

#[test]
fn a_correction_from_dimensions_alone_is_packed_and_made_again() {
    let desk = workplace();
    let width = |name: &str, along: &str, across: &str| {
        format!(
            "[[dimension]]\nname = \"{name}\"\nkind = \"width\"\nalong = \"{along}\"\n{across} = 0\nz_mm = -6\ninstrument = \"cmm\"\n"
        )
    };
    let both = width("ACME length", "x", "y_mm") + &width("breadth", "y", "x_mm");
    std::fs::create_dir(desk.path().join("cmm")).expect("a folder");
    desk.write("cmm/widths.toml", format!("version = 1\nvalues = \"part.dfq\"\n{both}"));
    desk.write("cmm/part.dfq", "K2002/1 breadth\nK2002/2 ACME length\n49.900\u{f}69.840\n");
    desk.call("correct job.toml --dimensions cmm/widths.toml -o out");
    // Whole in itself: the values of the measuring machine are in it.
    assert!(
        desk.read("out/dimensions-raw.toml").contains("value_mm = 69.84"),
        "{}",
        desk.read("out/dimensions-raw.toml")
    );
    let packed = desk.call("pack job.toml program.nc out -o story.tpk");
    assert_eq!(packed["again"]["same"], true, "{packed}");
    assert!(packed["files"].to_string().contains("out/dimensions-raw.toml"), "{packed}");
    let bare = desk.call("pack job.toml program.nc out -o bare.tpk --anonymous");
    assert_eq!(bare["again"]["same"], true, "{bare}");
    assert!(bare["files"].to_string().contains("\"dimensions.toml\""), "{bare}");
    desk.call("unpack bare.tpk -o there");
    assert!(!desk.read("there/dimensions.toml").contains("ACME"));
}
