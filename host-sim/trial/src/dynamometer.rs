//! Records of a dynamometer under the workpiece, from the virtual machine: straight cuts at the job's allowance and five
//! feeds, with the description that `truepath forces` takes.

use std::fmt::Write;

use truepath_ground::diagnostics::Failure;
use truepath_job::pass::Pass;
use truepath_plant as plant;

use crate::virtual_mill::path_and_cut;

/// Feeds, percent of the job's.
const FEEDS: [u32; 5] = [50, 75, 100, 125, 150];

/// Files with their names: `cuts.toml` and a record a feed. A spindle that turns the other way is recorded in a mirror.
///
/// # Errors
/// What the plant refuses.
pub fn records(pass: &Pass, machine: &plant::Machine) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let (path, cut) = path_and_cut(pass, machine)?;
    let climb = cut.is_climb(&path);
    let dynamometer = plant::Dynamometer::default();
    let mut text = format!(
        "# Straight cuts of the virtual machine under a dynamometer.\nversion = 1\n\n[tool]\ndiameter_mm = {}\nteeth = {}\n\
         helix_deg = {}\n\n[record]\nfeed = \"Fx\"\nacross = \"Fy\"\nforce_on = \"workpiece\"\nlow_pass_hz = {}\n\
         repeatability_percent = {}\n\n[cutting]\naxial_depth_mm = {}\nspindle_rpm = {}\nmilling = \"{}\"\nradial_depth_mm = {}\n",
        2.0 * cut.radius_mm,
        cut.teeth,
        cut.helix_deg,
        dynamometer.low_pass_hz,
        100.0 * dynamometer.repeatability,
        cut.axial_depth_mm,
        cut.spindle_rpm,
        if climb { "down" } else { "up" },
        cut.allowance_mm
    );
    let mut files = Vec::new();
    for (number, percent) in FEEDS.into_iter().enumerate() {
        let feed = cut.feed_mm_per_min * f64::from(percent) / 100.0;
        let at = plant::Cut { feed_mm_per_min: feed, feed_changes: Vec::new(), ..cut.clone() };
        let name = format!("feed-{percent}.csv");
        let _ = write!(text, "\n[[cut]]\nfeed_mm_per_min = {feed}\nrecord = \"{name}\"\n");
        let samples = dynamometer.record(&at, machine, climb, number as u64);
        files.push((name, dynamometer.text(&samples).into_bytes()));
    }
    files.push(("cuts.toml".to_owned(), text.into_bytes()));
    Ok(files)
}
