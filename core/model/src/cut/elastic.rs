//! The closed elastic loop: the cut is less deep because the tool yields.
//!
//! `a = p + C·F(engagement at a)` (P23 fig. 2; physics of a machine closed through the cut): the force is that of the
//! actual centre `a`, in the frame of its nominal place. Solved at every sample by a few steps of fixed-point
//! iteration with a secant (Anderson, depth one), warm-started from the sample before. Every solution reports what is
//! left; the iteration is bounded and cannot hang.

use super::compliance::Compliance;
use super::engagement::Exit;
use super::force::{Basis, Flutes, ForceTable, SplitForce, stretches};
use super::path::Path;
use super::setup::{Coefficients, Runout, WallLaw};
use super::teeth::Teeth;
use truepath_units::geometry::{Direction, Vector};
use truepath_units::{Offset, Real, div_rounded};

/// The cutter at one sample of the path.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct State {
    /// Commanded displacement from the nominal centre.
    pub commanded: Vector,
    /// Displacement by the mean force over a revolution, averaged over the engaged depth.
    pub displacement: Vector,
    /// Engagement angle φ₁, rad.
    pub engaged: Real,
    /// Normal towards the wall at the nominal place of the actual centre.
    pub normal: Direction,
    /// Chip scale of the programmed feed; see [`Coefficients::chip_scale`].
    pub chip_scale: Real,
    /// What the elastic loop left unsolved.
    pub residual: Offset,
}

/// A machine at work on a path: everything the elastic loop needs.
#[derive(Clone, Copy, Debug)]
pub struct Loop<'a> {
    /// The path and its stock.
    pub path: &'a Path<'a>,
    /// Force of the cutter.
    pub table: &'a ForceTable,
    /// Force coefficients; their size exponent is the one the table was made for.
    pub coefficients: Coefficients,
    /// Compliance of machine and cutter.
    pub compliance: Compliance,
    /// How much smaller than stated the cutter makes the wall (worn; negative: runout that nobody stated), the same
    /// everywhere. It moves the wall; engagement and force do not feel it.
    pub undersize: Offset,
}

/// Summary of a run of the loop.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Passage {
    /// Samples at which the loop did not reach its tolerance.
    pub unsettled: u32,
    /// The largest residual.
    pub worst_residual: Offset,
}

/// Heights at which walls are read together, as fractions 0…1 of the engaged depth above the tip, and what is kept of them from place to
/// place, of one machine.
#[derive(Clone, Debug)]
pub struct Heights<const N: usize> {
    fractions: [Real; N],
    /// Those of the compliance there.
    factors: [Real; N],
    flutes: [Flutes; N],
    teeth: Teeth,
    /// The antiderivatives at the end of an arc, and which.
    end: Option<(Real, Basis)>,
}

impl<const N: usize> Heights<N> {
    /// Of a machine, and no place yet.
    pub fn new(machine: &Loop, fractions: [Real; N]) -> Self {
        let factors = fractions.map(|fraction| machine.compliance.height_factor(fraction));
        Self { fractions, factors, flutes: [Flutes::NONE; N], teeth: Teeth::BLANK, end: None }
    }
}

/// What is kept of a state for the next one of the same machine.
#[derive(Clone, Copy, Debug, Default)]
pub struct Kept {
    feed: Option<Real>,
    /// That of the feed.
    chip_scale: Real,
    exit: Exit,
}

/// Iterations of the loop at one sample.
const MAX_ITERATIONS: u32 = 40;
/// Residual at which the loop counts as solved.
const TOLERANCE: Offset = Offset::from_nm(5);
/// Residual above which a sample is reported as unsettled.
const UNSETTLED: Offset = Offset::from_nm(500);

impl Passage {
    /// Of these samples and others.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self {
            unsettled: self.unsettled.saturating_add(other.unsettled),
            worst_residual: self.worst_residual.max(other.worst_residual),
        }
    }
}

impl State {
    /// Before any sample was solved.
    pub const REST: Self = Self {
        commanded: Vector::ZERO,
        displacement: Vector::ZERO,
        engaged: Real::ZERO,
        normal: Direction::X,
        chip_scale: Real::ZERO,
        residual: Offset::ZERO,
    };
}

impl Loop<'_> {
    /// Solves the loop at a sample for a commanded displacement, from a first guess of the deflection.
    /// Returns the state and the number of iterations.
    pub fn settle(&self, index: usize, commanded: Vector, guess: Vector, chip_scale: Real) -> (State, u32) {
        self.settle_about(index, commanded, guess, chip_scale, &mut Exit::default())
    }

    /// The same, with what is kept of the last engagement.
    fn settle_about(
        &self,
        index: usize,
        commanded: Vector,
        guess: Vector,
        chip_scale: Real,
        exit: &mut Exit,
    ) -> (State, u32) {
        let mut x = guess;
        let mut before: Option<(Vector, Vector)> = None;
        let mut state = State { commanded, chip_scale, ..State::REST };
        for iteration in 1..=MAX_ITERATIONS {
            let Some((engaged, normal, push)) = self.push(index, commanded + x, chip_scale, exit) else {
                if let Some((_, residual)) = before {
                    state.residual = residual.length();
                }
                return (state, iteration);
            };
            let residual = push - x;
            state = State { displacement: push, engaged, normal, ..state };
            // Longer than the tolerance is what is longer along an axis: roots are needed only near the end.
            if residual.x.abs().max(residual.y.abs()) <= TOLERANCE || iteration == MAX_ITERATIONS {
                state.residual = residual.length();
                if state.residual <= TOLERANCE {
                    return (state, iteration);
                }
            }
            let step = match before {
                None => residual,
                Some((x0, r0)) => mixed(residual, residual - r0, x - x0),
            };
            before = Some((x, residual));
            x = x + step;
        }
        (state, MAX_ITERATIONS)
    }

    /// Whether another machine cuts the same wall on the same path.
    pub fn cuts_as(&self, other: &Self) -> bool {
        let facts = |machine: &Self| (machine.coefficients, machine.compliance, machine.undersize);
        facts(self) == facts(other)
    }

    fn mean(&self, engaged: Real) -> SplitForce {
        self.table.mean((self.path.setup(), self.path.helix()), &self.coefficients, engaged)
    }

    /// Engagement, normal and mean deflection for a centre displaced from a sample.
    fn push(
        &self,
        index: usize,
        displacement: Vector,
        chip_scale: Real,
        exit: &mut Exit,
    ) -> Option<(Real, Direction, Vector)> {
        let frame = self.path.frame(index, displacement)?;
        let engaged = self.path.engagement_about(index, displacement, &frame, exit);
        let force = self.mean(engaged).total(chip_scale);
        let push = self.compliance.displacement(frame.normal, frame.heading, force);
        Some((engaged, frame.normal, push.scaled(self.compliance.mean_factor())))
    }

    /// Runs the loop over samples `from..from + states.len()`; `commanded` gives the commanded displacement of each.
    pub fn run(&self, from: usize, states: &mut [State], commanded: impl FnMut(usize) -> Vector) -> Passage {
        let mut guess = Vector::ZERO;
        self.run_on(from, (&mut guess, None), states, commanded, |_, _| ())
    }

    /// The same behind samples that were run before: `guess` is the deflection with which they ended, and becomes that with which
    /// these end.
    ///
    /// `before` is that with which they ended when this machine left `states` here last; `None` where it has not. A state is that of a
    /// command and a guess: where both are what they were, it is kept. `seen` is told every sample, and whether its state may have changed.
    pub fn run_on(
        &self,
        from: usize,
        (guess, mut before): (&mut Vector, Option<Vector>),
        states: &mut [State],
        mut commanded: impl FnMut(usize) -> Vector,
        mut seen: impl FnMut(usize, bool),
    ) -> Passage {
        let mut passage = Passage::default();
        let mut kept = Kept::default();
        for (k, slot) in states.iter_mut().enumerate() {
            let index = from.saturating_add(k);
            let command = commanded(index);
            let old = *slot;
            if before != Some(*guess) || old.commanded != command {
                let Some((state, _)) = self.state(&mut kept, index, command, *guess) else { break };
                *slot = state;
            }
            seen(index, before.is_none() || *slot != old);
            passage.unsettled = passage.unsettled.saturating_add(u32::from(slot.residual > UNSETTLED));
            passage.worst_residual = passage.worst_residual.max(slot.residual);
            if !self.path.is_pivot(index) {
                *guess = slot.displacement;
                before = before.map(|_| old.displacement);
            }
        }
        passage
    }

    /// The state at a sample for a commanded displacement, from a first guess of the deflection, and the number of iterations: 0 where
    /// the path turns on the spot. `None` beyond the path.
    #[inline]
    pub fn state(&self, kept: &mut Kept, index: usize, commanded: Vector, guess: Vector) -> Option<(State, u32)> {
        let sample = self.path.samples().get(index)?;
        if kept.feed != Some(sample.feed) {
            kept.feed = Some(sample.feed);
            kept.chip_scale = self.coefficients.chip_scale(self.path.setup().feed_per_tooth(sample.feed));
        }
        let chip_scale = kept.chip_scale;
        if self.path.is_pivot(index) {
            // Nothing is cut on the spot: the machine stands, and the cutter springs back to where it was sent.
            return Some((State { commanded, normal: sample.normal, chip_scale, ..State::REST }, 0));
        }
        Some(self.settle_about(index, commanded, guess, chip_scale, &mut kept.exit))
    }

    /// The state of an undisplaced cutter: the engagement the program intends.
    pub fn nominal(&self, index: usize, chip_scale: Real) -> State {
        let Some((engaged, normal, displacement)) = self.push(index, Vector::ZERO, chip_scale, &mut Exit::default())
        else {
            return State::REST;
        };
        State { engaged, normal, displacement, chip_scale, ..State::REST }
    }

    /// Mean force over a revolution in a state, (normal, tangential), N.
    pub fn mean_force(&self, state: &State) -> (Real, Real) {
        self.mean(state.engaged).total(state.chip_scale)
    }

    /// Displacement of the cutter from the nominal centre at the instant it makes the wall at a height, given as a
    /// fraction 0…1 of the engaged depth above the tip. With runout the tooth counts that ends deepest, with its reach.
    pub fn at_height(&self, teeth: &mut Teeth, state: &State, fraction: Real) -> Vector {
        let (force, reach) = self.made_by(teeth, state, fraction);
        state.commanded + self.displaced(state, fraction, force.total(state.chip_scale)) + reach
    }

    /// [`at_height`](Self::at_height) at several heights of a place, which cost less together.
    pub fn at_heights<const N: usize>(&self, heights: &mut Heights<N>, state: &State) -> [Vector; N] {
        self.deflections(heights, state).map(|deflection| state.commanded + deflection)
    }

    /// What the cutter is deflected by at several heights of a place, with the reach of the tooth that makes the wall.
    pub fn deflections<const N: usize>(&self, heights: &mut Heights<N>, state: &State) -> [Vector; N] {
        if self.is_even() {
            let push = self.pushed(state, self.mean(state.engaged));
            return heights.factors.map(|factor| push.scaled(factor));
        }
        let mut known = [Vector::ZERO; N];
        for (height, slot) in known.iter_mut().enumerate() {
            *slot = self.deflection(heights, height, state);
        }
        known
    }

    /// That at one of the heights.
    pub fn deflection<const N: usize>(&self, heights: &mut Heights<N>, height: usize, state: &State) -> Vector {
        let Heights { fractions, factors, flutes, teeth, end } = heights;
        let (Some(fraction), Some(factor), Some(flutes)) =
            (fractions.get(height), factors.get(height), flutes.get_mut(height))
        else {
            return Vector::ZERO;
        };
        let mut known = end.filter(|(angle, _)| *angle == state.engaged).map(|(_, basis)| basis);
        let alike = self.force_at((flutes, &mut known), state, *fraction);
        *end = known.map(|basis| (state.engaged, basis));
        let is_true = self.path.setup().runout == Runout::NONE;
        let (force, reach) = if is_true { (alike, Vector::ZERO) } else { self.longest(teeth, state, *fraction, alike) };
        self.pushed(state, force).scaled(*factor) + reach
    }

    /// Whether the force is the same at all heights.
    fn is_even(&self) -> bool {
        self.path.setup().law == WallLaw::Mean && self.path.setup().runout == Runout::NONE
    }

    /// What a force displaces the cutter by where the compliance is one.
    fn pushed(&self, state: &State, force: SplitForce) -> Vector {
        let heading = self.path.setup().wall.heading(state.normal);
        self.compliance.displacement(state.normal, heading, force.total(state.chip_scale))
    }

    /// Deflection at a height: (its chip part, the whole with the reach of the tooth that makes the wall).
    pub fn deflection_parts(&self, teeth: &mut Teeth, state: &State, fraction: Real) -> (Vector, Vector) {
        let (force, reach) = self.made_by(teeth, state, fraction);
        let chip = (force.chip_n * state.chip_scale, force.chip_t * state.chip_scale);
        let whole = force.total(state.chip_scale);
        (self.displaced(state, fraction, chip), self.displaced(state, fraction, whole) + reach)
    }

    /// The force at the instant the wall at a height is made, and how much farther the tooth reaches that makes it.
    fn made_by(&self, teeth: &mut Teeth, state: &State, fraction: Real) -> (SplitForce, Vector) {
        let alike = self.force_at((&mut teeth.flutes, &mut None), state, fraction);
        if self.path.setup().runout == Runout::NONE {
            return (alike, Vector::ZERO);
        }
        self.longest(teeth, state, fraction, alike)
    }

    /// The same where teeth do not reach equally far; `alike` is the force if they did.
    fn longest(&self, teeth: &mut Teeth, state: &State, fraction: Real, alike: SplitForce) -> (SplitForce, Vector) {
        let (setup, helix) = (self.path.setup(), self.path.helix());
        teeth.set(setup, &self.coefficients, state.chip_scale);
        if setup.law == WallLaw::Helical && state.chip_scale > Real::ZERO {
            teeth.immerse(setup, stretches((setup, helix), state.engaged, setup.axial_depth * fraction));
        }
        let mut deepest: Option<(Offset, SplitForce, Offset)> = None;
        for (reach, more) in teeth.makers(setup, &self.coefficients, helix.mm_per_lag) {
            let force = alike.plus(more);
            let end = self.displaced(state, fraction, force.total(state.chip_scale)).along(state.normal) + reach;
            if deepest.is_none_or(|(farthest, ..)| end > farthest) {
                deepest = Some((end, force, reach));
            }
        }
        deepest.map_or((alike, Vector::ZERO), |(_, force, reach)| (force, state.normal.times(reach)))
    }

    /// The force at the instant the wall at a height is made.
    fn force_at(&self, known: (&mut Flutes, &mut Option<Basis>), state: &State, fraction: Real) -> SplitForce {
        let setup = self.path.setup();
        match setup.law {
            WallLaw::Mean => self.mean(state.engaged),
            WallLaw::Helical => self.table.at_height_again(
                (setup, self.path.helix()),
                &self.coefficients,
                state.engaged,
                setup.axial_depth * fraction,
                known,
            ),
        }
    }

    /// What a force (normal, tangential) displaces the cutter by at a height.
    fn displaced(&self, state: &State, fraction: Real, force: (Real, Real)) -> Vector {
        let heading = self.path.setup().wall.heading(state.normal);
        self.compliance.displacement(state.normal, heading, force).scaled(self.compliance.height_factor(fraction))
    }
}

/// Anderson mixing of depth one: the residual less its share along the last change.
pub(crate) fn mixed(residual: Vector, change: Vector, last_step: Vector) -> Vector {
    let norm = change.dot(change);
    let gamma = Real::narrow(div_rounded(residual.dot(change) << Real::FRACTION_BITS, norm));
    let limit = Real::from_int(4);
    let gamma = gamma.min(limit).max(-limit);
    residual - (last_step + change).scaled(gamma)
}
