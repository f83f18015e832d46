//! A job in numbers: everything besides program and measurement that a correction follows from.
//!
//! It holds neither text nor floating point, so that it travels to the device in postcard (the compact form: fields
//! in their order, lengths in nanometres and numbers in units of 2⁻³² as variable-length integers, about 110 bytes)
//! and gives the same bits there. Ranges are those of the job file; [`Job::check`](super::Job::check) holds them.

use serde::{Deserialize, Serialize};

use crate::correct::Target;
use crate::cut::ToolMaterial;
use crate::gcode::{ArcCentres, Dialect, PointlessLength};
use crate::geometry::Side;
use crate::probe::{Format, Layout, MOST_ALIKE};
use crate::units::{Offset, Real};

/// The job.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Job {
    /// The control the program is written for.
    #[serde(with = "super::wire")]
    pub dialect: Dialect,
    /// What a length without a point is in the program.
    #[serde(with = "super::wire")]
    pub decimal: PointlessLength,
    /// How I, J and K of arcs count in the program until G90.1 or G91.1.
    #[serde(with = "super::wire")]
    pub arc_centres: ArcCentres,
    /// Side of travel of the finished wall; `None` leaves it to G41/G42 of the program.
    #[serde(with = "super::wire")]
    pub wall: Option<Side>,
    /// Stock left on the wall before this pass, along the normal, above 0, up to 100 mm and below the cutter's diameter.
    pub allowance: Offset,
    /// The cutter.
    pub tool: Tool,
    /// How deep and how fast.
    pub cut: Cut,
    /// Prior of the cutting force.
    pub force: Force,
    /// Prior of the machine.
    pub machine: Machine,
    /// How the part was probed; `None` in a job that is only simulated.
    pub probe: Option<Probe>,
    /// How to correct.
    pub correct: Correct,
    /// Which cut of the program it is about; `None` when the program holds one contour only.
    pub part: Option<Part>,
}

/// One finishing pass of a program with several cuts. Found on the host, so that the device need not search.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Part {
    /// Number of the feature: its place in the job or among the markers of the program, 1…[`LARGEST_NUMBER`].
    pub feature: u32,
    /// Number of the pass: the level of the feature in the order of execution, 1…[`LARGEST_NUMBER`].
    pub pass: u32,
    /// The run of cutting moves, counted from 1 in the order of execution.
    pub run: u32,
    /// The first of its blocks that belongs to the contour, from 0.
    pub first_block: u32,
    /// How many blocks belong to it, at least 1.
    pub blocks: u32,
    /// Tips of other passes that cut alike along the same path, above this one's (negative: below), up to 1 m; zero for none.
    /// A point at their height is one of this pass as well, as high above their tip.
    pub alike: [Offset; MOST_ALIKE],
}

/// The largest number of a tool, a tool offset or a setup: that of the tool tables of common controls.
pub const LARGEST_NUMBER: u32 = 99_999;

/// The cutter.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Tool {
    /// Nominal diameter, 0.1…100 mm.
    pub diameter: Offset,
    /// Measured diameter, 0.1…110 mm and within 10 % of the nominal one.
    pub measured_diameter: Option<Offset>,
    /// Radial offset of its axis from that of the spindle, 0…0.2 mm; 0 runs true.
    pub runout: Offset,
    /// Direction of the offset behind a tooth, degrees, 0…360.
    #[serde(with = "super::wire")]
    pub runout_deg: Real,
    /// Number of teeth, 1…12.
    pub teeth: u8,
    /// Helix angle, degrees, 0…60.
    #[serde(with = "super::wire")]
    pub helix_deg: Real,
    /// What makes the cutter a cantilever; `None` when its own bending is not modelled.
    pub cantilever: Option<Stickout>,
    /// Its number at the machine, 1…[`LARGEST_NUMBER`]; `None` leaves it to T of the program.
    pub number: Option<u32>,
    /// Number of the tool offset in force, up to [`LARGEST_NUMBER`], 0 for none.
    pub offset_number: u32,
    /// What the control adds to the program under G41 and G42.
    #[serde(with = "super::wire")]
    pub compensation: Compensation,
}

/// What G41 and G42 of the program do at the control.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Compensation {
    /// D holds wear or nothing: the program is the path of the cutter's centre, and they tell the side of the wall.
    #[default]
    Centre,
    /// D holds the cutter's radius: the program is the wall, and the centre keeps half of the nominal diameter away.
    Radius,
}

/// What the cutter's own compliance follows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Stickout {
    /// From the collet to the tip, at least the axial depth, at most 500 mm.
    pub length: Offset,
    /// What the cutter is made of.
    #[serde(with = "super::wire")]
    pub material: ToolMaterial,
}

/// Depth and speeds of the pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Cut {
    /// Axial depth of cut, above 0, up to 200 mm.
    pub axial_depth: Offset,
    /// Spindle speed, 1…200,000 rev/min, overriding S of the program.
    #[serde(with = "super::wire")]
    pub spindle_rpm: Option<Real>,
    /// Feed, 0.1…100,000 mm/min, overriding F of the program.
    #[serde(with = "super::wire")]
    pub feed_mm_per_min: Option<Real>,
}

/// Prior of the cutting force.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Force {
    /// Tangential chip coefficient, above 0, up to 20,000 N/mm².
    #[serde(with = "super::wire")]
    pub ktc: Real,
    /// Radial chip coefficient, 0…20,000 N/mm².
    #[serde(with = "super::wire")]
    pub krc: Real,
    /// Tangential edge coefficient, 0…500 N/mm.
    #[serde(with = "super::wire")]
    pub kte: Real,
    /// Radial edge coefficient, 0…500 N/mm.
    #[serde(with = "super::wire")]
    pub kre: Real,
    /// Which force makes the wall.
    pub model: ForceModel,
    /// Whether the four are the user's, or a table's for the user's material; else they are between the metals.
    pub stated: bool,
}

/// Which force makes the wall at a height.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ForceModel {
    /// The mean over a revolution.
    Mean,
    /// The force at the instant the height is generated.
    Helical,
    /// By evidence of the probe points; helical when they cannot tell.
    Auto,
}

/// Prior of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Machine {
    /// Stiffness along x, 10…1,000,000 N/mm.
    #[serde(with = "super::wire")]
    pub stiffness_x: Real,
    /// Stiffness along y, 10…1,000,000 N/mm.
    #[serde(with = "super::wire")]
    pub stiffness_y: Real,
    /// Whether the two are the user's; else they are between the machines.
    pub stated: bool,
}

/// How the part was probed.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Probe {
    /// Diameter of the ball, 0.1…50 mm.
    pub ball_diameter: Offset,
    /// Format of the measurement file.
    #[serde(with = "super::wire")]
    pub format: Format,
    /// Layout of a file of columns; `None` for the default one, and for other formats.
    pub layout: Option<Layout>,
    /// Machine coordinates of the work zero, ±10 m, for a file in machine coordinates that does not say it.
    pub work_offset: Option<[Offset; 3]>,
    /// What the Z in the file is.
    pub z_reference: ZReference,
    /// Standard deviation of one reading, above 0, up to 0.1 mm.
    pub noise: Offset,
}

/// What the Z of a measurement is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum ZReference {
    /// The ball's centre.
    Centre,
    /// The ball's lowest point.
    Tip,
}

/// How to correct.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Correct {
    /// The law.
    pub law: LawName,
    /// The largest correction allowed, above 0, up to 4 mm.
    pub clamp: Offset,
    /// What of the wall's error is brought to zero.
    #[serde(with = "super::wire")]
    pub target: Target,
    /// Heights above the cutter's tip over which the target is taken, rising, within the axial depth.
    pub band: [Offset; 2],
    /// The deepest gouge allowed at any height, 0…1 mm; wins over the target.
    pub max_gouge: Option<Offset>,
    /// Number of the setup (clamping) of the part, 1…[`LARGEST_NUMBER`].
    pub setup: u32,
}

/// The law of correction, before what it needs of the measurement is known.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum LawName {
    /// The identified model at the nominal engagement, iterated on the predicted wall error.
    Model,
    /// The deflection mirrored once.
    Mirror,
    /// Petrakov & Romanov 2023, equations (8)–(12), as printed.
    Paper,
}
