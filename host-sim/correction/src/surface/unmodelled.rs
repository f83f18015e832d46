//! Machines beside the one that was found: those that no points tell from it, because the model is not the cut, and the one whose
//! cutter does not bend.

use truepath_core::cut::Compliance;
use truepath_core::identify::Parameters;
use truepath_core::units::{Offset, Real};

/// The force differs by 2 %, the radial share by 3 %, the edge by 5 %, the exponent of the chip by 0.02, the bending
/// by 0.05 and the size of the cutter by 2 um: one standard deviation each.
pub fn unmodelled(found: &Parameters) -> impl Iterator<Item = Parameters> + use<> {
    let found = *found;
    let scaled = |value: Real, percent: i64| value + value * Real::ratio(percent, 100);
    let mut other = [found; 6];
    other[0].compliance.mean = scaled(found.compliance.mean, 2);
    other[0].compliance.difference = scaled(found.compliance.difference, 2);
    other[0].compliance.cross = scaled(found.compliance.cross, 2);
    other[1].coefficients.krc = scaled(found.coefficients.krc, 3);
    other[2].coefficients.kte = scaled(found.coefficients.kte, 5);
    other[2].coefficients.kre = scaled(found.coefficients.kre, 5);
    other[3].coefficients.size_exponent = found.coefficients.size_exponent + Real::ratio(2, 100);
    other[4].compliance.bend = found.compliance.bend + Real::ratio(5, 100);
    other[5].undersize = found.undersize + Offset::from_um(2);
    other.into_iter()
}

/// The same with a cutter that does not bend.
pub fn unbent(found: &Parameters) -> Parameters {
    Parameters { compliance: Compliance { bend: Real::ZERO, ..found.compliance }, ..*found }
}
