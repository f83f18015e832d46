//! How long `truepath correct` takes on long contours, and how much memory: waves of short lines up to ten metres long, one of
//! very short lines and one of long ones.

use std::path::Path;
use std::process::{Command, Stdio};
use std::time::Duration;

use crate::cost::{Cost, Meter};
use crate::repository::{cargo, program, root, run, target};
use crate::step::{Failure, Outcome, Passed};
use crate::table;

/// The document the table is written into.
const DOCUMENT: &str = "docs/measure.md";
/// Name, lines, length of each, period and height of the wave, mm.
const CONTOURS: [(&str, usize, f64, f64, f64); 6] = [
    ("5,000 lines of 0.2 mm, 1 m", 5_000, 0.2, 60.0, 6.0),
    ("10,000 lines of 0.2 mm, 2 m", 10_000, 0.2, 60.0, 6.0),
    ("25,000 lines of 0.2 mm, 5 m", 25_000, 0.2, 60.0, 6.0),
    ("50,000 lines of 0.2 mm, 10 m", 50_000, 0.2, 60.0, 6.0),
    ("10,000 lines of 0.1 mm, 1 m", 10_000, 0.1, 60.0, 6.0),
    ("1,000 lines of 5 mm, 5 m", 1_000, 5.0, 200.0, 10.0),
];
/// Cutter radius, ball radius, engaged depth, mm.
const CUT: (f64, f64, f64) = (6.0, 2.0, 10.0);
const JOB: &str = "version = 1
program = \"program.nc\"
wall = \"right\"
[stock]
allowance_mm = 0.5
[tool]
diameter_mm = 12.0
teeth = 4
helix_deg = 30
[cut]
axial_depth_mm = 10.0
[force]
ktc_n_per_mm2 = 820
krc_n_per_mm2 = 230
kte_n_per_mm = 12
kre_n_per_mm = 12
model = \"helical\"
[machine]
stiffness_x_n_per_mm = 1900
stiffness_y_n_per_mm = 1900
[probe]
ball_diameter_mm = 4.0
format = \"linuxcnc\"
z_reference = \"centre\"
";

/// Measures from start to end of the command, files included; with `write` the table goes into the document.
pub fn measure(write: bool) -> Outcome {
    run(cargo().args(["build", "--quiet", "--release", "--package", "truepath"]))?;
    let folder = target().join("long-contours");
    std::fs::create_dir_all(&folder).map_err(|e| Failure::found(e.to_string()))?;
    let mut rows = Vec::new();
    for (name, lines, length, period, height) in CONTOURS {
        files(&folder, &wave(lines, length, period, height)).map_err(|e| Failure::found(e.to_string()))?;
        let mut command = program(target().join("release/truepath"));
        command.args(["--quiet", "correct"]).arg(folder.join("job.toml"));
        command.arg("--probe").arg(folder.join("probe.txt")).arg("--force").arg("-o").arg(folder.join("out"));
        let (cost, megabytes) = watched(command.stdout(Stdio::null()).stderr(Stdio::null()))?;
        let [wall, processor] = [cost.wall, cost.processor].map(|time| format!("{:.1}", time.as_secs_f64()));
        println!("{name:<32} {wall:>6} s, {processor:>6} s of the processor, {megabytes:>5} MB");
        rows.push((name.to_owned(), format!("{wall} | {processor} | {megabytes}")));
    }
    if write {
        let head = ["contour", "s | s of the processor | MB"];
        table::replace(&root().join(DOCUMENT), "long", &table::table(head, rows))?;
    }
    Ok(Passed::Done)
}

/// Runs a command: what it cost, and the most memory it had, MB, as Linux tells (0 elsewhere).
fn watched(command: &mut Command) -> Result<(Cost, u64), Failure> {
    let failed = |e: std::io::Error| Failure::found(e.to_string());
    let meter = Meter::start();
    let mut child = command.spawn().map_err(failed)?;
    let mut kilobytes = 0;
    loop {
        // Only what runs has a peak, and it only grows.
        let status = std::fs::read_to_string(format!("/proc/{}/status", child.id())).unwrap_or_default();
        kilobytes = peak(&status).unwrap_or(kilobytes);
        if let Some(status) = child.try_wait().map_err(failed)? {
            let cost = meter.read();
            return if status.success() {
                Ok((cost, kilobytes / 1_000))
            } else {
                Err(Failure::found(status.to_string()))
            };
        }
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// The most memory of a process by its `/proc/PID/status`, kB.
fn peak(status: &str) -> Option<u64> {
    status.lines().find_map(|line| line.strip_prefix("VmHWM:")?.split_whitespace().next()?.parse().ok())
}

/// Points of a sine wave, equal distances apart along it.
fn wave(lines: usize, length: f64, period: f64, height: f64) -> Vec<[f64; 2]> {
    let step = length / 200.0;
    let (mut points, mut at, mut way) = (vec![[0.0; 2]], [0.0; 2], 0.0);
    while points.len() <= lines {
        let x: f64 = at[0] + step;
        let next = [x, height * (std::f64::consts::TAU * x / period).sin()];
        way += (next[0] - at[0]).hypot(next[1] - at[1]);
        at = next;
        if way >= length {
            way -= length;
            points.push(at);
        }
    }
    points
}

/// Program, job, and fifteen touches of a wall that stands 0.03 to 0.05 mm proud.
fn files(folder: &Path, points: &[[f64; 2]]) -> std::io::Result<()> {
    let [start, rest @ ..] = points else { return Ok(()) };
    let mut text =
        format!("%\nG21 G90 G94\nT1 M6\nS4000 M3\nG0 X{:.4} Y{:.4}\nG0 Z5\nG1 Z-10 F200\nF800\n", start[0], start[1]);
    for [x, y] in rest {
        text += &format!("G1 X{x:.4} Y{y:.4}\n");
    }
    text += "G0 Z5\nM30\n%\n";
    let (radius, ball, depth) = CUT;
    let mut touches = String::new();
    for share in [0.1, 0.3, 0.5, 0.7, 0.9] {
        let at = (points.len() as f64 * share) as usize;
        let (Some(a), Some(b)) = (points.get(at), points.get(at + 1)) else { continue };
        let length = (b[0] - a[0]).hypot(b[1] - a[1]);
        // The wall is on the right.
        let normal = [(b[1] - a[1]) / length, (a[0] - b[0]) / length];
        for (height, error) in [(0.1, 0.05), (0.5, 0.035), (0.9, 0.03)] {
            let reach = radius - error - ball;
            let touch = [0, 1].map(|k| f64::midpoint(a[k], b[k]) + normal[k] * reach);
            touches += &format!("{:.6} {:.6} {:.6} 0 0 0 0 0 0\n", touch[0], touch[1], (height - 1.0) * depth);
        }
    }
    std::fs::write(folder.join("program.nc"), text)?;
    std::fs::write(folder.join("job.toml"), JOB)?;
    std::fs::write(folder.join("probe.txt"), touches)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_peak_of_memory_is_read() {
        assert_eq!(peak("Name:\ttruepath\nVmPeak:\t  9 kB\nVmHWM:\t   73556 kB\n"), Some(73_556));
        assert_eq!(peak("Name:\tgone\n"), None);
    }

    #[test]
    fn the_lines_of_a_wave_have_the_length_asked_for() {
        let points = wave(400, 0.5, 60.0, 6.0);
        assert_eq!(points.len(), 401);
        let lengths = points.windows(2).map(|w| (w[1][0] - w[0][0]).hypot(w[1][1] - w[0][1]));
        assert!(lengths.clone().all(|l| (l - 0.5).abs() < 0.01), "{:?}", lengths.collect::<Vec<_>>());
    }
}
