//! What a program does not say: its dialect, where the axes stand at the start, and the machine it is for with its tool
//! table, its unit, and how its probe answers.

use super::{Axes, Dialect, NineAxes, Units};
use truepath_units::Offset;

/// A row of the tool table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Tool {
    /// T and H.
    pub number: u32,
    /// Its place in the changer.
    pub pocket: u32,
    /// The diameter of the cutter.
    pub diameter: Offset,
    /// Its offsets, in which the length is Z.
    pub offset: NineAxes,
}

impl Tool {
    /// Tool 0 without offsets.
    pub const NONE: Self = Self { number: 0, pocket: 0, diameter: Offset::ZERO, offset: [0; 9] };
}

/// A machine whose offsets are those of the parameters and the tool table: every position is known.
///
/// Without it a program is read for whatever machine it will run on, and positions are unknown after every change that
/// depends on the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Machine {
    /// The unit of the offsets in the parameters.
    pub units: Units,
    /// How far before the end of a probing move the probe is taken to answer.
    pub probe_before_end: Offset,
}

/// What G41 and G42 move the path aside by.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CompensationBy {
    /// By nothing: the program is the path of the cutter's centre, as it is where D holds wear only, and G41 or G42
    /// tell the side of the wall. G41.1 and G42.1 still count, as they name their diameter.
    #[default]
    Nothing,
    /// This radius, whatever D says.
    Radius(Offset),
    /// This radius while this tool, or none that the program names, is in the spindle; the path of any other tool is read
    /// as that of its centre.
    ToolRadius {
        /// T of the tool.
        tool: u32,
        /// Its radius.
        radius: Offset,
    },
    /// By half of the diameter that the tool table has for D, or for the tool in the spindle.
    Table,
}

/// What a length without a point is, `X10`.
///
/// It counts for axes, centres, radii, corners and every other length or angle of a block. F, S, P and L are always as
/// written, and so are parameters and expressions; with [`Self::Least`] an argument of G65 that is a length needs a
/// point, because controls differ in what they pass on.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum PointlessLength {
    /// In millimetres, inches or degrees, as a calculator reads it.
    #[default]
    Calculator,
    /// In least increments of the control: 0.001 mm, 0.0001 in or 0.001°.
    Least,
}

/// How I, J and K of arcs count until G90.1 or G91.1 says it.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum ArcCentres {
    /// From the start of the arc, unless the first arc that closes in one way only does so with absolute places: then they
    /// are, for that arc and all behind it, with a warning.
    #[default]
    Detect,
    /// From the start of the arc.
    Incremental,
    /// As places.
    Absolute,
}

/// What the program does not say.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Options<'t> {
    /// The unit until G20 or G21.
    pub units: Units,
    /// Where the axes stand at the start; with a machine in its coordinates.
    pub start: Axes,
    /// Whether blocks with `/` are skipped.
    pub skip_block_delete: bool,
    /// The control the program is written for.
    pub dialect: Dialect,
    /// Whether whatever LinuxCNC stops at is refused in its dialect, for a comparison with it. Otherwise a program that says
    /// plainly what it means is read, with a warning: the control it runs on is seldom LinuxCNC because no dialect is named.
    pub as_linuxcnc: bool,
    /// What a length without a point is.
    pub decimal: PointlessLength,
    /// How I, J and K of arcs count until the program says it.
    pub arc_centres: ArcCentres,
    /// How many blocks may be executed beyond as many as the program has lines; loops that run longer are an error.
    pub block_limit: u32,
    /// What G41 and G42 move the path aside by.
    pub compensation: CompensationBy,
    /// The tool table; empty when it is not known.
    pub tools: &'t [Tool],
    /// The machine; `None` when the program is read for any machine, and positions that depend on it are unknown.
    pub machine: Option<Machine>,
    /// How far the lines that stand for a spline may lie from it.
    pub spline_tolerance: Offset,
    /// Whether splines come as a whole ([`Canon::Spline`](super::Canon::Spline)) instead of as lines.
    pub whole_splines: bool,
}

impl Options<'_> {
    /// Whether the program is read as LinuxCNC itself reads it.
    pub(super) fn is_linuxcnc_itself(&self) -> bool {
        self.as_linuxcnc && self.dialect == Dialect::Linuxcnc
    }
}

impl Default for Options<'_> {
    /// Millimetres, positions unknown, `/` blocks executed, LinuxCNC, lengths without a point as a calculator
    /// reads them, a million blocks more than lines, no
    /// machine, splines to 1 µm.
    fn default() -> Self {
        Self {
            units: Units::Millimetres,
            start: Axes::UNKNOWN,
            skip_block_delete: false,
            dialect: Dialect::Linuxcnc,
            as_linuxcnc: false,
            decimal: PointlessLength::Calculator,
            arc_centres: ArcCentres::Detect,
            block_limit: 1_000_000,
            compensation: CompensationBy::Nothing,
            tools: &[],
            machine: None,
            spline_tolerance: Offset::from_um(1),
            whole_splines: false,
        }
    }
}
