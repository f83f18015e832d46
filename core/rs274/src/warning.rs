//! What deserves a look but does not stop the reading.

use core::fmt;

use super::text::Letter;
use super::{GCode, Line, Span};
use truepath_units::errors;

errors! {
    /// What was noticed.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum WarningKind {
        /// The program lacks one or both `%`.
        PercentMissing = "W001", "the program has one of the two `%` alone; make sure that the file is complete";
        /// There is text before the first or behind the second `%`.
        OutsidePercent = "W002", "text outside the two `%` is ignored";
        /// Neither M2 nor M30.
        EndMissing = "W003", "the program does not end with M2 or M30; make sure that the file is complete";
        /// There is text behind M2 or M30.
        TextAfterEnd = "W004", "text after the end of the program (M2, M30) is ignored";
        /// A cutting move before any F, or with F0.
        FeedMissing = "W005", "a cutting move has no feed; give F before it";
        /// A length before G20 or G21.
        UnitsAssumed = "W006",
            "neither G20 nor G21 before the first length; millimetres or inches are taken as set in the options";
        /// F in the block in which G20 or G21 changes the unit.
        UnitsWithFeed = "W007", "F stands in the block that changes the unit; it is read in the new unit";
        /// A block with `/` was executed.
        BlockDeleteExecuted = "W008", "a block with `/` is executed; it changes the part if the machine skips it";
        /// A block with `/` was skipped.
        BlockDeleteSkipped = "W009", "a block with `/` is skipped; it changes the part if the machine executes it";
        /// An M code that is not known.
        UnknownM {
            /// Its number.
            m: u32,
        } = "W010", "M{m} is not known here; it is kept, and taken not to move an axis";
        /// G53 with no axis words.
        BareG53 = "W011", "G53 without axis words has no effect";
        /// H or D without the code that uses it.
        UnusedOffsetNumber {
            /// `H` or `D`.
            letter: u8,
        } = "W012", "{letter} is given without the code that uses it; it has no effect here", letter = Letter(letter);
        /// G41 or G42: the side is recorded, no offset computed.
        CompensationNotApplied = "W013",
            "G41/G42: the program is read as the path of the cutter's centre and tells the side of the wall; the D offset must be zero or wear only";
        /// A length without a point, for a control that may take it for least increments.
        LengthWithoutPoint = "W014",
            "a length without a point is read in millimetres or inches; a control set to least increments moves 1000 (10,000 in inches) times less: write the point, or choose least increments";
        /// M99 in the main program.
        Repeats = "W015", "M99 in the main program repeats it without end; it is read once";
        /// A comment inside another one.
        CommentInComment = "W016",
            "a comment inside another one is read as part of it; LinuxCNC and some other controls stop here";
        /// A CR inside a line of a file whose lines end with LF.
        ReturnInLine = "W017",
            "a CR without LF inside this line counts as a blank; make sure that it is one line";
        /// G28 or G30 beside G0 or G1.
        ReferenceWithMotion = "W018",
            "G28 or G30 beside G0 or G1 is read as G28 or G30 alone; LinuxCNC stops here";
        /// A word that has no meaning for the code it stands with.
        IdleWord {
            /// The letter.
            letter: u8,
        } = "W019", "{letter} means nothing here and is left out; LinuxCNC stops at it", letter = Letter(letter);
        /// The time of G4 by S.
        DwellByS = "W020", "S beside G4 is read as its time in seconds, not as a speed";
        /// Axis words behind G80.
        MotionBehindCycle = "W021",
            "axis words behind G80 go on with G0 or G1 as before the cycle; write it, LinuxCNC and some other controls stop here";
        /// The centres of arcs turn out to be absolute.
        CentresFoundAbsolute = "W022",
            "I and J are read as absolute places, as this arc closes only so; write G90.1 before it if that is right, else G91.1";
        /// An arc whose radii differ by what the digits leave open.
        ArcBeyondLimit = "W023",
            "the radii of this arc differ by more than LinuxCNC allows, but no more than the last written digit explains";
        /// A word of the cycle before, with another code.
        CycleWordKept {
            /// The letter.
            letter: u8,
        } = "W024", "{letter} goes on from the cycle before this one; give it, some controls want it again", letter = Letter(letter);
        /// G70 or G71 as units at a control that has others for them.
        UnitsByLatheCode(code: GCode) = "W025",
            if code.tenths() == 700 => "G70 alone in its block is read as inches; write G20 if the control takes it for a cycle";
            "G71 alone in its block is read as millimetres; write G21 if the control takes it for a cycle";
        /// A cutting move from a place that is not known to one that is.
        StartUnknown {
            /// The axis.
            axis: u8,
        } = "W026",
            "this cutting move starts at an unknown {axis}: it is taken for a move to the part, and no wall it may cut is corrected; give the place with G0 before if it cuts one",
                axis = Letter(axis);
        /// F of a rounding or a chamfer.
        FeedOfCorner = "W028", "the feed of a rounding or chamfer is not looked at: its arc counts as cut at the feed of the contour";
        /// A call that is made no times.
        CallOfNoTimes = "W027",
            "L0 is read as no call; some controls call once: remove the block, or write L1";
    }
}

/// What was noticed, and where first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Warning {
    /// What was noticed.
    pub kind: WarningKind,
    /// The file: 0 for the program, otherwise the number its library gives it.
    pub file: u16,
    /// Line, counted from 1.
    pub line: u32,
    /// Column in bytes, counted from 1.
    pub column: u32,
    /// How often it was noticed in the program.
    pub times: u32,
}

/// The warnings of a program, each kind once with its first place and how often it was seen.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Warnings {
    list: heapless::Vec<Warning, { Self::CAPACITY }>,
    dropped: u32,
}

impl Warnings {
    /// How many different warnings are kept; more are counted in [`Self::dropped`].
    pub const CAPACITY: usize = 24;

    /// The warnings in the order in which they were first noticed.
    pub fn as_slice(&self) -> &[Warning] {
        &self.list
    }
    /// How many were noticed beyond [`Self::CAPACITY`] different ones.
    pub const fn dropped(&self) -> u32 {
        self.dropped
    }
    /// Notes one in the program.
    pub(super) fn note(&mut self, kind: WarningKind, line: &Line<'_>, span: Span) {
        self.note_in(0, kind, line, span);
    }
    /// Notes one in a file.
    pub(super) fn note_in(&mut self, file: u16, kind: WarningKind, line: &Line<'_>, span: Span) {
        if let Some(known) = self.list.iter_mut().find(|w| w.kind == kind) {
            known.times = known.times.saturating_add(1);
            return;
        }
        let column = span.start.saturating_sub(line.start).saturating_add(1);
        let column = u32::try_from(column).unwrap_or(u32::MAX);
        if self.list.push(Warning { kind, file, line: line.number, column, times: 1 }).is_err() {
            self.dropped = self.dropped.saturating_add(1);
        }
    }
}

impl fmt::Display for Warning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}: {}: {}", self.line, self.column, self.kind.code(), self.kind)
    }
}

#[cfg(test)]
mod tests {
    #![allow(clippy::indexing_slicing)]
    use super::*;

    #[test]
    fn a_warning_is_kept_once_and_counted() {
        let mut warnings = Warnings::default();
        let line = Line { number: 7, start: 100, text: b"G53" };
        for _ in 0..3 {
            warnings.note(WarningKind::BareG53, &line, Span { start: 104, len: 3 });
        }
        let seen = warnings.as_slice();
        assert_eq!((seen.len(), seen[0].line, seen[0].column, seen[0].times), (1, 7, 5, 3));
    }

    #[test]
    fn what_exceeds_the_capacity_is_counted() {
        let mut warnings = Warnings::default();
        let line = Line { number: 1, start: 0, text: b"" };
        for m in 0..30 {
            warnings.note(WarningKind::UnknownM { m }, &line, Span::default());
        }
        assert_eq!((warnings.as_slice().len(), warnings.dropped()), (24, 6));
    }
}
