//! Along the contour: the written lines and arcs against the points they stand for.

use truepath_core::geometry::Curve;
use truepath_core::units::Real;

use super::super::deviation::distance;
use super::super::spacing::bulges;
use super::super::vector::{dot, length, minus};

/// Spacing at which a written curve is looked at between the samples, nm.
const SPACING: f64 = 50_000.0;

/// Follows the samples of one line of the contour.
#[derive(Debug)]
pub(super) struct Follower<'a> {
    samples: &'a [[i64; 2]],
    /// How far the path may leave the chord between each two of them, nm.
    bulges: Vec<f64>,
    at: usize,
    tolerance: f64,
    /// What rounding may do to a place, nm.
    slack: f64,
    /// The largest distance between path and samples so far, nm.
    pub(super) deviation: f64,
}

impl<'a> Follower<'a> {
    /// For the samples of one line, whose programmed curvature is given in 1/nm.
    pub(super) fn new(samples: &'a [[i64; 2]], curvature: f64, tolerance: f64, slack: f64) -> Self {
        let origin = samples.first().copied().unwrap_or_default();
        let path: Vec<_> = samples.iter().map(|s| difference(*s, origin)).collect();
        Self { samples, bulges: bulges(&path, curvature), at: 0, tolerance, slack, deviation: 0.0 }
    }

    /// Whether all samples are passed when the written path has come to `place`.
    pub(super) fn is_done(&self, place: [i64; 2]) -> bool {
        let rest = self.samples.get(self.at..).unwrap_or_default();
        rest.iter().all(|s| length(difference(*s, place)) <= self.slack)
    }

    /// Index of the sample reached.
    pub(super) const fn reached(&self) -> usize {
        self.at
    }

    /// The chords before and after the sample reached.
    pub(super) fn chords(&self) -> [Option<[f64; 2]>; 2] {
        let sample = |k: usize| self.samples.get(k).copied();
        let chord = |a: Option<[i64; 2]>, b: Option<[i64; 2]>| Some(difference(b?, a?)).filter(|c| *c != [0.0; 2]);
        let here = sample(self.at);
        [chord(self.at.checked_sub(1).and_then(sample), here), chord(here, sample(self.at + 1))]
    }

    /// Takes the next written curve; `false` when it leaves the samples.
    pub(super) fn take(&mut self, curve: &Curve) -> bool {
        let end = [curve.end().x.nm(), curve.end().y.nm()];
        let mut nearest: Option<(f64, usize)> = None;
        for (k, sample) in self.samples.iter().enumerate().skip(self.at) {
            if distance(*sample, curve) > self.tolerance {
                break;
            }
            let off = length(difference(*sample, end));
            if k > self.at && off <= self.tolerance.max(self.slack) && nearest.is_none_or(|(best, _)| off <= best) {
                nearest = Some((off, k));
            }
        }
        let Some((_, reached)) = nearest else { return false };
        let passed = &self.samples[self.at..=reached];
        let here = passed.iter().map(|s| distance(*s, curve)).fold(0.0, f64::max);
        self.deviation = self.deviation.max(here).max(bulge(curve, passed, &self.bulges[self.at..]));
        self.at = reached;
        self.deviation <= self.tolerance
    }
}

/// How far the curve leaves the samples between them, nm: beyond what the samples' own spacing leaves open.
fn bulge(curve: &Curve, samples: &[[i64; 2]], bulges: &[f64]) -> f64 {
    let count = ((curve.length().nm() as f64 / SPACING) as i64).clamp(2, 100_000);
    let mut from = 0;
    (1..count)
        .map(|k| {
            let p = curve.point(Real::ratio(k, count));
            let place = [p.x.nm(), p.y.nm()];
            // The nearest chord, looked for onwards from the last one.
            let mut best = f64::INFINITY;
            let (mut last, begin) = (f64::INFINITY, from);
            for i in begin..samples.len().saturating_sub(1) {
                let ahead = length(difference(samples[i], place));
                if i > begin + 4 && ahead > last {
                    break;
                }
                last = ahead;
                let off = to_chord(place, samples[i], samples[i + 1]) - bulges[i];
                if off < best {
                    (best, from) = (off, i);
                }
            }
            if best.is_finite() { best.max(0.0) } else { 0.0 }
        })
        .fold(0.0, f64::max)
}

fn to_chord(p: [i64; 2], a: [i64; 2], b: [i64; 2]) -> f64 {
    let (p, b) = (difference(p, a), difference(b, a));
    let square = dot(b, b);
    let u = if square > 0.0 { (dot(p, b) / square).clamp(0.0, 1.0) } else { 0.0 };
    length(minus(p, [u * b[0], u * b[1]]))
}

/// In float, relative, so that large coordinates cost no digits.
pub(super) fn difference(a: [i64; 2], b: [i64; 2]) -> [f64; 2] {
    [(a[0] - b[0]) as f64, (a[1] - b[1]) as f64]
}
