//! What was probed, and what the model says the probe should have found there.

use super::parameters::{COUNT, Parameters};
use crate::cut::{Displacements, Envelope, ForceTable, Kept, Loop, Path, Sought, State, Teeth};
use truepath_units::geometry::{Direction, Vector};
use truepath_units::{Offset, Real, hypot_nm};

/// One reading of the wall: a probe point on the contour, a width between it and the wall across, or one of the two halves
/// of a width between two contours.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Observation {
    /// Arc length of the contour.
    pub s: Offset,
    /// Height above the tip as a fraction 0…1 of the engaged depth.
    pub height: Real,
    /// Measured wall error: positive, material left.
    pub error: Offset,
    /// Standard deviation of the measurement.
    pub noise: Offset,
    /// Nominal normal towards the wall.
    pub normal: Direction,
    /// Arc length of the other wall of a width; of a point its own, which costs a device half the memory of an option; of a half
    /// [`PAIRED`] with the number of the pair.
    other: Offset,
    /// Predicted error of the last evaluation.
    pub predicted: Offset,
    /// Prediction at the point about which a fit differentiates, nm, within ±2.1 mm: what is farther off is no wall, and a device has
    /// memory for so much.
    base: i32,
    /// The samples whose cutter positions made the wall there, and that across, counted from those beside; [`NOBODY`] where none is known.
    made_by: [i16; 2],
    /// Weight given by the robust loss, 0…1.
    pub weight: Real,
    /// Factor on the deviation of the points of a fit, found by it; 1 before.
    pub spread: Real,
    /// Sensitivities: change of the predicted error per prior standard deviation, in standard deviations of the point.
    pub sensitivity: [Real; COUNT],
}

/// No sample.
const NOBODY: i16 = i16::MIN;

/// A bit that no arc length has, nm.
const PAIRED: i64 = 1 << 60;

impl Observation {
    /// A measurement that has not been looked at.
    pub const fn new(s: Offset, height: Real, error: Offset, noise: Offset, normal: Direction) -> Self {
        Self {
            s,
            height,
            error,
            noise,
            normal,
            other: s,
            predicted: Offset::ZERO,
            base: 0,
            made_by: [NOBODY; 2],
            weight: Real::ONE,
            spread: Real::ONE,
            sensitivity: [Real::ZERO; COUNT],
        }
    }

    /// The same as the mean of the errors here and at the wall across.
    #[must_use]
    pub const fn with_across(self, across: Offset) -> Self {
        Self { other: across, ..self }
    }

    /// One of the two halves of a width between two contours. Each is an observation of its own contour, at its own wall, with
    /// the mean of both errors; `pair` is a number that they alone share. Of the two readings in place of one each has
    /// √2 times its standard deviation.
    #[must_use]
    pub const fn paired(self, pair: u32) -> Self {
        Self { other: Offset::from_nm(PAIRED | pair as i64), ..self }
    }

    /// Arc length of the wall across, whose normal is the opposite one, where the reading is a width of one contour: a calliper
    /// sees the mean of both errors, at one height, and no shift of the datum.
    pub fn across(&self) -> Option<Offset> {
        (!self.is_point() && self.pair().is_none()).then_some(self.other)
    }

    /// The pair that the reading is a half of.
    pub fn pair(&self) -> Option<u32> {
        u32::try_from(self.other.nm() ^ PAIRED).ok()
    }

    /// Whether it sees one wall.
    fn is_point(&self) -> bool {
        self.other == self.s
    }

    /// What it counts among readings: of a pair each half is half of one.
    pub(super) fn counts(&self) -> Real {
        if self.pair().is_some() { Real::HALF } else { Real::ONE }
    }

    /// What a shift of the datum by a millimetre along x and along y does to the reading, mm: it makes a wall that it
    /// brings nearer look cut deeper; of two walls across from each other it takes as much as it gives.
    pub fn by_datum(&self) -> [Real; 2] {
        if self.is_point() { [-self.normal.x, -self.normal.y] } else { [Real::ZERO; 2] }
    }
}

/// The share of an error that the model may miss, added to the noise of a point.
const MODEL_SHARE: Real = Real::ratio(1, 100);

/// Residual, in standard deviations, from which a point loses weight (Huber's constant).
const HUBER: Real = Real::ratio(25, 10);

impl Observation {
    /// Sets the weight for the residual and returns what it costs: quadratic near zero, linear in the tails (Huber's loss),
    /// and level beyond a gate, where the point has no weight. A wrong point must not bend the fit of the others.
    pub(super) fn weigh(&mut self, gate: Real) -> Real {
        let residual = self.residual().abs();
        let (weight, cost) = if residual <= HUBER {
            (Real::ONE, residual * residual)
        } else if residual > gate {
            (Real::ZERO, HUBER * (gate + gate - HUBER))
        } else {
            (HUBER / residual, HUBER * (residual + residual - HUBER))
        };
        self.weight = weight;
        cost
    }
    /// Keeps the prediction aside, and gives what is kept back.
    pub(super) fn keep(&mut self) {
        self.base = self.predicted.nm().clamp(i32::MIN.into(), i32::MAX.into()) as i32;
    }
    pub(super) fn kept(&self) -> Offset {
        Offset::from_nm(self.base.into())
    }
    /// Standard deviation of measured − predicted at the right parameters: probe noise and what the model may miss.
    pub fn deviation(&self) -> Offset {
        hypot_nm(self.noise, self.error.scaled(MODEL_SHARE)).scaled(self.spread).max(Offset::from_nm(1))
    }
    /// Whether the robust loss has set the point aside: a weight below 0.3.
    pub fn is_outlying(&self) -> bool {
        self.weight < Real::ratio(3, 10)
    }
    /// Measured − predicted, in standard deviations.
    pub fn residual(&self) -> Real {
        (self.error - self.predicted).over(self.deviation())
    }
}

/// Where the cutter position is looked for that makes a wall.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Search {
    /// As far as one may be.
    Everywhere,
    /// Beside the one that made it in the prediction before, of a machine that differs little: its difference quotients are those of one
    /// wall.
    Nearby,
}

/// Who predicts the points of a fit: one place after the other in lent buffers ([`PredictionWorkspace`]), or several at a time where
/// there are several processors. The points of a place stand together, and no place knows of another.
pub trait Predictor {
    /// As [`predict`].
    fn predict(
        &mut self,
        path: &Path,
        table: &ForceTable,
        parameters: &Parameters,
        search: Search,
        commanded: impl Fn(usize) -> Vector + Copy + Sync,
        observations: &mut [Observation],
    );
}

impl Predictor for PredictionWorkspace<'_> {
    fn predict(
        &mut self,
        path: &Path,
        table: &ForceTable,
        parameters: &Parameters,
        search: Search,
        commanded: impl Fn(usize) -> Vector + Copy + Sync,
        observations: &mut [Observation],
    ) {
        let machine = parameters.machine(path, table);
        let mut here = Neighbourhood::default();
        for observation in observations.iter_mut() {
            let [mut own, mut across] = match search {
                Search::Everywhere => [NOBODY; 2],
                Search::Nearby => observation.made_by,
            };
            let mut wall = |s, maker: &mut i16| here.wall(&machine, &commanded, (s, observation.height), maker, self);
            let error = wall(observation.s, &mut own);
            // A datum that moved towards the wall makes the wall look cut deeper by its share along the normal.
            observation.predicted = match observation.across() {
                None if observation.is_point() => {
                    error + parameters.undersize - parameters.datum.along(observation.normal)
                }
                None => error + parameters.undersize,
                Some(s) => (error + wall(s, &mut across)).scaled(Real::HALF) + parameters.undersize,
            };
            // Of difference quotients either side begins at the same.
            if search == Search::Everywhere {
                observation.made_by = [own, across];
            }
        }
    }
}

/// Buffers for the prediction of probe points, lent by the caller. Both as long as
/// [`PredictionWorkspace::needed`] says.
#[derive(Debug)]
pub struct PredictionWorkspace<'a> {
    /// States of the elastic loop around a probed place.
    pub states: &'a mut [State],
    /// Cutter positions at a height.
    pub displacements: &'a mut [Vector],
}

impl PredictionWorkspace<'_> {
    /// Length of the buffers for a path: the reach of the envelope to both sides of a place.
    pub fn needed(path: &Path) -> usize {
        let reach = reach(path).nm();
        // Samples may be closer together than the step on short blocks.
        path.samples()
            .iter()
            .enumerate()
            .map(|(i, s)| {
                path.index_at(s.s + Offset::from_nm(reach)).saturating_sub(i).saturating_mul(2).saturating_add(4)
            })
            .max()
            .unwrap_or(0)
    }
}

/// How far to either side of a place the cutter is followed to predict the wall there.
fn reach(path: &Path) -> Offset {
    path.setup().radius.scaled(Real::ratio(3, 10)).max(Offset::from_um(1_000))
}

/// Predicts the wall error at every observation and writes it into `predicted`. Observations of one place should
/// stand together: where the cutter is, is found once for them.
///
/// `commanded` is the displacement the program commanded at each sample of the path (zero for an uncorrected part). A half
/// of a width between two contours is given its own wall: [`join_pairs`] makes it what the width sees.
pub fn predict(
    path: &Path,
    table: &ForceTable,
    parameters: &Parameters,
    commanded: impl Fn(usize) -> Vector + Copy + Sync,
    observations: &mut [Observation],
    workspace: &mut PredictionWorkspace,
) {
    workspace.predict(path, table, parameters, Search::Everywhere, commanded, observations);
}

/// Gives both halves of every pair, of which each has the prediction of its own wall, the mean of the two.
#[inline(never)]
pub fn join_pairs(observations: &mut [Observation]) {
    let mut rest = observations;
    while let Some((half, others)) = rest.split_first_mut() {
        if half.pair().is_some()
            && let Some(other) = others.iter_mut().find(|other| other.pair() == half.pair())
        {
            let mean = (half.predicted + other.predicted).scaled(Real::HALF);
            (half.predicted, other.predicted) = (mean, mean);
        }
        rest = others;
    }
}

/// The stretch of the path around a place where the cutter was last asked for.
#[derive(Default)]
struct Neighbourhood {
    place: Option<(Offset, usize, usize)>,
    /// The last deflection that was found.
    guess: Vector,
    kept: Kept,
}

impl Neighbourhood {
    /// The wall error that a machine leaves at a place and a height. The cutter is found where the envelope looks: the loop does not
    /// remember how it came to a place, and settles from any deflection nearby. `maker` is the sample whose cutter position is known to
    /// make it nearly, counted from that beside, and becomes the one that does.
    fn wall(
        &mut self,
        machine: &Loop,
        commanded: &impl Fn(usize) -> Vector,
        (s, height): (Offset, Real),
        maker: &mut i16,
        workspace: &mut PredictionWorkspace,
    ) -> Offset {
        let path = machine.path;
        let (from, count) = match self.place {
            Some((place, from, count)) if place == s => (from, count),
            _ => {
                let working = path.working();
                let from = path.index_at(s - reach(path)).max(working.start);
                let to = path.index_at(s + reach(path)).min(working.end).max(from);
                let count = to.saturating_sub(from).saturating_add(1).min(workspace.states.len());
                workspace.states.get_mut(..count).unwrap_or_default().fill(UNKNOWN);
                // No place knows of another.
                (self.place, self.guess) = (Some((s, from, count)), Vector::ZERO);
                (from, count)
            }
        };
        let states = workspace.states.get_mut(..count).unwrap_or_default();
        let displacements = workspace.displacements.get_mut(..count).unwrap_or_default();
        let Self { guess, kept, .. } = self;
        let state = |slot: usize| {
            let known = states.get_mut(slot)?;
            if *known == UNKNOWN {
                let index = from.saturating_add(slot);
                let (state, iterations) = machine.state(kept, index, commanded(index), *guess)?;
                *known = state;
                if iterations > 0 {
                    *guess = state.displacement;
                }
            }
            Some(*known)
        };
        let mut teeth = Teeth::BLANK;
        let sought = Sought::new(machine, state, height, (&mut teeth, displacements));
        let (error, made_by) = wall_at(path, Envelope::of(path, from, sought), s, *maker);
        *maker = made_by;
        error
    }
}

/// A state that nobody has asked for: nothing is commanded so far away.
const UNKNOWN: State = State { commanded: Vector { x: Offset::MAX, y: Offset::MAX }, ..State::REST };

/// The wall error at an arc length, between the two samples that enclose it, and the sample whose cutter position made it at the first,
/// counted from that; it is looked for beside one that is known.
fn wall_at(path: &Path, mut envelope: Envelope<'_, impl Displacements>, s: Offset, near: i16) -> (Offset, i16) {
    let after = path.samples().partition_point(|x| x.s <= s);
    let before = after.saturating_sub(1);
    let first = match before.checked_add_signed(near.into()) {
        Some(maker) if near != NOBODY => envelope.read_next(before, maker),
        _ => envelope.read(before, before),
    };
    let made_by = first.map_or(NOBODY, |wall| {
        let shift = (wall.made_by as i64).saturating_sub(before as i64);
        i16::try_from(shift).unwrap_or(NOBODY)
    });
    let (Some(a), Some(b)) = (path.samples().get(before), path.samples().get(after)) else {
        return (first.map_or(Offset::ZERO, |wall| wall.error), made_by);
    };
    let u = (s - a.s).over(b.s - a.s);
    let second = match first {
        Some(wall) => envelope.read_next(after, wall.made_by.saturating_add(1)),
        None => envelope.read(after, after),
    };
    let error = match (first.map(|wall| wall.error), second.map(|wall| wall.error)) {
        (Some(ea), Some(eb)) => ea + (eb - ea).scaled(u),
        (ea, eb) => ea.or(eb).unwrap_or_default(),
    };
    (error, made_by)
}
