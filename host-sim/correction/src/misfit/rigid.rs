//! What all points are off in common: a shift of the datum and a difference in size, beside what is predicted.

use truepath_core::identify::Observation;
use truepath_ground::length::Unit;
use truepath_ground::units::float;

use super::look::CLAMPED_MM;
use super::score::{expected_mm, loss, residual_mm, weight};
use crate::plausible::WORN_MM;

/// Rounds in which the weights of the points settle.
const ROUNDS: usize = 20;
/// One standard deviation of datum and size, mm.
const FREE_MM: f64 = 0.5;
/// Fewer points cannot tell a shift from their own errors.
const LEAST_POINTS: usize = 5;
/// By how much a shift must lower the cost, and to what share.
const DECISIVE: f64 = 60.0;
const BY_FAR: f64 = 0.25;

/// A shift of all points.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rigid {
    /// What the readings have too much in x and y, mm.
    pub datum_mm: [f64; 2],
    /// What all points are off beside that, mm: positive, material seems left.
    pub level_mm: f64,
    /// Cost of the points as they are, without the datum, and without datum and level.
    pub cost: [f64; 3],
}

impl Rigid {
    /// Of points with predictions; `None` for too few.
    pub fn of(points: &[Observation]) -> Option<Self> {
        if points.len() < LEAST_POINTS {
            return None;
        }
        let rows: Vec<([f64; 3], f64)> = points
            .iter()
            .map(|o| {
                let e = expected_mm(o);
                let [x, y] = o.by_datum().map(float);
                ([x / e, y / e, 1.0 / e], residual_mm(o) / e)
            })
            .collect();
        let off = |x: &[f64; 3], (row, r): &([f64; 3], f64)| r - row.iter().zip(x).map(|(a, b)| a * b).sum::<f64>();
        let mut x = [0.0; 3];
        for _ in 0..ROUNDS {
            let (mut m, mut right) = ([[0.0; 3]; 3], [0.0; 3]);
            for (k, row) in m.iter_mut().enumerate() {
                row[k] = FREE_MM.powi(-2);
            }
            for both @ (row, r) in &rows {
                let w = weight(off(&x, both));
                for i in 0..3 {
                    right[i] += w * row[i] * r;
                    for j in 0..3 {
                        m[i][j] += w * row[i] * row[j];
                    }
                }
            }
            x = of_three(&m, &right);
        }
        let cost = |x: [f64; 3]| rows.iter().map(|row| loss(off(&x, row))).sum::<f64>();
        let cost = [cost([0.0; 3]), cost([x[0], x[1], 0.0]), cost(x)];
        Some(Self { datum_mm: [x[0], x[1]], level_mm: x[2], cost })
    }

    /// Whether it is more than what happens to every part, and explains the points by far.
    pub fn is_wrong(&self) -> bool {
        let [as_is, _, left] = self.cost;
        as_is - left > DECISIVE && left < BY_FAR * as_is && (self.is_moved() || self.level_mm.abs() > WORN_MM)
    }

    fn is_moved(&self) -> bool {
        self.datum_mm[0].hypot(self.datum_mm[1]) > CLAMPED_MM
    }

    /// What is wrong.
    pub fn words(&self, unit: Unit) -> String {
        let [x, y] = self.datum_mm.map(|v| unit.of(v + 0.0));
        let name = unit.name();
        if self.is_moved() {
            format!("all points lie X {x:.3} and Y {y:.3} {name} from where they should")
        } else {
            format!("all points are off by {:+.3} {name}", unit.of(self.level_mm))
        }
    }

    /// What to do about it.
    pub fn help(&self) -> &'static str {
        if self.is_moved() {
            "touch the part again in the work offset it was cut in (G54), without unclamping it, and look at X and Y of the origin"
        } else {
            "measure ball and cutter: the cutter is worn or another one, or ball_diameter_mm is not that of this ball"
        }
    }
}

fn of_three(m: &[[f64; 3]; 3], right: &[f64; 3]) -> [f64; 3] {
    let (mut m, mut x) = (*m, *right);
    for k in 0..3 {
        for i in k + 1..3 {
            let share = m[i][k] / m[k][k];
            let row = m[k];
            for (to, from) in m[i].iter_mut().zip(row).skip(k) {
                *to -= share * from;
            }
            x[i] -= share * x[k];
        }
    }
    for k in (0..3).rev() {
        let known: f64 = (k + 1..3).map(|j| m[k][j] * x[j]).sum();
        x[k] = (x[k] - known) / m[k][k];
    }
    x
}
