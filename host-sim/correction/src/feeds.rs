//! The feeds of a correction: whether the job wants them changed, and what that comes to.

use truepath_core::cut::Loop;
use truepath_ground::codes::J008;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::Unit;
use truepath_ground::units::float;
use truepath_job::feed::{FeedSummary, Schedule, Wanted, largest_force, schedule};
use truepath_job::job::{ForceLimit, Route};
use truepath_job::pass::Pass;

use crate::correction::{DesignRequest, Identification, design_correction};
use crate::summary::unscheduled;

/// The feeds along a contour.
#[derive(Clone, Debug, Default)]
pub struct Feeds {
    /// Where they change; `None` where those of the program stay.
    pub schedule: Option<Schedule>,
    /// What that does; `None` when the job has no `[feed]`.
    pub summary: Option<FeedSummary>,
}

/// A point with less weight is of something else than this wall.
const TRUSTED: f64 = 0.3;

/// The feeds that the job wants on the path of a machine. `probed` is whether the points are of this pass.
///
/// # Errors
/// `J008` when the job wants feeds that nobody would follow: of the coprocessor's route, with F words that are not
/// those of the cut, or of places that were not probed.
pub fn planned(
    pass: &Pass,
    machine: &Loop,
    identified: &Identification,
    probed: bool,
    routes: &[Route],
) -> Result<Feeds, Failure> {
    let Some(table) = &pass.job.feed else { return Ok(Feeds::default()) };
    if routes.contains(&Route::Coprocessor) {
        let found = "[feed] is given, and the correction is for the coprocessor: it follows the live feed, and the F words of its program stay";
        let help = "use route = \"program\", or remove [feed]";
        return Err(contradiction(pass, "feed", found, "feeds that are written into the program", help));
    }
    written_feeds_count(pass, "[feed] changes F words", "remove [feed]")?;
    let (limit_n, limited_by) = match table.limit {
        ForceLimit::Newtons(limit) => (float(limit), "max_force_n"),
        ForceLimit::Probed if !probed => {
            let found = "feed.keep is \"probed\", and this pass has not been probed";
            let help = "give feed.max_force_n instead";
            return Err(contradiction(pass, "feed", found, "a limit in newtons", help));
        }
        ForceLimit::Probed => {
            let trusted = identified.observations.iter().filter(|o| float(o.weight) >= TRUSTED);
            (largest_force(machine, trusted.map(|o| o.s)), "probed")
        }
    };
    let wanted = Wanted { percent: table.percent, limit_n };
    let schedule = schedule(machine, &wanted);
    let summary = FeedSummary::new(machine, &wanted, limited_by, schedule.as_ref());
    Ok(Feeds { schedule, summary: Some(summary) })
}

/// Refuses F words that the job overrides by others, where somebody `changes` them; `instead` is the way on without that.
///
/// # Errors
/// `J008`, and what is wrong with job or program.
pub(crate) fn written_feeds_count(pass: &Pass, changes: &str, instead: &str) -> Result<(), Failure> {
    const KEY: &str = "cut.feed_mm_per_min";
    if pass.job.numbers.cut.feed_mm_per_min.is_none() {
        return Ok(());
    }
    let mut job = pass.job.clone();
    job.numbers.cut.feed_mm_per_min = None;
    job.which.pass = pass.plan.as_ref().map(|_| pass.level());
    let written = Pass::new(job, pass.program.clone())?;
    let differs = written.blocks.iter().zip(&pass.blocks).find(|(written, cut)| written.feed != cut.feed);
    differs.map_or(Ok(()), |(written, cut)| {
        let found = format!(
            "{KEY} is {}, line {} of the program says F{}, and {changes}",
            float(cut.feed),
            written.line,
            float(written.feed)
        );
        let help = format!("write the feed of the cut into the program and remove cut.feed_mm_per_min, or {instead}");
        Err(contradiction(pass, KEY, &found, "F words that are the feeds of the cut", &help))
    })
}

fn contradiction(pass: &Pass, key: &str, found: &str, expected: &str, help: &str) -> Failure {
    InputError::new(J008, found, expected, help).at(pass.job.source(), pass.job.span(key)).into()
}

impl Feeds {
    /// Notes what a correction at the feeds of the program would leave; `machine` is on the path with these.
    pub fn compare(&mut self, pass: &Pass, machine: &Loop, identified: &Identification, request: &DesignRequest<'_>) {
        let (Some(_), Some(summary)) = (&self.schedule, &mut self.summary) else { return };
        // Beyond the clamp there is none.
        let Ok(plain) = design_correction(pass, machine, identified, request, |_| ()) else { return };
        summary.unscheduled = Some(unscheduled(&plain));
    }

    /// What the user should know of the feeds, given the standard deviation of the corrected wall at them, mm.
    pub fn warnings(&self, sigma_mm: f64, unit: Unit) -> Vec<String> {
        let Some(summary) = &self.summary else { return Vec::new() };
        let unused = self.schedule.is_none();
        let mut warnings: Vec<String> = summary.doubt().into_iter().collect();
        warnings.extend(unused.then(|| "[feed] changes nothing: the force is within the limit everywhere".to_owned()));
        if let Some(plain) = summary.unscheduled.filter(|plain| sigma_mm > 1.2 * plain.max_sigma_mm) {
            warnings.push(format!(
                "at the scheduled feeds the corrected wall is less certain ({:.4} {name}, {:.4} {name} at those of the program, one sigma): the points were cut at one feed, and what edge and chip have in the force is not told apart; probe the part cut with these feeds, or raise feed.min_percent",
                unit.of(sigma_mm),
                unit.of(plain.max_sigma_mm),
                name = unit.name()
            ));
        }
        warnings
    }
}
