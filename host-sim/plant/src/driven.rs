//! From the commanded path to the one that the machine goes: drives that lag, screws with play, a datum that drifts.
//!
//! Each axis follows its command as a first-order system with one time constant (a position loop of gain 1/τ without feed-forward);
//! behind it lies the play of its screw, half to either side. The path begins as if the machine had come in the direction of its
//! first step for long. The drift is that of the part against the machine as it warms: it grows evenly along the contour, in every
//! pass alike.

use super::drives::Drives;
use super::machine::Machine;
use super::path::Path;
use super::vector::{Point, along, distance};

/// A commanded place: centre, nominal sample beside it, feed on the way to it in mm/min.
pub(super) type Commanded = (Point, usize, f64);

/// Where the machine goes when it is told to go along `way`.
pub(super) fn driven(way: &[Commanded], path: &Path, machine: &Machine) -> Vec<Point> {
    let mut centre: Vec<Point> = way.iter().map(|(p, ..)| *p).collect();
    if !machine.drives.is_exact() {
        for axis in 0..2 {
            let followed = following(way, axis, &machine.drives);
            centre.iter_mut().zip(followed).for_each(|(p, x)| p[axis] = x);
        }
    }
    if machine.drift_mm != [0.0; 2] {
        for (p, (_, nominal, _)) in centre.iter_mut().zip(way) {
            *p = along(*p, machine.drift_mm, path.s_mm[*nominal] / path.length_mm);
        }
    }
    centre
}

/// The place of one axis along the way.
fn following(way: &[Commanded], axis: usize, drives: &Drives) -> Vec<f64> {
    let lag = drives.time_constant_s;
    let play = 0.5 * drives.backlash_mm[axis];
    // Velocity on the way to a place, mm/s, and how long it takes.
    let step = |k: usize| {
        let ((from, ..), (to, _, feed)) = (way[k - 1], way[k]);
        let seconds = distance(from, to) / feed * 60.0;
        if seconds > 0.0 { ((to[axis] - from[axis]) / seconds, seconds) } else { (0.0, 0.0) }
    };
    let Some((first, ..)) = way.first() else { return Vec::new() };
    let begins = (1..way.len()).map(step).find(|(_, seconds)| *seconds > 0.0).map_or(0.0, |(velocity, _)| velocity);
    let mut motor = first[axis] - begins * lag;
    let mut table = if begins.abs() > 0.0 { motor - play * begins.signum() } else { motor };
    let mut out = vec![table];
    for k in 1..way.len() {
        let (velocity, seconds) = step(k);
        let behind = velocity * lag;
        // The exact answer to a ramp.
        let settled = if lag > 0.0 { (-seconds / lag).exp() } else { 0.0 };
        motor = way[k].0[axis] - behind + (motor - way[k - 1].0[axis] + behind) * settled;
        table = table.clamp(motor - play, motor + play);
        out.push(table);
    }
    out
}
