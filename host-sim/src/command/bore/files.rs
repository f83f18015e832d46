//! The files of `bore`: tables, pictures, summary.

use truepath_bore::envelope::Profile;
use truepath_bore::setup::Setup;
use truepath_bore::{depth, picture, tables};
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::{OutputFolder, json};

use super::summary::BoreSummary;

/// Files this command may write.
pub(super) const FILES: &[&str] = &[
    "summary.json",
    "profile.csv",
    "roots.csv",
    "teeth.csv",
    "feed.csv",
    "helix.csv",
    "runout.csv",
    "levels.csv",
    "surface.csv",
    "circular.svg",
    "profile.svg",
    "teeth.svg",
    "runout.svg",
    "wall.svg",
];
/// Writes them all.
pub(super) fn write(
    folder: &OutputFolder,
    summary: &BoreSummary,
    setup: &Setup,
    profile: &Profile,
    depth_mm: Option<f64>,
) -> Result<(), Failure> {
    let title = title(summary);
    folder.write("profile.csv", &tables::profile(profile)?)?;
    folder.write("teeth.csv", &tables::rows(&summary.on_teeth)?)?;
    folder.write("feed.csv", &tables::rows(&summary.on_feed)?)?;
    folder.write("helix.csv", &tables::rows(&summary.on_helix)?)?;
    folder.write("circular.svg", &picture::circular(&title, profile)?)?;
    folder.write("profile.svg", &picture::diagram(&title, profile)?)?;
    folder.write("teeth.svg", &picture::teeth(&format!("{title}: number of teeth"), &summary.on_teeth)?)?;
    if let Some(roots) = &summary.roots {
        folder.write("roots.csv", &tables::rows(&roots.list)?)?;
    }
    if !summary.on_runout.is_empty() {
        folder.write("runout.csv", &tables::rows(&summary.on_runout)?)?;
        folder.write("runout.svg", &picture::runout(&format!("{title}: runout"), &summary.on_runout)?)?;
    }
    if let Some(depth) = depth_mm {
        let (z_mm, along_mm, deviation_mm) = patch(setup, profile, depth)?;
        let patch = picture::Patch { z_mm: &z_mm, along_mm: &along_mm, deviation_mm: &deviation_mm };
        folder.write("levels.csv", &tables::rows(&summary.levels)?)?;
        folder.write("surface.csv", &tables::surface(&patch)?)?;
        folder.write("wall.svg", &picture::wall(&title, &patch)?)?;
    }
    folder.write("summary.json", &json(summary)?)?;
    Ok(())
}

fn title(s: &BoreSummary) -> String {
    let teeth = if s.teeth == 1 { "1 tooth".to_owned() } else { format!("{} teeth", s.teeth) };
    let (hole, cutter) = (2.0 * s.hole_radius_mm, 2.0 * s.cutter_radius_mm);
    format!("bore ⌀{hole} mm, cutter ⌀{cutter} mm, {teeth}, {}, {:.4} mm per tooth", s.direction, s.feed_per_tooth_mm)
}

/// Heights, places along the wall near 90° and deviations from the largest radius there.
type Grid = (Vec<f64>, Vec<f64>, Vec<Vec<f64>>);

fn patch(setup: &Setup, profile: &Profile, depth_mm: f64) -> Result<Grid, Failure> {
    let motion = profile.passes.motion;
    let (half, highest) = (1.5 * motion.spacing(), profile.passes.highest());
    let middle = std::f64::consts::FRAC_PI_2;
    let steps = |count: usize| (0..=count).map(move |n| n as f64 / count as f64);
    let z_mm: Vec<f64> = steps(72).map(|s| s * depth_mm).collect();
    let rays: Vec<f64> = steps(96).map(|s| middle + half * (2.0 * s - 1.0)).collect();
    let radii = depth::surface(setup, &z_mm, &rays)?;
    let largest = radii.iter().flatten().copied().fold(f64::MIN, f64::max);
    let along = rays.iter().map(|phi| (phi - middle) * highest).collect();
    Ok((z_mm, along, radii.into_iter().map(|row| row.into_iter().map(|r| r - largest).collect()).collect()))
}
