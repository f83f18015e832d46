//! The wall that remains: the envelope of the displaced cutter.
//!
//! At a wall point W with normal n the material ends where the deepest of the nearby cutter circles ends:
//! `e = min over centres a of (v·n − √(r² − (v·t)²))`, v = W − a. Positive: material left. It is not the deflection
//! along n: where that changes along the path by g per unit length the envelope lies about r·g²/2 above it.

use super::coarse_look::{EIGHTHS, clear};
use super::elastic::{Heights, Loop, State};
use super::path::Path;
use super::sample::Sample;
use super::teeth::Teeth;
use truepath_units::geometry::{Direction, Point, Vector};
use truepath_units::{Offset, Real, isqrt_near, isqrt_rounded, part};

/// Cutter positions at one height, in the order of the path, ready for the wall to be read off.
#[derive(Clone, Copy, Debug)]
pub struct Envelope<'a, D = &'a [Vector]> {
    path: &'a Path<'a>,
    /// Displacements of the cutter from the nominal centre, one per sample from `from` on.
    displacements: D,
    from: usize,
    /// 2⁶³ over the cutter's diameter in nm; 0 for one whose square takes more than 62 bits.
    per_diameter: i64,
}

/// Who knows how far the cutter is displaced at a height: a row of displacements, or whoever computes those that are asked for.
pub trait Displacements {
    /// At a sample, counted from the first that is known; `None` beyond the last.
    fn displacement(&mut self, slot: usize) -> Option<Vector>;
}

impl Displacements for &[Vector] {
    #[inline]
    fn displacement(&mut self, slot: usize) -> Option<Vector> {
        self.get(slot).copied()
    }
}

/// Displacements at a height, each computed when it is first asked for: of a few walls side by side an envelope looks at a quarter.
#[derive(Debug)]
pub(crate) struct Sought<'a, S> {
    machine: &'a Loop<'a>,
    state: S,
    fraction: Real,
    teeth: &'a mut Teeth,
    known: &'a mut [Vector],
}

impl<'a, S: FnMut(usize) -> Option<State>> Sought<'a, S> {
    /// A displacement that nobody has asked for.
    const UNKNOWN: Vector = Vector { x: Offset::MAX, y: Offset::MAX };

    /// Of a machine at a fraction of the engaged depth; `state` tells a state, `known` is as long as there are any. The teeth are lent, so
    /// that they are on the stack once.
    pub(crate) fn new(
        machine: &'a Loop<'a>,
        state: S,
        fraction: Real,
        (teeth, known): (&'a mut Teeth, &'a mut [Vector]),
    ) -> Self {
        known.fill(Self::UNKNOWN);
        Self { machine, state, fraction, teeth, known }
    }
}

impl<S: FnMut(usize) -> Option<State>> Displacements for Sought<'_, S> {
    #[inline]
    fn displacement(&mut self, slot: usize) -> Option<Vector> {
        let known = self.known.get_mut(slot)?;
        if *known == Self::UNKNOWN {
            *known = self.machine.at_height(self.teeth, &(self.state)(slot)?, self.fraction);
        }
        Some(*known)
    }
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
        Self::of(path, from, displacements)
    }

    /// Fills `displacements` with the cutter's displacement at a height (fraction of the engaged depth).
    pub fn displace(machine: &Loop, states: &[State], fraction: Real, displacements: &mut [Vector]) {
        let mut teeth = Teeth::BLANK;
        for (slot, state) in displacements.iter_mut().zip(states) {
            *slot = machine.at_height(&mut teeth, state, fraction);
        }
    }

    /// The same at several heights, which cost less together: one row of displacements each.
    pub fn displace_all<const N: usize>(
        machine: &Loop,
        states: &[State],
        fractions: [Real; N],
        mut rows: [&mut [Vector]; N],
    ) {
        let mut heights = Heights::new(machine, fractions);
        for (at, state) in states.iter().enumerate() {
            for (row, displacement) in rows.iter_mut().zip(machine.at_heights(&mut heights, state)) {
                if let Some(slot) = row.get_mut(at) {
                    *slot = displacement;
                }
            }
        }
    }

    /// The wall error beside sample `index`. `guess` is where to look first: the sample that made the wall beside the
    /// neighbour. The search is bounded: a coarse look half a radius to both sides, then a descent to the nearest
    /// minimum.
    pub fn error(&self, index: usize, guess: usize) -> Option<WallError> {
        let mut envelope = *self;
        envelope.read(index, guess)
    }
}

impl<'a, D: Displacements> Envelope<'a, D> {
    /// Of the displacements of samples from `from` on.
    pub const fn of(path: &'a Path<'a>, from: usize, displacements: D) -> Self {
        let radius = path.setup().radius.nm();
        let per_diameter = match (1i64 << 62).checked_div(radius) {
            Some(per) if radius >> 31 == 0 => per,
            _ => 0,
        };
        Self { path, displacements, from, per_diameter }
    }

    /// As [`error`](Envelope::error).
    pub fn read(&mut self, index: usize, guess: usize) -> Option<WallError> {
        let path = self.path;
        let mut look = Look::beside(self, index, guess)?;
        let far = if path.is_crowded() { look.by_arc_length(index) } else { look.by_samples(index) };
        Some(look.descend(far / EIGHTHS))
    }

    /// The same beside a place next to one whose wall is known, which is made next to `guess`: there is no other to look for.
    pub(crate) fn read_next(&mut self, index: usize, guess: usize) -> Option<WallError> {
        Some(Look::beside(self, index, guess)?.descend(1))
    }
}

/// What [`Look::calm`] knows.
#[derive(Clone, Copy, Debug)]
struct Calm {
    /// What is left for every sample that the other place is off, nm².
    per_sample: i64,
    /// What is lost at any, nm².
    lost: i64,
    /// What is lost for every nanometre by which the displacement is another one, nm.
    per_change: i64,
    /// It must be less than this, nm.
    most: i64,
}

/// How far the cutter at sample `maker`, displaced, ends short of the wall point beside sample `index`, along its normal: the wall error there
/// as long as no other position ends deeper. `None` when it passes beside, or there is no such sample.
///
/// What moves the machine a little moves the wall as it moves the cutter that made it: who makes it changes that in second order only.
pub fn left_by(path: &Path, index: usize, maker: usize, displacement: Vector) -> Option<Offset> {
    let (beside, at) = (path.samples().get(index)?, path.samples().get(maker)?);
    let (ahead, across) = path.wall(beside).from(at.point + displacement).along_and_right(beside.normal);
    let (radius, across) = (path.setup().radius.nm(), across.nm());
    let square = radius.saturating_mul(radius).saturating_sub(across.saturating_mul(across));
    (square > 0).then(|| ahead - Offset::from_nm(isqrt_rounded(square.unsigned_abs().into()) as i64))
}

/// A look along the path for the cutter position that ends deepest beside a wall point.
///
/// Most positions end less deep than the deepest so far, and that is seen from their distance alone: the circle ends
/// above `lowered`, the wall point less the lowest gap, when its centre is farther from it than the radius, on the far side
/// of the wall. Where the distance does not leave a few nanometres to spare, what counts are the rounded components along
/// and across the normal: the shorter way only leaves out what they would.
struct Look<'e, 'a, D> {
    envelope: &'e mut Envelope<'a, D>,
    /// Samples from that of the first displacement on.
    samples: &'a [Sample],
    wall: Point,
    normal: Direction,
    /// The normal in units of 2⁻³⁰.
    coarse: [i64; 2],
    /// The lowest gap so far, and the sample whose cutter position it is of.
    lowest: Offset,
    made_by: usize,
    lowered: Point,
    /// Square of a distance of the centre that is certainly more than the radius, nm².
    clear: i64,
    /// The displacement of the cutter at the sample beside the wall point.
    own: Vector,
}

impl<'e, 'a, D: Displacements> Look<'e, 'a, D> {
    /// Begins with the cutter position at the sample beside the wall point and that of a guess; of two that end alike it
    /// is the first.
    fn beside(envelope: &'e mut Envelope<'a, D>, index: usize, guess: usize) -> Option<Self> {
        let (path, sample) = (envelope.path, envelope.path.samples().get(index)?);
        let (wall, normal) = (path.wall(sample), sample.normal);
        let clear = clear(path.setup().radius);
        let samples = path.samples().get(envelope.from..).unwrap_or_default();
        let own = envelope.displacements.displacement(index.checked_sub(envelope.from)?)?;
        let mut look = Self {
            envelope,
            samples,
            wall,
            normal,
            coarse: [normal.x, normal.y].map(|v| v.bits() >> 2),
            lowest: Offset::MAX,
            made_by: index,
            lowered: wall,
            clear,
            own,
        };
        // A circle that passes beside its own wall point makes none; that takes a displacement as large as the radius.
        let is_near = own.x.abs() + own.y.abs() < path.setup().radius;
        match look.gap(guess).filter(|_| is_near) {
            Some(gap) => {
                look.take(guess, gap);
                if guess != index
                    && !look.is_above(index)
                    && let gap = look.gap(index)?
                    && gap <= look.lowest
                {
                    look.take(index, gap);
                }
            }
            None => {
                let gap = look.gap(index)?;
                look.take(index, gap);
                look.at(guess);
            }
        }
        Some(look)
    }

    /// Goes down to the nearest minimum with halving strides.
    fn descend(&mut self, stride: usize) -> WallError {
        let mut stride = stride.max(1);
        while stride > 0 {
            let from = self.made_by;
            self.at(from.saturating_sub(stride));
            self.at(from.saturating_add(stride));
            if self.made_by == from {
                stride /= 2;
            }
        }
        let (made_by, lowest) = (self.made_by, self.lowest);
        WallError { error: lowest_about(made_by, lowest, |at| self.gap(at)), made_by }
    }

    fn take(&mut self, at: usize, gap: Offset) {
        (self.made_by, self.lowest) = (at, gap);
        self.lowered = self.wall - self.normal.times(gap);
    }

    /// Eighths of half a radius to both sides, counted in samples of the longest step; returns how many the whole is.
    fn by_samples(&mut self, index: usize) -> usize {
        let far = self.envelope.path.coarse_look().far;
        let strides = (1..=EIGHTHS).map(|eighth| far.saturating_mul(eighth) / EIGHTHS);
        let places = |stride: usize| [index.saturating_add(stride), index.saturating_sub(stride)];
        // Mostly all of them end above the lowest gap, and nothing is taken.
        let moves_little = self.calm(index).is_some_and(|calm| {
            strides.clone().all(|stride| places(stride).into_iter().all(|at| self.moves_little(&calm, at, stride)))
        });
        if !moves_little && !strides.clone().flat_map(places).all(|at| self.is_above(at)) {
            strides.flat_map(places).for_each(|at| self.at(at));
        }
        far
    }

    /// How little the displacement must change along the path for no other place of the coarse look to make the wall; `None` where
    /// that is not known.
    ///
    /// With d from the wall point W to the nominal centre of the other place, v and w the displacements here and there, τ the part of v
    /// along the path, and the cutter here ending at W − n·g, the other centre is e = d + t·τ + (w − v) + n·δ from where it must end,
    /// 0 ≤ δ ≤ 0.51·τ²/r, or farther on the far side where the lowest gap is below g. So
    /// `e² ≥ d² − 2·|τ|·|d·t| − τ² − (25/8)·r·|w − v|` as long as τ ≤ r/16, and d·t ≤ r/2 is at most the way to the other place.
    fn calm(&self, index: usize) -> Option<Calm> {
        let path = self.envelope.path;
        let (look, radius) = (path.coarse_look(), path.setup().radius.nm());
        if !path.samples().get(index).is_some_and(Sample::is_plain) {
            return None;
        }
        let [normal_x, normal_y] = self.coarse;
        let across = self.own.x.nm().wrapping_mul(normal_y).wrapping_sub(self.own.y.nm().wrapping_mul(normal_x));
        let along = (across >> 30).abs().saturating_add(2);
        let is_near = self.own.x.abs() + self.own.y.abs() < path.setup().radius;
        (is_near && along < radius / 16).then(|| Calm {
            per_sample: look.clearance.wrapping_sub(along.wrapping_mul(path.step().nm()).wrapping_mul(2)),
            lost: along.wrapping_mul(along).wrapping_add(radius.wrapping_mul(64)),
            per_change: radius.wrapping_mul(25) / 8,
            most: radius / 4,
        })
    }

    /// Whether the displacement at a place so many samples off is so near to the own one that its circle certainly ends above the lowest
    /// gap, or there is none.
    #[inline]
    fn moves_little(&mut self, calm: &Calm, at: usize, stride: usize) -> bool {
        let Some(by) = self.envelope.displacements.displacement(at.wrapping_sub(self.envelope.from)) else {
            return true;
        };
        let change =
            by.x.nm()
                .wrapping_sub(self.own.x.nm())
                .wrapping_abs()
                .saturating_add(by.y.nm().wrapping_sub(self.own.y.nm()).wrapping_abs());
        let lost = change.wrapping_mul(calm.per_change).wrapping_add(calm.lost);
        // The place itself is looked at anyway.
        stride == 0 || (change < calm.most && lost <= calm.per_sample.saturating_mul(stride as i64))
    }

    /// The same by arc length: samples that stand close together hide what lies beyond them.
    fn by_arc_length(&mut self, index: usize) -> usize {
        let path = self.envelope.path;
        let Some(sample) = path.samples().get(index) else { return 0 };
        let reach = Offset::from_nm(path.setup().radius.nm() / 2);
        let (mut ahead, mut back) = ([index; 2], [index; 2]);
        for eighth in 1..=EIGHTHS {
            let away = reach.scaled(Real::ratio(eighth as i64, EIGHTHS as i64));
            // About as far again as the place before.
            let next = |[before, last]: [usize; 2], s| {
                [last, path.index_near(s, last.saturating_add(last).saturating_sub(before))]
            };
            ahead = next(ahead, sample.s + away);
            self.at(ahead[1]);
            back = next(back, sample.s - away);
            self.at(back[1]);
        }
        ahead[1].saturating_sub(back[1]) / 2
    }

    /// Takes sample `at` where its circle ends deeper than the deepest so far.
    #[inline]
    fn at(&mut self, at: usize) {
        if !self.is_above(at)
            && let Some(gap) = self.gap(at)
            && gap < self.lowest
        {
            self.take(at, gap);
        }
    }

    /// Whether the circle at sample `at` certainly ends above the lowest gap, or there is none.
    #[inline]
    fn is_above(&mut self, at: usize) -> bool {
        const WITHIN: i64 = 1 << 31;
        let slot = at.wrapping_sub(self.envelope.from);
        let (Some(sample), Some(by)) = (self.samples.get(slot), self.envelope.displacements.displacement(slot)) else {
            return true;
        };
        // Of places within 4 · 10⁹ m.
        let spoke = |lowered: i64, point: i64, by: i64| lowered.wrapping_sub(point).wrapping_sub(by);
        let x = spoke(self.lowered.x.nm(), sample.point.x.nm(), by.x.nm());
        let y = spoke(self.lowered.y.nm(), sample.point.y.nm(), by.y.nm());
        if (x.wrapping_add(WITHIN) | y.wrapping_add(WITHIN)) as u64 >> 32 != 0 {
            return false;
        }
        let square = x.wrapping_mul(x).wrapping_add(y.wrapping_mul(y));
        // Along the normal, in units of 2⁻³⁰ nm; at least 8 nm, more than is cut off.
        let [normal_x, normal_y] = self.coarse;
        let ahead = x.wrapping_mul(normal_x).wrapping_add(y.wrapping_mul(normal_y));
        square >= self.clear && ahead >= 1 << 33
    }

    /// How far the circle at sample `at` ends short of the wall point, along the normal; `None` when it passes beside.
    fn gap(&mut self, at: usize) -> Option<Offset> {
        let slot = at.wrapping_sub(self.envelope.from);
        let (sample, by) = (self.samples.get(slot)?, self.envelope.displacements.displacement(slot)?);
        // On which side it is beside the normal does not matter: to the right as far as along the heading or against it.
        let (ahead, beside) = self.wall.from(sample.point + by).along_and_right(self.normal);
        let (r, beside, per_diameter) =
            (self.envelope.path.setup().radius.nm(), beside.nm(), self.envelope.per_diameter);
        let beside = beside.saturating_mul(beside);
        let square = r.saturating_mul(r).saturating_sub(beside);
        if square <= 0 {
            return None;
        }
        let root = if per_diameter > 0 {
            // Beside a wall it is short of the radius by beside²/2r and little more.
            isqrt_near(square, r.wrapping_sub(part(beside, per_diameter)), per_diameter)
        } else {
            isqrt_rounded(square.unsigned_abs().into()) as i64
        };
        Some(ahead - Offset::from_nm(root))
    }
}

/// The lowest gap within one sample of a cutter position, whose own is known; `gap` tells those of its neighbours.
pub(super) fn lowest_about(sample: usize, own: Offset, mut gap: impl FnMut(usize) -> Option<Offset>) -> Offset {
    let (Some(before), Some(after)) = (gap(sample.saturating_sub(1)), gap(sample.saturating_add(1))) else {
        return own;
    };
    let curvature = after - own + before - own;
    if (after - before).abs() > curvature + curvature {
        return own.min(before).min(after);
    }
    vertex(before, own, after)
}

/// Lowest point of the parabola through three even places, the middle one being the lowest or next to it.
fn vertex(before: Offset, lowest: Offset, after: Offset) -> Offset {
    let slope = i128::from((after - before).nm());
    let curvature = i128::from((after - lowest + before - lowest).nm());
    if curvature <= 0 {
        return lowest;
    }
    lowest
        - Offset::from_nm(truepath_units::div_rounded(slope.saturating_mul(slope), curvature.saturating_mul(8)) as i64)
}

#[cfg(test)]
mod tests {
    #![allow(clippy::arithmetic_side_effects, clippy::float_arithmetic, clippy::indexing_slicing, clippy::unwrap_used)]
    use super::*;
    use crate::cut::{CutSetup, Milling, Runout, WallLaw};
    use proptest::prelude::*;
    use std::vec::Vec;
    use truepath_units::geometry::{Block, Contour, Curve, Side};

    #[test]
    fn the_lowest_gap_is_no_farther_than_a_sample_from_the_position_that_is_asked_for() {
        let about = |gaps: [i64; 3]| {
            let gap = |at: usize| gaps.get(at).map(|nm| Offset::from_nm(*nm));
            lowest_about(1, gap(1).unwrap(), gap).nm()
        };
        // A parabola with its vertex at the position, half a sample and one sample beside it, and beyond.
        assert_eq!([about([800, 0, 800]), about([900, 100, 100]), about([400, 100, 0])], [0, 0, 0]);
        assert_eq!([about([1000, 0, -999]), about([-50, 0, 60]), about([0, 0, 0])], [-999, -50, 0]);
    }

    proptest! {
        /// A straight wall, an inside arc and an outside one; displacements from still to wild.
        #[test]
        fn places_that_are_left_out_because_little_moves_would_have_made_no_wall(
            radius in 2_000i64..10_000,
            size in 0i64..500_000,
            wave in 1.0f64..400.0,
            noise in prop::collection::vec(-1i64..=1, 600),
            roughness in prop_oneof![Just(0i64), 1i64..200, 1_000i64..100_000],
        ) {
            let setup = CutSetup {
                radius: Offset::from_um(radius),
                teeth: 4,
                helix_deg: Real::from_int(30),
                axial_depth: Real::from_int(10),
                allowance: Offset::from_um(500),
                spindle_rpm: Real::from_int(4000),
                wall: Side::Right,
                milling: Milling::of(Side::Right, true),
                law: WallLaw::Helical,
                runout: Runout::NONE,
            };
            let point = |x: i64, y: i64| Point::from_nm(x * 1_000_000, y * 1_000_000);
            let curves = [
                Curve::line(point(0, 0), point(20, 0)).unwrap(),
                Curve::arc(point(20, 0), point(32, 12), point(20, 12), true).unwrap(),
                Curve::arc(point(32, 12), point(44, 24), point(44, 12), false).unwrap(),
            ];
            let mut s = Offset::ZERO;
            let blocks: Vec<Block> = curves
                .into_iter()
                .map(|curve| {
                    let block = Block { curve, s, feed: Real::from_int(800), line: 1 };
                    s += curve.length();
                    block
                })
                .collect();
            let contour = Contour::new(&blocks).unwrap();
            let step = Offset::from_um(150);
            let mut buffer = std::vec![Sample::BLANK; Path::samples_needed(&contour, &setup, step)];
            let path = Path::sample(&contour, &setup, step, &mut buffer, |_| ()).unwrap();
            prop_assert!(path.coarse_look().clearance > 0);
            let all = path.without_clearance();
            let displacements: Vec<Vector> = (0..path.samples().len())
                .map(|i| {
                    let turn = i as f64 / wave;
                    let at = |v: f64, k: usize| (v * size as f64) as i64 + roughness * noise[(i + k) % noise.len()];
                    Vector::from_nm(at(turn.cos(), 0), at(turn.sin(), 77))
                })
                .collect();
            let [quick, thorough] = [&path, &all].map(|path| Envelope::new(path, 0, &displacements));
            for index in path.first()..path.first() + path.count() {
                prop_assert_eq!(quick.error(index, index + 1), thorough.error(index, index + 1), "{}", index);
            }
        }
    }
}
