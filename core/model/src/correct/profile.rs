//! The wall error over the height of the cut, and what of it a correction aims at.

use crate::cut::{Envelope, Loop, State, WallError};
use truepath_units::geometry::Vector;
use truepath_units::{Offset, Real};

/// Heights of the profile: midpoints of even slices of the band.
pub const HEIGHTS: i64 = 12;

/// The band of heights that counts, as fractions 0…1 of the engaged depth above the tip.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Band {
    /// Lower end.
    pub from: Real,
    /// Upper end.
    pub to: Real,
}

/// What the correction brings to zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Target {
    /// The uniform mean over the band.
    Mean,
    /// The error at the tip of the cutter.
    Tip,
    /// The middle between the largest and the smallest error over the band.
    Minimax,
}

/// Wall error beside one sample over the band of heights.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Profile {
    /// Mean over the band.
    pub mean: Offset,
    /// Smallest over the band (deepest).
    pub lowest: Offset,
    /// Largest over the band.
    pub highest: Offset,
    /// At the tip.
    pub tip: Offset,
    /// For every height the sample whose cutter position made the wall, counted from the one beside it, within 16 bits: the
    /// cutter's positions half a radius away are some hundred samples off.
    made_by: [i16; HEIGHTS as usize],
    /// How much deeper than `lowest` it is somewhere else in the engaged depth, nm.
    beneath: u32,
    /// Distance that the guard keeps from the deepest cut allowed, in tenths of a micrometre.
    margin: u16,
    /// Whether a wall stands there; see [`Sample::on_wall`](crate::cut::Sample::on_wall).
    pub on_wall: bool,
}

/// Step of a [margin](Profile::margin).
const MARGIN_STEP: i64 = 100;

impl Band {
    /// The whole engaged depth.
    pub const WHOLE: Self = Self { from: Real::ZERO, to: Real::ONE };

    /// Middle of the k-th of twelve even slices.
    pub fn at(self, k: i64) -> Real {
        self.from
            + (self.to - self.from) * Real::ratio(k.saturating_mul(2).saturating_add(1), HEIGHTS.saturating_mul(2))
    }

    /// Heights of the engaged depth that its slices and the tip leave out: what lies outside the band, and the top.
    pub(super) fn left_out(self) -> impl Iterator<Item = Real> {
        let outside = move |h: &Real| *h < self.from || *h > self.to;
        (0..HEIGHTS).map(|k| Self::WHOLE.at(k)).filter(outside).chain([Real::ONE])
    }
}

impl Profile {
    /// Beside a sample where a wall stands or not, of no height yet.
    pub(super) fn unread(on_wall: bool) -> Self {
        Self { lowest: Offset::MAX, highest: -Offset::MAX, on_wall, ..Self::default() }
    }
    /// The error a target aims at. `max_gouge` wins over the target: no height of the engaged depth may end deeper than it,
    /// and the [margin](Self::margin) stays free.
    pub fn aim(&self, target: Target, max_gouge: Option<Offset>) -> Offset {
        let wanted = match target {
            Target::Mean => self.mean,
            Target::Tip => self.tip,
            Target::Minimax => Offset::from_nm(self.lowest.nm().saturating_add(self.highest.nm()) / 2),
        };
        match max_gouge {
            Some(limit) => wanted.min(self.deepest() - self.margin() + limit),
            None => wanted,
        }
    }
    /// The smallest error (deepest cut) at any height of the engaged depth that was looked at: of the band and at the tip;
    /// under a guard also of what lies outside the band, and at the top.
    pub fn deepest(&self) -> Offset {
        self.lowest - Offset::from_nm(self.beneath.into())
    }
    /// The distance that the guard keeps from the deepest cut allowed. It stays when a profile is read anew.
    pub fn margin(&self) -> Offset {
        Offset::from_nm(i64::from(self.margin).saturating_mul(MARGIN_STEP))
    }
    /// Sets the margin: rounded up to 0.1 um, at most 6.5 mm.
    pub(super) fn set_margin(&mut self, margin: Offset) {
        let steps = margin.nm().max(0).saturating_add(MARGIN_STEP).saturating_sub(1).checked_div(MARGIN_STEP);
        self.margin = u16::try_from(steps.unwrap_or(0)).unwrap_or(u16::MAX);
    }
    /// Takes note of the error at a height of the band, but for the mean.
    pub(super) fn note(&mut self, error: Offset) {
        self.lowest = self.lowest.min(error);
        self.highest = self.highest.max(error);
    }
    /// Takes note of the error at a height that may lie outside the band.
    pub(super) fn deepen(&mut self, error: Offset) {
        let more = (self.lowest - error).nm();
        self.beneath = self.beneath.max(u32::try_from(more.max(0)).unwrap_or(u32::MAX));
    }
    /// What is left over height when the target is met: the larger distance from it.
    pub fn form_error(&self, target: Target) -> Offset {
        let zero = self.aim(target, None);
        (self.highest - zero).max(zero - self.lowest)
    }
    /// Adds what was read of other slices.
    pub fn join(&mut self, other: &Self) {
        self.mean += other.mean;
        self.lowest = self.lowest.min(other.lowest);
        self.highest = self.highest.max(other.highest);
        for (own, theirs) in self.made_by.iter_mut().zip(other.made_by) {
            // Either is zero where it has not read the slice.
            *own |= theirs;
        }
    }
    /// Moves the wall, where there is one, by the same at every height.
    pub(super) fn shift(&mut self, by: Offset) {
        if self.on_wall {
            self.mean += by;
            self.lowest += by;
            self.highest += by;
            self.tip += by;
        }
    }
    /// The samples, counted along the contour, whose cutter positions made the wall beside sample `index`, one for
    /// every height.
    pub fn makers(&self, index: usize) -> impl Iterator<Item = usize> + '_ {
        let shifts = self.made_by.iter().filter(|_| self.on_wall);
        shifts.filter_map(move |shift| index.checked_add_signed(*shift as isize))
    }
    /// The one of them for a slice of the band; sample `index` itself where none is known.
    pub(super) fn maker(&self, slice: i64, index: usize) -> usize {
        let shift = usize::try_from(slice).ok().and_then(|slice| self.made_by.get(slice)).copied().unwrap_or_default();
        index.checked_add_signed(shift.into()).unwrap_or(index)
    }
}

/// Adds the wall error that parts have shown beside the model: the same at every height.
pub fn add_residual(profiles: &mut [Profile], residual: &[Offset]) {
    for (p, more) in profiles.iter_mut().zip(residual) {
        p.shift(*more);
    }
}

/// Reads the profile off the wall beside each sample of the contour.
///
/// `states` belong to the path's working range; `profiles` to the contour's own samples; `displacements` is as long
/// as `states`.
pub fn profile(machine: &Loop, states: &[State], band: Band, displacements: &mut [Vector], profiles: &mut [Profile]) {
    begin(machine, profiles);
    for k in 0..HEIGHTS {
        Envelope::displace(machine, states, band.at(k), displacements);
        read_slice(machine, k, displacements, profiles);
    }
    Envelope::displace(machine, states, Real::ZERO, displacements);
    finish(machine, displacements, profiles);
}

/// Begins to read profiles: nothing is known of the walls but where there are any.
pub fn begin(machine: &Loop, profiles: &mut [Profile]) {
    for (p, sample) in profiles.iter_mut().zip(machine.path.samples().iter().skip(machine.path.first())) {
        let (margin, on_wall) = (p.margin, sample.on_wall);
        *p = Profile { margin, ..Profile::unread(on_wall) };
    }
}

/// Reads one of the [`HEIGHTS`] slices of the band off the cutter positions at its height. They do not depend on each other: read in
/// parts and [joined](Profile::join) they are the same.
pub fn read_slice(machine: &Loop, slice: i64, displacements: &[Vector], profiles: &mut [Profile]) {
    read(machine, displacements, profiles, |index, p, wall| {
        if let Some(slot) = p.made_by.get_mut(slice as usize) {
            let shift = (wall.made_by as i64).saturating_sub(index as i64);
            *slot = shift.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
        }
        p.mean += wall.error;
        p.note(wall.error);
    });
}

/// Ends with the tip, by the cutter positions there, when all slices are read.
pub fn finish(machine: &Loop, displacements: &[Vector], profiles: &mut [Profile]) {
    read(machine, displacements, profiles, |_, p, wall| {
        p.tip = wall.error;
        p.deepen(wall.error);
    });
    for p in profiles.iter_mut() {
        if !p.on_wall {
            *p = Profile { margin: p.margin, ..Profile::default() };
        }
        p.mean = p.mean.scaled(Real::ratio(1, HEIGHTS));
        p.shift(machine.undersize);
    }
}

/// Looks for the deepest cut at the heights of the engaged depth that [`profile`] left out: the top, and what lies outside
/// the band.
pub(super) fn deepen(
    machine: &Loop,
    states: &[State],
    band: Band,
    displacements: &mut [Vector],
    profiles: &mut [Profile],
) {
    for height in band.left_out() {
        Envelope::displace(machine, states, height, displacements);
        read(machine, displacements, profiles, |_, p, wall| p.deepen(wall.error));
    }
}

/// Hands the wall error at the height of cutter positions to every profile where a wall stands, with the index of its sample.
fn read(
    machine: &Loop,
    displacements: &[Vector],
    profiles: &mut [Profile],
    mut take: impl FnMut(usize, &mut Profile, &WallError),
) {
    let path = machine.path;
    let envelope = Envelope::new(path, path.working().start, displacements);
    let mut guess = path.first();
    for (i, p) in profiles.iter_mut().enumerate() {
        let index = path.first().saturating_add(i);
        let Some(wall) = envelope.error(index, guess).filter(|_| p.on_wall) else { continue };
        guess = wall.made_by.saturating_add(1);
        take(index, p, &wall);
    }
}
