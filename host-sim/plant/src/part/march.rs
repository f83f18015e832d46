//! A lap: the cutter goes along the wall, yields, and takes stock from every slice.
//!
//! At each step the mean centre is where it is in equilibrium with the mean force over a revolution; the force is the sum over
//! slices of what the engaged part of each gives. The wall at a height is made by the force at the instant at which a tooth passes
//! there. At that instant the cutter is elsewhere than on the mean, so it is less or more deep in the stock: the displacement
//! at the instant is in equilibrium with the engagement of the instant ([`Equilibrium::Instant`]).
//!
//! The force is taken in the frame of the nominal place of the actual centre, also when the run lies to the side. What the lap has
//! cut counts once the cutter is a diameter past; until then it is behind the cutting part of the circumference.

use std::collections::VecDeque;
use std::f64::consts::PI;

use serde::Serialize;

use super::elastic::Guess;
use super::field::{Circles, Field};
use super::immersion::{Immersion, Stand, moved};
use super::laps::{Lap, Step};
use super::rays::Rays;
use super::slices::Slice;
use crate::flutes::Flutes;
use crate::machine::{Machine, WallLaw};
use crate::path::Path;
use crate::setup::Cut;
use crate::vector::{Point, add, along, cross, dot, norm, scaled, sub};

/// The elastic loop is closed when the displacement repeats to this, mm.
const CLOSED_MM: f64 = 1e-6;
/// A loop that stays open by more than this is counted, mm.
const OPEN_MM: f64 = 1e-4;
/// Search window for the nominal place of the actual centre, mm of path.
const WINDOW_MM: f64 = 6.0;
/// Below this lag over the whole depth the flutes count as straight, rad.
const STRAIGHT_RAD: f64 = 1e-6;
/// What a lap has cut counts for itself when the cutter is a diameter and this past, mm.
const PAST_MM: f64 = 1.0;

/// With which engagement the force of an instant is in equilibrium.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum Equilibrium {
    /// With that of the instant.
    #[default]
    Instant,
    /// With that of the mean centre, as in [`crate::mill`].
    Mean,
}

/// State of the cut at one step of a lap.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LapSample {
    /// Sample of the nominal path that the commanded centre is beside.
    pub nominal: usize,
    /// Nominal place of the actual centre along the contour, mm.
    pub s_mm: f64,
    /// Commanded centre, mm, as the drives have followed it.
    pub commanded: Point,
    /// Actual centre under the mean force, mm.
    pub actual: Point,
    /// Mean force on the tool, x and y, N.
    pub force_n: Point,
    /// Largest immersion that cuts, at any height, rad.
    pub leaving_rad: f64,
    /// Feed, mm/min.
    pub feed_mm_per_min: f64,
}

/// What a lap was.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct LapFacts {
    /// Z of the tip, the lowest, mm.
    pub tip_z_mm: f64,
    /// Against the sense of the contour.
    pub reversed: bool,
    /// Climb milling.
    pub climb: bool,
    /// Where it begins along the contour, mm.
    pub from_s_mm: f64,
    /// Where it ends, mm.
    pub to_s_mm: f64,
    /// Its length, mm.
    pub length_mm: f64,
    /// How far from the nominal path it is commanded, in the mean, mm; positive away from the wall.
    pub beside_mm: f64,
    /// Least feed, mm/min.
    pub least_feed_mm_per_min: f64,
    /// Greatest feed, mm/min.
    pub greatest_feed_mm_per_min: f64,
    /// Largest mean force, N.
    pub largest_force_n: f64,
    /// Largest engagement, degrees.
    pub largest_engagement_deg: f64,
    /// Largest amount by which the elastic loop stayed open, mm.
    pub residual_mm: f64,
    /// Places (of a step, a slice and a tooth) where it stayed open by more than 0.1 µm.
    pub open_places: usize,
}

/// What does not change along a lap.
pub(super) struct March<'a> {
    pub(super) path: &'a Path,
    pub(super) cut: &'a Cut,
    pub(super) machine: &'a Machine,
    pub(super) rays: &'a Rays,
    pub(super) slices: &'a [Slice],
    pub(super) equilibrium: Equilibrium,
    pub(super) climb: bool,
    pub(super) reversed: bool,
    /// Force tables, and which of them each step uses.
    pub(super) flutes: &'a [Flutes],
    pub(super) which: &'a [usize],
}

/// The teeth at a step.
#[derive(Clone, Copy)]
struct Teeth<'a> {
    flutes: &'a Flutes,
    /// Edge force relative to sharp ones.
    edge: f64,
}

/// The slices that a step cuts, seen from the tip.
#[derive(Debug, Default)]
struct Engaged {
    /// First slice of the part that is.
    first: usize,
    /// First slice whose middle is above the tip: it is cut.
    cut: usize,
    /// Lower and upper edge above the tip, mm.
    edges: Vec<(f64, f64)>,
    /// How far the slice moves against the top of the cut.
    reach: Vec<f64>,
    /// The same less one.
    share: Vec<f64>,
    /// Weight of a force there.
    weight: Vec<f64>,
    /// The same times the height.
    weighted_mm: Vec<f64>,
}

impl Engaged {
    fn at(&mut self, tip: f64, march: &March<'_>) {
        self.first = march.slices.partition_point(|s| s.upper <= tip + 1e-9);
        self.cut = march.slices.partition_point(|s| s.middle() < tip);
        self.edges.clear();
        self.edges.extend(
            march.slices[self.first..].iter().filter_map(|s| s.above(tip)).map(|s| (s.lower - tip, s.upper - tip)),
        );
        let depth = march.cut.axial_depth_mm;
        let level = |(a, b): &(f64, f64)| 0.5 * (a + b) / depth;
        self.reach.clear();
        self.reach.extend(self.edges.iter().map(|e| march.machine.reach(level(e))));
        self.share.clear();
        self.share.extend(self.reach.iter().map(|g| g - 1.0));
        self.weight.clear();
        self.weight.extend(self.edges.iter().map(|e| march.machine.attack(level(e))));
        self.weighted_mm.clear();
        self.weighted_mm.extend(self.edges.iter().zip(&self.weight).map(|(e, w)| w * (e.1 - e.0)));
    }
}

/// What a lap carries from step to step.
struct Way {
    immersion: Immersion,
    at_crossings: Vec<[f64; 2]>,
    mean: Guess,
    /// By slice, then by tooth.
    instants: Vec<Guess>,
    /// Mean displacement of the step before, to which the instants belong.
    before: Point,
}

/// The mean centre of a step.
#[derive(Clone, Copy)]
struct Settled {
    displacement: Point,
    travel: Point,
    normal: Point,
    s_mm: f64,
    force: Point,
    leaving: f64,
}

impl March<'_> {
    /// Goes along a lap and takes the stock; `travelled_mm` is the way that the edges have cut before, and after.
    pub(super) fn go(&self, lap: &Lap, field: &mut Field, travelled_mm: &mut f64) -> (LapFacts, Vec<LapSample>) {
        let radius = self.cut.radius_mm;
        let each = self.flutes.first().map_or(1, Flutes::distinct_teeth);
        let distinct = if self.machine.law == WallLaw::Mean { 1 } else { each };
        let radii: Vec<f64> = if self.machine.law == WallLaw::Mean {
            vec![self.machine.longest_radius(radius)]
        } else {
            (0..distinct).map(|tooth| self.machine.tooth_radius(radius, tooth)).collect()
        };
        let mut way = Way {
            immersion: Immersion::default(),
            at_crossings: Vec::new(),
            mean: Guess::REST,
            instants: vec![Guess::REST; self.slices.len() * distinct],
            before: [0.0; 2],
        };
        let mut engaged = Engaged::default();
        let mut samples: Vec<LapSample> = Vec::with_capacity(lap.steps.len());
        let mut waiting: VecDeque<(f64, Circles)> = VecDeque::new();
        let past = if self.path.closed {
            (2.0 * radius + PAST_MM).min(0.6 * self.path.length_mm)
        } else {
            2.0 * radius + PAST_MM
        };
        let (mut near, mut length, mut beside) = (Vec::new(), 0.0, 0.0);
        let (mut residual_mm, mut open_places) = (0.0f64, 0);
        let mut stock = field.most();
        for (step, &which) in lap.steps.iter().zip(self.which) {
            length += step.way_mm;
            *travelled_mm += step.way_mm;
            let edge = 1.0 + self.machine.edge_wear_per_m * *travelled_mm * 1e-3;
            let teeth = Teeth { flutes: &self.flutes[which], edge };
            while waiting.front().is_some_and(|(at, _)| length - at > past) {
                if let Some((_, circles)) = waiting.pop_front() {
                    field.cut(self.rays, &circles, radius, stock, &mut near);
                }
            }
            engaged.at(step.tip_z_mm, self);
            let (settled, open) = self.settle(step, teeth, &engaged, field, &mut way);
            residual_mm = residual_mm.max(open);
            open_places += usize::from(open > OPEN_MM);
            let actual = add(step.commanded, settled.displacement);
            beside -= dot(sub(step.commanded, self.path.centre[step.nominal]), self.path.normal[step.nominal]);
            samples.push(LapSample {
                nominal: step.nominal,
                s_mm: settled.s_mm,
                commanded: step.commanded,
                actual,
                force_n: settled.force,
                leaving_rad: settled.leaving,
                feed_mm_per_min: step.feed_mm_per_min,
            });
            let mut centres = Vec::with_capacity((self.slices.len() - engaged.cut) * distinct);
            for k in engaged.cut - engaged.first..engaged.edges.len() {
                for tooth in 0..distinct {
                    let guess = &mut way.instants[(engaged.first + k) * distinct + tooth];
                    let (at, open) = if self.machine.law == WallLaw::Mean {
                        (settled.displacement, 0.0)
                    } else {
                        let moved = sub(settled.displacement, way.before);
                        guess.at = add(guess.at, moved);
                        self.instant((k, tooth), &settled, teeth, &engaged, &way.immersion, guess)
                    };
                    residual_mm = residual_mm.max(open);
                    open_places += usize::from(open > OPEN_MM);
                    centres.push(along(step.commanded, at, engaged.reach[k]));
                }
            }
            way.before = settled.displacement;
            if !centres.is_empty() {
                let circles = Circles { middle: actual, first_slice: engaged.cut, centres, radii: radii.clone() };
                waiting.push_back((length, circles));
            }
        }
        for (_, circles) in waiting {
            field.cut(self.rays, &circles, radius, stock, &mut near);
        }
        stock = stock.max(0.0);
        debug_assert!(field.most() <= stock + 1e-9);
        let facts = self.facts(lap, &samples, (length, beside / lap.steps.len().max(1) as f64));
        (LapFacts { residual_mm, open_places, ..facts }, samples)
    }

    fn facts(&self, lap: &Lap, samples: &[LapSample], (length_mm, beside_mm): (f64, f64)) -> LapFacts {
        let s = |step: Option<&Step>| step.map_or(0.0, |step| self.path.s_mm[step.nominal]);
        let feeds = || lap.steps.iter().map(|step| step.feed_mm_per_min);
        LapFacts {
            tip_z_mm: lap.steps.iter().map(|step| step.tip_z_mm).fold(f64::INFINITY, f64::min),
            reversed: self.reversed,
            climb: self.climb,
            from_s_mm: s(lap.steps.first()),
            to_s_mm: s(lap.steps.last()),
            length_mm,
            beside_mm,
            least_feed_mm_per_min: feeds().fold(f64::INFINITY, f64::min),
            greatest_feed_mm_per_min: feeds().fold(0.0, f64::max),
            largest_force_n: samples.iter().map(|s| norm(s.force_n)).fold(0.0, f64::max),
            largest_engagement_deg: samples.iter().map(|s| s.leaving_rad).fold(0.0, f64::max).to_degrees(),
            residual_mm: 0.0,
            open_places: 0,
        }
    }

    /// Finds the mean centre; leaves the depths of it in `way.immersion`.
    fn settle(&self, step: &Step, teeth: Teeth<'_>, engaged: &Engaged, field: &Field, way: &mut Way) -> (Settled, f64) {
        let Teeth { flutes, edge } = teeth;
        let Way { immersion, at_crossings, mean, .. } = way;
        let per_radian = self.cut.teeth as f64 / (2.0 * PI);
        let mut evaluate = |d: Point| {
            let centre = add(step.commanded, d);
            let place = self.path.place(centre, step.nominal, WINDOW_MM);
            let travel = if self.reversed { scaled(place.tangent, -1.0) } else { place.tangent };
            let stand = Stand {
                centre,
                travel,
                normal: place.normal,
                radius: self.cut.radius_mm,
                ray: self.rays.of_sample(place.index),
                reversed: self.reversed,
            };
            immersion.find(&stand, self.rays, field, engaged.first, (d, &engaged.share), slack(d));
            at_crossings.clear();
            at_crossings.extend(immersion.phi.iter().map(|phi| flutes.primitive(None, *phi, edge)));
            let primitive = |phi: f64| flutes.primitive(None, phi, edge);
            let (sum, leaving) = immersion.integrate(&engaged.weighted_mm, at_crossings, primitive);
            let force = in_xy(place.normal, travel, scaled(sum, per_radian));
            Settled { displacement: d, travel, normal: place.normal, s_mm: place.s_mm, force, leaving }
        };
        let normal = self.path.normal[step.nominal];
        let open = mean.settle(normal, CLOSED_MM, |d| {
            let at = evaluate(d);
            self.machine.deflection(at.force, at.s_mm, at.normal)
        });
        // The last try need not have been the best.
        let settled = evaluate(mean.at);
        immersion.bound(slack(mean.at));
        (settled, open)
    }

    /// The displacement at the instant at which a tooth passes the middle of a slice, and by how much it stayed open.
    fn instant(
        &self,
        (slice, tooth): (usize, usize),
        mean: &Settled,
        teeth: Teeth<'_>,
        engaged: &Engaged,
        immersion: &Immersion,
        guess: &mut Guess,
    ) -> (Point, f64) {
        let (lower, upper) = engaged.edges[slice];
        let height = 0.5 * (lower + upper);
        let force = |v: Point| {
            let sum = at_height(teeth, (tooth, height), engaged, immersion, (mean.displacement, v));
            self.machine.deflection(in_xy(mean.normal, mean.travel, sum), mean.s_mm, mean.normal)
        };
        match self.equilibrium {
            Equilibrium::Mean => (force(mean.displacement), 0.0),
            Equilibrium::Instant => {
                let open = guess.settle(mean.normal, CLOSED_MM, force);
                (guess.at, open)
            }
        }
    }
}

/// Force in (n, t) at the instant at which `tooth` makes the wall at `height` above the tip, with the centre displaced by `to`
/// where the depths hold for `from`.
fn at_height(
    Teeth { flutes, edge }: Teeth<'_>,
    (tooth, height): (usize, f64),
    engaged: &Engaged,
    immersion: &Immersion,
    (from, to): (Point, Point),
) -> Point {
    let (lag, sense, teeth) = (flutes.lag_rad_per_mm(), flutes.sense(), flutes.teeth());
    let pitch = 2.0 * PI / teeth as f64;
    let mut sum = [0.0; 2];
    if immersion.phi.is_empty() {
        return sum;
    }
    for (k, &(lower, upper)) in engaged.edges.iter().enumerate() {
        let end = immersion.end(k);
        if end < 0.0 {
            continue;
        }
        let by = moved(from, to, engaged.reach[k]);
        let (a, b) = (sense * lag * (height - lower), sense * lag * (height - upper));
        let (lo, hi) = (a.min(b), a.max(b));
        // The tooth that comes `turn` pitches later is farther on in immersion when that falls with time.
        let mut turn = (-hi / pitch - 1e-12).ceil();
        while lo + turn * pitch < end {
            let which = tooth as i64 - (sense * turn) as i64;
            let which = which.rem_euclid(teeth as i64) as usize;
            let (x, y) = (lo + turn * pitch, hi + turn * pitch);
            if lag * (upper - lower) < STRAIGHT_RAD / engaged.edges.len() as f64 {
                if immersion.holds(k, x.max(0.0), by) {
                    let g = flutes.density(which, x, edge);
                    sum = along(sum, g, engaged.weight[k] * (upper - lower));
                }
            } else {
                immersion.stretches(k, (x, y), by, |from, to| {
                    let (p, q) = (flutes.primitive(Some(which), from, edge), flutes.primitive(Some(which), to, edge));
                    sum = along(sum, sub(q, p), engaged.weight[k] / lag);
                });
            }
            turn += 1.0;
        }
    }
    sum
}

/// How far beside its mean place the cutter may be at an instant, mm.
fn slack(mean: Point) -> f64 {
    3.0 * norm(mean) + 0.15
}

fn in_xy(normal: Point, travel: Point, force: Point) -> Point {
    debug_assert!(cross(normal, travel).abs() > 0.9);
    add(scaled(normal, force[0]), scaled(travel, force[1]))
}
