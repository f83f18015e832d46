//! `multiaxis`: the chord error of a five-axis program, and the program in which no move exceeds a tolerance.

use std::fs::File;
use std::io::{self, BufReader, Write};
use std::path::Path as FilePath;

use truepath_core::gcode::{Dialect, PointlessLength, Units};

use crate::diagnostics::{Failure, InputError, Source};
use crate::multiaxis::machine::{Coordinates, Kind, Letter};
use crate::multiaxis::program::{
    CentrePoint, Digits, Left, Outcome, PassError, Places, Reading, Report, Settings, Sinks, Splitter, picture,
    run as pass,
};
use crate::multiaxis::statistics::Figures;
use crate::multiaxis::{Machine, Rule};
use crate::output::{OutputFile, OutputFolder};
use crate::report::json;

/// Files of `--report`.
const FILES: &[&str] = &["moves.csv", "summary.json", "errors.svg"];

/// What is asked.
#[derive(Clone, Debug)]
pub struct Options<'a> {
    /// The program.
    pub program: &'a FilePath,
    /// The machine file.
    pub machine: &'a FilePath,
    /// Largest chord error, mm.
    pub tolerance_mm: f64,
    /// Where locations are inserted.
    pub rule: Rule,
    /// Most pieces of a move.
    pub max_pieces: usize,
    /// The rewritten program, if it is wanted.
    pub out: Option<&'a FilePath>,
    /// Folder for table, summary and picture.
    pub report: Option<&'a FilePath>,
    /// Replace existing files.
    pub force: bool,
    /// Write the program although some moves cannot be checked or divided.
    pub partial: bool,
    /// What XYZ are, when the machine file does not say it.
    pub coordinates: Option<Coordinates>,
    /// What the control does under tool centre point codes.
    pub centre_point: CentrePoint,
    /// Decimals the control takes.
    pub digits: Digits,
    /// The control.
    pub dialect: Dialect,
    /// What a length without a point is.
    pub decimal: PointlessLength,
    /// The unit until G20 or G21.
    pub units: Units,
    /// Blocks with `/` are left out.
    pub skip_block_delete: bool,
}

/// What was found and done.
#[derive(Clone, Debug, serde::Serialize)]
pub struct MultiaxisSummary {
    /// Version of this summary.
    pub version: u32,
    /// `table-table A C`.
    pub machine: String,
    /// What XYZ are: `joints` or `tip`; those of `tip_moves` moves are the tip's in any case.
    pub coordinates: &'static str,
    /// Moves whose XYZ are places of the tool tip.
    pub tip_moves: u64,
    /// Largest chord error allowed, mm.
    pub tolerance_mm: f64,
    /// Lines read.
    pub lines: u64,
    /// Five-axis moves whose error was computed.
    pub moves: u64,
    /// G1 moves of X, Y, Z alone.
    pub straight_moves: u64,
    /// G1 moves of rotary axes alone.
    pub rotary_moves: u64,
    /// Five-axis moves under full tool centre point control.
    pub full_interpolation_moves: u64,
    /// Moves that were divided.
    pub moves_rewritten: u64,
    /// Locations inserted.
    pub points_inserted: u64,
    /// Chord errors of the moves read.
    pub before: Figures,
    /// Chord errors of the moves written.
    pub after: Figures,
    /// Moves near a pole of the machine, and their lines.
    pub singular: Places,
    /// Moves whose tool axis leaves the great circle by more than `orientation_tolerance_deg`, and cannot follow it.
    pub orientation: Places,
    /// Moves that stay although they may err too much, and why.
    pub left: Left,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Measures a program and rewrites it. `progress` is told the bytes read.
///
/// # Errors
/// Whatever is wrong with machine file or program, moves that cannot be brought within the tolerance unless `partial`,
/// and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(u64)) -> Result<MultiaxisSummary, Failure> {
    check_tolerance(options.tolerance_mm)?;
    let machine = Machine::from_toml(&Source::read(options.machine)?)?;
    let settings = settings(options, &machine);
    let file = File::open(options.program).map_err(|e| InputError::unreadable(options.program, &e))?;
    if options.program.is_dir() {
        let error = io::Error::new(io::ErrorKind::IsADirectory, "is a directory");
        return Err(InputError::unreadable(options.program, &error).into());
    }
    let mut out = options.out.map(|path| OutputFile::create(path, options.force)).transpose()?;
    let folder = options.report.map(|path| OutputFolder::create(path, options.force, FILES)).transpose()?;
    let mut table = folder.as_ref().map(|f| f.stream("moves.csv")).transpose()?.map(csv::Writer::from_writer);
    let mut nowhere = io::sink();
    let name = options.program.display().to_string();
    let sinks = Sinks {
        text: out.as_mut().map_or(&mut nowhere as &mut dyn Write, |file| file),
        row: &mut |row| match &mut table {
            Some(table) => table.serialize(row).map_err(|e| unwritable(options.report, e.into())),
            None => Ok(()),
        },
        progress,
    };
    let outcome = pass(BufReader::with_capacity(1 << 16, file), &name, &settings, None, sinks);
    let report = match outcome {
        Ok(Outcome::Done(report)) => report,
        Ok(Outcome::Steered(line)) => return Err(steered(options, line).into()),
        Err(PassError::Input(error)) => return Err(error.into()),
        Err(PassError::Read(error)) => return Err(InputError::unreadable(options.program, &error).into()),
        Err(PassError::Write(error)) => return Err(unwritable(options.out, error).into()),
    };
    if report.blocks == 0 {
        let found = format!("{name} has no block");
        let help = "check that this is a program of G1 moves";
        return Err(InputError::new("A008", found, "a program", help).in_file(options.program).into());
    }
    if let (Some(first), Some(_), false) = (report.left.moves.first(), &out, options.partial) {
        let many = report.left.count;
        let found = format!("line {}: the move cannot be brought within the tolerance: {}", first.line, first.reason);
        let expected = format!("five-axis moves that can all be checked and divided ({many} cannot)");
        let help = "correct it, or add --partial to leave such moves as they are";
        return Err(InputError::new("A009", found, expected, help).in_file(options.program).into());
    }
    let summary = summary(options, &machine, &settings, &report);
    if let Some(mut table) = table {
        table.flush().map_err(|e| unwritable(options.report, e))?;
    }
    if let Some(folder) = folder {
        folder.write("summary.json", &json(&summary)?)?;
        folder.write("errors.svg", &picture(&report.profile, options.tolerance_mm)?)?;
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
    Err(InputError::new(
        "A010",
        found,
        "a length above 0, at most 1000 mm",
        "give --tolerance 0.005, or what the part needs",
    ))
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
        coordinates: options.coordinates.unwrap_or(machine.coordinates()),
        centre_point: options.centre_point,
        splitter: Splitter {
            machine,
            tolerance: options.tolerance_mm,
            rule: options.rule,
            max_pieces: options.max_pieces,
            digits: options.digits,
        },
    }
}

fn steered(options: &Options, line: u32) -> InputError {
    let found = format!("line {line} steers the program or computes a place");
    let expected = "a program whose blocks are executed in the order of the text, with numbers";
    InputError::new("A011", found, expected, "let the control or the postprocessor write it out")
        .in_file(options.program)
}

fn unwritable(path: Option<&FilePath>, error: io::Error) -> InputError {
    InputError::unwritable(path.unwrap_or(FilePath::new("the output")), &error)
}

fn summary(options: &Options, machine: &Machine, settings: &Settings, report: &Report) -> MultiaxisSummary {
    let kind = match machine.kind() {
        Kind::TableTable => "table-table",
        Kind::TableHead => "table-head",
        Kind::HeadHead => "head-head",
    };
    let [first, second] = machine.rotary().map(|axis| axis.letter.name());
    let before = report.before.figures();
    MultiaxisSummary {
        version: 1,
        machine: format!("{kind} {first} {second}"),
        coordinates: if settings.coordinates == Coordinates::Tip { "tip" } else { "joints" },
        tip_moves: report.tips,
        tolerance_mm: options.tolerance_mm,
        lines: report.lines,
        moves: before.count,
        straight_moves: report.straight,
        rotary_moves: report.rotary_alone,
        full_interpolation_moves: report.full_interpolation,
        moves_rewritten: report.divided,
        points_inserted: report.inserted,
        before,
        after: report.after.figures(),
        singular: report.singular.clone(),
        orientation: report.orientation.clone(),
        left: report.left.clone(),
        warnings: warnings(options, report),
    }
}

fn warnings(options: &Options, report: &Report) -> Vec<String> {
    let name = options.program.display();
    let mut all: Vec<String> = Vec::new();
    for (note, line, count) in report.notes.iter() {
        let more = if count > 1 { format!(" (and {} more)", count - 1) } else { String::new() };
        all.push(format!("{name}:{line}: {note}{more}"));
    }
    if report.full_interpolation > 0 {
        all.push(format!(
            "{} five-axis moves are under tool centre point control, which keeps the tip on its chord: nothing to divide; \
             if the control transforms only the ends of blocks, say --tcp ends",
            report.full_interpolation
        ));
    }
    for left in report.left.moves.iter().take(10) {
        let error = left.error_mm.map_or_else(String::new, |e| format!(" (chord error {e:.4} mm)"));
        all.push(format!("{name}:{}: left as it is: {}{error}", left.line, left.reason));
    }
    if report.left.count > 10 {
        all.push(format!("{} more moves are left as they are", report.left.count - 10));
    }
    all
}
