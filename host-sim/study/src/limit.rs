//! What could be reached: a part cut with exact knowledge of the one before.
//!
//! Wear, another blank and a datum taken anew make every part another one than the last. A correction that knew the last part's wall
//! to the micrometre everywhere would still leave that difference; what a method leaves is to be read beside it. The commanded path
//! of such a correction is found on the plant itself, at the mean over the height, by shifting it against the error until that is
//! gone.

use truepath_ground::diagnostics::Failure;
use truepath_plant::{Milled, Point};
use truepath_trial::virtual_mill;

use super::case::Case;
use super::outcome::Outcome;

/// Parts cut at most to find a path.
const ROUNDS: usize = 12;

/// A wall within this of its nominal place is as good as exact, mm.
const EXACT_MM: f64 = 0.0005;

/// Largest error of part `number` + 1, mean over the height, cut with exact knowledge of part `number`, mm.
///
/// # Errors
/// What the plant refuses.
pub fn next_part_mm(case: &Case, number: u64) -> Result<f64, Failure> {
    let machine = case.machine_of(number);
    let mut milled = virtual_mill::mill(&case.pass, &machine, None)?;
    let mut shift_mm = vec![0.0; milled.path.len()];
    let mut best = (milled.judge().score.max_error_mm, shift_mm.clone());
    for _ in 0..ROUNDS {
        if best.0 <= EXACT_MM {
            break;
        }
        against(&milled, &mut shift_mm);
        milled = virtual_mill::mill(&case.pass, &machine, Some(&shifted(&milled, &shift_mm)))?;
        let left_mm = milled.judge().score.max_error_mm;
        if left_mm < best.0 {
            best = (left_mm, shift_mm.clone());
        }
    }
    let path = shifted(&milled, &best.1);
    let next = virtual_mill::mill(&case.pass, &case.machine_of(number + 1), Some(&path))?;
    Ok(next.judge().score.max_error_mm)
}

/// Adds the limits of the first correction and of learning to `outcome`.
///
/// # Errors
/// What the plant refuses.
pub fn add(case: &Case, learned: bool, outcome: &mut Outcome) -> Result<(), Failure> {
    let factor = |left_mm: f64| Some(case.before.score.max_error_mm / left_mm.max(1e-6));
    let limit_mm = next_part_mm(case, 1)?;
    (outcome.limit_mm, outcome.limit_factor) = (Some(limit_mm), factor(limit_mm));
    if learned {
        let limit_mm = next_part_mm(case, 2)?;
        (outcome.learned_limit_mm, outcome.learned_limit_factor) = (Some(limit_mm), factor(limit_mm));
    }
    Ok(())
}

/// Moves every place of the path towards the wall by the material left there; where no wall is defined, by that of the last place
/// which has one.
fn against(milled: &Milled, shift_mm: &mut [f64]) {
    let errors = milled.mean_errors();
    let mut last = errors.iter().copied().find(|e| e.is_finite()).unwrap_or(0.0);
    for (shift, error) in shift_mm.iter_mut().zip(errors) {
        last = if error.is_finite() { error } else { last };
        *shift += last;
    }
}

/// The nominal path of a part, shifted along its normals.
fn shifted(milled: &Milled, shift_mm: &[f64]) -> Vec<Point> {
    let places = milled.path.centre.iter().zip(&milled.path.normal).zip(shift_mm);
    places.map(|((centre, normal), by)| [centre[0] + by * normal[0], centre[1] + by * normal[1]]).collect()
}
