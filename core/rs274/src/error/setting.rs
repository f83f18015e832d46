//! Errors of offsets, tools and modes.

use super::super::GCode;
use super::super::text::Letter;
use truepath_units::errors;

errors! {
    /// What is wrong with a block that sets something.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum SettingError {
        /// Two codes of a block that both use the axis words.
        AxesUsedTwice {
            /// The one read first.
            first: GCode,
            /// The other.
            second: GCode,
        } = "G060", "{first} and {second} both use the axis words of this block; write them in two blocks";
        /// A code without the axis words it needs.
        AxesMissing(code: GCode) = "G061", "{code} has no axis word; add the axes it is meant for";
        /// A number that must be one of a few.
        NotBetween {
            /// Its letter.
            letter: u8,
            /// The least.
            least: u32,
            /// The greatest.
            greatest: u32,
        } = "G062",
            "{letter} must be a whole number from {least} to {greatest} here; correct it", letter = Letter(letter);
        /// An M code without a word it needs.
        MWordMissing {
            /// The code.
            m: u32,
            /// The letter.
            letter: u8,
        } = "G063", "M{m} has no {letter}; add it to this block", letter = Letter(letter);
        /// A tool that the tool table does not hold.
        ToolUnknown {
            /// Its number.
            tool: u32,
        } = "G064", "tool {tool} is not in the tool table; add it there or correct the number";
        /// More rows of the tool table are changed by G10 than are kept.
        TooManyTools {
            /// How many are kept.
            limit: u8,
        } = "G065", "G10 changes more than {limit} rows of the tool table; set them at the machine";
        /// M66 waits without a time.
        WaitWithoutTime = "G066", "M66 waits for an input without a time; add Q";
        /// A code of a lathe.
        Lathe(code: GCode) = "G067",
            if matches!(code.tenths(), 700 | 710) =>
                "{code} is a cycle in this dialect, and cycles of a lathe and rows of holes are not computed; where it stands for inches or millimetres, name the dialect (fanuc, siemens or mach), or write G20 or G21";
            "{code} belongs to a lathe, whose moves are not computed; post the program for a mill";
        /// A feed per revolution with S0 or without S.
        FeedPerRevolution = "G068", "feed per revolution (G95) without a spindle speed; give S before it";
        /// Polar words (@, ^) with X or Y.
        PolarMixed {
            /// `X` or `Y`.
            letter: u8,
        } = "G069",
            "polar words (@, ^) and {letter} name the same place twice; keep one of them", letter = Letter(letter);
        /// G53 in G91.
        MachineMoveIncremental = "G049",
            "a move in machine coordinates (G53) cannot be incremental; write G90 before it";
        /// An argument of G65 that is a length without a point, where such lengths are in least increments.
        ArgumentWithoutPoint {
            /// Its letter.
            letter: u8,
        } = "G116",
            "{letter} is passed to a macro without a point, and controls set to least increments differ in what it means; write the point",
                letter = Letter(letter);
        /// M72 without M70 or M73.
        NothingSaved = "G048", "M72 restores modes, but M70 or M73 has not saved any here; add M70 before it";
    }
}
