//! One pass of the cutter as job and program describe it, in memory that grows with them.
//!
//! What decides numbers is [`truepath_core::job`], which the device runs as well; here it is given buffers, and what it
//! refuses becomes a diagnostic.

use truepath_core::cut::{Milling, Path, Runout, Sample};
use truepath_core::gcode::{
    ContourOptions, ContourProgram, Dialect, GcodeError, GcodeErrorKind, HostMemory, Options, Program, Spindle,
    WarningKind, read_contour,
};
use truepath_core::geometry::{Block, Contour, Point, Side};
use truepath_core::job::{self, Compensation, JobError, Part};
use truepath_core::units::{Offset, Real};
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::length::{Remark, Unit};
use truepath_ground::rows::median;
use truepath_ground::units::{float, mm};

use crate::codes::K002;
use crate::cutter;
use crate::depth;
use crate::drawn::{Drawn, drawn};
use crate::feature;
use crate::feature::{FeaturePass, FeatureSummary, Plan};
use crate::feed::Schedule;
use crate::job::{JobFile, Which};
use crate::probe_format::settled;
use crate::probed_stock::{self, ProbedStock, TouchedPass};
use crate::refusal::Inputs;
use crate::roughed_stock::{self, Pushed, RoughedPass, RoughedStock, SAID};
use crate::surface::{Surface, stock_point};

/// Blocks a program may hold before the buffer is enlarged.
const FIRST_BUFFER: usize = 1 << 12;
/// Blocks a program may hold at all.
const LARGEST_BUFFER: usize = 1 << 24;

/// A pass on the host: [`job::ContourPass`], which is all that the core knows of it, with the files and the feature it comes
/// from and the memory it takes.
#[derive(Clone, Debug)]
pub struct Pass {
    /// The job, with wall, allowance and tool of its feature.
    pub job: JobFile,
    /// The program.
    pub program: Source,
    /// Job and program in numbers; `core.setup.allowance` is the allowance of the cut, whatever it came from.
    pub core: job::ContourPass,
    /// The contour, with the feed of the job where it gives one.
    pub blocks: Vec<Block>,
    /// The actual surface of the stock; without one the stock is the parallel curve at the allowance.
    pub surface: Option<Surface>,
    /// The stock as touches have found it or roughing leaves it; never beside a surface.
    pub stock: Option<KnownStock>,
    /// The feature it belongs to; `None` in a program with one cut and no names.
    pub plan: Option<Plan>,
    /// Things the user should know, in the order in which they were noticed.
    pub warnings: Vec<Remark>,
}

/// Stock that is not even, and why that is known.
#[derive(Clone, Debug)]
pub enum KnownStock {
    /// It was touched before the pass.
    Touched(ProbedStock),
    /// The program's own roughing leaves it.
    Roughed(RoughedStock),
}

impl KnownStock {
    /// Mean along the contour, mm.
    pub const fn mean_mm(&self) -> f64 {
        match self {
            Self::Touched(stock) => stock.facts.mean_mm,
            Self::Roughed(stock) => stock.facts.mean_mm,
        }
    }
}

/// Buffer for the samples of a path.
#[derive(Clone, Debug, Default)]
pub struct PathBuffer(Vec<Sample>);

impl Pass {
    /// The same pass with a cutter whose axis stands off by so much, its direction towards a tooth, and a sentence about it.
    #[must_use]
    pub fn running_out(&self, offset: Offset, said: Remark) -> Self {
        let mut pass = self.clone();
        pass.core.setup.runout = Runout { offset, behind: Real::ZERO };
        pass.warnings.push(said);
        pass
    }

    /// Reads job and program.
    ///
    /// # Errors
    /// Whatever is wrong with either, and what they contradict each other in.
    pub fn read(job: JobFile) -> Result<Self, Failure> {
        let program = job.read_program()?;
        Self::new(job, program)
    }

    /// From a job and a program already read.
    ///
    /// # Errors
    /// As [`Pass::read`].
    pub fn new(mut job: JobFile, program: Source) -> Result<Self, Failure> {
        cutter::settle(&mut job, &program)?;
        let drawn = find_out_drawn(&mut job, &program)?;
        let plan = feature::plan(&job, &program)?;
        Self::of_plan(job, program, plan, drawn.as_ref())?.over_known()
    }

    /// Reads job and program: a pass for every contour that the job's cutter finishes, in the order of the program; the one
    /// that the job names, where it names one.
    ///
    /// # Errors
    /// As [`Pass::read`].
    pub fn every(mut job: JobFile) -> Result<Vec<Self>, Failure> {
        let program = job.read_program()?;
        cutter::settle(&mut job, &program)?;
        let drawn = find_out_drawn(&mut job, &program)?;
        let plans = feature::plans(&job, &program)?;
        if plans.is_empty() {
            return Ok(vec![Self::of_plan(job, program, None, drawn.as_ref())?.over_known()?]);
        }
        let several = plans.len() > 1;
        let (mut passes, mut refused, mut left) = (Vec::new(), None, Vec::new());
        for plan in plans {
            let mut job = job.clone();
            if several {
                job.which.feature.clone_from(&plan.id);
            }
            let name = plan.id.clone().unwrap_or_default();
            match Self::of_plan(job, program.clone(), Some(plan), drawn.as_ref()).and_then(Self::over_known) {
                Ok(pass) => passes.push(pass),
                Err(Failure::Input(error)) if several => {
                    left.push(Remark::from(format!("{name} is left as it is: {}: {}", error.code(), error.found())));
                    refused = refused.or(Some(Failure::Input(error)));
                }
                Err(failure) => return Err(failure),
            }
        }
        // What is wrong with all of them is wrong with job or program.
        match passes.first_mut() {
            Some(first) => first.warnings.extend(left),
            None => return Err(refused.unwrap_or_else(|| Failure::Internal("a program of no contour".to_owned()))),
        }
        Ok(passes)
    }

    /// The other contours of the program that the job's cutter finishes; none where that is not certain.
    pub fn siblings(&self) -> Vec<Self> {
        let Some(plan) = self.plan.as_ref().filter(|plan| !plan.others.is_empty()) else { return Vec::new() };
        let own = plan.number;
        let mut job = self.job.clone();
        job.which = Which::default();
        let of_file = Self::every(job).unwrap_or_default().into_iter();
        of_file
            .filter(|other| other.plan.as_ref().is_some_and(|plan| plan.number != own))
            .map(|other| other.cut_with(self.core.cut_with))
            .collect()
    }

    /// The level of a feature that the job is about, or its first.
    fn of_plan(mut job: JobFile, program: Source, plan: Option<Plan>, drawn: Option<&Drawn>) -> Result<Self, Failure> {
        let level = job.which.pass.unwrap_or(1);
        depth::settle(&mut job, &program, plan.as_ref(), level)?;
        job.numbers.part = plan.as_ref().map(|plan| plan.level(level).map(|pass| pass.part)).transpose()?;
        let mut pass = Self::of_part(job, program, plan)?;
        let found_out = drawn.map(|drawn| {
            let (path, key) = match drawn.compensation {
                Compensation::Centre => ("the path of the cutter's centre", "centre"),
                Compensation::Radius => ("the outline of the part", "radius"),
            };
            let name = pass.program.name();
            format!("{name}: G41 or G42 leads along {path}: {}; tool.compensation = \"{key}\" says so", drawn.why)
        });
        pass.warnings.extend(found_out.map(Remark::from));
        Ok(pass)
    }

    /// Reads the part of the program that the job names by now.
    fn of_part(mut job: JobFile, program: Source, plan: Option<Plan>) -> Result<Self, Failure> {
        if let Some(plan) = &plan {
            let numbers = &mut job.numbers;
            numbers.wall = plan.wall.or(numbers.wall);
            numbers.allowance = plan.allowance.unwrap_or(numbers.allowance);
            numbers.tool.number = plan.tool.or(numbers.tool.number);
        }
        let read = |blocks: &mut [Block]| {
            let mut memory = Box::new(HostMemory::new());
            job::ContourPass::read(&job.numbers, program.bytes(), &mut memory.lend(), blocks)
        };
        let too_long = |e: &JobError| matches!(e, JobError::Program(e) if is_too_long(e));
        let (mut blocks, core) = with_enough_blocks(read, too_long).map_err(|error| {
            Inputs { job: &job, program: &program, probe: None, unit: Unit::default() }.refused(&error)
        })?;
        blocks.truncate(core.contour.blocks);
        let dialect = job.numbers.dialect;
        let warnings = core.contour.summary.warnings.as_slice().iter().filter(|w| !arms_truepath(w.kind, dialect));
        let mut warnings: Vec<Remark> = warnings.map(|w| format!("{}: {w}", program.name()).into()).collect();
        warnings.extend(job.assumed.iter().map(|assumed| assumed.text().into()));
        if core.contour.spindle == Spindle::Stopped {
            let said = "neither M3 nor M4 before the contour: a clockwise spindle is assumed, on which climb or conventional depends";
            warnings.push(format!("{}: {said}", program.name()).into());
        }
        let unit = core.contour.units.into();
        warnings.extend(other_feed(&job, &program, core.written_feeds, unit).map(Remark::from));
        let of_plan = plan.iter().flat_map(|p| &p.warnings);
        warnings.extend(of_plan.map(|said| said.clone().remark(unit)));
        let surface = job.read_surface()?;
        let pass = Self { job, program, core, blocks, surface: None, stock: None, plan, warnings };
        match surface {
            Some(surface) => pass.over(surface),
            None => Ok(pass),
        }
    }

    /// The same pass over the stock that the touches which the job names have found, or that its program's roughing leaves.
    fn over_known(self) -> Result<Self, Failure> {
        if let Some(roughing) = self.job.roughing {
            let stock = self.of_roughing(|pass| RoughedStock::read(pass, roughing))?;
            let said = self.unit().remark(|unit| stock.facts.text(self.program.name(), unit));
            let mut pass = self.over_stock(KnownStock::Roughed(stock));
            pass.warnings.push(said);
            return Ok(pass);
        }
        let Some(file) = self.job.read_stock_probe()? else {
            let hint = self.surface.is_none().then(|| self.of_roughing(roughed_stock::hint)).flatten();
            let mut pass = self;
            pass.warnings.extend(hint.map(|said| said.remark(pass.unit())));
            return Ok(pass);
        };
        let stock = {
            let refused = |error: &JobError| self.refused_of(&file, error);
            let contour = self.path_contour();
            let touched =
                TouchedPass { job: &self.job, core: &self.core, plan: self.plan.as_ref(), contour, refused: &refused };
            probed_stock::read(&touched, &file)?
        };
        Ok(match stock {
            Some(stock) => {
                let said = self.unit().remark(|unit| stock.facts.text(unit));
                let mut pass = self.over_stock(KnownStock::Touched(stock));
                pass.warnings.push(said);
                pass
            }
            None => {
                let mut pass = self;
                let said = format!("{}: no touch is of this contour: its stock is taken as even", file.name());
                pass.warnings.push(said.into());
                pass
            }
        })
    }

    /// The same pass over stock that is known: its allowance becomes the mean one along the contour.
    #[must_use]
    pub fn over_stock(mut self, stock: KnownStock) -> Self {
        self.core.setup.allowance = Offset::from_nm((stock.mean_mm() * 1e6).round() as i64);
        self.stock = Some(stock);
        self
    }

    /// The same over another pass's stock, where that is known.
    fn over_stock_of(self, other: &Self) -> Self {
        match &other.stock {
            Some(stock) => self.over_stock(stock.clone()),
            None => self,
        }
    }

    /// The same cut in another text of its program; the stock that was touched stays what it is.
    ///
    /// # Errors
    /// As [`Pass::read`].
    pub fn of_text(&self, mut job: JobFile, program: Source) -> Result<Self, Failure> {
        (job.stock_probe, job.roughing) = (None, None);
        Ok(Self::new(job, program)?.over_stock_of(self))
    }

    /// The same pass over an actual surface: its allowance becomes the median distance of the surface from the finished
    /// wall.
    ///
    /// # Errors
    /// `K002` when the surface is not beside the contour, or not between the finished wall and the cutter's far side.
    pub fn over(mut self, surface: Surface) -> Result<Self, Failure> {
        let mut buffer = PathBuffer::default();
        let mut allowances: Vec<f64> = {
            let path = self.sample(&mut buffer)?;
            let radius = mm(self.core.setup.radius);
            let contour = &path.samples()[path.first()..path.first() + path.count()];
            let beside = surface
                .beside(contour, radius)
                .ok_or_else(|| self.no_stock("lies nowhere beside the contour".to_owned()))?;
            let worst = beside
                .iter()
                .zip(contour)
                .map(|(d, sample)| (radius - d, sample))
                .find(|(a, _)| *a <= 0.0 || *a >= 2.0 * radius);
            if let Some((allowance, sample)) = worst {
                let unit = self.unit();
                let [x, y] = [sample.point.x, sample.point.y].map(|p| unit.of(p.nm() as f64 / 1e6));
                let (left, name) = (unit.of(allowance), unit.name());
                return Err(
                    self.no_stock(format!("leaves {left:.3} {name} on the finished wall beside X{x:.3} Y{y:.3}"))
                );
            }
            beside.iter().map(|d| radius - d).collect()
        };
        let median = median(&mut allowances);
        let allowance = Offset::from_nm((median * 1e6).round() as i64);
        self.core.setup.allowance = allowance;
        (self.surface, self.stock) = (Some(surface), None);
        Ok(self)
    }

    fn no_stock(&self, found: String) -> Failure {
        let expected = "a surface along the whole contour, between the finished wall and the far side of the cutter";
        let error = K002.error(format!("the surface of the stock {found}"), expected);
        match &self.job.surface {
            Some(path) => error.in_file(path).into(),
            None => error.into(),
        }
    }

    /// The same pass with the format of a probe file, where the job leaves that to the file.
    ///
    /// # Errors
    /// What is wrong with the file at first sight.
    pub fn of_file(mut self, file: &Source) -> Result<Self, Failure> {
        let probe = settled(&self.job, file)?.probe;
        self.job.numbers.probe = Some(probe);
        self.core.job.probe = Some(probe);
        Ok(self)
    }

    /// The unit of the program on the contour, in which people are told.
    pub fn unit(&self) -> Unit {
        self.core.contour.units.into()
    }

    /// The level of the feature, from 1.
    pub fn level(&self) -> u32 {
        self.job.numbers.part.map_or(1, |part| part.pass)
    }

    /// What is told of the feature; `corrected` are the levels whose correction was written.
    pub fn feature(&self, corrected: &[u32]) -> Option<FeatureSummary> {
        self.plan.as_ref().map(|plan| plan.summary(self.level(), corrected))
    }

    /// The moves that lead to the contour and away from it, where they are known.
    pub fn leads(&self) -> [&[Block]; 2] {
        let pass = self.plan.as_ref().and_then(|plan| plan.level(self.level()).ok());
        pass.map_or([&[], &[]], |pass| [&pass.leads[0], &pass.leads[1]])
    }

    /// The same pass, whose measured parts have to be cut with a correction.
    #[must_use]
    pub const fn cut_with(mut self, correction: truepath_core::probe::CutWith) -> Self {
        self.core.cut_with = correction;
        self
    }

    /// The same feature at another level.
    ///
    /// # Errors
    /// As [`Pass::read`], and when there is no such level.
    pub fn at_level(&self, number: u32) -> Result<Self, Failure> {
        let mut job = self.job_as_cut();
        job.which.pass = Some(number);
        let other = Self::of_plan(job, self.program.clone(), self.plan.clone(), None)?;
        Ok(other.over_stock_of(self).cut_with(self.core.cut_with))
    }

    /// One of the passes of the same feature, spring passes included. `wall` is the side of its own travel; `None` where
    /// the program says it.
    ///
    /// # Errors
    /// As [`Pass::read`].
    pub fn along(&self, pass: &FeaturePass, wall: Option<Side>) -> Result<Self, Failure> {
        let mut job = self.job_as_cut();
        job.numbers.part = Some(pass.part);
        job.numbers.wall = wall;
        let plan = self.plan.clone().map(|plan| Plan { wall, ..plan });
        Ok(Self::of_part(job, self.program.clone(), plan)?.over_stock_of(self))
    }

    /// A run that roughs before this pass, with this pass's cutter, over what the runs before it have left: as it is programmed.
    ///
    /// # Errors
    /// As [`Pass::read`], and where it is no run of the roughing of this pass.
    pub fn roughed_by(&self, number: u32) -> Result<Self, Failure> {
        let none = || Failure::Internal(format!("run {number} does not rough this pass"));
        let Some(KnownStock::Roughed(stock)) = &self.stock else { return Err(none()) };
        let found = self.of_roughing(|pass| {
            let (run, axial_depth) = stock.run(number, pass)?;
            Some((run, axial_depth, stock.side(run, pass)?))
        });
        let (run, axial_depth, side) = found.ok_or_else(none)?;
        let mut job = self.job_as_cut();
        let blocks = u32::try_from(run.blocks.len()).map_err(|_| none())?;
        job.numbers.part =
            Some(Part { feature: 1, pass: 1, run: number, first_block: 0, blocks, alike: Default::default() });
        job.numbers.wall = Some(side);
        job.numbers.cut.feed_mm_per_min = None;
        job.numbers.cut.axial_depth = axial_depth;
        job.numbers.correct.band = [Offset::ZERO, axial_depth];
        let mut rough = Self::of_part(job, self.program.clone(), None)?;
        rough.core.setup.allowance = rough.of_roughing(|rough| stock.mean_before(rough))?;
        rough.stock = Some(KnownStock::Roughed(stock.clone()));
        Ok(rough)
    }

    /// Whether its own cutter has roughed before it.
    pub fn is_roughed_by_its_cutter(&self) -> bool {
        matches!(&self.stock, Some(KnownStock::Roughed(stock)) if self.of_roughing(|pass| stock.is_of_the_cutter_of(pass)))
    }

    /// Numbers of the runs of roughing whose paths lie beside the contour, in their order; none where the stock is not what roughing leaves.
    ///
    /// # Errors
    /// As [`Pass::sample`].
    pub fn roughing_runs(&self) -> Result<Vec<u32>, Failure> {
        match &self.stock {
            Some(KnownStock::Roughed(stock)) => self.of_roughing(|pass| stock.runs_beside(pass)),
            _ => Ok(Vec::new()),
        }
    }

    /// The same pass where the runs of its roughing left so much more than their paths say, and by how much its stock is another
    /// by that at most, mm.
    ///
    /// # Errors
    /// As [`Pass::sample`].
    pub fn over_pushed(&self, pushed: Vec<Pushed>) -> Result<(Self, f64), Failure> {
        let Some(KnownStock::Roughed(stock)) = &self.stock else { return Ok((self.clone(), 0.0)) };
        let left = self.of_roughing(|pass| stock.pushed(pass, pushed))?;
        let change = left.largest_change(stock);
        Ok((self.clone().over_stock(KnownStock::Roughed(left)), change))
    }

    fn of_roughing<T>(&self, of: impl FnOnce(&RoughedPass<'_>) -> T) -> T {
        let Self { job, program, core, plan, .. } = self;
        let refused = |error: &JobError| self.refused(error);
        let (plan, contour) = (plan.as_ref(), self.path_contour());
        of(&RoughedPass { job, program, core, plan, contour, refused: &refused })
    }

    /// What a run that roughs left more, from what it left at samples of its path: index and mm, in the order of the path.
    pub fn pushed(&self, path: &Path<'_>, left: impl Iterator<Item = (usize, f64)>) -> Pushed {
        let number = self.job.numbers.part.map_or(0, |part| part.run);
        let samples = path.samples();
        let told = left.filter_map(|(index, more)| {
            let sample = samples.get(index).filter(|sample| sample.on_wall && !sample.near_corner)?;
            Some([mm(sample.s), more])
        });
        Pushed { number, side: self.core.setup.wall, more: told.collect() }
    }

    /// Says what roughing leaves as it is known by now.
    pub fn say_roughing(&mut self) {
        let Some(KnownStock::Roughed(stock)) = &self.stock else { return };
        let said = self.unit().remark(|unit| stock.facts.text(self.program.name(), unit));
        let before = format!("{}: {SAID}", self.program.name());
        match self.warnings.iter_mut().find(|text| text.starts_with(&before)) {
            Some(text) => *text = said,
            None => self.warnings.push(said),
        }
    }

    /// The job with the allowance of the cut, for another pass of the same feature.
    fn job_as_cut(&self) -> JobFile {
        let mut job = self.job.clone();
        job.numbers.allowance = self.core.setup.allowance;
        job
    }

    /// The failure for an error of the core, pointing into job or program.
    pub fn refused(&self, error: &JobError) -> Failure {
        self.inputs(None).refused(error)
    }

    /// The same, pointing into a probe file where the error is there.
    pub fn refused_of(&self, probe: &Source, error: &JobError) -> Failure {
        self.inputs(Some(probe)).refused(error)
    }

    fn inputs<'a>(&'a self, probe: Option<&'a Source>) -> Inputs<'a> {
        Inputs { job: &self.job, program: &self.program, probe, unit: self.unit() }
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
        self.sample_fed(buffer, None)
    }

    /// Samples the path with the feeds of a schedule, where there is one, in place of those of the program.
    ///
    /// # Errors
    /// As [`Pass::sample`].
    pub fn sample_fed<'a>(&self, buffer: &'a mut PathBuffer, schedule: Option<&Schedule>) -> Result<Path<'a>, Failure> {
        let contour = self.path_contour();
        let needed = Path::samples_needed(&contour, &self.core.setup, self.core.step());
        let fed = |sample: &mut Sample| {
            if let Some(schedule) = schedule {
                sample.feed = schedule.feed(sample.s, sample.feed);
            }
        };
        let Some(surface) = &self.surface else {
            buffer.0 = vec![Sample::BLANK; needed];
            let radius = mm(self.core.setup.radius);
            let mut swept = match &self.stock {
                Some(KnownStock::Roughed(stock)) => Some(self.of_roughing(|pass| stock.swept(pass))),
                _ => None,
            };
            let shape = |sample: &mut Sample| {
                if let Some(KnownStock::Touched(stock)) = &self.stock {
                    sample.stock = stock_point(sample, radius - stock.allowance.at(mm(sample.s)));
                }
                if let Some(swept) = &mut swept {
                    sample.stock = stock_point(sample, swept.distance(sample));
                }
                fed(sample);
            };
            return self.core.sample(&contour, &mut buffer.0, shape).map_err(|error| self.refused(&error));
        };
        let mut even = vec![Sample::BLANK; needed];
        let stock: Vec<Point> = {
            let path = self.core.sample(&contour, &mut even, |_| ()).map_err(|error| self.refused(&error))?;
            let samples = path.samples();
            let beside = surface.beside(samples, mm(self.core.setup.radius));
            let beside = beside.ok_or_else(|| self.no_stock("lies nowhere beside the contour".to_owned()))?;
            samples.iter().zip(beside).map(|(sample, d)| stock_point(sample, d)).collect()
        };
        buffer.0 = even;
        // The walk gives the samples in the same order again.
        let mut next = stock.into_iter();
        let shape = |sample: &mut Sample| {
            sample.stock = next.next().unwrap_or(sample.stock);
            fed(sample);
        };
        self.core.sample(&contour, &mut buffer.0, shape).map_err(|error| self.refused(&error))
    }
}

/// What a path under G41 or G42 is: where the job does not say it, it is found out and the job says it from now on.
fn find_out_drawn(job: &mut JobFile, program: &Source) -> Result<Option<Drawn>, InputError> {
    let drawn = if job.drawn { None } else { drawn(job, program)? };
    job.drawn = true;
    if let Some(drawn) = &drawn {
        job.numbers.tool.compensation = drawn.compensation;
    }
    Ok(drawn)
}

/// Reads the contour of a program, whatever its length.
///
/// # Errors
/// Whatever is wrong with the program.
pub fn read_blocks(program: &Source, options: Options<'static>) -> Result<(Vec<Block>, ContourProgram), Failure> {
    let options = ContourOptions { program: options, ..ContourOptions::default() };
    let read = |blocks: &mut [Block]| {
        let mut memory = Box::new(HostMemory::new());
        read_contour(&Program::new(program.bytes()), &mut memory.lend(), blocks, &options)
    };
    let (mut blocks, contour) =
        with_enough_blocks(read, is_too_long).map_err(|error| InputError::of_program(program, &error))?;
    blocks.truncate(contour.blocks);
    Ok((blocks, contour))
}

const fn is_too_long(error: &GcodeError) -> bool {
    matches!(error.kind, GcodeErrorKind::ContourTooLong { .. })
}

/// Reads into a buffer, and again into larger ones while it is too short.
fn with_enough_blocks<T, E>(
    read: impl Fn(&mut [Block]) -> Result<T, E>,
    too_long: impl Fn(&E) -> bool,
) -> Result<(Vec<Block>, T), E> {
    let mut capacity = FIRST_BUFFER;
    loop {
        let mut blocks = vec![Block::BLANK; capacity];
        match read(&mut blocks) {
            Ok(value) => return Ok((blocks, value)),
            Err(error) if too_long(&error) && capacity < LARGEST_BUFFER => capacity *= 8,
            Err(error) => return Err(error),
        }
    }
}

/// Climb or conventional, in words.
pub const fn milling_name(milling: Milling) -> &'static str {
    match milling {
        Milling::Climb => "climb",
        Milling::Conventional => "conventional",
    }
}

/// Whether a warning is of M160 or M161 of LinuxCNC, with which a program arms and disarms Truepath itself: they move no axis.
const fn arms_truepath(kind: WarningKind, dialect: Dialect) -> bool {
    matches!((kind, dialect), (WarningKind::UnknownM { m: 160 | 161 }, Dialect::Linuxcnc))
}

/// Feeds that differ by less are the same.
const SAME_FEED: f64 = 0.02;

/// A warning where the program cuts at another feed than the job says: a corrected program keeps its F words.
fn other_feed(job: &JobFile, program: &Source, written: [Real; 2], unit: Unit) -> Option<String> {
    let feed = float(job.numbers.cut.feed_mm_per_min?);
    let [least, greatest] = written.map(float);
    if greatest <= 0.0 || [least, greatest].iter().all(|written| (written / feed - 1.0).abs() < SAME_FEED) {
        return None;
    }
    let ([low, high], name) = ([least, greatest].map(|feed| unit.of(feed)), unit.name());
    let says = if least == greatest { format!("F{high}") } else { format!("F{low} to F{high}") };
    Some(format!(
        "{} is {}, the contour in {} says {says} {name}/min: everything holds for {} {name}/min; run the program at that feed, or \
         remove the key",
        job.unit.keys("cut.feed_mm_per_min"),
        job.unit.of(feed),
        program.name(),
        unit.of(feed)
    ))
}
