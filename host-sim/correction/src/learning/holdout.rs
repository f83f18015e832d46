//! Places left out of a fit, to tell honestly whether it learned something: one in five of the newest part's.
//!
//! The rule knows neither errors nor fits: the third place along the contour, and every fifth after it. A part with
//! fewer than four places holds none out, and no place counts where half a width to another contour was measured.

use std::ops::Range;

use truepath_core::correct::commanded;
use truepath_core::cut::{Path, State};
use truepath_core::geometry::Vector;
use truepath_core::identify::{Observation, Parameters, PredictionWorkspace, predict};
use truepath_core::units::Real;
use truepath_ground::units::{float, mm};

use super::joint::{Joint, PartPoints};
use crate::discrepancy::{CutPoints, Engagement, Own, Sensitivity, stock_sensitivities};
use crate::force_tables::force_table;

/// Which places are held out.
#[derive(Clone, Debug)]
pub struct Holdout {
    /// Their arc lengths, mm.
    pub places: Vec<f64>,
    points: Vec<Observation>,
}

/// Root mean square of measured − predicted at the held-out places, mean over the heights of a place, mm.
#[derive(Clone, Debug, serde::Serialize, schemars::JsonSchema)]
pub struct Residuals {
    /// Where the places are, mm along the contour.
    #[serde(rename = "places_s_mm")]
    pub places: Vec<f64>,
    /// Of the model that the part's correction was made from.
    pub before_mm: f64,
    /// Of the updated model, which has not seen these places.
    pub after_mm: f64,
}

impl Holdout {
    /// Of the last of the parts; `None` when it has fewer than four places.
    pub fn of(parts: &[PartPoints]) -> Option<Self> {
        let newest = parts.last()?;
        let places = newest.places();
        if places.len() < 4 {
            return None;
        }
        let is_whole = |range: &Range<usize>| newest.observations[range.clone()].iter().all(|o| o.pair().is_none());
        let held = places.into_iter().enumerate().filter(|(k, range)| k % 5 == 2 && is_whole(range));
        let points: Vec<Observation> = held.flat_map(|(_, range)| newest.observations[range].to_vec()).collect();
        if points.is_empty() {
            return None;
        }
        let places = points.chunk_by(|a, b| a.s == b.s).map(|place| mm(place[0].s)).collect();
        Some(Self { places, points })
    }

    /// The parts without the places held out.
    pub fn without(&self, parts: &[PartPoints]) -> Vec<PartPoints> {
        let mut parts = parts.to_vec();
        if let Some(newest) = parts.last_mut() {
            newest.observations.retain(|o| self.points.iter().all(|held| held.s != o.s));
        }
        parts
    }

    /// What a model misses at the held-out places of the last part.
    pub fn residual(&self, path: &Path, parts: &[PartPoints], model: &Joint) -> f64 {
        parts.last().map_or(0.0, |part| missed(path, part, &self.points, model))
    }
}

/// What a model, with what is known beside it, misses at points of a part: root mean square over the places, mm. Halves of
/// widths to another contour, which it does not know, do not count.
pub(super) fn missed(path: &Path, part: &PartPoints, points: &[Observation], model: &Joint) -> f64 {
    let mut points = seen_alone(points);
    let mut buffer = Vec::new();
    let path = &match &model.beside {
        Some(beside) => beside.discrepancy.stocked(path, 0, &mut buffer),
        None => *path,
    };
    let states = predicted(path, part, model, &model.core.fit.parameters, &mut points);
    let path = path.with_law(model.core.law);
    let loads = loads(&path, part, model, &points);
    let cut = CutPoints {
        path: &path,
        contour: 0,
        parts_ago: 1,
        nodes: &part.nodes,
        observations: &points,
        more: &[],
        own: Own::default(),
    };
    let stocks = stock_sensitivities(&path, &cut, &model.core);
    let engagement = Engagement::of(&path, 0, path.working().start, &states);
    let squares = points.chunk_by(|a, b| a.s == b.s).scan(0, |at, place| {
        let own = *at..*at + place.len();
        *at += place.len();
        let over = |values: &[f64]| values[own.clone()].iter().sum::<f64>() / place.len() as f64;
        let sensitivity = Sensitivity { load: over(&loads), stock: over(&stocks) };
        let count = place.len() as f64;
        let sum: f64 = place.iter().map(|o| mm(o.error - o.predicted)).sum();
        let more = model
            .beside
            .as_ref()
            .map_or(0.0, |beside| beside.discrepancy.rest_at(&engagement.at(place[0].s, place[0].normal, sensitivity)));
        Some((sum / count - more).powi(2))
    });
    let (sum, n) = squares.fold((0.0, 0.0), |(sum, n), square| (sum + square, n + 1.0));
    (sum / f64::max(n, 1.0)).sqrt()
}

/// The points that one contour explains.
pub(super) fn seen_alone(points: &[Observation]) -> Vec<Observation> {
    points.iter().filter(|o| o.pair().is_none()).copied().collect()
}

/// Predicts points of a part by a model with the parameters given, without a datum shift: that of another clamping is not known.
/// Returns the cutter's states along the path.
pub(super) fn predicted(
    path: &Path,
    part: &PartPoints,
    model: &Joint,
    parameters: &Parameters,
    points: &mut [Observation],
) -> Vec<State> {
    let parameters = Parameters { datum: Vector::ZERO, ..*parameters };
    predict_points(path, part, model, &parameters, points);
    let path = path.with_law(model.core.law);
    let (working, table) = (path.working(), force_table(&model.core.fit.parameters));
    let mut states = vec![State::REST; working.len()];
    parameters.machine(&path, &table).run(working.start, &mut states, |i| commanded(&path, &part.nodes, i));
    states
}

/// Change of the error at points of a part when force or compliance is larger, mm per unit of the natural logarithm.
fn loads(path: &Path, part: &PartPoints, model: &Joint, points: &[Observation]) -> Vec<f64> {
    const STEP: Real = Real::ratio(1, 32);
    let [above, below] = [STEP, -STEP].map(|step| {
        let mut theta = model.core.fit.theta;
        theta[0] += step;
        let mut points = points.to_vec();
        predict_points(path, part, model, &model.core.prior.at(&theta), &mut points);
        points
    });
    let per = 2.0 * float(STEP) * float(model.core.prior.sigma[0]).max(1e-9);
    above.iter().zip(&below).map(|(above, below)| mm(above.predicted - below.predicted) / per).collect()
}

fn predict_points(path: &Path, part: &PartPoints, model: &Joint, parameters: &Parameters, points: &mut [Observation]) {
    let path = path.with_law(model.core.law);
    let room = path.working().len() + 1;
    let table = force_table(parameters);
    let (mut states, mut displacements) = (vec![State::REST; room], vec![Vector::ZERO; room]);
    let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
    predict(&path, &table, parameters, |i| commanded(&path, &part.nodes, i), points, &mut workspace);
}
