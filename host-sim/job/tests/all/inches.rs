//! Lengths in inches: keys with `_in` in place of `_mm`.

use std::path::Path;

use truepath_ground::diagnostics::{Form, InputError, Source};
use truepath_job::job::JobFile;

const METRIC: &str = "version = 1\nprogram = \"p.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 0.508\n[tool]\ndiameter_mm = 12.7\n\
    measured_diameter_mm = 12.69492\nteeth = 4\nstickout_mm = 50.8\nmaterial = \"carbide\"\n[cut]\naxial_depth_mm = 6.35\n\
    feed_mm_per_min = 508\n[force]\nmaterial = \"al-7075-t6\"\n[machine]\nbacklash_x_mm = 0.0127\n[probe]\nball_diameter_mm = 6.35\n\
    format = \"columns\"\nframe = \"machine\"\nwork_offset_mm = [25.4, -254, 0]\ncolumns = \"x,y,z\"\n\
    [correct]\nband_mm = [1.27, 5.08]\nclamp_mm = 0.254\n[part]\ntolerance_mm = 0.0254\n[plan]\nmax_feed_mm_per_min = 2540\n";

const INCHES: &str = "version = 1\nprogram = \"p.nc\"\nwall = \"right\"\n[stock]\nallowance_in = 0.02\n[tool]\ndiameter_in = 0.5\n\
    measured_diameter_in = 0.4998\nteeth = 4\nstickout_in = 2\nmaterial = \"carbide\"\n[cut]\naxial_depth_in = 0.25\n\
    feed_in_per_min = 20\n[force]\nmaterial = \"al-7075-t6\"\n[machine]\nbacklash_x_in = 0.0005\n[probe]\nball_diameter_in = 0.25\n\
    format = \"columns\"\nframe = \"machine\"\nwork_offset_in = [1, -10, 0]\ncolumns = \"x,y,z\"\n\
    [correct]\nband_in = [0.05, 0.2]\nclamp_in = 0.01\n[part]\ntolerance_in = 0.001\n[plan]\nmax_feed_in_per_min = 100\n";

fn read(text: &str) -> Result<JobFile, InputError> {
    JobFile::parse(Source::new("job.toml", text.as_bytes().to_vec()), Path::new(""))
}

fn refused(text: &str) -> String {
    truepath_ground::diagnostics::Failure::from(read(text).expect_err(text)).render(Form::Plain)
}

#[test]
fn a_job_in_inches_is_the_same_job() {
    let metric = read(METRIC).unwrap_or_else(|e| panic!("{e:?}"));
    let inches = read(INCHES).unwrap_or_else(|e| panic!("{e:?}"));
    assert_eq!(inches.numbers, metric.numbers);
    assert_eq!(inches.backlash, metric.backlash);
    assert_eq!(format!("{:?}{:?}", inches.part, inches.plan), format!("{:?}{:?}", metric.part, metric.plan));
}

#[test]
fn a_length_in_inches_beyond_its_limits_is_told_them_in_inches() {
    for (found, put, words) in [
        ("\ndiameter_in = 0.5", "\ndiameter_in = 12.7", "tool.diameter_in is 12.7; expected 0.00394 to 3.93 in"),
        (
            "\ndiameter_in = 0.5",
            "\ndiameter_in = 12.7",
            "check the value; if it is in millimetres, write diameter_mm = 12.7",
        ),
        ("feed_in_per_min = 20", "feed_in_per_min = 0", "expected 0.00394 to 3937 in/min"),
        ("axial_depth_in = 0.25", "axial_depth_in = \"deep\"", "a number, above 0, up to 7.87 in"),
        ("diameter_in = 0.4998", "diameter_in = 0.6", "a diameter within 10 % of diameter_in, 0.500 in"),
        ("stickout_in = 2", "stickout_in = 0.2", "at least cut.axial_depth_in, 0.250 in"),
        ("allowance_in = 0.02", "allowance_in = 0.5", "less than the cutter's diameter, 0.500 in"),
        ("allowance_in = 0.02", "allowence_in = 0.02", "did you mean allowance_in where allowence_in is written?"),
        ("\nclamp_in = 0.01", "\nclam_in = 0.01", "did you mean clamp_in?"),
        ("\ndiameter_in = 0.5", "", "expected a number, 0.00394 to 3.93 in"),
        ("\ndiameter_in = 0.5", "", "add diameter_in under [tool]"),
        ("band_in = [0.05, 0.2]", "band_in = [0.05, 0.3]", "within 0.000 to 0.250 in"),
        ("work_offset_in = [1, -10, 0]", "work_offset_in = [1, -500, 0]", "three lengths, -393.701 to 393.701 in"),
        ("tolerance_in = 0.001", "tolerance_in = 20", "expected 0.000004 to 0.393 in"),
        ("tolerance_in = 0.001", "lower_in = 0.001\nupper_in = -0.001", "above part.lower_in, 0.00100 in"),
        ("tolerance_in = 0.001", "lower_in = 0.001", "part.upper_in is missing; expected a number, -0.393 to 0.393 in"),
    ] {
        assert!(INCHES.contains(found), "{found}");
        let said = refused(&INCHES.replace(found, put));
        assert!(said.contains(words), "{words}\n{said}");
        let metric = said.replace("if it is in millimetres, write diameter_mm", "").replace("[cut]", "");
        assert!(!metric.contains("_mm") && !metric.contains(" mm"), "{said}");
    }
    let said = refused(&METRIC.replace("\ndiameter_mm = 12.7", "\ndiameter_mm = 322.58"));
    assert!(said.contains("tool.diameter_mm is 322.58; expected 0.1 to 100 mm"), "{said}");
}

#[test]
fn a_length_in_both_units_is_a_contradiction_and_a_force_per_inch_no_key() {
    let said = refused(&INCHES.replace("allowance_in = 0.02", "allowance_in = 0.02\nallowance_mm = 0.508"));
    assert!(said.contains("J008") && said.contains("stock.allowance_in is given as well as allowance_mm"), "{said}");
    let said = refused(&INCHES.replace("[machine]\n", "[machine]\nstiffness_x_n_per_in = 1000\n"));
    assert!(said.contains("J003") && said.contains("stiffness_x_n_per_in"), "{said}");
    let said = refused(&INCHES.replace("teeth = 4", "teeth = 4\nhelix_in = 4"));
    assert!(said.contains("J003"), "{said}");
}
