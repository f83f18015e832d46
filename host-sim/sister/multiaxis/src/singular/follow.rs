//! Locations on the great circle: the tool axis is led along the arc between a move's ends, as far as the inverse of the
//! orientation permits.
//!
//! From the start on, the next location is taken as far along the arc as the orientation error of the piece allows, by
//! halving the step; its rotary words are the solution nearest to those of the location before. The programmed end stays
//! what it is: when the nearest solutions do not lead there (the program changed the branch, or made a whole turn), the
//! same is tried on the branch of the end, and then given up.

use super::super::Machine;
use super::super::kinematics::Branch;
use super::super::machine::Joints;
use super::super::vector::{Vector, add_scaled, angle, scale, unit};
use super::orientation_error;

/// Rotary words nearer than this, rad, are the same.
const SAME: f64 = 1e-9;
/// Steps along the arc below this are given up.
const SHORTEST: f64 = 1e-6;

/// Parameters of the chord and rotary words of locations, strictly between the ends, between which the tool axis stays
/// within `tolerance` (rad) of the great circle. `None` when the inverse does not lead from one end to the other, or
/// not within `most` locations.
pub(in super::super) fn follow(
    machine: &Machine,
    from: &Joints,
    to: &Joints,
    tolerance: f64,
    most: usize,
) -> Option<Vec<(f64, [f64; 2])>> {
    let ends = [from, to].map(|joints| machine.axis(joints.rotary));
    if angle(ends[0], ends[1]) > std::f64::consts::PI - 1e-6 {
        return None;
    }
    walk(machine, from, to, ends, tolerance, most, None)
        .or_else(|| walk(machine, from, to, ends, tolerance, most, Some(machine.branch(to.rotary))))
}

fn walk(
    machine: &Machine,
    from: &Joints,
    to: &Joints,
    ends: [Vector; 2],
    tolerance: f64,
    most: usize,
    branch: Option<Branch>,
) -> Option<Vec<(f64, [f64; 2])>> {
    let mut found = Vec::new();
    let (mut s, mut words) = (0.0f64, from.rotary);
    let mut step = 1.0f64;
    loop {
        let next = (s + step).min(1.0);
        let there = solution(machine, on_arc(ends, next), words, branch)?;
        let there = if next == 1.0 && same(there, to.rotary) { to.rotary } else { there };
        let joints = |rotary| Joints { xyz: [0.0; 3], rotary };
        if orientation_error(machine, &joints(words), &joints(there)).0 <= tolerance {
            if next == 1.0 {
                return same(there, to.rotary).then_some(found);
            }
            if found.len() >= most {
                return None;
            }
            found.push((next, there));
            (s, words) = (next, there);
            step *= 2.0;
        } else {
            step = step.min(1.0 - s) / 2.0;
            if step < SHORTEST {
                return None;
            }
        }
    }
}

/// The rotary words for a tool axis: the nearest, or the nearest on a branch.
fn solution(machine: &Machine, axis: Vector, near: [f64; 2], branch: Option<Branch>) -> Option<[f64; 2]> {
    let solutions = machine.orient(axis, near)?;
    let Some(branch) = branch else { return Some(solutions[0]) };
    let fits = |words: &&[f64; 2]| matches!(machine.branch(**words), b if b == branch || b == Branch::Pole);
    Some(*solutions.iter().find(fits).unwrap_or(&solutions[0]))
}

fn same(a: [f64; 2], b: [f64; 2]) -> bool {
    (a[0] - b[0]).abs() < SAME && (a[1] - b[1]).abs() < SAME
}

/// The direction at a part of the arc between two directions, at uniform angle.
fn on_arc(ends: [Vector; 2], s: f64) -> Vector {
    let whole = angle(ends[0], ends[1]);
    if whole < 1e-9 || s >= 1.0 {
        return ends[if s < 1.0 { 0 } else { 1 }];
    }
    let (a, b) = (((1.0 - s) * whole).sin(), (s * whole).sin());
    unit(add_scaled(scale(ends[0], a), ends[1], b)).unwrap_or(ends[0])
}
