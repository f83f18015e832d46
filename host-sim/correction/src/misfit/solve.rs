//! A symmetric positive system, solved by elimination.

use truepath_core::identify::COUNT;

/// The solution of `matrix` · x = `right`.
pub(super) fn solved(matrix: &[[f64; COUNT]; COUNT], right: &[f64; COUNT]) -> [f64; COUNT] {
    let (mut m, mut x) = (*matrix, *right);
    for k in 0..COUNT {
        let pivot = m[k][k].max(1e-12);
        for i in k + 1..COUNT {
            let share = m[i][k] / pivot;
            let row = m[k];
            for (to, from) in m[i].iter_mut().zip(row).skip(k) {
                *to -= share * from;
            }
            x[i] -= share * x[k];
        }
    }
    for k in (0..COUNT).rev() {
        let known: f64 = (k + 1..COUNT).map(|j| m[k][j] * x[j]).sum();
        x[k] = (x[k] - known) / m[k][k].max(1e-12);
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_solution_fulfils_the_equations() {
        // A · Aᵀ + 1 of entries without order.
        let entry = |i: usize, j: usize| ((i * 7 + j * 13) % 11) as f64 - 5.0;
        let mut matrix = [[0.0; COUNT]; COUNT];
        for (i, row) in matrix.iter_mut().enumerate() {
            for (j, value) in row.iter_mut().enumerate() {
                *value = (0..COUNT).map(|k| entry(i, k) * entry(j, k)).sum::<f64>() + f64::from(i == j);
            }
        }
        let right: [f64; COUNT] = std::array::from_fn(|k| k as f64 - 3.5);
        let x = solved(&matrix, &right);
        for (row, right) in matrix.iter().zip(right) {
            let product: f64 = row.iter().zip(x).map(|(a, b)| a * b).sum();
            assert!((product - right).abs() < 1e-6, "{product} {right}");
        }
    }
}
