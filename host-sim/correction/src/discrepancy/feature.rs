//! A place as the kernel sees it.

use truepath_core::cut::{Path, State};
use truepath_core::geometry::Direction;
use truepath_core::units::Offset;
use truepath_ground::units::{float, mm};

/// A place of a contour. Nothing in it changes when the part is shifted, turned by a quarter or mirrored, but the normal,
/// which enters by its product with another one only.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feature {
    /// The contour, counted among those of the part.
    pub(super) contour: usize,
    /// Arc length, mm.
    pub(super) s: f64,
    /// Engagement there and a quarter of the cutter's radius before and behind, rad.
    pub(super) engaged: [f64; 3],
    pub(super) normal: [f64; 2],
    /// Change of the wall error when force or compliance is larger there, mm per unit of the natural logarithm.
    pub(super) load: f64,
    /// Change of the wall error when the allowance is larger there, mm per mm.
    pub(super) stock: f64,
}

/// What the load does to the wall error of a place.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Sensitivity {
    /// When force or compliance is larger, mm per unit of the natural logarithm.
    pub load: f64,
    /// When the allowance is larger, mm per mm.
    pub stock: f64,
}

/// Engagement along a path.
#[derive(Clone, Debug)]
pub struct Engagement<'p> {
    path: &'p Path<'p>,
    contour: usize,
    engaged: Vec<f64>,
    from: usize,
}

impl<'p> Engagement<'p> {
    /// That of cutter positions, from sample `from` on: the actual ones of a run, or the nominal ones, where a correction that works leads
    /// the cutter.
    pub fn of(path: &'p Path<'p>, contour: usize, from: usize, states: &[State]) -> Self {
        Self { path, contour, engaged: states.iter().map(|state| float(state.engaged)).collect(), from }
    }

    /// A place with its normal and what the load does to it.
    pub fn at(&self, s: Offset, normal: Direction, sensitivity: Sensitivity) -> Feature {
        let quarter = Offset::from_nm(self.path.setup().radius.nm() / 4);
        let engaged = |s: Offset| {
            let at = self.path.index_at(s).saturating_sub(self.from);
            self.engaged.get(at).or(self.engaged.last()).copied().unwrap_or(0.0)
        };
        let engaged = [engaged(s - quarter), engaged(s), engaged(s + quarter)];
        let normal = [float(normal.x), float(normal.y)];
        let Sensitivity { load, stock } = sensitivity;
        Feature { contour: self.contour, s: mm(s), engaged, normal, load, stock }
    }
}
