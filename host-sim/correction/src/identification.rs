//! Machine and material from probe points, under the wall law that is given or that the points speak for.
//!
//! Which law that is only a fit under either can tell ([`truepath_core::identify`]). The device fits one after the other;
//! here both run at the same time, on points of their own, and give the same bits.

use truepath_core::cut::{Path, State, WallLaw};
use truepath_core::geometry::Vector;
use truepath_core::identify::{EarlierPart, Observation, PredictionWorkspace, identify, speaks_for_mean};
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

/// The points of one part or several.
#[derive(Clone, Copy, Debug)]
pub struct Points<'a> {
    /// The parts before the last one.
    pub earlier: &'a [EarlierPart],
    /// The points, one part behind the other.
    pub observations: &'a [Observation],
}

/// The wall law that a job asks for; `None` leaves it to the points.
pub const fn asked(model: ForceModel) -> Option<WallLaw> {
    match model {
        ForceModel::Auto => None,
        ForceModel::Mean => Some(WallLaw::Mean),
        ForceModel::Helical => Some(WallLaw::Helical),
    }
}

/// Fits machine and material to points under a law, or under the one they speak for. `commanded(part, sample)` is the
/// displacement that the program of a part, counted from 0, commanded. `progress` is told the share done, 0…1.
pub fn found(
    pass: &job::ContourPass,
    path: &Path,
    law: Option<WallLaw>,
    points: Points<'_>,
    commanded: impl Fn(usize, usize) -> Vector + Copy + Sync,
    progress: &mut dyn FnMut(f64),
) -> Found {
    let under = |law, progress: &mut dyn FnMut(f64)| {
        let (mut earlier, mut observations) = (points.earlier.to_vec(), points.observations.to_vec());
        let needed = path.working().len() + 1;
        let (mut states, mut displacements) = (vec![State::REST; needed], vec![Vector::ZERO; needed]);
        let mut workspace = PredictionWorkspace { states: &mut states, displacements: &mut displacements };
        let prior = pass.prior(law);
        let mut observe = |permille| progress(f64::from(permille) / 1000.0);
        let path = path.with_law(law);
        let fit = identify(&path, &prior, &mut earlier, &mut observations, commanded, &mut workspace, &mut observe);
        Found { core: job::Identified { law, prior, fit }, earlier, observations }
    };
    if let Some(law) = law {
        return under(law, progress);
    }
    let mut mean = None;
    let helical = rayon::in_place_scope(|threads| {
        threads.spawn(|_| mean = Some(under(WallLaw::Mean, &mut |_| ())));
        under(WallLaw::Helical, progress)
    });
    let Some(mean) = mean else { return helical };
    if speaks_for_mean(&mean.core.fit, &helical.core.fit) { mean } else { helical }
}
