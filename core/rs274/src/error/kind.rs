//! The kinds of errors and their codes.

use super::super::text::{Byte, Letter};
use super::super::{GCode, LineRange};
use super::{
    CompensationError, CornerError, CycleError, ExpressionError, FlowError, KlartextError, ParameterError, SettingError,
};
use truepath_units::{Millimetres, Offset, errors};

/// A language that is not G-code as read here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Foreign {
    /// `BEGIN PGM … MM`: Heidenhain's conversational language.
    Heidenhain,
    /// `E` words: a program of a 3D printer.
    Printer,
    /// `TRANS`, `CYCLE81(…)`, `T="…"`: Siemens' own language.
    Siemens,
}

errors! {
    /// What is wrong.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum GcodeErrorKind {
        /// A byte that belongs to no word and no comment.
        UnexpectedByte(byte: u8) = "G001",
            "{byte} is not part of a G-code block; remove it or put it in a comment", byte = Byte(byte);
        /// A letter without a number.
        NumberMissing {
            /// The letter.
            letter: u8,
        } = "G002", "{letter} has no number; write one directly after it", letter = Letter(letter);
        /// A number with more than 18 digits before its point.
        NumberTooLarge {
            /// Its letter.
            letter: u8,
        } = "G003",
            "the number of {letter} has more than 18 digits before its point; is a point missing?",
                letter = Letter(letter);
        /// `(` without `)` in the same line.
        UnclosedComment = "G004", "the comment opened by `(` is not closed in this line; add `)`";
        /// `)` without `(`.
        StrayParenthesis = "G005",
            "`)` without `(`; remove it, or the inner parentheses of a comment: LinuxCNC ends a comment at the first `)`";
        /// `#`, `[`, `]`, `=` or `*` where none belongs.
        Stray(byte: u8) = "G006",
            "{byte} does not belong here; a parameter is set with `#1=…`, and an expression stands in [ ] behind a letter",
                byte = Byte(byte);
        /// Three or more letters in a row outside a comment.
        Text = "G008", "text outside a comment; put it in ( ) if it is a remark, or post the program in plain G-code";
        /// The program is in another language.
        ForeignDialect(language: Foreign) = "G009",
            if matches!(language, Foreign::Heidenhain) =>
                "this is a HEIDENHAIN conversational program (BEGIN PGM); name dialect heidenhain. Where that is named the firmware of a board says so, which does not read it: use the PC";
            if matches!(language, Foreign::Siemens) =>
                "this is a word of Siemens' own language, of which some are read in dialect siemens; name that dialect, or write origins by G54 to G59 and cycles as moves, or post the program for ISO mode";
            "an E word: this is a 3D printer's program, or a number with an exponent; post it for a milling machine, with plain numbers";
        /// Something else than a comment after `%`.
        TextAfterPercent = "G010", "text after `%`; only a comment may follow it on its line";
        /// A letter given twice in a block.
        DuplicateWord {
            /// The letter.
            letter: u8,
        } = "G022", "{letter} is given twice in this block; keep one", letter = Letter(letter);
        /// N or `/` after another word.
        OutOfPlace {
            /// `N`, `/` or `O`.
            letter: u8,
        } = "G023",
            if letter == b'O' => "a program number stands alone at the start of its line; move it there";
            "{letter} must stand at the start of its block, before the other words; move it there",
                letter = Byte(letter);
        /// Two G codes of one modal group in a block.
        Conflict {
            /// The one read first.
            first: GCode,
            /// The other.
            second: GCode,
        } = "G024",
            if first == second => "{first} is given twice in this block; keep one";
            "{first} and {second} exclude each other in one block; write them in two blocks or keep one";
        /// Two M codes that exclude each other in a block.
        ConflictM {
            /// The one read first.
            first: u32,
            /// The other.
            second: u32,
        } = "G025",
            if first == second => "M{first} is given twice in this block; keep one";
            "M{first} and M{second} exclude each other in one block; write them in two blocks or keep one";
        /// More words in a block than are kept.
        TooManyWords {
            /// How many are kept.
            limit: u8,
        } = "G047", "more than {limit} words in one block; write them in several blocks";
        /// More M codes in a block than are kept.
        TooManyM {
            /// How many are kept.
            limit: u8,
        } = "G026", "more than {limit} M codes in one block; write them in several blocks";
        /// A number that must be whole is not.
        NotWhole {
            /// Its letter.
            letter: u8,
        } = "G027", "the number of {letter} must be whole; remove its decimals", letter = Letter(letter);
        /// A number that must not be negative is.
        Negative {
            /// Its letter.
            letter: u8,
        } = "G028", "the number of {letter} must not be negative; remove its sign", letter = Letter(letter);
        /// A word that no code of the block uses.
        UnusedWord {
            /// Its letter.
            letter: u8,
        } = "G029",
            "no code of this block uses {letter}; remove it or add the code it belongs to", letter = Letter(letter);
        /// A coordinate, feed, speed or number out of range.
        OutOfRange {
            /// Its letter.
            letter: u8,
        } = "G030",
            if matches!(letter, b'X'..=b'Z' | b'I' | b'J' | b'R') =>
                "{letter} leads farther than 100 m from the origin; is a point missing, or the unit wrong?",
                letter = Letter(letter);
            if matches!(letter, b'F' | b'S') => "the number of {letter} is above 1000000000; is a point missing?",
                letter = Letter(letter);
            "the number of {letter} is too large; the limit is 4294967295", letter = Letter(letter);
        /// A second program begins before the first has ended.
        SecondProgram {
            /// Number of the first.
            first: u32,
            /// Number of the second.
            second: u32,
        } = "G031",
            "program O{second} begins before O{first} has ended with M2 or M30; put each program in a file of its own";
        /// A G code that is not known.
        UnknownG(code: GCode) = "G032",
            "{code} is not known here, so what it does to the path cannot be told; remove it or post without it";
        /// A known G code that is not computed.
        Unsupported(code: GCode) = "G033", "{code} is not computed; post the program without it";
        /// A plane other than XY.
        WrongPlane(code: GCode) = "G034",
            "{code} selects a plane of the axes U, V, W, whose arcs are not computed; select G17, G18 or G19";
        /// A call of a macro.
        Macro(code: GCode) = "G038", "{code} calls a macro, which is not executed; post the program without macros";
        /// A G that is no number of a G code.
        NotAGCode = "G041", "no G code has this number; G codes go from G0 to G999 with at most one decimal";
        /// Axis words, but no motion is active.
        NoMotion = "G042", "axis words, but no motion is active; write G0, G1, G2 or G3 in this block or before it";
        /// G53 with axis words needs G0 or G1.
        MachineMoveNeedsLine = "G043",
            "a move in machine coordinates (G53) must be G0 or G1, not an arc; write G0 or G1";
        /// G4 without its time.
        DwellWithoutTime = "G044", "G4 has no time; add P or X";
        /// An incremental move or an arc from an axis position that is not known.
        PositionUnknown {
            /// The axis.
            axis: u8,
        } = "G045",
            "the position of {axis} is not known here (start of the program, G28, G53, or a new work or tool offset); give it once with G90 first",
                axis = Letter(axis);
        /// An arc with neither I, J nor R.
        ArcWithoutCentre = "G050", "this arc has no centre; add I and J, or R (or write G1 if it should be a line)";
        /// An arc with R as well as I or J.
        ArcMixed = "G051", "this arc has R as well as I or J; keep one of the two";
        /// An absolute centre (G90.1) of which one coordinate is missing.
        ArcCentreIncomplete {
            /// The missing letter.
            missing: u8,
        } = "G052", "the absolute centre (G90.1) has no {missing}; add it", missing = Letter(missing);
        /// An arc with R whose end is its start.
        ArcRadiusFullCircle = "G053",
            "an arc with R cannot be a full circle: its end is its start; give the centre with I and J";
        /// A radius too small to reach the end.
        ArcRadiusTooSmall {
            /// Distance from start to end.
            chord: Offset,
            /// The radius without its sign.
            radius: Offset,
        } = "G054",
            "radius {radius} mm cannot reach an end {chord} mm away; it must be at least half of that",
                radius = Millimetres(radius), chord = Millimetres(chord);
        /// The end is not as far from the centre as the start.
        ArcEndOffRadius {
            /// Distance of the start from the centre.
            start: Offset,
            /// Distance of the end from the centre.
            end: Offset,
        } = "G055",
            "the start of this arc is {start} mm from its centre but the end {end} mm; correct the end, I or J, or check G90.1/G91.1",
                start = Millimetres(start), end = Millimetres(end);
        /// An arc that closes with absolute I and J only, behind arcs that close with incremental ones.
        ArcCentreAbsolute = "G057",
            "this arc closes only if I and J are absolute places, but arcs before it were read with I and J from their start; write G90.1 or G91.1 at the start of the program, or say arc_centres";
        /// The centre coincides with the start or the end.
        ArcNoRadius = "G056", "the centre of this arc coincides with its start or end; correct I and J";
        /// No cutting move in X or Y at constant Z.
        NoContour = "G070",
            "no cutting move (G1, G2, G3) in X or Y at constant Z found; there is no contour to correct";
        /// More than one candidate.
        SeveralContours {
            /// How many.
            count: u32,
            /// Lines of the first.
            first: LineRange,
            /// Lines of the second.
            second: LineRange,
        } = "G071",
            "{count} contours found, the first two on {first} and {second}; give a program that holds the finishing contour alone";
        /// The program has no such blocks of a run.
        PartMissing {
            /// The run, counted from 1 in the order of execution.
            run: u32,
            /// The first of its blocks that counts, from 0.
            first: u32,
            /// How many count.
            blocks: u32,
        } = "G076",
            "the program has no run {run} of cutting moves with {blocks} blocks from its block {first}; the job was made for another program",
                first = first.saturating_add(1);
        /// More blocks than the buffer holds.
        ContourTooLong {
            /// What it holds.
            limit: usize,
        } = "G072",
            "the contour has more than {limit} blocks, which is what the buffer holds; choose fewer lines, or split the program";
        /// A cutting move from a place that is not known.
        StartUnknown {
            /// The axis whose position is not known.
            axis: u8,
        } = "G073",
            "this cutting move starts at an unknown {axis}; give it with G0 and G90 before (after G28, G53 or a new offset as well)",
                axis = Letter(axis);
        /// The height of the contour is never given.
        HeightUnknown = "G074",
            "the Z of this contour is not known; give it with G90 before the contour, after any tool change, G43, G28 or G53";
        /// The contour is cut with G41 in one part and G42 in another.
        BothSides = "G075", "the contour is cut with G41 in one part and G42 in another; a wall has one side";
    }
    with the code of {
        /// A parameter, or the memory for them.
        Parameter(error: ParameterError) = error.code(), "{error}";
        /// Cutter radius compensation.
        Compensation(error: CompensationError) = error.code(), "{error}";
        /// An expression.
        Expression(error: ExpressionError) = error.code(), "{error}";
        /// The order in which blocks are executed.
        Flow(error: FlowError) = error.code(), "{error}";
        /// A canned cycle, a spline, a probing move.
        Cycle(error: CycleError) = error.code(), "{error}";
        /// What a corner word asks for.
        Corner(error: CornerError) = error.code(), "{error}";
        /// An offset, a tool, a mode.
        Setting(error: SettingError) = error.code(), "{error}";
        /// A conversational block.
        Klartext(error: KlartextError) = error.code(), "{error}";
    }
}

/// The theme of each error, for `?`.
macro_rules! themes {
    ($($theme:ident($error:ident)),+) => {
        $(impl From<$error> for GcodeErrorKind {
            fn from(error: $error) -> Self {
                Self::$theme(error)
            }
        })+
    };
}

themes!(
    Parameter(ParameterError),
    Compensation(CompensationError),
    Expression(ExpressionError),
    Flow(FlowError),
    Cycle(CycleError),
    Corner(CornerError),
    Setting(SettingError),
    Klartext(KlartextError)
);
