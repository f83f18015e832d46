//! Ours beside what others have for the same, in one run on one machine: reading of programs, what a servo period costs, the correction
//! beside the law of the papers and a mirror, and how fast virtual parts are studied.

use std::collections::BTreeMap;
use std::fs;
use std::process::Stdio;

use serde_json::Value;

use super::rates;
use crate::cost::Meter;
use crate::linuxcnc::{Sample, median_us, typical_times};
use crate::repository::{program, read, root, run, target};
use crate::step::{Failure, Outcome, Passed};
use crate::table;
use crate::toolchain::need;

/// The document the table is written into.
const DOCUMENT: &str = "docs/measure.md";
/// Components that come with LinuxCNC and do something in every period, on a signal that changes.
const COMPONENTS: &str = "loadrt threads name1=servo period1=1000000
loadrt siggen
loadrt limit3
loadrt lowpass
loadrt biquad
loadrt pid num_chan=1
addf siggen.0.update servo
addf limit3.0 servo
addf lowpass.0 servo
addf biquad.0 servo
addf pid.0.do-pid-calcs servo
net signal siggen.0.sine limit3.0.in lowpass.0.in biquad.0.in pid.0.command
setp limit3.0.maxv 1
setp limit3.0.maxa 10
setp limit3.0.min -10
setp limit3.0.max 10
setp lowpass.0.gain 0.1
setp biquad.0.f0 50
setp biquad.0.enable 1
setp pid.0.Pgain 10
setp pid.0.enable 1
start
loadusr -w sh sample.sh
";
/// Reads their counters some hundred times.
const SAMPLER: &str = "i=0; while [ $i -lt 300 ]; do halcmd -s show pin '*.time'; sleep 0.004; i=$((i+1)); done\n";
/// Virtual parts that are studied: families, and seeds of each.
const STUDIED: (&str, u32) = ("corner-papers-helix,pocket-climb,boss,wave", 2);

/// Measures; with `write` the table goes into the document.
pub fn measure(write: bool) -> Outcome {
    need(
        || program("halrun").arg("-h").output().is_ok(),
        "linuxcnc-uspace",
        "the components beside ours are LinuxCNC's",
    )?;
    let mut rows: Vec<(String, String)> =
        rates::measured("reading")?.into_iter().map(|(name, rate)| (name, format!("{rate} MB/s"))).collect();
    rows.extend(corrections()?);
    rows.push(study()?);
    let microseconds = |name: &str, us: f64| (format!("servo period: {name}"), format!("{us:.2} µs"));
    rows.extend(components()?.iter().map(|(name, us)| microseconds(&format!("`{name}`"), *us)));
    rows.extend(typical_times("corner")?.iter().map(|(name, us)| microseconds(name, *us)));
    for (name, value) in &rows {
        println!("{name:<64} {value:>40}");
    }
    if write {
        table::replace(&root().join(DOCUMENT), "peers", &table::table(["what", "measured"], rows))?;
    }
    Ok(Passed::Done)
}

/// The helical corner of the demonstration, touched where `probe` says: what each law of correction leaves on the virtual machine, and
/// what the correction takes.
fn corrections() -> Result<Vec<(String, String)>, Failure> {
    let folder = target().join("peers");
    let found = |e: std::io::Error| Failure::found(format!("{}: {e}", folder.display()));
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).map_err(found)?;
    for name in ["program.nc", "plant.toml", "job.toml"] {
        fs::copy(root().join("host-sim/demo/corner-helix").join(name), folder.join(name)).map_err(found)?;
    }
    let truepath = |arguments: &str| {
        let mut command = program(target().join("release/truepath"));
        command.args(arguments.split(' ')).arg("--quiet").current_dir(&folder).stderr(Stdio::null());
        run(&mut command)
    };
    truepath("probe job.toml --dialect linuxcnc -o verify.nc")?;
    truepath("simulate job.toml --plant plant.toml --touch verify.nc -o first")?;
    let meter = Meter::start();
    truepath("correct job.toml --probe first/probe.txt -o corrected")?;
    let seconds = meter.read().processor.as_secs_f64();
    truepath("compare job.toml --probe first/probe.txt --plant plant.toml -o compared")?;
    let text = fs::read_to_string(folder.join("compared/summary.json")).map_err(found)?;
    let summary: Value = serde_json::from_str(&text).map_err(|e| Failure::found(e.to_string()))?;
    let mut rows = Vec::new();
    for law in summary["laws"].as_array().map(Vec::as_slice).unwrap_or_default() {
        let [mean, height] = ["max_error_mm", "worst_height_mm"].map(|key| law[key].as_f64());
        let (Some(title), Some(mean), Some(height)) = (law["title"].as_str(), mean, height) else {
            return Err(Failure::found("a law without its errors in summary.json of compare"));
        };
        let left = format!("{mean:.3} mm of the mean over the height, {height:.3} mm at any height");
        rows.push((format!("helical corner: {title}"), left));
    }
    rows.push(("helical corner: time of `correct`".to_owned(), format!("{seconds:.2} s of the processor")));
    Ok(rows)
}

/// How many virtual parts a second are milled, touched, corrected and milled again.
fn study() -> Result<(String, String), Failure> {
    let (families, seeds) = STUDIED;
    let folder = target().join("peers/study");
    let meter = Meter::start();
    let mut command = program(target().join("release/truepath"));
    command.args(["study", "--quiet", "--set", "test", "--families", families, "--seeds", &seeds.to_string(), "-o"]);
    run(command.arg(folder))?;
    let parts = families.split(',').count() as f64 * f64::from(seeds);
    let seconds = meter.read().wall.as_secs_f64();
    Ok(("`study`: cases".to_owned(), format!("{:.2} a second, two cores", parts / seconds)))
}

/// What each of LinuxCNC's components takes in a period, µs: the median of HAL's own counters.
fn components() -> Result<Vec<(String, f64)>, Failure> {
    let sample = Sample::fresh("peers")?;
    for (name, text) in [("peers.hal", COMPONENTS), ("sample.sh", SAMPLER)] {
        fs::write(sample.folder.join(name), text).map_err(|e| Failure::found(e.to_string()))?;
    }
    sample.user.own(&sample.folder)?;
    let said = read(sample.user.program("halrun", &sample.folder).arg("-f").arg("peers.hal"))?;
    let mut clocks: BTreeMap<&str, Vec<i64>> = BTreeMap::new();
    for (name, count) in said.lines().filter_map(counter) {
        clocks.entry(name).or_default().push(count);
    }
    let rows: Vec<(String, f64)> =
        clocks.into_iter().map(|(name, counts)| (name.to_owned(), median_us(counts))).collect();
    if rows.is_empty() { Err(Failure::found("HAL showed no counter")) } else { Ok(rows) }
}

/// `biquad s32   OUT 1690 biquad.0.time` as `halcmd -s show pin` has it, without those of threads.
fn counter(line: &str) -> Option<(&str, i64)> {
    let [_, "s32", "OUT", count, name] = line.split_whitespace().collect::<Vec<_>>()[..] else { return None };
    let name = name.strip_suffix(".time").filter(|name| name.contains('.'))?;
    Some((name, count.parse().ok()?))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counters_of_functions_are_read() {
        assert_eq!(counter("biquad s32   OUT 1690 biquad.0.time"), Some(("biquad.0", 1690)));
        assert_eq!(counter("__servo s32   OUT 72046 servo.time"), None);
        assert_eq!(counter(""), None);
    }
}
