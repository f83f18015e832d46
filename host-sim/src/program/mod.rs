//! The corrected program: the original text in which only the contour moves.
//!
//! Each line of the contour becomes one or more lines and arcs fitted to the corrected centre path ([`fit`]). Block
//! numbers, comments, feeds, spelling and line ends stay; every other line keeps its bytes, except that
//! * the moves that lead to the contour's start end at the corrected start,
//! * in incremental programs the first XY move after the contour makes up for the displaced end,
//! * a move that relied on the modal code of the last contour line gets that code written out, and
//! * a comment marks the program, and a marked program is refused: a correction must never be applied twice.
//!
//! The written text is read back with the same interpreter and compared with the samples; the result says how far it
//! is off.
//!
//! Limits: G17, one contour; coordinates are written with four decimals of a millimetre or six of an inch.

mod assemble;
mod deviation;
mod fit;
mod grid;
mod header;
mod line;
mod pen;
mod survey;
mod vector;
mod writer;

use std::ops::Range;

use truepath_core::gcode::{Options, is_marked_corrected};
use truepath_core::units::Offset;

use crate::diagnostics::{Failure, InputError, Source};

pub use fit::{Piece, Samples, Shape, fit};
pub use grid::Grid;

/// The corrected path of one line of the contour.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BlockEdit {
    /// The line of the original program, counted from 1.
    pub line: u32,
    /// Points of the corrected centre path in program coordinates, nm, from the start of the block to its end and about
    /// 0.1 mm apart. The first one is the last one of the block before.
    pub samples: Vec<[i64; 2]>,
}

/// How the corrected program is written.
#[derive(Clone, Debug, Default)]
pub struct RewriteOptions {
    /// How far the written path may leave the samples, 0.1 µm…0.1 mm. The rounding of the coordinates (50 nm) is
    /// taken from it.
    pub tolerance: Offset,
    /// What the program does not say.
    pub program: Options,
    /// Remarks for the head of the program, one comment each.
    pub notes: Vec<String>,
}

/// The corrected program and what it took.
#[derive(Clone, Debug)]
pub struct Rewritten {
    /// The bytes of the file.
    pub text: Vec<u8>,
    /// Lines (G1) written for the contour.
    pub lines: usize,
    /// Arcs (G2, G3) written for the contour.
    pub arcs: usize,
    /// Contour lines kept as they were, because they did not move.
    pub unchanged: usize,
    /// The largest distance of a sample from the written path, as read back, nm.
    pub max_deviation_nm: f64,
}

/// Writes a corrected program. `edits` are in the order of the program, one for every line of the contour.
///
/// # Errors
/// `P001` for a program that is corrected already, `P002` when no XY move of the program leads to the start of the
/// contour, `P003` when an arc begins where the contour ends, the interpreter's own errors; internal when the edits do
/// not belong to the program.
pub fn rewrite_program(source: &Source, edits: &[BlockEdit], options: &RewriteOptions) -> Result<Rewritten, Failure> {
    let original = source.bytes();
    if is_marked_corrected(original) {
        let help = "correct the original program; its CRC-32 is in the comment";
        return Err(InputError::new(
            "P001",
            "the program carries the mark TRUEPATH CORRECTED",
            "an uncorrected program",
            help,
        )
        .at(source, mark(original))
        .into());
    }
    let moves = survey::survey(original, options.program).map_err(|e| InputError::of_program(source, &e))?;
    let written = writer::write(source, &moves, edits, options)?;
    let after = survey::survey(&written.text, options.program)
        .map_err(|e| Failure::Internal(format!("the written program cannot be read back: {e}")))?;
    let mut max_deviation_nm = 0.0f64;
    for ((edit, lines), ends) in edits.iter().zip(&written.ranges).zip(&written.piece_ends) {
        let curves: Vec<_> = after.iter().filter(|m| lines.contains(&m.line)).filter_map(survey::Move::curve).collect();
        if curves.len() != ends.len() {
            return Err(Failure::Internal(format!("line {} is read back as another path", edit.line)));
        }
        let mut start = 0;
        for (curve, &end) in curves.iter().zip(ends) {
            max_deviation_nm = max_deviation_nm.max(deviation::deviation(&edit.samples[start..=end], curve));
            start = end;
        }
    }
    Ok(Rewritten {
        text: written.text,
        lines: written.lines,
        arcs: written.arcs,
        unchanged: written.unchanged,
        max_deviation_nm,
    })
}

/// Where the mark stands.
fn mark(program: &[u8]) -> Range<usize> {
    let word = b"TRUEPATH";
    let upper = program.to_ascii_uppercase();
    let at = upper.windows(word.len()).position(|w| w == word).unwrap_or(0);
    at..(at + word.len()).min(program.len())
}
