//! Programs that the control compensates by the cutter's radius (G41, G42): written as the path of the cutter's centre.
//!
//! A correction is a displacement of the centre, by amounts that a control would take for gouges or smooth away. So
//! along every stretch of compensated moves that holds a line of the contour, G41 or G42 and D are left out, entry,
//! exit and whatever lies between are written where the centre goes, and G40 stays, which is harmless. Compensated
//! stretches without a line of the contour keep their bytes.
//!
//! Limits: the radius is the one the program was read with; the offset of the control has no part in the path any
//! more, which the head of the program says. What cannot be written like this is refused (P007).

use std::collections::{BTreeMap, BTreeSet};
use std::ops::Range;

use truepath_core::gcode::{CompensationBy, Line, Motion, Plane};
use truepath_core::geometry;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;

use super::edit::{BlockEdit, RewriteOptions};
use super::fit::Shape;
use super::klartext::{Drawn, KlartextLine};
use super::line::{Block, Manner};
use super::pen::{Pen, place};
use super::survey::{Kind, Move};
use super::writer::Writer;
use crate::codes::P007;

/// Stretches of compensated moves that hold a line of the contour.
pub(super) fn stretches(moves: &[Move], edits: &[BlockEdit]) -> Vec<Range<usize>> {
    let lines: BTreeSet<u32> = edits.iter().map(|e| e.line).collect();
    let mut found = Vec::new();
    let mut at = 0;
    while at < moves.len() {
        let count = moves[at..].iter().take_while(|m| m.modal.compensated).count();
        if moves[at..at + count].iter().any(|m| lines.contains(&m.line)) {
            found.push(at..at + count);
        }
        at += count.max(1);
    }
    found
}

/// The lines that switch compensation on for these stretches, without the words that do; the line of the first move of
/// a stretch for which there is none.
pub(super) fn without_switches(
    lines: &[Line<'_>],
    moves: &[Move],
    stretches: &[Range<usize>],
    manner: Manner,
) -> Result<BTreeMap<u32, Vec<u8>>, u32> {
    let mut stripped = BTreeMap::new();
    for stretch in stretches {
        let first = moves[stretch.start].line;
        let before = lines.iter().rev().skip_while(|l| l.number > first);
        let found = before.map(|&l| (l.number, Block::new(l, manner))).find(|(_, b)| b.switches_compensation_on());
        let (number, block) = found.ok_or(first)?;
        // A lead is written anew as a whole.
        if !block.klartext().is_some_and(KlartextLine::is_lead) {
            stripped.insert(number, block.without_compensation());
        }
        if manner.klartext {
            // A block may name the side again.
            let last = moves[stretch.clone()].iter().map(|m| m.line).max().unwrap_or(first);
            for line in lines.iter().filter(|l| l.number > number && l.number <= last) {
                let block = Block::new(*line, manner);
                if block.switches_compensation_on() {
                    stripped.insert(line.number, block.without_compensation());
                }
            }
        }
    }
    Ok(stripped)
}

/// The options, with the note that the head of the program carries.
pub(super) fn noted(options: &RewriteOptions, program: &[u8]) -> RewriteOptions {
    let mut noted = options.clone();
    let radius = match options.program.compensation {
        CompensationBy::Radius(radius) | CompensationBy::ToolRadius { radius, .. } => {
            let unit = Unit::at(program, program.len());
            format!("the cutter radius of {} {}", unit.of(radius.nm() as f64 / 1e6), unit.name())
        }
        CompensationBy::Nothing | CompensationBy::Table => "the cutter radius".to_owned(),
    };
    noted.notes.push(format!("path of the cutter centre: {radius} is part of it, D is not used"));
    noted
}

impl Writer<'_> {
    /// Writes the moves of these stretches, and the one that leaves each, where the centre of the cutter goes. Lines
    /// of the contour are left to the rest of the writer, but never kept as they were.
    pub(super) fn write_centre_path(
        &mut self,
        moves: &[Move],
        stretches: &[Range<usize>],
        edits: &[BlockEdit],
    ) -> Result<(), Failure> {
        for stretch in stretches {
            let behind = moves[stretch.end..].iter().position(|m| !m.stands_still());
            let until = behind.map_or(moves.len(), |i| stretch.end + i + 1);
            let (mut last_travel, mut rapid) = (None, false);
            for step in &moves[stretch.start..until] {
                self.refuse_other_file(step)?;
                self.centre.insert(step.line);
                if edits.iter().any(|e| e.line == step.line) || matches!(step.kind, Kind::Away(_)) {
                    continue;
                }
                if self.manner.klartext {
                    let again = last_travel.replace(step.line) == Some(step.line);
                    self.write_conversational_centre(step, again.then_some(rapid))?;
                    rapid = matches!(step.kind, Kind::Traverse);
                    continue;
                }
                if !step.stands_still() && last_travel.replace(step.line) == Some(step.line) {
                    let found = "a line beside the contour becomes several moves by compensation (G41, G42)";
                    return Err(self.refuse_compensation(step.line, found));
                }
                self.write_centre(step)?;
            }
        }
        Ok(())
    }

    /// Writes one move beside the contour of a conversational program; `again` where its block has become one already, as
    /// those of leads do, and whether that is one of FMAX.
    fn write_conversational_centre(&mut self, step: &Move, again: Option<bool>) -> Result<(), Failure> {
        let refused = |writer: &Self| {
            let found = "this move cannot be written where compensation (RL, RR) leads the cutter's centre";
            Err(writer.refuse_compensation(step.line, found))
        };
        let Some(to) = place(step.to).filter(|_| !step.in_cycle()) else {
            // Heights alone are known before any place is.
            return if step.is_straight() && step.to.point().is_none() { Ok(()) } else { refused(self) };
        };
        let block = self.original(step.line);
        let Some(line) = block.klartext() else { return refused(self) };
        let pen = Pen::new(place(step.from).unwrap_or(to).map(|v| v as f64), &step.modal);
        let target = pen.nearest(to);
        let text = |axis: usize| pen.value(axis, target[axis]);
        let texts = match step.kind {
            Kind::Traverse | Kind::Feed if !line.is_lead() && again.is_none() => {
                if step.stands_still() && !block.names_axis(0) && !block.names_axis(1) {
                    return Ok(());
                }
                vec![line.repositioned([Some(text(0)), Some(text(1))])]
            }
            Kind::Traverse | Kind::Feed | Kind::Arc(_, 0) => {
                let arc = step.curve().and_then(|curve| match curve.shape() {
                    geometry::Shape::Arc { centre, sweep } => {
                        let grid = pen.grid();
                        let centre = [centre.x.nm() as f64, centre.y.nm() as f64];
                        Some((centre.map(|v| grid.text(grid.steps_of(v))), sweep.bits() > 0))
                    }
                    geometry::Shape::Line => None,
                });
                let drawn = Drawn { to: [text(0), text(1)], arc };
                match again {
                    Some(rapid) => line.further(&drawn, false, line.feed().filter(|_| rapid).as_deref()),
                    None => line.lead(&drawn, matches!(step.kind, Kind::Traverse), true, None),
                }
            }
            _ => return refused(self),
        };
        match self.replaced.get_mut(&step.line).filter(|_| again.is_some()) {
            Some(parts) => parts.extend(texts),
            None => {
                self.replaced.insert(step.line, texts);
            }
        }
        Ok(())
    }

    pub(super) fn refuse_compensation(&self, line: u32, found: &str) -> Failure {
        self.refusal(P007, line, [found, "moves that can be written as the path of the cutter's centre", P007.remedy])
    }

    /// Writes one move beside the contour.
    fn write_centre(&mut self, step: &Move) -> Result<(), Failure> {
        let (Some(from), Some(to), false) = (place(step.from), place(step.to), step.in_cycle()) else {
            let found = "this move begins beside the programmed path, where compensation (G41, G42) has led";
            return Err(self.refuse_compensation(step.line, found));
        };
        let block = self.block(step.line);
        let mut pen = Pen::new(from.map(|v| v as f64), &step.modal);
        let target = pen.nearest(to);
        let text = match step.kind {
            Kind::Traverse | Kind::Feed if !block.has_corner() => {
                let value = |axis: usize, letter| {
                    let named = block.word(letter).is_some();
                    let needed = if step.stands_still() { named && step.modal.absolute } else { true };
                    needed.then(|| pen.value(axis, target[axis]))
                };
                block.repositioned([value(0, b'X'), value(1, b'Y')])
            }
            Kind::Arc(curve, 0) if step.modal.plane == Plane::Xy => {
                let geometry::Shape::Arc { centre, sweep } = curve.shape() else {
                    return Err(Failure::Internal(format!("the arc of line {} is a line", step.line)));
                };
                let counter_clockwise = sweep.bits() > 0;
                let centre = [centre.x.nm() as f64, centre.y.nm() as f64];
                let words = pen.draw(target, &Shape::Arc { centre, counter_clockwise });
                block.moved(Motion::Arc { counter_clockwise }, false, &words, false, None)
            }
            _ => {
                let found = "this move cannot be written where compensation (G41, G42) leads the cutter's centre";
                return Err(self.refuse_compensation(step.line, found));
            }
        };
        self.replaced.insert(step.line, vec![text]);
        Ok(())
    }

    /// Writes the moves of an APPR (`to_contour`) or DEP block out, displaced by as much as the contour beside it: all of a
    /// lead to the contour, and the arc of one from it, whose straight move goes where it went.
    pub(super) fn write_lead(&mut self, moves: &[Move], by: [f64; 2], to_contour: bool) {
        let Some(number) = moves.first().map(|step| step.line) else { return };
        let block = self.original(number);
        let Some(line) = block.klartext() else { return };
        let (centre_path, mut rapid) = (self.centre.contains(&number), false);
        let mut texts = Vec::new();
        for step in moves {
            let Some(to) = place(step.to) else { continue };
            let pen = Pen::new(place(step.from).unwrap_or(to).map(|v| v as f64), &step.modal);
            let grid = pen.grid();
            let shift = if to_contour || matches!(step.kind, Kind::Arc(..)) { by } else { [0.0; 2] };
            let target = pen.nearest([0, 1].map(|axis| (to[axis] as f64 + shift[axis]).round() as i64));
            let arc = step.curve().and_then(|curve| match curve.shape() {
                geometry::Shape::Arc { centre, sweep } => {
                    let centre = [centre.x.nm() as f64 + shift[0], centre.y.nm() as f64 + shift[1]];
                    Some((centre.map(|v| grid.text(grid.steps_of(v))), sweep.bits() > 0))
                }
                geometry::Shape::Line => None,
            });
            let drawn = Drawn { to: [0, 1].map(|axis| pen.value(axis, target[axis])), arc };
            let fast = matches!(step.kind, Kind::Traverse);
            texts.extend(if texts.is_empty() {
                line.lead(&drawn, fast, centre_path, None)
            } else {
                line.further(&drawn, false, line.feed().filter(|_| rapid).as_deref())
            });
            rapid = fast;
        }
        self.replaced.insert(number, texts);
    }
}
