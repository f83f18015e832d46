//! The wall error over the height of the cut, and what of it a correction aims at.

use crate::cut::{Envelope, Loop, State};
use crate::geometry::Vector;
use crate::units::{Offset, Real};

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
    /// Whether a wall stands there; see [`Sample::on_wall`](crate::cut::Sample::on_wall).
    pub on_wall: bool,
}

impl Band {
    /// The whole engaged depth.
    pub const WHOLE: Self = Self { from: Real::ZERO, to: Real::ONE };

    /// Middle of the k-th of twelve even slices.
    pub fn at(self, k: i64) -> Real {
        self.from
            + (self.to - self.from) * Real::ratio(k.saturating_mul(2).saturating_add(1), HEIGHTS.saturating_mul(2))
    }
}

impl Profile {
    /// The error a target aims at. `max_gouge` wins over the target: the deepest height may not end deeper than it.
    pub fn aim(&self, target: Target, max_gouge: Option<Offset>) -> Offset {
        let wanted = match target {
            Target::Mean => self.mean,
            Target::Tip => self.tip,
            Target::Minimax => Offset::from_nm(self.lowest.nm().saturating_add(self.highest.nm()) / 2),
        };
        match max_gouge {
            Some(limit) => wanted.min(self.lowest + limit),
            None => wanted,
        }
    }
    /// What is left over height when the target is met: the larger distance from it.
    pub fn form_error(&self, target: Target) -> Offset {
        let zero = self.aim(target, None);
        (self.highest - zero).max(zero - self.lowest)
    }
    /// The samples, counted along the contour, whose cutter positions made the wall beside sample `index`, one for
    /// every height.
    pub fn makers(&self, index: usize) -> impl Iterator<Item = usize> + '_ {
        let shifts = self.made_by.iter().filter(|_| self.on_wall);
        shifts.filter_map(move |shift| index.checked_add_signed(*shift as isize))
    }
}

/// Adds the wall error that parts have shown beside the model: the same at every height.
pub fn add_residual(profiles: &mut [Profile], residual: &[Offset]) {
    for (p, more) in profiles.iter_mut().zip(residual).filter(|(p, _)| p.on_wall) {
        p.mean += *more;
        p.lowest += *more;
        p.highest += *more;
        p.tip += *more;
    }
}

/// Reads the profile off the wall beside each sample of the contour.
///
/// `states` belong to the path's working range; `profiles` to the contour's own samples; `displacements` is as long
/// as `states`.
pub fn profile(machine: &Loop, states: &[State], band: Band, displacements: &mut [Vector], profiles: &mut [Profile]) {
    let path = machine.path;
    let first = path.first();
    for (p, sample) in profiles.iter_mut().zip(path.samples().iter().skip(first)) {
        *p = Profile { lowest: Offset::MAX, highest: -Offset::MAX, on_wall: sample.on_wall, ..Profile::default() };
    }
    for k in 0..=HEIGHTS {
        let tip = k == HEIGHTS;
        let height = if tip { Real::ZERO } else { band.at(k) };
        Envelope::displace(machine, states, height, displacements);
        let envelope = Envelope::new(path, path.working().start, displacements);
        let mut guess = first;
        for (i, p) in profiles.iter_mut().enumerate() {
            let index = first.saturating_add(i);
            let Some(wall) = envelope.error(index, guess).filter(|_| p.on_wall) else { continue };
            guess = wall.made_by.saturating_add(1);
            if tip {
                p.tip = wall.error;
            } else {
                if let Some(slot) = p.made_by.get_mut(k as usize) {
                    let shift = (wall.made_by as i64).saturating_sub(index as i64);
                    *slot = shift.clamp(i16::MIN.into(), i16::MAX.into()) as i16;
                }
                p.mean += wall.error;
                p.lowest = p.lowest.min(wall.error);
                p.highest = p.highest.max(wall.error);
            }
        }
    }
    for p in profiles.iter_mut() {
        if !p.on_wall {
            *p = Profile::default();
        }
        p.mean = p.mean.scaled(Real::ratio(1, HEIGHTS));
    }
}
