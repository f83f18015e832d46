//! Reference circles of a roundness profile (ISO 12181-1): least squares, minimum zone, maximum inscribed, minimum circumscribed.
//!
//! A circle moved by a small eccentricity is `t + a sin φ + b cos φ` to first order, as roundness instruments take it, so all four are
//! linear fits. The minimum zone is a Chebyshev approximation by {1, sin, cos}, found by exchange of four points; the inscribed
//! and circumscribed circles rest on three points, exchanged until no other is violated. Each exchange moves the objective strictly
//! towards the optimum, so none returns; the number is bounded all the same.

use std::f64::consts::TAU;

const EXCHANGES: usize = 500;

/// Which reference circle.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Reference {
    /// Least squares (LSCI).
    LeastSquares,
    /// Minimum zone (MZCI).
    MinimumZone,
    /// Maximum inscribed (MICI): the largest plug that fits.
    MaximumInscribed,
    /// Minimum circumscribed (MCCI).
    MinimumCircumscribed,
}

/// Residuals of deviations at equal angles against a reference circle, mm.
pub fn residuals(deviations: &[f64], reference: Reference) -> Vec<f64> {
    let circle = match reference {
        Reference::LeastSquares => least_squares(deviations),
        Reference::MinimumZone => minimum_zone(deviations),
        Reference::MaximumInscribed => inscribed(deviations, 1.0),
        Reference::MinimumCircumscribed => inscribed(deviations, -1.0),
    };
    left(deviations, circle)
}

/// Peak to valley, mm.
pub fn span(values: &[f64]) -> f64 {
    let (low, high) = values.iter().fold((f64::MAX, f64::MIN), |(l, h), v| (l.min(*v), h.max(*v)));
    if values.is_empty() { 0.0 } else { high - low }
}

fn basis(index: usize, count: usize) -> [f64; 3] {
    let (s, c) = (TAU * index as f64 / count as f64).sin_cos();
    [1.0, s, c]
}

fn dot(a: [f64; 3], b: [f64; 3]) -> f64 {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

fn left(deviations: &[f64], circle: [f64; 3]) -> Vec<f64> {
    let count = deviations.len();
    deviations.iter().enumerate().map(|(i, d)| d - dot(circle, basis(i, count))).collect()
}

fn least_squares(deviations: &[f64]) -> [f64; 3] {
    let count = deviations.len();
    let mut sums = [0.0; 3];
    for (i, d) in deviations.iter().enumerate() {
        for (sum, b) in sums.iter_mut().zip(basis(i, count)) {
            *sum += d * b;
        }
    }
    let n = count.max(1) as f64;
    [sums[0] / n, 2.0 * sums[1] / n, 2.0 * sums[2] / n]
}

fn determinant(a: [f64; 3], b: [f64; 3], c: [f64; 3]) -> f64 {
    a[0] * (b[1] * c[2] - b[2] * c[1]) - a[1] * (b[0] * c[2] - b[2] * c[0]) + a[2] * (b[0] * c[1] - b[1] * c[0])
}

/// The circle through three points, by Cramer's rule.
fn through(rows: [[f64; 3]; 3], values: [f64; 3]) -> [f64; 3] {
    let whole = determinant(rows[0], rows[1], rows[2]);
    std::array::from_fn(|column| {
        let mut replaced = rows;
        for (row, value) in replaced.iter_mut().zip(values) {
            row[column] = value;
        }
        determinant(replaced[0], replaced[1], replaced[2]) / whole
    })
}

/// Levelled circle of four points and its error: all four are off by the same amount, signs as the dependence of their rows.
fn levelled(points: [usize; 4], deviations: &[f64]) -> ([f64; 3], f64) {
    let count = deviations.len();
    let rows = points.map(|p| basis(p, count));
    let weights = [
        determinant(rows[1], rows[2], rows[3]),
        -determinant(rows[0], rows[2], rows[3]),
        determinant(rows[0], rows[1], rows[3]),
        -determinant(rows[0], rows[1], rows[2]),
    ];
    let total: f64 = weights.iter().map(|w| w.abs()).sum();
    let error = weights.iter().zip(points).map(|(w, p)| w * deviations[p]).sum::<f64>() / total;
    // The three rows without the point of the largest weight are the best conditioned.
    let drop = (0..4).max_by(|a, b| weights[*a].abs().total_cmp(&weights[*b].abs())).unwrap_or(0);
    let kept: [usize; 3] = std::array::from_fn(|i| if i < drop { i } else { i + 1 });
    let values = kept.map(|i| deviations[points[i]] - error * weights[i].signum());
    (through(kept.map(|i| rows[i]), values), error.abs())
}

fn minimum_zone(deviations: &[f64]) -> [f64; 3] {
    let count = deviations.len();
    if count < 4 {
        return least_squares(deviations);
    }
    let mut points = [0, count / 4, count / 2, 3 * count / 4];
    let (mut circle, mut error) = levelled(points, deviations);
    for _ in 0..EXCHANGES {
        let rest = left(deviations, circle);
        let worst = (0..count).max_by(|a, b| rest[*a].abs().total_cmp(&rest[*b].abs())).unwrap_or(0);
        if rest[worst].abs() <= error * (1.0 + 1e-12) + f64::EPSILON || points.contains(&worst) {
            break;
        }
        let exchanged = (0..4).map(|drop| {
            let mut tried = points;
            tried[drop] = worst;
            let (circle, error) = levelled(tried, deviations);
            (tried, circle, error)
        });
        let Some(best) = exchanged.filter(|e| e.2.is_finite()).max_by(|a, b| a.2.total_cmp(&b.2)) else { break };
        if best.2 <= error {
            break;
        }
        (points, circle, error) = best;
    }
    circle
}

/// The largest circle inside (`sign` 1) or the smallest outside (−1) of the deviations.
fn inscribed(deviations: &[f64], sign: f64) -> [f64; 3] {
    let count = deviations.len();
    if count < 3 {
        return least_squares(deviations);
    }
    let mut points = [0, count / 3, 2 * count / 3];
    let circle_of = |p: [usize; 3]| through(p.map(|i| basis(i, count)), p.map(|i| deviations[i]));
    let mut circle = circle_of(points);
    for _ in 0..EXCHANGES {
        let rest = left(deviations, circle);
        let worst = (0..count).min_by(|a, b| (sign * rest[*a]).total_cmp(&(sign * rest[*b]))).unwrap_or(0);
        if sign * rest[worst] >= -f64::EPSILON * circle[0].abs().max(1.0) || points.contains(&worst) {
            break;
        }
        // Of the triples that hold the centre between their directions, the one that leaves the least room.
        let mut best: Option<([usize; 3], [f64; 3])> = None;
        for drop in 0..3 {
            let mut tried = points;
            tried[drop] = worst;
            let rows = tried.map(|p| basis(p, count));
            let area = [
                rows[1][1] * rows[2][2] - rows[1][2] * rows[2][1],
                rows[2][1] * rows[0][2] - rows[2][2] * rows[0][1],
                rows[0][1] * rows[1][2] - rows[0][2] * rows[1][1],
            ];
            let around = area.iter().all(|a| *a >= -1e-15) || area.iter().all(|a| *a <= 1e-15);
            let held = circle_of(tried);
            if around && held[0].is_finite() && best.is_none_or(|(_, b)| sign * held[0] < sign * b[0]) {
                best = Some((tried, held));
            }
        }
        let Some(found) = best else { break };
        (points, circle) = found;
    }
    circle
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The best of a fine grid of centres, refined thrice: slow and independent.
    fn by_grid(deviations: &[f64], score: impl Fn(&[f64]) -> f64) -> f64 {
        let (mut centre, mut size, mut best) = ([0.0, 0.0], 2.0, f64::MAX);
        for _ in 0..12 {
            let from = centre;
            for i in -10..=10 {
                for j in -10..=10 {
                    let at = [from[0] + size * f64::from(i) / 10.0, from[1] + size * f64::from(j) / 10.0];
                    let value = score(&left(deviations, [0.0, at[0], at[1]]));
                    if value < best {
                        (best, centre) = (value, at);
                    }
                }
            }
            size *= 0.4;
        }
        best
    }

    #[test]
    fn circles_are_the_best_ones_of_all_centres() {
        let wave = |i: usize| {
            let x = TAU * i as f64 / 360.0;
            0.3 * (x + 0.4).sin() + 0.2 * (2.0 * x).cos() + 0.11 * (3.0 * x + 1.0).sin() + 0.05 * (7.0 * x).cos()
        };
        let deviations: Vec<f64> = (0..360).map(wave).collect();
        let low = |v: &[f64]| v.iter().copied().fold(f64::MAX, f64::min);
        let high = |v: &[f64]| v.iter().copied().fold(f64::MIN, f64::max);
        let zone = span(&residuals(&deviations, Reference::MinimumZone));
        assert!((zone - by_grid(&deviations, span)).abs() < 1e-4, "{zone}");
        let inside = inscribed(&deviations, 1.0)[0];
        assert!((inside + by_grid(&deviations, |v| -low(v))).abs() < 1e-4, "{inside}");
        let outside = inscribed(&deviations, -1.0)[0];
        assert!((outside - by_grid(&deviations, high)).abs() < 1e-4, "{outside}");
        assert!(low(&residuals(&deviations, Reference::MaximumInscribed)) > -1e-12);
        assert!(high(&residuals(&deviations, Reference::MinimumCircumscribed)) < 1e-12);
        let squares = span(&residuals(&deviations, Reference::LeastSquares));
        assert!(zone <= squares);
    }
}
