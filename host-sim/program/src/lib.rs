//! The corrected program: the original text in which only the contour moves.
//!
//! Each line of the contour becomes one or more lines and arcs fitted to the corrected centre path ([`fit`]). Block
//! numbers, comments, spelling and line ends stay, and so do feeds, unless others are asked for (`feed`); every other line keeps its bytes, except that
//! * the moves that lead to the contour's start end at the corrected start,
//! * lead-in and lead-out arcs outside the contour are displaced as a whole, so that they stay tangent,
//! * the first straight XY move after the contour returns to its own place, an axis it does not name being added,
//! * where the control compensates the contour (G41, G42) it becomes the path of the centre (`centre_path`),
//! * a move that relied on the modal code of the last contour line gets that code written out, and
//! * a comment marks the program, and a marked program is refused: a correction must never be applied twice.
//!
//! The written text is then read back and proved (`proof`) to differ from the original in the contour and in nothing
//! else; what fails the proof is not written. [`Difference`] reports what was counted on the way.
//!
//! The contour may come in several stretches (passes), each written once: a line that is executed several times is
//! refused.
//!
//! Limits: G17; coordinates are written with four decimals of a millimetre or six of an inch.

mod approach;
pub mod canon;
mod centre_path;
pub mod codes;
mod departure;
mod deviation;
mod difference;
mod edit;
mod feed;
mod fit;
mod grid;
mod header;
mod klartext;
mod line;
pub mod passes;
mod pen;
mod proof;
mod spacing;
mod stretch;
mod survey;
mod unproved;
mod unrolled;
mod vector;
mod writer;
mod written;

use std::ops::Range;

use truepath_core::gcode::{LineRange, is_marked_corrected};
use truepath_ground::diagnostics::{Failure, InputError, Source};

use crate::codes::P001;

pub use difference::{Difference, Shift};
pub use edit::{BlockEdit, FeedFrom, Origin, Purpose, RewriteOptions};
pub use fit::{Piece, Samples, Shape, fit};
pub use grid::Grid;
pub use header::first_pass_of;
pub use unrolled::unrolled;

/// The corrected program and what it took.
#[derive(Clone, Debug)]
pub struct Rewritten {
    /// The bytes of the file.
    pub text: Vec<u8>,
    /// What is different.
    pub difference: Difference,
    /// Lines of the original behind which lines were added, with their number, in order.
    pub added: Vec<(u32, u32)>,
}

impl Rewritten {
    /// Where lines of the original stand in the written text, with everything they have become.
    pub fn lines(&self, original: LineRange) -> LineRange {
        let behind = |holds: &dyn Fn(u32) -> bool| {
            self.added.iter().filter(|(line, _)| holds(*line)).map(|(_, count)| count).sum::<u32>()
        };
        let [first, last] = [original.first, original.last];
        LineRange { first: first + behind(&|line| line < first), last: last + behind(&|line| line <= last) }
    }
}

/// Writes a corrected program. `edits` are in the order of the program, one for every line of the contour.
///
/// # Errors
/// `P001` for a program that is corrected already, `P002` when no move that can be displaced leads to the start of the
/// contour, `P003` when one that cannot be displaced (a G18 arc, a probing move) begins at its end, `P004` when a line
/// of the contour is executed several times, `P005` when the origin is set at the displaced end, `P006` for lines that
/// cannot be divided (G93, arcs of several turns), `P007` when the control's
/// cutter compensation cannot be taken out, `P008` when the edits do not belong to the program or the text fails the proof,
/// the interpreter's own errors.
pub fn rewrite_program(source: &Source, edits: &[BlockEdit], options: &RewriteOptions) -> Result<Rewritten, Failure> {
    let original = source.bytes();
    if is_marked_corrected(original) {
        return Err(P001
            .error("the program carries the mark TRUEPATH CORRECTED", "an uncorrected program")
            .at(source, mark(original))
            .into());
    }
    let moves = survey::survey(original, options.program).map_err(|e| InputError::of_program(source, &e))?;
    let edits = &joined(&moves, edits);
    let (written, proof) = within_kinks(source, &moves, edits, options)?;
    let changed = (written.touched.keys().copied(), written.unchanged, written.centre_path);
    let difference = Difference::new(original, &moves, edits, changed, &proof, options);
    let head = String::from_utf8_lossy(&written.head.1).lines().count();
    let mut added: Vec<(u32, u32)> = written.touched.iter().map(|(&line, &parts)| (line, parts as u32 - 1)).collect();
    added.push((written.head.0, head as u32));
    added.sort_unstable();
    Ok(Rewritten { text: written.text, difference, added })
}

/// Between two stretches the cutter may only plunge where it stands: a contour that begins at a corner, cut at several
/// depths. Then the second begins, at its own depth, with a step from the end of the first to its own start, as behind a
/// sharp corner.
fn joined(moves: &[survey::Move], edits: &[BlockEdit]) -> Vec<BlockEdit> {
    let mut edits = edits.to_vec();
    for at in 1..edits.len() {
        let [before, line] = [edits[at - 1].line, edits[at].line];
        let (Some(&end), Some(&start)) = (edits[at - 1].samples.last(), edits[at].samples.first()) else { continue };
        if start == end {
            continue;
        }
        let last = moves.iter().rposition(|m| m.line == before && m.cuts());
        let between =
            last.map_or(&[][..], |last| &moves[last + 1..]).iter().take_while(|m| m.line != line || !m.cuts());
        if between.into_iter().all(survey::Move::stands_still) {
            edits[at].samples.insert(0, end);
            edits[at].feeds.iter_mut().skip(1).for_each(|from| from.sample += 1);
        }
    }
    edits
}

/// Attempts to keep kinks below the limit.
const ATTEMPTS: usize = 6;

/// Writes, and again with a smaller tolerance for the lines whose kinks are too large: the heading steps between fitted
/// pieces shrink with it. The text within the limit is taken, else the first one: shorter pieces that turn as much are worth nothing.
fn within_kinks(
    source: &Source,
    moves: &[survey::Move],
    edits: &[BlockEdit],
    options: &RewriteOptions,
) -> Result<(written::Written, proof::Proof), Failure> {
    let step = moves.iter().map(|m| Grid::of(m.modal.units).step_nm()).fold(0.0, f64::max);
    let mut tolerances = vec![options.tolerance.nm() as f64; edits.len()];
    let mut first = None;
    for _ in 0..ATTEMPTS {
        let written = written::write(source, moves, edits, &tolerances, options)?;
        let claim = proof::Claim {
            original: source.bytes(),
            written: &written.text,
            touched: &written.touched,
            head: (written.head.0, &written.head.1),
            edits,
            program: options.program,
            tolerance: options.tolerance.nm() as f64,
            step,
            centre_path: written.centre_path,
        };
        let proof =
            proof::prove(&claim).map_err(|what| unproved::failure(source, edits, written.centre_path, &what))?;
        let mut largest = 0.0f64;
        let before = tolerances.clone();
        for kink in proof.kinks.iter().filter(|k| k.beyond > options.max_kink_deg) {
            largest = largest.max(kink.beyond);
            let from = if kink.at_start { kink.edit.saturating_sub(1) } else { kink.edit };
            for edit in from..=kink.edit {
                tolerances[edit] = (0.5 * before[edit]).max(2.0 * step);
            }
        }
        if largest == 0.0 {
            return Ok((written, proof));
        }
        first.get_or_insert((written, proof));
        if tolerances == before {
            break;
        }
    }
    first.ok_or_else(|| Failure::Internal("no attempt to write the program was made".to_owned()))
}

/// Where the mark stands.
fn mark(program: &[u8]) -> Range<usize> {
    let word = b"TRUEPATH";
    let upper = program.to_ascii_uppercase();
    let at = upper.windows(word.len()).position(|w| w == word).unwrap_or(0);
    at..(at + word.len()).min(program.len())
}
