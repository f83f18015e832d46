//! The raw stock before this pass: a surface, with material on the wall's side of it.
//!
//! Without a measured surface it is the parallel curve of the nominal centre path at `r − h` towards the wall, h varying smoothly
//! if the machine says so. An open path is extended tangentially by 40 mm at both ends, a closed one is closed. Where the two
//! ends of a path run out beyond an outside corner, the stock has its corner where the two curves cross; where the end runs over
//! the start, it is closed there.
//!
//! Limit: the stock does not vary with height.

use std::f64::consts::{PI, TAU};

use super::arcs::EngagedArcs;
use super::grid::Grid;
use super::machine::Machine;
use super::parallel::{closed_at_its_ends, parallel_curve};
use super::path::Path;
use super::setup::Cut;
use super::vector::{Point, add, along, cross, dot, mix, scaled, squared_distance, sub, unit};

/// Straight run of stock before and after an open path, mm.
const EXTENSION_MM: f64 = 40.0;
/// Pieces of straight runs, mm: small enough for the search by mid-points.
const PIECE_MM: f64 = 1.0;

/// Raw stock and the index to search it.
#[derive(Debug, Clone)]
pub(super) struct Stock {
    points: Vec<Point>,
    closed: bool,
    side: f64,
    pieces: Grid,
}

/// Frame in which immersion is measured: centre, direction of travel, normal to the wall.
#[derive(Debug, Clone, Copy)]
pub(super) struct Frame {
    pub(super) centre: Point,
    pub(super) tangent: Point,
    pub(super) normal: Point,
    pub(super) radius: f64,
}

impl Frame {
    /// Point of the circumference at the immersion φ.
    pub(super) fn at(&self, phi: f64) -> Point {
        let (s, c) = phi.sin_cos();
        along(along(self.centre, self.normal, self.radius * c), self.tangent, self.radius * s)
    }

    /// Immersion of the direction towards `p`, −π…π.
    pub(super) fn immersion(&self, p: Point) -> f64 {
        let v = sub(p, self.centre);
        dot(v, self.tangent).atan2(dot(v, self.normal))
    }
}

impl Stock {
    /// Its points, closed or not, and the sign of the side on which material lies: 1 on the left.
    pub(super) fn outline(&self) -> (&[Point], bool, f64) {
        (&self.points, self.closed, self.side)
    }

    pub(super) fn new(path: &Path, cut: &Cut, machine: &Machine) -> Self {
        let (points, closed) = match &cut.surface {
            Some(points) if path.closed => (points.clone(), true),
            Some(points) => (extended(points.clone()), false),
            None => {
                let curve = parallel_curve(path, cut, machine);
                match (closed_at_its_ends(&curve, path.side), path.closed) {
                    (Some(closed), _) => (closed, true),
                    (None, true) => (curve, true),
                    (None, false) => (extended(curve), false),
                }
            }
        };
        let points = subdivided(&points, closed);
        let count = points.len();
        let pieces = if closed { count } else { count - 1 };
        let mid = |k: usize| scaled(add(points[k], points[(k + 1) % count]), 0.5);
        let pieces = Grid::of(cut.radius_mm.max(2.0), (0..pieces).map(mid));
        Self { points, closed, side: path.side.sign(), pieces }
    }

    /// Pieces of the surface that a circle of `radius` about a centre within `slack` of `centre` can meet.
    pub(super) fn near(&self, centre: Point, radius: f64, slack: f64, found: &mut Vec<u32>) {
        self.pieces.near(centre, radius + slack + PIECE_MM, found);
    }

    /// Part of the circumference ahead of the wall point that lies in the raw stock; `pieces` as found by `near`.
    pub(super) fn engaged(&self, frame: &Frame, pieces: &[u32]) -> EngagedArcs {
        // (φ in 0…2π, the circumference enters the stock there)
        let mut crossings: Vec<(f64, bool)> = Vec::new();
        for &k in pieces {
            self.cross_piece(frame, k as usize, &mut crossings);
        }
        crossings.sort_by(|a, b| a.0.total_cmp(&b.0));
        let mut arcs = Vec::new();
        let n = crossings.len();
        if n == 0 {
            if self.contains(frame.at(0.0), pieces) {
                arcs.push([0.0, PI]);
            }
            return EngagedArcs::from_intervals(arcs);
        }
        for i in 0..n {
            let (from, enters) = crossings[i];
            let (mut to, again) = crossings[(i + 1) % n];
            if i + 1 == n {
                to += TAU;
            }
            // Two crossings of the same kind in a row: the surface is folded or touched; ask for the middle instead.
            let inside = if enters != again { enters } else { self.contains(frame.at(0.5 * (from + to)), pieces) };
            if inside {
                for shift in [-TAU, 0.0] {
                    let (lo, hi) = ((from + shift).max(0.0), (to + shift).min(PI));
                    if hi > lo {
                        arcs.push([lo, hi]);
                    }
                }
            }
        }
        arcs.sort_by(|a, b| a[0].total_cmp(&b[0]));
        EngagedArcs::from_intervals(arcs)
    }

    fn cross_piece(&self, frame: &Frame, k: usize, crossings: &mut Vec<(f64, bool)>) {
        let (a, b) = self.piece(k);
        let (d, v) = (sub(b, a), sub(a, frame.centre));
        let (dd, dv) = (dot(d, d), dot(d, v));
        let disc = dv * dv - dd * (dot(v, v) - frame.radius * frame.radius);
        if dd < 1e-18 || disc <= 0.0 {
            return;
        }
        for root in [-disc.sqrt(), disc.sqrt()] {
            let u = (root - dv) / dd;
            if (0.0..1.0).contains(&u) {
                let p = along(a, d, u);
                let phi = frame.immersion(p).rem_euclid(TAU);
                let (s, c) = phi.sin_cos();
                // Direction in which φ grows at p.
                let onward = along(scaled(frame.tangent, c), frame.normal, -s);
                crossings.push((phi, self.side * cross(d, onward) > 0.0));
            }
        }
    }

    fn piece(&self, k: usize) -> (Point, Point) {
        (self.points[k], self.points[(k + 1) % self.points.len()])
    }

    /// `p` is on the wall's side of the nearest piece; nothing near counts as air.
    fn contains(&self, p: Point, pieces: &[u32]) -> bool {
        let mut best = f64::INFINITY;
        let mut inside = false;
        for &k in pieces {
            let k = k as usize;
            let (a, b) = self.piece(k);
            let d = sub(b, a);
            let dd = dot(d, d);
            if dd < 1e-18 {
                continue;
            }
            let u = (dot(sub(p, a), d) / dd).clamp(0.0, 1.0);
            let foot = along(a, d, u);
            let distance = squared_distance(p, foot);
            if distance < best {
                best = distance;
                // At a vertex the sum of both headings decides.
                let heading = if u <= 0.0 {
                    self.heading_with(d, k.checked_sub(1))
                } else if u >= 1.0 {
                    self.heading_with(d, Some(k + 1))
                } else {
                    d
                };
                inside = self.side * cross(heading, sub(p, foot)) > 0.0;
            }
        }
        inside
    }

    fn heading_with(&self, d: Point, neighbour: Option<usize>) -> Point {
        let count = self.points.len();
        let last = if self.closed { count } else { count - 1 };
        let neighbour = match neighbour {
            Some(k) if k < last => k,
            Some(_) if self.closed => 0,
            None if self.closed => last - 1,
            _ => return d,
        };
        let (a, b) = self.piece(neighbour);
        let other = sub(b, a);
        if dot(other, other) < 1e-18 {
            return d;
        }
        add(unit(d), unit(other))
    }
}

fn extended(mut points: Vec<Point>) -> Vec<Point> {
    let n = points.len();
    if n < 2 {
        return points;
    }
    let before = unit(sub(points[0], points[1]));
    let after = unit(sub(points[n - 1], points[n - 2]));
    points.insert(0, along(points[0], before, EXTENSION_MM));
    points.push(along(points[n], after, EXTENSION_MM));
    points
}

fn subdivided(points: &[Point], closed: bool) -> Vec<Point> {
    let n = points.len();
    let pieces = if closed { n } else { n - 1 };
    let mut out = Vec::with_capacity(n + 100);
    for k in 0..pieces {
        let (a, b) = (points[k], points[(k + 1) % n]);
        let parts = (super::vector::distance(a, b) / PIECE_MM).ceil().max(1.0);
        for j in 0..parts as usize {
            out.push(mix(a, b, j as f64 / parts));
        }
    }
    if !closed {
        out.push(points[n - 1]);
    }
    out
}
