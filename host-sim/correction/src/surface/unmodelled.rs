//! Machines beside the one that was found: those that no points tell from it, because the model is not the cut, and the one whose
//! cutter does not bend.

use truepath_core::cut::Compliance;
use truepath_core::identify::{Parameter, Parameters};
use truepath_core::units::{Offset, Real};

/// What a model lacks, one standard deviation each: the compliance, and with it the force, in hundredths, the radial share and the level
/// of the edge in hundredths, bending and exponent of the chip in hundredths of one, the size of the cutter in um.
const LACK: [(Parameter, i64); 6] = [
    (Parameter::Compliance, 2),
    (Parameter::RadialRatio, 3),
    (Parameter::EdgeLevel, 5),
    (Parameter::SizeExponent, 2),
    (Parameter::Bend, 5),
    (Parameter::Undersize, 2),
];

/// Which of [the machines beside](unmodelled) has another load: it is softer by [this share](lack) and nothing else.
pub const SOFTER: usize = 0;

/// What a model lacks of a parameter, one standard deviation: of the logarithm for factors, else in its unit.
pub fn lack(parameter: Parameter) -> f64 {
    let steps = LACK.iter().find(|(of, _)| *of == parameter).map_or(0, |(_, steps)| *steps);
    steps as f64 / if parameter == Parameter::Undersize { 1000.0 } else { 100.0 }
}

/// Machines beside the one that was found by what a model lacks, each in one parameter.
pub fn unmodelled(found: &Parameters) -> impl Iterator<Item = Parameters> + use<> {
    let found = *found;
    LACK.into_iter().map(move |(parameter, steps)| {
        let share = Real::ratio(steps, 100);
        let scaled = |value: Real| value + value * share;
        let mut other = found;
        let (compliance, coefficients) = (&mut other.compliance, &mut other.coefficients);
        match parameter {
            Parameter::RadialRatio => coefficients.krc = scaled(coefficients.krc),
            Parameter::EdgeLevel => {
                coefficients.kte = scaled(coefficients.kte);
                coefficients.kre = scaled(coefficients.kre);
            }
            Parameter::SizeExponent => coefficients.size_exponent += share,
            Parameter::Bend => compliance.bend += share,
            Parameter::Undersize => other.undersize += Offset::from_um(steps),
            _ => {
                compliance.mean = scaled(compliance.mean);
                compliance.difference = scaled(compliance.difference);
                compliance.cross = scaled(compliance.cross);
            }
        }
        other
    })
}

/// The same with a cutter that does not bend.
pub fn unbent(found: &Parameters) -> Parameters {
    Parameters { compliance: Compliance { bend: Real::ZERO, ..found.compliance }, ..*found }
}
