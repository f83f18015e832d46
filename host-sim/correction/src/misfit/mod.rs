//! Points that do not fit the job: whether they do, and what would explain them.
//!
//! A fit always ends somewhere: points with a wrong datum become a soft machine, a wrong allowance a worn cutter. So the
//! fit of the job as stated is looked at ([`Look`]): points that do not fit by the stated noise, a size that no worn
//! cutter has, parameters that cannot be, and what a free datum would change ([`Shift`], without a new fit). Where that
//! is doubtful, the fit is made again under other assumptions ([`Cause`], [`Trial`]), and the one that explains the points
//! by far best is named ([`Misfit`]).
//!
//! Limits: what a machine like the one in the job could have done is not noticed. On one straight wall a shift of the
//! datum is a softer machine; the number of teeth scales all forces alike, as the stiffness does.

mod beside;
mod cause;
mod fit;
mod judge;
mod look;
mod notice;
mod rigid;
mod score;
mod shift;
mod solve;
mod stop;
mod text;
mod trial;

pub use cause::Cause;
pub use judge::judged;
pub use look::{Look, Reason};
pub use notice::noticed;
pub use rigid::Rigid;
pub use score::{Score, expected_mm, residual_mm};
pub use shift::Shift;
pub use stop::Misfit;
pub(crate) use text::said;
pub use trial::Trial;

use truepath_core::identify::Observation;
use truepath_core::job;
use truepath_ground::diagnostics::Failure;
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

/// Refuses points that do not fit the job, unless they are to be taken as they are.
///
/// # Errors
/// `Q009` with the likely cause and the worst points.
pub fn refuse_misfit(
    pass: &Pass,
    measurement: &Measurement,
    core: &job::Identified,
    observations: &[Observation],
) -> Result<(), Failure> {
    if measurement.taken_as_is {
        return Ok(());
    }
    judged(pass, measurement, core, observations).map_or(Ok(()), |misfit| Err(misfit.error(pass, measurement).into()))
}
