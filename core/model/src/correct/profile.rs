//! The wall error over the height of the cut, and what of it a correction aims at.

use crate::cut::{Displacements, Envelope, Loop, Sought, State, Teeth, WallError};
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
    /// Whether it has been read since a cutter position near it moved: only others are read.
    is_current: bool,
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
    /// Whether it need not be read.
    pub(super) const fn is_current(&self) -> bool {
        self.is_current
    }
    /// Says that it need, or need not, be read.
    pub(super) const fn set_current(&mut self, is_current: bool) {
        self.is_current = is_current;
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
    /// Takes the wall at a height beside sample `index`.
    fn take(&mut self, height: Height, index: usize, wall: &WallError) {
        match height {
            Height::Slice(slice) => {
                if let Some(slot) = self.made_by.get_mut(slice as usize) {
                    let shift = (wall.made_by as i64).saturating_sub(index as i64);
                    *slot = shift.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
                }
                self.mean += wall.error;
                self.note(wall.error);
            }
            Height::Tip => {
                self.tip = wall.error;
                self.deepen(wall.error);
            }
            Height::LeftOut => self.deepen(wall.error),
        }
    }
    /// What is left over height when the target is met: the larger distance from it.
    pub fn form_error(&self, target: Target) -> Offset {
        let zero = self.aim(target, None);
        (self.highest - zero).max(zero - self.lowest)
    }
    /// Adds what was read of other slices.
    pub fn join(&mut self, other: &Self) {
        if self.is_current {
            return;
        }
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

/// Adds the wall error that parts have shown beside the model: the same at every height. The profiles that were read have then been
/// read.
pub fn add_residual(profiles: &mut [Profile], residual: &[Offset]) {
    let more = residual.iter().copied().chain(core::iter::repeat(Offset::ZERO));
    for (p, more) in profiles.iter_mut().zip(more).filter(|(p, _)| !p.is_current) {
        p.shift(more);
        p.is_current = true;
    }
}

/// Reads the profile off the wall beside each sample of the contour, where it is not current.
///
/// `states` belong to the path's working range; `profiles` to the contour's own samples; `displacements` is as long
/// as `states`.
pub fn profile(machine: &Loop, states: &[State], band: Band, displacements: &mut [Vector], profiles: &mut [Profile]) {
    begin(machine, profiles);
    for k in 0..HEIGHTS {
        at_height(machine, (states, band.at(k)), displacements, profiles, Height::Slice(k));
    }
    at_height(machine, (states, Real::ZERO), displacements, profiles, Height::Tip);
    finish(machine, profiles);
}

/// Begins to read profiles that are not current: nothing is known of these walls but where there are any.
pub fn begin(machine: &Loop, profiles: &mut [Profile]) {
    let samples = machine.path.samples().iter().skip(machine.path.first());
    for (p, sample) in profiles.iter_mut().zip(samples).filter(|(p, _)| !p.is_current) {
        let (margin, on_wall) = (p.margin, sample.on_wall);
        *p = Profile { margin, ..Profile::unread(on_wall) };
    }
}

/// A height at which walls are read.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Height {
    /// The middle of one of the [`HEIGHTS`] slices of the band.
    Slice(i64),
    /// The tip.
    Tip,
    /// One that the band leaves out, above it or below: only how deep the wall is there counts.
    LeftOut,
}

/// Reads one height off the cutter positions there. Slices do not depend on each other: read in parts and [joined](Profile::join) they
/// are the same. The tip is read when all slices are.
pub fn read(machine: &Loop, height: Height, displacements: impl Displacements, profiles: &mut [Profile]) {
    let path = machine.path;
    let mut envelope = Envelope::of(path, path.working().start, displacements);
    let mut guess = path.first();
    for (i, p) in profiles.iter_mut().enumerate() {
        let index = path.first().saturating_add(i);
        if !p.on_wall {
            continue;
        }
        if p.is_current {
            // As if it had been read: the next one may be made where this one is.
            guess = p.maker(height.slice(), index).saturating_add(1);
            continue;
        }
        let Some(wall) = envelope.read(index, guess) else { continue };
        guess = wall.made_by.saturating_add(1);
        p.take(height, index, &wall);
    }
}

/// Ends reading, when all heights are.
pub fn finish(machine: &Loop, profiles: &mut [Profile]) {
    for p in profiles.iter_mut().filter(|p| !p.is_current) {
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
        at_height(machine, (states, height), displacements, profiles, Height::LeftOut);
    }
}

/// Finds the cutter's positions at a height and reads it: all of them, or those that a profile asks for which is not current.
fn at_height(
    machine: &Loop,
    (states, fraction): (&[State], Real),
    displacements: &mut [Vector],
    profiles: &mut [Profile],
    height: Height,
) {
    if profiles.iter().any(Profile::is_current) {
        let (mut teeth, state) = (Teeth::BLANK, |slot: usize| states.get(slot).copied());
        read(machine, height, Sought::new(machine, state, fraction, (&mut teeth, displacements)), profiles);
    } else {
        Envelope::displace(machine, states, fraction, displacements);
        read(machine, height, &*displacements, profiles);
    }
}

impl Height {
    /// The slice of the band whose cutter positions are next to those that make it.
    const fn slice(self) -> i64 {
        if let Self::Slice(slice) = self { slice } else { 0 }
    }
}
