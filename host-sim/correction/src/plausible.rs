//! Whether a fit has ended at a machine that can be.

use truepath_core::identify::Parameter;
use truepath_core::job;
use truepath_ground::units::{float, mm};

/// What a worn cutter is smaller than stated, or one that runs out larger, mm.
pub const WORN_MM: f64 = 0.05;
/// A parameter farther from what the job says than so many prior standard deviations cannot be.
pub const FARTHEST: f64 = 10.0;
/// The least standard deviation, as a share of the compliance, by which a cross term is called far. The mean law expects
/// hardly any, but that is a belief about the papers' machine and not about what machines have.
const CROSS_SHARE: f64 = 0.08;

fn index(parameter: Parameter) -> usize {
    Parameter::ALL.iter().position(|p| *p == parameter).unwrap_or_default()
}

/// What all points are off, mm, and its standard deviation.
pub fn level_mm(core: &job::Identified) -> [f64; 2] {
    let size = index(Parameter::Undersize);
    let sigma = float(core.prior.sigma[size]) * float(core.fit.remaining(size));
    [mm(core.fit.parameters.undersize), sigma]
}

/// The parameter farthest from what the job says, size and datum aside, and how far in standard deviations.
pub fn farthest(core: &job::Identified) -> (Parameter, f64) {
    let mut theta = core.fit.theta.map(|t| float(t).abs());
    let cross = index(Parameter::ComplianceCross);
    theta[cross] *= (float(core.prior.sigma[cross]) / CROSS_SHARE).min(1.0);
    let of_machine = Parameter::ALL.into_iter().zip(theta).take(index(Parameter::Undersize));
    of_machine.max_by(|a, b| a.1.total_cmp(&b.1)).unwrap_or((Parameter::Compliance, 0.0))
}

/// Whether neither size nor machine are what nothing can be.
pub fn is_possible(core: &job::Identified) -> bool {
    let [level, sigma] = level_mm(core);
    level.abs() <= WORN_MM + 3.0 * sigma && farthest(core).1 <= FARTHEST
}
