//! The normal equations of a fit in normalised parameters: LDLᵀ in fixed point.
//!
//! Parameters are counted in their prior standard deviations, so the prior is the unit matrix and the information
//! never falls below it. A parameter that changes its sign when the part is turned or mirrored gives bits that change
//! their sign; the last two parameters are the components of a vector and exchange places under a quarter turn, so
//! they are solved together by the 2 × 2 inverse, whose bits exchange places too.
#![expect(clippy::indexing_slicing, reason = "every index is a loop bound below the constant dimension")]
#![expect(clippy::arithmetic_side_effects, reason = "index arithmetic below the constant dimension")]

use super::parameters::COUNT;
use truepath_units::{Real, log2};

/// A square matrix of the fit.
pub type Matrix = [[Real; COUNT]; COUNT];

/// Least information about a parameter: a sixteenth of that of a Gaussian prior.
const LEAST: Real = Real::ratio(1, 16);

/// Scalars eliminated one by one; the remaining two form the vector.
pub(super) const SCALARS: usize = COUNT - 2;

/// Accumulated information (JᵀWJ + 1) and gradient.
#[derive(Clone, Copy, Debug)]
pub struct Information {
    pub(super) matrix: Matrix,
    pub(super) gradient: [Real; COUNT],
}

impl Information {
    /// The prior alone, at `theta` standard deviations from its centre, to which it draws by the weights.
    pub fn prior(theta: &[Real; COUNT], weights: &[Real; COUNT]) -> Self {
        let mut matrix = [[Real::ZERO; COUNT]; COUNT];
        let mut gradient = [Real::ZERO; COUNT];
        for i in 0..COUNT {
            matrix[i][i] = weights[i];
            gradient[i] = -(weights[i] * theta[i]);
        }
        Self { matrix, gradient }
    }

    /// Adds an observation: its sensitivities and its residual (measured − predicted), both in its standard
    /// deviations, with a weight 0…1.
    pub fn add(&mut self, sensitivity: &[Real; COUNT], residual: Real, weight: Real) {
        for (i, row) in self.matrix.iter_mut().enumerate() {
            self.gradient[i] += weight * (sensitivity[i] * residual);
            for (entry, other) in row.iter_mut().zip(sensitivity) {
                // The product of the two first: its rounding does not depend on their order.
                *entry += weight * (sensitivity[i] * *other);
            }
        }
    }

    /// The step that solves the normal equations.
    pub fn step(&self) -> [Real; COUNT] {
        Factor::new(&self.matrix).solve(&self.gradient)
    }

    /// The covariance in units of the prior standard deviations.
    pub fn covariance(&self) -> Matrix {
        let factor = Factor::new(&self.matrix);
        let mut out = [[Real::ZERO; COUNT]; COUNT];
        for (k, row) in out.iter_mut().enumerate() {
            let mut unit = [Real::ZERO; COUNT];
            unit[k] = Real::ONE;
            *row = factor.solve(&unit);
        }
        out
    }

    /// Binary logarithm of the determinant, for the evidence.
    pub fn log2_determinant(&self) -> Real {
        let f = Factor::new(&self.matrix);
        let mut sum = log2(f.determinant);
        for k in 0..SCALARS {
            sum += log2(f.diagonal[k]);
        }
        sum
    }
}

/// Columns of a square root of a covariance: their outer products add up to it. Used for the spread of what follows
/// from the parameters; a column whose variance has vanished is zero.
pub fn square_root(covariance: &Matrix) -> Matrix {
    let mut rest = *covariance;
    let mut columns = [[Real::ZERO; COUNT]; COUNT];
    for (k, column) in columns.iter_mut().enumerate() {
        let pivot = rest[k][k].sqrt();
        if pivot < Real::ratio(1, 100_000) {
            continue;
        }
        for i in k..COUNT {
            column[i] = rest[i][k] / pivot;
        }
        for i in k..COUNT {
            for j in k..COUNT {
                rest[i][j] -= column[i] * column[j];
            }
        }
    }
    columns
}

/// LDLᵀ with a 2 × 2 block at the end.
struct Factor {
    lower: Matrix,
    diagonal: [Real; COUNT],
    corner: Real,
    determinant: Real,
}

impl Factor {
    fn new(matrix: &Matrix) -> Self {
        let mut rest = *matrix;
        let mut lower = [[Real::ZERO; COUNT]; COUNT];
        let mut diagonal = [Real::ONE; COUNT];
        for k in 0..SCALARS {
            // Information is at least that of the prior; rounding may not take it to nothing.
            let d = rest[k][k].max(LEAST);
            diagonal[k] = d;
            for i in k + 1..COUNT {
                lower[i][k] = rest[i][k] / d;
            }
            for i in k + 1..COUNT {
                for j in k + 1..COUNT {
                    // Symmetric in i and j to the last bit.
                    let product = (lower[i][k] * rest[j][k] + lower[j][k] * rest[i][k]) * Real::HALF;
                    rest[i][j] -= product;
                }
            }
            // Column k is finished; its own row is not read again.
        }
        let (a, b) = (SCALARS, SCALARS + 1);
        diagonal[a] = rest[a][a].max(LEAST);
        diagonal[b] = rest[b][b].max(LEAST);
        let corner = rest[a][b];
        let determinant = Real::dot(diagonal[a], diagonal[b], -corner, corner).max(LEAST);
        Self { lower, diagonal, corner, determinant }
    }

    fn solve(&self, right: &[Real; COUNT]) -> [Real; COUNT] {
        let mut y = *right;
        for k in 0..SCALARS {
            for i in k + 1..COUNT {
                y[i] -= self.lower[i][k] * y[k];
            }
        }
        let (a, b) = (SCALARS, SCALARS + 1);
        let xa = Real::dot(self.diagonal[b], y[a], -self.corner, y[b]) / self.determinant;
        let xb = Real::dot(self.diagonal[a], y[b], -self.corner, y[a]) / self.determinant;
        (y[a], y[b]) = (xa, xb);
        for k in (0..SCALARS).rev() {
            y[k] = y[k] / self.diagonal[k];
            // The two components of the vector are added in one rounding, whatever their order.
            let vector = Real::dot(self.lower[a][k], y[a], self.lower[b][k], y[b]);
            for i in k + 1..SCALARS {
                y[k] -= self.lower[i][k] * y[i];
            }
            y[k] -= vector;
        }
        y
    }
}

#[cfg(test)]
mod tests;
