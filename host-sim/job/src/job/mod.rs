//! The job file: what is cut, with what, how it is probed and how it is to be corrected.
//!
//! Reading has two stages. `document` turns the text into tables, keys and spans; `check` turns those into a [`JobFile`]
//! in which every quantity is in range, in the units of the core, and every choice is made. Lengths come out as exact
//! nanometres of the decimal text. Unknown keys are errors. Every error names file, line and column, what was found,
//! what was expected and what to do.
//!
//! Limits: one cutter and one correction a job; of several features one is corrected at a time.

mod check;
mod check_correct;
mod check_feature;
mod check_feed;
mod check_part;
mod check_plan;
mod check_pocket;
mod check_probe;
mod check_stock;
mod check_store;
mod check_tool;
mod material;
mod measured;
mod open;

use std::ops::Range;
use std::path::PathBuf;

use truepath_core::job::Probe;
use truepath_core::units::Offset;
use truepath_ground::codes::J004;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::files;
use truepath_ground::length::Unit;

use crate::codes::{J001, J009};
use crate::post::ToolNote;
use crate::signing::Signer;
use crate::surface::Surface;

pub use check::DECIMALS;
pub use check_correct::ROUTES;
pub use check_feature::{FeaturePlace, FeatureRole, FeatureTable};
pub use check_feed::{FeedTable, ForceLimit};
pub use check_part::{PartFlags, PartNames, PartTable, Tolerance};
pub use check_plan::{CutterStiffness, PlanCutter, PlanTable};
pub use check_pocket::{Mode, PerSection, PocketTable};
pub use check_probe::{FORMATS, ProbeFlags, columns, one_of};
pub use check_store::{PriorOf, StoreNames, StorePlace, StoreTable, has_password, without_password};
pub use check_tool::Shank;
pub use material::{MATERIALS, Material};
pub use open::{Assumed, DIALECTS, USUAL_FORCE, USUAL_HELIX, USUAL_STIFFNESS, WORD_DIALECTS, dialect_name};

pub(crate) use check_feature::is_id;

/// The roughing cutter, as the job has it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Roughing {
    /// Its diameter.
    pub diameter: Offset,
    /// Its number, where only its passes count.
    pub tool: Option<u32>,
}

/// A checked job.
#[derive(Clone, Debug)]
pub struct JobFile {
    /// The program, as a path that can be opened.
    pub program: PathBuf,
    /// What the correction follows from, as the device takes it; without a probe when the job has no `[probe]`.
    pub numbers: truepath_core::job::Job,
    /// Backlash of the x and the y axis, 0…1 mm.
    pub backlash: [Offset; 2],
    /// What the machine repeats to, standard deviation of one dimension from part to part, 0.0001…0.5 mm; `None` where the job
    /// does not state it.
    pub repeatability: Option<Offset>,
    /// How far the written path may leave the computed one, 0.0001…0.1 mm.
    pub tolerance: Offset,
    /// Arcs of a larger radius are written as lines, 10…100,000 mm.
    pub max_arc_radius: Offset,
    /// Kinks of the written path where the program is smooth are kept below this, 0.1…10 degrees.
    pub max_kink_deg: f64,
    /// Whether a correction cancels what the points show beside machine and material.
    pub discrepancy: bool,
    /// Where the correction is applied.
    pub route: Route,
    /// How far the feeds along the contour may be changed; `None` leaves every F word.
    pub feed: Option<FeedTable>,
    /// What `truepath plan` has to keep.
    pub plan: PlanTable,
    /// Cutters it may use beside that of the job.
    pub plan_cutters: Vec<PlanCutter>,
    /// What the customer of the part is told; empty without `[part]`.
    pub part: PartTable,
    /// The shop store its parts go into; empty without `[store]`.
    pub store: StoreTable,
    /// What `truepath pocket` cuts; `None` without `[pocket]`.
    pub pocket: Option<PocketTable>,
    /// The cutter's shape as a beam, beside stick-out and material.
    pub shank: Shank,
    /// Parts that the cutter had cut before the first one that is learned from, 0…100,000.
    pub parts_cut: u32,
    /// The actual surface of the stock, as a path that can be opened; its allowance follows from it.
    pub surface: Option<PathBuf>,
    /// The file of touches of the stock before the pass, as a path that can be opened.
    pub stock_probe: Option<PathBuf>,
    /// The cutter whose passes in the same program leave the stock.
    pub roughing: Option<Roughing>,
    /// The `[[feature]]` tables.
    pub features: Vec<FeatureTable>,
    /// Which feature and pass the command is about.
    pub which: Which,
    /// Whether it has been found out what a path under G41 or G42 is, where the file does not say it.
    pub drawn: bool,
    /// What the file does not say and was taken from the program or a default.
    pub assumed: Vec<Assumed>,
    /// Cutters that the program names, where the job says neither diameter nor number and the contour has to decide; else
    /// empty.
    pub cutters: Vec<ToolNote>,
    /// Whether file or command line say the format of the probe file; else the file shows it.
    pub format_stated: bool,
    /// The control as `--dialect` of `truepath probe` names it; `None` where it is not known or none is written for it.
    pub probe_control: Option<&'static str>,
    /// Whether the depth of the cut is still to be found with the contour.
    pub open_depth: bool,
    /// Who signs the images that are made; only the command line says it.
    pub signer: Option<Signer>,
    /// Whether points are taken although they do not fit the job; only the command line says it.
    pub force_data: bool,
    /// The unit of its keys.
    pub unit: Unit,
    source: Source,
    spans: truepath_ground::document::Spans,
}

/// Which cut of a program with several a command is about.
#[derive(Clone, Debug, Default, PartialEq, Eq, clap::Args)]
pub struct Which {
    /// The feature of the job, or of the markers in the program; needed when there are several to correct.
    #[arg(long, value_name = "ID")]
    pub feature: Option<String>,
    /// The depth of the feature, 1 for the first; otherwise the one the probe points lie on, or the first.
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=99_999))]
    pub pass: Option<u32>,
}

/// What the command line of a command that reads a probe file says in place of the job.
#[derive(Clone, Debug, Default, PartialEq, Eq, clap::Args)]
pub struct Said {
    /// Of the probe file.
    #[command(flatten)]
    pub probe: ProbeFlags,
    /// Which cut of the program.
    #[command(flatten)]
    pub which: Which,
}

impl Said {
    /// A job with this in force.
    ///
    /// # Errors
    /// As [`JobFile::read`] and [`JobFile::override_probe`].
    pub fn read(&self, job: &std::path::Path) -> Result<JobFile, InputError> {
        let mut job = JobFile::read(job)?;
        job.override_probe(&self.probe)?;
        job.which = self.which.clone();
        Ok(job)
    }
}

/// Where the correction is applied; a job is corrected in one place only.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Route {
    /// In the program text.
    #[default]
    Program,
    /// In the coprocessor.
    Coprocessor,
}

impl JobFile {
    /// An image of this job as it is to be written: signed, if somebody signs.
    ///
    /// # Errors
    /// As [`Signer::signed`].
    pub fn signed(&self, image: Vec<u8>) -> Result<Vec<u8>, Failure> {
        match &self.signer {
            Some(signer) => signer.signed(&image),
            None => Ok(image),
        }
    }

    /// Reads the program.
    ///
    /// # Errors
    /// `J001`, pointing at the key `program`.
    pub fn read_program(&self) -> Result<Source, InputError> {
        let bytes = files::read(&self.program).map_err(|error| {
            let reason = InputError::unreadable(&self.program, &error);
            J001.error(reason.found(), "a readable program").at(&self.source, self.span("program"))
        })?;
        Ok(Source::new(self.program.display().to_string(), bytes))
    }

    /// Reads the surface of the stock, when the job names one.
    ///
    /// # Errors
    /// `J001`, pointing at the key `stock.surface`, and whatever is wrong with the file.
    pub fn read_surface(&self) -> Result<Option<Surface>, InputError> {
        let Some(path) = &self.surface else { return Ok(None) };
        let bytes = files::read(path).map_err(|error| {
            let reason = InputError::unreadable(path, &error);
            J001.error(reason.found(), "a readable surface").at(&self.source, self.span("stock.surface"))
        })?;
        Surface::read(&Source::new(path.display().to_string(), bytes)).map(Some)
    }

    /// Reads the touches of the stock, when the job names any.
    ///
    /// # Errors
    /// `J001`, pointing at the key `stock.probe`.
    pub(crate) fn read_stock_probe(&self) -> Result<Option<Source>, InputError> {
        let Some(path) = &self.stock_probe else { return Ok(None) };
        let bytes = files::read(path).map_err(|error| {
            let reason = InputError::unreadable(path, &error);
            let help = "correct the name, relative to the job file's folder; truepath probe --stock writes the program that touches the stock, truepath correct without stock.probe takes an even allowance";
            InputError::new(J001, reason.found(), "readable touches of the stock", help)
                .at(&self.source, self.span("stock.probe"))
        })?;
        Ok(Some(Source::new(path.display().to_string(), bytes)))
    }

    /// The key that says of stock that it is measured, where one does.
    pub const fn measured_stock(&self) -> Option<&'static str> {
        match (&self.surface, &self.stock_probe, &self.roughing) {
            (Some(_), ..) => Some("stock.surface"),
            (None, Some(_), _) => Some("stock.probe"),
            (None, None, Some(_)) => Some("stock.roughing_diameter_mm"),
            (None, None, None) => None,
        }
    }

    /// The compact form for a device that makes its own image.
    ///
    /// # Errors
    /// `J009` when the stock was measured, which stays on the host.
    pub fn compact(&self) -> Result<Vec<u8>, Failure> {
        if let Some(key) = self.measured_stock() {
            let found = format!("{key} is given: a device that computes its own image takes an even allowance only");
            let error = J009.error(found, "stock.allowance_mm alone, or an image made here");
            return Err(error.at(&self.source, self.span(key)).into());
        }
        let mut compact = [0; truepath_core::job::COMPACT_BYTES];
        let compact = self.numbers.to_compact(&mut compact).map_err(|e| Failure::Internal(e.to_string()))?;
        Ok(compact.to_vec())
    }

    /// The `[probe]` table.
    ///
    /// # Errors
    /// `J004` when the job has none.
    pub fn require_probe(&self) -> Result<Probe, InputError> {
        self.numbers.probe.ok_or_else(|| {
            let end = self.source.bytes().len();
            InputError::new(
                J004,
                "[probe] is missing",
                "a table [probe]",
                "add [probe] with ball_diameter_mm = the diameter of the probe's ball: every point is shifted by half of it",
            )
            .at(&self.source, end..end)
        })
    }

    /// Puts what the command line says of the probe file in place of what the job says.
    ///
    /// # Errors
    /// `J004` when the job has no `[probe]`, `C001` for flags that contradict each other or the job.
    pub fn override_probe(&mut self, flags: &ProbeFlags) -> Result<(), InputError> {
        self.force_data = flags.force_data;
        let said = ProbeFlags { force_data: false, ..*flags };
        if said != ProbeFlags::default() {
            self.numbers.probe = Some(flags.over(self.require_probe()?)?);
            self.format_stated = true;
        }
        Ok(())
    }

    /// Puts what the command line says of the part in place of what the job says.
    ///
    /// # Errors
    /// `C001` for a flag that says nothing usable.
    pub fn override_part(&mut self, flags: &PartFlags) -> Result<(), InputError> {
        self.part = flags.over(std::mem::take(&mut self.part))?;
        Ok(())
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
