//! The coarse look of the envelope, half a radius to both sides of a wall point, and what the path alone says about it.

use super::sample::Sample;
use super::setup::CutSetup;
use truepath_units::Offset;

/// Places of the coarse look to either side.
pub(super) const EIGHTHS: usize = 8;

/// What is known of the coarse looks along a path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct CoarseLook {
    /// Half a radius in samples of the longest step.
    pub(super) far: usize,
    /// By how much the square of the distance of a wall point from the nominal centre at another place of its look is more than that of
    /// a centre which certainly makes no wall there, for every sample that they are apart, at least, nm²; beside sharp corners it may be
    /// less.
    pub(super) clearance: i64,
}

impl CoarseLook {
    /// Of a path's samples, which are at most `step` apart.
    pub(super) fn of(samples: &[Sample], setup: &CutSetup, step: Offset) -> Self {
        let radius = setup.radius;
        let far = (radius.nm() / 2).checked_div(step.nm()).unwrap_or(0).unsigned_abs() as usize;
        // Squares of the distances add up in 62 bits.
        if radius.nm() >> 30 != 0 {
            return Self { far, clearance: 0 };
        }
        let of_pair = |sample: &Sample, other: Option<&Sample>, stride: usize| {
            let Some(other) = other else { return i64::MAX };
            let spoke = (sample.point + sample.normal.times(radius)).from(other.point);
            let square = i64::try_from(spoke.length_squared()).unwrap_or(i64::MAX);
            let is_ahead = spoke.along(sample.normal).nm() >= radius.nm() / 2;
            if is_ahead { square.saturating_sub(clear(radius)).checked_div(stride as i64).unwrap_or(0) } else { 0 }
        };
        let mut clearance = i64::MAX;
        for (index, sample) in samples.iter().enumerate().filter(|(_, sample)| sample.is_plain()) {
            let strides = (1..=EIGHTHS).map(|eighth| far.saturating_mul(eighth) / EIGHTHS);
            for stride in strides.filter(|stride| *stride > 0) {
                let [ahead, back] = [Some(index.saturating_add(stride)), index.checked_sub(stride)];
                let others = [ahead, back].map(|at| of_pair(sample, at.and_then(|at| samples.get(at)), stride));
                clearance = others.into_iter().fold(clearance, i64::min);
            }
        }
        // Of a path without other places nothing is asked.
        Self { far, clearance: clearance.min(1 << 50) }
    }
}

/// Square of a distance of a centre from a place that is certainly more than the radius, nm²: rounding of the components and of the
/// place, and a normal that is not quite one long.
pub(super) fn clear(radius: Offset) -> i64 {
    let beyond = radius.nm().saturating_add(radius.nm() >> 20).saturating_add(4);
    beyond.saturating_mul(beyond)
}
