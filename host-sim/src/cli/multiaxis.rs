//! `truepath multiaxis`: five-axis programs whose moves keep to their chords.

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use truepath_core::gcode::{Dialect, PointlessLength, Units};
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::json;
use truepath_multiaxis::Rule;
use truepath_multiaxis::machine::Coordinates;
use truepath_multiaxis::program::{CentrePoint, Digits};
use truepath_multiaxis::statistics::Figures;

use super::canon::{Control, FileUnits, Pointless};
use super::{Terminal, print};
use crate::command::multiaxis::{MultiaxisSummary, Options, run as multiaxis};

#[derive(Debug, Args)]
pub(super) struct Arguments {
    /// The program: G-code with X, Y, Z and two of A, B, C.
    file: PathBuf,
    /// The machine file.
    #[arg(long, value_name = "M.toml")]
    machine: PathBuf,
    /// Largest chord error of a move, mm.
    #[arg(long, value_name = "MM", allow_negative_numbers = true)]
    tolerance: f64,
    /// The rewritten program; without it the errors are only told.
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
    /// Folder for moves.csv, summary.json and errors.svg.
    #[arg(long, value_name = "DIR")]
    report: Option<PathBuf>,
    /// Where locations are inserted.
    #[arg(long, value_enum, default_value_t = Division::Fewest)]
    rule: Division,
    /// Most pieces of one move.
    #[arg(long, value_name = "N", default_value_t = 1000, value_parser = clap::value_parser!(u32).range(2..=10_000))]
    max_pieces: u32,
    /// What X, Y, Z are; by default what the machine file says.
    #[arg(long, value_enum)]
    xyz: Option<Meaning>,
    /// What the control does under G43.4, G43.5, G234 or LinuxCNC's M428.
    #[arg(long, value_enum, default_value_t = Tcp::Full)]
    tcp: Tcp,
    /// Decimals of a millimetre and of a degree that the control takes (one more of an inch); by default 4 and 6.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u8).range(2..=8))]
    decimals: Option<u8>,
    /// Write the program although some moves cannot be checked or divided; they are left as they are.
    #[arg(long)]
    partial: bool,
    /// Write a program with loops, calls or computed places out plainly, so that it can be rewritten.
    #[arg(long)]
    unroll: bool,
    /// The control the program is written for.
    #[arg(long, value_enum, default_value_t = Control::Linuxcnc)]
    dialect: Control,
    /// What a length without a point is: millimetres and inches, or least increments (0.001 mm, 0.0001 in).
    #[arg(long, value_enum, default_value_t = Pointless::Calculator)]
    decimal: Pointless,
    /// The unit until G20 or G21.
    #[arg(long, value_enum, default_value_t = FileUnits::Mm)]
    units: FileUnits,
    /// Skip blocks that begin with `/`.
    #[arg(long)]
    skip_block_delete: bool,
    /// Normal of the surface that is cut, out of the part: tells where the ball end touches it.
    #[arg(long, value_name = "X,Y,Z", value_parser = normal, allow_hyphen_values = true)]
    normal: Option<[f64; 3]>,
    /// Replace existing files.
    #[arg(long)]
    force: bool,
}

/// Three numbers with commas between them.
fn normal(text: &str) -> Result<[f64; 3], String> {
    let numbers: Vec<f64> = text.split(',').map_while(|part| part.trim().parse().ok()).collect();
    match numbers[..] {
        [x, y, z] if numbers.iter().all(|n| n.is_finite()) && text.split(',').count() == 3 => Ok([x, y, z]),
        _ => Err("expected three numbers, for instance 0,0,1".to_owned()),
    }
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Division {
    /// Equal pieces.
    Equal,
    /// Halving, as in the paper.
    Midpoint,
    /// Every piece as long as it can be.
    Longest,
    /// The one of the three with the fewest pieces.
    Fewest,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Meaning {
    /// Positions of the linear joints.
    Joints,
    /// Places of the tool tip in the part's frame.
    Tip,
}

#[derive(Clone, Copy, Debug, ValueEnum)]
enum Tcp {
    /// It transforms every interpolated point: no chord error.
    Full,
    /// It transforms the ends of blocks only.
    Ends,
}

pub(super) fn run(arguments: &Arguments, terminal: &Terminal) -> Result<(), Failure> {
    let options = Options {
        program: &arguments.file,
        machine: &arguments.machine,
        tolerance_mm: arguments.tolerance,
        rule: match arguments.rule {
            Division::Equal => Rule::Equal,
            Division::Midpoint => Rule::Midpoint,
            Division::Longest => Rule::Longest,
            Division::Fewest => Rule::Fewest,
        },
        max_pieces: arguments.max_pieces as usize,
        out: arguments.output.as_deref(),
        report: arguments.report.as_deref(),
        force: arguments.force,
        partial: arguments.partial,
        unroll: arguments.unroll,
        coordinates: arguments.xyz.map(|meaning| match meaning {
            Meaning::Joints => Coordinates::Joints,
            Meaning::Tip => Coordinates::Tip,
        }),
        centre_point: match arguments.tcp {
            Tcp::Full => CentrePoint::Full,
            Tcp::Ends => CentrePoint::Ends,
        },
        digits: arguments.decimals.map_or_else(Digits::default, Digits::at_most),
        dialect: Dialect::from(arguments.dialect),
        decimal: PointlessLength::from(arguments.decimal),
        units: Units::from(arguments.units),
        skip_block_delete: arguments.skip_block_delete,
        normal: arguments.normal,
    };
    let bytes = std::fs::metadata(&arguments.file).map_or(0, |m| m.len());
    let mut bar = terminal.progress("dividing", bytes);
    let summary = multiaxis(&options, &mut |read| bar.reached(read))?;
    drop(bar);
    for warning in &summary.warnings {
        terminal.warn(warning);
    }
    print(&if terminal.json() { json(&summary)? } else { words(&summary).into_bytes() })
}

/// A figure of the table.
type Figure = fn(&Figures) -> f64;

fn words(s: &MultiaxisSummary) -> String {
    let xyz = match (s.tip_moves, s.moves) {
        (0, 0) if s.coordinates == "tip" => "places of the tool tip",
        (0, _) => "positions of the joints",
        (tips, all) if tips == all => "places of the tool tip",
        _ => "positions of the joints, and of the tool tip under centre point codes",
    };
    let mut text = format!("{}; X, Y, Z are {xyz}; tolerance {} mm\n\n", s.machine, s.tolerance_mm);
    text += "chord error, mm         before       after\n";
    let rows: [(&str, Figure); 4] = [
        ("maximum", |v| v.maximum_mm),
        ("minimum", |v| v.minimum_mm),
        ("mean", |v| v.mean_mm),
        ("standard deviation", |v| v.standard_deviation_mm),
    ];
    for (name, value) in rows {
        text += &format!("{name:<20} {:>9.5} {:>11.5}\n", value(&s.before), value(&s.after));
    }
    text += &format!("{:<20} {:>9} {:>11}\n\n", "moves", s.before.count, s.after.count);
    text += &format!(
        "{} of {} five-axis moves rewritten, {} points inserted\n",
        s.moves_rewritten, s.moves, s.points_inserted
    );
    if s.singular.count > 0 {
        let lines: Vec<String> = s.singular.lines.iter().take(12).map(u32::to_string).collect();
        let more = if s.singular.lines.len() > 12 { ", …" } else { "" };
        let (moves, word) = (counted(s.singular.count, "move"), if lines.len() == 1 { "line" } else { "lines" });
        text += &format!("{moves} near a pole of the machine or across it: {word} {}{more}\n", lines.join(", "));
    }
    if s.orientation.count > 0 {
        text += &format!("{} whose tool axis cannot keep to the great circle\n", counted(s.orientation.count, "move"));
    }
    if let Some(contact) = &s.contact {
        let span = |[low, high]: [f64; 2], digits| format!("{low:.digits$} to {high:.digits$}");
        text += &format!(
            "ball end on the surface: {} degrees from its tip, cutting radius {} mm, lag of the edge {} degrees\n",
            span(contact.polar_deg, 2),
            span(contact.cutting_radius_mm, 3),
            span(contact.lag_deg, 2)
        );
        if contact.on_shank > 0 {
            text += &format!("{} where the shank would touch it\n", counted(contact.on_shank, "place"));
        }
    }
    if s.left.count > 0 {
        text += &format!("{} not brought within the tolerance\n", counted(s.left.count, "move"));
    }
    text
}

fn counted(count: u64, what: &str) -> String {
    if count == 1 { format!("1 {what}") } else { format!("{count} {what}s") }
}
