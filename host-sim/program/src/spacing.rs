//! What the samples of a path leave open between them.
//!
//! Between two samples of a smooth path the path bulges over their chord by an eighth of the second difference; at a
//! corner it does not, although the second difference is large there. So a chord is granted the smaller of the second
//! differences at its two ends (a corner has one, a bend both), and at least what the programmed curve itself bulges.

use super::vector::{length, minus};

/// How much the programmed curvature may grow through the correction.
const GROWTH: f64 = 1.5;

/// How far the path may leave the chord between each two samples, nanometres; `curvature` is that of the programmed
/// line or arc, 1/nm.
pub(super) fn bulges(path: &[[f64; 2]], curvature: f64) -> Vec<f64> {
    let second = |k: usize| match (k.checked_sub(1).and_then(|i| path.get(i)), path.get(k), path.get(k + 1)) {
        (Some(&a), Some(&b), Some(&c)) => length(minus(minus(c, b), minus(b, a))),
        _ => 0.0,
    };
    let chord = |k: usize| length(minus(path[k + 1], path[k]));
    (0..path.len().saturating_sub(1))
        .map(|k| (GROWTH * curvature * chord(k) * chord(k)).max(second(k).min(second(k + 1))) / 8.0)
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_bend_may_bulge_by_an_eighth_of_its_second_difference_and_a_corner_may_not() {
        let circle: Vec<_> = (0..20).map(|i| f64::from(i) * 0.1).map(|a| [1e6 * a.cos(), 1e6 * a.sin()]).collect();
        let sagitta = 1e6 * (1.0 - 0.05f64.cos());
        for (k, bulge) in bulges(&circle, 0.0).iter().enumerate().filter(|(k, _)| (1..18).contains(k)) {
            assert!((bulge / sagitta - 1.0).abs() < 0.01, "{bulge} at {k}");
        }
        let corner = [[0.0, 0.0], [1e5, 0.0], [2e5, 0.0], [2e5, 1e5], [2e5, 2e5]];
        assert_eq!(bulges(&corner, 0.0), [0.0; 4]);
        assert_eq!(bulges(&corner, 1e-6)[2], 1.5e-6 * 1e10 / 8.0);
    }
}
