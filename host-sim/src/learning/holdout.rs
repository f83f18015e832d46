//! Places left out of a fit, to tell honestly whether it learned something: one in five of the newest part's.
//!
//! The rule knows neither errors nor fits: the third place along the contour, and every fifth after it. A part with
//! fewer than four places holds none out.

use truepath_core::correct::commanded;
use truepath_core::cut::{Path, State};
use truepath_core::geometry::Vector;
use truepath_core::identify::{Observation, PredictionWorkspace, predict};

use super::joint::{Joint, PartPoints};
use crate::report::mm;

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
    pub fn residual(&self, path: &Path, parts: &[PartPoints], model: &Joint) -> f64 {
        let mut points = self.points.clone();
        predicted(path, parts.last(), model, &mut points);
        let squares = points.chunk_by(|a, b| a.s == b.s).map(|place| {
            let sum: f64 = place.iter().map(|o| mm(o.error - o.predicted)).sum();
            (sum / place.len() as f64).powi(2)
        });
        let (sum, n) = squares.fold((0.0, 0.0), |(sum, n), square| (sum + square, n + 1.0));
        (sum / f64::max(n, 1.0)).sqrt()
    }
}

/// Predicts points of a part by a model, without a datum shift: that of another clamping is not known.
fn predicted(path: &Path, part: Option<&PartPoints>, model: &Joint, points: &mut [Observation]) {
    let needed = path.working().len() + 1;
    let (mut states, mut displacements) = (vec![State::REST; needed], vec![Vector::ZERO; needed]);
    let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
    let path = path.with_law(model.core.law);
    let parameters = truepath_core::identify::Parameters { datum: Vector::ZERO, ..model.core.fit.parameters };
    let nodes = part.map(|p| p.nodes.as_slice()).unwrap_or_default();
    predict(&path, &model.core.table(), &parameters, |i| commanded(&path, nodes, i), points, &mut workspace);
}
