//! Goes through the original line by line and writes the corrected text.
//!
//! The contour comes in one or more stretches of consecutive lines (a pass each). Before a stretch the moves that lead
//! to its start are displaced ([`approach`](super::approach)), on it every line is written anew
//! ([`stretch`](super::stretch)), after it whatever depended on its end is put right
//! ([`departure`](super::departure)).

use std::collections::{BTreeMap, BTreeSet};

use truepath_core::gcode::{Line, Lines, program_crc};
use truepath_ground::diagnostics::{Failure, Source};

use super::centre_path;
use super::edit::{BlockEdit, RewriteOptions};
use super::header;
use super::klartext;
use super::line::{Block, Manner};
use super::survey::Move;
use super::writer::{Replaced, Writer};
use crate::codes::P008;

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

/// Writes the program; `tolerances` are those of the edits, nm.
pub(super) fn write(
    source: &Source,
    moves: &[Move],
    edits: &[BlockEdit],
    tolerances: &[f64],
    options: &RewriteOptions,
) -> Result<Written, Failure> {
    let raw: Vec<Line<'_>> = Lines::new(source.bytes()).collect();
    let conversational = options.program.dialect.is_klartext();
    let mut manner = Manner { two_digits: false, klartext: conversational };
    manner.two_digits = raw.iter().map(|&l| Block::new(l, manner)).any(|b| b.motion_word().is_some() && b.two_digits());
    let compensated = centre_path::stretches(moves, edits);
    let noted = (!compensated.is_empty()).then(|| centre_path::noted(options, source.bytes()));
    let options = noted.as_ref().unwrap_or(options);
    let switches = centre_path::without_switches(&raw, moves, &compensated, manner);
    let stripped = switches.as_ref().cloned().unwrap_or_default();
    let text = |l: &Line<'_>| stripped.get(&l.number).map(Vec::as_slice);
    let lines: Vec<Line<'_>> = raw.iter().map(|l| Line { text: text(l).unwrap_or(l.text), ..*l }).collect();
    let replaced: Replaced = stripped.iter().map(|(&line, text)| (line, vec![text.clone()])).collect();
    let centre = BTreeSet::new();
    let mut writer = Writer {
        source,
        lines,
        options,
        replaced,
        manner,
        motion: None,
        unchanged: 0,
        centre,
        rewritten: BTreeSet::new(),
        feed: None,
    };
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
            let found = "this line of the contour comes before the one it follows, or does not cut in the plane";
            let wanted = "lines of the contour in the order in which they are cut";
            return Err(writer.refusal(P008, edit.line, [found, wanted, P008.remedy]));
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
    if conversational {
        writer.replace_corners(&raw);
        klartext::with_poles(&raw, &mut writer.replaced);
    }
    let (text, head) = assemble(source.bytes(), &raw, &writer.replaced, options);
    let touched = writer.replaced.iter().map(|(&line, parts)| (line, parts.len())).collect();
    Ok(Written { text, head, touched, unchanged: writer.unchanged, centre_path: !compensated.is_empty() })
}

/// The bytes of the program, and the mark with the line of the original it stands after.
fn assemble(
    program: &[u8],
    lines: &[Line<'_>],
    replaced: &Replaced,
    options: &RewriteOptions,
) -> (Vec<u8>, (u32, Vec<u8>)) {
    let next_starts = lines.iter().skip(1).map(|l| l.start).chain([program.len()]);
    let ends: Vec<&[u8]> = lines.iter().zip(next_starts).map(|(l, next)| &program[l.span().end()..next]).collect();
    let usual = ends.iter().copied().find(|end| !end.is_empty()).unwrap_or(b"\n");
    let head = header::text(options.origin.program.unwrap_or_else(|| program_crc(program)), options, usual);
    let head_after = header::place(program, options.program.dialect);

    let mut text = program[..lines.first().map_or(0, |l| l.start)].to_vec();
    if head_after == 0 {
        text.extend_from_slice(&head);
    }
    for (line, end) in lines.iter().zip(ends) {
        let single = [line.text.to_vec()];
        let parts = replaced.get(&line.number).map_or(&single[..], Vec::as_slice);
        for (index, part) in parts.iter().enumerate() {
            text.extend_from_slice(part);
            // Only the last line of a file can be without an end.
            text.extend_from_slice(if index + 1 < parts.len() && end.is_empty() { usual } else { end });
        }
        if line.number == head_after {
            text.extend_from_slice(&head);
        }
    }
    if options.program.dialect.is_klartext()
        && let Some(first) = klartext::first_number(program)
    {
        text = klartext::numbered(&text, first, klartext::continues);
    }
    (text, (head_after, head))
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
