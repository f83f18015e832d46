//! Symmetric positive definite systems of up to some hundred unknowns, in float.
//!
//! Sums run in one stated order, so the same numbers give the same bits on every machine.

/// L of A = L·Lᵀ, row by row.
#[derive(Clone, Debug)]
pub struct Cholesky(Vec<Vec<f64>>);

impl Cholesky {
    /// Of a matrix of which the lower half is read; `None` when it is not positive definite.
    pub fn new(matrix: &[Vec<f64>]) -> Option<Self> {
        let mut lower: Vec<Vec<f64>> = Vec::with_capacity(matrix.len());
        for (i, row) in matrix.iter().enumerate() {
            let mut own: Vec<f64> = Vec::with_capacity(i + 1);
            for (j, entry) in row.iter().take(i + 1).enumerate() {
                let before = if j < i { &lower[j] } else { &own };
                let rest = entry - own.iter().zip(before).take(j).map(|(a, b)| a * b).sum::<f64>();
                if j < i {
                    own.push(rest / lower[j][j]);
                } else if rest > 0.0 && rest.is_finite() {
                    own.push(rest.sqrt());
                } else {
                    return None;
                }
            }
            lower.push(own);
        }
        Some(Self(lower))
    }

    /// L⁻¹·b.
    pub fn halfway(&self, right: &[f64]) -> Vec<f64> {
        let mut y: Vec<f64> = Vec::with_capacity(right.len());
        for (row, b) in self.0.iter().zip(right) {
            let known: f64 = row.iter().zip(&y).map(|(l, v)| l * v).sum();
            y.push((b - known) / row[y.len()]);
        }
        y
    }

    /// A⁻¹·b.
    pub fn solve(&self, right: &[f64]) -> Vec<f64> {
        let mut x = self.halfway(right);
        for i in (0..x.len()).rev() {
            let known: f64 = (i + 1..x.len()).map(|k| self.0[k][i] * x[k]).sum();
            x[i] = (x[i] - known) / self.0[i][i];
        }
        x
    }

    /// The diagonal of A⁻¹.
    pub fn inverse_diagonal(&self) -> Vec<f64> {
        let n = self.0.len();
        let each = |k: usize| {
            let mut unit = vec![0.0; n];
            unit[k] = 1.0;
            self.halfway(&unit).iter().map(|v| v * v).sum()
        };
        (0..n).map(each).collect()
    }

    /// Natural logarithm of the determinant of A.
    pub fn ln_determinant(&self) -> f64 {
        2.0 * self.0.iter().filter_map(|row| row.last()).map(|d| d.ln()).sum::<f64>()
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn the_solution_solves_the_system(seed in prop::collection::vec(-1.0f64..1.0, 36), right in prop::collection::vec(-1.0f64..1.0, 6)) {
            let a: Vec<Vec<f64>> = (0..6)
                .map(|i| (0..6).map(|j| {
                    let square: f64 = (0..6).map(|k| seed[6 * i + k] * seed[6 * j + k]).sum();
                    square + f64::from(u8::from(i == j))
                }).collect())
                .collect();
            let x = Cholesky::new(&a).unwrap().solve(&right);
            for (row, b) in a.iter().zip(&right) {
                let product: f64 = row.iter().zip(&x).map(|(a, x)| a * x).sum();
                prop_assert!((product - b).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn the_determinant_of_a_diagonal_is_its_product_and_indefinite_matrices_are_refused() {
        let diagonal = vec![vec![4.0, 0.0], vec![0.0, 9.0]];
        assert!((Cholesky::new(&diagonal).unwrap().ln_determinant() - 36f64.ln()).abs() < 1e-12);
        assert!(Cholesky::new(&[vec![1.0, 2.0], vec![2.0, 1.0]]).is_none());
    }
}
