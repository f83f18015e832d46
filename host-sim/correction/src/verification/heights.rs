//! Heights at which the ball meets the wall.
//!
//! The ball touches with its equator, so its centre must stand inside the engaged depth, and its lowest point must
//! stay clear of the floor, which may lie as high as the cutter's tip. The heights are spread evenly over what remains:
//! the outermost tell bending and the helix, those between tell a bad touch.
//!
//! Where the profile is asked for, or the wall is taller than one axial contact ratio, they are chosen instead
//! ([`profile_heights`]).
//!
//! Passes of a millimetre or two leave no room for a ball, and make a wall all the same: then the heights are spread over the
//! wall of several passes that are cut alike, each at another height above the tip that cut it there.

use truepath_core::job::{Probe, ZReference};
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::length::Unit;
use truepath_ground::units::{float, mm};
use truepath_job::levels;
use truepath_job::pass::Pass;

use super::profile_heights::profile_heights;
use super::settings::{Settings, USUAL_HEIGHTS};
use crate::codes::V002;

/// A height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height {
    /// Above the cutter's tip, fraction of the engaged depth.
    pub fraction: f64,
    /// Of the ball's centre above the cutter's tip, mm.
    pub above_tip_mm: f64,
    /// Z that is programmed, mm, program coordinates: centre or tip of the ball as the job says.
    pub z_mm: f64,
    /// What it is for.
    pub why: &'static str,
}

/// From the ball's centre to the upper end of the engaged depth, at least: above it stands what an earlier pass left, or
/// the edge with its burr. The larger of millimetres and a share of the depth.
const BELOW_TOP: (f64, f64) = (1.0, 0.1);

/// Diameters of balls that probes are sold with, mm, from the largest down.
const BALLS_MM: [f64; 7] = [6.0, 5.0, 4.0, 3.0, 2.0, 1.5, 1.0];
/// Touches over less than the last share of the height of a wall leave the rest of it to the model; a ball that reaches the first is
/// looked for, then one that reaches the last (`truepath study --touches advised`; docs/study.md has what it is worth).
const REACHED: [f64; 2] = [0.6, 0.4];

/// The largest smaller ball that would touch enough of the height of a wall, mm. `spread` is what a ball would touch, mm.
pub(super) fn smaller_ball(ball_mm: f64, depth_mm: f64, spread: impl Fn(f64) -> f64) -> Option<f64> {
    let smaller = || BALLS_MM.into_iter().filter(move |ball| *ball < ball_mm);
    let reaches = |share: f64| smaller().find(|ball| spread(*ball) >= share * depth_mm);
    if spread(ball_mm) >= REACHED[1] * depth_mm { None } else { REACHED.into_iter().find_map(reaches) }
}

/// Between two heights, at least, mm.
const APART: f64 = 0.5;

/// What heights over several passes are for.
const OF_SEVERAL: [&str; 2] = [
    "highest: with the others, each at another height above the tip of its pass, it tells bending and helix",
    "on a pass below that is cut alike, at another height above its tip",
];
/// Share of the depth next to tip and upper end of a pass that is not touched: there the next pass begins.
const EDGE: f64 = 0.2;

/// Tips of the passes that make one wall with this one, above its own, mm: its own, and those that are cut alike.
fn tips(pass: &Pass) -> Result<Vec<f64>, Failure> {
    let others = levels::alike(pass)?;
    Ok(std::iter::once(0.0).chain(others.into_iter().map(mm)).collect())
}

/// Heights on the wall of several passes of a depth, as the tip of their pass and the fraction of the depth above it, from
/// the highest down; none where there is no room either. `lowest` above the deepest floor, `below_top` under the upper end.
fn over_several(tips: &[f64], depth: f64, (lowest, below_top): (f64, f64), count: u32) -> Vec<(f64, f64)> {
    let floor = tips.iter().copied().fold(f64::INFINITY, f64::min) + lowest;
    let top = tips.iter().copied().fold(f64::NEG_INFINITY, f64::max) + depth - below_top;
    let share = |k: u32| if count < 2 { 0.5 } else { f64::from(k) / f64::from(count - 1) };
    let mut found: Vec<(f64, f64)> = Vec::new();
    for k in 0..count {
        let fraction = 1.0 - EDGE - (1.0 - 2.0 * EDGE) * share(k);
        let wanted = top + (floor - top) * share(k);
        let z = |tip: &f64| tip + fraction * depth;
        let room = |tip: &&f64| {
            let below_the_last = found.last().is_none_or(|(last, f)| z(tip) <= last + f * depth - APART + 1e-9);
            z(tip) >= floor - 1e-9 && z(tip) <= top + 1e-9 && below_the_last
        };
        let nearest = tips.iter().filter(room).min_by(|a, b| (z(a) - wanted).abs().total_cmp(&(z(b) - wanted).abs()));
        found.extend(nearest.map(|tip| (*tip, fraction)));
    }
    found
}

/// The room of a ball on a wall, mm.
#[derive(Clone, Copy, Debug)]
struct Room {
    depth: f64,
    /// Of the ball's lowest point above the tip of the cutter, at least.
    lowest: f64,
    /// Of its centre below the upper end, at least.
    below_top: f64,
}

impl Room {
    /// Of a wall of a depth.
    fn of(pass: &Pass, settings: &Settings) -> Self {
        let depth = float(pass.core.setup.axial_depth);
        Self { depth, lowest: settings.floor_clearance, below_top: BELOW_TOP.0.max(BELOW_TOP.1 * depth) }
    }
    /// What a ball can touch, mm; below zero nothing.
    fn spread(self, ball_mm: f64) -> f64 {
        self.depth - self.below_top - self.lowest - ball_mm / 2.0
    }
    /// The ball to take where one has no room, mm: one that touches enough of the wall, or two heights of it, or any.
    fn ball(self, ball_mm: f64) -> Option<f64> {
        let with = |spread: f64| BALLS_MM.into_iter().find(|ball| *ball < ball_mm && self.spread(*ball) >= spread);
        smaller_ball(ball_mm, self.depth, |ball| self.spread(ball)).or_else(|| with(APART)).or_else(|| with(0.0))
    }
}

/// The ball that has room on the wall of a pass where that of the job has none (`V002`), mm; `None` where it has, or no ball has.
pub fn ball_with_room(pass: &Pass, settings: &Settings) -> Option<f64> {
    let (room, ball_mm) = (Room::of(pass, settings), mm(pass.job.require_probe().ok()?.ball_diameter));
    if room.spread(ball_mm) < 0.0 { room.ball(ball_mm) } else { None }
}

fn no_room(room: Room, ball_mm: f64, unit: Unit) -> InputError {
    let name = unit.name();
    let [ball, depth, floor, top] = [ball_mm, room.depth, room.lowest, room.below_top].map(|mm| unit.of(mm));
    let has_room =
        room.ball(ball_mm).map_or_else(String::new, |other| format!(", as one of {} {name} has", unit.of(other)));
    V002.error(
        format!("a ball of {ball} {name} has no room in an engaged depth of {depth} {name}"),
        format!(
            "its radius + {floor} {name} above the floor + {top} {name} below the upper end within the depth{has_room}"
        ),
    )
}

/// Whether every height of the wall of a pass counts: a tolerance was stated, or one instant of a tooth makes more than one height.
fn asks_for_profile(pass: &Pass, settings: &Settings) -> bool {
    let setup = &pass.core.setup;
    let lag = float(setup.helix().lag_per_mm) * float(setup.axial_depth);
    let pitch = std::f64::consts::TAU / f64::from(setup.teeth);
    settings.tolerance.is_some() || pass.job.part.tolerance.is_some() || lag > pitch
}

/// The heights of a pass, from the highest down, with a sentence why these where they were chosen; on other passes of the same
/// wall as well where it has no room for the ball.
///
/// # Errors
/// `V002` when the ball has no room between floor and upper end, and whatever is wrong with another pass.
pub(super) fn heights(
    pass: &Pass,
    probe: &Probe,
    settings: &Settings,
) -> Result<(Vec<Height>, Option<String>), Failure> {
    let wanted = settings.heights.unwrap_or(USUAL_HEIGHTS);
    let room = Room::of(pass, settings);
    let (depth, below_top) = (room.depth, room.below_top);
    let radius = mm(probe.ball_diameter) / 2.0;
    let tip_z = pass.core.contour.z.nm() as f64 / 1e6;
    let (lowest, highest) = (radius + room.lowest, depth - below_top);
    let lift = match probe.z_reference {
        ZReference::Centre => 0.0,
        ZReference::Tip => radius,
    };
    if lowest > highest {
        let over_several = over_several(&tips(pass)?, depth, (lowest, below_top), wanted);
        if !over_several.is_empty() {
            let height = |(k, (tip, fraction)): (usize, &(f64, f64))| Height {
                fraction: *fraction,
                above_tip_mm: fraction * depth,
                z_mm: tip_z + tip + fraction * depth - lift,
                why: if k == 0 { OF_SEVERAL[0] } else { OF_SEVERAL[1] },
            };
            return Ok((over_several.iter().enumerate().map(height).collect(), None));
        }
        return Err(no_room(room, 2.0 * radius, pass.unit()).into());
    }
    if wanted > 1 && asks_for_profile(pass, settings) {
        let count = settings.heights.map(|count| count as usize);
        if let Some(chosen) = profile_heights(pass, (lowest, highest), mm(probe.noise), count)? {
            let height = |(above_tip_mm, why): &(f64, &'static str)| Height {
                fraction: above_tip_mm / depth,
                above_tip_mm: *above_tip_mm,
                z_mm: tip_z + above_tip_mm - lift,
                why,
            };
            return Ok((chosen.above_tip_mm.iter().map(height).collect(), Some(chosen.why)));
        }
    }
    // Heights closer together than this tell the same.
    let count = wanted.min(1 + ((highest - lowest) / APART) as u32);
    let at = |k: u32| {
        let share = if count == 1 { 0.5 } else { f64::from(k) / f64::from(count - 1) };
        let above_tip_mm = highest + (lowest - highest) * share;
        let why = match (count, k) {
            (1, _) => "mid-height: the mean of the wall",
            (_, 0) => "highest: with the lowest it tells bending and helix over the height",
            (n, k) if k + 1 == n => "lowest: with the highest it tells bending and helix over the height",
            _ => "between: shape over the height, and a check of its neighbours",
        };
        Height { fraction: above_tip_mm / depth, above_tip_mm, z_mm: tip_z + above_tip_mm - lift, why }
    };
    Ok(((0..count).map(at).collect(), None))
}
