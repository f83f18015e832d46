//! The sentences of errors: what was found, what was expected, what to do.

use core::fmt;

use super::{Foreign, GcodeError, GcodeErrorKind, LineRange};
use truepath_units::Offset;

/// A length in millimetres with as many decimals as it needs, at most six.
pub(super) struct Millimetres(pub(super) Offset);

impl fmt::Display for Millimetres {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let nm = self.0.nm();
        let (whole, mut part) = (nm.unsigned_abs() / 1_000_000, nm.unsigned_abs() % 1_000_000);
        let mut width = 6usize;
        while width > 0 && part.is_multiple_of(10) {
            part /= 10;
            width = width.saturating_sub(1);
        }
        let sign = if nm < 0 { "-" } else { "" };
        if width == 0 { write!(f, "{sign}{whole} mm") } else { write!(f, "{sign}{whole}.{part:0width$} mm") }
    }
}

/// A byte as a reader can find it in the text.
struct Byte(u8);

impl fmt::Display for Byte {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.0.is_ascii_graphic() {
            write!(f, "`{}`", char::from(self.0))
        } else {
            write!(f, "byte 0x{:02X}", self.0)
        }
    }
}

/// A letter.
pub(super) struct Letter(pub(super) u8);

impl fmt::Display for Letter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", char::from(self.0))
    }
}

impl fmt::Display for LineRange {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.first == self.last {
            write!(f, "line {}", self.first)
        } else {
            write!(f, "lines {}-{}", self.first, self.last)
        }
    }
}

impl fmt::Display for GcodeErrorKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::UnexpectedByte(b) => {
                write!(f, "{} is not part of a G-code block; remove it or put it in a comment", Byte(b))
            }
            Self::NumberMissing { letter } => write!(f, "{} has no number; write one directly after it", Letter(letter)),
            Self::NumberTooLarge { letter } => {
                write!(f, "the number of {} has more than 18 digits before its point; is a point missing?", Letter(letter))
            }
            Self::UnclosedComment => f.write_str("the comment opened by `(` is not closed in this line; add `)`"),
            Self::StrayParenthesis => {
                f.write_str("`)` without `(`: comments do not nest, so the comment ended at the first `)`; remove the inner parentheses")
            }
            Self::Stray(b) => {
                write!(f, "{} does not belong here; a parameter is set with `#1=…`, and an expression stands in [ ] behind a letter", Byte(b))
            }
            Self::Text => f.write_str("text outside a comment; put it in ( ) if it is a remark, or post the program in plain G-code"),
            Self::ForeignDialect(Foreign::Heidenhain) => {
                f.write_str("this is a Heidenhain conversational program (BEGIN PGM), not G-code; post it for an ISO control")
            }
            Self::ForeignDialect(Foreign::Printer) => f.write_str(
                "an E word: this is a 3D printer's program, or a number with an exponent; post it for a milling machine, with plain numbers",
            ),
            Self::TextAfterPercent => f.write_str("text after `%`; only a comment may follow it on its line"),
            Self::Parameter(error) => error.fmt(f),
            Self::Compensation(error) => error.fmt(f),
            Self::Expression(error) => error.fmt(f),
            Self::Flow(error) => error.fmt(f),
            Self::Corner(error) => error.fmt(f),
            Self::Cycle(error) => error.fmt(f),
            Self::Setting(error) => error.fmt(f),
            _ => self.fmt_block(f),
        }
    }
}

impl GcodeErrorKind {
    fn fmt_block(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::DuplicateWord { letter } => write!(f, "{} is given twice in this block; keep one", Letter(letter)),
            Self::OutOfPlace { letter: b'O' } => {
                f.write_str("a program number stands alone at the start of its line; move it there")
            }
            Self::OutOfPlace { letter } => {
                write!(
                    f,
                    "{} must stand at the start of its block, before the other words; move it there",
                    Byte(letter)
                )
            }
            Self::Conflict { first, second } if first == second => {
                write!(f, "{first} is given twice in this block; keep one")
            }
            Self::Conflict { first, second } => {
                write!(f, "{first} and {second} exclude each other in one block; write them in two blocks or keep one")
            }
            Self::ConflictM { first, second } if first == second => {
                write!(f, "M{first} is given twice in this block; keep one")
            }
            Self::ConflictM { first, second } => {
                write!(
                    f,
                    "M{first} and M{second} exclude each other in one block; write them in two blocks or keep one"
                )
            }
            Self::TooManyM { limit } => {
                write!(f, "more than {limit} M codes in one block; write them in several blocks")
            }
            Self::TooManyWords { limit } => {
                write!(f, "more than {limit} words in one block; write them in several blocks")
            }
            Self::NotWhole { letter } => {
                write!(f, "the number of {} must be whole; remove its decimals", Letter(letter))
            }
            Self::Negative { letter } => {
                write!(f, "the number of {} must not be negative; remove its sign", Letter(letter))
            }
            Self::UnusedWord { letter } => {
                write!(f, "no code of this block uses {}; remove it or add the code it belongs to", Letter(letter))
            }
            Self::OutOfRange { letter: letter @ b'X'..=b'Z' }
            | Self::OutOfRange { letter: letter @ (b'I' | b'J' | b'R') } => {
                write!(
                    f,
                    "{} leads farther than 100 m from the origin; is a point missing, or the unit wrong?",
                    Letter(letter)
                )
            }
            Self::OutOfRange { letter: letter @ (b'F' | b'S') } => {
                write!(f, "the number of {} is above 1000000000; is a point missing?", Letter(letter))
            }
            Self::OutOfRange { letter } => {
                write!(f, "the number of {} is too large; the limit is 4294967295", Letter(letter))
            }
            Self::SecondProgram { first, second } => {
                write!(
                    f,
                    "program O{second} begins before O{first} has ended with M2 or M30; put each program in a file of its own"
                )
            }
            _ => self.fmt_code(f),
        }
    }

    fn fmt_code(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::UnknownG(g) => write!(
                f,
                "{g} is not known here, so what it does to the path cannot be told; remove it or post without it"
            ),
            Self::Unsupported(g) => write!(f, "{g} is not computed; post the program without it"),
            Self::WrongPlane(g) => write!(
                f,
                "{g} selects a plane of the axes U, V, W, whose arcs are not computed; select G17, G18 or G19"
            ),
            Self::Macro(g) => write!(f, "{g} calls a macro, which is not executed; post the program without macros"),
            Self::NotAGCode => {
                f.write_str("no G code has this number; G codes go from G0 to G999 with at most one decimal")
            }
            Self::NoMotion => {
                f.write_str("axis words, but no motion is active; write G0, G1, G2 or G3 in this block or before it")
            }
            Self::MachineMoveNeedsLine => {
                f.write_str("a move in machine coordinates (G53) must be G0 or G1, not an arc; write G0 or G1")
            }
            Self::DwellWithoutTime => f.write_str("G4 has no time; add P or X"),
            Self::PositionUnknown { axis } => write!(
                f,
                "the position of {} is not known here (start of the program, G28, G53, or a new work or tool offset); give it once with G90 first",
                Letter(axis)
            ),
            _ => self.fmt_geometry(f),
        }
    }

    fn fmt_geometry(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::ArcWithoutCentre => {
                f.write_str("this arc has no centre; add I and J, or R (or write G1 if it should be a line)")
            }
            Self::ArcMixed => f.write_str("this arc has R as well as I or J; keep one of the two"),
            Self::ArcCentreIncomplete { missing } => {
                write!(f, "the absolute centre (G90.1) has no {}; add it", Letter(missing))
            }
            Self::ArcRadiusFullCircle => {
                f.write_str("an arc with R cannot be a full circle: its end is its start; give the centre with I and J")
            }
            Self::ArcRadiusTooSmall { chord, radius } => write!(
                f,
                "radius {} cannot reach an end {} away; it must be at least half of that",
                Millimetres(radius),
                Millimetres(chord)
            ),
            Self::ArcEndOffRadius { start, end } => write!(
                f,
                "the start of this arc is {} from its centre but the end {}; correct the end, I or J, or check G90.1/G91.1",
                Millimetres(start),
                Millimetres(end)
            ),
            Self::ArcNoRadius => f.write_str("the centre of this arc coincides with its start or end; correct I and J"),
            Self::NoContour => f.write_str(
                "no cutting move (G1, G2, G3) in X or Y at constant Z found; there is no contour to correct",
            ),
            Self::SeveralContours { count, first, second } => write!(
                f,
                "{count} contours found, the first two on {first} and {second}; give a program that holds the finishing contour alone"
            ),
            Self::ContourTooLong { limit } => {
                write!(f, "the contour has more than {limit} blocks, which is what the buffer holds; choose fewer lines, or split the program")
            }
            Self::StartUnknown { axis } => write!(
                f,
                "this cutting move starts at an unknown {}; give it with G0 and G90 before (after G28, G53 or a new offset as well)",
                Letter(axis)
            ),
            Self::HeightUnknown => {
                f.write_str("the Z of this contour is not known; give it with G90 before the contour, after any tool change, G43, G28 or G53")
            }
            Self::BothSides => {
                f.write_str("the contour is cut with G41 in one part and G42 in another; a wall has one side")
            }
            Self::PartMissing { run, first, blocks } => write!(
                f,
                "the program has no run {run} of cutting moves with {blocks} blocks from its block {}; the job was made for another program",
                first.saturating_add(1)
            ),
            _ => Ok(()),
        }
    }
}

impl fmt::Display for GcodeError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "line {}, column {}: {}: {}", self.line, self.column, self.kind.code(), self.kind)
    }
}

impl core::error::Error for GcodeError {}
