//! The largest distance of a moving point from a convex set, with a proof that no larger one exists.
//!
//! The distance from a convex set is a convex function of the place. On a piece of the way of width h the point stays
//! within h²/8·M of the straight line between the piece's ends, M a bound on its second derivative there; so its distance
//! is at most the larger of the ends' distances plus h²/8·M. The piece with the largest such bound is halved until the
//! bound meets the largest distance found (branch and bound). Several local maxima, plateaus and loops are all the same
//! to it. Near a maximum the bound closes in by a factor of four a halving or better, so that a handful of pieces a
//! halving remains, and some ten to thirty evaluations give six digits.
//!
//! Limits: at most [`MOST_PIECES`] pieces; then the bound is what is proved by then, larger than need be but true.

use std::cmp::Ordering;
use std::collections::BinaryHeap;

use super::super::kinematics::Jet;
use super::super::vector::Vector;

/// Pieces after which the search stops.
pub(in super::super) const MOST_PIECES: usize = 20_000;

/// A piece of the way, its ends and the middle with its derivatives.
pub(in super::super) struct Sample<'p> {
    pub(in super::super) from: Vector,
    pub(in super::super) to: Vector,
    pub(in super::super) middle: &'p Jet,
    /// Half the width of the piece in the parameter.
    pub(in super::super) half: f64,
}

/// A moving point and the convex set its distance is taken from.
pub(in super::super) trait Curve {
    /// Distance of a place from the set.
    fn distance(&self, place: Vector) -> f64;
    /// Place and derivatives at a parameter 0…1.
    fn jet(&self, t: f64) -> Jet;
    /// Bound on the distance over a piece, whose ends' larger distance is `ends`.
    fn ceiling(&self, piece: &Sample<'_>, ends: f64) -> f64;
    /// Bound on the second derivative over the whole way.
    fn steepest_bend(&self) -> f64;
    /// Rounding error of a distance.
    fn rounding(&self) -> f64;
}

/// A maximum with its proof.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Largest {
    /// The largest distance found.
    pub(in super::super) value: f64,
    /// Where.
    pub(in super::super) at: f64,
    /// No distance is larger.
    pub(in super::super) bound: f64,
}

/// The largest distance, to within the larger of an absolute and a relative slack.
pub(in super::super) fn largest(curve: &impl Curve, absolute: f64, relative: f64) -> Largest {
    let mut search = Search::new(curve);
    while search.bound() - search.best.0 > absolute.max(relative * search.best.0) && search.halve() {}
    search.polish();
    let (value, at) = search.best;
    Largest { value, at, bound: search.bound().max(value) + curve.rounding() }
}

/// Whether the distance is proved to stay at or below a limit.
pub(in super::super) fn stays_within(curve: &impl Curve, limit: f64) -> bool {
    let limit = limit - curve.rounding();
    if curve.steepest_bend() / 8.0 <= limit {
        return true;
    }
    let mut search = Search::new(curve);
    loop {
        if search.bound() <= limit {
            return true;
        }
        if search.best.0 > limit || !search.halve() {
            return false;
        }
    }
}

struct Piece {
    bound: f64,
    from: (f64, Vector),
    to: (f64, Vector),
    middle: Vector,
}

struct Search<'c, C> {
    curve: &'c C,
    /// Largest distance found, and where.
    best: (f64, f64),
    open: BinaryHeap<Piece>,
    /// Bound of the pieces that can be halved no more.
    closed: f64,
    made: usize,
}

impl<'c, C: Curve> Search<'c, C> {
    fn new(curve: &'c C) -> Self {
        let (from, to) = (curve.jet(0.0).place, curve.jet(1.0).place);
        let mut search = Self { curve, best: (0.0, 0.0), open: BinaryHeap::new(), closed: 0.0, made: 0 };
        search.open((0.0, from), (1.0, to));
        search
    }

    /// No distance is larger than this.
    fn bound(&self) -> f64 {
        self.open.peek().map_or(0.0, |piece| piece.bound).max(self.closed).max(self.best.0)
    }

    fn open(&mut self, from: (f64, Vector), to: (f64, Vector)) {
        let middle_t = (from.0 + to.0) / 2.0;
        let half = (to.0 - from.0) / 2.0;
        let middle = self.curve.jet(middle_t);
        let here = self.curve.distance(middle.place);
        if here > self.best.0 {
            self.best = (here, middle_t);
        }
        let ends = self.curve.distance(from.1).max(self.curve.distance(to.1));
        let bound = self.curve.ceiling(&Sample { from: from.1, to: to.1, middle: &middle, half }, ends);
        // What is not a number proves nothing.
        let known = bound.is_finite() && here.is_finite();
        let bound = if known { bound.max(here) } else { f64::INFINITY };
        self.made += 1;
        self.open.push(Piece { bound, from, to, middle: middle.place });
    }

    /// Halves the piece with the largest bound; `false` when that is not possible any more.
    fn halve(&mut self) -> bool {
        if self.made >= MOST_PIECES {
            return false;
        }
        let Some(piece) = self.open.pop() else { return false };
        let middle = (piece.from.0 + piece.to.0) / 2.0;
        if !(piece.from.0 < middle && middle < piece.to.0 && piece.bound.is_finite()) {
            self.closed = self.closed.max(piece.bound);
            return piece.bound.is_finite();
        }
        self.open(piece.from, (middle, piece.middle));
        self.open((middle, piece.middle), piece.to);
        true
    }

    /// Vertex of the parabola through three near places, while that finds a larger distance: more digits of the place.
    fn polish(&mut self) {
        for _ in 0..4 {
            let (value, t) = self.best;
            let (low, high) = ((t - 1e-3).max(0.0), (t + 1e-3).min(1.0));
            let at = |t: f64| self.curve.distance(self.curve.jet(t).place);
            let (p, q) = ((t - low) * (value - at(high)), (t - high) * (value - at(low)));
            let vertex = t - ((t - low) * p - (t - high) * q) / (2.0 * (p - q));
            if !(0.0..=1.0).contains(&vertex) {
                return;
            }
            let there = at(vertex);
            if there.is_nan() || there <= value {
                return;
            }
            self.best = (there, vertex);
        }
    }
}

impl PartialEq for Piece {
    fn eq(&self, other: &Self) -> bool {
        self.cmp(other) == Ordering::Equal
    }
}
impl Eq for Piece {}
impl PartialOrd for Piece {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}
impl Ord for Piece {
    fn cmp(&self, other: &Self) -> Ordering {
        self.bound.total_cmp(&other.bound)
    }
}
