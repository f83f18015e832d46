//! Lines and arcs through a sampled path.
//!
//! Greedy: from the end of the last piece, the longest line or arc whose two ends are samples and which passes all
//! samples between them within the tolerance. All circles through two points form a pencil with one parameter
//! `g = 1/2h` (h: distance of the centre from the chord, left positive; g = 0 is the chord itself). A sample at
//! (u, v) along and left of a chord of length c lies on the circle `g = −v/w`, `w = u(c − u) − v²`, and its distance
//! from any other circle of the pencil is `|g − gₖ|·w/√(1 + g²c²)`, so a tolerance is an interval of g and a piece
//! fits when the intervals of its samples meet. A line is taken whenever 0 lies in all of them. Between the samples
//! the path may bulge over their chord as far as [`Samples::bulges`] says, so no arc cuts a corner.
//!
//! Free arcs need no more pieces than biarcs with matched tangents, because the whole tolerance goes into their
//! number; the heading steps that remain between pieces are of the order of 4·tolerance/length. In the end the
//! tolerance is lowered as far as the number of pieces, and of arcs among them, allows: the samples are then spread
//! evenly over them.
//!
//! Only sums, products, quotients and square roots are used: the result is the same on every host, and turned by 90°
//! or mirrored with its input.
//!
//! Limits: arcs of at most 160°; radii up to a stated one, above which a piece is a line.

use super::vector::{cross, dot, minus};

/// What runs from one sample to a later one. Lengths in nanometres, relative to the first sample.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shape {
    /// A straight line.
    Line,
    /// An arc.
    Arc {
        /// Its centre.
        centre: [f64; 2],
        /// Whether it turns left.
        counter_clockwise: bool,
    },
}

/// A line or arc that ends at a sample; it starts where the one before ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Piece {
    /// Index of the sample at its end.
    pub end: usize,
    /// What it is.
    pub shape: Shape,
}

/// tan(80°): half the largest angle of an arc.
const MAX_HALF_TANGENT: f64 = 5.67;

/// The samples of a path and the points the ends of pieces are rounded to.
#[derive(Clone, Copy, Debug)]
pub struct Samples<'a> {
    /// Where the path passes, nanometres relative to the first sample.
    pub path: &'a [[f64; 2]],
    /// The same points as they will be written.
    pub written: &'a [[f64; 2]],
    /// How far the path may leave the chord between each two samples, nanometres.
    pub bulges: &'a [f64],
    /// The farthest centre from the chord of an arc, nanometres.
    pub max_radius: f64,
}

/// Pieces through all samples within `tolerance` nanometres. A piece between neighbouring samples is always accepted.
pub fn fit(samples: Samples<'_>, tolerance: f64) -> Vec<Piece> {
    let coarse = greedy(samples, tolerance);
    let (mut best, mut low, mut high) = (coarse, 0.0, tolerance);
    for _ in 0..10 {
        let middle = 0.5 * (low + high);
        let finer = greedy(samples, middle);
        if finer.len() <= best.len() && arcs(&finer) <= arcs(&best) {
            (best, high) = (finer, middle);
        } else {
            low = middle;
        }
    }
    best
}

fn arcs(pieces: &[Piece]) -> usize {
    pieces.iter().filter(|piece| piece.shape != Shape::Line).count()
}

fn greedy(samples: Samples<'_>, tolerance: f64) -> Vec<Piece> {
    let last = samples.path.len().saturating_sub(1);
    let mut pieces = Vec::new();
    let mut start = 0;
    while start < last {
        let (end, shape) = longest(samples, start, last, tolerance);
        // A piece whose ends are written as the same point would be no move, or a full circle.
        if samples.written[end] != samples.written[start] {
            pieces.push(Piece { end, shape });
        }
        start = end;
    }
    pieces
}

/// The farthest sample reached from `start` with one piece: doubling steps, then bisection.
fn longest(samples: Samples<'_>, start: usize, last: usize, tolerance: f64) -> (usize, Shape) {
    let mut reached = (start + 1, Shape::Line);
    let mut beyond = last + 1;
    let mut step = 1;
    while reached.0 < last && beyond > last {
        let end = (reached.0 + step).min(last);
        match shape(samples, start, end, tolerance) {
            Some(shape) => reached = (end, shape),
            None => beyond = end,
        }
        step *= 2;
    }
    while beyond <= last && beyond - reached.0 > 1 {
        let end = reached.0 + (beyond - reached.0) / 2;
        match shape(samples, start, end, tolerance) {
            Some(shape) => reached = (end, shape),
            None => beyond = end,
        }
    }
    reached
}

/// The line or arc between two samples that passes those between them within the tolerance.
fn shape(samples: Samples<'_>, start: usize, end: usize, tolerance: f64) -> Option<Shape> {
    let a = samples.written[start];
    let b = minus(samples.written[end], a);
    let chord = dot(b, b).sqrt();
    if chord == 0.0 {
        return None;
    }
    let local = |p: [f64; 2]| (dot(p, b) / chord, cross(b, p) / chord);
    let place = |k: usize| local(minus(samples.path[k], a));
    // The samples between the ends, and the middle of every chord, where the path is less certain.
    let between = |k: usize| {
        let (p, q) = (place(k), place(k + 1));
        ((0.5 * (p.0 + q.0), 0.5 * (p.1 + q.1)), tolerance + samples.bulges[k])
    };
    let points = || (start + 1..end).map(|k| (place(k), tolerance)).chain((start..end).map(between));
    let middle = place(start + (end - start) / 2);
    let estimate = parameter(middle, chord).map_or(0.0, |(g, _)| g);
    let widening = (1.0 + (estimate * chord) * (estimate * chord)).sqrt();
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    for ((u, v), tolerance) in points() {
        match parameter((u, v), chord) {
            Some((g, w)) => {
                low = low.max(g - tolerance * widening / w);
                high = high.min(g + tolerance * widening / w);
            }
            // On or outside the circle over the chord: only the ends themselves may lie there.
            None if u * u + v * v <= tolerance * tolerance => {}
            None if (u - chord) * (u - chord) + v * v <= tolerance * tolerance => {}
            None => return None,
        }
        if low > high {
            return None;
        }
    }
    // The slack was an estimate, to first order in the distance, and a chord is farthest from a circle where it is nearest to its centre;
    // what counts is the distance from the circle that is taken.
    let passes = |g: f64| {
        let nearest = |k: usize| {
            let (p, q) = (place(k), place(k + 1));
            let (along, to_centre) = ([q.0 - p.0, q.1 - p.1], [0.5 * chord - p.0, 0.5 / g - p.1]);
            let u = (dot(to_centre, along) / dot(along, along).max(1e-9)).clamp(0.0, 1.0);
            ((p.0 + u * along[0], p.1 + u * along[1]), tolerance + samples.bulges[k])
        };
        let fits = |(p, t): ((f64, f64), f64)| distance(p, chord, g) <= t;
        points().all(fits) && (g == 0.0 || (start..end).map(nearest).all(fits))
    };
    if low <= 0.0 && high >= 0.0 && passes(0.0) {
        return Some(Shape::Line);
    }
    let middle = 0.5 * (low + high);
    // 1/2h of the farthest centre.
    let least = 0.5 / samples.max_radius;
    let g = if middle < 0.0 { middle.min(-least).max(low) } else { middle.max(least).min(high) };
    if g.abs() < least || (g * chord).abs() > MAX_HALF_TANGENT || !passes(g) {
        return None;
    }
    let h = 0.5 / g;
    // Half the chord along it, h to its left.
    let centre = [a[0] + 0.5 * b[0] - h * b[1] / chord, a[1] + 0.5 * b[1] + h * b[0] / chord];
    Some(Shape::Arc { centre, counter_clockwise: g > 0.0 })
}

/// Parameter of the circle through both ends of the chord and a point, and the point's weight; `None` on or outside
/// the circle that has the chord as its diameter.
fn parameter((u, v): (f64, f64), chord: f64) -> Option<(f64, f64)> {
    let w = u * (chord - u) - v * v;
    (w > 0.0).then(|| (-v / w, w))
}

/// Distance of a point from the circle of the pencil, or from the chord's line for g = 0: the power of the point, −(w + v/g), over the
/// sum of its distance from the centre and the radius.
fn distance((u, v): (f64, f64), chord: f64, g: f64) -> f64 {
    let power = v + g * (u * (chord - u) - v * v);
    if g == 0.0 {
        return power.abs();
    }
    let (half, h) = (0.5 * chord, 0.5 / g);
    let from_centre = [u - half, v - h];
    (power / g).abs() / (dot(from_centre, from_centre).sqrt() + (half * half + h * h).sqrt())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A bend of the kind a correction leaves: a straight, a corner of 20 mm radius, a straight, all displaced by a bump.
    fn bend() -> Vec<[f64; 2]> {
        let mut path = Vec::new();
        for i in 0..=1000 {
            let s = f64::from(i) * 0.1;
            let (x, y) = match s {
                s if s < 30.0 => (s, 0.0),
                s if s < 61.4 => {
                    let a = (s - 30.0) / 20.0;
                    (30.0 + 20.0 * a.sin(), 20.0 - 20.0 * a.cos())
                }
                s => (50.0, 20.0 + s - 61.4),
            };
            let bump = 0.2 / (1.0 + ((s - 40.0) / 8.0).powi(2));
            path.push([((x - bump) * 1e6).round(), ((y + 0.5 * bump) * 1e6).round()]);
        }
        path
    }

    fn fit(path: &[[f64; 2]], tolerance: f64) -> Vec<Piece> {
        let bulges = crate::spacing::bulges(path, 0.0);
        super::fit(Samples { path, written: path, bulges: &bulges, max_radius: 1e10 }, tolerance)
    }

    #[test]
    fn a_straight_is_one_line_and_a_circle_a_few_arcs() {
        let line: Vec<_> = (0..500).map(|i| [f64::from(i) * 60_000.0, f64::from(i) * 80_000.0]).collect();
        assert_eq!(fit(&line, 100.0), [Piece { end: 499, shape: Shape::Line }]);
        let circle: Vec<_> =
            (0..=1440).map(|i| f64::from(i).to_radians() / 4.0).map(|a| [8e6 * a.cos() - 8e6, 8e6 * a.sin()]).collect();
        let pieces = fit(&circle, 100.0);
        assert_eq!(pieces.len(), 3);
        for piece in pieces {
            let Shape::Arc { centre, counter_clockwise } = piece.shape else { panic!("a circle needs arcs") };
            assert!((centre[0] + 8e6).hypot(centre[1]) < 200.0 && counter_clockwise, "centre {centre:?}");
        }
    }

    #[test]
    fn a_corrected_corner_needs_few_pieces_and_a_tighter_tolerance_not_fewer() {
        let path = bend();
        let mut last = 0;
        for tolerance in [5_000.0, 1_000.0, 300.0] {
            let count = fit(&path, tolerance).len();
            assert!(count >= last && count <= 40, "{count} pieces at {tolerance} nm");
            last = count;
        }
    }

    #[test]
    fn the_fit_turns_and_mirrors_with_the_path_to_the_last_bit() {
        let path = bend();
        let upright = fit(&path, 1_000.0);
        let maps: [fn([f64; 2]) -> [f64; 2]; 3] = [|p| [-p[1], p[0]], |p| [-p[0], -p[1]], |p| [p[0], -p[1]]];
        for (index, map) in maps.into_iter().enumerate() {
            let turned: Vec<_> = path.iter().copied().map(map).collect();
            let expected: Vec<_> = upright
                .iter()
                .map(|piece| match piece.shape {
                    Shape::Line => *piece,
                    Shape::Arc { centre, counter_clockwise } => {
                        let shape =
                            Shape::Arc { centre: map(centre), counter_clockwise: counter_clockwise != (index == 2) };
                        Piece { end: piece.end, shape }
                    }
                })
                .collect();
            assert_eq!(fit(&turned, 1_000.0), expected, "map {index}");
        }
    }

    #[test]
    fn a_short_chord_of_a_large_circle_stays_a_line() {
        let on_circle = |i: i32| [f64::from(i) * 13_000.0, -(f64::from(i) * 13_000.0).powi(2) / 2e8];
        let path: Vec<_> = (0..4).map(on_circle).collect();
        assert_eq!(fit(&path, 1_000.0), [Piece { end: 3, shape: Shape::Line }]);
    }

    #[test]
    fn a_sample_that_stands_out_is_passed_however_short_the_piece() {
        let mut path: Vec<_> = (0..40).map(|i| [f64::from(i) * 1e5, 0.0]).collect();
        path.push([4.0e6 - 7_000.0, 23_000.0]);
        path.push([4.0e6, 0.0]);
        let ends: Vec<_> = fit(&path, 1_000.0).iter().map(|p| p.end).collect();
        assert_eq!(ends, [39, 40, 41]);
    }

    #[test]
    fn a_corner_is_kept_as_a_corner() {
        let mut path: Vec<_> = (0..=100).map(|i| [f64::from(i) * 1e5, 0.0]).collect();
        path.extend((1..=100).map(|i| [1e7, f64::from(i) * 1e5]));
        let ends: Vec<_> = fit(&path, 1_000.0).iter().map(|p| (p.end, p.shape)).collect();
        assert_eq!(ends, [(100, Shape::Line), (200, Shape::Line)]);
    }

    #[test]
    fn the_distance_from_a_circle_is_exact_however_near_its_centre_a_point_lies() {
        for g in [0.5, -0.5, 0.02, -0.02, 1e-9] {
            let (chord, h): (f64, f64) = (2.0, 0.5 / g);
            let radius = (1.0 + h * h).sqrt();
            for (u, v) in [(1.0, 0.3), (0.2, -0.4), (1.9, 1.1), (1.0, h), (-3.0, 2.0)] {
                let exact = ((u - 1.0f64).hypot(v - h) - radius).abs();
                assert!((distance((u, v), chord, g) - exact).abs() < 1e-6, "{g} {u} {v}");
            }
        }
        assert_eq!(distance((0.3, -0.7), 2.0, 0.0), 0.7);
    }

    #[test]
    fn no_arc_through_a_path_that_goes_to_and_fro_leaves_its_chords_by_more_than_they_are_granted() {
        // Samples 0.1 mm apart, up to 60 µm beside a line: arcs of little more than the spacing pass three of them.
        let mut state = 1u64;
        let mut chance = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
            (state >> 40) as f64 / f64::from(1 << 24) - 0.5
        };
        let path: Vec<_> = (0..4_000).map(|i| [(f64::from(i) * 1e5).round(), (chance() * 1.2e5).round()]).collect();
        let bulges = crate::spacing::bulges(&path, 0.0);
        let (mut start, mut arcs) = (0, 0);
        for piece in fit(&path, 1_000.0) {
            if let Shape::Arc { centre, .. } = piece.shape {
                arcs += 1;
                let radius = (path[start][0] - centre[0]).hypot(path[start][1] - centre[1]);
                for k in start..piece.end {
                    let (p, q) = (path[k], path[k + 1]);
                    for step in 0..=100 {
                        let u = f64::from(step) / 100.0;
                        let at = [p[0] + u * (q[0] - p[0]) - centre[0], p[1] + u * (q[1] - p[1]) - centre[1]];
                        let off = (at[0].hypot(at[1]) - radius).abs();
                        assert!(off <= 1_000.0 + bulges[k] + 1e-3, "{off} of {} behind sample {k}", bulges[k]);
                    }
                }
            }
            start = piece.end;
        }
        assert!(arcs > 20, "{arcs}");
    }
}
