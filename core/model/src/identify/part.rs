//! Earlier parts in a fit: cut with corrections of their own and clamped anew, by the same machine.
//!
//! Machine, cutter and material are shared by all parts. Two things are each part's own: the shift of the datum between cut
//! and probe, and the level of force, which rises as the cutter wears and changes with the blank. Both are eliminated from
//! the normal equations before these are solved and found again from the solution, so a fit over many parts is no larger
//! than one over the last. The level needs no sensitivity of its own: a force larger by a share does to the wall what
//! a compliance larger by that share does. As in [`solve`](super::solve) the components of the datum are solved by the 2 × 2
//! inverse, whose bits exchange places under a quarter turn.
#![expect(clippy::indexing_slicing, reason = "every index is a loop bound below the constant dimension")]
#![expect(clippy::arithmetic_side_effects, reason = "index arithmetic below the constant dimension")]

use super::observation::Observation;
use super::parameters::{COUNT, Parameters, Prior};
use super::solve::{Information, SCALARS};
use truepath_units::geometry::Vector;
use truepath_units::{Real, log2};

/// What is believed of the level of force of an earlier part over that of the last one, natural logarithm.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Level {
    /// Expected value.
    pub expected: Real,
    /// One standard deviation; 0 holds it.
    pub sigma: Real,
}

impl Level {
    /// Of parts of which nothing is known: another lot of the same alloy cuts up to 10 % harder, a cutter at its end 20 %.
    pub const ANY: Self = Self { expected: Real::ZERO, sigma: Real::ratio(1, 10) };

    /// One that is known.
    pub const fn known(level: Real) -> Self {
        Self { expected: level, sigma: Real::ZERO }
    }
}

/// A part before the last one of a fit: how many of the observations are of it, and what is its own.
#[derive(Clone, Copy, Debug, Default)]
pub struct EarlierPart {
    /// Its observations; those of the parts stand one behind the other, the last part's at the end.
    pub points: usize,
    /// What is believed of its level of force.
    pub believed: Level,
    own: Own,
    /// The same where the fit looks.
    trial: Own,
    eliminated: Eliminated,
}

/// What a part has of its own, in standard deviations of what is believed.
#[derive(Clone, Copy, Debug, Default)]
struct Own {
    level: Real,
    datum: [Real; 2],
}

impl EarlierPart {
    /// A part of so many observations.
    pub fn new(points: usize, believed: Level) -> Self {
        Self { points, believed, ..Self::default() }
    }

    /// The fitted shift of its datum between cut and probe.
    pub fn datum(&self, prior: &Prior) -> Vector {
        datum(prior, self.own.datum)
    }

    /// Its fitted level of force over that of the last part, natural logarithm.
    pub fn level(&self) -> Real {
        self.level_at(&self.own)
    }

    fn level_at(&self, own: &Own) -> Real {
        self.believed.expected + self.believed.sigma * own.level
    }

    /// The parameters of the last part with what is this one's own where the fit looks.
    pub(super) fn tried(&self, prior: &Prior, last: &Parameters) -> Parameters {
        Parameters { datum: datum(prior, self.trial.datum), ..last.with_force(self.level_at(&self.trial)) }
    }

    /// What it costs to look where the fit does.
    pub(super) fn cost(&self) -> Real {
        let Own { level, datum: [x, y] } = self.trial;
        level * level + x * x + y * y
    }

    /// Adds what its points say about the parameters of all parts.
    #[inline(never)]
    pub(super) fn inform(&mut self, whole: &mut Information, prior: &Prior, observations: &[Observation]) {
        let mut own = Information::of_part(self.trial.datum);
        for o in observations {
            own.add(&o.sensitivity, o.residual(), o.weight);
        }
        let [of_compliance, ..] = prior.sigma;
        let ratio = if of_compliance == Real::ZERO { Real::ZERO } else { self.believed.sigma / of_compliance };
        let level = own.take_level(ratio, self.trial.level);
        self.eliminated = whole.add_part(&own).with_level(level);
    }

    /// Looks a share of the way along the step that belongs to a step of the shared parameters.
    pub(super) fn look(&mut self, step: &[Real; COUNT], share: Real) {
        let (level, own) = self.eliminated.step(step);
        self.trial.level = self.own.level + level * share;
        for ((trial, datum), step) in self.trial.datum.iter_mut().zip(&self.own.datum).zip(&own) {
            *trial = *datum + *step * share;
        }
    }

    /// Stays where the fit looks.
    pub(super) const fn stay(&mut self) {
        self.own = self.trial;
    }

    /// Looks where it stayed.
    pub(super) const fn look_back(&mut self) {
        self.trial = self.own;
    }

    /// Binary logarithm of the determinant that elimination took out of the matrix.
    pub(super) fn log2_determinant(&self) -> Real {
        self.eliminated.log2_determinant()
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

    /// Takes the level of force out of the information of an earlier part, at `level` standard deviations from what is expected;
    /// a standard deviation of it does `ratio` times what one of the mean compliance does.
    pub fn take_level(&mut self, ratio: Real, level: Real) -> EliminatedLevel {
        let cross: [Real; COUNT] = core::array::from_fn(|i| self.matrix[i][0] * ratio);
        let diagonal = Real::ONE + cross[0] * ratio;
        let gradient = self.gradient[0] * ratio - level;
        let share = cross.map(|c| c / diagonal);
        for i in 0..COUNT {
            self.gradient[i] -= share[i] * gradient;
            for j in 0..COUNT {
                // Symmetric in i and j to the last bit.
                self.matrix[i][j] -= (share[i] * cross[j] + share[j] * cross[i]) * Real::HALF;
            }
        }
        EliminatedLevel { diagonal, cross, gradient }
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

/// The level of force of an earlier part, eliminated from its normal equations: what is needed to find it again.
#[derive(Clone, Copy, Debug)]
pub struct EliminatedLevel {
    diagonal: Real,
    cross: [Real; COUNT],
    gradient: Real,
}

impl Default for EliminatedLevel {
    fn default() -> Self {
        Self { diagonal: Real::ONE, cross: [Real::ZERO; COUNT], gradient: Real::ZERO }
    }
}

impl EliminatedLevel {
    /// The step of the level that belongs to a step of the shared parameters and of the part's datum.
    fn step(&self, others: &[Real; COUNT], [x, y]: [Real; 2]) -> Real {
        let shared = self.cross.iter().zip(others).take(SCALARS);
        let right = shared.fold(self.gradient, |right, (c, step)| right - *c * *step);
        // The two components of the vector are added in one rounding, whatever their order.
        (right - Real::dot(self.cross[SCALARS], x, self.cross[SCALARS + 1], y)) / self.diagonal
    }
}

/// What is an earlier part's own, eliminated from the normal equations: what is needed to find it again.
#[derive(Clone, Copy, Debug, Default)]
pub struct Eliminated {
    level: EliminatedLevel,
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
        let gradient = [part.gradient[a], part.gradient[b]];
        Self { level: EliminatedLevel::default(), diagonal, corner, determinant, cross, gradient }
    }

    /// With the level that was [taken out](Information::take_level) before the datum.
    #[must_use]
    pub const fn with_level(self, level: EliminatedLevel) -> Self {
        Self { level, ..self }
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

    /// The steps of the part's level of force and of its datum that belong to a step of all the others.
    pub fn step(&self, others: &[Real; COUNT]) -> (Real, [Real; 2]) {
        let mut right = self.gradient;
        for (c, step) in self.cross.iter().zip(others) {
            right[0] -= c[0] * *step;
            right[1] -= c[1] * *step;
        }
        let datum = self.solve(right);
        (self.level.step(others, datum), datum)
    }

    /// Binary logarithm of the determinant that elimination took out of the matrix.
    pub fn log2_determinant(&self) -> Real {
        log2(self.determinant) + log2(self.level.diagonal)
    }
}
