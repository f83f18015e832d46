//! Puts the lines of the corrected program together: kept, replaced, and the mark at the head.

use std::collections::{BTreeMap, BTreeSet};
use std::ops::RangeInclusive;

use truepath_core::gcode::{Line, Lines, program_crc};

use super::{BlockEdit, RewriteOptions, header};

/// New text of a line: one or more lines without their ends.
pub(super) type Replaced = BTreeMap<u32, Vec<Vec<u8>>>;

/// The bytes of the program, and which of its lines came from each edit.
pub(super) fn assemble(
    program: &[u8],
    lines: &[Line<'_>],
    replaced: &Replaced,
    edits: &[BlockEdit],
    options: &RewriteOptions,
) -> (Vec<u8>, Vec<RangeInclusive<u32>>) {
    let next_starts = lines.iter().skip(1).map(|l| l.start).chain([program.len()]);
    let ends: Vec<&[u8]> = lines.iter().zip(next_starts).map(|(l, next)| &program[l.span().end()..next]).collect();
    let usual = ends.iter().copied().find(|end| !end.is_empty()).unwrap_or(b"\n");
    let head = header::text(program_crc(program), options.tolerance, &options.notes, usual);
    let head_after = header::place(program);
    let edited: BTreeSet<u32> = edits.iter().map(|edit| edit.line).collect();

    let mut text = program[..lines.first().map_or(0, |l| l.start)].to_vec();
    let mut ranges = Vec::new();
    let mut written = 0;
    if head_after == 0 {
        text.extend_from_slice(&head);
        written += Lines::new(&head).count() as u32;
    }
    for (line, end) in lines.iter().zip(ends) {
        let begin = written + 1;
        let single = [line.text.to_vec()];
        let parts = replaced.get(&line.number).map_or(&single[..], Vec::as_slice);
        for (index, part) in parts.iter().enumerate() {
            text.extend_from_slice(part);
            // Only the last line of a file can be without an end.
            text.extend_from_slice(if index + 1 < parts.len() && end.is_empty() { usual } else { end });
            written += 1;
        }
        if edited.contains(&line.number) {
            ranges.push(begin..=written);
        }
        if line.number == head_after {
            text.extend_from_slice(&head);
            written += Lines::new(&head).count() as u32;
        }
    }
    (text, ranges)
}
