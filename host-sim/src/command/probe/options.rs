//! What `probe` is asked for.

use std::path::PathBuf;

use clap::{ArgGroup, Args};
use truepath_correction::verification::{ProbeDialect, Settings};
use truepath_ground::diagnostics::Failure;
use truepath_ground::length;
use truepath_job::dimension::{INSTRUMENTS, Instrument};
use truepath_job::job::{JobFile, ProbeFlags, Which, one_of};
use truepath_job::pass::Pass;

use crate::command::begin::BeginFlags;

/// What is asked for.
#[derive(Clone, Debug, Args)]
#[command(group = ArgGroup::new("measured").multiple(true))]
pub struct Options {
    /// The job.
    pub job: PathBuf,
    /// The control the program is for; without it that of the part's program, where job or program show it.
    #[arg(long, value_enum, requires = "output")]
    pub dialect: Option<ProbeDialect>,
    /// The program to write; without it the places are listed alone.
    #[arg(short, long, value_name = "FILE")]
    pub output: Option<PathBuf>,
    /// Further places, given what was measured: those after which the worst place of the corrected wall is most certain.
    #[arg(long, requires = "measured")]
    pub next: bool,
    /// Touch the stock, before the finishing pass: the results are for stock.probe of the job.
    #[arg(long, conflicts_with_all = ["next", "probe", "from"])]
    #[cfg_attr(not(target_family = "wasm"), arg(conflicts_with = "store"))]
    pub stock: bool,
    /// Instead of a program: the dimensions that tell most with a calliper, as a sheet to print (FILE.html) and the file that its
    /// numbers are typed into (FILE.toml), for correct --dimensions.
    #[arg(long, conflicts_with_all = ["next", "stock", "dialect"], requires = "output")]
    pub dimensions: bool,
    /// What the dimensions are taken with.
    #[arg(long, value_name = "NAME", requires = "dimensions", value_parser = one_of(&INSTRUMENTS), default_value = "calliper")]
    pub instrument: Instrument,
    /// What a reading of it stays within, ± at two standard deviations (k = 2), mm, or with its unit (0.1in)
    /// [default: that of the instrument].
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, requires = "dimensions")]
    pub uncertainty: Option<f64>,
    /// The largest dimension that it takes, mm, or with its unit (0.1in) [default: 150 with a calliper, otherwise no
    /// limit].
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, requires = "dimensions")]
    pub reach: Option<f64>,
    /// How far the stock may be from the allowance of the job, mm, or with its unit (0.1in) [default: half of the
    /// allowance, at least 0.3].
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, requires = "stock")]
    pub stock_margin: Option<f64>,
    /// What was measured on the part that will be touched again: cut by the job's program, or with the correction in DIR.
    #[arg(long, value_name = "FILE", requires = "next", group = "measured")]
    pub probe: Option<PathBuf>,
    /// Folder of correct, plan or learn: touched is the part cut with the correction in it, its history is known.
    #[arg(long, value_name = "DIR", requires = "next", group = "measured")]
    pub from: Option<PathBuf>,
    /// Where fits begin: touches go where that leaves most open.
    #[command(flatten)]
    pub begin: BeginFlags,
    /// Replace the file if it exists.
    #[arg(long)]
    pub force: bool,
    /// Which cut of the program.
    #[command(flatten)]
    pub which: Which,
    /// Places along the contour, on several together, with two at least on each; each place is touched at every height; how many dimensions
    /// [default: 8; with --next 4, fewer where more are not worth touching; with --stock by the length of the contour].
    #[arg(long, value_name = "N")]
    pub points: Option<u32>,
    /// Choices about the program.
    #[command(flatten)]
    pub settings: Settings,
    /// What is said of the probe file in place of the job.
    #[command(flatten)]
    pub probe_flags: ProbeFlags,
}

impl Options {
    /// The walls of the job, with what other jobs say of them where it wants that.
    pub(super) fn walls(&self, job: JobFile) -> Result<Vec<Pass>, Failure> {
        Ok(self.begin.passes(Pass::every(job)?))
    }
}
