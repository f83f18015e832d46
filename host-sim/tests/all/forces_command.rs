//! The command: from the dynamometer of a virtual machine to a job, and real means from the command line.

use std::fs;

use crate::workplace::{Workplace, truepath};

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
    fs::write(folder.path().join("cuts.toml"), &text).expect("a file");
    let done = truepath(folder.path(), &["forces", "cuts.toml", "-o", "out"]);
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert_eq!(done.status.code(), Some(0), "{}", String::from_utf8_lossy(&done.stderr));
    assert!(said.contains("feed = \"across_n\", across = \"feed_n\""), "{said}");
    assert!(said.contains("cuts that were not fitted are predicted within 4."), "{said}");

    // In inches: the same forces, told in inches; what is written keeps millimetres.
    let written = fs::read_to_string(folder.path().join("out/forces.toml")).expect("a file");
    let inches: String = text
        .split_inclusive('\n')
        .map(|line| {
            match line.trim_end().split_once("_mm = ").and_then(|(key, mm)| Some((key, mm.parse::<f64>().ok()?))) {
                Some((key, mm)) => format!("{key}_in = {:.9}\n", mm / 25.4),
                None => line.to_owned(),
            }
        })
        .collect();
    fs::write(folder.path().join("cuts.toml"), &inches).expect("a file");
    let done = truepath(folder.path(), &["forces", "cuts.toml", "-o", "inch"]);
    let said = String::from_utf8_lossy(&done.stdout).into_owned();
    assert!(said.contains(": 0.00098 in per tooth") && !said.contains(" mm"), "{said}");
    let again = fs::read_to_string(folder.path().join("inch/forces.toml")).expect("a file");
    let numbers = |text: &str| text.lines().filter(|line| line.starts_with("ktc")).collect::<String>();
    assert_eq!(numbers(&again), numbers(&written));
    fs::write(folder.path().join("cuts.toml"), inches.replace("axial_depth_in = 0.1", "#")).expect("a file");
    let done = truepath(folder.path(), &["forces", "cuts.toml", "-o", "none"]);
    let told = String::from_utf8_lossy(&done.stderr).into_owned();
    assert!(told.contains("axial_depth_in of a cut is missing; expected a number, above 0, up to 7.87 in"), "{told}");
}

/// Round a corner of a boss, climbing, with three teeth: a part beside those of the demonstration.
const BOSS: [&str; 3] = [
    "version = 1\nprogram = \"program.nc\"\nwall = \"right\"\n[stock]\nallowance_mm = 1.2\n[tool]\ndiameter_mm = 12\nteeth = 3\n\
        helix_deg = 35\n[cut]\naxial_depth_mm = 14\n[force]\nktc_n_per_mm2 = 820\nkrc_n_per_mm2 = 230\nkte_n_per_mm = 12\n\
        kre_n_per_mm = 12\nmodel = \"auto\"\n[machine]\nstiffness_x_n_per_mm = 1300\nstiffness_y_n_per_mm = 1300\n[probe]\n\
        ball_diameter_mm = 4\nformat = \"linuxcnc-log\"\n",
    "ktc_n_per_mm2 = 700\nkrc_n_per_mm2 = 220\nkte_n_per_mm = 14\nkre_n_per_mm = 15\nsize_exponent = 0.15\n\
        compliance_mm_per_n = [[0.0006, 0.00004], [0.00004, 0.0009]]\nbend = 0.15\nprobe_noise_mm = 0.002\nseed = 1\n",
    "%\nG21 G90 G17 G40 G94\nS4500 M3\nG0 X-20 Y46 Z10\nG1 Z-14 F300\nG1 X50 Y46 F810\nG2 X66 Y30 I0 J-16\nG1 X66 Y-30\nG0 Z50\nM30\n%\n",
];

/// The largest mean error over the height that a part leaves, mm: as programmed, then corrected with forces that were guessed, with the
/// coefficients that `truepath forces` found, and with its runout as well. The axis of the plant is offset by so much, 20 degrees
/// behind a tooth.
fn left(part: &str, runout_mm: f64, seed: u64) -> [f64; 4] {
    let desk = Workplace::with(&[]);
    let [job, plant, program] = match part {
        "boss" => BOSS.map(str::to_owned),
        part => {
            let demo = Workplace::demo(part, &["job.toml", "plant.toml", "program.nc"]);
            ["job.toml", "plant.toml", "program.nc"].map(|name| demo.read(name))
        }
    };
    let job = job.replace("\"linuxcnc\"", "\"linuxcnc-log\"");
    let table: toml::Table = job.parse().expect("a job");
    let teeth = table["tool"]["teeth"].as_integer().expect("teeth");
    let pitch = std::f64::consts::TAU / teeth as f64;
    let reach: Vec<f64> =
        (0..teeth).map(|tooth| runout_mm * (pitch * tooth as f64 + 20f64.to_radians()).cos()).collect();
    let kept = plant.lines().filter(|line| !line.starts_with("runout_mm") && !line.starts_with("seed"));
    let plant = kept.collect::<Vec<_>>().join("\n") + &format!("\nseed = {seed}\nrunout_mm = {reach:?}\n");
    let from = |job: &str| {
        let guessed = |line: &&str| !["ktc", "krc", "kte", "kre"].iter().any(|key| line.starts_with(key));
        let job = job.lines().filter(guessed).collect::<Vec<_>>().join("\n");
        job.replace("[force]", "[force]\nfrom = \"measured/forces.toml\"\n#")
    };
    let coefficients = from(&job);
    let both = coefficients.replace("[tool]", "[tool]\nrunout_from = \"measured/forces.toml\"");
    for (name, text) in [("job.toml", &job), ("plant.toml", &plant), ("program.nc", &program)] {
        desk.write(name, text);
    }
    desk.call("probe job.toml --dialect linuxcnc -o verify.nc");
    let first = desk.call("simulate job.toml --plant plant.toml --touch verify.nc --dynamometer -o first");
    desk.call("forces first/dynamometer/cuts.toml -o measured");
    let error = |told: &serde_json::Value| told["judged"]["max_error_mm"].as_f64().expect("an error");
    let corrected = |name: &str, job: &str| {
        desk.write(&format!("{name}.toml"), job);
        desk.call(&format!("correct {name}.toml --probe first/probe.txt -o {name}"));
        let program = format!("{name}/corrected.nc");
        error(&desk.call(&format!("simulate {name}.toml --plant plant.toml --program {program} -o {name}-cut")))
    };
    [error(&first), corrected("guessed", &job), corrected("coefficients", &coefficients), corrected("both", &both)]
}

/// What is left of three parts at these runouts, and the sums over the parts at the last.
fn left_of_three_parts(runouts_mm: &[f64]) -> [f64; 3] {
    let mut all = [0.0; 3];
    for part in ["corner-helix", "pocket", "boss"] {
        for (k, runout_mm) in runouts_mm.iter().enumerate() {
            let left = left(part, *runout_mm, 2);
            println!("{part} {runout_mm:.3}: {left:.4?}");
            if k + 1 == runouts_mm.len() {
                all.iter_mut().zip(&left[1..]).for_each(|(sum, one)| *sum += one);
            }
        }
    }
    all
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn measured_coefficients_and_runout_lower_what_three_parts_leave() {
    let all = left_of_three_parts(&[0.010]);
    assert!(all[2] < all[0] && all[2] < all[1], "{all:?}");
}

#[test]
#[ignore = "campaign: the table of docs/forces.md"]
fn campaign_measured_coefficients_and_runout_lower_what_three_parts_leave() {
    let all = left_of_three_parts(&[0.0, 0.005, 0.010]);
    assert!(all[2] < all[0] && all[2] < all[1], "{all:?}");
}
