//! Errors of programs in HEIDENHAIN's conversational language.

use truepath_units::errors;

errors! {
    /// What is wrong with a conversational block, or why it is not read.
    #[derive(Clone, Copy, Debug, PartialEq, Eq)]
    pub enum KlartextError {
        /// A block that begins with no known word.
        Block = "G180", "no block of conversational programs begins like this; correct the word, or put the line behind `;`";
        /// A word that belongs to no block.
        Word = "G181", "this word is not known in its block; correct it, or put it behind `;`";
        /// A word without its number.
        NumberMissing = "G182", "this word has no number; write one, or a Q parameter";
        /// A number with more than 18 digits before its point.
        NumberTooLarge = "G183", "this number has more than 18 digits before its point; is a point missing?";
        /// A name that is not closed.
        QuoteOpen = "G184", "the name opened by `\"` is not closed in this line; add `\"`";
        /// BEGIN PGM without MM or INCH.
        Unit = "G185", "BEGIN PGM names the program and its unit; add MM or INCH at the end of the line";
        /// An arc without DR, or DR that turns against IPA.
        Rotation = "G186", "an arc needs its sense of rotation, which is that of IPA; write DR+ or DR-";
        /// An arc or a polar place without pole.
        PoleMissing = "G187", "this needs a pole and none is known; write CC with X and Y before it";
        /// A tangent block without anything before it, or a lead without the contour.
        TangentMissing = "G188",
            "this begins tangent to the block before it, and that is no move in the plane; write a line before it";
        /// APPR without a contour behind it.
        ContourMissing = "G189", "behind APPR comes the first move of the contour, and this is none; put it elsewhere";
        /// A lead of which a word is missing or wrong.
        Lead = "G190",
            "this lead cannot be computed: LT and LN need LEN, CT needs CCA and R, LCT needs R and a place from which the arc can be reached; correct it, or write the lead as L and CR";
        /// APPR or DEP of another form.
        Form = "G191", "APPR and DEP lead along LT, LN, CT or LCT (PLT, PLN, PCT, PLCT); write one of them";
        /// A place that is no place of a Q parameter.
        Parameter = "G192", "a Q parameter is Q0 to Q1999, QL0 to QL499 or QR0 to QR499, and `=` follows it; correct it";
        /// What is no formula.
        Formula = "G193",
            "a number, a Q parameter, a bracket or one of SIN COS TAN ASIN ACOS ATAN SQRT SQ LN LOG EXP INT FRAC ABS NEG SGN PI must stand here; correct the formula";
        /// `(` without `)`.
        BracketOpen = "G194", "the bracket opened by `(` is not closed; add `)`";
        /// A label that no LBL has.
        NoSuchLabel = "G195", "no LBL has this name; correct it, or add the LBL";
        /// LBL, CALL LBL, REP or GOTO LBL without what belongs to it.
        Label = "G196", "a label has a number or a name in quotes, and REP a number of repetitions; write it";
        /// A tool axis other than Z.
        ToolAxis = "G197", "the axis of the tool is not Z, and the path is computed in X and Y; use Z, or post for a tool along Z";
        /// CYCL DEF without a number.
        CycleNumber = "G198", "CYCL DEF has the number of its cycle; write it";
        /// A cycle that cuts along a path of its own.
        Cycle {
            /// Its number.
            number: u16,
        } = "G199",
            "cycle {number} is not computed: it moves or cuts in a way that the program does not show; write it as L and CR, or put it into a program of its own";
        /// CYCL CALL or M99 without a cycle.
        CycleMissing = "G200", "no cycle is defined that this could call; write CYCL DEF before it";
        /// PLANE other than RESET.
        Plane = "G201", "PLANE turns the working plane, which is not computed; PLANE RESET is read: post the contour without it";
        /// FUNCTION other than MODE and RESET.
        Function = "G202",
            "FUNCTION changes how the axes move, which is not computed; FUNCTION MODE and FUNCTION RESET are read: post the contour without it";
        /// M128 and others.
        Machine {
            /// The number.
            m: u32,
        } = "G203", "M{m} changes the path of the cutter in a way that is not computed; post the contour without it";
        /// FL, FC, FPOL.
        FreeContour = "G204",
            "free contour programming (FK) is not computed; let the control convert it (CONVERT FK -> H), or write L, CR and CT";
        /// LN with vectors.
        Vector = "G205", "LN blocks move a cutter by vectors, in more than three axes, which is not computed; post L blocks";
        /// SPL.
        Spline = "G206", "splines (SPL) are not computed; post lines and arcs";
        /// TCH PROBE.
        Touch = "G207",
            "a touch probe cycle leads to places that the program does not show; put it into a program of its own, run before this one";
        /// PATTERN DEF, CYCL CALL PAT.
        Pattern = "G208", "patterns of points are not computed; write the places as L blocks with M99";
        /// CONTOUR DEF, OCM.
        ContourCycle = "G209", "contours for cycles are not computed; write the finishing pass as L, C and CR";
        /// CALL PGM, SEL PGM.
        OtherProgram = "G210", "another program is called, which is not in this file; put its blocks into this one behind an LBL";
        /// FN 14, FN 17, FN 18, FN 23 …
        SystemFunction = "G211",
            "this FN function is not computed: its result depends on the machine; write the value as FN 0 (FN 0 to FN 13 are read)";
        /// DECLARE, TABDATA, OPEN.
        Text = "G212", "texts and tables of the control are not read; write the values themselves";
        /// IF, WHILE, FOR of TNC7.
        Structure = "G213", "IF, FOR and WHILE of newer controls are not read; write FN 9 to FN 12 and CALL LBL with REP";
        /// A block of ISO words.
        Iso = "G214", "this is a block of an ISO program among conversational ones; write it in conversational words";
        /// FZ, FT.
        OtherFeed = "G215", "feeds by tooth or by time (FZ, FT, FMAXT) are not read; write F in mm/min or FU";
        /// CYCL DEF 7 with a number of the datum table, and 8, 10, 11, 19, 26 that do something.
        Transformation {
            /// The number of the cycle.
            number: u16,
        } = "G216",
            if number == 7 => "this datum shift comes from the datum table of the control; write its values, as CYCL DEF 7.1 X+10";
            "cycle {number} mirrors, turns, scales or tilts what follows, which is not computed; post the contour as it is cut";
    }
}
