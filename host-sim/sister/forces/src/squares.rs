//! Least squares for a few unknowns: Levenberg and Marquardt, with the covariance at the minimum.

/// What was found.
#[derive(Clone, Debug)]
pub struct Estimate {
    /// The unknowns.
    pub theta: Vec<f64>,
    /// Their covariance for residuals of unit variance.
    pub covariance: Vec<Vec<f64>>,
    /// Sum of squared residuals.
    pub chi2: f64,
}

/// Most steps.
const STEPS: usize = 40;
/// The sum of squares counts as settled below this change, relative.
const SETTLED: f64 = 1e-9;

/// Minimises the sum of squares of `residuals` from `start`, every unknown within its range; `scale` is a typical size of
/// each. `None` where the residuals do not tell the unknowns apart.
pub fn least_squares(
    start: &[f64],
    scale: &[f64],
    range: &[[f64; 2]],
    residuals: &dyn Fn(&[f64]) -> Vec<f64>,
) -> Option<Estimate> {
    let mut theta = start.to_vec();
    let mut now = residuals(&theta);
    let mut chi2 = square(&now);
    let mut damping = 1e-6;
    for _ in 0..STEPS {
        let (normal, gradient) = normal_equations(&theta, &now, scale, range, residuals);
        let mut better = None;
        while damping < 1e9 {
            let mut damped = normal.clone();
            for (k, row) in damped.iter_mut().enumerate() {
                row[k] += damping * row[k].max(1e-12);
            }
            if let Some(step) = inverse(&damped).map(|inverse| times(&inverse, &gradient)) {
                let to = |k: usize| (theta[k] - step[k] * scale[k]).clamp(range[k][0], range[k][1]);
                let moved: Vec<f64> = (0..theta.len()).map(to).collect();
                let then = residuals(&moved);
                let sum = square(&then);
                if sum.is_finite() && sum <= chi2 {
                    better = Some((moved, then, sum));
                    break;
                }
            }
            damping *= 10.0;
        }
        let Some((moved, then, sum)) = better else { break };
        let settled = chi2 - sum <= SETTLED * chi2;
        (theta, now, chi2) = (moved, then, sum);
        damping = (damping * 0.1).max(1e-12);
        if settled {
            break;
        }
    }
    let (normal, _) = normal_equations(&theta, &now, scale, range, residuals);
    let mut covariance = inverse(&normal)?;
    for (i, row) in covariance.iter_mut().enumerate() {
        for (j, value) in row.iter_mut().enumerate() {
            *value *= scale[i] * scale[j];
        }
    }
    Some(Estimate { theta, covariance, chi2 })
}

fn square(residuals: &[f64]) -> f64 {
    residuals.iter().map(|r| r * r).sum()
}

/// JᵀJ and Jᵀr in units of `scale`, by difference quotients.
fn normal_equations(
    theta: &[f64],
    now: &[f64],
    scale: &[f64],
    range: &[[f64; 2]],
    residuals: &dyn Fn(&[f64]) -> Vec<f64>,
) -> (Vec<Vec<f64>>, Vec<f64>) {
    let columns: Vec<Vec<f64>> = (0..theta.len())
        .map(|k| {
            // Away from the nearer end of the range.
            let step = 1e-5 * scale[k] * if theta[k] + 1e-5 * scale[k] > range[k][1] { -1.0 } else { 1.0 };
            let mut moved = theta.to_vec();
            moved[k] += step;
            let then = residuals(&moved);
            now.iter().zip(then).map(|(a, b)| (b - a) / step * scale[k]).collect()
        })
        .collect();
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(x, y)| x * y).sum::<f64>();
    let normal = columns.iter().map(|a| columns.iter().map(|b| dot(a, b)).collect()).collect();
    (normal, columns.iter().map(|a| dot(a, now)).collect())
}

fn times(matrix: &[Vec<f64>], vector: &[f64]) -> Vec<f64> {
    matrix.iter().map(|row| row.iter().zip(vector).map(|(a, b)| a * b).sum()).collect()
}

/// The inverse of a symmetric positive matrix (Gauss and Jordan on unit diagonal); `None` where it is singular to 10⁻¹².
pub fn inverse(matrix: &[Vec<f64>]) -> Option<Vec<Vec<f64>>> {
    let n = matrix.len();
    let root: Vec<f64> = (0..n).map(|k| matrix[k][k].sqrt()).collect();
    if root.iter().any(|r| !r.is_finite() || *r <= 0.0) {
        return None;
    }
    let mut work: Vec<Vec<f64>> = (0..n)
        .map(|i| {
            let unit = (0..n).map(|j| if i == j { 1.0 } else { 0.0 });
            (0..n).map(|j| matrix[i][j] / (root[i] * root[j])).chain(unit).collect()
        })
        .collect();
    for k in 0..n {
        let pivot = (k..n).max_by(|a, b| work[*a][k].abs().total_cmp(&work[*b][k].abs()))?;
        if work[pivot][k].abs() < 1e-12 {
            return None;
        }
        work.swap(k, pivot);
        let by = work[k][k];
        work[k].iter_mut().for_each(|v| *v /= by);
        let row = work[k].clone();
        for (i, other) in work.iter_mut().enumerate() {
            if i != k && other[k] != 0.0 {
                let factor = other[k];
                other.iter_mut().zip(&row).for_each(|(v, r)| *v -= factor * r);
            }
        }
    }
    Some((0..n).map(|i| (0..n).map(|j| work[i][n + j] / (root[i] * root[j])).collect()).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn an_exponential_is_found_with_its_covariance() {
        let at: Vec<f64> = (0..20).map(|k| f64::from(k) * 0.1).collect();
        let residuals =
            |p: &[f64]| at.iter().map(|x| (p[0] * (-p[1] * x).exp() - 3.0 * (-0.7 * x).exp()) / 0.01).collect();
        let found =
            least_squares(&[1.0, 0.1], &[1.0, 1.0], &[[0.0, 10.0], [0.0, 10.0]], &residuals).expect("a minimum");
        assert!((found.theta[0] - 3.0).abs() < 1e-6 && (found.theta[1] - 0.7).abs() < 1e-6, "{found:?}");
        // JᵀJ by hand.
        let j: Vec<[f64; 2]> = at.iter().map(|x| [(-0.7 * x).exp(), -3.0 * x * (-0.7 * x).exp()]).collect();
        let dot = |a: usize, b: usize| j.iter().map(|r| r[a] * r[b]).sum::<f64>() / 1e-4;
        let var0 = dot(1, 1) / (dot(0, 0) * dot(1, 1) - dot(0, 1).powi(2));
        assert!((found.covariance[0][0] / var0 - 1.0).abs() < 1e-3);
    }

    #[test]
    fn what_cannot_be_told_apart_is_no_estimate() {
        let residuals = |p: &[f64]| vec![p[0] + p[1] - 1.0, 2.0 * (p[0] + p[1]) - 2.0];
        assert!(least_squares(&[0.0, 0.0], &[1.0, 1.0], &[[-9.0, 9.0]; 2], &residuals).is_none());
    }
}
