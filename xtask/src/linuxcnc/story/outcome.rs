//! What the story came to: a table, pictures of the walls, and whether each wall is ten times better.

use std::fmt::Write;
use std::path::Path;

use serde_json::Value;

use crate::repository::{program, read, root};
use crate::step::Failure;
use crate::table::replace;

/// Times by which the largest error of a wall has to be smaller.
const LEAST_FACTOR: f64 = 10.0;
const DOCUMENT: &str = "docs/linuxcnc.md";

/// A wall, along the commanded path and along the measured one.
#[derive(Clone, Copy, Debug)]
pub struct Told {
    /// Largest error away from the ends, mm: commanded, measured.
    pub largest_mm: [f64; 2],
    /// Its root mean square, mm.
    pub rms_mm: [f64; 2],
    /// Largest distance of the commanded path from the program's, mm.
    pub off_mm: f64,
    /// Least feed along it, as a share of the program's.
    pub least_feed: f64,
}

impl Told {
    /// From what `truepath simulate --json` said of both.
    pub fn of(said: &[Value]) -> Option<Self> {
        let number = |path: usize, place: &str| said.get(path)?.pointer(place)?.as_f64();
        let both = |place: &str| Some([number(0, place)?, number(1, place)?]);
        Some(Self {
            largest_mm: both("/judged/max_error_mm")?,
            rms_mm: both("/judged/rms_error_mm")?,
            off_mm: number(0, "/recorded/farthest_mm")?,
            least_feed: number(0, "/recorded/least_feed")?,
        })
    }
}

/// A part before and after.
pub struct Part<'a> {
    pub name: &'a str,
    pub before: Told,
    pub after: Told,
    /// Periods with a correction that is the replay's to the last nanometre.
    pub replayed: usize,
}

impl Part<'_> {
    fn factor(&self, path: usize) -> f64 {
        self.before.largest_mm[path] / self.after.largest_mm[path]
    }
}

/// Prints the table, draws the walls, judges.
///
/// # Errors
/// A picture or the document cannot be written; a wall is not ten times better.
pub fn tell(truepath: &Path, parts: &[Part], folder: &Path, write: bool) -> Result<(), Failure> {
    let table = table(parts);
    println!("\n{table}");
    for part in parts {
        let picture = match write {
            true => root().join(format!("docs/linuxcnc-{}.svg", part.name)),
            false => folder.join(format!("{}.svg", part.name)),
        };
        let mut command = program(truepath);
        command.args(["plot", "error"]);
        for when in ["before", "after"] {
            command.arg(folder.join(format!("{}-{when}-measured", part.name)));
        }
        command.args(["--name", "uncorrected", "--name", "corrected", "--force", "-o"]).arg(&picture);
        read(&mut command)?;
    }
    if write {
        replace(&root().join(DOCUMENT), "walls", &table)?;
    }
    let mut worse = Vec::new();
    for part in parts {
        for (path, kind) in ["commanded", "measured"].iter().enumerate() {
            let factor = part.factor(path);
            if factor.is_nan() || factor < LEAST_FACTOR {
                worse.push(format!("{} along the {kind} path: only {factor:.1} times", part.name));
            }
        }
        if part.replayed == 0 {
            worse.push(format!("{}: nothing was corrected", part.name));
        }
    }
    if worse.is_empty() { Ok(()) } else { Err(Failure::found(worse.join("; "))) }
}

fn table(parts: &[Part]) -> String {
    let mut text = String::from(
        "| part | largest wall error, uncorrected mm | corrected mm | rms mm | rms corrected mm \
         | path off the program's mm | least feed |\n|---|---:|---:|---:|---:|---:|---:|\n",
    );
    for part in parts {
        let (before, after) = (part.before, part.after);
        let [first, second] = [0, 1].map(|path| {
            let kind = ["commanded path", "measured path"][path];
            let off = if path == 0 { format!("{:.4}", before.off_mm) } else { String::new() };
            let least = if path == 0 { format!("{:.0} %", 100.0 * before.least_feed) } else { String::new() };
            format!(
                "| {}, {kind} | {:.4} | {:.4} | {:.4} | {:.4} | {off} | {least} |",
                part.name, before.largest_mm[path], after.largest_mm[path], before.rms_mm[path], after.rms_mm[path],
            )
        });
        let _ = writeln!(text, "{first}\n{second}");
    }
    text
}
