//! A wall unrolled, along the contour and over the height, and how good it is everywhere.

use serde::Serialize;

use crate::mill::Milled;

/// Wall errors over a surface: positive, material left; NaN where no wall is.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Places along the contour, mm.
    pub s_mm: Vec<f64>,
    /// The same along the nominal wall, mm.
    pub wall_mm: Vec<f64>,
    /// Lower and upper edge of every slice, from the lowest, mm.
    pub slices_mm: Vec<(f64, f64)>,
    /// By slice, then by place, mm.
    pub errors_mm: Vec<Vec<f64>>,
}

/// How near the edge of an outside corner a wall is not judged, mm: along its own normal the end of the other wall would look like
/// a deep cut, and a place that the cutter leaves there like a wall in the stock.
const EDGE_MM: f64 = 1.0;

/// A place and its error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Worst {
    /// Along the contour, mm.
    pub s_mm: f64,
    /// Height, mm.
    pub z_mm: f64,
    /// Error there, mm.
    pub error_mm: f64,
}

/// The wall at one height.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct HeightScore {
    /// Middle of the slice, mm.
    pub z_mm: f64,
    /// Mean along the contour, mm.
    pub mean_mm: f64,
    /// Largest magnitude, mm.
    pub profile_mm: f64,
    /// Most material left, mm; 0 where none is.
    pub left_mm: f64,
    /// Deepest cut into the part, mm; 0 where none is.
    pub gouge_mm: f64,
    /// What 95 % of the wall at this height are within, mm.
    pub p95_mm: f64,
    /// Root mean square, mm.
    pub rms_mm: f64,
}

/// How good a wall is, at all heights and all places that are judged.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SurfaceScore {
    /// Largest magnitude of the mean over the height, mm.
    pub mean_over_height_mm: f64,
    /// Profile error: largest magnitude anywhere, mm.
    pub profile_mm: f64,
    /// What 95 % of the surface are within, mm.
    pub p95_mm: f64,
    /// Root mean square over the surface, mm.
    pub rms_mm: f64,
    /// Most material left anywhere, mm; 0 where none is.
    pub left_mm: f64,
    /// Deepest cut into the part anywhere, mm; 0 where none is.
    pub gouge_mm: f64,
    /// Where the profile error is.
    pub worst: Worst,
    /// The same at every height, from the lowest.
    pub heights: Vec<HeightScore>,
}

/// Values with their share of the surface.
#[derive(Default)]
struct Weighed {
    values: Vec<(f64, f64)>,
}

impl Weighed {
    fn sum(&self, of: impl Fn(f64) -> f64) -> f64 {
        let total: f64 = self.values.iter().map(|(_, w)| w).sum();
        self.values.iter().map(|(v, w)| of(*v) * w).sum::<f64>() / total
    }

    fn most(&self, of: impl Fn(f64) -> f64) -> f64 {
        self.values.iter().map(|(v, _)| of(*v)).fold(0.0, f64::max)
    }

    /// The magnitude that a share of the surface is within.
    fn within(&self, share: f64) -> f64 {
        let mut sizes: Vec<(f64, f64)> = self.values.iter().map(|(v, w)| (v.abs(), *w)).collect();
        sizes.sort_by(|a, b| a.0.total_cmp(&b.0));
        let due = share * sizes.iter().map(|(_, w)| w).sum::<f64>();
        let mut sum = 0.0;
        let at = sizes.iter().find(|(_, w)| {
            sum += w;
            sum >= due
        });
        at.or(sizes.last()).map_or(f64::NAN, |(v, _)| *v)
    }
}

impl Surface {
    pub(super) fn new(s_mm: Vec<f64>, wall_mm: Vec<f64>, slices_mm: Vec<(f64, f64)>, errors_mm: Vec<Vec<f64>>) -> Self {
        Self { s_mm, wall_mm, slices_mm, errors_mm }
    }

    /// The wall of a single pass in `slices` slices; `tip_z_mm` is Z of the cutter's tip.
    pub fn of(milled: &Milled, tip_z_mm: f64, slices: usize) -> Self {
        let depth = milled.cut.axial_depth_mm;
        let edge = |k: usize| tip_z_mm + depth * k as f64 / slices as f64;
        let levels: Vec<f64> = (0..slices).map(|k| (k as f64 + 0.5) / slices as f64).collect();
        let path = &milled.path;
        let mut wall_mm = Vec::with_capacity(path.len());
        let mut at = 0.0;
        for i in 0..path.len() {
            if i > 0 {
                let r = milled.cut.radius_mm;
                at += crate::vector::distance(path.wall(i - 1, r), path.wall(i, r));
            }
            wall_mm.push(at);
        }
        Self {
            s_mm: path.s_mm.clone(),
            wall_mm,
            slices_mm: (0..slices).map(|k| (edge(k), edge(k + 1))).collect(),
            errors_mm: milled.wall_errors(&levels),
        }
    }

    /// Length of the wall that a place stands for, mm.
    fn share(&self, i: usize) -> f64 {
        let last = self.wall_mm.len() - 1;
        0.5 * (self.wall_mm[(i + 1).min(last)] - self.wall_mm[i.saturating_sub(1)])
    }

    /// Places beside which a wall stands, and none ends within [`EDGE_MM`].
    fn away_from_edges(&self) -> Vec<bool> {
        let stands = |i: usize| self.errors_mm.iter().any(|errors| errors[i].is_finite());
        let mut away: Vec<bool> = (0..self.s_mm.len()).map(stands).collect();
        let ends: Vec<f64> = (0..away.len()).filter(|i| !away[*i]).map(|i| self.s_mm[i]).collect();
        for (away, s) in away.iter_mut().zip(&self.s_mm) {
            let next = ends.partition_point(|end| end < s);
            let near = [next.checked_sub(1), Some(next)].into_iter().flatten().filter_map(|k| ends.get(k));
            *away &= near.map(|end| (end - s).abs()).fold(f64::INFINITY, f64::min) > EDGE_MM;
        }
        away
    }

    /// Judges the wall away from its ends, `trim_mm` each, and from the edges of outside corners. `None` where nothing is to be
    /// judged.
    pub fn score(&self, trim_mm: f64) -> Option<SurfaceScore> {
        let length = *self.s_mm.last()?;
        let away = self.away_from_edges();
        let judged = |i: &usize| away[*i] && self.s_mm[*i] > trim_mm && self.s_mm[*i] < length - trim_mm;
        let places: Vec<usize> = (0..self.s_mm.len()).filter(judged).collect();
        let (mut all, mut heights) = (Weighed::default(), Vec::new());
        let mut worst: Option<Worst> = None;
        for (&(lower, upper), errors) in self.slices_mm.iter().zip(&self.errors_mm) {
            let mut slice = Weighed::default();
            let z_mm = 0.5 * (lower + upper);
            for &i in &places {
                let error_mm = errors[i];
                if !error_mm.is_finite() {
                    continue;
                }
                slice.values.push((error_mm, self.share(i)));
                all.values.push((error_mm, self.share(i) * (upper - lower)));
                if worst.is_none_or(|w| error_mm.abs() > w.error_mm.abs()) {
                    worst = Some(Worst { s_mm: self.s_mm[i], z_mm, error_mm });
                }
            }
            if !slice.values.is_empty() {
                heights.push(HeightScore {
                    z_mm,
                    mean_mm: slice.sum(|v| v),
                    profile_mm: slice.most(f64::abs),
                    left_mm: slice.most(|v| v),
                    gouge_mm: slice.most(|v| -v),
                    p95_mm: slice.within(0.95),
                    rms_mm: slice.sum(|v| v * v).sqrt(),
                });
            }
        }
        let mean = self.means();
        let mean_over_height_mm = places.iter().map(|i| mean[*i].abs()).filter(|m| m.is_finite()).fold(0.0, f64::max);
        Some(SurfaceScore {
            mean_over_height_mm,
            profile_mm: all.most(f64::abs),
            p95_mm: all.within(0.95),
            rms_mm: all.sum(|v| v * v).sqrt(),
            left_mm: all.most(|v| v),
            gouge_mm: all.most(|v| -v),
            worst: worst?,
            heights,
        })
    }

    /// Mean over the height at each place, mm.
    pub fn means(&self) -> Vec<f64> {
        let mean = |i: usize| {
            let slices = self.slices_mm.iter().zip(&self.errors_mm).filter(|(_, e)| e[i].is_finite());
            let (sum, height) = slices.fold((0.0, 0.0), |(sum, height), ((lower, upper), errors)| {
                (sum + errors[i] * (upper - lower), height + upper - lower)
            });
            sum / height
        };
        (0..self.s_mm.len()).map(mean).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_score_of_a_known_wall_is_its_own() {
        let count = 1001;
        let s: Vec<f64> = (0..count).map(|k| f64::from(k) * 0.1).collect();
        // Falls from +0.1 to −0.1 along the upper slice, 0.05 all along the lower one, which is three times as high.
        let fall: Vec<f64> = s.iter().map(|s| 0.1 - 0.002 * s).collect();
        let wall = Surface::new(s.clone(), s, vec![(-4.0, -1.0), (-1.0, 0.0)], vec![vec![0.05; count as usize], fall]);
        let score = wall.score(10.0).expect("a wall");
        assert!((score.profile_mm - 0.08).abs() < 1e-3 && (score.gouge_mm - 0.08).abs() < 1e-3, "{score:?}");
        assert!((score.mean_over_height_mm - (0.15 + 0.08) / 4.0).abs() < 1e-3);
        // Of the upper quarter 37.5 % are beyond 0.05: 9.4 % of all; the largest 5 % begin at 0.08 − 0.03·5/9.375.
        assert!((score.p95_mm - 0.064).abs() < 1e-3, "{}", score.p95_mm);
        assert_eq!(score.heights.len(), 2);
        assert!((score.heights[0].p95_mm - 0.05).abs() < 1e-9 && score.heights[0].gouge_mm == 0.0);
        assert!(score.heights[1].mean_mm.abs() < 1e-9);
    }
}
