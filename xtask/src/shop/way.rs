//! One program the whole way, with the commands a user has.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Output, Stdio};
use std::time::Instant;

use serde_json::Value;

use super::table::Program;
use super::wall;
use crate::repository::{program, root, target};
use crate::step::Failure;

/// The machine of a folder without one of its own, from the root.
const PLANT: &str = "tests/data/shop/plant.toml";
/// Lengths of contours that differ by less are the same, mm.
const SAME_MM: f64 = 0.05;
/// A wall whose error grows by more than this, as a share, has become worse.
const WORSE: f64 = 1.02;

/// How far a program came.
#[derive(Clone, Debug, PartialEq)]
pub enum End {
    /// The corrected program was cut and the wall is better; the contour is the wall's.
    Through,
    /// The same, but the contour is longer or shorter than the wall by this, mm: leads were taken for wall, or wall for leads.
    OtherContour(f64),
    /// A command refused it with a code.
    Refused { step: &'static str, code: String },
    /// The wall is worse than without a correction.
    Worse,
    /// The program of the probe drives its ball into the wall.
    Collision,
    /// A command ended with a fault of its own.
    Fault { step: &'static str, code: String },
    /// The virtual machine cannot follow; the mistake is the table's or the harness's.
    Unjudged { step: &'static str, code: String },
}

impl End {
    /// For tables.
    pub fn word(&self) -> String {
        match self {
            Self::Through => "through".to_owned(),
            Self::OtherContour(_) => "other contour".to_owned(),
            Self::Refused { step, code } => format!("{step} {code}"),
            Self::Worse => "worse".to_owned(),
            Self::Collision => "collision".to_owned(),
            Self::Fault { step, code } => format!("{step} fault {code}"),
            Self::Unjudged { step, code } => format!("{step} unjudged {code}"),
        }
    }
    /// Whether it is bad whatever is expected.
    pub const fn is_fault(&self) -> bool {
        matches!(self, Self::Fault { .. } | Self::Worse | Self::Collision)
    }
    /// Whether it is worse than what a table expects.
    pub fn is_worse_than(&self, expected: &str) -> bool {
        match self {
            Self::Through => false,
            Self::OtherContour(_) => expected == "through",
            _ => matches!(expected, "through" | "other contour"),
        }
    }
}

/// What became of a program with one job.
#[derive(Clone, Debug)]
pub struct Run {
    /// How far it came.
    pub end: End,
    /// What was said where it ended.
    pub said: String,
    /// The line of the program that was named there, with its text.
    pub line: Option<(u64, String)>,
    /// Largest wall error without and with the correction, mm.
    pub errors_mm: Option<[f64; 2]>,
    /// Time of the commands of the user, s.
    pub seconds: f64,
}

/// What became of a program.
#[derive(Clone, Debug)]
pub struct Way {
    /// With nothing but wall side, allowance and cutter.
    pub bare: Run,
    /// With the lines of its first wall named, where the bare job did not go through.
    pub named: Option<Run>,
}

impl Way {
    /// Takes a program the whole way.
    ///
    /// # Errors
    /// When the files of the way cannot be written.
    pub fn of(folder: &Path, shop: &Program) -> Result<Self, Failure> {
        let stem = shop.file.replace(['/', '.'], "-");
        let place = target().join("shop").join(stem);
        let bare = walk(folder, shop, &place.join("bare"), false)?;
        let named = match bare.end {
            End::Through => None,
            _ => Some(walk(folder, shop, &place.join("named"), true)?),
        };
        Ok(Self { bare, named })
    }
}

/// A command that did not end well.
struct Stopped {
    code: String,
    said: String,
    line: Option<u64>,
    fault: bool,
}

fn walk(folder: &Path, shop: &Program, place: &Path, named: bool) -> Result<Run, Failure> {
    let failed = |e: std::io::Error| Failure::found(format!("{}: {e}", place.display()));
    if place.exists() {
        fs::remove_dir_all(place).map_err(failed)?;
    }
    fs::create_dir_all(place).map_err(failed)?;
    let name = Path::new(&shop.file).file_name().unwrap_or_default().to_string_lossy().into_owned();
    let text = fs::read(folder.join(&shop.file)).map_err(failed)?;
    fs::write(place.join(&name), &text).map_err(failed)?;
    let truth = job(shop, &name, true);
    let first = shop.walls.iter().map(|wall| wall.first().copied().unwrap_or_default());
    let own = if named { with_lines(&truth, &first.collect::<Vec<_>>()) } else { job(shop, &name, false) };
    fs::write(place.join("job.toml"), own).map_err(failed)?;
    let mut run = Run { end: End::Through, said: String::new(), line: None, errors_mm: None, seconds: 0.0 };
    if let Err((end, stopped)) = steps(folder, shop, (place, &name), &truth, &mut run) {
        run.end = end;
        if let Some(stopped) = stopped {
            run.said = stopped.said;
            let text = String::from_utf8_lossy(&text).into_owned();
            let line = |n: u64| text.lines().nth((n as usize).saturating_sub(1)).unwrap_or_default().trim().to_owned();
            run.line = stopped.line.map(|n| (n, line(n)));
        }
    }
    Ok(run)
}

/// Probe, touches, correct, cut again.
fn steps(
    folder: &Path,
    shop: &Program,
    (place, name): (&Path, &str),
    truth: &str,
    run: &mut Run,
) -> Result<(), (End, Option<Stopped>)> {
    let mut users = |step: &'static str, arguments: &[&str]| {
        let begun = Instant::now();
        let done = truepath(place, name, arguments);
        run.seconds += begun.elapsed().as_secs_f64();
        done.map_err(|stopped| {
            let end = match stopped.fault {
                true => End::Fault { step, code: stopped.code.clone() },
                false => End::Refused { step, code: stopped.code.clone() },
            };
            (end, Some(stopped))
        })
    };
    let plan = users("probe", &["probe", "job.toml", "--dialect", "linuxcnc", "-o", "verify.nc"])?;
    // The wall the places are on is the one that is milled.
    let touched: Vec<u64> =
        plan["points"].as_array().into_iter().flatten().filter_map(|p| p["line"].as_u64()).collect();
    let within =
        |range: &&[u32; 2]| touched.iter().filter(|l| (range[0].into()..=range[1].into()).contains(*l)).count();
    // Where several depths are touched, all of them are: they were cut alike.
    let whole = |wall: &Vec<[u32; 2]>| Some([wall.first()?[0], wall.last()?[1]]);
    let shallow = plan["points"].as_array().is_some_and(|points| {
        let below = |p: &Value| p["why_height"].as_str().is_some_and(|why| why.contains("pass below"));
        points.iter().any(below)
    });
    let milled = |wall: &Vec<[u32; 2]>| {
        let touched = wall.iter().rev().max_by_key(within).copied();
        if shallow { whole(wall) } else { touched }.unwrap_or_default()
    };
    let walls: Vec<[u32; 2]> = shop.walls.iter().map(milled).collect();
    let plant = [folder.join("plant.toml"), root().join(PLANT)];
    let plant = plant.into_iter().find(|p| p.exists()).unwrap_or_default().display().to_string();
    let unjudged = |step| {
        move |stopped: Stopped| {
            let end = match stopped.code.as_str() {
                "L004" => End::Collision,
                code if stopped.fault => End::Fault { step, code: code.to_owned() },
                code => End::Unjudged { step, code: code.to_owned() },
            };
            (end, Some(stopped))
        }
    };
    if let Err(e) = fs::write(place.join("wall.toml"), with_lines(truth, &walls)) {
        run.said = e.to_string();
        return Err((End::Unjudged { step: "write", code: String::new() }, None));
    }
    let mill = ["simulate", "wall.toml", "--plant", &plant];
    let first = truepath(place, name, &[&mill[..], &["--touch", "verify.nc", "-o", "first"]].concat());
    let first = first.map_err(unjudged("touch"))?;
    users("correct", &["correct", "job.toml", "--probe", "first/probe.txt", "-o", "out"])?;
    truepath(place, name, &[&mill[..], &["--from", "out", "-o", "second"]].concat()).map_err(unjudged("cut"))?;
    let mut worst = [0.0f64; 2];
    for folder in contours(&place.join("first")) {
        let of = |part: &str| {
            let beside = folder.strip_prefix(place.join("first")).unwrap_or(&folder);
            wall::largest_error_mm(&place.join(part).join(beside), shop.diameter_mm).unwrap_or(f64::NAN)
        };
        let errors = [of("first"), of("second")];
        worst = [worst[0].max(errors[0]), worst[1].max(errors[1])];
        run.errors_mm = Some(worst);
        if errors[1].is_nan() || errors[1] > WORSE * errors[0] {
            run.said = format!("{:.4} mm became {:.4} mm", errors[0], errors[1]);
            return Err((End::Worse, None));
        }
    }
    let corrected: f64 = contours(&place.join("out")).iter().map(|f| corrected_mm(&f.join("correction.csv"))).sum();
    let excess = corrected - first["length_mm"].as_f64().unwrap_or(f64::NAN);
    if excess.is_nan() || excess.abs() > SAME_MM * walls.len() as f64 {
        let lines: Vec<String> = walls.iter().map(|[first, last]| format!("{first}-{last}")).collect();
        run.said = format!("what is corrected is {excess:+.2} mm longer than the walls of lines {}", lines.join(", "));
        return Err((End::OtherContour(excess), None));
    }
    Ok(())
}

/// The folders of the contours in a folder of outputs: the folder itself where there is one contour.
fn contours(folder: &Path) -> Vec<PathBuf> {
    let Ok(entries) = fs::read_dir(folder.join("contours")) else { return vec![folder.to_owned()] };
    let mut folders: Vec<PathBuf> = entries.flatten().map(|entry| entry.path()).collect();
    folders.sort();
    folders
}

/// Length of the contour that was corrected, mm.
fn corrected_mm(rows: &Path) -> f64 {
    let text = fs::read_to_string(rows).unwrap_or_default();
    let last = text.lines().last().and_then(|l| l.split(',').next()).and_then(|s| s.parse().ok());
    last.unwrap_or(f64::NAN)
}

/// Runs a command of the tool in a folder; its summary, or what it said with the line of the program `name`.
fn truepath(place: &Path, name: &str, arguments: &[&str]) -> Result<Value, Stopped> {
    let tool: PathBuf = target().join("debug/truepath");
    let done = program(tool).current_dir(place).arg("--json").args(arguments).stdin(Stdio::null()).output();
    let fault = |said: String| Stopped { code: "no answer".to_owned(), said, line: None, fault: true };
    let Output { status, stdout, stderr } = done.map_err(|e| fault(e.to_string()))?;
    let said = String::from_utf8_lossy(&stderr);
    if status.success() {
        return serde_json::from_slice(&stdout).map_err(|e| fault(format!("no summary: {e}")));
    }
    let parsed = said.lines().filter_map(|line| serde_json::from_str::<Value>(line).ok());
    let error = parsed.filter_map(|mut line| line.get_mut("error").map(Value::take)).next();
    let Some(error) = error else { return Err(fault(said.trim().lines().last().unwrap_or_default().to_owned())) };
    let word = |key: &str| error[key].as_str().unwrap_or_default().to_owned();
    Err(Stopped {
        code: word("code"),
        said: [word("found"), word("expected"), word("help")]
            .into_iter()
            .filter(|w| !w.is_empty())
            .collect::<Vec<_>>()
            .join("; "),
        line: error["line"].as_u64().filter(|_| word("file").ends_with(name)),
        fault: status.code() != Some(1),
    })
}

/// The job of a machinist who knows cutter, wall side, allowance and the ball of his probe. The `whole` one also says control,
/// depth, a material of the table and a guess at the machine, and the keys that Truepath has to find out.
fn job(shop: &Program, name: &str, whole: bool) -> String {
    let Program { dialect, allowance_mm, diameter_mm, teeth, helix_deg, depth_mm, .. } = shop;
    let keys = |table: &str| -> String {
        let told =
            shop.keys.iter().filter(|key| whole || !key.starts_with('!')).map(|key| key.trim_start_matches('!').trim());
        let own = told
            .filter_map(|key| if table.is_empty() { Some(key) } else { key.strip_prefix(table)?.strip_prefix('.') });
        let plain = own.filter(|key| key.split_once('=').is_some_and(|(name, _)| !name.contains('.')));
        plain.map(|key| format!("{key}\n")).collect()
    };
    let wall = if shop.wall.is_empty() { String::new() } else { format!("wall = \"{}\"\n", shop.wall) };
    // A ball that has room beside the cutter's own slot.
    let ball = match *diameter_mm {
        ..4.0 => 1.0,
        ..8.0 => 2.0,
        _ if *depth_mm < 6.0 => 2.0,
        _ => 4.0,
    };
    let only = |text: String| if whole { text } else { String::new() };
    let control = only(format!("dialect = \"{dialect}\"\n"));
    let depth = only(format!("axial_depth_mm = {depth_mm}\n"));
    let prior = only(
        "[force]\nmaterial = \"al-6082-t6\"\n[machine]\nstiffness_x_n_per_mm = 2300\nstiffness_y_n_per_mm = 2300\n"
            .to_owned(),
    );
    let file = only("format = \"linuxcnc-log\"\nz_reference = \"centre\"\n".to_owned());
    format!(
        "version = 1\nprogram = \"{name}\"\n{control}{wall}{}\
         [stock]\nallowance_mm = {allowance_mm}\n{}\
         [tool]\ndiameter_mm = {diameter_mm}\nteeth = {teeth}\nhelix_deg = {helix_deg}\n{}\
         [cut]\n{depth}{}{prior}\
         [probe]\nball_diameter_mm = {ball}\n{file}",
        keys(""),
        keys("stock"),
        keys("tool"),
        keys("cut"),
    )
}

/// The same job for the contours on some lines.
fn with_lines(job: &str, walls: &[[u32; 2]]) -> String {
    let feature = |(at, [first, last]): (usize, &[u32; 2])| {
        format!("[[feature]]\nid = \"wall-{}\"\nlines = [{first}, {last}]\n", at + 1)
    };
    walls.iter().enumerate().map(feature).fold(job.to_owned(), |text, feature| text + &feature)
}
