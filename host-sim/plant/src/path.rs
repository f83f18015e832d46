//! The nominal path of the cutter's centre, sampled evenly, with heading and normal towards the wall.
//!
//! Programs made by a CAM system describe curves by many short lines. The heading of such a curve must turn steadily, or the
//! force would jump at every vertex: at a vertex that turns by less than 15° the heading changes linearly over half the shorter
//! neighbour on both sides. That distance is bounded so that the implied rounding of the vertex stays below 0.0125 mm; a kink
//! between two long lines therefore stays a kink.
//!
//! Limits: a vertex that turns by 15° or more is a corner of the path; one sample lies on it and has the heading of what follows.

use super::error::{PlantError, require};
use super::segment::Segment;
use super::vector::{Point, along, distance, left_of, scaled, turn, turned};

/// A wall that advances by less than this share of the path stands still.
const STANDS: f64 = 0.05;

/// A vertex that turns less than this is a facet of a smooth curve.
pub(super) const FACET_RAD: f64 = 15.0 * std::f64::consts::PI / 180.0;
/// Half-length over which a facet of turn α is smoothed is at most this / α, mm·rad: a chord error of a quarter of it.
const FACET_MM_RAD: f64 = 0.05;
/// Pieces of at least so many steps are sampled each for itself.
const LONG_STEPS: f64 = 5.0;
/// Ends closer than this meet, mm.
const JOIN_MM: f64 = 0.01;

/// On which side of the direction of travel the finished wall lies.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Side {
    /// Wall on the left of travel (+1).
    Left,
    /// Wall on the right of travel (−1).
    Right,
}

impl Side {
    /// +1 for left, −1 for right.
    pub fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// Sampled centre path. Index the four vectors together.
#[derive(Debug, Clone)]
pub struct Path {
    /// Distance along the path, mm, strictly increasing from 0 to `length_mm`.
    pub s_mm: Vec<f64>,
    /// Centre, mm.
    pub centre: Vec<Point>,
    /// Unit direction of travel.
    pub tangent: Vec<Point>,
    /// Unit normal from the centre towards the finished wall.
    pub normal: Vec<Point>,
    /// Side of the wall.
    pub side: Side,
    /// Length, mm.
    pub length_mm: f64,
    /// Largest distance between samples, mm.
    pub step_mm: f64,
    /// The path ends where it starts.
    pub closed: bool,
}

/// A segment with the heading corrections at its two ends.
struct Piece {
    segment: Segment,
    length: f64,
    start: Facet,
    end: Facet,
}

/// Heading correction: `angle` at the vertex, falling to 0 at `reach`.
#[derive(Clone, Copy, Default)]
struct Facet {
    angle: f64,
    reach: f64,
}

impl Facet {
    fn at(self, distance: f64) -> f64 {
        if distance < self.reach { self.angle * (1.0 - distance / self.reach) } else { 0.0 }
    }
}

impl Piece {
    fn at(&self, x: f64) -> (Point, Point) {
        let (p, t) = self.segment.at(x / self.length);
        (p, turned(t, self.start.at(x) + self.end.at(self.length - x)))
    }
}

impl Path {
    /// Samples the joined `segments` at most `step_mm` (0.005…1 mm; 0.1 is usual) apart. Segments of zero length are left out.
    ///
    /// # Errors
    /// `EmptyPath`, `Gap` (more than 0.01 mm), `ArcRadii`, `OutOfRange` for the step.
    pub fn new(segments: &[Segment], side: Side, step_mm: f64) -> Result<Self, PlantError> {
        require((0.005..=1.0).contains(&step_mm), "step_mm", step_mm, "0.005 to 1 mm")?;
        let mut pieces: Vec<Piece> = Vec::with_capacity(segments.len());
        for (index, &segment) in segments.iter().enumerate() {
            segment.check(index)?;
            if let Some(before) = pieces.last() {
                let gap_mm = distance(before.segment.to(), segment.from());
                if gap_mm.is_nan() || gap_mm > JOIN_MM {
                    return Err(PlantError::Gap { segment: index, gap_mm });
                }
            }
            let length = segment.length();
            if length > 1e-6 {
                let (start, end) = (Facet::default(), Facet::default());
                pieces.push(Piece { segment, length, start, end });
            }
        }
        let (Some(first), Some(last)) = (pieces.first(), pieces.last()) else {
            return Err(PlantError::EmptyPath);
        };
        let closed = distance(first.segment.from(), last.segment.to()) < JOIN_MM;
        let mut run_starts = smooth_facets(&mut pieces, closed);
        // Where two long pieces meet the curvature jumps: a sample lies there too.
        for (k, pair) in pieces.windows(2).enumerate() {
            run_starts[k + 1] |= pair[0].length.min(pair[1].length) >= LONG_STEPS * step_mm;
        }

        let mut path = Self {
            s_mm: Vec::new(),
            centre: Vec::new(),
            tangent: Vec::new(),
            normal: Vec::new(),
            side,
            length_mm: 0.0,
            step_mm,
            closed,
        };
        let mut rest = pieces.as_slice();
        let mut starts = run_starts.as_slice();
        while !rest.is_empty() {
            let run = starts.iter().skip(1).position(|&c| c).map_or(rest.len(), |i| i + 1);
            path.sample_run(&rest[..run]);
            rest = &rest[run..];
            starts = &starts[run..];
        }
        if let Some(last) = pieces.last() {
            let (p, t) = last.at(last.length);
            path.push(path.length_mm, p, t);
        }
        Ok(path)
    }

    /// Samples a run of pieces evenly, the end left out.
    fn sample_run(&mut self, run: &[Piece]) {
        let length: f64 = run.iter().map(|p| p.length).sum();
        let count = (length / self.step_mm - 1e-9).ceil().max(1.0);
        let (mut piece, mut begin) = (0, 0.0);
        for k in 0..count as usize {
            let x = length * k as f64 / count;
            while piece + 1 < run.len() && x >= begin + run[piece].length {
                begin += run[piece].length;
                piece += 1;
            }
            let (p, t) = run[piece].at((x - begin).clamp(0.0, run[piece].length));
            self.push(self.length_mm + x, p, t);
        }
        self.length_mm += length;
    }

    fn push(&mut self, s: f64, p: Point, t: Point) {
        self.s_mm.push(s);
        self.centre.push(p);
        self.tangent.push(t);
        self.normal.push(scaled(left_of(t), self.side.sign()));
    }

    /// Number of samples.
    pub fn len(&self) -> usize {
        self.s_mm.len()
    }

    /// Never: a path has at least two samples.
    pub fn is_empty(&self) -> bool {
        self.s_mm.is_empty()
    }

    /// Whether the path ends where it starts and goes on there without a corner.
    pub fn runs_on(&self) -> bool {
        let ends = self.tangent.first().zip(self.tangent.last());
        self.closed && ends.is_some_and(|(on, out)| turn(*out, *on).abs() < FACET_RAD)
    }

    /// Sample nearest to the distance `s_mm` along the path.
    pub fn index_at(&self, s_mm: f64) -> usize {
        let k = self.s_mm.partition_point(|&s| s < s_mm).clamp(1, self.len() - 1);
        if s_mm - self.s_mm[k - 1] < self.s_mm[k] - s_mm { k - 1 } else { k }
    }

    /// Whether the cutter rolls about an edge of the part beside a sample: the nominal wall stands still while the centre moves
    /// on. No wall is made there, and its normal is anybody's choice.
    pub fn rolls(&self, index: usize, radius_mm: f64) -> bool {
        let last = self.len().saturating_sub(1);
        // The first and the last sample of a closed path are one place.
        let before = if index == 0 { self.closed.then(|| last.saturating_sub(1)) } else { Some(index - 1) };
        let behind = if index >= last { self.closed.then_some(1.min(last)) } else { Some(index + 1) };
        let stands = |other: usize| {
            let wall = distance(self.wall(index, radius_mm), self.wall(other, radius_mm));
            wall < STANDS * distance(self.centre[index], self.centre[other])
        };
        [before, behind].into_iter().flatten().any(stands)
    }

    /// Point of the finished wall that sample `index` generates with a rigid cutter of `radius_mm`.
    pub fn wall(&self, index: usize, radius_mm: f64) -> Point {
        along(self.centre[index], self.normal[index], radius_mm)
    }
}

/// Sets the heading corrections; returns for each piece whether a corner lies before it.
fn smooth_facets(pieces: &mut [Piece], closed: bool) -> Vec<bool> {
    let n = pieces.len();
    let mut corner = vec![false; n];
    for k in 0..n {
        if k == 0 && !(closed && n > 1) {
            continue;
        }
        let before = (k + n - 1) % n;
        let angle = turn(pieces[before].segment.at(1.0).1, pieces[k].segment.at(0.0).1);
        if angle.abs() >= FACET_RAD {
            corner[k] = true;
            continue;
        }
        let shorter = pieces[before].length.min(pieces[k].length);
        let reach = (0.5 * shorter).min(FACET_MM_RAD / angle.abs().max(1e-12));
        pieces[before].end = Facet { angle: 0.5 * angle, reach };
        pieces[k].start = Facet { angle: -0.5 * angle, reach };
    }
    corner
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::super::vector::{dot, unit};
    use super::*;

    fn facets(radius: f64, step_deg: f64) -> Vec<Segment> {
        let n = (90.0 / step_deg) as usize;
        let at = |k: usize| {
            let a = (k as f64 * step_deg).to_radians();
            [radius * a.cos(), radius * a.sin()]
        };
        (0..n).map(|k| Segment::Line { from: at(k), to: at(k + 1) }).collect()
    }

    #[test]
    fn the_heading_of_a_circle_in_short_lines_is_that_of_the_circle() {
        // Chords of 2° on radius 20: 0.7 mm. Mid-chord and vertex headings are exact, between them the circle is linear too.
        let path = Path::new(&facets(20.0, 2.0), Side::Right, 0.1).expect("valid");
        for i in 10..path.len() - 10 {
            let p = path.centre[i];
            let circle = unit(left_of(p));
            assert!(turn(circle, path.tangent[i]).abs() < 1e-4, "sample {i}");
        }
    }

    #[test]
    fn a_kink_between_long_lines_stays_a_kink() {
        let bend = 10f64.to_radians();
        let lines = [
            Segment::Line { from: [-50.0, 0.0], to: [0.0, 0.0] },
            Segment::Line { from: [0.0, 0.0], to: [50.0 * bend.cos(), 50.0 * bend.sin()] },
        ];
        let path = Path::new(&lines, Side::Left, 0.1).expect("valid");
        let before = path.index_at(49.5);
        assert!(turn([1.0, 0.0], path.tangent[before]).abs() < 1e-12);
        let after = path.index_at(50.5);
        assert!((turn([1.0, 0.0], path.tangent[after]) - bend).abs() < 1e-12);
    }

    #[test]
    fn samples_are_even_and_end_at_the_end() {
        let arc = Segment::Arc { from: [10.0, 0.0], to: [0.0, 10.0], centre: [0.0, 0.0], ccw: true };
        let path = Path::new(&[arc], Side::Left, 0.1).expect("valid");
        assert!((path.length_mm - 5.0 * PI).abs() < 1e-9);
        assert!(path.s_mm.windows(2).all(|w| w[1] > w[0] && w[1] - w[0] <= 0.1 + 1e-9));
        assert!((path.s_mm[path.len() - 1] - path.length_mm).abs() < 1e-12);
        // Left of counter-clockwise travel lies the centre.
        assert!(dot(path.normal[50], path.centre[50]) < -9.99);
    }

    #[test]
    fn a_gap_is_an_error_that_names_the_segment() {
        let lines =
            [Segment::Line { from: [0.0, 0.0], to: [1.0, 0.0] }, Segment::Line { from: [1.5, 0.0], to: [2.0, 0.0] }];
        let error = Path::new(&lines, Side::Left, 0.1).expect_err("gap");
        assert_eq!(error, PlantError::Gap { segment: 1, gap_mm: 0.5 });
    }
}
