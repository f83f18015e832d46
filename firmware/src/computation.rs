//! The on-board correction: program, job and probe log → image, apart from both links.
//!
//! `Compute` makes a [`Computation`] of the uploads and the image buffer. The board runs it at its lowest priority, in
//! memory it lends, and hands it back to the configuration service, which writes the image to the idle slot. Meanwhile
//! the service answers requests, and a [`ProgressMeter`] says how far the computation is.

use core::sync::atomic::{AtomicU32, Ordering};

use truepath_core::errors::number;
use truepath_core::job::{self, Job, JobError, Workspace};
use truepath_core::link::{ComputeFailure, Stage};

use crate::ram_upload::RamUploads;

/// How far a computation is: written by it, read by the configuration service, without a lock.
#[derive(Debug, Default)]
pub struct ProgressMeter(AtomicU32);

impl ProgressMeter {
    /// Nothing done yet.
    pub const fn new() -> Self {
        Self(AtomicU32::new(0))
    }
    /// Stage, as its number, and the share of it that is done, 0 … 1000.
    fn set(&self, stage: Stage, permille: u16) {
        self.0.store((stage as u32) << 16 | u32::from(permille), Ordering::Relaxed);
    }
    /// What was set last.
    pub fn read(&self) -> (Stage, u16) {
        const STAGES: [Stage; 7] =
            [Stage::Job, Stage::Program, Stage::Probe, Stage::Cut, Stage::Identify, Stage::Correct, Stage::Write];
        let bits = self.0.load(Ordering::Relaxed);
        let stage = STAGES.into_iter().find(|&stage| stage as u32 == bits >> 16).unwrap_or(Stage::Job);
        (stage, bits as u16)
    }
}

/// One image to be computed.
pub struct Computation<'a> {
    /// The items, complete.
    pub(crate) uploads: RamUploads<'a>,
    /// Where the image goes.
    pub(crate) image: &'a mut [u8],
    meter: &'a ProgressMeter,
    pub(crate) made: Option<Result<usize, ComputeFailure>>,
}

impl<'a> Computation<'a> {
    pub(crate) fn new(uploads: RamUploads<'a>, image: &'a mut [u8], meter: &'a ProgressMeter) -> Self {
        meter.set(Stage::Job, 0);
        Self { uploads, image, meter, made: None }
    }

    /// Makes the image. Takes seconds to minutes; everything it needs is in itself and in `workspace`.
    pub fn run(&mut self, workspace: &mut Workspace<'_>) {
        let Self { uploads, image, meter, made } = self;
        let job = match Job::from_compact(uploads.job.content().unwrap_or(&[])) {
            Ok(job) => job,
            Err(error) => {
                *made = Some(Err(failure(Stage::Job, &error)));
                return;
            }
        };
        let program = uploads.program.content().unwrap_or(&[]);
        let probe = uploads.probe.content().unwrap_or(&[]);
        let result = job::image(&job, program, probe, workspace, image, &mut |stage, permille| {
            meter.set(link_stage(stage), permille);
        });
        let reached = meter.read().0;
        *made = Some(result.map(|made| made.bytes as usize).map_err(|error| failure(reached, &error)));
    }
}

fn link_stage(stage: job::Stage) -> Stage {
    match stage {
        job::Stage::Reading => Stage::Program,
        job::Stage::Sampling => Stage::Cut,
        job::Stage::Contacts => Stage::Probe,
        job::Stage::Identification => Stage::Identify,
        job::Stage::Design => Stage::Correct,
        job::Stage::Image => Stage::Write,
    }
}

/// A failure as it travels. The code is that of the command line as a number: three digits, and in front of them 0 for
/// `J`, 1 for `G`, 2 for `M`, 3 for `I`, 4 for `W`.
fn failure(stage: Stage, error: &JobError) -> ComputeFailure {
    let code = error.code();
    let group = "JGMIW".find(code.chars().next().unwrap_or(' ')).unwrap_or(9);
    let column = match error {
        JobError::Program(error) => error.column,
        _ => 0,
    };
    ComputeFailure { stage, code: group as u16 * 1000 + number(code), line: error.line().unwrap_or(0), column }
}
