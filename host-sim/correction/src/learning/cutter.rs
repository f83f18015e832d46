//! What a new cutter is expected to need: the level of force of parts over the life of their cutters.
//!
//! The level l of a part (natural logarithm, over that of the newest) whose cutter had cut k parts before is taken as l = a + b·k + e: b is the
//! wear of a part, alike for all cutters, e what parts differ in. Of the slope no more is known before than that a cutter
//! needs some 20 % more force when it is replaced. A new cutter begins at a; it differs from others like it by what grinding leaves.
//! Bayes' rule for a line with a prior of its slope (Bishop, Pattern Recognition and Machine Learning, section 3.3).

use truepath_ground::hypotenuse::hypot;

use super::joint::PartPoints;
use crate::discrepancy::Own;

/// What parts of one age differ in.
const SCATTER: f64 = 0.02;
/// What cutters that begin differ in.
const CUTTERS: f64 = 0.03;
/// What a cutter needs more at the end of its life.
const WORN: f64 = 0.2;
/// Parts that a cutter cuts at least.
const FEWEST: f64 = 10.0;

/// Level of force of a part over that of another, natural logarithm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Level {
    /// Expected.
    pub mean: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// The level of a part that is cut with a new cutter over that of the newest of some parts, given what every part has of its own and how
/// many parts the first cutter had cut before.
pub(super) fn new_cutter(parts: &[PartPoints], own: &[Own], cut_before: u32) -> Level {
    let ages = parts.iter().map(|part| f64::from(part.age(cut_before)));
    let newest = parts.len().saturating_sub(1);
    let levels = own.iter().enumerate().map(|(k, own)| if k == newest { 0.0 } else { own.level });
    beginning(&ages.zip(levels).collect::<Vec<_>>())
}

/// The level at age 0, of ages and levels.
fn beginning(parts: &[(f64, f64)]) -> Level {
    let sum = |of: fn(&(f64, f64)) -> f64| parts.iter().map(of).sum::<f64>();
    let count = parts.len().max(1) as f64;
    let longest = parts.iter().map(|(age, _)| *age).fold(FEWEST, f64::max);
    let (ages, levels) = (sum(|p| p.0), sum(|p| p.1));
    let squares = sum(|p| p.0 * p.0) + (SCATTER * longest / WORN).powi(2);
    // Above 0: the mean of squares is not below the square of the mean, and the prior comes on top.
    let determinant = count * squares - ages * ages;
    let mean = (squares * levels - ages * sum(|p| p.0 * p.1)) / determinant;
    let known = SCATTER * (squares / determinant).sqrt();
    Level { mean, sigma: hypot(known, hypot(SCATTER, CUTTERS)) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_new_cutter_begins_where_the_wear_of_the_parts_began() {
        // 4 % more from part to part.
        let steady: Vec<(f64, f64)> = (0..6).map(|k| (f64::from(k), 0.04 * f64::from(k) - 0.2)).collect();
        let Level { mean, sigma } = beginning(&steady);
        assert!((mean + 0.2).abs() < 0.02 && sigma < 0.05, "{mean} {sigma}");
        // Two cutters: the second began as the first.
        let two = [(0.0, -0.12), (1.0, -0.08), (2.0, -0.04), (0.0, -0.12), (3.0, 0.0)];
        assert!((beginning(&two).mean + 0.12).abs() < 0.01);
    }

    #[test]
    fn what_is_not_seen_is_not_foretold() {
        // One part, of a new cutter: the next new one is like it.
        let one = beginning(&[(0.0, 0.0)]);
        assert!(one.mean.abs() < 1e-12 && one.sigma > CUTTERS);
        // Of a cutter that had cut 40 parts: what those did to it is open.
        let late = beginning(&[(40.0, 0.0), (41.0, 0.0)]);
        assert!(late.mean.abs() < 0.01 && (0.15..0.25).contains(&late.sigma), "{late:?}");
        let early = beginning(&[(0.0, 0.0), (1.0, 0.0)]);
        assert!(early.sigma < 0.05, "{early:?}");
    }
}
