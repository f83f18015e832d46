//! What the parameters do to the wall that a correction has to cancel, beside every sample of a contour.

use rayon::prelude::*;
use truepath_core::correct::Band;
use truepath_core::cut::{ForceTable, Heights, Loop, Path, Sample, State};
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
    let states = engaged(path, core);
    let change = |(k, parameter): (usize, &Parameter)| match parameter {
        // Another clamping, another datum: it is not on the wall to come.
        Parameter::DatumX | Parameter::DatumY => None,
        Parameter::Undersize => Some((k, vec![float(core.prior.sigma[k]); path.count()])),
        _ if core.prior.sigma[k] == Real::ZERO => None,
        _ => {
            let [above, below] = [STEP, -STEP].map(|step| {
                let mut theta = core.fit.theta;
                theta[k] += step;
                deflections(path, &states, &core.prior.at(&theta))
            });
            let quotient = 1.0 / (2.0 * float(STEP));
            Some((k, above.iter().zip(&below).map(|(above, below)| mm(*above - *below) * quotient).collect()))
        }
    };
    let changes: Vec<(usize, Vec<f64>)> = Parameter::ALL.par_iter().enumerate().filter_map(change).collect();
    for (k, change) in changes {
        rows.iter_mut().zip(change).for_each(|(row, change)| row[k] = change);
    }
    rows
}

/// Change of the deflection at the nominal engagement per allowance, beside every sample of the contour, mm per mm.
pub(super) fn stock_sensitivities(path: &Path, core: &job::Identified) -> Vec<f64> {
    let [more, less] = moved_stock(path).map(|(mut buffer, shift)| {
        let moved = path.with_stock_moved(&mut buffer, |_| shift);
        (shift, deflections(&moved, &engaged(&moved, core), &core.fit.parameters))
    });
    let per = mm(less.0 - more.0);
    more.1.iter().zip(&less.1).map(|(more, less)| if per > 0.0 { mm(*more - *less) / per } else { 0.0 }).collect()
}

/// What other stock does to the deflection at the nominal engagement, beside every sample of the contour.
pub(super) fn by_stock(even: &Path, stocked: &Path, core: &job::Identified) -> Vec<Offset> {
    let [without, with] = [even, stocked].map(|path| deflections(path, &engaged(path, core), &core.fit.parameters));
    with.iter().zip(&without).map(|(with, without)| *with - *without).collect()
}

/// A path with its stock moved towards the wall by so much at every sample, in a buffer.
pub(super) fn with_stock<'a>(
    path: &Path,
    mut shifts: impl Iterator<Item = Offset>,
    buffer: &'a mut Vec<Sample>,
) -> Path<'a> {
    buffer.resize(path.samples().len(), Sample::BLANK);
    path.with_stock_moved(buffer, |_| shifts.next().unwrap_or_default())
}

/// Buffers for a path with more and with less stock, and by how much it is moved towards the wall.
pub(super) fn moved_stock(path: &Path) -> [(Vec<Sample>, Offset); 2] {
    let share = path.setup().allowance.scaled(Real::ratio(1, 20));
    [-share, share].map(|shift| (vec![Sample::BLANK; path.samples().len()], shift))
}

/// The cutter at its nominal place beside every sample of the contour: how far it is engaged there, no machine changes.
fn engaged(path: &Path, core: &job::Identified) -> Vec<State> {
    let table = core.table();
    let machine = core.machine(path, &table);
    (path.first()..path.first() + path.count()).map(|index| machine.nominal(index, Real::ZERO)).collect()
}

/// Wall error by the deflection of a machine at the nominal engagement, mean over the height, beside every sample of the contour.
fn deflections(path: &Path, engaged: &[State], parameters: &Parameters) -> Vec<Offset> {
    let table = ForceTable::new(parameters.coefficients.size_exponent);
    let machine: Loop = parameters.machine(path, &table);
    let samples = &path.samples()[path.first()..path.first() + path.count()];
    let mut scale = (None, Real::ZERO);
    let states = engaged.iter().zip(samples).map(|(state, sample)| {
        if scale.0 != Some(sample.feed) {
            let feed = path.setup().feed_per_tooth(sample.feed);
            scale = (Some(sample.feed), machine.coefficients.chip_scale(feed));
        }
        State { chip_scale: scale.1, ..*state }
    });
    let mut heights: Heights<{ HEIGHTS as usize }> = Heights::new(std::array::from_fn(|k| Band::WHOLE.at(k as i64)));
    let mean = |(state, sample): (State, &Sample)| {
        let deflections = machine.deflections(&mut heights, &state);
        let sum = deflections.iter().fold(Offset::ZERO, |sum, deflection| sum + deflection.along(sample.normal));
        -sum.scaled(Real::ratio(1, HEIGHTS))
    };
    states.zip(samples).map(mean).collect()
}
