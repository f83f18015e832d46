//! G-code: bytes → words → modal interpreter → canonical moves → contour.
//!
//! Its place: above `truepath-units`, below `truepath-model`. It stands on its own: whoever wants to read RS274 without
//! an allocator needs these two crates and nothing of milling.
//!
//! | step | where |
//! |---|---|
//! | lines, spans | [`Lines`], [`Span`] |
//! | words with exact decimal numbers (`lexical`) | [`Words`], [`Decimal`] |
//! | expressions and parameters (`expression`, `parameter`) | [`Number`], [`Memory`] |
//! | subprograms, loops, jumps: which line comes next (`flow`) | [`Program`], [`Library`] |
//! | modes and order of execution, moves, offsets, cycles (`execute`) | [`Interpreter`], [`Options`] |
//! | the path of the cutter's centre under G41 and G42 | [`compensation`] |
//! | canonical moves with the block each comes from | [`Event`], [`Canon`] |
//! | the finishing contour (`contour`) | [`read_contour`], [`find_contours`], [`search`] |
//!
//! Nothing is allocated. A number as it is written stays exact: 0.0001 in is 2540 nm on every machine; only expressions
//! are computed in floating point, in software that gives the same bits everywhere. What is not understood is a
//! [`GcodeError`] with line, column and a code; it is never skipped.
//!
//! ```
//! use truepath_rs274::{Canon, DeviceMemory, Interpreter, Options};
//!
//! let program = b"%\nG21 G90 G17\nG0 X0 Y0\nG3 X10 Y10 R10 F200\nM30\n%\n";
//! let mut arcs = 0;
//! let mut memory = DeviceMemory::new();
//! let summary = Interpreter::new(Options::default()).run(program, &mut memory.lend(), &mut |event| {
//!     arcs += i32::from(matches!(event.canon, Canon::Arc { .. }));
//!     Ok(())
//! })?;
//! assert_eq!((arcs, summary.end, summary.warnings.as_slice().len()), (1, Some(30), 0));
//! # Ok::<(), truepath_rs274::GcodeError>(())
//! ```
#![no_std]
#![forbid(unsafe_code)]
#![deny(missing_docs)]
#![deny(
    clippy::arithmetic_side_effects,
    clippy::indexing_slicing,
    clippy::unwrap_used,
    clippy::expect_used,
    clippy::panic,
    clippy::float_arithmetic
)]

#[cfg(test)]
extern crate std;

mod block;
mod canon;
mod code;
mod comment;
pub mod compensation;
mod contour;
mod corner;
mod dialect;
mod error;
mod execute;
mod expression;
mod flow;
mod group;
mod identity;
mod interpreter;
#[cfg(feature = "klartext")]
mod klartext;
mod lexical;
mod mcode;
mod modal;
mod mode;
mod options;
mod parameter;
mod place;
mod shifts;
mod text;
mod warning;

pub use canon::{Canon, Event, ShiftKind, Sink, Source};
pub use code::GCode;
pub use comment::{Comment, CommentKind};
pub use contour::{
    Between, Candidate, ContourOptions, ContourProgram, Criteria, Found, Idle, Role, RunPart, find_contours,
    read_contour, search, visit_runs,
};
pub use dialect::Dialect;
pub use error::{
    CornerError, CycleError, ExpressionError, FlowError, Foreign, GcodeError, GcodeErrorKind, KlartextError,
    ParameterError, SettingError,
};
pub use flow::{Library, LibraryFile, Program, Word};
pub use identity::{CORRECTED_MARK, is_marked_corrected, program_crc};
pub use interpreter::{Executed, Interpreter, ProgramSummary};
#[cfg(feature = "klartext")]
pub use klartext::{
    Form, KlartextBlock, KlartextValue, KlartextWord, KlartextWords, Statement, letter as klartext_letter,
};
pub use lexical::{Decimal, Number, NumberError, Token, Words, WrittenWord};
pub use modal::{Modal, Motion};
pub use mode::{Coolant, FeedMode, PathControl, Plane, RetractLevel, Spindle, ToolLength, Units};
pub use options::{ArcCentres, CompensationBy, Machine, Options, PointlessLength, Tool};
pub use parameter::{DeviceMemory, HostMemory, MachineParameters, Memory, MemoryBuffers, NamedSlot};
pub use place::Axes;
pub use shifts::{AXIS_LETTERS, NineAxes, Shifts};
pub use text::{Line, LineRange, Lines, Span};
pub use warning::{Warning, WarningKind, Warnings};
