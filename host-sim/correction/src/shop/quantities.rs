//! The quantities that jobs have in common, in a form that no job's own statement is in.
//!
//! A fit holds the tangential chip coefficient at what the job states, and its compliance carries the scale of both. What two jobs
//! can compare is their product; and the edge coefficients over the tangential one. Logarithms are those of `libm`, whose bits are the
//! same in a browser.

use truepath_core::cut::Compliance;
use truepath_core::identify::{Parameters, Prior};
use truepath_core::units::{Offset, Real};
use truepath_ground::units::{float, mm, real};

use crate::surface::predicted::TAIL;

/// How many there are.
pub const QUANTITIES: usize = 9;

/// Values of all, in the order of [`Quantity::ALL`].
pub type Quantities = [f64; QUANTITIES];

/// A quantity that jobs have in common.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Quantity {
    /// ln of mean compliance times tangential chip coefficient: how far the machine gives way in this material.
    Yield,
    /// Half the difference of the compliances along x and y, as a share of their mean.
    Difference,
    /// Cross compliance as a share of the mean.
    Cross,
    /// ln of the radial over the tangential chip coefficient.
    RadialRatio,
    /// ln of the tangential edge over the tangential chip coefficient, mm.
    EdgeLevel,
    /// ln of the radial over the tangential edge coefficient.
    EdgeRatio,
    /// Bending of the cutter over the engaged depth.
    Bend,
    /// Size exponent of the chip.
    SizeExponent,
    /// How much smaller than stated the cutter is, mm.
    Undersize,
}

impl Quantity {
    /// All, in the order of [`Quantities`]; that of a fit's parameters, which end with the datum of a part.
    pub const ALL: [Self; QUANTITIES] = [
        Self::Yield,
        Self::Difference,
        Self::Cross,
        Self::RadialRatio,
        Self::EdgeLevel,
        Self::EdgeRatio,
        Self::Bend,
        Self::SizeExponent,
        Self::Undersize,
    ];

    /// What it is called in a sentence.
    pub const fn words(self) -> &'static str {
        match self {
            Self::Yield => "how far the machine gives way in this material",
            Self::Difference => "the difference between the stiffnesses along X and Y",
            Self::Cross => "how far the machine gives way across the force",
            Self::RadialRatio => "the radial over the tangential force",
            Self::EdgeLevel => "the force of the edges",
            Self::EdgeRatio => "the direction of the force of the edges",
            Self::Bend => "the bending of the cutter",
            Self::SizeExponent => "how the force grows with the chip",
            Self::Undersize => "the size of the cutter",
        }
    }
}

/// The quantities of parameters, in float. That of an edge force that is not there is 0, and no job says anything of it.
pub(super) fn of(parameters: &Parameters) -> Quantities {
    let (k, c) = (&parameters.coefficients, &parameters.compliance);
    let [ktc, krc, kte] = [k.ktc, k.krc, k.kte].map(float);
    let ln = |value: f64| if value > 0.0 { libm::log(value) } else { 0.0 };
    let mean = float(c.mean);
    [
        ln(mean * ktc),
        float(c.difference) / mean,
        float(c.cross) / mean,
        ln(krc / ktc),
        ln(kte / ktc),
        ln(float(parameters.edge_ratio)),
        float(c.bend),
        float(k.size_exponent),
        mm(parameters.undersize),
    ]
}

impl Quantity {
    /// How wide a Gaussian is that holds it within two standard deviations as surely as what is believed of it, over the scale of that: the
    /// size of cutters is believed with long tails.
    const fn widening(self) -> f64 {
        match self {
            Self::Undersize => TAIL,
            _ => 1.0,
        }
    }

    /// Farther from what a job states, to one standard deviation, is nothing to begin at.
    pub(super) fn farthest(self, sigma: f64) -> f64 {
        FARTHEST * if self == Self::Undersize { sigma.max(CUTTERS_MM) } else { sigma }
    }
}

/// Standard deviations.
const FARTHEST: f64 = 6.0;
/// What cutters that nobody measured are smaller by than stated, one standard deviation, mm: those that were are known as stated.
pub(super) const CUTTERS_MM: f64 = 0.010;

/// One standard deviation of each under a prior; 0 where it is held.
pub(super) fn sigmas(prior: &Prior) -> Quantities {
    Quantity::ALL.map(|quantity| quantity.widening() * float(prior.sigma[quantity as usize]))
}

/// A prior with other expected values and standard deviations of some quantities, `None` for those that stay.
pub(super) fn narrowed(stated: &Prior, by: &[Option<[f64; 2]>; QUANTITIES]) -> Prior {
    let mut values = of(&stated.mean);
    let mut sigma = stated.sigma;
    for quantity in Quantity::ALL {
        let k = quantity as usize;
        if let Some([mean, deviation]) = by[k] {
            (values[k], sigma[k]) = (mean, real(deviation / quantity.widening()));
        }
    }
    let [level, difference, cross, radial, edge, edge_ratio, bend, exponent, undersize] = values;
    let mut raw = Raw::of(&stated.mean);
    let ktc = float(stated.mean.coefficients.ktc);
    let new = |quantity: Quantity| by[quantity as usize].is_some();
    if new(Quantity::Yield) || new(Quantity::Difference) || new(Quantity::Cross) || new(Quantity::Bend) {
        let compliance = libm::exp(level) / ktc;
        let part = |share: f64| real(share * compliance);
        raw.compliance =
            Compliance { mean: part(1.0), difference: part(difference), cross: part(cross), bend: real(bend) };
    }
    if new(Quantity::RadialRatio) {
        raw.krc = real(libm::exp(radial) * ktc);
    }
    if new(Quantity::EdgeLevel) && raw.kte > Real::ZERO {
        raw.kte = real(libm::exp(edge) * ktc);
    }
    if new(Quantity::EdgeRatio) {
        raw.edge_ratio = real(libm::exp(edge_ratio));
    }
    if new(Quantity::SizeExponent) {
        raw.size_exponent = real(exponent.max(0.0));
    }
    if new(Quantity::Undersize) {
        raw.undersize = Offset::from_mm(real(undersize));
    }
    Prior { mean: raw.put_in(&stated.mean), sigma }
}

/// What of the parameters of a prior another belief changes, in their own units.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Raw {
    pub(super) compliance: Compliance,
    pub(super) krc: Real,
    pub(super) kte: Real,
    pub(super) edge_ratio: Real,
    pub(super) size_exponent: Real,
    pub(super) undersize: Offset,
}

impl Raw {
    pub(super) const fn of(mean: &Parameters) -> Self {
        let Parameters { coefficients: k, compliance, edge_ratio, undersize, .. } = *mean;
        Self { compliance, krc: k.krc, kte: k.kte, edge_ratio, size_exponent: k.size_exponent, undersize }
    }

    /// The parameters with these; the other edge coefficient follows.
    pub(super) fn put_in(&self, stated: &Parameters) -> Parameters {
        let mut mean = *stated;
        let Self { compliance, krc, kte, edge_ratio, size_exponent, undersize } = *self;
        (mean.compliance, mean.edge_ratio, mean.undersize) = (compliance, edge_ratio, undersize);
        (mean.coefficients.krc, mean.coefficients.kte, mean.coefficients.size_exponent) = (krc, kte, size_exponent);
        if stated.coefficients.kte > Real::ZERO {
            mean.edge_level = stated.edge_level * (kte / stated.coefficients.kte);
            if stated.coefficients.kre != Real::ZERO {
                mean.coefficients.kre = kte * edge_ratio;
            }
        }
        mean
    }
}
