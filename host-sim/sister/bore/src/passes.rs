//! Which passes of which teeth form the wall.
//!
//! A pass belongs to the cut when its crest does: when the cutter's centre is on its circle, between 0 and `2π·laps`, at the
//! moment the tooth points straight at the wall. It then counts as a whole, because a tangential lead-in or lead-out, on which
//! its beginning or end may fall, leaves the circle only to second order.
//!
//! Unless `ω₂/ω₁` is a whole number the marks do not close after one lap. After exactly one lap the gap between the last and
//! the first mark is anything up to twice the others, and the crest left there up to four times as high. A cut therefore goes
//! on for a moment; the default is one lap and one turn of the cutter against it, the shortest cut without such a seam. Further
//! laps put their marks between those of the first, wherever the ratio says.

use std::f64::consts::TAU;

use super::arc::Arc;
use super::motion::{Motion, Tooth};
use super::refusal::Refusal;

/// The most passes in one cut.
pub const MAX_PASSES: usize = 200_000;
/// The most laps.
pub const MAX_LAPS: f64 = 100.0;
/// Radii closer than this, mm, are one: a picometre.
const SAME_RADIUS_MM: f64 = 1e-9;
/// Crests closer than this, rad, of teeth of one radius are one mark.
const SAME_PLACE: f64 = 1e-12;

/// One pass of one tooth.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ToothPass {
    /// Index of the tooth, from 0.
    pub tooth: usize,
    /// Index of the curve it leaves.
    pub arc: usize,
    /// When its crest is cut, s.
    pub tau: f64,
    /// Where on the wall, rad in [0, 2π).
    pub crest: f64,
}

/// All passes of a cut, by place on the wall.
#[derive(Clone, Debug)]
pub struct Passes {
    /// The motion.
    pub motion: Motion,
    /// The teeth.
    pub teeth: Vec<Tooth>,
    /// The curves, one a radius of edge.
    pub arcs: Vec<Arc>,
    /// Index of the curve of each tooth.
    pub arc_of: Vec<usize>,
    /// The passes in the order of their crests.
    pub passes: Vec<ToothPass>,
    /// Laps of the centre.
    pub laps: f64,
    /// Index of the curve of the longest edge.
    pub longest: usize,
    /// Half the largest gap between crests of the longest edge, rad. No pass matters farther from its crest: the longest
    /// edge has passed within this distance of every place, and at the same distance no other reaches as far out.
    pub reach: f64,
}

impl Passes {
    /// The shortest cut without a seam: one lap and one turn of the cutter against the path.
    pub fn laps_without_seam(motion: &Motion) -> f64 {
        1.0 + motion.advance().abs()
    }
    /// # Errors
    /// [`Refusal`]: too many passes, laps out of range, or passes that do not meet.
    pub fn new(motion: Motion, teeth: Vec<Tooth>, laps: Option<f64>) -> Result<Self, Refusal> {
        let laps = laps.unwrap_or_else(|| Self::laps_without_seam(&motion));
        Refusal::unless_in("number of laps", "", laps, 1.0, MAX_LAPS)?;
        let relative = motion.omega2 - motion.omega1;
        let found = laps * relative.abs() / motion.omega1 * teeth.len() as f64;
        if found > MAX_PASSES as f64 {
            return Err(Refusal::Passes { found, limit: MAX_PASSES });
        }
        let mut arcs: Vec<Arc> = Vec::new();
        let mut arc_of = Vec::with_capacity(teeth.len());
        for tooth in &teeth {
            let known = arcs.iter().position(|arc| (arc.edge - tooth.radius_mm).abs() <= SAME_RADIUS_MM);
            arc_of.push(known.unwrap_or(arcs.len()));
            if known.is_none() {
                arcs.push(motion.arc(tooth));
            }
        }
        let mut passes = Vec::with_capacity(found as usize + teeth.len());
        for (tooth, &arc) in arc_of.iter().enumerate() {
            each_pass(&motion, teeth[tooth].angle, laps, |tau, crest| {
                passes.push(ToothPass { tooth, arc, tau, crest })
            });
        }
        passes.sort_by(|a, b| a.crest.total_cmp(&b.crest).then(a.tau.total_cmp(&b.tau)));
        passes.dedup_by(|b, a| a.arc == b.arc && (b.crest - a.crest) <= SAME_PLACE);
        let longest = (0..arcs.len()).max_by(|a, b| arcs[*a].edge.total_cmp(&arcs[*b].edge)).unwrap_or(0);
        let reach = half_largest_gap(passes.iter().filter(|p| p.arc == longest).map(|p| p.crest));
        for arc in &arcs {
            // Equality is a wall: at k > 0 the pass ends exactly where the next begins.
            if arc.half_width() < reach * (1.0 - 1e-9) || arc.turning(0.0) <= 0.0 {
                let wall = arc.path + arc.edge;
                let (spacing_mm, reach_mm) = (2.0 * reach * wall, 2.0 * arc.half_width().max(0.0) * wall);
                return Err(Refusal::Apart { spacing_mm, reach_mm });
            }
        }
        Ok(Self { motion, teeth, arcs, arc_of, passes, laps, longest, reach })
    }
    /// The curve of a pass.
    pub fn arc(&self, pass: &ToothPass) -> &Arc {
        &self.arcs[pass.arc]
    }
    /// The largest radius of the wall, mm.
    pub fn highest(&self) -> f64 {
        self.motion.path_mm + self.arcs[self.longest].edge
    }
}

/// Calls `with(τ, place)` for every crest of a tooth with the centre between 0 and `2π·laps`.
fn each_pass(motion: &Motion, angle: f64, laps: f64, mut with: impl FnMut(f64, f64)) {
    let relative = motion.omega2 - motion.omega1;
    let end = TAU * laps / motion.omega1;
    // u = (ω₂ − ω₁)τ + β = 2πm.
    let turns_at = |tau: f64| (relative * tau + angle) / TAU;
    let (a, b) = (turns_at(0.0), turns_at(end));
    let (first, last) = (a.min(b).ceil() as i64, a.max(b).floor() as i64);
    for m in first..=last {
        let tau = ((m as f64) * TAU - angle) / relative;
        with(tau, around(motion.omega1 * tau));
    }
}

/// The angle in [0, 2π).
pub fn around(angle: f64) -> f64 {
    let turned = angle.rem_euclid(TAU);
    if turned < TAU { turned } else { 0.0 }
}

/// Half the largest distance of neighbours on the circle; the places in ascending order.
fn half_largest_gap(places: impl Iterator<Item = f64>) -> f64 {
    let (mut first, mut last, mut gap) = (None, 0.0, 0.0f64);
    for place in places {
        match first {
            None => first = Some(place),
            Some(_) => gap = gap.max(place - last),
        }
        last = place;
    }
    first.map_or(f64::INFINITY, |first| gap.max(first + TAU - last) / 2.0)
}
