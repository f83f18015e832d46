//! What the gouge guard did: where it holds the cutter back from what the target wants, and by how much.

use truepath_core::correct::Law;
use truepath_core::cut::Path;
use truepath_core::units::Offset;
use truepath_ground::units::mm;

use crate::correction::Correction;

/// Held back by less than this is not worth a line.
const LEAST: Offset = Offset::from_um(1);
/// Places nearer to each other than this are one.
const APART: Offset = Offset::from_um(1_000);

/// A stretch of the contour on which the guard holds the cutter back.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct HeldBack {
    /// Its start, mm along the contour.
    pub from_s_mm: f64,
    /// Its end, mm along the contour.
    pub to_s_mm: f64,
    /// Where the guard holds back most, mm along the contour.
    pub at_s_mm: f64,
    /// Correction towards the wall that the target wants there, mm.
    pub wanted_mm: f64,
    /// What the guard allows of it, mm.
    pub allowed_mm: f64,
}

impl HeldBack {
    /// By how much the cutter is held back, mm.
    pub fn moved_mm(&self) -> f64 {
        self.wanted_mm - self.allowed_mm
    }
}

/// The guard of a correction.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct GuardSummary {
    /// The deepest cut allowed at any height of the engaged depth, mm.
    pub max_gouge_mm: f64,
    /// Standard deviations of the deepest height that are kept free.
    pub confidence_sigmas: u32,
    /// Whether the law of the correction heeds a guard.
    pub heeded: bool,
    /// Deepest predicted cut at any height, mm (positive).
    pub deepest_mm: f64,
    /// The same with the standard deviations kept free: at most `max_gouge_mm` where the guard is kept, mm.
    pub deepest_with_confidence_mm: f64,
    /// Largest distance by which it holds the cutter back from what the target wants, mm.
    pub moved_mm: f64,
    /// Where it does.
    pub places: Vec<HeldBack>,
}

/// The guard of a correction, if its job asks for one.
pub fn guard_summary(path: &Path, correction: &Correction) -> Option<GuardSummary> {
    let max_gouge = correction.wanted.max_gouge?;
    let walls = || correction.predicted.iter().map(|p| &p.after).filter(|wall| wall.on_wall);
    let places = places(path, correction);
    Some(GuardSummary {
        max_gouge_mm: mm(max_gouge),
        confidence_sigmas: truepath_core::correct::GUARD_SIGMAS.unsigned_abs(),
        heeded: correction.wanted.law == Law::Model,
        deepest_mm: mm(walls().map(|wall| -wall.deepest()).max().unwrap_or_default()).max(0.0),
        deepest_with_confidence_mm: mm(walls().map(|wall| wall.margin() - wall.deepest()).max().unwrap_or_default())
            .max(0.0),
        moved_mm: places.iter().map(HeldBack::moved_mm).fold(0.0, f64::max),
        places,
    })
}

fn places(path: &Path, correction: &Correction) -> Vec<HeldBack> {
    let mut out: Vec<HeldBack> = Vec::new();
    let samples = path.samples().iter().skip(path.first());
    for ((sample, allowed), wanted) in samples.zip(&correction.nodes).zip(&correction.unguarded) {
        let towards = |node: &truepath_core::correct::Node| node.total().along(sample.normal);
        let (wanted, allowed) = (towards(wanted), towards(allowed));
        if wanted - allowed < LEAST {
            continue;
        }
        let s = mm(sample.s);
        let here = HeldBack { from_s_mm: s, to_s_mm: s, at_s_mm: s, wanted_mm: mm(wanted), allowed_mm: mm(allowed) };
        match out.last_mut() {
            Some(last) if s - last.to_s_mm <= mm(APART) => {
                let from_s_mm = last.from_s_mm;
                let more = if here.moved_mm() > last.moved_mm() { here } else { *last };
                *last = HeldBack { from_s_mm, to_s_mm: s, ..more };
            }
            _ => out.push(here),
        }
    }
    out
}
