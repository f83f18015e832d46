//! The job file: what is cut, with what, how it is probed and how it is to be corrected.
//!
//! Reading has two stages. `document` turns the text into tables, keys and spans; `check` turns those into a [`Job`]
//! in which every quantity is in range, in the units of the core, and every choice is made. Lengths come out as exact
//! nanometres of the decimal text. Unknown keys are errors. Every error names file, line and column, what was found,
//! what was expected and what to do; the codes are
//!
//! | code | meaning |
//! |---|---|
//! | J001 | a file named by the job cannot be read |
//! | J002 | not TOML |
//! | J003 | unknown key |
//! | J004 | missing key or table |
//! | J005 | value of the wrong type |
//! | J006 | value out of range |
//! | J007 | unknown name |
//! | J008 | keys that contradict each other |
//! | J009 | recognised, not supported |
//! | J010 | version of the format |
//!
//! Limits: one contour a job; the stock is a parallel curve of the finished wall.

mod check;
mod check_correct;
mod check_tool;
mod decimal;
mod document;
mod limits;
mod material;

use std::ops::Range;
use std::path::{Path, PathBuf};

use truepath_core::units::{Offset, Real};

use crate::diagnostics::{InputError, Source};

pub use decimal::Decimal;
pub use material::{MATERIALS, Material};
pub use truepath_core::geometry::Side;

/// A checked job.
#[derive(Clone, Debug)]
pub struct Job {
    /// The program, as a path that can be opened.
    pub program: PathBuf,
    /// Side of travel of the finished wall; `None` leaves it to G41/G42 of the program.
    pub wall: Option<Side>,
    /// Stock left on the wall before this pass, along the normal, above 0 and below the cutter's diameter.
    pub allowance: Offset,
    /// The cutter.
    pub tool: Tool,
    /// How deep and how fast.
    pub cut: Cut,
    /// Prior of the cutting force.
    pub force: Force,
    /// Prior of the machine.
    pub machine: Machine,
    /// How the part was probed; `None` when the job has no `[probe]`.
    pub probe: Option<Probe>,
    /// How to correct.
    pub correct: Correct,
    source: Source,
    spans: document::Spans,
}

/// The cutter.
#[derive(Clone, Debug)]
pub struct Tool {
    /// Nominal diameter, 0.1…100 mm.
    pub diameter: Offset,
    /// Measured diameter, within 10 % of the nominal one.
    pub measured_diameter: Option<Offset>,
    /// Number of teeth, 1…12.
    pub teeth: u8,
    /// Helix angle, degrees, 0…60.
    pub helix_deg: Real,
    /// The free length and the material that make the cutter a cantilever; `None` when its own bending is not modelled.
    pub cantilever: Option<Cantilever>,
}

/// What the cutter's own compliance follows from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cantilever {
    /// From the collet to the tip, at least the axial depth, at most 500 mm.
    pub stickout: Offset,
    /// What it is made of.
    pub material: CutterMaterial,
}

/// What a cutter is made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CutterMaterial {
    /// High-speed steel.
    Hss,
    /// Cemented carbide.
    Carbide,
}

/// Depth and speeds of the pass.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Cut {
    /// Axial depth of cut, above 0, up to 200 mm.
    pub axial_depth: Offset,
    /// Spindle speed in rev/min, overriding S of the program.
    pub spindle_rpm: Option<Real>,
    /// Feed in mm/min, overriding F of the program.
    pub feed_mm_per_min: Option<Real>,
}

/// Prior of the cutting force.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Force {
    /// Tangential chip coefficient, N/mm².
    pub ktc: Real,
    /// Radial chip coefficient, N/mm².
    pub krc: Real,
    /// Tangential edge coefficient, N/mm.
    pub kte: Real,
    /// Radial edge coefficient, N/mm.
    pub kre: Real,
    /// Which force makes the wall.
    pub model: ForceModel,
    /// The material of the built-in table the coefficients were taken from.
    pub material: Option<&'static str>,
}

/// Which force makes the wall at a height.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ForceModel {
    /// The mean over a revolution.
    Mean,
    /// The force at the instant the height is generated.
    Helical,
    /// By evidence of the probe points; helical when they cannot tell.
    Auto,
}

/// Prior of the machine.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Machine {
    /// Stiffness along x, N/mm, 10…1,000,000.
    pub stiffness_x: Real,
    /// Stiffness along y, N/mm.
    pub stiffness_y: Real,
    /// Backlash of the x axis, 0…1 mm.
    pub backlash_x: Offset,
    /// Backlash of the y axis.
    pub backlash_y: Offset,
}

/// How the part was probed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Probe {
    /// Diameter of the ball, above 0, up to 50 mm.
    pub ball_diameter: Offset,
    /// Format of the measurement file.
    pub format: ProbeFormat,
    /// What the Z in the file is.
    pub z_reference: ZReference,
    /// Standard deviation of one reading, above 0, up to 0.1 mm.
    pub noise: Offset,
}

/// Format of a measurement file; frame, unit and point follow from it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProbeFormat {
    /// Nine columns of LinuxCNC's PROBEOPEN: work coordinates, program units, ball centre.
    LinuxCnc,
    /// Columns `x y z` with an optional outward normal `nx ny`: work coordinates, mm, ball centre.
    Columns,
}

/// What the Z of a measurement is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ZReference {
    /// The ball's centre.
    Centre,
    /// The ball's lowest point.
    Tip,
}

/// How to correct.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Correct {
    /// The law.
    pub law: Law,
    /// How far the written path may leave the computed one, 0.0001…0.1 mm.
    pub tolerance: Offset,
    /// The largest correction allowed, above 0, up to 4 mm; 0.5 mm unless the job names more.
    pub clamp: Offset,
    /// What of the wall's error is brought to zero.
    pub target: Target,
    /// Heights above the cutter's tip over which the target is taken, mm; within the axial depth.
    pub band: [Offset; 2],
    /// The deepest gouge allowed at any height; wins over the target.
    pub max_gouge: Option<Offset>,
    /// Where the correction is applied.
    pub route: Route,
}

/// The law of correction.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Law {
    /// The identified model at the nominal engagement, iterated on the predicted wall error.
    Model,
    /// The deflection mirrored once.
    Mirror,
    /// Petrakov & Romanov 2023, equations (8)–(12), as printed.
    Paper,
}

/// What of the wall's error is brought to zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Target {
    /// The mean over the band.
    Mean,
    /// The error at the cutter's tip.
    Tip,
    /// The largest magnitude over the band.
    Minimax,
}

/// Where the correction is applied; a job is corrected in one place only.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Route {
    /// In the program text.
    Program,
    /// In the coprocessor.
    Coprocessor,
}

impl Job {
    /// Reads and checks a job file.
    ///
    /// # Errors
    /// An [`InputError`] at the first thing that is wrong.
    pub fn read(path: &Path) -> Result<Self, InputError> {
        let folder = path.parent().unwrap_or(Path::new(""));
        Self::parse(Source::read(path)?, folder)
    }

    /// Checks the text of a job whose relative paths start at `folder`.
    ///
    /// # Errors
    /// An [`InputError`] at the first thing that is wrong.
    pub fn parse(source: Source, folder: &Path) -> Result<Self, InputError> {
        check::job(source, folder)
    }

    /// Reads the program.
    ///
    /// # Errors
    /// `J001`, pointing at the key `program`.
    pub fn read_program(&self) -> Result<Source, InputError> {
        let bytes = std::fs::read(&self.program).map_err(|error| {
            let reason = InputError::unreadable(&self.program, &error);
            InputError::new(
                "J001",
                reason.found(),
                "a readable program",
                "correct the name: it is taken relative to the job file's folder",
            )
            .at(&self.source, self.span("program"))
        })?;
        Ok(Source::new(self.program.display().to_string(), bytes))
    }

    /// The `[probe]` table.
    ///
    /// # Errors
    /// `J004` when the job has none.
    pub fn require_probe(&self) -> Result<Probe, InputError> {
        self.probe.ok_or_else(|| {
            let end = self.source.bytes().len();
            InputError::new(
                "J004",
                "[probe] is missing",
                "a table [probe]",
                "add [probe] with ball_diameter_mm, format and z_reference",
            )
            .at(&self.source, end..end)
        })
    }

    /// Where the value of a key stands, `tool.diameter_mm`; the start of the file for a key that is not given.
    pub fn span(&self, key: &str) -> Range<usize> {
        self.spans.get(key).cloned().unwrap_or(0..0)
    }
    /// Whether the file gives a key.
    pub fn gives(&self, key: &str) -> bool {
        self.spans.contains_key(key)
    }
    /// The file's text.
    pub const fn source(&self) -> &Source {
        &self.source
    }
}
