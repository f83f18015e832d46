//! How far the corrected wall may be from where it is predicted, from the covariance of the fit.
//!
//! Limits: the change of a wall is that of the cutter positions that made it, at some heights and at places between which the cut changes
//! little; in between the standard deviations are interpolated, up to 7 % off where the load changes fastest.

use super::design::{Design, DesignWorkspace};
use super::profile::{HEIGHTS, Profile, Target};
use super::reader::WallReader;
use super::scratch::{Deviation, Scratch};
use crate::cut::{ForceTable, Loop, Near, Path, State};
use crate::identify::{Fit, Prior, neighbours};
use truepath_units::{Offset, Real, hypot_nm};

/// Slices of the band that stand for it in a mean: each is the middle one of three.
const MIDDLES: [i64; 4] = [1, 4, 7, 10];
/// Its lowest and its highest slice.
const ENDS: [i64; 2] = [0, HEIGHTS - 1];
/// Samples that one piece of work has.
const PIECE: usize = 256;
/// Such a part of the radius lies between places that are computed, at most.
const APART: i64 = 4;
/// The engagement angle, or the way of the normal, changes by less between them, rad.
const TURN: Real = Real::ratio(1, 32);

/// Standard deviations of the walls that a correction leaves, beside each sample, from the covariance of the fit: of the
/// error the target aims at and of the deepest height.
///
/// The machine is displaced along each column of a square root of the covariance and cuts again with the correction held; the
/// squares of the changes add up. `workspace` must hold the states and the walls of the correction. Every slot of
/// `workspace.scratch` then holds a [`Deviation`].
#[inline(never)]
pub(super) fn deviations(
    machine: &Loop,
    (prior, fit): (&Prior, &Fit),
    wanted: &Design,
    workspace: &mut DesignWorkspace<'_, impl WallReader>,
) {
    let path = machine.path;
    let DesignWorkspace { states, profiles, scratch, reader, .. } = workspace;
    let corrected = Corrected { states, profiles, from: path.working().start, wanted };
    corrected.choose(path, scratch);
    let mut table = ForceTable::BLANK;
    table.tabulate(machine.table.size_exponent());
    for (parameters, share) in neighbours(prior, fit) {
        // The last columns move nothing but the datum of the part that was probed: the wall stays where it is.
        if parameters.machine(path, &table).cuts_as(machine) {
            continue;
        }
        if parameters.coefficients.size_exponent != table.size_exponent() {
            table.tabulate(parameters.coefficients.size_exponent);
        }
        let displaced = parameters.machine(path, &table);
        reader.each(scratch, PIECE, |first, slots| {
            let (mut here, mut there) = (Near::known(machine), Near::new(&displaced));
            for (k, slot) in slots.iter_mut().enumerate() {
                let known = slot.deviation();
                if known.is_asked
                    && let Some(change) = corrected.change([&mut here, &mut there], first.saturating_add(k))
                {
                    let and = |known: Offset, change: Offset| hypot_nm(known, change.scaled(share));
                    let (aimed, deepest) = (and(known.aimed, change.aimed), and(known.deepest, change.deepest));
                    *slot = Deviation { aimed, deepest, ..known }.into();
                }
            }
        });
    }
    interpolate(scratch, profiles);
}

/// Fills in what lies between the places that were computed. Where one of the two has no wall, the other stands for both.
fn interpolate(slots: &mut [Scratch], profiles: &[Profile]) {
    let on_wall = |at: usize| profiles.get(at).is_some_and(|wall| wall.on_wall);
    let (mut from, mut before) = (0usize, Deviation::default());
    for to in 0..slots.len() {
        let Some(behind) = slots.get(to).map(|slot| slot.deviation()).filter(|known| known.is_asked) else { continue };
        let length = to.saturating_sub(from) as i64;
        let (first, last) = match (on_wall(from), on_wall(to)) {
            (true, false) => (before, before),
            (false, true) => (behind, behind),
            _ => (before, behind),
        };
        for between in from.saturating_add(1)..to {
            let share = Real::ratio(between.saturating_sub(from) as i64, length);
            let mixed = |first: Offset, last: Offset| first + (last - first).scaled(share);
            if let Some(slot) = slots.get_mut(between).filter(|_| on_wall(between)) {
                let (aimed, deepest) = (mixed(first.aimed, last.aimed), mixed(first.deepest, last.deepest));
                *slot = Deviation { aimed, deepest, is_asked: false }.into();
            }
        }
        (from, before) = (to, behind);
    }
}

/// The contour as the identified machine cuts it with its correction.
struct Corrected<'a> {
    states: &'a [State],
    profiles: &'a [Profile],
    /// Sample of the first state.
    from: usize,
    wanted: &'a Design,
}

impl Corrected<'_> {
    /// Chooses the places that are computed: the first and the last, and wherever the cutter works otherwise than at the last one chosen, or that is
    /// too far away.
    fn choose(&self, path: &Path, slots: &mut [Scratch]) {
        let apart = (path.setup().radius.nm() / APART).checked_div(path.step().nm()).unwrap_or(0);
        let skipped = path.first().saturating_sub(self.from);
        let at = |k: usize| {
            let state = self.states.get(skipped.saturating_add(k)).copied().unwrap_or(State::REST);
            (state, self.profiles.get(k).is_some_and(|wall| wall.on_wall))
        };
        let last = slots.len().saturating_sub(1);
        let mut chosen = (0usize, at(0));
        for (k, slot) in slots.iter_mut().enumerate() {
            let (before, (then, had_wall)) = chosen;
            let (now, has_wall) = at(k);
            let is_asked = k == 0
                || k == last
                || k.saturating_sub(before) as i64 >= apart
                || has_wall != had_wall
                || now.chip_scale != then.chip_scale
                || (now.engaged - then.engaged).abs() > TURN
                || (now.normal.x - then.normal.x).abs().max((now.normal.y - then.normal.y).abs()) > TURN;
            if is_asked {
                chosen = (k, (now, has_wall));
            }
            *slot = Deviation { is_asked, ..Deviation::default() }.into();
        }
    }

    /// How the wall beside a sample of the contour changes from one machine to another: the error that the target aims at, and the deepest,
    /// which only a guard asks for. `None` where no wall stands.
    fn change(&self, machines: [&mut Near<'_>; 2], at: usize) -> Option<Deviation> {
        let wall = self.profiles.get(at).filter(|wall| wall.on_wall)?;
        let [before, after] = machines.map(|machine| self.walls(wall, machine, at));
        let (before, after) = (before?, after?);
        let aimed = |wall: &Profile| wall.aim(self.wanted.target, None);
        let (aimed, deepest) = (aimed(&after) - aimed(&before), after.deepest() - before.deepest());
        Some(Deviation { aimed, deepest, is_asked: true })
    }

    /// The wall of a machine at the heights that are needed, as the cutter positions make it that make it corrected.
    fn walls(&self, corrected: &Profile, machine: &mut Near<'_>, at: usize) -> Option<Profile> {
        let Design { target, band, max_gouge, .. } = *self.wanted;
        let index = machine.machine().path.first().saturating_add(at);
        let run = |sample: usize| self.states.get(sample.checked_sub(self.from)?).copied();
        let mut left = |slice: i64, height: Real| machine.wall((index, corrected.maker(slice, index), height), run);
        let [lowest, highest] = ENDS;
        let mut wall = Profile::unread(true);
        let is_guarded = max_gouge.is_some();
        if target != Target::Tip || is_guarded {
            for slice in MIDDLES {
                let error = left(slice, band.at(slice))?;
                wall.mean += error.scaled(Real::ratio(1, MIDDLES.len() as i64));
                wall.note(error);
            }
        }
        if target == Target::Minimax || is_guarded {
            for slice in ENDS {
                wall.note(left(slice, band.at(slice))?);
            }
        }
        if target == Target::Tip || is_guarded {
            wall.tip = left(lowest, Real::ZERO)?;
        }
        if is_guarded {
            wall.deepen(wall.tip);
            for height in band.left_out() {
                wall.deepen(left(if height < band.from { lowest } else { highest }, height)?);
            }
        }
        wall.shift(machine.machine().undersize);
        Some(wall)
    }
}
