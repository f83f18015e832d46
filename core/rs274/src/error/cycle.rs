//! Errors of canned cycles, splines, probing and tapping.

use super::super::text::Letter;
use super::super::{GCode, Spindle};
use truepath_units::{Millimetres, Position, errors};

errors! {
    /// What is wrong with a cycle, a spline or a probing move.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum CycleError {
        /// A word that the code needs is missing.
        WordMissing {
            /// The code.
            code: GCode,
            /// The letter.
            letter: u8,
        } = "G090", "{code} has no {letter}; add it to this block", letter = Letter(letter);
        /// R lies below the bottom of the hole.
        BelowBottom {
            /// The height of R.
            clearance: Position,
            /// The bottom.
            bottom: Position,
        } = "G091",
            "R at {clearance} mm is below the bottom of the hole at {bottom} mm; correct R or the depth",
                clearance = Millimetres(clearance - Position::ZERO), bottom = Millimetres(bottom - Position::ZERO);
        /// K of a back boring cycle lies outside the hole.
        BackBoreTop {
            /// Where K leads.
            top: Position,
            /// The bottom.
            bottom: Position,
            /// The height of R.
            clearance: Position,
        } = "G092",
            "K leads to {top} mm, which is not between the bottom at {bottom} mm and R at {clearance} mm; correct K",
                top = Millimetres(top - Position::ZERO), bottom = Millimetres(bottom - Position::ZERO),
                clearance = Millimetres(clearance - Position::ZERO);
        /// L0.
        NoRepetition = "G093", "L0 repeats the cycle no times; remove L or give at least 1";
        /// Q is so small that a hole has more pecks than are executed.
        TooManyPecks {
            /// How many are executed.
            limit: u32,
        } = "G094", "Q asks for more than {limit} pecks in one hole; is it too small?";
        /// The spindle does not turn as the code needs it.
        Spindle {
            /// The code.
            code: GCode,
            /// How it must turn.
            needed: Spindle,
        } = "G095",
            if needed == Spindle::CounterClockwise => "{code} needs a turning spindle; give S and M4 before it";
            "{code} needs a turning spindle; give S and M3 before it";
        /// A spline outside the XY plane, or with a move of another axis.
        SplinePlane(code: GCode) = "G096",
            "{code} is a spline in X and Y only; select G17 and remove the words of other axes";
        /// G5.3 without G5.2 before it.
        SplineNotBegun = "G097", "G5.3 ends a spline, but G5.2 has not begun one; add G5.2 before it";
        /// A spline that is still open when another code comes.
        SplineOpen = "G098", "the spline begun by G5.2 is not ended; write G5.3 before this block";
        /// Fewer control points than the order needs.
        SplinePoints {
            /// How many there are.
            found: u8,
            /// The order (L).
            order: u8,
        } = "G099",
            "the spline has {found} control points with its start, but L{order} needs at least {order}; add points or give a lower L (2 to 8)";
        /// More control points than are kept.
        SplineTooLong {
            /// How many are kept.
            limit: u8,
        } = "G100", "the spline has more than {limit} control points; end it with G5.3 and begin another";
        /// A probing move without length.
        ProbeTooShort = "G101", "the probing move has no length; give a target away from the present place";
        /// A canned cycle in G93: its moves would each take the time that F gives.
        InverseTime = "G102", "canned cycles have no time of their own in G93; select G94 or G95 before";
    }
}
