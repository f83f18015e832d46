//! Parts to cut: a wave of any number of segments, and a pocket. The papers' corner is that of the tests.

use super::corner::{chain, point, real, setup};
use std::f64::consts::TAU;
use truepath_core::cut::{CutSetup, Milling, WallLaw};
use truepath_core::geometry::{Block, Curve, Point, Side};
use truepath_core::units::Offset;

/// Length of a period of the wave, mm, and segments in it.
const PERIOD: (f64, usize) = (20.0, 10);

/// A wave of short lines along x that turns its heading by ±0.1 rad; radius of curvature 32 mm or more. Every ten
/// segments are the same, so a step costs the same on any of them, were it not for the length of the whole.
pub fn wave(segments: usize) -> Vec<Block> {
    let length = PERIOD.0 / PERIOD.1 as f64;
    let mut at = (0.0, 0.0);
    let mut points: Vec<Point> = vec![point(0.0, 0.0)];
    for i in 0..segments {
        let heading = 0.1 * (TAU * (i % PERIOD.1) as f64 / PERIOD.1 as f64).sin();
        at = (at.0 + length * heading.cos(), at.1 + length * heading.sin());
        points.push(point(at.0, at.1));
    }
    let lines: Vec<Curve> = points.windows(2).map(|p| Curve::line(p[0], p[1]).unwrap()).collect();
    chain(&lines, 400.0)
}

/// A pocket of 92 × 62 mm with corners of 10 mm, milled in climb along its wall with a cutter of 12 mm.
pub fn pocket() -> Vec<Block> {
    let (w, h, r) = (80.0, 50.0, 4.0);
    let line = |a: (f64, f64), b: (f64, f64)| Curve::line(point(a.0, a.1), point(b.0, b.1)).unwrap();
    let arc = |a: (f64, f64), b: (f64, f64), c: (f64, f64)| {
        Curve::arc(point(a.0, a.1), point(b.0, b.1), point(c.0, c.1), true).unwrap()
    };
    let curves = [
        line((w / 2.0, 0.0), (w - r, 0.0)),
        arc((w - r, 0.0), (w, r), (w - r, r)),
        line((w, r), (w, h - r)),
        arc((w, h - r), (w - r, h), (w - r, h - r)),
        line((w - r, h), (r, h)),
        arc((r, h), (0.0, h - r), (r, h - r)),
        line((0.0, h - r), (0.0, r)),
        arc((0.0, r), (r, 0.0), (r, r)),
        line((r, 0.0), (w / 2.0, 0.0)),
    ];
    chain(&curves, 480.0)
}

/// The cut of the pocket.
pub fn pocket_setup() -> CutSetup {
    CutSetup {
        radius: Offset::from_um(6_000),
        teeth: 4,
        helix_deg: real(35.0),
        axial_depth: real(15.0),
        allowance: Offset::from_um(1_000),
        spindle_rpm: real(2400.0),
        wall: Side::Right,
        milling: Milling::Climb,
        ..setup(WallLaw::Helical)
    }
}
