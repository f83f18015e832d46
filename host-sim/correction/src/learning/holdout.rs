//! Places left out of a fit, to tell honestly whether it learned something: one in five of the newest part's.
//!
//! The rule knows neither errors nor fits: the third place along the contour, and every fifth after it. A part with
//! fewer than four places holds none out.

use truepath_core::correct::commanded;
use truepath_core::cut::{Path, State};
use truepath_core::geometry::Vector;
use truepath_core::identify::{Observation, Parameters, PredictionWorkspace, predict};
use truepath_ground::units::mm;

use super::joint::{Joint, PartPoints};
use super::kernel::Engagement;
use super::residual::Residual;

/// Which places are held out.
#[derive(Clone, Debug)]
pub struct Holdout {
    /// Their arc lengths, mm.
    pub places: Vec<f64>,
    points: Vec<Observation>,
}

/// Root mean square of measured − predicted at the held-out places, mean over the heights of a place, mm.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Residuals {
    /// Where the places are, mm along the contour.
    #[serde(rename = "places_s_mm")]
    pub places: Vec<f64>,
    /// Of the model that the part's correction was made from.
    pub before_mm: f64,
    /// Of the updated model, which has not seen these places.
    pub after_mm: f64,
    /// Of the updated model with the residual, when there is one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub after_with_residual_mm: Option<f64>,
}

impl Holdout {
    /// Of the last of the parts; `None` when it has fewer than four places.
    pub fn of(parts: &[PartPoints]) -> Option<Self> {
        let newest = parts.last()?;
        let places = newest.places();
        if places.len() < 4 {
            return None;
        }
        let held = places.into_iter().enumerate().filter(|(k, _)| k % 5 == 2);
        let points: Vec<Observation> = held.flat_map(|(_, range)| newest.observations[range].to_vec()).collect();
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
    pub fn residual(&self, path: &Path, parts: &[PartPoints], model: &Joint, beside: Option<&Residual>) -> f64 {
        parts.last().map_or(0.0, |part| missed(path, part, &self.points, model, beside))
    }
}

/// What a model, with what is known beside it, misses at points of a part: root mean square over the places, mm.
pub(super) fn missed(
    path: &Path,
    part: &PartPoints,
    points: &[Observation],
    model: &Joint,
    beside: Option<&Residual>,
) -> f64 {
    let mut points = points.to_vec();
    let states = predicted(path, part, model, &mut points);
    let path = path.with_law(model.core.law);
    let engagement = Engagement::of(&path, path.working().start, &states);
    let squares = points.chunk_by(|a, b| a.s == b.s).map(|place| {
        let sum: f64 = place.iter().map(|o| mm(o.error - o.predicted)).sum();
        let feature = engagement.at(place[0].s, place[0].normal);
        let more = beside.map_or(0.0, |residual| residual.at(&feature).0);
        (sum / place.len() as f64 - more).powi(2)
    });
    let (sum, n) = squares.fold((0.0, 0.0), |(sum, n), square| (sum + square, n + 1.0));
    (sum / f64::max(n, 1.0)).sqrt()
}

/// Predicts points of a part by a model, without a datum shift: that of another clamping is not known. Returns the
/// cutter's states along the path.
pub(super) fn predicted(path: &Path, part: &PartPoints, model: &Joint, points: &mut [Observation]) -> Vec<State> {
    let path = path.with_law(model.core.law);
    let (working, table) = (path.working(), model.core.table());
    let (mut states, mut displacements) = (vec![State::REST; working.len() + 1], vec![Vector::ZERO; working.len() + 1]);
    let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
    let parameters = Parameters { datum: Vector::ZERO, ..model.core.fit.parameters };
    let asked = |i: usize| commanded(&path, &part.nodes, i);
    predict(&path, &table, &parameters, asked, points, &mut workspace);
    states.truncate(working.len());
    model.core.machine(&path, &table).run(working.start, &mut states, asked);
    states
}
