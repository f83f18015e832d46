//! `plot`: pictures of what the other commands wrote.
//!
//! | code | meaning |
//! |---|---|
//! | Z011 | an output that ends neither in .svg nor in .png; `--scale` for an SVG |
//! | Z012 | a folder without the table, a table without its wall.csv and without a job |
//! | Z013 | too many tables, too many laws, tables that do not go together, or a table of another job |
//! | Z014 | a summary.json that is not one of `compare` |
//!
//! Others: [`View`], [`png`], `report::sheet`.

mod wall;

use std::io::Write;
use std::path::{Path as FilePath, PathBuf};

use clap::{Args, Subcommand};
use truepath_chart::raster::png;
use truepath_chart::view::View;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::files;
use truepath_ground::length::{Typed, Unit};
use truepath_ground::output::OutputFile;
use truepath_ground::sheet::{names as names_of, read_bounded};
use truepath_job::job::Which;
use truepath_report::codes::{Z011, Z012, Z013, Z014};
use truepath_report::plot::{Column, Compared, LawWall, PASSES, Place, Probed, Wall};
use truepath_report::{Trace, plot, read_correction, read_points, read_trace, read_walls};
use wall::OfJob;

use crate::terminal::Terminal;

/// Most laws of a comparison.
const LAWS: usize = 12;
/// Pixels of a PNG picture to one of the view, when nothing is said.
const SCALE: f64 = 2.0;

/// What is drawn.
#[derive(Clone, Debug, Args)]
pub struct Options {
    #[command(subcommand)]
    kind: Kind,
}

/// The kinds of pictures. Every path is a table or the folder it lies in.
#[derive(Clone, Debug, Subcommand)]
enum Kind {
    /// Engagement, force, deflection and error along the contour; several passes over each other.
    Trace {
        /// trace.csv of simulate, or the folder it lies in; up to seven.
        #[arg(required = true)]
        tables: Vec<PathBuf>,
        /// Name of a pass in the legend, in the order of the tables; otherwise that of its folder.
        #[arg(long = "name")]
        names: Vec<String>,
        /// What is drawn, from top to bottom.
        #[arg(long, value_enum, value_delimiter = ',', default_values = ["arc", "force", "deflection", "error"])]
        columns: Vec<Column>,
        #[command(flatten)]
        picture: Picture,
    },
    /// What a correction adds to the path, and the wall error predicted without and with it.
    Correction {
        /// correction.csv of correct or learn, or the folder it lies in.
        table: PathBuf,
        #[command(flatten)]
        picture: Picture,
    },
    /// The wall to scale with its error magnified, and the probed places.
    Error {
        /// correction.csv or trace.csv, or the folder; several traces are drawn over each other.
        #[arg(required = true)]
        tables: Vec<PathBuf>,
        /// Name of a pass in the legend, in the order of the tables; otherwise that of its folder.
        #[arg(long = "name")]
        names: Vec<String>,
        /// Probed places; otherwise points.csv beside the first table, if there is one.
        #[arg(long, value_name = "points.csv")]
        points: Option<PathBuf>,
        /// How many times larger than the wall its error is drawn; otherwise the largest is a tenth of the part.
        #[arg(long, value_name = "TIMES", allow_negative_numbers = true)]
        magnify: Option<f64>,
        /// The job of the tables; without it the nominal wall is that of the wall.csv beside each of them.
        #[arg(long, value_name = "JOB.toml")]
        job: Option<PathBuf>,
        #[command(flatten)]
        which: Which,
        #[command(flatten)]
        picture: Picture,
    },
    /// What every law of correction leaves on the same machine.
    Compare {
        /// The folder compare wrote.
        folder: PathBuf,
        #[command(flatten)]
        picture: Picture,
    },
}

/// How it is drawn.
#[derive(Clone, Debug, Args)]
struct Picture {
    /// The picture: .svg or .png.
    #[arg(short, long, value_name = "FILE")]
    output: PathBuf,
    /// Draw in inches; --from and --to are then in inches, too, where they have no unit.
    #[arg(long)]
    inch: bool,
    /// First place shown along the contour, mm, or with its unit (1.5in).
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    from: Option<Typed>,
    /// Last place shown along the contour, mm, or with its unit (1.5in).
    #[arg(long, value_name = "LENGTH", allow_negative_numbers = true)]
    to: Option<Typed>,
    /// Width, 1/96 inch on paper.
    #[arg(long, value_name = "PX")]
    width: Option<u32>,
    /// Height.
    #[arg(long, value_name = "PX")]
    height: Option<u32>,
    /// Pixels of a PNG to one of width and height: 3.125 prints with 300 dpi. [default: 2]
    #[arg(long, value_name = "TIMES", allow_negative_numbers = true)]
    scale: Option<f64>,
    /// The line above the picture; "" for none.
    #[arg(long)]
    title: Option<String>,
    /// Replace an existing picture.
    #[arg(long)]
    force: bool,
}

impl Picture {
    fn view(&self, magnify: Option<f64>) -> View {
        let Self { from, to, width, height, .. } = *self;
        let unit = if self.inch { Unit::Inch } else { Unit::Millimetre };
        let mm = |at: Typed| if at.unit.is_none() { unit.in_mm(at.mm) } else { at.mm };
        let [from_mm, to_mm] = [from, to].map(|at| at.map(mm));
        View { title: self.title.clone(), width, height, from_mm, to_mm, magnify, unit }
    }
}

/// Draws, and prints where the picture lies.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let summary = run(&options.kind)?;
    terminal.warn_all(&summary.warnings);
    terminal.tell(&summary, || format!("written to {}\n", summary.output.display()))
}

/// What was written.
#[derive(Clone, Debug, serde::Serialize)]
pub struct PlotSummary {
    /// Version of this object.
    pub version: u32,
    /// The picture.
    pub output: PathBuf,
    /// `svg` or `png`.
    pub format: &'static str,
    /// Its size.
    pub bytes: usize,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Draws a picture of tables.
///
/// # Errors
/// The codes of this module and those it names; an output that exists or cannot be written.
fn run(kind: &Kind) -> Result<PlotSummary, Failure> {
    let (Kind::Trace { picture, .. }
    | Kind::Correction { picture, .. }
    | Kind::Error { picture, .. }
    | Kind::Compare { picture, .. }) = kind;
    if let Kind::Error { job: None, which, .. } = kind
        && *which != Which::default()
    {
        let help = "give --job, the job of the tables, or leave --feature and --pass out";
        return Err(InputError::new(Z012, "--feature and --pass without --job", "a job", help).into());
    }
    let format = format(&picture.output)?;
    if format == "svg" && picture.scale.is_some() {
        let help = "an SVG picture is sharp at any size: leave --scale out, or name a .png";
        return Err(InputError::new(Z011, "--scale was given for an SVG picture", "a .png", help).into());
    }
    let mut file = OutputFile::create(&picture.output, picture.force)?;
    let svg = drawn(kind)?;
    let mut warnings = Vec::new();
    let bytes = match format {
        "svg" => svg,
        _ => {
            warnings.extend(truepath_chart::letters::unknown_letters(&svg));
            png(&svg, picture.scale.unwrap_or(SCALE))?
        }
    };
    file.write_all(&bytes).map_err(|e| InputError::unwritable(&picture.output, &e))?;
    file.commit()?;
    Ok(PlotSummary { version: 1, output: picture.output.clone(), format, bytes: bytes.len(), warnings })
}

fn format(output: &FilePath) -> Result<&'static str, InputError> {
    let extension = output.extension().unwrap_or_default().to_ascii_lowercase();
    match extension.to_str() {
        Some("svg") => Ok("svg"),
        Some("png") => Ok("png"),
        _ => {
            let found = format!("{} is neither .svg nor .png", output.display());
            let help = "the ending of the output says what kind of picture is written";
            Err(InputError::new(Z011, found, "a name that ends in .svg or .png", help).in_file(output))
        }
    }
}

fn drawn(kind: &Kind) -> Result<Vec<u8>, Failure> {
    match kind {
        Kind::Trace { tables, names, columns, picture } => {
            let traces = traces(tables, names, |_, source| Ok(read_trace(source, None)?))?;
            let passes: Vec<_> = traces.iter().map(|(name, trace)| (name.as_str(), trace.as_slice())).collect();
            plot::trace(&picture.view(None), &passes, columns)
        }
        Kind::Correction { table, picture } => {
            let source = read_bounded(&table_in(table, &["correction.csv"])?)?;
            plot::correction(&picture.view(None), &read_correction(&source, None)?)
        }
        Kind::Error { tables, names, points, magnify, job, which, picture } => {
            let job = job.as_deref().map(|job| OfJob { job, which });
            error(&picture.view(*magnify), (tables, names), points.as_deref(), job.as_ref())
        }
        Kind::Compare { folder, picture } => plot::compare(&picture.view(None), &compared(folder)?),
    }
}

/// The passes of several tables with their names.
fn traces(
    tables: &[PathBuf],
    names: &[String],
    read: impl Fn(&FilePath, &Source) -> Result<Trace, Failure>,
) -> Result<Vec<(String, Trace)>, Failure> {
    if tables.len() > PASSES || names.len() > tables.len() {
        let found = format!("there are {} tables and {} names", tables.len(), names.len());
        let help = "one name a table, in their order";
        return Err(InputError::new(Z013, found, format!("at most {PASSES} tables"), help).into());
    }
    let each = tables.iter().enumerate().map(|(k, table)| {
        let file = table_in(table, &["trace.csv"])?;
        let name = names.get(k).cloned().unwrap_or_else(|| named_after(&file));
        Ok((name, read(&file, &read_bounded(&file)?)?))
    });
    each.collect()
}

/// The folder a table lies in, or the table itself where that has no name.
fn named_after(table: &FilePath) -> String {
    let folder = table.parent().and_then(FilePath::file_name);
    folder.unwrap_or(table.as_os_str()).to_string_lossy().into_owned()
}

/// A table, or the first of these that lies in a folder.
fn table_in(path: &FilePath, wanted: &[&str]) -> Result<PathBuf, InputError> {
    if !files::is_dir(path) {
        return Ok(path.to_owned());
    }
    let there = wanted.iter().map(|name| path.join(name)).find(|file| files::is_file(file));
    there.ok_or_else(|| {
        let found = format!("{} holds no {}", path.display(), wanted.join(" and no "));
        let help = "simulate writes trace.csv, correct and learn write correction.csv, compare writes walls.csv";
        InputError::new(Z012, found, "a folder of the command that writes it", help).in_file(path)
    })
}

fn error(
    view: &View,
    (tables, names): (&[PathBuf], &[String]),
    points: Option<&FilePath>,
    job: Option<&OfJob>,
) -> Result<Vec<u8>, Failure> {
    let files = tables.iter().map(|t| table_in(t, &["correction.csv", "trace.csv"])).collect::<Result<Vec<_>, _>>()?;
    let beside = files.first().map(|f| f.with_file_name("points.csv")).filter(|f| files::is_file(f));
    let probed = match points.map(FilePath::to_owned).or(beside) {
        Some(file) => probed(&read_bounded(&file)?)?,
        None => Vec::new(),
    };
    if let [file] = files.as_slice() {
        let source = read_bounded(file)?;
        if names_of(&source).iter().any(|name| name == "predicted_error_before_mm") {
            let wall = wall::wall(file, &source, job)?;
            return plot::predicted_error(view, &read_correction(&source, Some(&wall))?, &probed);
        }
    }
    let read = |file: &FilePath, source: &Source| Ok(read_trace(source, Some(&wall::wall(file, source, job)?))?);
    let passes = traces(&files, names, read)?;
    let alone = passes.len() == 1;
    let walls: Vec<Wall> = passes
        .iter()
        .zip(truepath_chart::style::INKS)
        .map(|((name, trace), ink)| Wall::of_trace(&**name, if alone { ink.colour.into() } else { ink }, trace))
        .collect();
    plot::error(view, "The wall", &walls, None, &probed)
}

fn probed(source: &Source) -> Result<Vec<Probed>, InputError> {
    let rows = read_points(source)?;
    let probed = rows.iter().map(|r| {
        let nominal = [r.contact[0] + r.normal[0] * r.error_mm, r.contact[1] + r.normal[1] * r.error_mm];
        let free = [-r.normal[0], -r.normal[1]];
        Probed { place: Place { s_mm: r.s_mm, wall: nominal, free, error_mm: r.error_mm }, outlying: r.outlying }
    });
    Ok(probed.collect())
}

/// What of the summary of `compare` a picture needs.
#[derive(serde::Deserialize)]
struct Summary {
    machine: String,
    trim_mm: f64,
    laws: Vec<Law>,
}

#[derive(serde::Deserialize)]
struct Law {
    law: String,
    title: String,
    max_error_mm: Option<f64>,
}

fn compared(path: &FilePath) -> Result<Compared, InputError> {
    let file = table_in(path, &["walls.csv"])?;
    let walls = read_walls(&read_bounded(&file)?)?;
    let source = read_bounded(&file.with_file_name("summary.json"))?;
    let summary: Summary = serde_json::from_slice(source.bytes()).map_err(|e| {
        let (line, column) = (u32::try_from(e.line()).unwrap_or(1), u32::try_from(e.column()).unwrap_or(1));
        Z014.error(e.to_string(), "the summary of compare").at(&source, source.span_at(line, column, 0))
    })?;
    if walls.len() > LAWS {
        let found = format!("{} holds {} laws", file.display(), walls.len());
        let help = "the lines of a law stand together in the table";
        return Err(InputError::new(Z013, found, format!("at most {LAWS}"), help).in_file(&file));
    }
    let law = |(law, places): (String, Vec<[f64; 4]>)| {
        let row = summary.laws.iter().find(|row| row.law == law);
        LawWall {
            title: row.map_or_else(|| law.clone(), |row| row.title.clone()),
            max_error_mm: row.and_then(|row| row.max_error_mm),
            places,
            law,
        }
    };
    Ok(Compared {
        on_plant: summary.machine == "plant",
        trim_mm: summary.trim_mm,
        laws: walls.into_iter().map(law).collect(),
    })
}
