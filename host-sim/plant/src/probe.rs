//! The probe: a ball that comes along the nominal normal and stops at the wall as it is.
//!
//! The ball touches where it meets the wall first, which on a wall that is tilted by g against the nominal one lies R·g beside
//! the place aimed at (R·g²/2 along the normal). Noise is Gaussian along the normal, drawn in the order of the points; what the probe
//! reads wrong besides lies along the normal too.
//!
//! Limit: the contact is found in the plane of the ball's centre; the slope of the wall over the height is not seen.

use std::fmt::Write;

use rand_chacha::ChaCha8Rng;
use rand_chacha::rand_core::SeedableRng;
use rand_distr::{Distribution, Normal};

use super::error::{PlantError, require};
use super::mill::Milled;
use super::vector::{Point, along, dot, squared_distance, sub};
use super::wall::REACH_MM;

/// Where to touch.
#[derive(Debug, Clone, PartialEq)]
pub struct ProbePlan {
    /// Places along the contour, mm.
    pub s_mm: Vec<f64>,
    /// Heights at each place, fractions of the axial depth above the tip.
    pub levels: Vec<f64>,
    /// Diameter of the ball, mm.
    pub ball_diameter_mm: f64,
    /// Z of the cutter's tip in the pass, program coordinates, mm.
    pub tip_z_mm: f64,
}

/// One touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Place along the contour, mm.
    pub s_mm: f64,
    /// Height, fraction of the axial depth above the tip.
    pub level: f64,
    /// Centre of the ball, program coordinates, mm.
    pub ball_centre: [f64; 3],
}

/// Probes the wall, all heights of a place before the next place.
///
/// # Errors
/// `NoWallAt` for a place off the contour or without a wall, `OutOfRange` for the ball.
pub fn probe(milled: &Milled, plan: &ProbePlan) -> Result<Vec<Touch>, PlantError> {
    let ball = 0.5 * plan.ball_diameter_mm;
    require((0.05..=50.0).contains(&ball), "ball_diameter_mm", plan.ball_diameter_mm, "0.1 to 100 mm")?;
    let path = &milled.path;
    let errors = milled.wall_errors(&plan.levels);
    let mut rng = ChaCha8Rng::seed_from_u64(milled.machine.seed);
    rng.set_stream(2);
    let noise = Normal::new(0.0, milled.machine.probe_noise_mm).map_err(|_| PlantError::OutOfRange {
        key: "probe_noise_mm",
        value: milled.machine.probe_noise_mm,
        expected: "a number of at least 0",
    })?;
    let mut out = Vec::with_capacity(plan.s_mm.len() * plan.levels.len());
    for &s_mm in &plan.s_mm {
        let i = path.index_at(s_mm);
        for (&level, errors) in plan.levels.iter().zip(&errors) {
            let off = s_mm.is_nan() || s_mm < 0.0 || s_mm > path.length_mm;
            if off || !errors[i].is_finite() {
                return Err(PlantError::NoWallAt { s_mm });
            }
            let wall = path.wall(i, milled.cut.radius_mm);
            let wrong = milled.machine.probe.beyond(out.len() as u64, path.normal[i], milled.machine.seed);
            let rest = rest_along_normal(milled, errors, i, ball).ok_or(PlantError::NoWallAt { s_mm })?;
            let rest = rest + noise.sample(&mut rng) + wrong;
            let c = along(wall, path.normal[i], rest);
            let z = plan.tip_z_mm + level * milled.cut.axial_depth_mm;
            out.push(Touch { s_mm, level, ball_centre: [c[0], c[1], z] });
        }
    }
    Ok(out)
}

/// Where the ball's centre stops, along the normal from the nominal wall point (negative: towards the cutter), mm; `None` where it meets
/// no wall.
fn rest_along_normal(milled: &Milled, errors: &[f64], i: usize, ball: f64) -> Option<f64> {
    let path = &milled.path;
    let radius = milled.cut.radius_mm;
    let (aim, normal) = (path.wall(i, radius), path.normal[i]);
    // Samples of the centre path whose wall points can lie under the ball, also on a concave arc, where the wall is longer.
    let window = ((ball + 1.0) / path.step_mm).ceil() as usize;
    let (lo, hi) = (i.saturating_sub(window), (i + window).min(path.len() - 1));
    // A wall can be farther off than a small ball is large.
    let reach = ball.max(REACH_MM);
    let mut rest: Option<f64> = None;
    for (k, e) in errors.iter().enumerate().take(hi + 1).skip(lo) {
        let wall: Point = along(path.wall(k, radius), path.normal[k], -e);
        let depth = dot(sub(wall, aim), normal);
        let room = ball * ball - (squared_distance(wall, aim) - depth * depth);
        if e.is_finite() && room >= 0.0 && depth.abs() < reach {
            let here = depth - room.sqrt();
            rest = Some(rest.map_or(here, |rest| rest.min(here)));
        }
    }
    rest
}

/// The touches as LinuxCNC's PROBEOPEN writes them: nine columns X Y Z A B C U V W, ball centre, no header.
pub fn probeopen_text(touches: &[Touch]) -> String {
    let mut text = String::with_capacity(touches.len() * 90);
    for t in touches {
        let [x, y, z] = t.ball_centre;
        // Writing to a string cannot fail.
        let _ = write!(text, "{x:.6} {y:.6} {z:.6}");
        text.push_str(&" 0.000000".repeat(6));
        text.push('\n');
    }
    text
}
