//! Puts the lines of the corrected program together: kept, replaced, and the mark at the head.

use std::collections::BTreeMap;

use truepath_core::gcode::{Line, program_crc};

use super::edit::RewriteOptions;
use super::header;

/// New text of a line: one or more lines without their ends.
pub(super) type Replaced = BTreeMap<u32, Vec<Vec<u8>>>;

/// The bytes of the program, and the mark with the line of the original it stands after.
pub(super) fn assemble(
    program: &[u8],
    lines: &[Line<'_>],
    replaced: &Replaced,
    options: &RewriteOptions,
) -> (Vec<u8>, (u32, Vec<u8>)) {
    let next_starts = lines.iter().skip(1).map(|l| l.start).chain([program.len()]);
    let ends: Vec<&[u8]> = lines.iter().zip(next_starts).map(|(l, next)| &program[l.span().end()..next]).collect();
    let usual = ends.iter().copied().find(|end| !end.is_empty()).unwrap_or(b"\n");
    let head = header::text(program_crc(program), options, usual);
    let head_after = header::place(program);

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
    (text, (head_after, head))
}
