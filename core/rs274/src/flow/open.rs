//! What is open: calls, conditions and loops whose end is still to come.

use super::super::{FlowError, Lines};
use super::keyword::Label;
use super::place::Place;

/// Calls inside each other.
pub(super) const CALLS: usize = 10;

/// A call that has not returned.
#[derive(Clone, Debug)]
pub(super) struct Call<'p> {
    /// Where the caller goes on.
    pub(super) back: Place<'p>,
    /// Where the subprogram begins.
    pub(super) begin: Lines<'p>,
    /// Turns left behind this one.
    pub(super) turns: u32,
    pub(super) kind: CallKind,
}

/// What kind of subprogram was called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum CallKind {
    /// An O word's, which ends with `endsub`.
    Sub,
    /// M98, M97: with the local parameters of its caller.
    Program,
    /// G65: with local parameters of its own.
    Macro,
}

/// Conditions and loops that may be open at a time, all calls together.
const LIMIT: usize = 32;

/// A condition or a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Kind {
    If,
    While,
    Do,
    /// `repeat` with the turns that are left.
    Repeat(u32),
    /// `WHILE … DO1` or `DO1`.
    Macro,
}

/// One that is open.
#[derive(Clone, Debug)]
pub(super) struct Open<'p> {
    pub(super) label: Label,
    pub(super) kind: Kind,
    /// Its first line, and what follows it.
    pub(super) before: Lines<'p>,
    pub(super) behind: Lines<'p>,
    /// How deep in calls it stands.
    pub(super) depth: u8,
}

/// All that are open, the innermost last.
#[derive(Debug, Default)]
pub(super) struct OpenList<'p>(heapless::Vec<Open<'p>, LIMIT>);

impl<'p> OpenList<'p> {
    pub(super) fn open(&mut self, open: Open<'p>) -> Result<(), FlowError> {
        // A jump may have left it open the last time.
        self.close(open.label, open.depth);
        self.0.push(open).map_err(|_| FlowError::TooManyOpen { limit: LIMIT as u8 })
    }

    /// The innermost one with a label in this call.
    pub(super) fn find(&mut self, label: Label, depth: u8) -> Option<&mut Open<'p>> {
        self.0.iter_mut().rev().find(|o| o.label == label && o.depth == depth)
    }

    /// Closes one and all inside it.
    pub(super) fn close(&mut self, label: Label, depth: u8) {
        if let Some(index) = self.0.iter().position(|o| o.label == label && o.depth == depth) {
            self.0.truncate(index);
        }
    }

    /// Closes all that stand deeper in calls.
    pub(super) fn leave(&mut self, depth: u8) {
        let kept = self.0.iter().take_while(|o| o.depth <= depth).count();
        self.0.truncate(kept);
    }
}
