//! The M codes of one block: which exclude each other, and what each kind does.
//!
//! LinuxCNC's modal groups 4 (stop), 5 (inputs and outputs), 6 (tool), 7 (spindle), 8 (coolant), 9 (overrides), its
//! saving of modes, and the calls of Fanuc and Haas. Any other code is kept and passed on.

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
    pub(super) io: Option<MCode>,
    pub(super) tool: Option<MCode>,
    pub(super) spindle: Option<MCode>,
    pub(super) saved: Option<MCode>,
    pub(super) overrides: Option<MCode>,
    pub(super) call: Option<MCode>,
    pub(super) coolant: heapless::Vec<MCode, M_LIMIT>,
    pub(super) other: heapless::Vec<MCode, M_LIMIT>,
    any: bool,
}

impl MCodes {
    /// Sorts the codes of a block; two of one kind exclude each other, except M7 with M8 and codes that are not known.
    pub(super) fn sorted(codes: &[MCode]) -> Result<Self, (GcodeErrorKind, Span)> {
        let mut sorted = Self { any: !codes.is_empty(), ..Self::default() };
        for &code in codes {
            let before = match code.number {
                0 | 1 | 2 | 30 | 60 => sorted.stop.replace(code),
                62..=68 => sorted.io.replace(code),
                6 | 61 => sorted.tool.replace(code),
                3..=5 | 19 => sorted.spindle.replace(code),
                7..=9 => add(&mut sorted.coolant, code, |c| c.number == code.number || c.number.max(code.number) == 9),
                48..=53 => sorted.overrides.replace(code),
                70..=73 => sorted.saved.replace(code),
                97..=99 => sorted.call.replace(code),
                _ => add(&mut sorted.other, code, |_| false),
            };
            if let Some(first) = before {
                return Err((GcodeErrorKind::ConflictM { first: first.number, second: code.number }, code.span));
            }
        }
        Ok(sorted)
    }

    /// Whether the block has no M code.
    pub(super) const fn is_empty(&self) -> bool {
        !self.any
    }
}

/// Adds a code to a list; gives the one before that excludes it.
fn add(list: &mut heapless::Vec<MCode, M_LIMIT>, code: MCode, excludes: impl Fn(&MCode) -> bool) -> Option<MCode> {
    let before = list.iter().copied().find(excludes);
    // The list holds as many codes as a block, so this cannot fail.
    list.push(code).err().or(before)
}
