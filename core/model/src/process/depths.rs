//! How deep every point of the cutter's circumference lies in what is left.
//!
//! A point lies in material when its distance from the path, along the normal of its own foot on the path, is more than radius less
//! remaining stock *there*: ahead of the cutter that is the wall before this pass. Material may be met in several stretches: on a
//! wavy wall, or in a corner above a wall that is already deeper.

use super::grid::{ANGLES, ImmersionGrid};
use super::part::Part;
use super::slices::MAX_SLICES;
use crate::cut::{Frame, Path};
use truepath_units::geometry::{Direction, Point, Side, Vector};
use truepath_units::{Offset, Real};

/// Samples by which the foot of one angle may lie away from that of the angle before: a sharp corner turns on the spot in 157.
const FOOT_STEPS: usize = 400;
/// Beyond what the loop moves the cutter from where the depths were looked at, points this far out of the stock are in air.
const SLACK: Offset = Offset::from_um(200);

/// A point this far out of the material, nm, comes into it under no displacement of a slice.
const AIR: i64 = -300_000;

/// Depths at all angles in all slices for one place of the cutter; positive in material.
#[derive(Clone, Debug)]
pub struct Depths {
    /// Angles from the wall on that matter.
    pub(super) rows: usize,
    /// Normal of the foot of every angle.
    pub(super) normal: [Direction; ANGLES],
    /// By slice, then by angle, nm.
    pub(super) depth: [[i64; ANGLES]; MAX_SLICES],
}

/// The foot of a point on the path.
struct Foot {
    /// Sample before it.
    at: usize,
    /// How far towards the next.
    share: Real,
    normal: Direction,
    /// Distance of the point along the normal.
    distance: Offset,
}

impl Depths {
    /// Nothing in material.
    pub const NONE: Self = Self { rows: 0, normal: [Direction::X; ANGLES], depth: [[0; ANGLES]; MAX_SLICES] };

    /// Looks from a centre. `forward`: travels as the path does. `shift` holds what every slice lies beside the centre, as a
    /// factor of `mean`.
    pub(super) fn look(
        &mut self,
        (path, part): (&Path, &Part),
        grid: &ImmersionGrid,
        (centre, frame, forward): (Point, &Frame, bool),
        (mean, shift): (Vector, &[Real]),
    ) {
        let radius = path.setup().radius;
        let heading = if forward { frame.heading } else { frame.heading.reversed() };
        let mut at = frame.index;
        let clear = part.most() + SLACK + mean.length();
        let (mut rows, slices) = (0usize, part.slices().count());
        let slots = self.normal.iter_mut().zip(grid.sine).zip(grid.cosine).enumerate();
        for (row, ((normal, sine), cosine)) in slots {
            let out = Direction {
                x: Real::dot(frame.normal.x, cosine, heading.x, sine),
                y: Real::dot(frame.normal.y, cosine, heading.y, sine),
            };
            let Some(foot) = foot(path, centre + out.times(radius), at) else { break };
            at = foot.at;
            *normal = foot.normal;
            let reach = foot.distance - radius;
            if reach + clear > Offset::ZERO {
                rows = row.saturating_add(1);
            }
            let (here, next) = (part.beside(foot.at), part.beside(foot.at.saturating_add(1)));
            let next = if next.is_empty() { here } else { next };
            let along = mean.along(foot.normal).nm();
            let heights = here.iter().zip(next).zip(shift).zip(self.depth.iter_mut()).take(slices);
            for (((a, b), factor), depths) in heights {
                let left = a.nm().saturating_add(part_of((*b - *a).nm(), foot.share));
                let depth = reach.nm().saturating_add(left).saturating_add(part_of(along, *factor));
                if let Some(slot) = depths.get_mut(row) {
                    *slot = depth;
                }
            }
        }
        self.rows = rows.saturating_add(2).min(ANGLES);
    }

    /// For every slice from `first` on how many angles matter: behind them is nothing but air, however the loop moves the cutter.
    pub(super) fn rows_of_slices(&self, first: usize, count: usize) -> [u8; MAX_SLICES] {
        let mut slices = [0; MAX_SLICES];
        for (rows, depth) in slices.iter_mut().zip(&self.depth).take(count).skip(first) {
            let known = depth.get(..self.rows).unwrap_or_default();
            let last = known.iter().rposition(|d| *d > AIR);
            *rows = last.map_or(0, |last| last.saturating_add(2).min(self.rows)) as u8;
        }
        slices
    }

    /// The largest angle of the grid at which there is material in a slice from `first` on, rad.
    pub(super) fn leaves(&self, grid: &ImmersionGrid, (first, count): (usize, usize)) -> Real {
        let last = self
            .depth
            .iter()
            .take(count)
            .skip(first)
            .filter_map(|d| d.get(..self.rows)?.iter().rposition(|d| *d > 0))
            .max();
        last.and_then(|last| grid.angle.get(last)).copied().unwrap_or(Real::ZERO)
    }
}

/// A length below half a metre times a factor of a few units, rounded down, nm.
#[inline]
pub(super) const fn part_of(nm: i64, factor: Real) -> i64 {
    nm.saturating_mul(factor.bits()) >> Real::FRACTION_BITS
}

/// The foot of a point, looked for from sample `from` on.
fn foot(path: &Path, point: Point, from: usize) -> Option<Foot> {
    let samples = path.samples();
    let last = samples.len().checked_sub(2)?;
    let mut at = from.min(last);
    let side = path.setup().wall;
    let along = |index: usize| {
        let sample = samples.get(index)?;
        Some(point.from(sample.point).along(side.heading(sample.normal)))
    };
    for _ in 0..FOOT_STEPS {
        if at >= last || along(at.saturating_add(1))? < Offset::ZERO {
            break;
        }
        at = at.saturating_add(1);
    }
    let mut behind = along(at)?;
    for _ in 0..FOOT_STEPS {
        if at == 0 || behind >= Offset::ZERO {
            break;
        }
        at = at.saturating_sub(1);
        behind = along(at)?;
    }
    let ahead = along(at.saturating_add(1))?;
    let share = if behind <= Offset::ZERO {
        Real::ZERO
    } else if ahead >= Offset::ZERO {
        Real::ONE
    } else {
        behind.over(behind - ahead)
    };
    let (a, b) = (samples.get(at)?, samples.get(at.saturating_add(1))?);
    let rest = Real::ONE - share;
    let normal = Direction {
        x: Real::dot(a.normal.x, rest, b.normal.x, share),
        y: Real::dot(a.normal.y, rest, b.normal.y, share),
    };
    // Between two samples the path bulges from the chord and the mixed normal is a little short.
    let (between, turn) = (share * rest, a.normal.cross(b.normal));
    let bulge = (b.s - a.s).scaled(turn * between * Real::HALF);
    let bulge = if side == Side::Right { bulge } else { -bulge };
    let chord = a.point + b.point.from(a.point).scaled(share);
    let distance = point.from(chord).along(normal).scaled(Real::ONE + turn * turn * between * Real::HALF) - bulge;
    Some(Foot { at, share, normal, distance })
}
