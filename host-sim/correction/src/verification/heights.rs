//! Heights at which the ball meets the wall.
//!
//! The ball touches with its equator, so its centre must stand inside the engaged depth, and its lowest point must
//! stay clear of the floor, which may lie as high as the cutter's tip. The heights are spread evenly over what remains:
//! the outermost tell bending and the helix, those between tell a bad touch.

use truepath_core::job::{Probe, ZReference};
use truepath_ground::diagnostics::InputError;
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;

use super::settings::Settings;
use crate::codes::V002;

/// A height.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Height {
    /// Above the cutter's tip, fraction of the engaged depth.
    pub fraction: f64,
    /// Of the ball's centre above the cutter's tip, mm.
    pub above_tip_mm: f64,
    /// Z that is programmed, mm, program coordinates: centre or tip of the ball as the job says.
    pub z_mm: f64,
    /// What it is for.
    pub why: &'static str,
}

/// From the ball's centre to the upper end of the engaged depth, at least: above it stands what an earlier pass left, or
/// the edge with its burr. The larger of millimetres and a share of the depth.
const BELOW_TOP: (f64, f64) = (1.0, 0.1);

/// Between two heights, at least, mm.
const APART: f64 = 0.5;

/// The heights of a pass, from the highest down.
///
/// # Errors
/// `V002` when the ball has no room between floor and upper end.
pub(super) fn heights(pass: &Pass, probe: &Probe, settings: &Settings) -> Result<Vec<Height>, InputError> {
    let depth = float(pass.core.setup.axial_depth);
    let radius = mm(probe.ball_diameter) / 2.0;
    let tip_z = pass.core.contour.z.nm() as f64 / 1e6;
    let below_top = BELOW_TOP.0.max(BELOW_TOP.1 * depth);
    let (lowest, highest) = (radius + settings.floor_clearance, depth - below_top);
    if lowest > highest {
        return Err(V002.error(
            format!("a ball of {} mm has no room in an engaged depth of {depth} mm", 2.0 * radius),
            format!(
                "its radius + {} mm above the floor + {below_top} mm below the upper end within the depth",
                settings.floor_clearance
            ),
        ));
    }
    let lift = match probe.z_reference {
        ZReference::Centre => 0.0,
        ZReference::Tip => radius,
    };
    // Heights closer together than this tell the same.
    let count = settings.heights.min(1 + ((highest - lowest) / APART) as u32);
    let at = |k: u32| {
        let share = if count == 1 { 0.5 } else { f64::from(k) / f64::from(count - 1) };
        let above_tip_mm = highest + (lowest - highest) * share;
        let why = match (count, k) {
            (1, _) => "mid-height: the mean of the wall",
            (_, 0) => "highest: with the lowest it tells bending and helix over the height",
            (n, k) if k + 1 == n => "lowest: with the highest it tells bending and helix over the height",
            _ => "between: shape over the height, and a check of its neighbours",
        };
        Height { fraction: above_tip_mm / depth, above_tip_mm, z_mm: tip_z + above_tip_mm - lift, why }
    };
    Ok((0..count).map(at).collect())
}
