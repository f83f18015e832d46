//! The wall that remains: the envelope of the displaced cutter.
//!
//! At a wall point W with normal n the material ends where the deepest of the nearby cutter circles ends:
//! `e = min over centres a of (v·n − √(r² − (v·t)²))`, v = W − a. Positive: material left. It is not the deflection
//! along n: where that changes along the path by g per unit length the envelope lies about r·g²/2 above it.

use super::elastic::{Loop, State};
use super::path::Path;
use super::sample::Sample;
use super::teeth::Teeth;
use truepath_units::geometry::{Direction, Point, Vector};
use truepath_units::{Offset, Real, isqrt_rounded};

/// Cutter positions at one height, in the order of the path, ready for the wall to be read off.
#[derive(Clone, Copy, Debug)]
pub struct Envelope<'a> {
    path: &'a Path<'a>,
    /// Displacements of the cutter from the nominal centre, one per sample from `from` on.
    displacements: &'a [Vector],
    from: usize,
}

/// The wall error at a sample.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WallError {
    /// Material left (positive) or cut too deep (negative).
    pub error: Offset,
    /// Index of the sample whose cutter position made it.
    pub made_by: usize,
}

impl<'a> Envelope<'a> {
    /// Takes the displacements of samples `from..from + displacements.len()`.
    pub const fn new(path: &'a Path<'a>, from: usize, displacements: &'a [Vector]) -> Self {
        Self { path, displacements, from }
    }

    /// Fills `displacements` with the cutter's displacement at a height (fraction of the engaged depth).
    pub fn displace(machine: &Loop, states: &[State], fraction: Real, displacements: &mut [Vector]) {
        let mut teeth = Teeth::BLANK;
        for (slot, state) in displacements.iter_mut().zip(states) {
            *slot = machine.at_height(&mut teeth, state, fraction);
        }
    }

    /// The wall error beside sample `index`. `guess` is where to look first: the sample that made the wall beside the
    /// neighbour. The search is bounded: a coarse look half a radius to both sides, then a descent to the nearest
    /// minimum.
    pub fn error(&self, index: usize, guess: usize) -> Option<WallError> {
        let sample = self.path.samples().get(index)?;
        let wall = self.path.wall(sample);
        let gap = |at: usize| self.gap(at, sample, wall);
        let mut best = (index, gap(index)?);
        let lower = |at: usize, best: Offset| self.lower(at, sample, wall, best);
        let mut consider = |at: usize| {
            if let Some(g) = lower(at, best.1) {
                best = (at, g);
            }
        };
        consider(guess);
        let reach = Offset::from_nm(self.path.setup().radius.nm() / 2);
        let mut far = reach.nm().checked_div(self.path.step().nm()).unwrap_or(0).unsigned_abs() as usize;
        if self.path.is_crowded() {
            // Samples that stand close together hide what lies beyond them: look by arc length.
            for eighth in 1..=8 {
                let away = reach.scaled(Real::ratio(eighth, 8));
                consider(self.path.index_at(sample.s + away));
                consider(self.path.index_at(sample.s - away));
            }
            let (from, to) = (self.path.index_at(sample.s - reach), self.path.index_at(sample.s + reach));
            far = to.saturating_sub(from) / 2;
        } else {
            for eighth in 1..=8usize {
                let stride = far.saturating_mul(eighth) / 8;
                consider(index.saturating_add(stride));
                consider(index.saturating_sub(stride));
            }
        }
        // Descent with halving strides.
        let mut stride = (far / 8).max(1);
        while stride > 0 {
            let from = best.0;
            for at in [from.saturating_sub(stride), from.saturating_add(stride)] {
                if let Some(g) = lower(at, best.1) {
                    best = (at, g);
                }
            }
            if best.0 == from {
                stride /= 2;
            }
        }
        let (at, lowest) = best;
        let refined = match (gap(at.saturating_sub(1)), gap(at.saturating_add(1))) {
            (Some(before), Some(after)) => vertex(before, lowest, after),
            _ => lowest,
        };
        Some(WallError { error: refined, made_by: at })
    }

    /// How far the circle at sample `at` ends short of the wall point, along the normal; `None` when it passes beside.
    fn gap(&self, at: usize, sample: &Sample, wall: Point) -> Option<Offset> {
        self.reach(at, sample, wall).map(|(ahead, square)| ahead - root(square))
    }

    /// The gap at sample `at` where it is below another. Most are not, and that is seen without a root: with
    /// q = ahead − best the gap is no less than best when q² ≥ r² − beside².
    fn lower(&self, at: usize, sample: &Sample, wall: Point, best: Offset) -> Option<Offset> {
        let (ahead, square) = self.reach(at, sample, wall)?;
        let q = (ahead - best).nm();
        if q >= 0 && q.saturating_mul(q) >= square {
            return None;
        }
        Some(ahead - root(square)).filter(|g| *g < best)
    }

    /// Of the circle at sample `at`: distance of the wall point from its centre along the normal, and r² − beside², nm²;
    /// `None` when it passes beside.
    fn reach(&self, at: usize, sample: &Sample, wall: Point) -> Option<(Offset, i64)> {
        let displacement = *self.displacements.get(at.checked_sub(self.from)?)?;
        let centre = self.path.samples().get(at)?.point + displacement;
        let v = wall.from(centre);
        let normal: Direction = sample.normal;
        let beside = v.along(self.path.setup().wall.heading(normal)).nm();
        let r = self.path.setup().radius.nm();
        let square = r.saturating_mul(r).saturating_sub(beside.saturating_mul(beside));
        (square > 0).then(|| (v.along(normal), square))
    }
}

fn root(square: i64) -> Offset {
    Offset::from_nm(isqrt_rounded(square.unsigned_abs().into()) as i64)
}

/// Lowest point of the parabola through three even places, the middle one being the lowest.
fn vertex(before: Offset, lowest: Offset, after: Offset) -> Offset {
    let slope = i128::from((after - before).nm());
    let curvature = i128::from((after - lowest + before - lowest).nm());
    if curvature <= 0 {
        return lowest;
    }
    lowest
        - Offset::from_nm(truepath_units::div_rounded(slope.saturating_mul(slope), curvature.saturating_mul(8)) as i64)
}
