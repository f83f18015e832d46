//! Kinks: where the written path turns on the spot and the original does not.
//!
//! The wanted path may turn there itself, because the correction changes quickly; what counts against the limit is the
//! part of a kink that goes beyond that turn. The wanted turn at a sample is that of the chords on both sides, less
//! what the programmed curvature makes of it.

use truepath_core::geometry::{Curve, Shape};

use super::super::vector::{cross, dot};
use super::along::difference;

/// Turns of the original up to here count as tangent, radians (half a degree: rounded coordinates of short blocks).
const TANGENT: f64 = 0.0087;

/// Behind a sharp corner the correction steps from one wall's to the next one's; what is shorter is that step, nm.
const STEP: i64 = 500_000;

/// A heading step of the written path in a place where the original goes on smoothly.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(in super::super) struct Kink {
    /// Its size.
    pub(in super::super) degrees: f64,
    /// What of it the wanted path does not have.
    pub(in super::super) beyond: f64,
    /// Line of the written program that begins with it; 0 for none.
    pub(in super::super) line: u32,
    /// Which of the edits it is in, and whether it is at the edit's start.
    pub(in super::super) edit: usize,
    pub(in super::super) at_start: bool,
}

/// Headings at the last junctions.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Turns {
    original_end: Option<[f64; 2]>,
    original_turn: f64,
    written_end: Option<[f64; 2]>,
    /// Whether the last curve was the step behind a sharp corner.
    stepped: bool,
    /// The last chord of the wanted path.
    pub(super) wanted_end: Option<[f64; 2]>,
}

/// The wanted path around a junction.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// The chords before and after it.
    pub(super) chords: [Option<[f64; 2]>; 2],
    /// Curvature of the programmed curve, 1/nm, positive to the left.
    pub(super) curvature: f64,
}

impl Wanted {
    /// Its own turn.
    fn turn(&self) -> f64 {
        let [Some(a), Some(b)] = self.chords else { return 0.0 };
        let smooth = self.curvature * 0.5 * (dot(a, a).sqrt() + dot(b, b).sqrt());
        turn(a, b) - smooth
    }
}

impl Turns {
    /// The next line of the original, from its first to its last curve.
    pub(super) fn original(&mut self, first: &Option<Curve>, last: &Option<Curve>) {
        let (Some(first), Some(last)) = (first, last) else { return };
        self.original_turn = self.original_end.map_or(0.0, |end| turn(end, headings(first)[0]));
        self.original_end = Some(headings(last)[1]);
    }
    /// The next curve of the written path: the size of the kink at its start, and what of it the wanted path does not
    /// have.
    pub(super) fn written(&mut self, curve: &Curve, begins_line: bool, wanted: &Wanted) -> Option<[f64; 2]> {
        let [start, end] = headings(curve);
        let before = self.written_end.replace(end)?;
        let expected = if begins_line { self.original_turn } else { 0.0 };
        let behind_step = std::mem::take(&mut self.stepped) && !begins_line;
        if expected.abs() > TANGENT {
            self.stepped = curve.length().nm() < STEP;
            return None;
        }
        if behind_step {
            return None;
        }
        let (kink, own) = (turn(before, start) - expected, wanted.turn());
        let shared = if kink * own > 0.0 { own.abs() } else { 0.0 };
        Some([kink.abs().to_degrees(), (kink.abs() - shared).max(0.0).to_degrees()])
    }
}

fn turn(a: [f64; 2], b: [f64; 2]) -> f64 {
    cross(a, b).atan2(dot(a, b))
}

/// Headings of a curve at its start and end, from its geometry.
fn headings(curve: &Curve) -> [[f64; 2]; 2] {
    let [start, end] = [curve.start(), curve.end()].map(|p| [p.x.nm(), p.y.nm()]);
    match curve.shape() {
        Shape::Line => [difference(end, start); 2],
        Shape::Arc { centre, sweep } => {
            let centre = [centre.x.nm(), centre.y.nm()];
            let sense = if sweep.bits() < 0 { -1.0 } else { 1.0 };
            [start, end].map(|p| {
                let spoke = difference(p, centre);
                [-sense * spoke[1], sense * spoke[0]]
            })
        }
    }
}
