//! The nominal wall beside the rows of a table: from the `wall.csv` that lies there, or from the job whose path it is.
//!
//! A table from elsewhere, or one whose `wall.csv` was lost, holds arc length and centre of the cutter; the normal at that arc
//! length, from the path of the job, gives the wall. Where two samples of the path have one arc length (a sharp corner),
//! rows and samples are taken in their order.

use std::path::Path as FilePath;

use truepath_core::cut::Sample;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::files;
use truepath_ground::sheet::{each_line, read_bounded};
use truepath_ground::units::{float, mm};
use truepath_job::job::{JobFile, Which};
use truepath_job::pass::{Pass, PathBuffer};
use truepath_report::codes::{Z012, Z013};
use truepath_report::{WallRow, read_wall};

/// Arc lengths are told apart to half of the last digit of a table, mm.
const SAME: f64 = 1e-6;
/// How far the centre of a row may lie from the path of the job, mm: much less than two jobs differ in.
const NEAR: f64 = 0.05;

/// Where the nominal wall comes from.
#[derive(Clone, Debug)]
pub struct OfJob<'a> {
    /// The job.
    pub job: &'a FilePath,
    /// Which cut of its program.
    pub which: &'a Which,
}

/// The nominal wall of a table: of the job, where there is one, otherwise from the `wall.csv` beside it.
pub(super) fn wall(table: &FilePath, source: &Source, job: Option<&OfJob>) -> Result<Vec<WallRow>, Failure> {
    match job {
        Some(of) => of_job(table, source, of),
        None => Ok(beside(table)?),
    }
}

fn beside(table: &FilePath) -> Result<Vec<WallRow>, InputError> {
    let file = table.with_file_name("wall.csv");
    if !files::is_file(&file) {
        let found = format!("there is no wall.csv beside {}", table.display());
        let help = "the wall to scale needs the wall.csv that simulate, correct and learn write beside their table: name \
                    their folder, or give --job, the job of the table";
        return Err(InputError::new(Z012, found, "a folder with both tables, or --job", help).in_file(&file));
    }
    read_wall(&read_bounded(&file)?)
}

fn of_job(table: &FilePath, source: &Source, of: &OfJob) -> Result<Vec<WallRow>, Failure> {
    let mut job = JobFile::read(of.job)?;
    job.which = of.which.clone();
    let pass = Pass::read(job)?;
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    let radius = mm(path.setup().radius);
    let (samples, mut next) = (path.samples(), 0);
    let mut rows: Vec<WallRow> = Vec::new();
    let mut strange = None;
    each_line(source, &["s_mm", "x_mm", "y_mm"], |line| {
        let s = line.along(0, rows.last().map(|r| r.s_mm))?;
        let centre = [line.number(1)?, line.number(2)?];
        let at = along(samples, &mut next, s);
        let apart = at.map_or(f64::INFINITY, |at| (at.centre[0] - centre[0]).hypot(at.centre[1] - centre[1]));
        if apart > NEAR || apart.is_nan() {
            strange.get_or_insert((s, centre, at));
        }
        let [nx, ny] = at.map_or([f64::NAN; 2], |at| at.normal);
        rows.push(WallRow { s_mm: s, x_mm: centre[0] + nx * radius, y_mm: centre[1] + ny * radius, nx, ny });
        Ok(())
    })?;
    let Some((s, [x, y], at)) = strange else { return Ok(rows) };
    let there = at.map_or_else(
        || "has no such place".to_owned(),
        |at| format!("is at X {:.3} Y {:.3} there", at.centre[0], at.centre[1]),
    );
    let found = format!("at s = {s} mm the table has X {x:.3} Y {y:.3}, and the path of {} {there}", of.job.display());
    let help = "give the job the table was made from, with --feature and --pass where its program has several cuts";
    Err(InputError::new(Z013, found, "a table of this job", help).in_file(table).into())
}

/// A place of a path.
#[derive(Clone, Copy)]
struct Place {
    centre: [f64; 2],
    normal: [f64; 2],
}

impl Place {
    fn of(sample: &Sample) -> Self {
        let point = sample.point;
        Self {
            centre: [point.x.nm() as f64 / 1e6, point.y.nm() as f64 / 1e6],
            normal: [float(sample.normal.x), float(sample.normal.y)],
        }
    }

    fn between(a: &Self, b: &Self, share: f64) -> Self {
        let mixed = |a: [f64; 2], b: [f64; 2]| [0, 1].map(|k: usize| a[k] + (b[k] - a[k]) * share);
        let normal = mixed(a.normal, b.normal);
        let length = normal[0].hypot(normal[1]);
        Self { centre: mixed(a.centre, b.centre), normal: normal.map(|v| v / length) }
    }
}

/// The place of an arc length; `next` is the first sample that no row has taken yet.
fn along(samples: &[Sample], next: &mut usize, s: f64) -> Option<Place> {
    let rest = samples.get(*next..)?;
    *next += rest.iter().take_while(|sample| mm(sample.s) < s - SAME).count();
    let after = samples.get(*next)?;
    if mm(after.s) <= s + SAME {
        *next += 1;
        return Some(Place::of(after));
    }
    let before = samples.get(next.checked_sub(1)?)?;
    let (from, to) = (mm(before.s), mm(after.s));
    Some(Place::between(&Place::of(before), &Place::of(after), (s - from) / (to - from)))
}
