//! What the core refuses in job, program or measurement, as the user meets it: with the place in the file, what was
//! expected and what to do.

use truepath_core::image::MAX_CLAMP_NM;
use truepath_core::job::JobError;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::{Failure, InputError, Source};
use truepath_ground::length::Unit;
use truepath_ground::units::mm;

use crate::job::JobFile;

mod readings;

use readings::{of_contacts, of_probe};

pub use readings::why;
pub(crate) use readings::{line_span, suspected};

/// The files an error may point into.
#[derive(Clone, Copy, Debug)]
pub struct Inputs<'a> {
    /// The job.
    pub job: &'a JobFile,
    /// Its program.
    pub program: &'a Source,
    /// The probe file, once there is one.
    pub probe: Option<&'a Source>,
    /// The unit in which it is said.
    pub unit: Unit,
}

impl Inputs<'_> {
    /// The failure for an error of the core.
    pub fn refused(&self, error: &JobError) -> Failure {
        let said = |e: InputError| e.told_in(self.unit).with_keys_in(self.job.unit);
        let at_job = |e: InputError, key: &str| Failure::from(said(e).at(self.job.source(), self.job.span(key)));
        let at_line =
            |e: InputError, line: u32| Failure::from(said(e).at(self.program, self.program.span_at(line, 1, 1)));
        match *error {
            JobError::Program(error) => InputError::of_program(self.program, &error).into(),
            JobError::NoFeed { line } => at_line(of_job(error), line),
            JobError::Undercut { line } | JobError::Jagged { line } => at_line(of_job(error), line),
            JobError::Measurement(error) => {
                self.probe.map_or_else(|| Failure::Internal(error.to_string()), |file| of_probe(file, &error).into())
            }
            JobError::OffTheWall { line, .. } | JobError::NoContact { line, .. } => {
                let error = of_contacts(error, self.job, self.unit).with_keys_in(self.job.unit);
                match self.probe {
                    Some(file) => error.at(file, line_span(file, line)).into(),
                    None => error.into(),
                }
            }
            JobError::Corrected => at_job(of_job(error), "program"),
            JobError::WallsDiffer | JobError::NoWall => at_job(of_job(error), "wall"),
            JobError::NoSpeed | JobError::FeedPerTooth => at_job(of_job(error), "cut"),
            JobError::ToolsDiffer { .. } => at_job(of_job(error), "tool.number"),
            JobError::NoTool => at_job(of_job(error), "tool"),
            JobError::Flutes => at_job(of_job(error), "cut.axial_depth_mm"),
            JobError::Unfit { .. } => at_job(of_correction(error, self.job, self.unit), "probe.ball_diameter_mm"),
            JobError::BeyondClamp { .. } | JobError::NoFeedWindow { .. } => {
                at_job(of_correction(error, self.job, self.unit), "correct.clamp_mm")
            }
            JobError::TooManyNodes { .. } | JobError::Image(_) => {
                at_job(of_correction(error, self.job, self.unit), "correct")
            }
            JobError::Range { .. } | JobError::NoProbe => at_job(of_job(error), ""),
            JobError::Compact | JobError::Full { .. } => Failure::Internal(error.to_string()),
        }
    }
}

/// What job and program lack or contradict each other in.
fn of_job(error: &JobError) -> InputError {
    let (expected, help) = match error {
        JobError::Corrected => (
            "the original program",
            "name the original program in the job: correcting a correction would move the wall twice",
        ),
        JobError::NoFeed { .. } => {
            ("a feed rate", "add an F word to the program, or feed_mm_per_min to [cut] of the job")
        }
        JobError::Undercut { .. } => (
            "an outside arc of the path at least as wide as the cutter's radius",
            "check the side (wall = \"left\" or \"right\") and the cutter's diameter in the job",
        ),
        JobError::Jagged { .. } => (
            "a contour with a wall that this cutter makes",
            "check diameter_mm and the unit of the program (G20, G21); name the lines of the contour in [[feature]] if it is another",
        ),
        JobError::WallsDiffer => (
            "the same side in both",
            "remove wall from the job: G41 means the wall is on the right of travel, G42 on the left",
        ),
        JobError::NoWall => (
            "wall = \"left\" or wall = \"right\", as seen in the direction of travel",
            "add wall to the job (inside pockets cut counter-clockwise have it on the right)",
        ),
        JobError::NoSpeed => {
            ("an S word before the contour, or spindle_rpm in [cut]", "add spindle_rpm to [cut] of the job")
        }
        JobError::ToolsDiffer { .. } => (
            "the same tool in both",
            "correct number in [tool] of the job, or remove it: the T word before M6 of the program is used then",
        ),
        JobError::NoTool => (
            "the number that the controller sends when it arms",
            "add number to [tool] of the job, or T and M6 to the program; route = \"program\" needs neither",
        ),
        JobError::Flutes => {
            ("at most 64 flutes in the stock at once", "check axial_depth_mm, diameter_mm, teeth and helix_deg")
        }
        JobError::FeedPerTooth => ("a feed per tooth up to 8 mm", "check feed, spindle speed and number of teeth"),
        _ => ("", "correct the job"),
    };
    let sentence = error.to_string();
    let found = error.line().and_then(|line| sentence.strip_prefix(&format!("line {line}: "))).unwrap_or(&sentence);
    InputError::of_core(error.code(), found, expected, help)
}

/// A correction that must not be made.
fn of_correction(error: &JobError, job: &JobFile, unit: Unit) -> InputError {
    let (code, name) = (error.code(), unit.name());
    let limit = |clamp| format!("{} = {}", job.unit.keys("clamp_mm"), job.unit.of(mm(clamp)));
    match *error {
        JobError::Unfit { s, measured, fitting, .. } => InputError::of_core(
            code,
            format!(
                "{error}; at s = {:.2} {name} {:.4} {name} were measured, {:.4} {name} would fit",
                unit.of(mm(s)),
                unit.of(mm(measured)),
                unit.of(mm(fitting))
            ),
            "probe points of one part cut by this program",
            "check ball_diameter_mm, allowance_mm, the side of the wall and that the probed part is the one of this program",
        ),
        JobError::BeyondClamp { reach, clamp, at } => InputError::of_core(
            code,
            format!(
                "the correction reaches {:.3} {name} at X{:.3} Y{:.3}, beyond {}",
                unit.of(mm(reach)),
                unit.of(at.x.nm() as f64 / 1e6),
                unit.of(at.y.nm() as f64 / 1e6),
                limit(clamp)
            ),
            "a correction inside the clamp",
            clamp_help(reach, job.unit),
        ),
        JobError::NoFeedWindow { reach, clamp } => InputError::of_core(
            code,
            format!(
                "at 110 % of the programmed feed the correction reaches {:.3} {name}, beyond {}",
                unit.of(mm(reach)),
                limit(clamp)
            ),
            "a correction that leaves room for a feed override of 110 %",
            clamp_help(reach, job.unit),
        ),
        JobError::TooManyNodes { limit, .. } => InputError::of_core(
            code,
            error.to_string(),
            format!(
                "at most {limit} nodes: about {:.1} m of contour, ten to a millimetre",
                f64::from(limit) / 10_000.0
            ),
            "cut the contour in two programs, or correct in the program instead (route = \"program\")",
        ),
        _ => InputError::of_core(code, error.to_string(), "", "correct in the program instead (route = \"program\")"),
    }
}

/// What to do about a correction beyond the clamp: the peak and a tenth of it, rounded up to a hundredth of a millimetre or half a
/// thousandth of an inch, where that may be a deflection at all.
fn clamp_help(peak: Offset, unit: Unit) -> String {
    let steps = if unit == Unit::Inch { 2000.0 } else { 100.0 };
    let proposal = (unit.said(mm(peak)) * 1.1 * steps).ceil() / steps;
    if unit.in_mm(proposal) > mm(Offset::from_nm(MAX_CLAMP_NM)) {
        return "no cutter deflects that much: check the side of the wall, the cutter's diameter and the probe file"
            .to_owned();
    }
    format!(
        "if a correction that large is meant, set {} = {proposal} in [correct]; otherwise check the probe file and the cut",
        unit.keys("clamp_mm")
    )
}
