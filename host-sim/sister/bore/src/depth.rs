//! The bore over its depth: a helix turns the profile, runout also changes it.
//!
//! At height z the edge comes later by the lag `z·tan β/r`, so its crests lie `|k|·lag` farther along the travel: marks are inclined, and
//! along a generatrix (a straight line up the wall) the same waviness appears with the wavelength `2πr/(N tan β)`. With runout
//! the radii of the edges differ from height to height, so the height of the waviness differs too.

use std::f64::consts::TAU;

use super::arc::Arc;
use super::passes::Passes;
use super::refusal::Refusal;
use super::setup::Setup;

/// Radius of the wall on one ray, mm, from the passes near it alone: without the whole envelope, and a check of it.
pub fn ray(passes: &Passes, phi: f64) -> f64 {
    let relative = passes.motion.omega2 - passes.motion.omega1;
    let (spacing, end) = (passes.motion.spacing(), TAU * passes.laps);
    let mut best = f64::MIN;
    for (tooth, &arc) in passes.teeth.iter().zip(&passes.arc_of) {
        let arc: &Arc = &passes.arcs[arc];
        let reach = passes.reach.min(arc.half_width()) * (1.0 + 1e-12);
        // Crests of this tooth in the order of the centre's angle: origin, origin + spacing, …
        let origin = {
            let turned = tooth.angle.rem_euclid(TAU);
            passes.motion.omega1 * if relative > 0.0 { (TAU - turned) / relative } else { turned / -relative }
        };
        let origin = if origin >= spacing { origin - spacing } else { origin };
        for lap in -1..=passes.laps.ceil() as i64 {
            let target = phi + TAU * lap as f64;
            let first = (((target - reach - origin) / spacing).ceil() as i64).max(0);
            let last = ((target + reach).min(end * (1.0 + 1e-15)) - origin) / spacing;
            for n in first..=last.floor() as i64 {
                best = best.max(arc.wall(target - origin - n as f64 * spacing).0);
            }
        }
    }
    best
}

/// The profile of one height in short.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Level {
    /// Above the tip, mm.
    pub z_mm: f64,
    /// How far the profile has turned along the travel, degrees.
    pub turned_deg: f64,
    /// Pt, mm.
    #[serde(rename = "Pt_mm")]
    pub height_mm: f64,
    /// Radii of the wall, mm.
    pub smallest_radius_mm: f64,
    /// Largest radius, mm.
    pub largest_radius_mm: f64,
    /// Teeth that leave a mark.
    pub cutting_teeth: usize,
}

/// Profiles at equally spaced heights from the tip to `depth` mm.
///
/// # Errors
/// [`Refusal`].
pub fn levels(setup: &Setup, depth_mm: f64, count: usize) -> Result<Vec<Level>, Refusal> {
    Refusal::unless_in("depth", "mm", depth_mm, 0.0, 1e4)?;
    let level = |n: usize| {
        let z_mm = depth_mm * n as f64 / (count.max(2) - 1) as f64;
        let (motion, steady) = (setup.motion()?, setup.steady(z_mm)?);
        Ok(Level {
            z_mm,
            turned_deg: (motion.advance() * setup.cutter.lag(z_mm, &motion)).to_degrees(),
            height_mm: steady.height_mm,
            smallest_radius_mm: steady.highest_mm - steady.height_mm,
            largest_radius_mm: steady.highest_mm,
            cutting_teeth: steady.cutting_teeth,
        })
    };
    (0..count).map(level).collect()
}

/// Radius of the wall over heights (outer) and rays (inner).
///
/// # Errors
/// [`Refusal`].
pub fn surface(setup: &Setup, heights: &[f64], rays: &[f64]) -> Result<Vec<Vec<f64>>, Refusal> {
    heights.iter().map(|z| setup.passes(*z).map(|p| rays.iter().map(|phi| ray(&p, *phi)).collect())).collect()
}

/// Wavelength of the marks along a generatrix, mm: `2πr/(N tan β)`; none for straight teeth.
pub fn generatrix_wavelength(setup: &Setup) -> Option<f64> {
    let slope = setup.cutter.helix_deg.to_radians().tan().abs();
    (slope > 1e-12).then(|| TAU * setup.cutter.radius_mm / (f64::from(setup.cutter.teeth) * slope))
}
