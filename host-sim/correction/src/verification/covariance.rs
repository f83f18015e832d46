//! Covariance of the unknowns: the parameters, in units of the prior's standard deviations, and what is beside the model at
//! places of the wall, mm.
//!
//! A touch with sensitivities g (change of its reading per unit of every unknown, in standard deviations of the
//! reading) turns the covariance P into P − P g gᵀ P / (1 + gᵀ P g).

use truepath_core::identify::{COUNT, Matrix, Parameter};
use truepath_ground::units::float;

use crate::discrepancy::Open;

/// Sensitivities of one touch to the parameters.
pub(super) type Row = [f64; COUNT];

/// What a touch, or the wall at a place, is made of.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Thing {
    /// Its change per unit of every parameter.
    pub(super) row: Row,
    /// The place of the wall that it lies at, of those where something is beside the model, and its change per mm there.
    pub(super) beside: Option<(usize, f64)>,
}

impl Thing {
    /// What is beside the model at a place, mm, whatever the parameters.
    pub(super) const fn of_place(at: usize) -> Self {
        Self { row: [0.0; COUNT], beside: Some((at, 1.0)) }
    }

    fn times(&self, column: &[f64]) -> f64 {
        let (parameters, beside) = column.split_at(COUNT.min(column.len()));
        dot(&self.row, parameters) + self.beside.map_or(0.0, |(at, per)| per * beside.get(at).copied().unwrap_or(0.0))
    }
}

impl From<Row> for Thing {
    fn from(row: Row) -> Self {
        Self { row, beside: None }
    }
}

/// A covariance.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Covariance(Vec<Vec<f64>>);

impl Covariance {
    /// Before any touch, nothing beside the model.
    pub(super) fn prior() -> Self {
        let row = |k: usize| (0..COUNT).map(|j| if j == k { 1.0 } else { 0.0 }).collect();
        Self((0..COUNT).map(row).collect())
    }

    /// After what was measured: the covariance of a fit, nothing beside the model. With a `fresh_datum` the part is another one, or
    /// clamped anew: nothing is known of its datum.
    pub(super) fn of(covariance: &Matrix, fresh_datum: bool) -> Self {
        let mut matrix = covariance.map(|row| row.map(float).to_vec()).to_vec();
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

    /// With what is open beside the model at places of the wall.
    #[must_use]
    pub(super) fn beside(mut self, open: &Open) -> Self {
        let none = vec![0.0; open.covariance.len()];
        self.0.iter_mut().for_each(|row| row.extend(&none));
        self.0.extend(open.covariance.iter().map(|row| [&[0.0; COUNT][..], row].concat()));
        self
    }

    /// What touches take of it: columns c with P_after = P − Σ c cᵀ.
    pub(super) fn taken(&self, touches: &[Thing]) -> Vec<Vec<f64>> {
        let mut columns: Vec<Vec<f64>> = Vec::with_capacity(touches.len());
        for touch in touches {
            let mut column = self.image(touch);
            for before in &columns {
                let share = touch.times(before);
                column.iter_mut().zip(before).for_each(|(entry, before)| *entry -= share * before);
            }
            let scale = 1.0 / (1.0 + touch.times(&column)).sqrt();
            column.iter_mut().for_each(|entry| *entry *= scale);
            columns.push(column);
        }
        columns
    }

    /// Without what touches take of it.
    #[must_use]
    pub(super) fn without(mut self, taken: &[Vec<f64>]) -> Self {
        for column in taken {
            for (row, a) in self.0.iter_mut().zip(column) {
                row.iter_mut().zip(column).for_each(|(entry, b)| *entry -= a * b);
            }
        }
        self
    }

    /// After all touches of a place.
    #[must_use]
    pub(super) fn after_all(&self, touches: &[Thing]) -> Self {
        self.clone().without(&self.taken(touches))
    }

    /// Standard deviation of a parameter over that of the prior, 0…1.
    pub(super) fn remaining(&self, parameter: usize) -> f64 {
        self.0[parameter][parameter].max(0.0).sqrt()
    }

    /// Sum of the variances of many things by their parameters, given the sum of the outer products of their rows.
    pub(super) fn total(&self, products: &[[f64; COUNT]; COUNT]) -> f64 {
        self.0.iter().zip(products).map(|(row, other)| dot(row, other)).sum()
    }

    /// Variance of a thing.
    pub(super) fn variance(&self, thing: &Thing) -> f64 {
        thing.times(&self.image(thing)).max(0.0)
    }

    /// Standard deviation of a thing.
    pub(super) fn sigma(&self, thing: &Thing) -> f64 {
        self.variance(thing).sqrt()
    }

    /// Covariance of every unknown with a thing.
    fn image(&self, thing: &Thing) -> Vec<f64> {
        self.0.iter().map(|row| thing.times(row)).collect()
    }
}

/// What the columns that touches take hold of the variance of a thing.
pub(super) fn share_of(taken: &[Vec<f64>], thing: &Thing) -> f64 {
    taken.iter().map(|column| thing.times(column).powi(2)).sum()
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
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
        let known = Covariance::prior().after_all(&[row.into()]);
        // 1 / (1 + 3²) of the variance remains.
        assert!((known.remaining(2) - 0.1f64.sqrt()).abs() < 1e-12);
        assert_eq!(known.remaining(3), 1.0);
        let all = products([row, row].iter());
        assert!((known.total(&all) - 2.0 * 9.0 * 0.1).abs() < 1e-12);
    }

    #[test]
    fn a_touch_tells_of_what_is_beside_the_model_at_its_place_and_of_places_like_it() {
        // Three places: the second is like the first, the third like none.
        let covariance = [[0.04, 0.03, 0.0], [0.03, 0.04, 0.0], [0.0, 0.0, 0.04]].map(|row| row.to_vec()).to_vec();
        let known = Covariance::prior().beside(&Open { places_mm: vec![0.0, 1.0, 9.0], covariance });
        let wall = |at| Thing { row: [0.0; COUNT], beside: Some((at, 1.0)) };
        // A reading of 0.1 mm noise.
        let touch = Thing { row: [0.0; COUNT], beside: Some((0, 10.0)) };
        let taken = known.taken(&[touch]);
        let after = known.clone().without(&taken);
        for (at, left) in [(0, 0.04 - 0.0016 / 0.05), (1, 0.04 - 0.0009 / 0.05), (2, 0.04)] {
            assert!((after.variance(&wall(at)) - left).abs() < 1e-12, "{at}");
            let said = known.variance(&wall(at)) - share_of(&taken, &wall(at));
            assert!((said - left).abs() < 1e-12, "{at}");
        }
    }

    #[test]
    fn touches_one_after_the_other_are_touches_together() {
        let rows: Vec<Thing> = (0..3)
            .map(|k| Thing::from(std::array::from_fn::<f64, COUNT, _>(|j| ((3 * k + j * j) % 7) as f64 - 2.5)))
            .collect();
        let together = Covariance::prior().after_all(&rows);
        let one_by_one = rows.iter().fold(Covariance::prior(), |known, row| known.after_all(&[*row]));
        for k in 0..COUNT {
            assert!((together.remaining(k) - one_by_one.remaining(k)).abs() < 1e-12);
        }
    }
}
