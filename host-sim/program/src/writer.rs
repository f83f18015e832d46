//! What has been written so far of a corrected program, and what every part of the writing asks of it.

use std::collections::{BTreeMap, BTreeSet, HashMap, HashSet};

use truepath_core::gcode::{KlartextBlock, Line, Modal, Motion, Statement};
use truepath_ground::codes::Row;
use truepath_ground::diagnostics::{Failure, InputError, Source};

use super::edit::RewriteOptions;
use super::klartext::Drawn;
use super::line::{Block, Manner};
use super::pen::Pen;
use super::survey::Move;
use crate::codes::P004;

/// New text of a line: one or more lines without their ends.
pub(super) type Replaced = BTreeMap<u32, Vec<Vec<u8>>>;

/// The feed in force in the written text where it is not that of the program.
#[derive(Clone, Debug)]
pub(super) struct Scheduled {
    /// As it is written.
    pub(super) text: String,
    /// The line that was written last.
    pub(super) line: u32,
    pub(super) modal: Modal,
}

/// What has been written so far.
pub(super) struct Writer<'a> {
    pub(super) source: &'a Source,
    pub(super) lines: Vec<Line<'a>>,
    pub(super) options: &'a RewriteOptions,
    pub(super) replaced: Replaced,
    pub(super) manner: Manner,
    /// The motion in force in the written text.
    pub(super) motion: Option<Motion>,
    pub(super) unchanged: usize,
    /// Lines whose words lead beside the path of the cutter's centre: they are never kept.
    pub(super) centre: BTreeSet<u32>,
    /// Lines of the contour that are written anew.
    pub(super) rewritten: BTreeSet<u32>,
    /// The feed in force in the written text, where it is another one than in the program.
    pub(super) feed: Option<Scheduled>,
}

impl<'a> Writer<'a> {
    /// A line as it was.
    pub(super) fn original(&self, number: u32) -> Block<'a> {
        Block::new(self.line(number), self.manner)
    }
    /// Its text; nothing for a line of another file.
    fn line(&self, number: u32) -> Line<'a> {
        let index = (number as usize).checked_sub(1);
        index.and_then(|i| self.lines.get(i)).copied().unwrap_or(Line { number, start: 0, text: &[] })
    }
    /// A line as it stands now.
    pub(super) fn block(&self, number: u32) -> Block<'_> {
        // A pole stands before its arc.
        let of = |lines: &'_ Vec<Vec<u8>>| if self.manner.klartext { lines.len().saturating_sub(1) } else { 0 };
        let line = match self.replaced.get(&number).and_then(|lines| lines.get(of(lines))) {
            Some(text) => Line { number, start: 0, text },
            None => self.line(number),
        };
        Block::new(line, self.manner)
    }
    pub(super) fn refusal(&self, row: Row, line: u32, texts: [&str; 3]) -> Failure {
        let span = self.line(line).span();
        let [found, expected, help] = texts;
        InputError::new(row, found, expected, help).at(self.source, span.start..span.end()).into()
    }

    /// A line that the program executes several times, or that stands in another file, cannot be edited in place.
    pub(super) fn refuse_repetition(&self, moves: &[Move], lines: impl Iterator<Item = u32>) -> Result<(), Failure> {
        let mut first = HashMap::new();
        let again: HashSet<u32> =
            moves.iter().filter(|m| *first.entry(m.line).or_insert(m.jumps) != m.jumps).map(|m| m.line).collect();
        for line in lines {
            if line == 0 || again.contains(&line) {
                let found = if line == 0 {
                    "a line of the contour, or one that leads to or from it, stands in another file"
                } else {
                    "this line is executed several times (a loop or a subprogram), with one correction for each"
                };
                return Err(self.refusal(
                    P004,
                    line,
                    [found, "lines of this file that are executed once", P004.remedy],
                ));
            }
        }
        Ok(())
    }

    /// A move written in another file cannot be displaced.
    pub(super) fn refuse_other_file(&self, step: &Move) -> Result<(), Failure> {
        self.refuse_repetition(&[], std::iter::once(step.line).filter(|line| *line == 0))
    }

    /// Writes out the motion of a move that relied on the code of an earlier line, where that is another one now.
    pub(super) fn state_motion(&mut self, step: &Move) {
        let Some(motion) = step.modal.motion else { return };
        let block = self.block(step.line);
        if self.motion != Some(motion) && !block.names(motion) {
            let text = block.with_motion(motion);
            self.replaced.insert(step.line, vec![text]);
        }
        self.motion = Some(motion);
    }

    /// Keeps a move that stands still in the plane where the pen is.
    pub(super) fn follow(&mut self, pen: Pen, step: &Move) {
        if !step.modal.absolute || step.from.point().is_none_or(|p| pen.is_at([p.x.nm(), p.y.nm()])) {
            return;
        }
        let block = self.block(step.line);
        let values = [0, 1].map(|axis| block.names_axis(axis).then(|| pen.value(axis, pen.at[axis])));
        if values.iter().any(Option::is_some) {
            let text = block.repositioned(values);
            self.replaced.insert(step.line, vec![text]);
        }
    }

    /// Moves an arc beside the contour with the contour's end: `pen` is at its start, `by` away from where it was. Gives
    /// the pen at its end.
    pub(super) fn carry(&mut self, pen: Pen, step: &Move, by: [f64; 2]) -> Option<Pen> {
        let to = step.to.point()?;
        let target = [to.x.nm() as f64 + by[0], to.y.nm() as f64 + by[1]];
        let block = self.block(step.line);
        if let Some(line) = block.klartext() {
            // The pole may be that of other arcs, and a tangent arc follows what stands before it.
            let grid = pen.grid();
            let arc = step.curve().and_then(|curve| match curve.shape() {
                truepath_core::geometry::Shape::Arc { centre, sweep } => {
                    let centre = [centre.x.nm() as f64 + by[0], centre.y.nm() as f64 + by[1]];
                    Some((centre.map(|v| grid.text(grid.steps_of(v))), sweep.bits() > 0))
                }
                truepath_core::geometry::Shape::Line => None,
            });
            let drawn = Drawn { to: [0, 1].map(|axis| pen.value(axis, target[axis])), arc };
            let text = line.moved(&drawn, false, None);
            self.replaced.insert(step.line, text);
            return Some(Pen::new(target, &step.modal));
        }
        let mut text = None;
        if step.modal.absolute {
            let value =
                |axis: usize| (block.names_axis(axis) || by[axis] != 0.0).then(|| pen.value(axis, target[axis]));
            text = Some(block.repositioned([value(0), value(1)]));
        }
        if step.modal.absolute_centres
            && let Some(curve) = step.curve()
            && let truepath_core::geometry::Shape::Arc { centre, .. } = curve.shape()
        {
            let line = Line { number: step.line, start: 0, text: text.as_deref().unwrap_or_else(|| block.text()) };
            let centre = [centre.x.nm() as f64 + by[0], centre.y.nm() as f64 + by[1]];
            let grid = pen.grid();
            text = Some(
                Block::new(line, self.manner)
                    .with_values([(b'I', 0), (b'J', 1)].map(|(l, axis)| (l, grid.text(grid.steps_of(centre[axis]))))),
            );
        }
        if let Some(text) = text {
            self.replaced.insert(step.line, vec![text]);
        }
        Some(Pen::new(target, &step.modal))
    }

    /// Roundings and chamfers that the control was to cut behind lines written anew are part of the path now: their
    /// blocks become comments.
    pub(super) fn replace_corners(&mut self, raw: &[Line<'_>]) {
        for pair in 0..raw.len() {
            let number = raw[pair].number;
            if !self.rewritten.contains(&number) {
                continue;
            }
            for line in &raw[pair + 1..] {
                let Ok(block) = KlartextBlock::of(*line) else { break };
                if block.statement.is_corner() {
                    let text = self.original(line.number).klartext().map(|l| l.commented());
                    text.into_iter().for_each(|text| {
                        self.replaced.insert(line.number, vec![text]);
                    });
                }
                if block.statement != Statement::Empty {
                    break;
                }
            }
        }
    }
}
