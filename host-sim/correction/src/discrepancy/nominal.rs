//! What the parameters do to the wall that a correction has to cancel, beside every sample of a contour.

use std::ops::Range;

use rayon::prelude::*;
use truepath_core::correct::Band;
use truepath_core::cut::{Heights, Loop, Path, Sample, State};
use truepath_core::identify::{COUNT, Parameter, Parameters};
use truepath_core::job;
use truepath_core::units::{Offset, Real};
use truepath_ground::units::{float, mm};

use super::feature::Engagement;
use crate::force_tables::force_table;

/// Step of the difference quotients, prior standard deviations.
const STEP: Real = Real::ratio(1, 32);
/// Samples of a stretch that is not divided among threads.
const STRETCH: usize = 512;
/// Heights over which the wall is averaged.
const HEIGHTS: i64 = truepath_core::correct::HEIGHTS;

/// The cutter at its nominal place along a contour, where a correction that works leads it.
#[derive(Clone, Debug)]
pub(super) struct Nominal<'a> {
    path: &'a Path<'a>,
    core: &'a job::Identified,
    /// At every working sample of the path.
    states: Vec<State>,
}

impl<'a> Nominal<'a> {
    /// Of an identified machine.
    pub(super) fn of(path: &'a Path<'a>, core: &'a job::Identified) -> Self {
        Self { path, core, states: engaged(path, core, path.working()) }
    }

    /// How far it is engaged.
    pub(super) fn engagement(&self, contour: usize) -> Engagement<'a> {
        Engagement::of(self.path, contour, self.path.working().start, &self.states)
    }

    /// Change of the deflection per prior standard deviation of the compliance, beside every sample of the contour, mm.
    pub(super) fn by_compliance(&self) -> Vec<f64> {
        let every: Vec<usize> = (0..self.path.count()).collect();
        self.change(0, &every).unwrap_or_else(|| vec![0.0; every.len()])
    }

    /// Change of the deflection per prior standard deviation of every shared parameter, one row per place, which are samples of the
    /// contour, mm: what changes of the wall when the machine is another than the correction was made for.
    pub(super) fn sensitivities(&self, places: &[usize]) -> Vec<[f64; COUNT]> {
        let mut rows = vec![[0.0; COUNT]; places.len()];
        let changes: Vec<_> = (0..COUNT).into_par_iter().map(|k| self.change(k, places)).collect();
        for (k, change) in changes.into_iter().enumerate() {
            rows.iter_mut().zip(change.into_iter().flatten()).for_each(|(row, change)| row[k] = change);
        }
        rows
    }

    /// That of one parameter; `None` where it changes nothing.
    fn change(&self, k: usize, places: &[usize]) -> Option<Vec<f64>> {
        let (core, before) = (self.core, self.path.first() - self.path.working().start);
        match Parameter::ALL[k] {
            // Another clamping, another datum: it is not on the wall to come.
            Parameter::DatumX | Parameter::DatumY => None,
            Parameter::Undersize => Some(vec![float(core.prior.sigma[k]); places.len()]),
            _ if core.prior.sigma[k] == Real::ZERO => None,
            _ => {
                let [above, below] = [STEP, -STEP].map(|step| {
                    let mut theta = core.fit.theta;
                    theta[k] += step;
                    let samples = of_contour(self.path);
                    let at = places.iter().map(|place| (&self.states[before + *place], &samples[*place]));
                    with_machine(self.path, &core.prior.at(&theta), |machine| deflections(machine, at))
                });
                let quotient = 1.0 / (2.0 * float(STEP));
                Some(above.iter().zip(&below).map(|(above, below)| mm(*above - *below) * quotient).collect())
            }
        }
    }
}

/// Change of the deflection at the nominal engagement per allowance, beside every sample of the contour, mm per mm.
pub(super) fn stock_sensitivities(path: &Path, core: &job::Identified) -> Vec<f64> {
    let [more, less] = moved_stock(path).map(|(mut buffer, shift)| {
        let moved = path.with_stock_moved(&mut buffer, |_| shift);
        (shift, every_deflection(&moved, core))
    });
    let per = mm(less.0 - more.0);
    more.1.iter().zip(&less.1).map(|(more, less)| if per > 0.0 { mm(*more - *less) / per } else { 0.0 }).collect()
}

/// What other stock does to the deflection at the nominal engagement, beside every sample of the contour.
pub(super) fn by_stock(even: &Path, stocked: &Path, core: &job::Identified) -> Vec<Offset> {
    let [without, with] = [even, stocked].map(|path| every_deflection(path, core));
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

/// The cutter at its nominal place at samples: how far it is engaged there, no machine changes.
fn engaged(path: &Path, core: &job::Identified, samples: Range<usize>) -> Vec<State> {
    let table = force_table(&core.fit.parameters);
    let machine = core.machine(path, &table);
    samples.into_par_iter().map(|index| machine.nominal(index, Real::ZERO)).collect()
}

/// The samples of the contour itself.
fn of_contour<'a>(path: &Path<'a>) -> &'a [Sample] {
    &path.samples()[path.first()..path.first() + path.count()]
}

/// Wall error by the deflection of an identified machine at the nominal engagement, mean over the height, beside every sample of the
/// contour.
fn every_deflection(path: &Path, core: &job::Identified) -> Vec<Offset> {
    let engaged = engaged(path, core, path.first()..path.first() + path.count());
    with_machine(path, &core.fit.parameters, |machine| {
        let stretches = engaged.par_chunks(STRETCH).zip(of_contour(path).par_chunks(STRETCH));
        stretches.flat_map_iter(|(states, samples)| deflections(machine, states.iter().zip(samples))).collect()
    })
}

/// Does something with a machine that has such parameters.
fn with_machine<T>(path: &Path, parameters: &Parameters, with: impl FnOnce(&Loop) -> T) -> T {
    let table = force_table(parameters);
    with(&parameters.machine(path, &table))
}

/// The same of any machine, beside samples where the cutter is engaged as in a state.
fn deflections<'s>(machine: &Loop, engaged: impl Iterator<Item = (&'s State, &'s Sample)>) -> Vec<Offset> {
    let mut scale = (None, Real::ZERO);
    let fractions: [Real; HEIGHTS as usize] = std::array::from_fn(|k| Band::WHOLE.at(k as i64));
    let mut heights = Heights::new(machine, fractions);
    let mean = |(state, sample): (&State, &Sample)| {
        if scale.0 != Some(sample.feed) {
            let feed = machine.path.setup().feed_per_tooth(sample.feed);
            scale = (Some(sample.feed), machine.coefficients.chip_scale(feed));
        }
        let deflections = machine.deflections(&mut heights, &State { chip_scale: scale.1, ..*state });
        let sum = deflections.iter().fold(Offset::ZERO, |sum, deflection| sum + deflection.along(sample.normal));
        -sum.scaled(Real::ratio(1, HEIGHTS))
    };
    engaged.map(mean).collect()
}
