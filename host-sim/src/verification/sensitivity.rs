//! What a touch would tell, by the model of the job.
//!
//! The core's fit is run on readings that agree with its prior exactly: it settles at once and leaves the sensitivities
//! of every reading to every unknown behind. They are those of the priors the job states; a machine far from them is
//! probed at places that are a little less telling, never at wrong ones.

use truepath_core::cut::{ForceTable, Path, State};
use truepath_core::geometry::{Direction, Vector};
use truepath_core::identify::{Observation, Parameter, PredictionWorkspace, Prior, identify_observed, predict};
use truepath_core::units::{Offset, Real};

use crate::report::{float, mm};

use super::candidates::Site;
use super::heights::Height;
use super::knowledge::Row;

/// What the touches of one place would tell.
#[derive(Clone, Debug)]
pub(super) struct Telling {
    /// Sensitivities of the readings, one row a height.
    pub(super) rows: Vec<Row>,
    /// Change of the wall itself, mm, one row a height: without the unknowns of the measurement.
    pub(super) wall: Vec<Row>,
}

/// The telling of every site, in their order. `progress` is told the share done, 0…1.
pub(super) fn tellings(
    path: &Path,
    prior: &Prior,
    sites: &[Site],
    heights: &[Height],
    noise: Offset,
    progress: &mut dyn FnMut(f64),
) -> Vec<Telling> {
    let needed = PredictionWorkspace::needed(path);
    let (mut states, mut displacements) = (vec![State::REST; needed], vec![Vector::ZERO; needed]);
    let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
    let blank = |site: &Site, height: &Height| {
        let height = Real::from_bits((height.fraction * 4_294_967_296.0) as i64);
        let normal = Direction { x: real(site.normal[0]), y: real(site.normal[1]) };
        Observation::new(site.s, height, Offset::ZERO, noise, normal)
    };
    let mut observations: Vec<Observation> =
        sites.iter().flat_map(|site| heights.iter().map(move |height| blank(site, height))).collect();
    let uncorrected = |_| Vector::ZERO;
    let table = ForceTable::new(prior.mean.coefficients.size_exponent);
    predict(path, &table, &prior.mean, uncorrected, &mut observations, &mut workspace);
    for observation in &mut observations {
        observation.error = observation.predicted;
    }
    // Two linearisations of the thirteen that the longest fit would take.
    let mut share = |permille: u16| progress((f64::from(permille) / 1000.0 * 13.0 / 2.0).min(1.0));
    identify_observed(path, prior, &mut observations, uncorrected, &mut workspace, &mut share);
    let telling = |touches: &[Observation]| {
        let rows: Vec<Row> = touches.iter().map(|o| o.sensitivity.map(float)).collect();
        let wall = touches.iter().zip(&rows).map(|(o, row)| wall_row(row, mm(o.deviation()))).collect();
        Telling { rows, wall }
    };
    observations.chunks(heights.len()).map(telling).collect()
}

fn real(value: f64) -> Real {
    Real::from_bits((value * 4_294_967_296.0).round() as i64)
}

/// Change of the wall: in mm, without what acts on the measurement alone.
fn wall_row(row: &Row, deviation: f64) -> Row {
    std::array::from_fn(|k| match Parameter::ALL[k] {
        Parameter::Radius | Parameter::DatumX | Parameter::DatumY => 0.0,
        _ => row[k] * deviation,
    })
}
