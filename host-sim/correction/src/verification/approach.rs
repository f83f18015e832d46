//! The proof that the ball's way to a place is free.
//!
//! The ball of radius R comes down at the stand-off, its centre R + clearance before the wall, and moves along the
//! normal. Proved is that
//!
//! 1. the way lies in what is free before the wall: 2 R + clearance ≤ the width that the pass itself has cleared (the
//!    cutter's diameter: the cutter stood on every place of the contour) or that the user says is free;
//! 2. at the stand-off the ball keeps [`MARGIN`] from every nominal wall of the contour, whichever block it is of;
//! 3. on the last approach no wall is nearer to the ball than the place it goes to: in a bay narrower than the ball it
//!    would touch elsewhere.
//!
//! The walls are those of the path's samples, 0.1 mm apart, which is a chord error below 1 µm for radii above 1.3 mm.

use super::settings::MARGIN;

/// A point or a vector of the plane, mm.
pub(super) type Xy = [f64; 2];

/// `p + n·d`.
pub(super) fn along(p: Xy, n: Xy, d: f64) -> Xy {
    [p[0] + n[0] * d, p[1] + n[1] * d]
}

/// The ball and its way.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ball {
    /// Radius, mm.
    pub(super) radius: f64,
    /// From its surface to the wall at the stand-off, mm.
    pub(super) clearance: f64,
}

/// What a distance may be short by rounding and sampling, mm.
const SLACK: f64 = 0.002;
/// Steps in which the last approach is looked at, mm.
const STEP: f64 = 0.1;

impl Ball {
    /// Width before the wall that must be free, mm.
    pub(super) fn width(self) -> f64 {
        2.0 * self.radius + self.clearance
    }

    /// Whether the way to the wall point `wall` with the normal `n` towards the wall is free of `walls`.
    pub(super) fn is_free(self, wall: Xy, n: Xy, walls: &[Xy]) -> bool {
        let reach = self.radius + self.clearance;
        let stand_off = along(wall, n, -reach);
        // Walls farther from the stand-off than this touch the ball nowhere on its way.
        let near: Vec<Xy> = walls.iter().copied().filter(|w| distance(*w, stand_off) < 2.0 * reach).collect();
        let nearest = |c: Xy| near.iter().map(|w| distance(*w, c)).fold(f64::INFINITY, f64::min);
        if nearest(stand_off) < self.radius + MARGIN - SLACK {
            return false;
        }
        let steps = (self.clearance / STEP).ceil().max(1.0) as u32;
        (0..=steps).all(|k| {
            let away = self.radius + self.clearance * f64::from(k) / f64::from(steps);
            nearest(along(wall, n, -away)) >= away - SLACK
        })
    }
}

pub(super) fn distance(a: Xy, b: Xy) -> f64 {
    (a[0] - b[0]).hypot(a[1] - b[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The walls x = 0 (y ≥ 0) and y = 0 (x ≥ 0), the free side between them.
    fn corner() -> Vec<Xy> {
        (0..1000).flat_map(|k| [[0.0, f64::from(k) * 0.05], [f64::from(k) * 0.05, 0.0]]).collect()
    }

    #[test]
    fn a_way_is_free_where_no_other_wall_is_nearer_than_the_one_to_be_touched() {
        let ball = Ball { radius: 3.0, clearance: 2.0 };
        let at = |y: f64| ball.is_free([0.0, y], [-1.0, 0.0], &corner());
        assert!(at(10.0) && at(5.0));
        assert!(!at(4.9), "at the stand-off the other wall would be nearer than the one to be touched");
    }

    #[test]
    fn a_ball_larger_than_the_bay_is_refused() {
        let bay: Vec<Xy> =
            (0..=180).map(|k| f64::from(k).to_radians()).map(|a| [4.0 * a.cos(), 4.0 * a.sin()]).collect();
        let fits = |radius| Ball { radius, clearance: 1.0 }.is_free([0.0, 4.0], [0.0, 1.0], &bay);
        assert!(fits(2.0));
        assert!(!fits(4.5));
    }
}
