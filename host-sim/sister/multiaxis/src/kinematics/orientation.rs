//! Inverse of the orientation: the rotary words that give a tool axis, both solutions.
//!
//! Seen from the part the tool axis is `u = Q_p(φ_p) Q_s(φ_s) k`: the *polar* axis p is the one nearest to the part, the
//! *tilting* axis s the one nearest to the tool, and φ = ±θ (the table's turns are undone). `u·e_p` depends on φ_s only:
//! `cos φ_s` for p = C, `sin φ_s` for p = A, s = B, `−sin φ_s` for p = B, s = A. Each has two solutions, the *branches*;
//! φ_p is then the angle about e_p from `Q_s k` to u. At the pole, u = ±e_p, φ_p is free.
//!
//! Limits: with s = C the tilting axis turns the tool about itself, and most orientations cannot be reached: no inverse.

use std::f64::consts::{PI, TAU};

use super::super::machine::{Letter, Machine};
use super::super::vector::{Vector, add_scaled, cross, dot, norm};
use super::UPRIGHT;
use super::chain::Link;

/// Which of the two solutions a pair of rotary words is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Branch {
    /// Sine (p = C) or cosine (p = A, B) of the tilt φ_s is positive.
    Positive,
    /// It is negative.
    Negative,
    /// It is zero: the tool stands in the pole, where the branches meet.
    Pole,
}

/// Sine of a tilt below which the tool is in the pole.
const IN_POLE: f64 = 1e-9;

impl Machine {
    /// The polar and the tilting axis.
    fn polar_and_tilting(&self) -> [Link; 2] {
        let [near_tool, near_part] = self.chain().links;
        [near_part, near_tool]
    }

    /// The place in [`Machine::rotary`] of the axis that swings near the pole.
    pub fn polar(&self) -> usize {
        self.polar_and_tilting()[0].axis
    }

    /// Whether the tool reaches a half sphere of orientations; not so when C turns it about itself.
    pub fn tilts(&self) -> bool {
        self.polar_and_tilting()[1].letter != Letter::C
    }

    /// Angle of a tool axis from the pole, the line of the polar axis, 0…π/2. Zero for every axis of a machine that
    /// does not tilt.
    pub fn from_pole(&self, axis: Vector) -> f64 {
        if !self.tilts() {
            return 0.0;
        }
        let pole = self.polar_and_tilting()[0].letter.direction();
        norm(cross(pole, axis)).atan2(dot(pole, axis).abs())
    }

    /// The branch a pair of rotary words is on.
    pub fn branch(&self, rotary: [f64; 2]) -> Branch {
        let [polar, tilting] = self.polar_and_tilting();
        if tilting.letter == Letter::C {
            return Branch::Pole;
        }
        let (sin, cos) = (tilting.sign * rotary[tilting.axis]).sin_cos();
        match if polar.letter == Letter::C { sin } else { cos } {
            tilt if tilt.abs() < IN_POLE => Branch::Pole,
            tilt if tilt > 0.0 => Branch::Positive,
            _ => Branch::Negative,
        }
    }

    /// Both pairs of rotary words that give the unit vector `axis`, each taken to the turn nearest to `near`; the nearer
    /// pair first. `None` when the machine cannot reach orientations at all, or not this one.
    pub fn orient(&self, axis: Vector, near: [f64; 2]) -> Option<[[f64; 2]; 2]> {
        let [polar, tilting] = self.polar_and_tilting();
        let height = dot(axis, polar.letter.direction()).clamp(-1.0, 1.0);
        // The sideways part keeps its digits where the height has none left.
        let side = norm(cross(polar.letter.direction(), axis));
        let tilts = match (polar.letter, tilting.letter) {
            (_, Letter::C) => return None,
            (Letter::C, _) => {
                let tilt = side.atan2(height);
                [tilt, -tilt]
            }
            (_, letter) => {
                let tilt = if letter == Letter::B { height.atan2(side) } else { -height.atan2(side) };
                [tilt, PI - tilt]
            }
        };
        let solved = tilts.map(|tilt| {
            let mut words = near;
            words[tilting.axis] = nearest_turn(tilt * tilting.sign, near[tilting.axis]);
            let tilted = tilting.turned(UPRIGHT, words);
            if side > IN_POLE {
                let turn = angle_about(polar.letter.direction(), tilted, axis);
                words[polar.axis] = nearest_turn(turn * polar.sign, near[polar.axis]);
            }
            words
        });
        let way = |words: [f64; 2]| (words[0] - near[0]).abs() + (words[1] - near[1]).abs();
        let [a, b] = solved;
        Some(if way(b) < way(a) { [b, a] } else { [a, b] })
    }
}

/// Signed angle about a unit vector from one direction to another, −π…π.
fn angle_about(e: Vector, from: Vector, to: Vector) -> f64 {
    let flat = add_scaled(from, e, -dot(from, e));
    dot(e, cross(flat, to)).atan2(dot(flat, to))
}

/// The angle plus the number of whole turns that brings it nearest to another.
fn nearest_turn(angle: f64, near: f64) -> f64 {
    angle + TAU * ((near - angle) / TAU).round()
}
