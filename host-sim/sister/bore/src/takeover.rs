//! Where a pass begins to cut farther out than another, when their edges differ (runout).
//!
//! The difference `d = F_i − F_j` of two curves has a second derivative within `±M` ([`Arc::curvature_bound`]), so from a place
//! where `d > 0` it stays above the parabola `d + d′s − Ms²/2`: stepping to the parabola's zero never jumps over a change of
//! lead, and near one it converges as Newton's method does. Steps are at least a ten-thousandth of the search range. Within such
//! a step a change there and back could be missed that is at most `M·s²/8` high, about 10⁻⁸ of the waviness.

use super::arc::Arc;
use super::refusal::Refusal;

/// Smallest step, share of the range.
const LEAST_STEP: f64 = 1e-4;

/// How many steps are left.
#[derive(Clone, Copy, Debug)]
pub struct Steps {
    left: u64,
    most: u64,
}

impl Steps {
    /// So many.
    pub const fn new(most: u64) -> Self {
        Self { left: most, most }
    }
    /// Uses one.
    ///
    /// # Errors
    /// [`Refusal::Comparisons`] when none is left.
    pub fn take(&mut self) -> Result<(), Refusal> {
        self.left = self.left.checked_sub(1).ok_or(Refusal::Comparisons { limit: self.most })?;
        Ok(())
    }
}

/// The first place in `[from, to]` where the curve of `other` rises above that of `leader`, which leads at `from` or
/// equals it. Each curve comes with the place of its crest.
///
/// # Errors
/// [`Refusal::Comparisons`] when the steps are used up.
pub fn takeover(
    leader: (&Arc, f64),
    other: (&Arc, f64),
    (from, to): (f64, f64),
    steps: &mut Steps,
) -> Result<Option<f64>, Refusal> {
    steps.take()?;
    if from > to {
        return Ok(None);
    }
    let value = |place: f64| {
        let (a, b) = (leader.0.wall(place - leader.1), other.0.wall(place - other.1));
        (a.0 - b.0, a.1 - b.1)
    };
    // Neither rises away from its crest: the best of one against the worst of the other.
    let worst = (from - leader.1).abs().max((to - leader.1).abs());
    if leader.0.wall(worst).0 > other.0.wall(other.1.clamp(from, to) - other.1).0 {
        return Ok(None);
    }
    let farthest = (from - other.1).abs().max((to - other.1).abs());
    let bound = leader.0.curvature_bound(worst) + other.0.curvature_bound(farthest);
    let least = LEAST_STEP * (to - from).max(f64::EPSILON);
    // Heights equal to rounding.
    let level = 4.0 * f64::EPSILON * (leader.0.path + leader.0.edge);
    let mut place = from;
    // The least step ends the search in 10⁴ steps.
    for _ in 0..=(1.0 / LEAST_STEP) as usize + 1 {
        steps.take()?;
        let (height, slope) = value(place);
        if height <= level && slope < 0.0 {
            return Ok(Some(place));
        }
        if height < -level {
            // Behind already: the change lies within the step just made.
            return Ok(Some(place));
        }
        if place >= to {
            return Ok(None);
        }
        let height = height.max(0.0);
        let root = (slope * slope + 2.0 * bound * height).sqrt();
        let step = if slope < 0.0 { 2.0 * height / (root - slope) } else { (slope + root) / bound };
        // Close to a change the steps get short because it is near: let them, down to rounding.
        let near = slope < 0.0 && height < -slope * least;
        let step = if near { step.max(4.0 * f64::EPSILON * place.abs()) } else { step.max(least) };
        place = if step.is_finite() { (place + step).min(to) } else { (place + least).min(to) };
    }
    Ok(None)
}
