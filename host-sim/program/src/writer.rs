//! Goes through the original line by line and writes the corrected text.
//!
//! The contour comes in one or more stretches of consecutive lines (a pass each). Before a stretch the moves that lead
//! to its start are displaced ([`approach`](super::approach)), on it every line is written anew
//! ([`stretch`](super::stretch)), after it whatever depended on its end is put right
//! ([`departure`](super::departure)).

use std::collections::{BTreeMap, BTreeSet};

use truepath_core::gcode::{Line, Lines, Motion};
use truepath_ground::diagnostics::{Failure, InputError, Source};

use super::assemble::{Replaced, assemble};
use super::feed::Scheduled;
use super::line::Block;
use super::pen::Pen;
use super::survey::Move;
use super::{BlockEdit, RewriteOptions, centre_path};

/// The written text and which lines of the original it changes.
pub(super) struct Written {
    pub(super) text: Vec<u8>,
    /// The line of the original after which the mark stands, and the mark.
    pub(super) head: (u32, Vec<u8>),
    /// How many lines each changed line has become.
    pub(super) touched: BTreeMap<u32, usize>,
    /// Lines of the contour that stay.
    pub(super) unchanged: usize,
    /// Whether the control's compensation has been taken out of the contour.
    pub(super) centre_path: bool,
}

/// What has been written so far.
pub(super) struct Writer<'a> {
    source: &'a Source,
    lines: Vec<Line<'a>>,
    pub(super) options: &'a RewriteOptions,
    pub(super) replaced: Replaced,
    two_digits: bool,
    /// The motion in force in the written text.
    pub(super) motion: Option<Motion>,
    pub(super) unchanged: usize,
    /// Lines whose words lead beside the path of the cutter's centre: they are never kept.
    pub(super) centre: BTreeSet<u32>,
    /// The feed in force in the written text, where it is another one than in the program.
    pub(super) feed: Option<Scheduled>,
}

/// Writes the program; `tolerances` are those of the edits, nm.
pub(super) fn write(
    source: &Source,
    moves: &[Move],
    edits: &[BlockEdit],
    tolerances: &[f64],
    options: &RewriteOptions,
) -> Result<Written, Failure> {
    let raw: Vec<Line<'_>> = Lines::new(source.bytes()).collect();
    let two_digits = raw.iter().map(|&l| Block::new(l, false)).any(|b| b.motion_word().is_some() && b.two_digits());
    let compensated = centre_path::stretches(moves, edits);
    let noted = centre_path::noted(options);
    let options = if compensated.is_empty() { options } else { &noted };
    let switches = centre_path::without_switches(&raw, moves, &compensated);
    let stripped = switches.as_ref().cloned().unwrap_or_default();
    let text = |l: &Line<'_>| stripped.get(&l.number).map(Vec::as_slice);
    let lines: Vec<Line<'_>> = raw.iter().map(|l| Line { text: text(l).unwrap_or(l.text), ..*l }).collect();
    let replaced: Replaced = stripped.iter().map(|(&line, text)| (line, vec![text.clone()])).collect();
    let centre = BTreeSet::new();
    let mut writer =
        Writer { source, lines, options, replaced, two_digits, motion: None, unchanged: 0, centre, feed: None };
    if edits.is_empty() {
        return Err(Failure::Internal("there is no line to correct".to_owned()));
    }
    writer.refuse_repetition(moves, edits.iter().map(|edit| edit.line))?;
    if let Err(line) = switches {
        let found = "the control compensates this path (G41, G42), switched on by no line before it";
        return Err(writer.refuse_compensation(line, found));
    }
    writer.write_centre_path(moves, &compensated, edits)?;
    let mut edits: Vec<_> = edits.iter().zip(tolerances.iter().copied()).collect();
    edits.reverse();
    let (mut at, mut end) = (0, None);
    while let Some(&(edit, _)) = edits.last() {
        let Some(first) = moves[at..].iter().position(|m| m.line == edit.line && m.cuts()).map(|i| at + i) else {
            moves.iter().try_for_each(|m| writer.refuse_other_file(m))?;
            let text = format!("line {} is out of order or does not cut in the plane", edit.line);
            return Err(Failure::Internal(text));
        };
        let displaced = match end {
            Some(pen) => writer.depart(pen, &moves[at - 1], &moves[at..first])?,
            None => None,
        };
        let mut pen = writer.approach(&moves[at..first], &moves[first], edit, displaced)?;
        at = writer.stretch(&mut pen, moves, first, &mut edits)?;
        end = Some(pen);
    }
    if let Some(pen) = end {
        writer.depart(pen, &moves[at - 1], &moves[at..])?;
    }
    writer.refuse_repetition(moves, writer.replaced.keys().copied())?;
    let (text, head) = assemble(source.bytes(), &raw, &writer.replaced, options);
    let touched = writer.replaced.iter().map(|(&line, parts)| (line, parts.len())).collect();
    Ok(Written { text, head, touched, unchanged: writer.unchanged, centre_path: !compensated.is_empty() })
}

impl<'a> Writer<'a> {
    /// A line as it was.
    pub(super) fn original(&self, number: u32) -> Block<'a> {
        Block::new(self.line(number), self.two_digits)
    }
    /// Its text; nothing for a line of another file.
    fn line(&self, number: u32) -> Line<'a> {
        let index = (number as usize).checked_sub(1);
        index.and_then(|i| self.lines.get(i)).copied().unwrap_or(Line { number, start: 0, text: &[] })
    }
    /// A line as it stands now.
    pub(super) fn block(&self, number: u32) -> Block<'_> {
        let line = match self.replaced.get(&number).and_then(|lines| lines.first()) {
            Some(text) => Line { number, start: 0, text },
            None => self.line(number),
        };
        Block::new(line, self.two_digits)
    }
    pub(super) fn refusal(&self, code: &str, line: u32, texts: [&str; 3]) -> Failure {
        let span = self.line(line).span();
        let [found, expected, help] = texts;
        InputError::new(code, found, expected, help).at(self.source, span.start..span.end()).into()
    }

    /// A line that the program executes several times, or that stands in another file, cannot be edited in place.
    fn refuse_repetition(&self, moves: &[Move], lines: impl Iterator<Item = u32>) -> Result<(), Failure> {
        const HELP: &str = "use --route coprocessor, or post the program without subprograms and loops";
        for line in lines {
            let mut times = moves.iter().filter(|m| m.line == line).map(|m| m.jumps);
            let first = times.next();
            if line == 0 || times.any(|jumps| Some(jumps) != first) {
                let found = if line == 0 {
                    "a line of the contour, or one that leads to or from it, stands in another file"
                } else {
                    "this line is executed several times (a loop or a subprogram), with one correction for each"
                };
                return Err(self.refusal("P004", line, [found, "lines of this file that are executed once", HELP]));
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
        let value = |axis: usize, letter| block.word(letter).map(|_| pen.value(axis, pen.at[axis]));
        let values = [value(0, b'X'), value(1, b'Y')];
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
        let mut text = None;
        if step.modal.absolute {
            let value = |axis: usize, letter| {
                (block.word(letter).is_some() || by[axis] != 0.0).then(|| pen.value(axis, target[axis]))
            };
            text = Some(block.repositioned([value(0, b'X'), value(1, b'Y')]));
        }
        if step.modal.absolute_centres
            && let Some(curve) = step.curve()
            && let truepath_core::geometry::Shape::Arc { centre, .. } = curve.shape()
        {
            let line = Line { number: step.line, start: 0, text: text.as_deref().unwrap_or_else(|| block.text()) };
            let centre = [centre.x.nm() as f64 + by[0], centre.y.nm() as f64 + by[1]];
            let grid = pen.grid();
            text = Some(
                Block::new(line, self.two_digits)
                    .with_values([(b'I', 0), (b'J', 1)].map(|(l, axis)| (l, grid.text(grid.steps_of(centre[axis]))))),
            );
        }
        if let Some(text) = text {
            self.replaced.insert(step.line, vec![text]);
        }
        Some(Pen::new(target, &step.modal))
    }
}

#[cfg(test)]
mod tests {
    use super::super::survey::survey;
    use super::*;

    #[test]
    fn a_line_of_the_contour_that_comes_again_is_refused_and_so_is_one_of_another_file() {
        let source = Source::new("loop.nc", b"G21 G90 G0 X0 Y0\nG1 X10 F100\nG0 X0\nM2\n".to_vec());
        let options = RewriteOptions::default();
        let edits = [BlockEdit::new(2, vec![[0, 100_000], [10_000_000, 100_000]])];
        let once = survey(source.bytes(), options.program).expect("a readable program");
        let written = |moves: &[Move]| write(&source, moves, &edits, &[1_000.0], &options);
        assert!(written(&once).is_ok());

        let again: Vec<Move> =
            once.iter().chain(&once).enumerate().map(|(i, m)| Move { jumps: i as u32 / 3, ..*m }).collect();
        let elsewhere: Vec<Move> =
            once.iter().map(|m| Move { line: if m.line == 1 { 0 } else { m.line }, ..*m }).collect();
        for (moves, line) in [(again, 2), (elsewhere, 1)] {
            let Err(Failure::Input(error)) = written(&moves) else { panic!("an input error") };
            assert_eq!((error.code(), error.line_column()), ("P004", Some((line, 1))), "{error}");
        }
    }
}
