//! Whether what shops have beside the model explains points as well as wrong data do.
//!
//! Stock in waves of a quarter, or a wall that yields, is no mistake, and still nothing that machine and material as the job states
//! them can fit: such points look like those of a cutter with other teeth, or like a shifted datum. The stops of a
//! [judgement](super::judge) are therefore asked again with the [discrepancy](crate::discrepancy) in place: under the job as stated
//! and under each cause that was named, machine, material and discrepancy integrated out of both.

use truepath_core::cut::WallLaw;
use truepath_core::identify::Observation;
use truepath_core::job;
use truepath_ground::units::nm;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, PathBuffer};

use super::look::Look;
use super::stop::Misfit;
use super::trial::Trial;
use crate::discrepancy::{PartCut, is_fitted, relieved};
use crate::identification::Found;

/// Odds, natural logarithm, from which wrong data are believed rather than what is beside the model.
const CLEARLY: f64 = 6.0;
/// Stock of a place, as shares of the allowance more than that.
const STOCKS: [f64; 6] = [-0.4, -0.25, -0.12, 0.12, 0.25, 0.4];
/// Their standard deviation.
const UNEVEN: f64 = 0.15;

/// Whether the correction, which is made beside the discrepancy, may go on with points that a fit without it refuses: no cause is
/// clearly more probable, and beside the discrepancy nothing forbids it.
pub(super) fn explains(
    misfit: &Misfit,
    (pass, measurement): (&Pass, &Measurement),
    core: &job::Identified,
    observations: &[Observation],
) -> bool {
    if !is_fitted(pass) {
        return false;
    }
    (misfit.causes.is_empty()
        || is_discrepancy(misfit, pass, measurement)
        || is_stock(misfit, pass, measurement, core.law))
        && (misfit.reason.is_none() || is_allowed(pass, measurement, core, observations))
}

/// Whether no cause is clearly more probable than the job as stated, where either has a discrepancy.
fn is_discrepancy(misfit: &Misfit, pass: &Pass, measurement: &Measurement) -> bool {
    let Some(stated) = misfit.stated.ln_evidence(pass, measurement) else { return false };
    let is_clear = |evidence: Option<f64>| evidence.is_some_and(|evidence| evidence > stated + CLEARLY);
    !misfit.causes.iter().any(|cause| is_clear(cause.ln_evidence(pass, measurement)))
}

/// Whether no cause is clearly more probable than stock that differs from place to place. The discrepancy takes that as
/// small, but a tooth more in the cut makes another wall.
fn is_stock(misfit: &Misfit, pass: &Pass, measurement: &Measurement, law: WallLaw) -> bool {
    let Some(cost) = Trial::beside_stock(pass, measurement, law, (&STOCKS, UNEVEN)) else { return false };
    misfit.causes.iter().all(|cause| cost < cause.cost() + 2.0 * CLEARLY)
}

/// Whether nothing forbids to go on with the points relieved of what is beside the model: they fit then, all of them, since a
/// discrepancy that leaves them off is no explanation of theirs.
fn is_allowed(pass: &Pass, measurement: &Measurement, core: &job::Identified, measured: &[Observation]) -> bool {
    let mut buffer = PathBuffer::default();
    let Ok(path) = pass.sample(&mut buffer) else { return false };
    let found = Found { core: *core, earlier: Vec::new(), observations: measured.to_vec() };
    let cut = PartCut::uncorrected(path, 0, measured);
    let relieved = relieved(&pass.core, found, &[cut], &mut |_| ());
    let mut points = relieved.found.observations.clone();
    for (o, beside) in points.iter_mut().zip(&relieved.at_points) {
        o.error -= nm(*beside);
    }
    let look = Look::of(pass, measurement, &relieved.found.core, &points);
    look.reason().is_none() && look.fits_well()
}
