//! The pages that are tried: each written by the program, of the kind a user has.
//!
//! The demonstration; a pass predicted and one cut by the virtual machine; an island with its wall on the left, cut
//! conventionally, corrected, learnt from, inspected and planned; a plate with five contours, touched by the virtual machine, corrected,
//! learnt from, inspected and planned together; a part of a program in inches; and a contour of ten metres with 100,000 samples.

use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Stdio;

use crate::repository::{self, Profile, program, root, run, target};
use crate::step::Failure;

/// Job, program, machine and touches of the island, relative to the root.
const ISLAND: &str = "host-sim/page/tests/parts/island";
/// Job, program and machine of the plate.
const PLATE: &str = "host-sim/page/tests/parts/plate";
/// Program of a part in inches and its machine; what its job says beside the program.
const INCHES: [&str; 2] = ["tests/data/shop/fusion-haas-inch-cover.nc", "tests/data/shop/plant.toml"];
const INCH_JOB: [&str; 5] = [
    "allowance=0.02in",
    "probe.ball_diameter_in=0.25",
    "material=al-7075-t6",
    "stiffness=2500",
    "part.tolerance_in=0.0015",
];
/// Radius, depth and number of the lobes of the long contour, mm: a star, ten metres long to a few percent.
const STAR: (f64, f64, f64) = (1480.0, 60.0, 12.0);
/// Length of its lines, mm.
const LINE: f64 = 5.0;
const LONG_JOB: &str = "version = 1
program = \"program.nc\"
wall = \"left\"
[stock]
allowance_mm = 0.5
[tool]
diameter_mm = 12.0
teeth = 4
helix_deg = 30
[cut]
axial_depth_mm = 10.0
[force]
material = \"al-7075-t6\"
model = \"helical\"
[machine]
stiffness_x_n_per_mm = 1200
stiffness_y_n_per_mm = 2400
";

/// Limits under which a search is short.
const FEW: &str = "\n[plan]\nmax_cuts = 2\nmax_levels = 1\nmax_percent = 100\n";

/// Has the program write all pages into `page` of the target directory; returns that folder.
///
/// # Errors
/// A command that fails.
pub fn write() -> Result<PathBuf, Failure> {
    let tool = repository::truepath(Profile::Dev)?;
    let pages = target().join("page");
    let truepath = |arguments: &[&Path], out: &str| {
        let mut command = program(&tool);
        command.args(arguments).arg("--output").arg(pages.join(out));
        run(command.stdout(Stdio::null()).stderr(Stdio::null()))
    };
    let word = Path::new;
    let force = word("--force");
    let pocket = |file: &str| pages.join("demo/pocket").join(file);
    let island = |file: &str| root().join(ISLAND).join(file);
    truepath(&[word("demo"), force], "demo")?;
    truepath(&[word("simulate"), force, &pocket("job.toml")], "simulate-core")?;
    truepath(
        &[word("simulate"), force, &pocket("job.toml"), word("--plant"), &pocket("plant.toml")],
        "simulate-plant",
    )?;
    truepath(&[word("simulate"), force, &island("job.toml"), word("--plant"), &island("plant.toml")], "island")?;
    let touched = [island("job.toml"), island("probe.txt"), island("probe-2.txt")];
    let [job, first, second] = touched.each_ref().map(PathBuf::as_path);
    truepath(&[word("inspect"), force, job, word("--probe"), first], "inspect")?;
    truepath(&[word("correct"), force, job, word("--probe"), first], "correct")?;
    truepath(&[word("learn"), force, job, word("--probe"), second, word("--from"), &pages.join("correct")], "learn")?;
    let tolerance = [word("--tolerance"), word("0.02"), word("--write")];
    truepath(&[&[word("plan"), force, job, word("--probe"), first][..], &tolerance].concat(), "plan")?;
    plate(&pages.join("plate"), &truepath)?;
    inches(&pages.join("inch"), &truepath)?;
    let long = pages.join("long");
    long_job(&long).map_err(|e| Failure::found(format!("{}: {e}", long.display())))?;
    truepath(&[word("simulate"), force, &long.join("job.toml")], "long")?;
    Ok(pages)
}

/// The plate the whole way: predicted, cut and touched, inspected, corrected, cut and touched again, learnt from.
fn plate(folder: &Path, truepath: &impl Fn(&[&Path], &str) -> Result<(), Failure>) -> Result<(), Failure> {
    let word = Path::new;
    let file = |name: &str| root().join(PLATE).join(name);
    let (job, machine) = (file("job.toml"), file("plant.toml"));
    let of = [word("--force"), &job];
    let run = |command: &str, more: &[&Path], out: &str| {
        let arguments: Vec<&Path> = [word(command)].iter().chain(&of).chain(more).copied().collect();
        truepath(&arguments, &format!("plate/{out}"))
    };
    let (verify, corrected) = (folder.join("verify.nc"), folder.join("correct"));
    let touched = |part: &str| folder.join(part).join("probe.txt");
    run("simulate", &[], "simulate")?;
    run("probe", &[word("--dialect"), word("linuxcnc")], "verify.nc")?;
    let cut = [word("--plant"), &machine, word("--touch"), &verify];
    run("simulate", &cut, "first")?;
    run("inspect", &[word("--probe"), &touched("first")], "inspect")?;
    run("correct", &[word("--probe"), &touched("first")], "correct")?;
    run("simulate", &[&cut[..], &[word("--from"), &corrected]].concat(), "second")?;
    run("learn", &[word("--probe"), &touched("second"), word("--from"), &corrected], "learn")?;
    // Five contours, each with what two passes can do.
    let text = fs::read_to_string(&job).map_err(|e| Failure::found(format!("{}: {e}", job.display())))?;
    let program = format!("program = {:?}", file("program.nc").display().to_string());
    let planned = folder.join("planned.toml");
    fs::write(&planned, text.replace("program = \"program.nc\"", &program) + FEW)
        .map_err(|e| Failure::found(format!("{}: {e}", planned.display())))?;
    truepath(&[word("plan"), word("--force"), &planned, word("--probe"), &touched("first")], "plate/plan")
}

/// A part in inches the whole way.
fn inches(folder: &Path, truepath: &impl Fn(&[&Path], &str) -> Result<(), Failure>) -> Result<(), Failure> {
    let word = Path::new;
    let [part, machine] = INCHES.map(|file| root().join(file));
    let (job, corrected) = (folder.join("job.toml"), folder.join("correct"));
    let touched = |part: &str| folder.join(part).join("probe.txt");
    let init = [word("init"), word("--force"), &part, word("--yes")];
    let set = INCH_JOB.iter().flat_map(|said| [word("--set"), word(said)]);
    fs::create_dir_all(folder).map_err(|e| Failure::found(format!("{}: {e}", folder.display())))?;
    truepath(&init.into_iter().chain(set).collect::<Vec<_>>(), "inch/job.toml")?;
    let verify = folder.join("verify.nc");
    let run = |command: &str, more: &[&Path], out: &str| {
        let arguments: Vec<&Path> =
            [word(command), word("--force"), &job].into_iter().chain(more.iter().copied()).collect();
        truepath(&arguments, &format!("inch/{out}"))
    };
    run("probe", &[], "verify.nc")?;
    let cut = [word("--plant"), &machine, word("--touch"), &verify];
    run("simulate", &cut, "first")?;
    run("inspect", &[word("--probe"), &touched("first")], "inspect")?;
    run("correct", &[word("--probe"), &touched("first")], "correct")?;
    run("simulate", &[&cut[..], &[word("--from"), &corrected]].concat(), "second")?;
    run("learn", &[word("--probe"), &touched("second"), word("--from"), &corrected], "learn")
}

/// Program and job of the long contour.
fn long_job(folder: &Path) -> std::io::Result<()> {
    fs::create_dir_all(folder)?;
    let points = star();
    let mut text = String::from("%\nG21 G90 G94\nT1 M6\nS4000 M3\n");
    for (k, [x, y]) in points.iter().chain(points.first()).enumerate() {
        let line = if k == 0 { "G0" } else { "G1" };
        let plunge = if k == 0 { "\nG0 Z5\nG1 Z-10 F6000" } else { "" };
        writeln!(text, "{line} X{x:.4} Y{y:.4}{plunge}").expect("text is written to memory");
    }
    text += "G0 Z5\nM30\n%\n";
    fs::write(folder.join("program.nc"), text)?;
    fs::write(folder.join("job.toml"), LONG_JOB)
}

/// Corners of the long contour, counter-clockwise.
fn star() -> Vec<[f64; 2]> {
    let (radius, depth, lobes) = STAR;
    let at = |turn: f64| {
        let r = radius + depth * (lobes * turn).sin();
        [r * turn.cos(), r * turn.sin()]
    };
    let (mut points, mut turn) = (Vec::new(), 0.0);
    while turn < TAU {
        let here = at(turn);
        points.push(here);
        let ahead = at(turn + 1e-6);
        turn += LINE * 1e-6 / (ahead[0] - here[0]).hypot(ahead[1] - here[1]);
    }
    points
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_long_contour_is_long_and_made_of_lines_of_nearly_the_same_length() {
        let points = star();
        let lengths: Vec<f64> = points.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1])).collect();
        assert!(lengths.iter().sum::<f64>() > 9800.0);
        assert!(lengths.iter().all(|l| (l - LINE).abs() < 0.1), "{lengths:?}");
    }
}
