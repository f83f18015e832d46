//! Errors in the order of execution: subprograms, loops, jumps.

use super::super::text::Letter;
use truepath_units::errors;

errors! {
    /// What is wrong with the order in which blocks are executed.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum FlowError {
        /// A word behind an O word that is none of its keywords.
        Keyword = "G140",
            "an O word is followed by sub, endsub, call, return, if, elseif, else, endif, while, endwhile, do, repeat, endrepeat, break or continue; correct the word";
        /// An O word without number or name.
        Label = "G141", "an O word needs a number or a name in < >; write one";
        /// A condition that does not stand in brackets.
        Condition = "G142", "a condition or a number of repetitions stands in brackets; put it in [ ]";
        /// Something behind a complete statement.
        TextBehind = "G143", "nothing may follow this statement in its line; put it in a line of its own";
        /// A subprogram that is neither in this text nor in the library.
        NoSuchProgram = "G144",
            "this subprogram is neither in the program nor in a file beside it; add it, or correct its name";
        /// A block number that no block has.
        NoSuchBlock {
            /// The number.
            number: u32,
        } = "G145", "no block has the number N{number}; correct the number or add the block";
        /// `sub`, `if`, `while`, `do` or `repeat` without its end.
        NoEnd = "G146", "the end of this part of the program is missing; add the line that closes it";
        /// `else`, `endif`, `endwhile`, `break` … outside of what it belongs to.
        Unmatched = "G147", "nothing that this line could belong to is open here; add its beginning or remove the line";
        /// `return` outside of a subprogram.
        ReturnOutside = "G148", "a return outside of a subprogram; remove it";
        /// More calls inside each other than are followed.
        TooManyCalls {
            /// How many are followed.
            limit: u8,
        } = "G149", "more than {limit} calls inside each other; does a subprogram call itself?";
        /// More loops and conditions inside each other than are kept.
        TooManyOpen {
            /// How many are kept.
            limit: u8,
        } = "G150", "more than {limit} loops and conditions inside each other; make them fewer";
        /// More arguments of a call than there are parameters for.
        TooManyArguments {
            /// How many there are.
            limit: u8,
        } = "G151", "a call takes {limit} arguments at most; pass fewer";
        /// More assignments in a block than are kept.
        TooManyAssignments {
            /// How many are kept.
            limit: u8,
        } = "G152", "more than {limit} parameters are set in one block; use several blocks";
        /// More blocks executed than allowed.
        TooLong {
            /// How many are allowed behind the first jump.
            limit: u32,
        } = "G153", "{limit} blocks were executed since the first loop or call; does a loop never end?";
        /// A statement that the dialect does not have.
        OtherDialect = "G154",
            "this statement belongs to the macro language of another control; name the control's dialect, or write it in the language of this one";
        /// A block that can be no argument list of G65.
        Argument {
            /// The letter.
            letter: u8,
        } = "G155", "{letter} cannot pass an argument here; use another letter", letter = Letter(letter);
    }
}
