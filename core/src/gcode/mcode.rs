//! The M codes of one block: which exclude each other, and what each kind does.
//!
//! LinuxCNC's modal groups 4 (stop), 6 (tool), 7 (spindle) and 8 (coolant). M97, M98 and M99 leave the sequence of blocks,
//! M70 to M73 change modes out of sight: they are refused; any other code is kept and passed on.

use super::block::BlockWords;
use super::{GcodeErrorKind, Span};

/// M codes kept per block; one more is an error.
pub(super) const M_LIMIT: usize = 8;

/// An M code with its place.
#[derive(Clone, Copy, Debug)]
pub(super) struct MCode {
    pub(super) number: u32,
    pub(super) span: Span,
}

/// The M codes of a block by what they do.
#[derive(Default)]
pub(super) struct MCodes {
    pub(super) stop: Option<MCode>,
    pub(super) tool: Option<MCode>,
    pub(super) spindle: Option<MCode>,
    pub(super) coolant: heapless::Vec<MCode, M_LIMIT>,
    pub(super) other: heapless::Vec<MCode, M_LIMIT>,
}

impl MCodes {
    /// Sorts them; two of one kind exclude each other, except M7 with M8 and codes that are not known.
    pub(super) fn sorted(block: &BlockWords) -> Result<Self, (GcodeErrorKind, Span)> {
        let mut sorted = Self::default();
        for &code in &block.m {
            let before = match code.number {
                0 | 1 | 2 | 30 => sorted.stop.replace(code),
                6 => sorted.tool.replace(code),
                3..=5 => sorted.spindle.replace(code),
                7..=9 => add(&mut sorted.coolant, code, |c| c.number == code.number || c.number.max(code.number) == 9),
                70..=73 => return Err((GcodeErrorKind::SavedModes { m: code.number }, code.span)),
                97..=99 => return Err((GcodeErrorKind::Subprogram { m: code.number }, code.span)),
                _ => add(&mut sorted.other, code, |_| false),
            };
            if let Some(first) = before {
                return Err((GcodeErrorKind::ConflictM { first: first.number, second: code.number }, code.span));
            }
        }
        Ok(sorted)
    }
}

/// Adds a code to a list; gives the one before that excludes it.
fn add(list: &mut heapless::Vec<MCode, M_LIMIT>, code: MCode, excludes: impl Fn(&MCode) -> bool) -> Option<MCode> {
    let before = list.iter().copied().find(excludes);
    // The list holds as many codes as a block, so this cannot fail.
    list.push(code).err().or(before)
}
