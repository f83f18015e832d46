//! How much the wall error beside the model at one place says about that at another.
//!
//! Two kinds of likeness add up. *Local*: the same stretch of the contour, at much the same engagement. *Keyed*: another
//! stretch where the cutter is engaged alike, now and a quarter of its radius before and behind, so that what one corner
//! taught is known in the next that is like it; half of it holds whatever the direction of the wall, half only where the
//! walls are parallel, because a machine may yield otherwise along another axis.

use truepath_core::cut::{Loop, Path, State};
use truepath_core::geometry::Direction;
use truepath_core::units::Offset;
use truepath_ground::units::{float, mm};

/// A place as the kernel sees it. Nothing in it changes when the part is shifted, turned by a quarter or mirrored, but
/// the normal, which enters by its product with another one only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Feature {
    /// Arc length, mm.
    s: f64,
    /// Engagement there and a quarter of the cutter's radius before and behind, rad.
    engaged: [f64; 3],
    normal: [f64; 2],
}

/// Engagement along a path.
#[derive(Clone, Debug)]
pub(super) struct Engagement<'p> {
    path: &'p Path<'p>,
    engaged: Vec<f64>,
    from: usize,
}

/// Standard deviations of the two kinds, mm, and where the local one ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kernel {
    /// Of the local kind.
    pub(super) local: f64,
    /// Of the keyed kind.
    pub(super) keyed: f64,
    /// Length over which the local kind holds, mm.
    pub(super) reach: f64,
    /// Length of the contour where it is closed.
    pub(super) round: Option<f64>,
}

/// Engagements nearer than this are alike, rad.
const ALIKE: f64 = 0.15;
/// Length over which the local kind holds, in cutter radii: the wall is shaped by positions about that far off.
const REACH: f64 = 0.4;

impl<'p> Engagement<'p> {
    /// That of the actual cutter positions of a run.
    pub(super) fn of(path: &'p Path<'p>, from: usize, states: &[State]) -> Self {
        Self { path, engaged: states.iter().map(|state| float(state.engaged)).collect(), from }
    }

    /// That of the nominal positions, where a correction that works leads the cutter.
    pub(super) fn nominal(machine: &'p Loop<'p>) -> Self {
        let working = machine.path.working();
        let from = working.start;
        let states: Vec<State> = working
            .map(|i| {
                machine.nominal(
                    i,
                    machine
                        .coefficients
                        .chip_scale(machine.path.setup().feed_per_tooth(machine.path.samples()[i].feed)),
                )
            })
            .collect();
        Self::of(machine.path, from, &states)
    }

    /// A place with its normal.
    pub(super) fn at(&self, s: Offset, normal: Direction) -> Feature {
        let quarter = Offset::from_nm(self.path.setup().radius.nm() / 4);
        let engaged = |s: Offset| {
            let at = self.path.index_at(s).saturating_sub(self.from);
            self.engaged.get(at).or(self.engaged.last()).copied().unwrap_or(0.0)
        };
        let engaged = [engaged(s - quarter), engaged(s), engaged(s + quarter)];
        Feature { s: mm(s), engaged, normal: [float(normal.x), float(normal.y)] }
    }
}

impl Kernel {
    /// For a path.
    pub(super) fn along(path: &Path, local: f64, keyed: f64) -> Self {
        let round = path.is_closed().then(|| mm(path.length()));
        Self { local, keyed, reach: REACH * mm(path.setup().radius), round }
    }

    /// Covariance of two places, mm².
    pub(super) fn of(&self, a: &Feature, b: &Feature) -> f64 {
        let bell = |square: f64| (-0.5 * square).exp();
        let mut way = (a.s - b.s).abs();
        if let Some(length) = self.round {
            way = way.min((length - way).abs());
        }
        let load = [0, 1, 2].map(|k| ((a.engaged[k] - b.engaged[k]) / ALIKE).powi(2));
        let cosine = a.normal[0] * b.normal[0] + a.normal[1] * b.normal[1];
        let direction = 0.5 + 0.5 * cosine * cosine;
        self.local.powi(2) * bell((way / self.reach).powi(2)) * bell(load[1])
            + self.keyed.powi(2) * bell(load[0] + load[1] + load[2]) * direction
    }

    /// Variance of a place, mm².
    pub(super) fn variance(&self) -> f64 {
        self.local.powi(2) + self.keyed.powi(2)
    }
}
