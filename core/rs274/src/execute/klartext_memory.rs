//! What conversational blocks remember from one to the next, and become.

use super::super::{Axes, Form, Line, Number, Source, Span, Word};
use truepath_units::Offset;
use truepath_units::geometry::Vector;

/// Words that one block becomes.
pub(super) const LOWERED: usize = 32;

/// What conversational blocks remember.
#[derive(Debug, Default)]
pub(super) struct KlartextMemory<'p> {
    /// CC: X and Y, as written.
    pub(super) pole: [Option<Number>; 2],
    /// The direction in which the last move of the plane ended, of any length.
    pub(super) direction: Option<Vector>,
    /// APPR, until the contour shows where it leads to.
    pub(super) lead: Option<Lead<'p>>,
    /// Whether the last positioning block was one of FMAX.
    pub(super) rapid: bool,
    /// F of TOOL CALL.
    pub(super) feed_of_tool: Option<Word>,
    /// DR of TOOL CALL.
    pub(super) oversize: Offset,
    /// The cycle that CYCL DEF has defined, and whether every positioning block calls it (M89).
    pub(super) cycle: Option<u16>,
    pub(super) calls_cycle: bool,
    /// Whether the block before has taken the rounding or chamfer that comes.
    pub(super) corner_taken: bool,
}

/// What M functions of a block ask for beside what they switch.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Asked {
    /// M91, M92.
    pub(super) machine: bool,
    /// M99.
    pub(super) cycle: bool,
    /// M140, with its place.
    pub(super) lift: Option<Span>,
}

/// The words of a block in G-code.
pub(super) type Lowered = heapless::Vec<Word, LOWERED>;

/// What a lead is made of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Shape {
    pub(super) form: Form,
    /// `LEN`, nm.
    pub(super) length: Option<f64>,
    /// `R`, nm.
    pub(super) radius: Option<f64>,
    /// `CCA`, radians.
    pub(super) angle: Option<f64>,
}

/// An APPR whose contour is still to come.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lead<'p> {
    pub(super) shape: Shape,
    /// R0, RL, RR.
    pub(super) side: Option<Word>,
    pub(super) line: Line<'p>,
    pub(super) source: Source,
    pub(super) from: Axes,
    pub(super) to: Axes,
    /// Whether the way to the auxiliary point is one of FMAX; then F counts behind it.
    pub(super) rapid: bool,
    pub(super) feed: Option<Word>,
}
