//! Earlier parts in a fit: cut with corrections of their own and clamped anew, by the same machine.
//!
//! Machine, cutter and material are shared by all parts; the shift of the datum between cut and probe is each part's
//! own. The two components of an earlier part's datum are eliminated from the normal equations before these are solved
//! and found again from the solution, so a fit over many parts is no larger than one over the last. As in
//! [`solve`](super::solve) the components are solved by the 2 × 2 inverse, whose bits exchange places under a quarter
//! turn.
#![expect(clippy::indexing_slicing, reason = "every index is a loop bound below the constant dimension")]
#![expect(clippy::arithmetic_side_effects, reason = "index arithmetic below the constant dimension")]

use super::observation::Observation;
use super::parameters::{COUNT, Prior};
use super::solve::{Information, SCALARS};
use truepath_units::geometry::Vector;
use truepath_units::{Real, log2};

/// A part before the last one of a fit: how many of the observations are of it, and its own datum.
#[derive(Clone, Copy, Debug, Default)]
pub struct EarlierPart {
    /// Its observations; those of the parts stand one behind the other, the last part's at the end.
    pub points: usize,
    /// Shift of its datum in standard deviations of the prior.
    pub(super) datum: [Real; 2],
    /// The same where the fit looks.
    pub(super) trial: [Real; 2],
    pub(super) eliminated: Eliminated,
}

impl EarlierPart {
    /// A part of so many observations.
    pub fn new(points: usize) -> Self {
        Self { points, ..Self::default() }
    }

    /// The fitted shift of its datum between cut and probe.
    pub fn datum(&self, prior: &Prior) -> Vector {
        datum(prior, self.datum)
    }

    /// The shift where the fit looks.
    pub(super) fn trial_datum(&self, prior: &Prior) -> Vector {
        datum(prior, self.trial)
    }

    /// Adds what its points say about the parameters of all parts.
    #[inline(never)]
    pub(super) fn inform(&mut self, whole: &mut Information, observations: &[Observation]) {
        let mut own = Information::of_part(self.trial);
        for o in observations {
            own.add(&o.sensitivity, o.residual(), o.weight);
        }
        self.eliminated = whole.add_part(&own);
    }

    /// Looks a share of the way along the step that belongs to a step of the shared parameters.
    pub(super) fn look(&mut self, step: &[Real; COUNT], share: Real) {
        let own = self.eliminated.step(step);
        for ((trial, datum), step) in self.trial.iter_mut().zip(&self.datum).zip(&own) {
            *trial = *datum + *step * share;
        }
    }
}

fn datum(prior: &Prior, [x, y]: [Real; 2]) -> Vector {
    let mut theta = [Real::ZERO; COUNT];
    theta[SCALARS] = x;
    theta[SCALARS + 1] = y;
    prior.at(&theta).datum
}

impl Information {
    /// The information of an earlier part before its points are added: of the prior only that of the part's own datum,
    /// at `datum` standard deviations from its centre.
    pub fn of_part(datum: [Real; 2]) -> Self {
        let mut empty = Self { matrix: [[Real::ZERO; COUNT]; COUNT], gradient: [Real::ZERO; COUNT] };
        for (k, d) in datum.iter().enumerate() {
            empty.matrix[SCALARS + k][SCALARS + k] = Real::ONE;
            empty.gradient[SCALARS + k] = -*d;
        }
        empty
    }

    /// Adds what an earlier part says about the parameters that all parts share, its own datum eliminated.
    pub fn add_part(&mut self, part: &Self) -> Eliminated {
        let eliminated = Eliminated::of(part);
        for i in 0..SCALARS {
            let [x, y] = eliminated.share(i);
            self.gradient[i] += part.gradient[i] - Real::dot(x, eliminated.gradient[0], y, eliminated.gradient[1]);
            for j in 0..SCALARS {
                let [u, v] = eliminated.share(j);
                let (a, b) = (eliminated.cross[i], eliminated.cross[j]);
                // Symmetric in i and j to the last bit.
                let twice = Real::dot(x, b[0], y, b[1]) + Real::dot(u, a[0], v, a[1]);
                self.matrix[i][j] += part.matrix[i][j] - twice * Real::HALF;
            }
        }
        eliminated
    }
}

/// The datum of an earlier part, eliminated from the normal equations: what is needed to find it again.
#[derive(Clone, Copy, Debug, Default)]
pub struct Eliminated {
    diagonal: [Real; 2],
    corner: Real,
    determinant: Real,
    cross: [[Real; 2]; SCALARS],
    gradient: [Real; 2],
}

impl Eliminated {
    fn of(part: &Information) -> Self {
        let (a, b) = (SCALARS, SCALARS + 1);
        let diagonal = [part.matrix[a][a].max(Real::ONE), part.matrix[b][b].max(Real::ONE)];
        let corner = part.matrix[a][b];
        let determinant = Real::dot(diagonal[0], diagonal[1], -corner, corner).max(Real::HALF);
        let mut cross = [[Real::ZERO; 2]; SCALARS];
        for (i, c) in cross.iter_mut().enumerate() {
            *c = [part.matrix[i][a], part.matrix[i][b]];
        }
        Self { diagonal, corner, determinant, cross, gradient: [part.gradient[a], part.gradient[b]] }
    }

    /// The 2 × 2 system for a right side; the components of the result exchange their bits with those of the right side.
    fn solve(&self, [x, y]: [Real; 2]) -> [Real; 2] {
        [
            Real::dot(self.diagonal[1], x, -self.corner, y) / self.determinant,
            Real::dot(self.diagonal[0], y, -self.corner, x) / self.determinant,
        ]
    }

    fn share(&self, parameter: usize) -> [Real; 2] {
        self.solve(self.cross[parameter])
    }

    /// The step of the part's datum that belongs to a step of all the others.
    pub fn step(&self, others: &[Real; COUNT]) -> [Real; 2] {
        let mut right = self.gradient;
        for (c, step) in self.cross.iter().zip(others) {
            right[0] -= c[0] * *step;
            right[1] -= c[1] * *step;
        }
        self.solve(right)
    }

    /// Binary logarithm of the determinant that elimination took out of the matrix.
    pub fn log2_determinant(&self) -> Real {
        log2(self.determinant)
    }
}
