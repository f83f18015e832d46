//! What a corrected program differs in from its original, for people and for machines.
//!
//! The numbers are counted from the written text by [`super::proof`], not taken from the writer.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write as _;

use truepath_core::gcode::Lines;
use truepath_core::geometry::Curve;

use super::deviation::distance;
use super::edit::{BlockEdit, RewriteOptions};
use super::proof::{Kink, Proof};
use super::survey::Move;
use super::vector::length;
use truepath_ground::length::Unit;

/// The largest displacement of the contour.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Shift {
    /// How far the corrected path is from the programmed one, mm.
    pub mm: f64,
    /// The line of the original program.
    pub line: u32,
    /// The place on the corrected path, program coordinates, mm.
    pub x_mm: f64,
    /// The place on the corrected path, program coordinates, mm.
    pub y_mm: f64,
}

/// The difference between a program and its corrected text.
#[derive(Clone, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Difference {
    /// Lines of the original program.
    pub program_lines: usize,
    /// Lines of the contour that were written anew.
    pub contour_lines_changed: usize,
    /// Lines of the contour kept as they were, because they did not move.
    pub contour_lines_kept: usize,
    /// Lines beside the contour that were changed, because they hang on its ends.
    pub other_lines_changed: Vec<u32>,
    /// Whether the control's cutter compensation (G41, G42) was taken out: the contour is the path of the centre.
    pub compensation_taken_out: bool,
    /// G1 moves along the written contour.
    pub straight_moves: usize,
    /// G2 and G3 moves along it.
    pub arcs: usize,
    /// The largest displacement.
    pub largest_shift: Shift,
    /// The largest distance between the written path and the wanted one, mm, as read back.
    pub largest_deviation_mm: f64,
    /// What it may be, mm.
    pub tolerance_mm: f64,
    /// The largest kink where the original is smooth, degrees.
    pub largest_kink_deg: f64,
    /// The line of the corrected program that begins with it; 0 without any.
    pub largest_kink_line: u32,
    /// The largest part of a kink that the wanted path does not have itself, degrees.
    pub largest_kink_beyond_path_deg: f64,
    /// What that should not exceed, degrees.
    pub max_kink_deg: f64,
    /// Steps (moves, feeds, speeds, tools, functions, comments) outside the contour, all compared and the same.
    pub steps_outside_compared: usize,
    /// Moves among them.
    pub moves_outside_compared: usize,
    /// F words along the contour: all the same, or the wanted percentages.
    pub feeds_along_compared: usize,
    /// Whether feeds along the contour were to change.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub feeds_scheduled: bool,
}

/// An angle without the digits in which arc tangents of one system differ from those of another.
fn shown(degrees: f64) -> f64 {
    (degrees * 1e9).round() / 1e9
}

impl Difference {
    pub(super) fn new(
        program: &[u8],
        moves: &[Move],
        edits: &[BlockEdit],
        (touched, kept, centre_path): (impl Iterator<Item = u32>, usize, bool),
        proof: &Proof,
        options: &RewriteOptions,
    ) -> Self {
        let kink = proof.kinks.iter().copied().fold(Kink::default(), |a, b| if b.degrees > a.degrees { b } else { a });
        let edited: BTreeSet<u32> = edits.iter().map(|edit| edit.line).collect();
        let others = touched.filter(|line| !edited.contains(line)).collect();
        Self {
            program_lines: Lines::new(program).count(),
            contour_lines_changed: edits.len() - kept,
            contour_lines_kept: kept,
            other_lines_changed: others,
            compensation_taken_out: centre_path,
            straight_moves: proof.lines,
            arcs: proof.arcs,
            largest_shift: largest_shift(moves, edits),
            largest_deviation_mm: proof.deviation_nm / 1e6,
            tolerance_mm: options.tolerance.nm() as f64 / 1e6,
            largest_kink_deg: shown(kink.degrees),
            largest_kink_line: kink.line,
            largest_kink_beyond_path_deg: shown(proof.kinks.iter().map(|k| k.beyond).fold(0.0, f64::max)),
            max_kink_deg: options.max_kink_deg,
            steps_outside_compared: proof.steps_outside,
            moves_outside_compared: proof.moves_outside,
            feeds_along_compared: proof.feeds,
            feeds_scheduled: edits.iter().any(|edit| !edit.feeds.is_empty()),
        }
    }

    /// `difference.txt`, in the unit of the program.
    pub fn text(&self, original: &str, unit: Unit) -> String {
        let mut text = String::new();
        let others: Vec<String> = self.other_lines_changed.iter().map(u32::to_string).collect();
        let kink = match self.largest_kink_line {
            0 => "none".to_owned(),
            line => format!("{:.3} deg at line {line} of corrected.nc", self.largest_kink_deg),
        };
        let (shift, name) = (self.largest_shift, unit.name());
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "corrected.nc against {original} ({} lines)\n\
             \n\
             contour lines written anew        {}\n\
             contour lines kept                {}\n\
             other lines changed               {}\n\
             cutter compensation               {}\n\
             written for the contour           {} G1, {} G2/G3\n\
             largest shift                     {:.4} {name}, line {} near X{:.3} Y{:.3} {name}\n\
             largest deviation from the path   {:.5} {name} (tolerance {} {name})\n\
             largest kink where it was smooth  {kink}\n\
             beyond the wanted path's own turn {:.3} deg (limit {} deg)\n\
             \n\
             Both programs were then read and compared step by step:\n\
             {} steps outside the contour, {} of them moves: the same, but for the ends at the contour.\n\
             Along the contour: {}speeds, heights, modes, comments, functions and block numbers are the same.\n\
             All lines not named above have kept their bytes. Nothing else changed.\n",
            self.program_lines,
            self.contour_lines_changed,
            self.contour_lines_kept,
            if others.is_empty() {
                "none".to_owned()
            } else {
                format!("{} (to and from the contour's ends)", others.join(", "))
            },
            if self.compensation_taken_out {
                "taken out of the contour: it is the path of the cutter's centre"
            } else {
                "as it was"
            },
            self.straight_moves,
            self.arcs,
            unit.of(shift.mm),
            shift.line,
            unit.of(shift.x_mm),
            unit.of(shift.y_mm),
            unit.of(self.largest_deviation_mm),
            unit.of(self.tolerance_mm),
            self.largest_kink_beyond_path_deg,
            self.max_kink_deg,
            self.steps_outside_compared,
            self.moves_outside_compared,
            if self.feeds_scheduled {
                format!(
                    "{} F words are the wanted percentages of the programmed feeds, put back behind it;\n",
                    self.feeds_along_compared
                )
            } else {
                format!("feeds ({} F words), ", self.feeds_along_compared)
            },
        );
        text
    }
}

fn largest_shift(moves: &[Move], edits: &[BlockEdit]) -> Shift {
    let mut of_line: BTreeMap<u32, Vec<Curve>> = BTreeMap::new();
    for (line, curve) in moves.iter().filter_map(|step| Some((step.line, step.curve()?))) {
        of_line.entry(line).or_default().push(curve);
    }
    let mut largest = Shift::default();
    for edit in edits {
        let curves = of_line.get(&edit.line).map_or(&[][..], Vec::as_slice);
        let (Some(first), Some(last)) = (curves.first(), curves.last()) else { continue };
        let ends = [(edit.samples.first(), first.start()), (edit.samples.last(), last.end())];
        let displaced = ends.into_iter().filter_map(|(sample, nominal)| {
            let s = *sample?;
            Some((length([(s[0] - nominal.x.nm()) as f64, (s[1] - nominal.y.nm()) as f64]), s))
        });
        let beside = edit.samples.iter().map(|&s| {
            let off = curves.iter().map(|c| distance(s, c)).fold(f64::INFINITY, f64::min);
            (off, s)
        });
        for (nm, at) in displaced.chain(beside) {
            if nm / 1e6 > largest.mm {
                let [x_mm, y_mm] = at.map(|v| v as f64 / 1e6);
                largest = Shift { mm: nm / 1e6, line: edit.line, x_mm, y_mm };
            }
        }
    }
    largest
}
