//! `bore`: the profile that a circling cutter leaves, its parameters, what it depends on.

use std::path::Path;

use truepath_bore::dependence::TeethRow;
use truepath_bore::envelope::{Profile, cutting_teeth};
use truepath_bore::roots::roots;
use truepath_bore::setup::{Setup, cusp_formula};
use truepath_bore::texture::{Cutoffs, texture};
use truepath_bore::wanted::feed_for;
use truepath_bore::{dependence, depth};
use truepath_ground::diagnostics::Failure;
use truepath_ground::output::OutputFolder;

use super::bore_error::refused;
use super::bore_files::{FILES, write};

pub use super::bore_summary::{BoreSummary, Roots, Wanted};

/// Teeth in the table of dependence, at least.
const TEETH: u32 = 8;
/// Heights of `levels.csv`.
const LEVELS: usize = 11;

/// What is asked.
#[derive(Clone, Copy, Debug)]
pub struct Options<'a> {
    /// Bore, cutter, feed and speed.
    pub setup: Setup,
    /// Whether a feed was given; without one the wanted waviness decides it.
    pub feed_given: bool,
    /// Height of the wall to look at, mm.
    pub depth_mm: Option<f64>,
    /// Cut-offs of the parameters.
    pub cutoffs: Cutoffs,
    /// Ray whose roots are listed, degrees.
    pub roots_at_deg: Option<f64>,
    /// Height of waviness that is wanted, mm.
    pub wanted_mm: Option<f64>,
    /// Output folder.
    pub out: Option<&'a Path>,
    /// Replace existing files.
    pub force: bool,
}

/// Computes the bore, and writes tables and pictures where a folder is named. `progress` is told the share done, 0…1.
///
/// # Errors
/// Numbers out of range or without a wall (codes B001…B006), and outputs that cannot be written.
pub fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<BoreSummary, Failure> {
    let mut setup = options.setup;
    let wanted = options.wanted_mm.map(|mm| wanted(options, mm)).transpose()?;
    if let (Some(found), false) = (&wanted, options.feed_given) {
        setup.feed_mm_per_min = found.feed_mm_per_min;
    }
    let profile = setup.profile(0.0).map_err(|e| refused(&e))?;
    let folder = options.out.map(|out| OutputFolder::create(out, options.force, FILES)).transpose()?;
    let parameters = texture(&profile, &options.cutoffs).map_err(|e| refused(&e))?;
    let motion = profile.passes.motion;
    let roots = options.roots_at_deg.map(|phi| listed(&profile, phi)).transpose()?;
    let on_teeth = dependence::on_teeth(&setup, TEETH.max(setup.cutter.teeth)).map_err(|e| refused(&e))?;
    progress(0.2);
    let climb = setup.rpm < 0.0;
    let here = |row: &TeethRow| if climb { row.climb_mm } else { row.conventional_mm };
    let teeth_exponent =
        dependence::exponent(on_teeth.iter().filter_map(|row| Some((f64::from(row.teeth), here(row)?))));
    let on_runout = if setup.cutter.teeth > 1 {
        dependence::on_runout(&setup, &mut |share| progress(0.2 + 0.5 * share)).map_err(|e| refused(&e))?
    } else {
        Vec::new()
    };
    let levels = match options.depth_mm {
        Some(depth) => depth::levels(&setup, depth, LEVELS).map_err(|e| refused(&e))?,
        None => Vec::new(),
    };
    progress(0.8);
    let summary = BoreSummary {
        version: 1,
        hole_radius_mm: setup.hole_mm,
        cutter_radius_mm: setup.cutter.radius_mm,
        teeth: setup.cutter.teeth,
        helix_deg: setup.cutter.helix_deg,
        runout_mm: setup.cutter.runout_mm,
        runout_deg: setup.cutter.runout_deg,
        direction: if climb { "climb" } else { "conventional" },
        feed_mm_per_min: setup.feed_mm_per_min,
        feed_at: setup.feed_at,
        feed_per_tooth_mm: setup.feed_per_tooth(),
        rpm: setup.rpm,
        path_radius_mm: motion.path_mm,
        omega1_rad_per_s: motion.omega1,
        omega2_rad_per_s: motion.omega2,
        laps: profile.passes.laps,
        waviness_mm: profile.height(),
        smallest_radius_mm: profile.lowest(),
        largest_radius_mm: profile.passes.highest(),
        cutting_teeth: cutting_teeth(&profile.passes, &profile.stretches),
        cusp_formula_mm: cusp_formula(&motion, setup.cutter.radius_mm, setup.cutter.teeth),
        parameters,
        wanted,
        roots,
        on_teeth,
        teeth_exponent,
        on_feed: dependence::on_feed(&setup),
        on_runout,
        on_helix: dependence::on_helix(&setup).map_err(|e| refused(&e))?,
        levels,
        warnings: warnings(&setup, &profile),
    };
    if let Some(folder) = folder {
        write(&folder, &summary, &setup, &profile, options.depth_mm)?;
        folder.commit()?;
    }
    progress(1.0);
    Ok(summary)
}

fn wanted(options: &Options, wanted_mm: f64) -> Result<Wanted, Failure> {
    let found = feed_for(&options.setup, wanted_mm).map_err(|e| refused(&e))?;
    let profile = found.profile(0.0).map_err(|e| refused(&e))?;
    // Only the ratio of the speeds counts.
    let ratio = options.setup.feed_mm_per_min / found.feed_mm_per_min;
    Ok(Wanted {
        wanted_mm,
        feed_mm_per_min: found.feed_mm_per_min,
        feed_per_tooth_mm: found.feed_per_tooth(),
        height_mm: profile.height(),
        rpm_at_given_feed: options.feed_given.then_some(found.rpm.abs() * ratio),
    })
}

fn listed(profile: &Profile, phi_deg: f64) -> Result<Roots, Failure> {
    truepath_bore::Refusal::unless_in("angle of the ray", "°", phi_deg, -3600.0, 3600.0).map_err(|e| refused(&e))?;
    let phi = truepath_bore::passes::around(phi_deg.to_radians());
    let list = roots(&profile.passes, phi);
    let on_ray = list.iter().filter(|r| r.on_ray).count();
    Ok(Roots { phi_deg, radius_mm: profile.at(phi).0, on_ray, opposite: list.len() - on_ray, list })
}

fn warnings(setup: &Setup, profile: &Profile) -> Vec<String> {
    let mut said = Vec::new();
    let passes = &profile.passes;
    let seamless = truepath_bore::passes::Passes::laps_without_seam(&passes.motion);
    if passes.laps < seamless {
        said.push(format!(
            "{} laps leave a seam where the last mark meets the first; from {seamless:.4} laps on there is none",
            passes.laps
        ));
    }
    let cutting = cutting_teeth(passes, &profile.stretches);
    if cutting < passes.teeth.len() {
        said.push(format!(
            "with {:.3} µm of runout {cutting} of {} teeth cut to the wall at the tip",
            setup.cutter.runout_mm * 1e3,
            passes.teeth.len()
        ));
    }
    said
}
