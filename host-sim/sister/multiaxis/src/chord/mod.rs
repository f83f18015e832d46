//! The chord error of a move: how far the tool leaves the programmed line while the joints move linearly.
//!
//! T eqs (3)–(4) with two repairs. The distance is taken from the programmed chord p_wL (the text says p_w), and from the
//! chord as a *segment*: where the tool overshoots an end, or the chord has no length because the tool only tilts, the
//! distance from the nearer end counts. It is never smaller than the distance from the infinite line.
//!
//! [`ChordError::estimate`] is the closed form: the tip path is nearly a parabola, whose sagitta is an eighth of its
//! second derivative across the chord, `ε ≈ ⅛ |p″(½)⊥chord|`. For one rotary axis on the table that is
//! `⅛ |(Δθ²ρ − 2Δθ·JΔp)⊥chord|`, ρ the mid-point of the chord from the axis and J the turn by 90°; the common
//! `ρ(1 − cos Δθ/2)` leaves out the second term and is twice too small or seven times too large, by sign.
//!
//! [`ChordError::exact`] is the largest distance over the move, and [`ChordError::bound`] a proof that there is no
//! larger one.

mod certified;
mod distance;

use certified::stays_within;
use distance::FromChord;

use super::Machine;
use super::kinematics::Course;
use super::machine::Joints;
use super::vector::{Vector, add_scaled, dot, norm, sub};

pub(super) use certified::{Curve, Sample, largest};

/// The chord error of a move, mm.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ChordError {
    /// Closed form, from the second derivative in the middle of the move.
    pub estimate: f64,
    /// The largest distance, reached at `at`.
    pub exact: f64,
    /// No distance is larger than this: `exact` and the slack of the proof, at most [`SLACK_MM`] or 10⁻⁵ of `exact`
    /// unless the rotary axes make hundreds of turns.
    pub bound: f64,
    /// Parameter of the move, 0…1, at which the distance is `exact`.
    pub at: f64,
}

/// Absolute slack of the certified maximum, mm.
pub const SLACK_MM: f64 = 1e-7;
/// Slack relative to the maximum.
const SLACK: f64 = 1e-5;

/// The chord error of the linear joint move `from` → `to`.
///
/// Numbers that are not finite give errors that are not finite; nothing else can go wrong.
pub fn chord_error(machine: &Machine, from: &Joints, to: &Joints) -> ChordError {
    let course = Course::of_point(machine, from, to);
    let curve = FromChord::new(&course);
    let largest = largest(&curve, SLACK_MM, SLACK);
    ChordError { estimate: estimate(&course), exact: largest.value, bound: largest.bound, at: largest.at }
}

/// The closed form alone.
pub fn chord_estimate(machine: &Machine, from: &Joints, to: &Joints) -> f64 {
    estimate(&Course::of_point(machine, from, to))
}

/// Proves that the chord error of a move is at most `tolerance_mm`. `false` when it is larger, or so near that `f64`
/// cannot tell.
pub fn within(machine: &Machine, from: &Joints, to: &Joints, tolerance_mm: f64) -> bool {
    let course = Course::of_point(machine, from, to);
    stays_within(&FromChord::new(&course), tolerance_mm)
}

fn estimate(course: &Course) -> f64 {
    let chord = sub(course.place(1.0), course.place(0.0));
    norm(across(course.jet(0.5).second, chord)) / 8.0
}

/// The part of a vector perpendicular to the chord; all of it for a chord without length.
fn across(v: Vector, chord: Vector) -> Vector {
    let square = dot(chord, chord);
    if square > 0.0 { add_scaled(v, chord, -dot(v, chord) / square) } else { v }
}
