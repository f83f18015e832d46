//! What a pass found, in bounded memory.

use serde::Serialize;
use truepath_core::gcode::Units;

use super::notes::Notes;
use super::profile::Profile;
use super::reason::Reason;
use super::settings::Settings;
use super::split::Plan;
use crate::ball::Contacts;
use crate::singular::Class;
use crate::statistics::Deviations;

/// A move of the program.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct MoveRow {
    /// Its line.
    pub line: u32,
    /// Its largest chord error, mm.
    pub error_before_mm: f64,
    /// Pieces it is divided into, 1 when it stays as it is.
    pub pieces: usize,
    /// The largest chord error of a piece, mm.
    pub error_after_mm: f64,
    /// How it stands to the pole of the machine.
    pub passage: Class,
}

/// Lines kept of a kind of place; beyond them only the number grows.
pub const LISTED: usize = 100;

/// Places of one kind.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Places {
    /// How many.
    pub count: u64,
    /// The first `LISTED` lines, each once.
    pub lines: Vec<u32>,
}

impl Places {
    /// Adds one.
    pub fn add(&mut self, line: u32) {
        self.count += 1;
        if self.lines.len() < LISTED && self.lines.last() != Some(&line) {
            self.lines.push(line);
        }
    }
}

/// A move that is left as it is although it was not shown to be within the tolerance.
#[derive(Clone, Copy, Debug, Serialize)]
pub struct LeftMove {
    /// Its line.
    pub line: u32,
    /// Why.
    pub reason: Reason,
    /// Its chord error, mm, when it can be computed.
    pub error_mm: Option<f64>,
}

/// All such moves.
#[derive(Clone, Debug, Default, Serialize)]
pub struct Left {
    /// How many.
    pub count: u64,
    /// The first `LISTED`.
    pub moves: Vec<LeftMove>,
}

impl Left {
    /// Adds one.
    pub fn add(&mut self, line: u32, reason: Reason, error_mm: Option<f64>) {
        self.count += 1;
        if self.moves.len() < LISTED {
            self.moves.push(LeftMove { line, reason, error_mm });
        }
    }
}

/// What a pass found.
#[derive(Clone, Debug)]
pub struct Report {
    /// Lines read.
    pub lines: u64,
    /// Bytes read.
    pub bytes: u64,
    /// Blocks executed.
    pub blocks: u64,
    /// G1 moves of X, Y, Z alone.
    pub straight: u64,
    /// G1 moves of rotary axes alone, left as they are.
    pub rotary_alone: u64,
    /// Five-axis moves under a control that interpolates the tip.
    pub full_interpolation: u64,
    /// Moves that are divided.
    pub divided: u64,
    /// Locations inserted.
    pub inserted: u64,
    /// Errors of the moves read.
    pub before: Deviations,
    /// Errors of the moves written.
    pub after: Deviations,
    /// Errors along the program.
    pub profile: Profile,
    /// Moves left although they may err too much.
    pub left: Left,
    /// Moves near a pole of the machine, or from one branch of its kinematics to the other.
    pub singular: Places,
    /// Moves whose tool axis leaves the great circle by more than the machine file allows, and cannot follow it.
    pub orientation: Places,
    /// Moves whose XYZ are the tip.
    pub tips: u64,
    /// Where the ball end touches the named surface.
    pub contacts: Option<Contacts>,
    /// What to look at.
    pub notes: Notes,
    /// Line and error of the move that errs most, when that is more than allowed.
    pub worst: Option<(u32, f64)>,
    /// Largest error allowed, mm.
    pub tolerance: f64,
    /// The unit in which the program ends.
    pub units: Units,
}

impl Report {
    /// Nothing yet.
    pub fn new(settings: &Settings<'_>) -> Self {
        Self {
            lines: 0,
            bytes: 0,
            blocks: 0,
            straight: 0,
            rotary_alone: 0,
            full_interpolation: 0,
            divided: 0,
            inserted: 0,
            before: Deviations::default(),
            after: Deviations::default(),
            profile: Profile::default(),
            left: Left::default(),
            singular: Places::default(),
            orientation: Places::default(),
            tips: 0,
            contacts: settings.normal.and_then(|normal| Contacts::new(settings.splitter.machine, normal)),
            notes: Notes::default(),
            worst: None,
            tolerance: settings.splitter.tolerance,
            units: settings.units,
        }
    }

    /// Adds a checked move.
    pub fn add(&mut self, row: &MoveRow, plan: &Plan) {
        if row.error_before_mm > self.tolerance && self.worst.is_none_or(|worst| row.error_before_mm > worst.1) {
            self.worst = Some((row.line, row.error_before_mm));
        }
        self.before.push(row.error_before_mm);
        plan.after.iter().for_each(|error| self.after.push(*error));
        self.profile.add(row.error_before_mm, row.error_after_mm);
        if matches!(row.passage, Class::NearPole | Class::BranchChange) {
            self.singular.add(row.line);
        }
        if plan.cannot_follow {
            self.orientation.add(row.line);
        }
        self.divided += u64::from(row.pieces > 1);
        self.inserted += plan.inserted.len() as u64;
    }

    /// The program was not rewritten after all.
    pub fn stays(&mut self) {
        (self.after, self.divided, self.inserted) = (self.before, 0, 0);
    }
}
