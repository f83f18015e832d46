//! `bore`: the profile that a circling cutter leaves, its parameters, what it depends on.

mod files;
mod summary;
mod words;

use std::path::PathBuf;

use clap::{Args, ValueEnum};
use files::{FILES, write};
use truepath_bore::dependence::TeethRow;
use truepath_bore::envelope::{Profile, cutting_teeth};
use truepath_bore::motion::Cutter;
use truepath_bore::roots::roots;
use truepath_bore::setup::{FeedAt, Setup, cusp_formula};
use truepath_bore::texture::{Cutoffs, texture};
use truepath_bore::wanted::feed_for;
use truepath_bore::{dependence, depth};
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::{self, Typed, Unit};
use truepath_ground::output::OutputFolder;

use truepath_job::job::one_of;
use words::words;

pub use summary::{BoreSummary, Roots, Wanted};

use crate::terminal::Terminal;

/// Teeth in the table of dependence, at least.
const TEETH: u32 = 8;
/// Heights of `levels.csv`.
const LEVELS: usize = 11;

/// At which radius the feed may hold.
const FEEDS: [(&str, FeedAt); 2] = [("centre", FeedAt::Centre), ("wall", FeedAt::Wall)];

/// What is asked.
#[derive(Clone, Debug, Args)]
#[command(allow_negative_numbers = true)]
pub struct Options {
    /// Nominal radius of the hole: the path of the centre and the cutter's radius together, mm, or with its unit
    /// (0.1in), in which the figures are then said.
    #[arg(long, value_name = "LENGTH")]
    hole_radius: Typed,
    /// Radius of the cutter, mm, or with its unit (0.1in).
    #[arg(long, value_name = "LENGTH", value_parser = length::flag)]
    cutter_radius: f64,
    /// Teeth, equally pitched.
    #[arg(long, value_name = "N")]
    teeth: u32,
    /// Feed, mm/min, or with its unit (12in); may be left out when a waviness is wanted.
    #[arg(long, value_name = "LENGTH_PER_MIN", value_parser = length::flag, required_unless_present = "wanted_waviness")]
    feed: Option<f64>,
    /// Whether the feed is that of the cutter's centre or of the wall.
    #[arg(long, value_parser = one_of(&FEEDS), default_value = "centre")]
    feed_at: FeedAt,
    /// Spindle speed; a negative one turns against the travel.
    #[arg(long, value_name = "REV_PER_MIN")]
    rpm: f64,
    /// How the cutter turns against its travel round the hole; by default the sign of the speed decides.
    #[arg(long, value_enum)]
    direction: Option<Direction>,
    /// Turn the cutter the other way round.
    #[arg(long, conflicts_with = "direction")]
    reverse: bool,
    /// Helix angle.
    #[arg(long, value_name = "DEG", default_value_t = 0.0)]
    helix: f64,
    /// Look at the wall over this height as well, mm, or with its unit (0.1in).
    #[arg(long, value_name = "LENGTH", value_parser = length::flag)]
    depth: Option<f64>,
    /// Offset of the cutter's axis from the spindle's, mm, or with its unit (0.1in).
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, default_value_t = 0.0)]
    runout: f64,
    /// Direction of the runout against tooth 1.
    #[arg(long, value_name = "DEG", default_value_t = 0.0)]
    runout_angle: f64,
    /// Angle of tooth 1 when the circle begins; 0 points straight at the wall.
    #[arg(long, value_name = "DEG", default_value_t = 0.0)]
    tooth_phase: f64,
    /// Laps of the cutter's centre; by default one and as much as it takes to leave no seam.
    #[arg(long, value_name = "N")]
    laps: Option<f64>,
    /// Cut-off wavelength λc between waviness and roughness, mm, or with its unit (0.1in).
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, default_value_t = Cutoffs::default().lambda_c_mm)]
    lambda_c: f64,
    /// Cut-off of roundness, undulations per revolution.
    #[arg(long, value_name = "UPR", default_value_t = Cutoffs::default().upr)]
    upr: f64,
    /// List every time at which a tooth is on the line of the ray --phi.
    #[arg(long, requires = "phi")]
    roots: bool,
    /// The ray, degrees along the travel from where the circle begins.
    #[arg(long, value_name = "DEG", requires = "roots")]
    phi: Option<f64>,
    /// Find the feed at which the height of the waviness is this, mm, or with its unit (0.1in).
    #[arg(long, value_name = "LENGTH", value_parser = length::flag, conflicts_with = "laps")]
    wanted_waviness: Option<f64>,
    /// Folder for tables, pictures and the summary.
    #[arg(short, long, value_name = "DIR")]
    output: Option<PathBuf>,
    /// Replace the files of an earlier run.
    #[arg(long, requires = "output")]
    force: bool,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Direction {
    /// Against the travel (G3 inside a bore with M3).
    Climb,
    /// With the travel (G2 inside a bore with M3).
    Conventional,
}

impl Options {
    /// That in which figures are said.
    fn unit(&self) -> Unit {
        self.hole_radius.unit.unwrap_or_default()
    }
    fn setup(&self) -> Setup {
        let rpm = match (self.direction, self.reverse) {
            (Some(Direction::Conventional), _) => self.rpm.abs(),
            (Some(Direction::Climb), _) => -self.rpm.abs(),
            (None, true) => -self.rpm,
            (None, false) => self.rpm,
        };
        let cutter = Cutter {
            radius_mm: self.cutter_radius,
            teeth: self.teeth,
            helix_deg: self.helix,
            runout_mm: self.runout,
            runout_deg: self.runout_angle,
            phase_deg: self.tooth_phase,
        };
        Setup {
            hole_mm: self.hole_radius.mm,
            cutter,
            feed_mm_per_min: self.feed.unwrap_or(1.0),
            feed_at: self.feed_at,
            rpm,
            laps: self.laps,
        }
    }
}

/// Computes the bore and prints it.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let summary = terminal.watch("milling the bore", |progress| run(options, progress))?;
    terminal.warn_all(&summary.warnings);
    terminal.tell(&summary, || words(&summary, options.unit()))
}

/// Computes the bore, and writes tables and pictures where a folder is named. `progress` is told the share done, 0…1.
///
/// # Errors
/// Numbers out of range or without a wall (codes B001…B006), and outputs that cannot be written.
fn run(options: &Options, progress: &mut dyn FnMut(f64)) -> Result<BoreSummary, Failure> {
    let mut setup = options.setup();
    let wanted = options.wanted_waviness.map(|mm| wanted(&setup, mm, options.feed)).transpose()?;
    if let (Some(found), None) = (&wanted, options.feed) {
        setup.feed_mm_per_min = found.feed_mm_per_min;
    }
    let profile = setup.profile(0.0)?;
    let folder = options.output.as_ref().map(|out| OutputFolder::create(out, options.force, FILES)).transpose()?;
    let parameters = texture(&profile, &Cutoffs { lambda_c_mm: options.lambda_c, upr: options.upr })?;
    let motion = profile.passes.motion;
    let roots = options.phi.map(|phi| listed(&profile, phi)).transpose()?;
    let on_teeth = dependence::on_teeth(&setup, TEETH.max(setup.cutter.teeth))?;
    progress(0.2);
    let climb = setup.rpm < 0.0;
    let here = |row: &TeethRow| if climb { row.climb_mm } else { row.conventional_mm };
    let teeth_exponent =
        dependence::exponent(on_teeth.iter().filter_map(|row| Some((f64::from(row.teeth), here(row)?))));
    let on_runout = if setup.cutter.teeth > 1 {
        dependence::on_runout(&setup, &mut |share| progress(0.2 + 0.5 * share))?
    } else {
        Vec::new()
    };
    let levels = match options.depth {
        Some(depth) => depth::levels(&setup, depth, LEVELS)?,
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
        on_helix: dependence::on_helix(&setup)?,
        levels,
        warnings: warnings(&setup, &profile, options.unit()),
    };
    if let Some(folder) = folder {
        write(&folder, &summary, &setup, &profile, options.depth)?;
        folder.commit()?;
    }
    progress(1.0);
    Ok(summary)
}

fn wanted(setup: &Setup, wanted_mm: f64, feed: Option<f64>) -> Result<Wanted, Failure> {
    let found = feed_for(setup, wanted_mm)?;
    let profile = found.profile(0.0)?;
    // Only the ratio of the speeds counts.
    let ratio = setup.feed_mm_per_min / found.feed_mm_per_min;
    Ok(Wanted {
        wanted_mm,
        feed_mm_per_min: found.feed_mm_per_min,
        feed_per_tooth_mm: found.feed_per_tooth(),
        height_mm: profile.height(),
        rpm_at_given_feed: feed.map(|_| found.rpm.abs() * ratio),
    })
}

fn listed(profile: &Profile, phi_deg: f64) -> Result<Roots, Failure> {
    truepath_bore::Refusal::unless_in("angle of the ray", "°", phi_deg, -3600.0, 3600.0)?;
    let phi = truepath_bore::passes::around(phi_deg.to_radians());
    let list = roots(&profile.passes, phi);
    let on_ray = list.iter().filter(|r| r.on_ray).count();
    Ok(Roots { phi_deg, radius_mm: profile.at(phi).0, on_ray, opposite: list.len() - on_ray, list })
}

fn warnings(setup: &Setup, profile: &Profile, unit: Unit) -> Vec<String> {
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
            "with {:.3} {} of runout {cutting} of {} teeth cut to the wall at the tip",
            unit.small(setup.cutter.runout_mm),
            unit.small_name(),
            passes.teeth.len()
        ));
    }
    said
}
