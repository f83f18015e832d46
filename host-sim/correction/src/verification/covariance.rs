//! Covariance of the unknowns, in units of the prior's standard deviations.
//!
//! A touch with sensitivities g (change of its reading per prior standard deviation, in standard deviations of the
//! reading) turns the covariance P into P − P g gᵀ P / (1 + gᵀ P g).

use truepath_core::identify::{COUNT, Matrix, Parameter};
use truepath_ground::units::float;

/// Sensitivities of one touch.
pub(super) type Row = [f64; COUNT];

/// A covariance.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Covariance([[f64; COUNT]; COUNT]);

impl Covariance {
    /// Before any touch.
    pub(super) fn prior() -> Self {
        let mut matrix = [[0.0; COUNT]; COUNT];
        for (k, row) in matrix.iter_mut().enumerate() {
            row[k] = 1.0;
        }
        Self(matrix)
    }

    /// After what was measured: the covariance of a fit. With a `fresh_datum` the part is another one, or clamped anew:
    /// nothing is known of its datum.
    pub(super) fn of(covariance: &Matrix, fresh_datum: bool) -> Self {
        let mut matrix = covariance.map(|row| row.map(float));
        let datum = |k: usize| matches!(Parameter::ALL[k], Parameter::DatumX | Parameter::DatumY);
        for (i, row) in matrix.iter_mut().enumerate() {
            for (j, entry) in row.iter_mut().enumerate() {
                if fresh_datum && (datum(i) || datum(j)) {
                    *entry = if i == j { 1.0 } else { 0.0 };
                }
            }
        }
        Self(matrix)
    }

    /// After a touch.
    #[must_use]
    pub(super) fn after(&self, touch: &Row) -> Self {
        let image = self.times(touch);
        let scale = 1.0 / (1.0 + dot(&image, touch));
        let mut matrix = self.0;
        for (row, a) in matrix.iter_mut().zip(&image) {
            for (entry, b) in row.iter_mut().zip(&image) {
                *entry -= a * b * scale;
            }
        }
        Self(matrix)
    }

    /// After all touches of a place.
    #[must_use]
    pub(super) fn after_all(&self, touches: &[Row]) -> Self {
        touches.iter().fold(self.clone(), |known, touch| known.after(touch))
    }

    /// Standard deviation of an unknown over that of the prior, 0…1.
    pub(super) fn remaining(&self, unknown: usize) -> f64 {
        self.0[unknown][unknown].max(0.0).sqrt()
    }

    /// Sum of the variances of many things, given the sum of the outer products of their rows.
    pub(super) fn total(&self, products: &[[f64; COUNT]; COUNT]) -> f64 {
        self.0.iter().zip(products).map(|(row, other)| dot(row, other)).sum()
    }

    /// Standard deviation of a thing with a row.
    pub(super) fn sigma(&self, row: &Row) -> f64 {
        dot(&self.times(row), row).max(0.0).sqrt()
    }

    fn times(&self, row: &Row) -> Row {
        std::array::from_fn(|k| dot(&self.0[k], row))
    }
}

fn dot(a: &Row, b: &Row) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

/// Sum of the outer products of rows.
pub(super) fn products<'r>(rows: impl Iterator<Item = &'r Row>) -> [[f64; COUNT]; COUNT] {
    let mut sum = [[0.0; COUNT]; COUNT];
    for row in rows {
        for (line, a) in sum.iter_mut().zip(row) {
            for (entry, b) in line.iter_mut().zip(row) {
                *entry += a * b;
            }
        }
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_touch_tells_what_it_is_sensitive_to_and_nothing_else() {
        let mut row = [0.0; COUNT];
        row[2] = 3.0;
        let known = Covariance::prior().after(&row);
        // 1 / (1 + 3²) of the variance remains.
        assert!((known.remaining(2) - 0.1f64.sqrt()).abs() < 1e-12);
        assert_eq!(known.remaining(3), 1.0);
        let all = products([row, row].iter());
        assert!((known.total(&all) - 2.0 * 9.0 * 0.1).abs() < 1e-12);
    }
}
