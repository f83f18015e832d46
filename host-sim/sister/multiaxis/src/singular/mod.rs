//! Singular neighbourhoods: where the tool axis stands near the pole, a rotary axis may swing far while the tool axis
//! hardly moves.
//!
//! The pole is the line of the polar axis, the rotary axis nearest to the part (see the inverse of the orientation in
//! [`super::kinematics`]). The distance of the tool axis from it depends on the tilting word alone, so its minimum over a
//! move is exact: the distance of an interval from a row of equally spaced points.
//!
//! A move is meant to lead the tool axis from u₀ to u₁ along the great circle between them. The *orientation error* is the
//! largest angle of the actual axis from that arc; it is a certified maximum like the chord error, since the distance
//! from the cone spanned by u₀ and u₁ is convex and equals the sine of the angle.
//!
//! A passage is reported, never re-routed in silence: see [`Passage::class`] and [`super::division::insert`].

mod cone;
mod follow;

use std::f64::consts::{FRAC_PI_2, PI};

use cone::FromArc;

use super::Machine;
use super::chord::largest;
use super::kinematics::{Branch, Course};
use super::machine::{Joints, Letter};
use super::vector::angle;

pub(super) use follow::follow;

/// How a move stands to the pole.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Class {
    /// Away from it.
    Regular,
    /// Within [`Machine::pole`] of it, on one branch.
    NearPole,
    /// Its ends lie on different branches of the inverse: the tilt passes through the pole.
    BranchChange,
    /// The machine has no tilt: C turns the tool about itself, every position is the pole.
    NoTilt,
}

/// How the orientation runs over a move; angles in rad.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// Its class.
    pub class: Class,
    /// Smallest angle between tool axis and pole.
    pub nearest_pole: f64,
    /// Angle by which the polar axis turns.
    pub swing: f64,
    /// Angle between the tool axes at its ends.
    pub turn: f64,
    /// Largest angle between the tool axis and the great circle between the ends.
    pub orientation_error: f64,
    /// Parameter of the move at which it is reached.
    pub at: f64,
    /// The branches of its ends.
    pub branches: [Branch; 2],
}

/// Slack of the certified orientation error, in sines of angles, and relative to it.
const SLACK: [f64; 2] = [1e-7, 1e-4];

/// The passage of the linear joint move `from` → `to`.
pub fn passage(machine: &Machine, from: &Joints, to: &Joints) -> Passage {
    let branches = [from, to].map(|joints| machine.branch(joints.rotary));
    let nearest_pole = nearest_pole(machine, from, to);
    let class = if !machine.tilts() {
        Class::NoTilt
    } else if matches!(branches, [Branch::Positive, Branch::Negative] | [Branch::Negative, Branch::Positive]) {
        Class::BranchChange
    } else if nearest_pole < machine.pole() {
        Class::NearPole
    } else {
        Class::Regular
    };
    let polar = machine.polar();
    let (orientation_error, at) = orientation_error(machine, from, to);
    Passage {
        class,
        nearest_pole,
        swing: (to.rotary[polar] - from.rotary[polar]).abs(),
        turn: angle(machine.axis(from.rotary), machine.axis(to.rotary)),
        orientation_error,
        at,
        branches,
    }
}

/// Largest angle between the tool axis and the great circle between the ends, and the parameter of its place.
pub(super) fn orientation_error(machine: &Machine, from: &Joints, to: &Joints) -> (f64, f64) {
    if from.rotary == to.rotary {
        return (0.0, 0.0);
    }
    let course = Course::of_axis(machine, from, to);
    let arc = FromArc::new(&course);
    let largest = largest(&arc, SLACK[0], SLACK[1]);
    // Beyond a right angle the distance says no more than that.
    let error = if largest.bound < 1.0 { largest.bound.asin() } else { arc.angle(course.place(largest.at)) };
    (error, largest.at)
}

/// Smallest angle between tool axis and pole over a move.
fn nearest_pole(machine: &Machine, from: &Joints, to: &Joints) -> f64 {
    if !machine.tilts() {
        return 0.0;
    }
    let polar = machine.polar();
    let tilting = 1 - polar;
    // Poles stand at whole multiples of π of the tilt about C, half a turn apart and shifted by π/2 about A and B.
    let shift = if machine.rotary()[polar].letter == Letter::C { 0.0 } else { FRAC_PI_2 };
    let (a, b) = (from.rotary[tilting] - shift, to.rotary[tilting] - shift);
    let (low, high) = (a.min(b) / PI, a.max(b) / PI);
    if low.ceil() <= high {
        return 0.0;
    }
    (low - low.floor()).min(high.ceil() - high).max(0.0) * PI
}
