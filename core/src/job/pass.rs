//! One pass of the cutter as job and program describe it: the contour, the cut, the sampled path.

use super::{Buffer, Compensation, ForceModel, Job, JobError, Probe};
use crate::cut::{Cantilever, Coefficients, Compliance, CutSetup, Milling, Path, PathError, Runout, Sample, WallLaw};
use crate::gcode::{
    CompensationBy, ContourOptions, ContourProgram, GcodeError, GcodeErrorKind, Memory, Options, Program, RunPart,
    Spindle, Units, is_marked_corrected, program_crc, read_contour,
};
use crate::geometry::{Block, Contour};
use crate::identify::Prior;
use crate::image::Binding;
use crate::probe::{CutWith, Given, LengthUnit};
use crate::units::{Offset, Real};

/// Largest distance between the samples of a path.
const STEP: Offset = Offset::from_um(100);

/// A pass along a contour: what job and program say together.
#[derive(Clone, Debug)]
pub struct ContourPass {
    /// The job as it was given.
    pub job: Job,
    /// What the program says about the contour.
    pub contour: ContourProgram,
    /// CRC-32 of the program.
    pub program_crc: u32,
    /// The cut; its law is helical unless the job says mean. Its allowance is the job's until a caller that knows the actual
    /// surface of the stock gives another: whoever wants to know what is cut asks here.
    pub setup: CutSetup,
    /// The correction that measured parts have to be cut with: none, unless the caller says another.
    pub cut_with: CutWith,
    /// Least and greatest feed along the contour as the program says it, mm/min, whatever the job says.
    pub written_feeds: [Real; 2],
    /// What other parts of the shop say of machine and material, under the helical law; `None`, unless the caller says it, for what
    /// the job states.
    pub believed: Option<Prior>,
}

impl ContourPass {
    /// Reads the contour of a program into `blocks` and puts it together with a job. The blocks carry the feed of the
    /// job where it gives one; those in use are the first [`ContourProgram::blocks`].
    ///
    /// # Errors
    /// A job out of range, whatever is wrong with the program, and what the two contradict each other in.
    pub fn read(job: &Job, program: &[u8], memory: &mut Memory<'_>, blocks: &mut [Block]) -> Result<Self, JobError> {
        job.check()?;
        if is_marked_corrected(program) {
            return Err(JobError::Corrected);
        }
        memory.clear();
        let contour = read_contour(&Program::new(program), memory, blocks, &options(job)).map_err(JobError::Program)?;
        match (job.tool.number, named_tool(&contour)) {
            (Some(job), Some(program)) if job != program => return Err(JobError::ToolsDiffer { job, program }),
            _ => {}
        }
        let setup = setup(job, &contour)?;
        let mut written_feeds = [Real::MAX, Real::ZERO];
        for block in blocks.iter_mut().take(contour.blocks) {
            written_feeds = [written_feeds[0].min(block.feed), written_feeds[1].max(block.feed)];
            block.feed = job.cut.feed_mm_per_min.unwrap_or(block.feed);
            if block.feed <= Real::ZERO {
                return Err(JobError::NoFeed { line: block.line });
            }
        }
        Ok(Self {
            job: *job,
            contour,
            program_crc: program_crc(program),
            setup,
            cut_with: CutWith::Nothing,
            written_feeds,
            believed: None,
        })
    }

    /// What an image of this pass belongs to. `feature` and `pass` are those of the job's part of the program; both are 1 in
    /// a program with one contour, milled to size in one pass.
    ///
    /// # Errors
    /// Neither job nor program gives the number of the tool.
    pub fn binding(&self) -> Result<Binding, JobError> {
        let tool = self.job.tool.number.or(named_tool(&self.contour)).ok_or(JobError::NoTool)?;
        let (tool_offset, setup) = (self.job.tool.offset_number, self.job.correct.setup);
        let (feature, pass) = self.job.part.map_or((1, 1), |part| (part.feature, part.pass));
        Ok(Binding { program_crc: self.program_crc, feature, pass, tool, tool_offset, setup })
    }

    /// Distance between the samples of the path: 0.1 mm, or a fiftieth of a small cutter's diameter.
    pub fn step(&self) -> Offset {
        STEP.min(Offset::from_nm(self.setup.radius.nm() / 25))
    }

    /// The contour of the blocks that were read.
    ///
    /// # Errors
    /// When they are not those of a contour.
    pub fn path_contour(blocks: &[Block]) -> Result<Contour<'_>, JobError> {
        let none = GcodeError { kind: GcodeErrorKind::NoContour, file: 0, line: 1, column: 1, start: 0, len: 0 };
        Contour::new(blocks).ok_or(JobError::Program(none))
    }

    /// Samples the path of a contour into a buffer, each sample with what `shape` makes of it, see [`Path::sample`]. A
    /// contour that cannot fit is refused before it is walked along.
    ///
    /// # Errors
    /// When the buffer is too short, or path and cutter leave no wall.
    pub fn sample<'a>(
        &self,
        contour: &Contour,
        buffer: &'a mut [Sample],
        shape: impl FnMut(&mut Sample),
    ) -> Result<Path<'a>, JobError> {
        self.sample_every(self.step(), contour, buffer, shape)
    }

    /// The same at another step.
    ///
    /// # Errors
    /// As [`ContourPass::sample`].
    pub fn sample_every<'a>(
        &self,
        step: Offset,
        contour: &Contour,
        buffer: &'a mut [Sample],
        shape: impl FnMut(&mut Sample),
    ) -> Result<Path<'a>, JobError> {
        let lent = buffer.len();
        // Every block but the first may save one sample.
        let steps = contour.length().nm().checked_div(step.nm()).unwrap_or(0).unsigned_abs() as usize;
        let least = steps.saturating_sub(contour.blocks().len());
        if least > lent {
            return Err(JobError::full(Buffer::Samples, least, lent));
        }
        Path::sample(contour, &self.setup, step, buffer, shape).map_err(|error| match error {
            PathError::NoWall { line } => JobError::Undercut { line },
            PathError::Jagged { line } => JobError::Jagged { line },
            PathError::BufferTooShort { needed, lent } => JobError::full(Buffer::Samples, needed, lent),
        })
    }

    /// The prior of machine and material for a wall law: what the shop believes, or what the job states.
    pub fn prior(&self, law: WallLaw) -> Prior {
        self.believed.filter(|_| law == WallLaw::Helical).unwrap_or_else(|| self.stated_prior(law))
    }

    /// The prior of what the job states for a wall law; a wide one of what it does not.
    pub fn stated_prior(&self, law: WallLaw) -> Prior {
        let mut prior = Prior::around(self.coefficients(), self.compliance(), law);
        if !self.job.force.stated {
            prior = prior.without_material();
        }
        if self.job.machine.stated { prior } else { prior.without_machine() }
    }

    /// The stated force coefficients.
    pub const fn coefficients(&self) -> Coefficients {
        let force = &self.job.force;
        Coefficients { ktc: force.ktc, krc: force.krc, kte: force.kte, kre: force.kre, size_exponent: Real::ZERO }
    }

    /// The stated compliance, with that of the cutter where the job describes it.
    pub fn compliance(&self) -> Compliance {
        let machine = Compliance::from_stiffness(self.job.machine.stiffness_x, self.job.machine.stiffness_y);
        let tool = &self.job.tool;
        let Some(stickout) = tool.cantilever else { return machine };
        Cantilever::new(tool.diameter, tool.teeth, stickout.length, self.setup.axial_depth, stickout.material)
            .mounted_in(machine)
    }

    /// What is known about a measurement file of this pass before it is read.
    pub fn probe_given(&self, probe: &Probe) -> Given {
        Given {
            format: probe.format,
            layout: probe.layout.unwrap_or_default(),
            work_offset: probe.work_offset,
            program_unit: match self.contour.units {
                Units::Inches => LengthUnit::Inch,
                Units::Millimetres => LengthUnit::Millimetre,
            },
            program_crc: self.program_crc,
            ball_diameter: probe.ball_diameter,
            cut_with: self.cut_with,
        }
    }
}

impl Job {
    /// How the program of the job is read.
    pub fn program_options(&self) -> Options<'static> {
        let radius = Offset::from_nm(self.tool.diameter.nm() / 2);
        let compensation = match (self.tool.compensation, self.tool.number) {
            (Compensation::Centre, _) => CompensationBy::Nothing,
            (Compensation::Radius, Some(tool)) => CompensationBy::ToolRadius { tool, radius },
            (Compensation::Radius, None) => CompensationBy::Radius(radius),
        };
        let Self { dialect, decimal, arc_centres, .. } = *self;
        Options { compensation, dialect, decimal, arc_centres, ..Options::default() }
    }
}

/// Where a job's contour is in its program.
fn options(job: &Job) -> ContourOptions {
    let part = job.part.map(|part| RunPart { run: part.run, first: part.first_block, blocks: part.blocks });
    ContourOptions { part, program: job.program_options(), ..ContourOptions::default() }
}

/// The tool that the program has changed to before the contour. T0 empties the spindle and names none.
fn named_tool(contour: &ContourProgram) -> Option<u32> {
    contour.tool.filter(|&number| number > 0)
}

/// The cut, from job and program together.
fn setup(job: &Job, contour: &ContourProgram) -> Result<CutSetup, JobError> {
    let wall = match (job.wall, contour.wall) {
        (Some(job), Some(program)) if job != program => return Err(JobError::WallsDiffer),
        (Some(side), _) | (None, Some(side)) => side,
        (None, None) => return Err(JobError::NoWall),
    };
    let speed = job.cut.spindle_rpm.or(contour.speed).filter(|s| *s > Real::ZERO);
    let diameter = job.tool.measured_diameter.unwrap_or(job.tool.diameter);
    let setup = CutSetup {
        radius: Offset::from_nm(diameter.nm() / 2),
        teeth: job.tool.teeth,
        helix_deg: job.tool.helix_deg,
        axial_depth: job.cut.axial_depth.mm(),
        allowance: job.allowance,
        spindle_rpm: speed.ok_or(JobError::NoSpeed)?,
        wall,
        milling: Milling::of(wall, contour.spindle != Spindle::CounterClockwise),
        law: match job.force.model {
            ForceModel::Mean => WallLaw::Mean,
            ForceModel::Helical | ForceModel::Auto => WallLaw::Helical,
        },
        runout: Runout { offset: job.tool.runout, behind: job.tool.runout_deg * Real::PI / Real::from_int(180) },
    };
    if setup.fits_force_table() { Ok(setup) } else { Err(JobError::Flutes) }
}
