//! The estimate of machine and material by which places are chosen, and how the part was cut that will be touched.

use truepath_core::correct::{Node, commanded};
use truepath_core::cut::Path;
use truepath_core::geometry::Vector;
use truepath_core::identify::{COUNT, Parameter, Parameters, Prior};
use truepath_core::units::Real;

/// Parameters of the model at a distance from the prior.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate<'a> {
    /// What the job states.
    pub(super) prior: &'a Prior,
    /// Distance from it, in its standard deviations.
    pub(super) theta: [Real; COUNT],
    /// The correction the touched part was cut with; empty for an uncorrected one.
    pub(super) nodes: &'a [Node],
}

impl<'a> Estimate<'a> {
    /// Before any touch, of an uncorrected part.
    pub(super) const fn stated(prior: &'a Prior) -> Self {
        Self { prior, theta: [Real::ZERO; COUNT], nodes: &[] }
    }
    /// The parameters estimated.
    pub(super) fn parameters(&self) -> Parameters {
        self.prior.at(&self.theta)
    }
    /// The parameters with one of them some of its standard deviations away.
    pub(super) fn displaced(&self, unknown: usize, by: Real) -> Parameters {
        let mut theta = self.theta;
        theta[unknown] += by;
        self.prior.at(&theta)
    }
    /// The displacement that was commanded at a sample of the path.
    pub(super) fn commanded(&self, path: &Path, index: usize) -> Vector {
        if self.nodes.is_empty() { Vector::ZERO } else { commanded(path, self.nodes, index) }
    }
}

/// Whether an unknown acts on the measurement alone, and not on the wall.
pub(super) const fn of_measurement(parameter: Parameter) -> bool {
    matches!(parameter, Parameter::DatumX | Parameter::DatumY)
}
