//! One pass of the cutter as job and program describe it: the contour, the cut, the sampled path.

use truepath_core::cut::{
    Cantilever, Coefficients, Compliance, CutSetup, Milling, Path, PathError, Sample, ToolMaterial, WallLaw,
};
use truepath_core::gcode::{
    ContourOptions, ContourProgram, GcodeError, GcodeErrorKind, Spindle, Units, is_marked_corrected, program_crc,
    read_contour,
};
use truepath_core::geometry::{Block, Contour, Curve, Point};
use truepath_core::identify::Prior;
use truepath_core::units::{Offset, Real};

use crate::diagnostics::{Failure, InputError, Source};
use crate::job::{CutterMaterial, ForceModel, Job};

/// Largest distance between the samples of a path.
const STEP: Offset = Offset::from_um(100);
/// Blocks a program may hold before the buffer is enlarged.
const FIRST_BUFFER: usize = 1 << 12;
/// Blocks a program may hold at all.
const LARGEST_BUFFER: usize = 1 << 24;

/// A pass: what the core needs to know of it.
#[derive(Clone, Debug)]
pub struct Pass {
    /// The job.
    pub job: Job,
    /// The program.
    pub program: Source,
    /// CRC-32 of the program.
    pub program_crc: u32,
    /// The contour, with the feed of the job where it gives one.
    pub blocks: Vec<Block>,
    /// What the program says about the contour.
    pub contour: ContourProgram,
    /// The cut; its law is helical unless the job says `mean`.
    pub setup: CutSetup,
    /// Things the user should know, in the order in which they were noticed.
    pub warnings: Vec<String>,
}

/// Buffer for the samples of a path.
#[derive(Clone, Debug, Default)]
pub struct PathBuffer(Vec<Sample>);

impl Pass {
    /// Reads job and program.
    ///
    /// # Errors
    /// Whatever is wrong with either, and what they contradict each other in.
    pub fn read(job: Job) -> Result<Self, Failure> {
        let program = job.read_program()?;
        Self::new(job, program)
    }

    /// From a job and a program already read.
    ///
    /// # Errors
    /// As [`Pass::read`].
    pub fn new(job: Job, program: Source) -> Result<Self, Failure> {
        if is_marked_corrected(program.bytes()) {
            return Err(InputError::new(
                "J011",
                "the program is already corrected (it carries the mark TRUEPATH CORRECTED)",
                "the original program",
                "name the original program in the job: correcting a correction would move the wall twice",
            )
            .at(job.source(), job.span("program"))
            .into());
        }
        let (mut blocks, contour) = read_blocks(&program)?;
        let mut warnings: Vec<String> =
            contour.summary.warnings.as_slice().iter().map(|w| format!("{}: {w}", program.name())).collect();
        if contour.spindle == Spindle::Stopped {
            warnings.push(format!(
                "{}: neither M3 nor M4 before the contour: a clockwise spindle is assumed, on which climb or conventional depends",
                program.name()
            ));
        }
        let mut pass = Self {
            program_crc: program_crc(program.bytes()),
            setup: setup(&job, &contour)?,
            job,
            program,
            blocks: Vec::new(),
            contour,
            warnings,
        };
        let feed = pass.job.cut.feed_mm_per_min;
        for block in &mut blocks {
            block.feed = feed.unwrap_or(block.feed);
            if block.feed <= Real::ZERO {
                return Err(InputError::new(
                    "J012",
                    "the contour has no feed: there is no F before this line",
                    "a feed rate",
                    "add an F word to the program, or feed_mm_per_min to [cut] of the job",
                )
                .at(&pass.program, pass.program.span_at(block.line, 1, 1))
                .into());
            }
        }
        pass.blocks = blocks;
        Ok(pass)
    }

    /// Distance between the samples of the path: 0.1 mm, or a fiftieth of a small cutter's diameter.
    pub fn step(&self) -> Offset {
        STEP.min(Offset::from_nm(self.setup.radius.nm() / 25))
    }

    /// The contour.
    pub fn path_contour(&self) -> Contour<'_> {
        Contour::new(&self.blocks).unwrap_or_else(|| unreachable!("the reader gives blocks end to end"))
    }

    /// Samples the path into a buffer.
    ///
    /// # Errors
    /// When an outside arc is so tight that it leaves no wall.
    pub fn sample<'a>(&self, buffer: &'a mut PathBuffer) -> Result<Path<'a>, Failure> {
        let contour = self.path_contour();
        buffer.0 = vec![Sample::BLANK; Path::samples_needed(&contour, &self.setup, self.step())];
        Path::sample(&contour, &self.setup, self.step(), &mut buffer.0).map_err(|error| match error {
            PathError::NoWall { line } => InputError::new(
                "J013",
                "this arc turns round the wall more tightly than the cutter: it leaves no wall to correct",
                "an outside arc of the path at least as wide as the cutter's radius",
                "check the side (wall = \"left\" or \"right\") and the cutter's diameter in the job",
            )
            .at(&self.program, self.program.span_at(line, 1, 1))
            .into(),
            PathError::BufferTooShort { needed, lent } => {
                Failure::Internal(format!("a path needs {needed} samples, {lent} were counted"))
            }
        })
    }

    /// The prior of machine and material for a wall law.
    pub fn prior(&self, law: WallLaw) -> Prior {
        Prior::around(self.coefficients(), self.compliance(), law)
    }

    /// The stated force coefficients.
    pub fn coefficients(&self) -> Coefficients {
        let force = &self.job.force;
        Coefficients { ktc: force.ktc, krc: force.krc, kte: force.kte, kre: force.kre, size_exponent: Real::ZERO }
    }

    /// The stated compliance, with that of the cutter where the job describes it.
    pub fn compliance(&self) -> Compliance {
        let machine = Compliance::from_stiffness(self.job.machine.stiffness_x, self.job.machine.stiffness_y);
        let Some(cutter) = self.job.tool.cantilever else { return machine };
        let material = match cutter.material {
            CutterMaterial::Hss => ToolMaterial::HighSpeedSteel,
            CutterMaterial::Carbide => ToolMaterial::Carbide,
        };
        let tool = &self.job.tool;
        Cantilever::new(tool.diameter, tool.teeth, cutter.stickout, self.setup.axial_depth, material)
            .mounted_in(machine)
    }
}

/// Reads the contour of a program, whatever its length.
///
/// # Errors
/// Whatever is wrong with the program.
pub fn read_blocks(program: &Source) -> Result<(Vec<Block>, ContourProgram), Failure> {
    let origin = Point::from_nm(0, 0);
    let away = Point::from_nm(1, 0);
    let curve = Curve::line(origin, away).ok_or_else(|| Failure::Internal("a line has no length".to_owned()))?;
    let blank = Block { curve, s: Offset::ZERO, feed: Real::ZERO, line: 0 };
    let mut capacity = FIRST_BUFFER;
    loop {
        let mut blocks = vec![blank; capacity];
        match read_contour(program.bytes(), &mut blocks, &ContourOptions::default()) {
            Ok(contour) => {
                blocks.truncate(contour.blocks);
                return Ok((blocks, contour));
            }
            Err(GcodeError { kind: GcodeErrorKind::ContourTooLong { .. }, .. }) if capacity < LARGEST_BUFFER => {
                capacity *= 8;
            }
            Err(error) => return Err(InputError::of_program(program, &error).into()),
        }
    }
}

/// The cut, from job and program together.
fn setup(job: &Job, contour: &ContourProgram) -> Result<CutSetup, Failure> {
    let wall = match (job.wall, contour.wall) {
        (Some(job_side), Some(program_side)) if job_side != program_side => {
            return Err(InputError::new(
                "J014",
                "the job says the wall lies on one side of travel and G41/G42 of the program on the other",
                "the same side in both",
                "remove wall from the job: G41 means the wall is on the right of travel, G42 on the left",
            )
            .at(job.source(), job.span("wall"))
            .into());
        }
        (Some(side), _) | (None, Some(side)) => side,
        (None, None) => {
            return Err(InputError::new(
                "J015",
                "neither job nor program says on which side the wall lies",
                "wall = \"left\" or wall = \"right\", as seen in the direction of travel",
                "add wall to the job (inside pockets cut counter-clockwise have it on the right)",
            )
            .at(job.source(), 0..0)
            .into());
        }
    };
    let clockwise = contour.spindle != Spindle::CounterClockwise;
    let Some(spindle_rpm) = job.cut.spindle_rpm.or(contour.speed).filter(|s| *s > Real::ZERO) else {
        return Err(InputError::new(
            "J016",
            "neither job nor program gives a spindle speed",
            "an S word before the contour, or spindle_rpm in [cut]",
            "add spindle_rpm to [cut] of the job",
        )
        .at(job.source(), job.span("cut"))
        .into());
    };
    let diameter = job.tool.measured_diameter.unwrap_or(job.tool.diameter);
    let setup = CutSetup {
        radius: Offset::from_nm(diameter.nm() / 2),
        teeth: job.tool.teeth,
        helix_deg: job.tool.helix_deg,
        axial_depth: job.cut.axial_depth.mm(),
        allowance: job.allowance,
        spindle_rpm,
        wall,
        milling: Milling::of(wall, clockwise),
        law: match job.force.model {
            ForceModel::Mean => WallLaw::Mean,
            ForceModel::Helical | ForceModel::Auto => WallLaw::Helical,
        },
    };
    if !setup.fits_force_table() {
        return Err(InputError::new(
            "J019",
            format!(
                "a helix of this angle winds round the cutter too often over an axial depth of {} mm",
                job.cut.axial_depth.nm() as f64 / 1e6
            ),
            "at most 64 flutes in the stock at once",
            "check axial_depth_mm, diameter_mm, teeth and helix_deg",
        )
        .at(job.source(), job.span("cut.axial_depth_mm"))
        .into());
    }
    Ok(setup)
}

/// The unit of the program's words, for the files a control writes in it.
pub fn length_unit(contour: &ContourProgram) -> truepath_core::probe::LengthUnit {
    match contour.units {
        Units::Inches => truepath_core::probe::LengthUnit::Inch,
        Units::Millimetres => truepath_core::probe::LengthUnit::Millimetre,
    }
}

/// Climb or conventional, in words.
pub const fn milling_name(milling: Milling) -> &'static str {
    match milling {
        Milling::Climb => "climb",
        Milling::Conventional => "conventional",
    }
}
