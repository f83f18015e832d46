//! Errors of corner words.

use truepath_units::{Millimetres, Offset, errors};

errors! {
    /// What is wrong with `,R` or `,C`.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum CornerError {
        /// The word stands on a block that is no line (G1) in the plane.
        WithoutLine = "G058",
            "`,R` and `,C` stand between two lines (G1) of the plane, and this block is none; remove the word or write the corner out";
        /// Something else than a line (G1) in the plane follows.
        NotFollowed {
            /// The line of what follows.
            line: u32,
        } = "G058",
            "`,R` and `,C` stand between two lines (G1) of the plane, and line {line} comes before the second; write the corner out, or put that block elsewhere";
        /// What is cut off is longer than what is left of one of the two lines.
        TooLarge {
            /// What is cut off of each line.
            needed: Offset,
            /// How long the line is, less the corner at its other end.
            left: Offset,
            /// The line of its block.
            line: u32,
        } = "G059",
            "the corner cuts {needed} mm off each of its two lines, and that of line {line} has {left} mm left; give a smaller one",
                needed = Millimetres(needed), left = Millimetres(left);
        /// The second line goes back along the first.
        TurnsBack = "G110",
            "the second line goes back along the first, and nothing can be cut off there; remove the word";
        /// `,A` is given.
        Angle = "G111", "`,A` (the direction of a line) is not computed; write the end of the line with its axes";
        /// `,R` and `,C` stand in one block.
        Twice = "G112", "`,R` and `,C` stand in one block; keep one of them";
        /// A line moves more than the two axes of the plane.
        OtherAxis = "G113",
            "a corner is cut between lines of the two axes of the plane, and another axis moves here; give that move a block of its own";
        /// Inverse time (G93) is on, where F is the time of the whole block.
        InverseTime = "G114",
            "a corner has no feed of its own in inverse time (G93); write G94 before it, or write the corner out";
        /// More steps between the two lines than can wait.
        TooMuchBetween {
            /// How many can.
            limit: u8,
        } = "G115",
            "more than {limit} steps stand between the two lines of a corner; put comments, M, F and S before or behind them";
    }
}
