//! Kinks: where the written path turns on the spot and the original does not.

use truepath_core::geometry::Curve;

use super::super::vector::{cross, dot};
use super::inside::headings;

/// Turns of the original up to here count as tangent, radians (half a degree: rounded coordinates of short blocks).
const TANGENT: f64 = 0.0087;

/// A heading step of the written path in a place where the original goes on smoothly.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Kink {
    pub(super) degrees: f64,
    /// Line of the written program that begins with it.
    pub(super) line: u32,
}

/// Headings at the last junctions of both programs.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Turns {
    original_end: Option<[f64; 2]>,
    original_turn: f64,
    written_end: Option<[f64; 2]>,
}

impl Turns {
    /// The next line of the original, from its first to its last curve; `count` curves are taken as smooth inside.
    pub(super) fn original(&mut self, first: &Option<Curve>, last: &Option<Curve>, count: usize) {
        let (Some(first), Some(last)) = (first, last) else { return };
        debug_assert!(count > 0);
        self.original_turn = self.original_end.map_or(0.0, |end| turn(end, headings(first)[0]));
        self.original_end = Some(headings(last)[1]);
    }
    /// The next curve of the written path.
    pub(super) fn written(&mut self, curve: &Curve, line: u32, begins_line: bool) -> Option<Kink> {
        let [start, end] = headings(curve);
        let before = self.written_end.replace(end)?;
        let expected = if begins_line { self.original_turn } else { 0.0 };
        (expected.abs() <= TANGENT).then(|| Kink { degrees: (turn(before, start) - expected).abs().to_degrees(), line })
    }
}

fn turn(a: [f64; 2], b: [f64; 2]) -> f64 {
    cross(a, b).atan2(dot(a, b))
}
