//! Machine and material from probe points, under the wall law that is given or that the points speak for.
//!
//! Which law that is only a fit under either can tell ([`truepath_core::identify`]). The device fits one after the other;
//! here both run at the same time, on points of their own, and the places of a fit are predicted at the same time: no place knows of
//! another, so the bits are the same.

use rayon::prelude::*;
use truepath_core::cut::{ForceTable, Path, State, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::{
    Cut, EarlierPart, Fit, Observation, Parameters, PredictionWorkspace, Predictor, Search, identify, speaks_for_mean,
};
use truepath_core::job::{self, ForceModel};

/// What a fit has found, with the points as it left them.
#[derive(Clone, Debug)]
pub struct Found {
    /// Wall law, machine and material.
    pub core: job::Identified,
    /// The parts before the last one, with their datums.
    pub earlier: Vec<EarlierPart>,
    /// The points with predictions, weights and sensitivities.
    pub observations: Vec<Observation>,
}

/// The points of one cut or several.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// The cuts they are of, in their order; the wall law of the paths does not matter.
    pub cuts: &'a [Cut<'a>],
    /// The parts before the last one.
    pub earlier: &'a [EarlierPart],
    /// The points, one cut behind the other.
    pub observations: &'a [Observation],
    /// A fit of these points, which has left them as they are, of nearly the same machine under the same law: it is gone on from there.
    pub begin: Option<&'a Fit>,
}

/// The wall law that a job asks for; `None` leaves it to the points.
pub const fn asked(model: ForceModel) -> Option<WallLaw> {
    match model {
        ForceModel::Auto => None,
        ForceModel::Mean => Some(WallLaw::Mean),
        ForceModel::Helical => Some(WallLaw::Helical),
    }
}

/// Fits machine and material to points under a law, or under the one they speak for. `commanded(cut, sample)` is the
/// displacement that the program commanded at a sample of a cut. `progress` is told the share done, 0…1.
pub fn found(
    pass: &job::ContourPass,
    law: Option<WallLaw>,
    points: Points<'_>,
    commanded: impl Fn(usize, usize) -> Vector + Copy + Sync,
    progress: &mut dyn FnMut(f64),
) -> Found {
    if let Some(law) = law {
        return under(law, pass, points, commanded, progress);
    }
    let (mean, helical) = under_both(pass, points, commanded, progress);
    if speaks_for_mean(&mean.core.fit, &helical.core.fit) { mean } else { helical }
}

/// As [`found`], under the mean law and under the helical one.
pub fn under_both(
    pass: &job::ContourPass,
    points: Points<'_>,
    commanded: impl Fn(usize, usize) -> Vector + Copy + Sync,
    progress: &mut dyn FnMut(f64),
) -> (Found, Found) {
    let mut mean = None;
    let helical = rayon::in_place_scope(|threads| {
        threads.spawn(|_| mean = Some(under(WallLaw::Mean, pass, points, commanded, &mut |_| ())));
        under(WallLaw::Helical, pass, points, commanded, progress)
    });
    (mean.unwrap_or_else(|| helical.clone()), helical)
}

fn under(
    law: WallLaw,
    pass: &job::ContourPass,
    points: Points<'_>,
    commanded: impl Fn(usize, usize) -> Vector + Copy + Sync,
    progress: &mut dyn FnMut(f64),
) -> Found {
    let (mut earlier, mut observations) = (points.earlier.to_vec(), points.observations.to_vec());
    let cuts: Vec<Cut> = points.cuts.iter().map(|cut| Cut { path: cut.path.with_law(law), ..*cut }).collect();
    let mut predictor =
        Places { room: cuts.iter().map(|cut| PredictionWorkspace::needed(&cut.path)).max().unwrap_or(0) };
    let prior = pass.prior(law);
    let mut observe = |permille| progress(f64::from(permille) / 1000.0);
    let fit = identify(
        &cuts,
        (&prior, points.begin),
        &mut earlier,
        &mut observations,
        commanded,
        &mut predictor,
        &mut observe,
    );
    Found { core: job::Identified { law, prior, fit }, earlier, observations }
}

/// Predicts the places of a contour on all processors.
struct Places {
    /// Length of the buffers for one place.
    room: usize,
}

impl Predictor for Places {
    fn predict(
        &mut self,
        path: &Path,
        table: &ForceTable,
        parameters: &Parameters,
        search: Search,
        commanded: impl Fn(usize) -> Vector + Copy + Sync,
        observations: &mut [Observation],
    ) {
        let places: Vec<&mut [Observation]> = observations.chunk_by_mut(|a, b| a.s == b.s).collect();
        let buffers = || (vec![State::REST; self.room], vec![Vector::ZERO; self.room]);
        places.into_par_iter().for_each_init(buffers, |(states, displacements), place| {
            let mut here = PredictionWorkspace { states, displacements };
            here.predict(path, table, parameters, search, commanded, place);
        });
    }
}
