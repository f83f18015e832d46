//! How probable the points are under a kernel, the parameters of the machine integrated out.

use truepath_ground::cholesky::Cholesky;

use super::kernel::Kernel;
use super::points::{Points, Row, SHARED};

/// The covariance of the points under a kernel, factored.
#[derive(Clone, Debug)]
pub(super) struct Factored {
    pub(super) kernel: Kernel,
    factor: Cholesky,
    /// Covariance⁻¹ times what the points have unexplained.
    pub(super) weights: Vec<f64>,
    /// Natural logarithm of the evidence, up to a constant.
    pub(super) evidence: f64,
}

/// What is the same under every kernel.
#[derive(Clone, Debug)]
pub(super) struct Task<'p> {
    points: &'p Points,
    /// The rows that are used.
    used: &'p [usize],
    /// Covariance by the parameters.
    parametric: Vec<Vec<f64>>,
}

impl<'p> Task<'p> {
    /// With the rows that are used.
    pub(super) fn of(points: &'p Points, used: &'p [usize]) -> Self {
        let rows = || used.iter().map(|k| &points.rows[*k]);
        let parametric = rows().map(|a| rows().map(|b| parametric(points, a, b)).collect()).collect();
        Self { points, used, parametric }
    }

    /// The rows that are used.
    pub(super) fn rows(&self) -> impl ExactSizeIterator<Item = &'p Row> + Clone {
        let points = self.points;
        self.used.iter().map(move |k| &points.rows[*k])
    }

    /// The points under a kernel; `None` where their covariance is none.
    pub(super) fn factored(&self, kernel: &Kernel) -> Option<Factored> {
        let covariance: Vec<Vec<f64>> = self
            .rows()
            .enumerate()
            .map(|(i, a)| {
                let entry = |(j, b): (usize, &Row)| {
                    let own = if i == j { variance(kernel, a) } else { 0.0 };
                    self.parametric[i][j] + discrepancy(self.points, kernel, a, b) + own
                };
                self.rows().take(i + 1).enumerate().map(entry).collect()
            })
            .collect();
        let factor = Cholesky::new(&covariance)?;
        let unexplained: Vec<f64> = self.rows().map(|row| row.unexplained).collect();
        let weights = factor.solve(&unexplained);
        let explained: f64 = unexplained.iter().zip(&weights).map(|(y, w)| y * w).sum();
        let evidence = -0.5 * (explained + factor.ln_determinant());
        Some(Factored { kernel: *kernel, factor, weights, evidence })
    }
}

impl Factored {
    /// Σ over the used rows of a covariance times their weights: the mean of what has that covariance with them.
    pub(super) fn mean(&self, covariance: &[f64]) -> f64 {
        covariance.iter().zip(&self.weights).map(|(c, w)| c * w).sum()
    }

    /// By how much the rows lower the variance of what has that covariance with them.
    pub(super) fn known(&self, covariance: &[f64]) -> f64 {
        self.factor.halfway(covariance).iter().map(|v| v * v).sum()
    }

    /// L⁻¹ times a covariance with the rows, LLᵀ theirs: the product of two of these is what the rows know of both.
    pub(super) fn halfway(&self, covariance: &[f64]) -> Vec<f64> {
        self.factor.halfway(covariance)
    }

    /// Every row as the others predict it: (residual, variance).
    pub(super) fn left_out(&self) -> Vec<(f64, f64)> {
        let n = self.weights.len();
        let each = |k: usize| {
            let mut unit = vec![0.0; n];
            unit[k] = 1.0;
            let precision: f64 = self.factor.halfway(&unit).iter().map(|v| v * v).sum();
            (self.weights[k] / precision, 1.0 / precision)
        };
        (0..n).map(each).collect()
    }
}

/// Variance of a row of its own, mm².
pub(super) fn variance(kernel: &Kernel, row: &Row) -> f64 {
    (row.noise * kernel.noise.powi(2) + kernel.height.powi(2)) / row.count
}

/// Covariance of two rows by the discrepancy, mm².
pub(super) fn discrepancy(points: &Points, kernel: &Kernel, a: &Row, b: &Row) -> f64 {
    let with = |place| a.lasting(kernel, &points.extents, place);
    let here = with(&b.feature);
    let lasting = b.across.as_ref().map_or(here, |across| 0.5 * (here + with(across)));
    lasting + kernel.between_parts(&a.feature, &b.feature, [a.parts_ago, b.parts_ago])
}

/// Covariance of two rows by the parameters, mm².
fn parametric(points: &Points, a: &Row, b: &Row) -> f64 {
    let shared = (0..SHARED).map(|k| a.sensitivity[k] * b.sensitivity[k] / points.precision[k]).sum::<f64>();
    if a.parts_ago != b.parts_ago {
        return shared;
    }
    let datum = |k: usize| a.sensitivity[k] * b.sensitivity[k];
    shared + (datum(SHARED) + datum(SHARED + 1))
}
