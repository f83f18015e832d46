//! What `multiaxis` tells of a program: the figures before and after, and what the user should know.

use std::path::Path as FilePath;

use truepath_ground::count::counted;
use truepath_ground::length::Unit;
use truepath_multiaxis::Machine;
use truepath_multiaxis::ball::{ContactSpan, Contacts};
use truepath_multiaxis::machine::{Coordinates, Kind};
use truepath_multiaxis::program::{Left, Places, Report, Settings};
use truepath_multiaxis::statistics::Figures;

/// What was found and done.
#[derive(Clone, Debug, serde::Serialize)]
pub struct MultiaxisSummary {
    /// Version of this summary.
    pub version: u32,
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    pub unit: Unit,
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
    /// Where the ball end touches the surface named by `--normal`, at the ends of the five-axis moves.
    pub contact: Option<ContactSpan>,
    /// Moves that stay although they may err too much, and why.
    pub left: Left,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// What is told of a pass.
pub(super) fn summary(program: &FilePath, machine: &Machine, settings: &Settings, report: &Report) -> MultiaxisSummary {
    let kind = match machine.kind() {
        Kind::TableTable => "table-table",
        Kind::TableHead => "table-head",
        Kind::HeadHead => "head-head",
    };
    let [first, second] = machine.rotary().map(|axis| axis.letter.name());
    let before = report.before.figures();
    MultiaxisSummary {
        version: 1,
        unit: report.units.into(),
        machine: format!("{kind} {first} {second}"),
        coordinates: if settings.coordinates == Coordinates::Tip { "tip" } else { "joints" },
        tip_moves: report.tips,
        tolerance_mm: settings.splitter.tolerance,
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
        contact: report.contacts.as_ref().and_then(Contacts::span),
        left: report.left.clone(),
        warnings: warnings(program, report),
    }
}

fn warnings(program: &FilePath, report: &Report) -> Vec<String> {
    let (name, unit) = (program.display(), Unit::from(report.units));
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
        let error =
            left.error_mm.map_or_else(String::new, |e| format!(" (chord error {:.4} {})", unit.of(e), unit.name()));
        all.push(format!("{name}:{}: left as it is: {}{error}", left.line, left.reason));
    }
    if report.left.count > 10 {
        all.push(format!("{} more moves are left as they are", report.left.count - 10));
    }
    all
}

/// A figure of the table.
type Figure = fn(&Figures) -> f64;

pub(super) fn words(s: &MultiaxisSummary) -> String {
    let (unit, name) = (s.unit, s.unit.name());
    let xyz = match (s.tip_moves, s.moves) {
        (0, 0) if s.coordinates == "tip" => "places of the tool tip",
        (0, _) => "positions of the joints",
        (tips, all) if tips == all => "places of the tool tip",
        _ => "positions of the joints, and of the tool tip under centre point codes",
    };
    let mut text = format!("{}; X, Y, Z are {xyz}; tolerance {} {name}\n\n", s.machine, unit.of(s.tolerance_mm));
    text += &format!("chord error, {name}         before       after\n");
    let rows: [(&str, Figure); 4] = [
        ("maximum", |v| v.maximum_mm),
        ("minimum", |v| v.minimum_mm),
        ("mean", |v| v.mean_mm),
        ("standard deviation", |v| v.standard_deviation_mm),
    ];
    for (row, value) in rows {
        let [before, after] = [&s.before, &s.after].map(|figures| unit.of(value(figures)));
        text += &format!("{row:<20} {before:>9.5} {after:>11.5}\n");
    }
    text += &format!("{:<20} {:>9} {:>11}\n\n", "moves", s.before.count, s.after.count);
    text += &format!(
        "{} of {} rewritten, {} inserted\n",
        s.moves_rewritten,
        counted(s.moves, "five-axis move"),
        counted(s.points_inserted, "point")
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
        let span = |[low, high]: [f64; 2]| format!("{low:.2} to {high:.2}");
        let [low, high] = contact.cutting_radius_mm.map(|mm| unit.of(mm));
        text += &format!(
            "ball end on the surface: {} degrees from its tip, cutting radius {low:.3} to {high:.3} {name}, lag of the edge {} degrees\n",
            span(contact.polar_deg),
            span(contact.lag_deg)
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
