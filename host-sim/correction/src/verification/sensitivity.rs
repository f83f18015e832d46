//! What a touch would tell, by the model at the present estimate.
//!
//! Difference quotients of the predicted readings about the estimate: those the job states before anything
//! is measured, those of the fit afterwards. A machine far from them is probed at places that are a little less telling,
//! never at wrong ones.

use truepath_core::cut::{ForceTable, Path, State};
use truepath_core::geometry::{Direction, Vector};
use truepath_core::identify::{COUNT, Observation, Parameter, PredictionWorkspace, predict};
use truepath_core::units::{Offset, Real, hypot_nm};
use truepath_ground::units::{float, mm, real};

use super::candidates::Site;
use super::covariance::{Row, Thing};
use super::estimate::{Estimate, of_measurement};
use super::heights::Height;
use crate::force_tables::force_table;

/// What the touches of one place would tell.
#[derive(Clone, Debug)]
pub(super) struct Sensitivity {
    /// Sensitivities of the readings, one row a height.
    pub(super) rows: Vec<Row>,
    /// Standard deviations of the readings, mm, one a height.
    pub(super) deviations: Vec<f64>,
    /// Change of the wall itself, mm, one row a height: without the unknowns of the measurement.
    pub(super) wall: Vec<Row>,
}

impl Sensitivity {
    /// The touches, where something is beside the model at a place of the wall.
    pub(super) fn touches(&self, beside: Option<usize>) -> Vec<Thing> {
        let touch =
            |(row, deviation): (&Row, &f64)| Thing { row: *row, beside: beside.map(|at| (at, 1.0 / deviation)) };
        self.rows.iter().zip(&self.deviations).map(touch).collect()
    }
}

/// Step of the difference quotients, in standard deviations of what the job states.
const DIFFERENCE: Real = Real::ratio(1, 32);

/// The sensitivities of every site, in their order. `progress` is told the share done, 0…1.
pub(super) fn sensitivities(
    path: &Path,
    estimate: &Estimate,
    sites: &[Site],
    heights: &[Height],
    noise: Offset,
    progress: &mut dyn FnMut(f64),
) -> Vec<Sensitivity> {
    let blank = |site: &Site, height: &Height| {
        let height = Real::from_bits((height.fraction * 4_294_967_296.0) as i64);
        let normal = Direction { x: real(site.normal[0]), y: real(site.normal[1]) };
        Observation::new(site.s, height, Offset::ZERO, hypot_nm(noise, site.unsteady), normal)
    };
    let mut touches: Vec<Observation> =
        sites.iter().flat_map(|site| heights.iter().map(move |height| blank(site, height))).collect();
    let rows = rows(path, estimate, &mut touches, progress);
    let deviations: Vec<f64> = touches.iter().map(|o| mm(o.deviation())).collect();
    let sensitivity = |(rows, deviations): (&[Row], &[f64])| {
        let wall = rows.iter().zip(deviations).map(|(row, deviation)| wall_row(row, *deviation)).collect();
        Sensitivity { rows: rows.to_vec(), deviations: deviations.to_vec(), wall }
    };
    rows.chunks(heights.len()).zip(deviations.chunks(heights.len())).map(sensitivity).collect()
}

/// A place of the same load where it is steady, as a share.
const ALIKE: f64 = 0.9;

/// Without places where the load changes, if it is as high at a steady one within `near` mm: what is read on the way up tells of
/// that way.
pub(super) fn without_ramps(
    sites: Vec<Site>,
    sensitivities: Vec<Sensitivity>,
    near: f64,
) -> (Vec<Site>, Vec<Sensitivity>) {
    let load = |of: &Sensitivity| of.wall.iter().map(|row| row[0].abs()).sum::<f64>();
    let steady: Vec<(f64, f64)> = sites
        .iter()
        .zip(&sensitivities)
        .filter(|(site, _)| site.unsteady == Offset::ZERO)
        .map(|(site, of)| (mm(site.s), load(of)))
        .collect();
    let is_kept = |(site, of): &(Site, Sensitivity)| {
        let as_high = |(s, other): &(f64, f64)| (s - mm(site.s)).abs() <= near && *other >= ALIKE * load(of);
        site.unsteady == Offset::ZERO || !steady.iter().any(as_high)
    };
    sites.into_iter().zip(sensitivities).filter(is_kept).unzip()
}

/// The sensitivities of readings, which then hold what is expected of them as their error: change per prior standard
/// deviation, in standard deviations of the reading. `progress` is told the share done, 0…1.
pub(super) fn rows(
    path: &Path,
    estimate: &Estimate,
    touches: &mut [Observation],
    progress: &mut dyn FnMut(f64),
) -> Vec<Row> {
    let needed = PredictionWorkspace::needed(path);
    let (mut states, mut displacements) = (vec![State::REST; needed], vec![Vector::ZERO; needed]);
    let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
    let mut readings = |touches: &mut [Observation], parameters: &_, table: &ForceTable| {
        predict(path, table, parameters, |i| estimate.commanded(path, i), touches, &mut workspace);
        touches.iter().map(|o| o.predicted).collect::<Vec<_>>()
    };
    let parameters = estimate.parameters();
    let table = force_table(&parameters);
    let expected = readings(touches, &parameters, &table);
    for (touch, expected) in touches.iter_mut().zip(&expected) {
        touch.error = *expected;
    }
    let deviations: Vec<f64> = touches.iter().map(|o| mm(o.deviation())).collect();
    let mut rows = vec![[0.0; COUNT]; touches.len()];
    for (k, parameter) in Parameter::ALL.into_iter().enumerate() {
        progress(k as f64 / COUNT as f64);
        let sigma = float(estimate.prior.sigma[k]);
        if sigma == 0.0 {
            continue;
        }
        if of_measurement(parameter) {
            for ((row, touch), deviation) in rows.iter_mut().zip(&*touches).zip(&deviations) {
                row[k] = sigma / deviation * direct(parameter, touch);
            }
            continue;
        }
        let mut at = |by: Real| {
            let moved = estimate.displaced(k, by);
            readings(touches, &moved, &force_table(&moved))
        };
        let (above, below) = (at(DIFFERENCE), at(-DIFFERENCE));
        for (((row, a), b), deviation) in rows.iter_mut().zip(&above).zip(&below).zip(&deviations) {
            row[k] = mm(*a - *b) / (2.0 * float(DIFFERENCE)) / deviation;
        }
    }
    rows
}

/// What a unit of an unknown of the measurement does to a reading.
fn direct(parameter: Parameter, touch: &Observation) -> f64 {
    match parameter {
        Parameter::DatumX => float(touch.by_datum()[0]),
        Parameter::DatumY => float(touch.by_datum()[1]),
        _ => 1.0,
    }
}

/// Change of the wall: in mm, without what acts on the measurement alone.
pub(super) fn wall_row(row: &Row, deviation: f64) -> Row {
    std::array::from_fn(|k| if of_measurement(Parameter::ALL[k]) { 0.0 } else { row[k] * deviation })
}
