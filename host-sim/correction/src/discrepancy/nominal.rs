//! What the parameters do to the wall that a correction has to cancel, beside every sample of a contour.

use truepath_core::correct::Band;
use truepath_core::cut::{ForceTable, Loop, Path, Sample, Teeth};
use truepath_core::identify::{COUNT, Parameter, Parameters};
use truepath_core::job;
use truepath_core::units::{Offset, Real};
use truepath_ground::units::{float, mm};

/// Step of the difference quotients, prior standard deviations.
const STEP: Real = Real::ratio(1, 32);
/// Heights over which the wall is averaged.
const HEIGHTS: i64 = truepath_core::correct::HEIGHTS;

/// Change of the deflection at the nominal engagement per prior standard deviation of every shared parameter, one row per
/// sample of the contour, mm: what changes of the wall when the machine is another than the correction was made for.
pub(super) fn sensitivities(path: &Path, core: &job::Identified) -> Vec<[f64; COUNT]> {
    let mut rows = vec![[0.0; COUNT]; path.count()];
    for (k, parameter) in Parameter::ALL.iter().enumerate() {
        match parameter {
            // Another clamping, another datum: it is not on the wall to come.
            Parameter::DatumX | Parameter::DatumY => continue,
            Parameter::Undersize => rows.iter_mut().for_each(|row| row[k] = float(core.prior.sigma[k])),
            _ if core.prior.sigma[k] == Real::ZERO => continue,
            _ => {
                let [above, below] = [STEP, -STEP].map(|step| {
                    let mut theta = core.fit.theta;
                    theta[k] += step;
                    deflections(path, &core.prior.at(&theta))
                });
                let quotient = 1.0 / (2.0 * float(STEP));
                for (row, (above, below)) in rows.iter_mut().zip(above.iter().zip(&below)) {
                    row[k] = mm(*above - *below) * quotient;
                }
            }
        }
    }
    rows
}

/// Change of the deflection at the nominal engagement per allowance, beside every sample of the contour, mm per mm.
pub(super) fn stock_sensitivities(path: &Path, core: &job::Identified) -> Vec<f64> {
    let [more, less] = moved_stock(path).map(|(mut buffer, shift)| {
        let moved = path.with_stock_moved(&mut buffer, |_| shift);
        (shift, deflections(&moved, &core.fit.parameters))
    });
    let per = mm(less.0 - more.0);
    more.1.iter().zip(&less.1).map(|(more, less)| if per > 0.0 { mm(*more - *less) / per } else { 0.0 }).collect()
}

/// Buffers for a path with more and with less stock, and by how much it is moved towards the wall.
pub(super) fn moved_stock(path: &Path) -> [(Vec<Sample>, Offset); 2] {
    let share = path.setup().allowance.scaled(Real::ratio(1, 20));
    [-share, share].map(|shift| (vec![Sample::BLANK; path.samples().len()], shift))
}

/// Wall error by the deflection at the nominal engagement, mean over the height, beside every sample of the contour.
fn deflections(path: &Path, parameters: &Parameters) -> Vec<Offset> {
    let table = ForceTable::new(parameters.coefficients.size_exponent);
    let machine: Loop = parameters.machine(path, &table);
    let (mut scale, mut teeth) = ((None, Real::ZERO), Teeth::BLANK);
    let wall = |k: usize| {
        let index = path.first() + k;
        let sample = &path.samples()[index];
        if scale.0 != Some(sample.feed) {
            let feed = path.setup().feed_per_tooth(sample.feed);
            scale = (Some(sample.feed), machine.coefficients.chip_scale(feed));
        }
        let state = machine.nominal(index, scale.1);
        let mut along = |k: i64| machine.deflection_parts(&mut teeth, &state, Band::WHOLE.at(k)).1.along(sample.normal);
        let sum = (0..HEIGHTS).fold(Offset::ZERO, |sum, k| sum + along(k));
        -sum.scaled(Real::ratio(1, HEIGHTS))
    };
    (0..path.count()).map(wall).collect()
}
