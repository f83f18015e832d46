//! The command: from the dynamometer of a virtual machine to a job, and real means from the command line.

use std::fs;

use crate::workplace::truepath;

const PROGRAM: &str = "%\nG21 G90 G17 G40\nS4200 M3\nG0 X0 Y-20 Z10\nG1 Z-6 F300\nG1 X80 F1344\nG0 Z50\nM30\n%\n";

const JOB: &str = "version = 1\nprogram = \"part.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 4\n[tool]\ndiameter_mm = 12\n\
    teeth = 4\nhelix_deg = 35\n[cut]\naxial_depth_mm = 6\n[force]\nmaterial = \"al-6082-t6\"\n[machine]\n\
    stiffness_x_n_per_mm = 4000\nstiffness_y_n_per_mm = 4000\n";

const PLANT: &str = "ktc_n_per_mm2 = 900\nkrc_n_per_mm2 = 250\nkte_n_per_mm = 12\nkre_n_per_mm = 14\n\
    stiffness_x_n_per_mm = 4000\nstiffness_y_n_per_mm = 4000\nseed = 3\n";

#[test]
fn what_a_virtual_dynamometer_records_becomes_the_force_of_a_job() {
    let folder = tempfile::tempdir().expect("a folder");
    for (name, text) in [("part.nc", PROGRAM), ("job.toml", JOB), ("plant.toml", PLANT)] {
        fs::write(folder.path().join(name), text).expect("a file");
    }
    let run = |arguments: &[&str]| {
        let done = truepath(folder.path(), arguments);
        assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
        String::from_utf8_lossy(&done.stdout).into_owned()
    };
    run(&["simulate", "job.toml", "--plant", "plant.toml", "--dynamometer", "-o", "out"]);
    let said = run(&["forces", "out/dynamometer/cuts.toml", "-o", "measured"]);
    assert!(said.contains("for the job: Ktc"), "{said}");
    let page = fs::read_to_string(folder.path().join("measured/report.html")).expect("a page");
    assert!(page.contains("Mean force over feed") && page.matches("<svg").count() == 6);
    // The plant's coefficients, within what is said of them, are those of a job that takes the file.
    let written = fs::read_to_string(folder.path().join("measured/forces.toml")).expect("a file");
    let table: toml::Table = written.parse().expect("TOML");
    let number = |table_name: &str, key: &str| table[table_name][key].as_float().expect("a number");
    for (key, truth) in
        [("ktc_n_per_mm2", 900.0), ("krc_n_per_mm2", 250.0), ("kte_n_per_mm", 12.0), ("kre_n_per_mm", 14.0)]
    {
        let (found, sigma) = (number("force", key), number("prior", key));
        assert!((found - truth).abs() < 3.0 * sigma && sigma < 0.4 * truth, "{key} {found} ± {sigma}");
    }
    let job = JOB.replace("material = \"al-6082-t6\"", "from = \"measured/forces.toml\"");
    fs::write(folder.path().join("job.toml"), &job).expect("a file");
    run(&["simulate", "job.toml", "-o", "with"]);
    // What goes wrong with it.
    for (text, code) in [
        (job.replace("measured/forces.toml", "none.toml"), "J001"),
        (job.replace("from =", "material = \"al-6082-t6\"\nfrom ="), "J008"),
        (job.replace("measured/forces.toml", "plant.toml"), "J004"),
    ] {
        fs::write(folder.path().join("job.toml"), text).expect("a file");
        let done = truepath(folder.path(), &["simulate", "job.toml", "-o", "wrong", "--json"]);
        let said = String::from_utf8_lossy(&done.stderr).into_owned();
        assert!(done.status.code() == Some(1) && said.contains(code), "{said}");
    }
}

#[test]
fn means_without_axes_find_the_axes_and_predict_what_was_not_fitted() {
    let folder = tempfile::tempdir().expect("a folder");
    let means = [
        (0.025, 63.02, -39.80),
        (0.05, 107.14, -60.05),
        (0.075, 137.67, -71.60),
        (0.1, 171.27, -76.75),
        (0.125, 210.74, -78.49),
    ];
    let cuts: String = means
        .iter()
        .enumerate()
        .map(|(k, (f, x, y))| {
            let using = if k % 2 == 0 { "fit" } else { "predict" };
            format!("[[cut]]\nfeed_per_tooth_mm = {f}\nfeed_n = {x}\nacross_n = {y}\nuse = \"{using}\"\n")
        })
        .collect();
    let text = format!(
        "version = 1\n[tool]\ndiameter_mm = 25\nteeth = 2\nhelix_deg = 45\n[cutting]\naxial_depth_mm = 3\nspindle_rpm = 6000\n\
         milling = \"slot\"\n{cuts}"
    );
    fs::write(folder.path().join("cuts.toml"), text).expect("a file");
    let done = truepath(folder.path(), &["forces", "cuts.toml", "-o", "out"]);
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(said.contains("feed = \"across_n\", across = \"feed_n\""), "{said}");
    assert!(said.contains("cuts that were not fitted are predicted within 4."), "{said}");
}
