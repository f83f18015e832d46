//! `multiaxis`: the chord error of a five-axis program, and the program in which no move exceeds a tolerance.

mod summary;

use std::io::{self, BufRead, BufReader, Write};
use std::path::{Path as FilePath, PathBuf};

use clap::Args;
use clap::builder::TypedValueParser;
use summary::{summary, words};
use truepath_core::gcode::{Dialect, PointlessLength, Units};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::files;
use truepath_ground::length::{self, Unit};
use truepath_ground::output::{OutputFile, OutputFolder, json};
use truepath_job::job::{DECIMALS, WORD_DIALECTS, one_of};
use truepath_multiaxis::ball::Contacts;
use truepath_multiaxis::codes::{A008, A009, A010, A011, A014};
use truepath_multiaxis::machine::{Coordinates, Kind, Letter};
use truepath_multiaxis::program::{
    At, CentrePoint, Digits, Outcome, PassError, Reading, Report, Settings, Sinks, Splitter, UnrollOptions, picture,
    run as pass, unroll,
};
use truepath_multiaxis::{Machine, Rule};

pub use summary::MultiaxisSummary;

use super::canon::UNITS;
use crate::terminal::Terminal;

/// Files of `--report`.
const FILES: &[&str] = &["moves.csv", "summary.json", "errors.svg"];

/// Bytes of a program with loops, calls or computed places, which is held in memory.
const LARGEST_STEERED: u64 = 64 << 20;

/// What is asked.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// The program: G-code with X, Y, Z and two of A, B, C.
    pub file: PathBuf,
    /// The machine file.
    #[arg(long, value_name = "M.toml")]
    pub machine: PathBuf,
    /// Largest chord error of a move, mm, or with its unit (0.0005in, 12um).
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, allow_negative_numbers = true)]
    pub tolerance: f64,
    /// The rewritten program; without it the errors are only told.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Folder for moves.csv, summary.json and errors.svg.
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Where locations are inserted.
    #[arg(long, value_enum, default_value_t = Rule::Fewest)]
    pub rule: Rule,
    /// Most pieces of one move.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    pub max_pieces: u32,
    /// What X, Y, Z are; by default what the machine file says.
    #[arg(long, value_enum)]
    pub xyz: Option<Coordinates>,
    /// What the control does under G43.4, G43.5, G234 or LinuxCNC's M428.
    #[arg(long, value_enum, default_value_t = CentrePoint::Full)]
    pub tcp: CentrePoint,
    /// Decimals of a millimetre and of a degree that the control takes (one more of an inch); by default 4 and 6.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(2..=8).map(Digits::at_most))]
    pub decimals: Option<Digits>,
    /// Write the program although some moves cannot be checked or divided; they are left as they are.
    #[arg(long)]
    pub partial: bool,
    /// Write a program with loops, calls or computed places out plainly, so that it can be rewritten.
    #[arg(long)]
    pub unroll: bool,
    /// The control the program is written for.
    #[arg(long, value_parser = one_of(&WORD_DIALECTS), default_value = "linuxcnc")]
    pub dialect: Dialect,
    /// What a length without a point is: millimetres and inches, or least increments (0.001 mm, 0.0001 in).
    #[arg(long, value_parser = one_of(&DECIMALS), default_value = "calculator")]
    pub decimal: PointlessLength,
    /// The unit until G20 or G21.
    #[arg(long, value_parser = one_of(&UNITS), default_value = "mm")]
    pub units: Units,
    /// Skip blocks that begin with `/`.
    #[arg(long)]
    pub skip_block_delete: bool,
    /// Normal of the surface that is cut, out of the part: tells where the ball end touches it.
    #[arg(long, value_name = "X,Y,Z", value_parser = normal, allow_hyphen_values = true)]
    pub normal: Option<[f64; 3]>,
    /// Replace existing files.
    #[arg(long)]
    pub force: bool,
}

/// Three numbers with commas between them.
fn normal(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text.split(',').map_while(|part| part.trim().parse().ok()).collect();
    match numbers[..] {
        [x, y, z] if numbers.iter().all(|n| n.is_finite()) && text.split(',').count() == 3 => Ok([x, y, z]),
        _ => Err("expected three numbers, for instance 0,0,1".to_owned()),
    }
}

/// Rewrites a program and prints its figures.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let bytes = files::length(&options.file).unwrap_or_default();
    let mut bar = terminal.progress("dividing", bytes);
    let summary = run(options, &mut |read| bar.reached(read))?;
    drop(bar);
    terminal.warn_all(&summary.warnings);
    terminal.tell(&summary, || words(&summary))
}

/// Measures a program and rewrites it. `progress` is told the bytes read.
///
/// # Errors
/// Whatever is wrong with machine file or program, moves that cannot be brought within the tolerance unless `partial`,
/// and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(u64)) -> Result<MultiaxisSummary, Failure> {
    check_tolerance(options.tolerance)?;
    let machine = Machine::from_toml(&Source::read(&options.machine)?)?;
    check_normal(options, &machine)?;
    let settings = settings(options, &machine);
    let file = files::open(&options.file).map_err(|e| InputError::unreadable(&options.file, &e))?;
    if files::is_dir(&options.file) {
        let error = io::Error::new(io::ErrorKind::IsADirectory, "is a directory");
        return Err(InputError::unreadable(&options.file, &error).into());
    }
    let name = options.file.display().to_string();
    let input = BufReader::with_capacity(1 << 16, file);
    match attempt(options, &settings, input, &name, None, true, progress)? {
        Attempt::Done(found) => finish(options, &machine, &settings, found, None),
        Attempt::Steered(line) => steered(options, &machine, &settings, line, progress),
    }
}

/// A pass that came to its end, and what it wrote.
struct Found {
    report: Report,
    out: Option<OutputFile>,
    folder: Option<OutputFolder>,
}

enum Attempt {
    Done(Box<Found>),
    Steered(u32),
}

/// One pass; the text goes to the output when `writes`.
fn attempt(
    options: &Options,
    settings: &Settings<'_>,
    input: impl BufRead,
    name: &str,
    origin: Option<&[u32]>,
    writes: bool,
    progress: &mut dyn FnMut(u64),
) -> Result<Attempt, Failure> {
    let mut out = options.output.as_ref().map(|path| OutputFile::create(path, options.force)).transpose()?;
    let folder = options.report.as_ref().map(|path| OutputFolder::create(path, options.force, FILES)).transpose()?;
    let mut table = folder.as_ref().map(|f| f.stream("moves.csv")).transpose()?.map(csv::Writer::from_writer);
    let mut nowhere = io::sink();
    let sinks = Sinks {
        text: out.as_mut().filter(|_| writes).map_or(&mut nowhere as &mut dyn Write, |file| file),
        row: &mut |row| match &mut table {
            Some(table) => table.serialize(row).map_err(|e| unwritable(options.report.as_deref(), e.into())),
            None => Ok(()),
        },
        progress,
    };
    let report = match pass(input, name, settings, origin, sinks) {
        Ok(Outcome::Done(report)) => *report,
        Ok(Outcome::Steered(line)) => return Ok(Attempt::Steered(line)),
        Err(PassError::Input(error)) => return Err(error.into()),
        Err(PassError::Read(error)) => return Err(InputError::unreadable(&options.file, &error).into()),
        Err(PassError::Write(error)) => return Err(unwritable(options.output.as_deref(), error).into()),
    };
    if let Some(mut table) = table {
        table.flush().map_err(|e| unwritable(options.report.as_deref(), e))?;
    }
    Ok(Attempt::Done(Box::new(Found { report, out, folder })))
}

/// A program that line `line` steers: it is executed and written out, and measured as it runs.
fn steered(
    options: &Options,
    machine: &Machine,
    settings: &Settings<'_>,
    line: u32,
    progress: &mut dyn FnMut(u64),
) -> Result<MultiaxisSummary, Failure> {
    let bytes = files::length(&options.file).unwrap_or_default();
    if bytes > LARGEST_STEERED {
        let found = format!("line {line} steers the program or computes a place, and the file has {bytes} bytes");
        let expected = format!("at most {LARGEST_STEERED} bytes of such a program");
        let help = "divide the program into plain files, which may be of any size";
        return Err(InputError::new(A011, found, expected, help).in_file(&options.file).into());
    }
    let source = Source::read(&options.file)?;
    let plain = unroll(
        &source,
        UnrollOptions {
            dialect: options.dialect,
            decimal: options.decimal,
            units: options.units,
            skip_block_delete: options.skip_block_delete,
        },
    )?;
    let name = format!("{} (written out)", options.file.display());
    let found =
        attempt(options, settings, plain.text.as_slice(), &name, Some(&plain.origin), options.unroll, progress)?;
    let Attempt::Done(mut found) = found else {
        return Err(Failure::Internal("a program written out is not plain".to_owned()));
    };
    if options.unroll {
        return finish(options, machine, settings, found, Some(line));
    }
    // Its own text can only stay as it is.
    if let (Some(worst), Some(_), false) = (found.report.worst, &found.out, options.partial) {
        let unit = Unit::from(found.report.units);
        let found = format!(
            "the move leaves its chord by {:.4} {}, and line {line} steers the program or computes a place",
            unit.of(worst.1),
            unit.name()
        );
        let help = "add --unroll to have the program written out plainly, or --partial to leave it as it is";
        let expected = "a program whose lines can be rewritten in place";
        return Err(At::error_in(&options.file, worst.0, A011, [&found, expected, help]).into());
    }
    if let Some(out) = &mut found.out {
        out.write_all(source.bytes()).map_err(|e| unwritable(options.output.as_deref(), e))?;
    }
    found.report.stays();
    finish(options, machine, settings, found, Some(line))
}

/// Judges what was found and puts the outputs in their place.
fn finish(
    options: &Options,
    machine: &Machine,
    settings: &Settings<'_>,
    found: Box<Found>,
    steered: Option<u32>,
) -> Result<MultiaxisSummary, Failure> {
    let Found { report, out, folder } = *found;
    if report.blocks == 0 {
        let found = format!("{} has no block", options.file.display());
        return Err(A008.error(found, "a program").in_file(&options.file).into());
    }
    if let (Some(first), Some(_), false) = (report.left.moves.first(), &out, options.partial) {
        let many = report.left.count;
        let found = format!("the move cannot be brought within the tolerance: {}", first.reason);
        let expected = format!("five-axis moves that can all be checked and divided ({many} cannot)");
        return Err(At::error_in(&options.file, first.line, A009, [&found, &expected, A009.remedy]).into());
    }
    let mut summary = summary(&options.file, machine, settings, &report);
    if let Some(line) = steered {
        let name = options.file.display();
        let done = match (options.unroll, report.worst) {
            (true, _) => "it is written out plainly",
            (false, None) => "it is within the tolerance and stays as it is",
            (false, Some(_)) => "it stays as it is, and does not keep the tolerance",
        };
        let what = "loops, calls or computed places: it was executed, and measured as it runs";
        summary.warnings.insert(0, format!("{name}:{line}: {what}; {done}"));
    }
    if let Some(folder) = folder {
        folder.write("summary.json", &json(&summary)?)?;
        folder.write("errors.svg", &picture(&report.profile, options.tolerance, summary.unit)?)?;
        folder.commit()?;
    }
    if let Some(out) = out {
        out.commit()?;
    }
    Ok(summary)
}

fn check_tolerance(tolerance_mm: f64) -> Result<(), InputError> {
    if tolerance_mm > 0.0 && tolerance_mm <= 1000.0 {
        return Ok(());
    }
    let found = format!("the tolerance is {tolerance_mm} mm");
    Err(A010.error(found, format!("a length above 0, {}", length::between(0.0, 1000.0))))
}

/// A surface is of use to a ball end only.
fn check_normal(options: &Options, machine: &Machine) -> Result<(), InputError> {
    let Some(normal) = options.normal else { return Ok(()) };
    if Contacts::new(machine, normal).is_some() {
        return Ok(());
    }
    let (found, expected, help) = if machine.tool().ball_radius_mm.is_none() {
        (
            "a surface is named, but the machine file has no ball end",
            "[tool] ball_radius_mm",
            "add it, or leave out --normal",
        )
    } else {
        ("the normal has no direction", "three numbers that are not all zero", "give --normal 0,0,1 for a floor")
    };
    Err(InputError::new(A014, found, expected, help).in_file(&options.machine))
}

fn settings<'m>(options: &Options, machine: &'m Machine) -> Settings<'m> {
    let has = |letter| machine.place_of(letter).is_some();
    Settings {
        reading: Reading {
            dialect: options.dialect,
            decimal: options.decimal,
            rotary: [Letter::A, Letter::B, Letter::C].map(has),
            one_tool: machine.kind() != Kind::TableTable,
            skip_block_delete: options.skip_block_delete,
        },
        units: options.units,
        coordinates: options.xyz.unwrap_or(machine.coordinates()),
        centre_point: options.tcp,
        splitter: Splitter {
            machine,
            tolerance: options.tolerance,
            rule: options.rule,
            max_pieces: options.max_pieces as usize,
            digits: options.decimals.unwrap_or_default(),
        },
        normal: options.normal,
    }
}

fn unwritable(path: Option<&FilePath>, error: io::Error) -> InputError {
    InputError::unwritable(path.unwrap_or(FilePath::new("the output")), &error)
}
