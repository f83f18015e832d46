//! How deep the cutter's circumference lies in material, for every slice.
//!
//! The circumference is known where rays cross it: there the depth is exactly how far the circle goes along the ray less where
//! the stock begins on it. Between two rays the depth is linear in cos φ, as it is beside an even wall. A slice that is displaced
//! against the centre by h lies deeper by h·n, n the normal of the ray. So one search over the rays serves all slices, and all
//! instants within a turn of the cutter. The engaged set may be several stretches: it is where the depth is positive.
//!
//! Limits: immersion 0…π, ahead of the place where the wall is made; the stock is no deeper than the cutter's radius; displacements
//! within a turn are small against the waves of the stock.

use super::field::Field;
use super::rays::{Ray, Rays};
use crate::vector::{Point, dot, mix, scaled, sub};

/// Rays looked at to either side for the one at which the wall is made.
const SEARCH: usize = 600;
/// Rays ahead at most.
const MOST: usize = 4000;

/// Where the cutter is and how immersion is counted.
#[derive(Debug, Clone, Copy)]
pub(super) struct Stand {
    pub(super) centre: Point,
    /// Direction of travel of the run.
    pub(super) travel: Point,
    pub(super) normal: Point,
    pub(super) radius: f64,
    /// Ray of the nominal place.
    pub(super) ray: usize,
    /// Against the sense of the contour.
    pub(super) reversed: bool,
}

/// Depths along the circumference.
#[derive(Debug, Clone, Default)]
pub(super) struct Immersion {
    /// Immersion of the crossings, ascending, rad.
    pub(super) phi: Vec<f64>,
    cos: Vec<f64>,
    normal: Vec<Point>,
    /// By crossing, then by slice, mm; negative in the air.
    depth: Vec<f64>,
    slices: usize,
    /// By slice, the immersion beyond which it is in the air.
    ends: Vec<f64>,
}

/// A ray's crossing: immersion, and how far beyond the nominal wall, mm.
fn met(stand: &Stand, ray: &Ray) -> Option<(f64, f64)> {
    let v = sub(stand.centre, ray.foot);
    let on_ray = dot(v, ray.normal);
    let room = stand.radius * stand.radius - (dot(v, v) - on_ray * on_ray);
    if room < 0.0 {
        return None;
    }
    let out = on_ray + room.sqrt();
    let u = [ray.normal[0] * out - v[0], ray.normal[1] * out - v[1]];
    Some((dot(u, stand.travel).atan2(dot(u, stand.normal)), out - stand.radius))
}

impl Immersion {
    /// Finds the depths for a centre; slice k is displaced against it by `beside` times `share[k]`. Only the slices from
    /// `first` on count. Depths less than −`slack` everywhere are left out at the end.
    pub(super) fn find(
        &mut self,
        stand: &Stand,
        rays: &Rays,
        field: &Field,
        first: usize,
        (beside, share): (Point, &[f64]),
        slack: f64,
    ) {
        self.phi.clear();
        self.cos.clear();
        self.normal.clear();
        self.depth.clear();
        self.slices = share.len();
        let onward = |number: usize, back: bool| {
            if stand.reversed == back { Some(number + 1) } else { number.checked_sub(1) }
        };
        let at = |number: usize| rays.ray(number).and_then(|ray| Some((*ray, met(stand, ray)?)));
        // The last ray behind the place where the wall is made, or on it.
        let mut number = stand.ray;
        for _ in 0..SEARCH {
            if at(number).is_some_and(|(_, (phi, _))| phi <= 0.0) {
                break;
            }
            match onward(number, true) {
                Some(next) if rays.ray(next).is_some() => number = next,
                _ => break,
            }
        }
        let mut before = at(number).filter(|(_, (phi, _))| *phi <= 0.0);
        for _ in 0..MOST {
            let Some(next) = onward(number, false).filter(|n| rays.ray(*n).is_some()) else { break };
            number = next;
            let Some((ray, (phi, beyond))) = at(number) else {
                if self.phi.is_empty() && before.is_some() { continue } else { break }
            };
            if phi <= 0.0 {
                if self.phi.is_empty() {
                    before = Some((ray, (phi, beyond)));
                }
                continue;
            }
            if let Some((a, (phi_a, beyond_a))) = before.take() {
                let u = -phi_a / (phi - phi_a).max(1e-12);
                let normal = mix(a.normal, ray.normal, u);
                let left = field.row(a.row)[first..].iter().zip(&field.row(ray.row)[first..]);
                let base = beyond_a + (beyond - beyond_a) * u;
                let sideways = dot(beside, normal);
                self.depth.extend(left.zip(share).map(|((a, b), g)| base + a + (b - a) * u + g * sideways));
                self.mark(0.0, normal);
            }
            // Rays of another leg cross those of this one beside an outside corner; they come second.
            if self.phi.last().is_some_and(|last| phi <= *last) {
                continue;
            }
            let sideways = dot(beside, ray.normal);
            let left = &field.row(ray.row)[first..];
            self.depth.extend(left.iter().zip(share).map(|(a, g)| beyond + a + g * sideways));
            self.mark(phi, ray.normal);
        }
        let live = |row: &[f64]| row.iter().any(|d| *d > -slack);
        let used =
            self.depth.chunks(self.slices.max(1)).rposition(live).map_or(0, |last| (last + 2).min(self.phi.len()));
        self.phi.truncate(used);
    }

    fn mark(&mut self, phi: f64, normal: Point) {
        self.phi.push(phi);
        self.cos.push(phi.cos());
        self.normal.push(normal);
    }

    /// Integrates over the engaged stretches of all slices together: `primitive` at the crossings is `at`, between them
    /// `between`; every slice counts with its weight. Gives the integral and the largest immersion.
    pub(super) fn integrate(
        &self,
        weight: &[f64],
        at: &[[f64; 2]],
        between: impl Fn(f64) -> [f64; 2],
    ) -> ([f64; 2], f64) {
        let (mut sum, mut leaves) = ([0.0; 2], 0.0f64);
        let n = self.slices;
        for j in 1..self.phi.len() {
            let (a, b) = (&self.depth[(j - 1) * n..j * n], &self.depth[j * n..(j + 1) * n]);
            let mut whole = 0.0;
            for ((&da, &db), &w) in a.iter().zip(b).zip(weight) {
                if da > 0.0 && db > 0.0 {
                    whole += w;
                } else if da > 0.0 || db > 0.0 {
                    let cos = self.cos[j - 1] + (self.cos[j] - self.cos[j - 1]) * da / (da - db);
                    let phi = cos.clamp(-1.0, 1.0).acos();
                    let part = between(phi);
                    let (lo, hi) = if da > 0.0 { (at[j - 1], part) } else { (part, at[j]) };
                    sum[0] += w * (hi[0] - lo[0]);
                    sum[1] += w * (hi[1] - lo[1]);
                    leaves = leaves.max(if da > 0.0 { phi } else { self.phi[j] });
                }
            }
            if whole > 0.0 {
                sum[0] += whole * (at[j][0] - at[j - 1][0]);
                sum[1] += whole * (at[j][1] - at[j - 1][1]);
                leaves = leaves.max(self.phi[j]);
            }
        }
        (sum, leaves)
    }

    /// Gives the engaged stretches of a slice between two immersions to `visit`; the slice is displaced by `by` from where the
    /// depths hold.
    pub(super) fn stretches(&self, slice: usize, (from, to): (f64, f64), by: Point, mut visit: impl FnMut(f64, f64)) {
        let Some(&end) = self.phi.last() else { return };
        let (from, to) = (from.max(self.phi[0]), to.min(end));
        if from > to {
            return;
        }
        let depth = |j: usize| self.depth[j * self.slices + slice] + dot(by, self.normal[j]);
        let mut j = self.phi.partition_point(|phi| *phi <= from).clamp(1, (self.phi.len() - 1).max(1));
        if self.phi.len() < 2 {
            return;
        }
        let (mut a, mut da) = (from, 0.0);
        let mut started = false;
        let mut open: Option<f64> = None;
        while j < self.phi.len() {
            let (d0, d1) = (depth(j - 1), depth(j));
            let (c0, c1) = (self.cos[j - 1], self.cos[j]);
            let inside = |phi: f64| if c1 == c0 { d0 } else { d0 + (d1 - d0) * (c0 - phi.cos()) / (c0 - c1) };
            if !started {
                da = inside(a);
                started = true;
                open = (da > 0.0).then_some(a);
            }
            let b = self.phi[j].min(to);
            let db = if b == self.phi[j] { d1 } else { inside(b) };
            if (da > 0.0) != (db > 0.0) {
                let (ca, cb) = (a.cos(), b.cos());
                let phi = (ca + (cb - ca) * da / (da - db)).clamp(-1.0, 1.0).acos();
                match open.take() {
                    Some(start) => visit(start, phi),
                    None => open = Some(phi),
                }
            }
            (a, da) = (b, db);
            if b >= to {
                break;
            }
            j += 1;
        }
        if let Some(start) = open {
            visit(start, a);
        }
    }

    /// Whether a slice is in material at an immersion.
    pub(super) fn holds(&self, slice: usize, phi: f64, by: Point) -> bool {
        let mut found = false;
        self.stretches(slice, (phi, phi), by, |_, _| found = true);
        found
    }

    /// Notes for every slice beyond which immersion it is in the air by more than `slack`.
    pub(super) fn bound(&mut self, slack: f64) {
        let n = self.slices;
        self.ends.clear();
        self.ends.resize(n, f64::NEG_INFINITY);
        for (j, row) in self.depth.chunks(n.max(1)).take(self.phi.len()).enumerate() {
            let beyond = self.phi[(j + 1).min(self.phi.len() - 1)];
            for (end, depth) in self.ends.iter_mut().zip(row) {
                if *depth > -slack {
                    *end = beyond;
                }
            }
        }
    }

    /// The largest immersion at which a slice may be in material.
    pub(super) fn end(&self, slice: usize) -> f64 {
        self.ends.get(slice).copied().unwrap_or(f64::NEG_INFINITY)
    }
}

/// Displacement of a slice at `reach` when the centre is displaced from `from` to `to`.
pub(super) fn moved(from: Point, to: Point, reach: f64) -> Point {
    scaled(sub(to, from), reach)
}
