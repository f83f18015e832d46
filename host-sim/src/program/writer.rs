//! Goes through the original line by line and writes the corrected text.
//!
//! Before the contour: the moves that lead to its start. On it: one edit a line. After it: whatever depended on the
//! end that has moved. A move inside the contour that stands still (programs repeat points) follows the pen.

use std::collections::BTreeMap;

use truepath_core::gcode::{Line, Lines, Motion};
use truepath_core::geometry::Curve;
use truepath_core::units::Offset;

use super::assemble::{Replaced, assemble};
use super::deviation::deviation;
use super::fit::{Piece, Samples, Shape, fit};
use super::line::Block;
use super::pen::{Pen, place};
use super::spacing::bulges;
use super::survey::{Kind, Move};
use super::{BlockEdit, RewriteOptions};
use crate::diagnostics::{Failure, InputError, Source};

/// The written text and which lines of the original it changes.
pub(super) struct Written {
    pub(super) text: Vec<u8>,
    /// The line of the original after which the mark stands, and the mark.
    pub(super) head: (u32, Vec<u8>),
    /// How many lines each changed line has become.
    pub(super) touched: BTreeMap<u32, usize>,
    /// Lines of the contour that stay.
    pub(super) unchanged: usize,
}

struct Writer<'a> {
    source: &'a Source,
    lines: Vec<Line<'a>>,
    options: &'a RewriteOptions,
    replaced: Replaced,
    two_digits: bool,
    motion: Option<Motion>,
    unchanged: usize,
}

/// Writes the program.
pub(super) fn write(
    source: &Source,
    moves: &[Move],
    edits: &[BlockEdit],
    options: &RewriteOptions,
) -> Result<Written, Failure> {
    let lines: Vec<Line<'_>> = Lines::new(source.bytes()).collect();
    let two_digits = lines.iter().map(|&l| Block::new(l, false)).any(|b| b.motion_word().is_some() && b.two_digits());
    let mut writer =
        Writer { source, lines, options, replaced: Replaced::new(), two_digits, motion: None, unchanged: 0 };
    let (Some(first_edit), Some(last_edit)) = (edits.first(), edits.last()) else {
        return Err(Failure::Internal("there is no line to correct".to_owned()));
    };
    let index_of = |line: u32| moves.iter().position(|m| m.line == line && m.cuts());
    let (Some(first), Some(last)) = (index_of(first_edit.line), index_of(last_edit.line)) else {
        return Err(Failure::Internal("the first or last line to correct does not cut in the plane".to_owned()));
    };
    let mut pen = writer.lead(&moves[..first], &moves[first], first_edit)?;
    writer.motion = moves[first].motion_before;
    let mut edits_left = edits.iter();
    for step in &moves[first..=last] {
        if step.cuts() {
            match edits_left.next() {
                Some(edit) if edit.line == step.line => writer.edit(&mut pen, step, edit)?,
                _ => return Err(Failure::Internal(format!("line {} of the contour has no corrected path", step.line))),
            }
        } else {
            writer.follow(pen.under(&step.modal), step);
        }
    }
    if let Some(edit) = edits_left.next() {
        return Err(Failure::Internal(format!("line {} is out of order or not part of the contour", edit.line)));
    }
    writer.leave(pen, &moves[last + 1..])?;
    let (text, head) = assemble(source.bytes(), &writer.lines, &writer.replaced, options);
    let touched = writer.replaced.iter().map(|(&line, parts)| (line, parts.len())).collect();
    Ok(Written { text, head, touched, unchanged: writer.unchanged })
}

impl<'a> Writer<'a> {
    fn line(&self, number: u32) -> Line<'a> {
        self.lines[number as usize - 1]
    }
    /// A line as it stands now.
    fn block(&self, number: u32) -> Block<'_> {
        let line = match self.replaced.get(&number).and_then(|lines| lines.first()) {
            Some(text) => Line { number, start: 0, text },
            None => self.line(number),
        };
        Block::new(line, self.two_digits)
    }
    fn refusal(&self, code: &str, line: u32, texts: [&str; 3]) -> Failure {
        let span = self.line(line).span();
        let [found, expected, help] = texts;
        InputError::new(code, found, expected, help).at(self.source, span.start..span.end()).into()
    }

    /// Leads the moves before the contour to its corrected start.
    fn lead(&mut self, before: &[Move], first: &Move, edit: &BlockEdit) -> Result<Pen, Failure> {
        let (Some(from), Some(&to)) = (place(first.from), edit.samples.first()) else {
            return Err(Failure::Internal("the contour has no start".to_owned()));
        };
        let start = Pen::new(from.map(|v| v as f64), &first.modal);
        if start.is_at(to) {
            return Ok(start);
        }
        const EXPECTED: [&str; 2] = [
            "a G0 or G1 move in X and Y to the start of the contour",
            "give the contour's start with G0 X Y before it",
        ];
        for step in before.iter().rev() {
            let block = self.block(step.line);
            let named = [b'X', b'Y'].map(|letter| block.word(letter).is_some());
            if !matches!(step.kind, Kind::Traverse | Kind::Feed) {
                let found = "the move to the start of the contour cannot be changed";
                return Err(self.refusal("P002", step.line, [found, EXPECTED[0], EXPECTED[1]]));
            }
            if named == [false, false] {
                continue;
            }
            let still = step.stands_still();
            let pen = Pen::new(place(step.from).unwrap_or(from).map(|v| v as f64), &step.modal);
            let target = pen.nearest(to);
            if step.modal.absolute || !still {
                let values = [0, 1].map(|axis| (named[axis] || !still).then(|| pen.value(axis, target[axis])));
                let text = block.repositioned(values);
                self.replaced.insert(step.line, vec![text]);
            }
            if !still {
                return Ok(Pen::new(target, &first.modal));
            }
        }
        Err(self.refusal("P002", first.line, ["no move leads to the start of the contour", EXPECTED[0], EXPECTED[1]]))
    }

    /// Writes one line of the contour.
    fn edit(&mut self, pen: &mut Pen, step: &Move, edit: &BlockEdit) -> Result<(), Failure> {
        *pen = pen.under(&step.modal);
        let (Some(&first), Some(from), Some(to), Some(curve)) =
            (edit.samples.first(), place(step.from), place(step.to), step.curve())
        else {
            return Err(Failure::Internal(format!("line {} has no corrected path", edit.line)));
        };
        let gap = [0, 1].map(|axis| (first[axis] as f64 - pen.at[axis]).abs());
        if gap[0].max(gap[1]) > (self.options.tolerance.nm() as f64).max(200.0) {
            return Err(Failure::Internal(format!("the corrected path jumps at line {}", edit.line)));
        }
        let last = edit.samples[edit.samples.len() - 1];
        let tolerance = self.options.tolerance.nm() as f64;
        let end = Pen::new(last.map(|v| v as f64), &step.modal);
        if pen.is_at(from) && end.is_at(to) && deviation(&edit.samples, &curve) <= 0.5 * tolerance {
            let motion = step.modal.motion;
            if self.motion != motion && self.block(step.line).motion_word().is_none() {
                self.state_motion(step);
            }
            self.motion = motion;
            pen.at = to.map(|v| v as f64);
            self.unchanged += 1;
            return Ok(());
        }
        let step_nm = pen.grid().step_nm();
        let (pieces, points) =
            pieces(pen, &edit.samples, &curve, (tolerance - step_nm).max(0.5 * tolerance), self.options.max_arc_radius);
        let block = Block::new(self.line(step.line), self.two_digits);
        let mut text = Vec::new();
        for (index, (piece, target)) in pieces.iter().zip(&points).enumerate() {
            let motion = match piece.shape {
                Shape::Line => Motion::Feed,
                Shape::Arc { counter_clockwise, .. } => Motion::Arc { counter_clockwise },
            };
            let words = pen.draw(*target, &piece.shape);
            let more = index + 1 < pieces.len();
            text.push(if index == 0 {
                block.moved(motion, self.motion != Some(motion), &words, more)
            } else {
                block.further(motion, &words, !more)
            });
            self.motion = Some(motion);
        }
        self.replaced.insert(step.line, text);
        Ok(())
    }

    /// Keeps a move that stands still in the plane where the pen is.
    fn follow(&mut self, pen: Pen, step: &Move) {
        let block = self.block(step.line);
        if step.modal.absolute && !place(step.from).is_some_and(|from| pen.is_at(from)) {
            let values =
                [(0, b'X'), (1, b'Y')].map(|(axis, letter)| block.word(letter).map(|_| pen.value(axis, pen.at[axis])));
            if values.iter().any(Option::is_some) {
                let text = block.repositioned(values);
                self.replaced.insert(step.line, vec![text]);
            }
        }
        self.state_motion(step);
    }

    /// Writes out the motion of a move that relied on the code of an earlier line, where that is another one now.
    fn state_motion(&mut self, step: &Move) {
        let Some(motion) = step.modal.motion else { return };
        let block = self.block(step.line);
        if self.motion != Some(motion) && block.motion_word().is_none() {
            let text = block.with_motion(motion);
            self.replaced.insert(step.line, vec![text]);
        }
        self.motion = Some(motion);
    }

    /// Makes up, after the contour, for its displaced end.
    fn leave(&mut self, mut pen: Pen, after: &[Move]) -> Result<(), Failure> {
        if let Some(next) = after.iter().find(|m| !matches!(m.kind, Kind::Reference)) {
            self.state_motion(next);
        }
        for step in after {
            pen = pen.under(&step.modal);
            let (Some(from), Some(to)) = (place(step.from), place(step.to)) else { break };
            if pen.is_at(from) {
                break;
            }
            if step.stands_still() {
                self.follow(pen, step);
                continue;
            }
            if matches!(step.kind, Kind::Arc(_)) {
                let found = "an arc begins where the corrected contour ends, and its centre would no longer fit";
                let texts = [found, "a line after the contour", "put a short G1 move between the contour and this arc"];
                return Err(self.refusal("P003", step.line, texts));
            }
            let block = self.block(step.line);
            if !step.modal.absolute {
                let value = |(axis, letter)| {
                    let value = pen.value(axis, to[axis] as f64);
                    (block.word(letter).is_some() || value != pen.grid().text(0)).then_some(value)
                };
                let values = [(0, b'X'), (1, b'Y')].map(value);
                let text = block.repositioned(values);
                self.replaced.insert(step.line, vec![text]);
                break;
            }
            // An axis the line does not name stays displaced, in the program as at the machine.
            for (axis, letter) in [b'X', b'Y'].into_iter().enumerate() {
                if block.word(letter).is_some() {
                    pen.at[axis] = to[axis] as f64;
                }
            }
        }
        Ok(())
    }
}

/// Pieces through the samples from where the pen is, in program coordinates, and the places they end at.
fn pieces(
    pen: &Pen,
    samples: &[[i64; 2]],
    curve: &Curve,
    tolerance: f64,
    max_radius: Offset,
) -> (Vec<Piece>, Vec<[f64; 2]>) {
    let origin = samples[0];
    let shift = origin.map(|v| v as f64);
    let path: Vec<_> = samples.iter().map(|s| [(s[0] - origin[0]) as f64, (s[1] - origin[1]) as f64]).collect();
    let places: Vec<_> = std::iter::once(pen.at).chain(samples.iter().skip(1).map(|&s| pen.nearest(s))).collect();
    let written: Vec<_> = places.iter().map(|p| [p[0] - shift[0], p[1] - shift[1]]).collect();
    let max_radius = max_radius.nm() as f64;
    let curvature = curve.signed_radius().map_or(0.0, |r| 1.0 / (r.nm().abs() as f64).max(1.0));
    let bulges = bulges(&path, curvature);
    let mut pieces = fit(Samples { path: &path, written: &written, bulges: &bulges, max_radius }, tolerance);
    if pieces.is_empty() {
        pieces.push(Piece { end: samples.len() - 1, shape: Shape::Line });
    }
    for piece in &mut pieces {
        if let Shape::Arc { centre, .. } = &mut piece.shape {
            *centre = [centre[0] + shift[0], centre[1] + shift[1]];
        }
    }
    let ends = pieces.iter().map(|p| places[p.end]).collect();
    (pieces, ends)
}
