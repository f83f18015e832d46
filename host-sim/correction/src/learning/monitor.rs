//! How the parts came out: the error of the target quantity at their places, and whether the newest one is worse.
//!
//! A probe touches a few heights, the target is (say) the mean over all. So the error of the target at a place is that of
//! the model there plus what was measured beside the model, mean over the heights touched: where the model is right about
//! the shape over height, this is what the probe would find as the mean over all heights.
//!
//! The newest part is held against the one before at the newest's places: as it was measured there, where the part
//! before was touched at the same place, else as the model of all parts says. A worse part may hide behind places that
//! were not touched before only as far as that model is wrong.

use truepath_core::correct::{Law, Profile, Target};
use truepath_core::cut::Path;
use truepath_core::units::{Offset, Real};
use truepath_ground::units::{float, mm, real};
use truepath_job::pass::Pass;

use super::joint::{Joint, PartPoints};
use crate::correction::walls;
use crate::discrepancy::Own;
use crate::force_tables::force_table;

/// Error of the target quantity over some places.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct PartError {
    /// Number of the part.
    pub part: u32,
    /// Largest magnitude, mm.
    pub max_mm: f64,
    /// Root mean square, mm.
    pub rms_mm: f64,
    /// Places.
    pub places: usize,
}

/// A place of a part.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Place {
    /// Arc length.
    pub s: Offset,
    /// Error of the target quantity.
    pub error: Offset,
    /// Standard deviation by the noise of the probe.
    pub noise: Offset,
}

/// What the parts are judged by.
#[derive(Clone, Debug)]
pub struct Monitor {
    /// Every part at its own places, in their order.
    pub parts: Vec<PartError>,
    /// The newest part.
    pub now: PartError,
    /// The one before, at the places of the newest.
    pub before: PartError,
    /// Places of the newest part.
    pub places: Vec<Place>,
    /// By how much the root mean square may be larger by noise alone, mm.
    margin_mm: f64,
    /// Which of the earlier parts came out best.
    pub better: usize,
}

/// Places nearer than this are the same place of two parts.
const SAME: Offset = Offset::from_um(200);

impl Monitor {
    /// Of the parts of a joint fit; the last one is judged.
    pub fn of(pass: &Pass, path: &Path, parts: &[PartPoints], joint: &Joint) -> Self {
        let path = path.with_law(joint.core.law);
        let table = force_table(&joint.core.fit.parameters);
        let wanted = pass.job.numbers.design(Law::Model);
        let wall = |(part, own): (&PartPoints, &Own)| {
            let parameters = joint.core.fit.parameters.with_force(real(own.level));
            walls(&parameters.machine(&path, &table), wanted.band, &part.nodes, &[]).0
        };
        let walls: Vec<Vec<Profile>> = parts.iter().zip(&joint.own).map(wall).collect();
        let target = |k: usize, s: Offset| aim(&path, &walls[k], wanted.target, s);
        let places: Vec<Vec<Place>> = (0..parts.len()).map(|k| places(&parts[k], joint, k, &target)).collect();
        let each = |k: usize| PartError::of(parts[k].number, places[k].iter().map(|p| p.error));
        let newest = parts.len() - 1;
        let previous = newest.saturating_sub(1);
        let before = places[newest].iter().map(|now| {
            let measured = places[previous].iter().filter(|p| (p.s - now.s).abs() <= SAME);
            measured.min_by_key(|p| (p.s - now.s).abs()).map_or_else(|| target(previous, now.s), |p| p.error)
        });
        let before = PartError::of(parts[previous].number, before);
        let own: Vec<PartError> = (0..parts.len()).map(each).collect();
        let better = (0..newest).min_by(|a, b| own[*a].rms_mm.total_cmp(&own[*b].rms_mm)).unwrap_or(0);
        let noise: f64 = places[newest].iter().map(|p| mm(p.noise).powi(2)).sum::<f64>();
        let n = places[newest].len().max(1) as f64;
        let margin_mm = 2.0 * (2.0 * noise / n).sqrt() / n.sqrt();
        let places = places.into_iter().next_back().unwrap_or_default();
        Self { now: own[newest], parts: own, before, places, margin_mm, better }
    }

    /// Whether the newest part is worse than the one before, beyond noise.
    pub fn is_worse(&self) -> bool {
        self.now.rms_mm > self.before.rms_mm + self.margin_mm
    }
}

impl PartError {
    fn of(part: u32, errors: impl Iterator<Item = Offset>) -> Self {
        let errors: Vec<f64> = errors.map(|e| mm(e.abs())).collect();
        let n = errors.len().max(1) as f64;
        Self {
            part,
            max_mm: errors.iter().copied().fold(0.0, f64::max),
            rms_mm: (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt(),
            places: errors.len(),
        }
    }
}

fn aim(path: &Path, walls: &[Profile], target: Target, s: Offset) -> Offset {
    let at = path.index_at(s).saturating_sub(path.first());
    walls.get(at.min(walls.len().saturating_sub(1))).map_or(Offset::ZERO, |wall| wall.aim(target, None))
}

fn places(part: &PartPoints, joint: &Joint, k: usize, target: &impl Fn(usize, Offset) -> Offset) -> Vec<Place> {
    let Some(observations) = joint.observations.get(k) else { return Vec::new() };
    let fitting = |weight: Real| float(weight) >= 0.3;
    let outlying = observations.iter().filter(|o| !fitting(o.weight)).count();
    // A few wild points are of something else; when many do not fit, that is what the part is like.
    let all = outlying * 4 > observations.len();
    let of_place = |range: std::ops::Range<usize>| {
        let used: Vec<_> = observations.get(range)?.iter().filter(|o| all || fitting(o.weight)).collect();
        let n = Real::from_int(i32::try_from(used.len()).ok()?.max(1));
        let sum = used.iter().fold(Offset::ZERO, |sum, o| sum + (o.error - o.predicted));
        let s = used.first()?.s;
        let error = target(k, s) + sum.scaled(Real::ONE / n);
        Some(Place { s, error, noise: part.noise.scaled(Real::ONE / n.sqrt()) })
    };
    part.places().into_iter().filter_map(of_place).collect()
}
