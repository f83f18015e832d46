//! What `bore` computed, as it is printed with `--json` and written to `summary.json`.

use truepath_bore::dependence::{FeedRow, HelixRow, RunoutRow, TeethRow};
use truepath_bore::depth::Level;
use truepath_bore::roots::Root;
use truepath_bore::setup::FeedAt;
use truepath_bore::texture::Texture;

/// The bore as computed.
#[derive(Clone, Debug, serde::Serialize)]
pub struct BoreSummary {
    /// Version of this file.
    pub version: u32,
    /// Nominal radius, mm.
    pub hole_radius_mm: f64,
    /// Radius, mm.
    pub cutter_radius_mm: f64,
    /// Teeth.
    pub teeth: u32,
    /// Helix, degrees.
    pub helix_deg: f64,
    /// Offset of the cutter's axis, mm.
    pub runout_mm: f64,
    /// Its direction against tooth 1, degrees.
    pub runout_deg: f64,
    /// `conventional` or `climb`.
    pub direction: &'static str,
    /// Feed, mm/min.
    pub feed_mm_per_min: f64,
    /// Where the feed holds.
    pub feed_at: FeedAt,
    /// Feed per tooth of the cutter's centre, mm.
    pub feed_per_tooth_mm: f64,
    /// Spindle speed, rev/min, negative for climb.
    pub rpm: f64,
    /// Radius of the centre's path, mm.
    pub path_radius_mm: f64,
    /// Angular speed of the centre, rad/s.
    pub omega1_rad_per_s: f64,
    /// Angular speed of the cutter, rad/s.
    pub omega2_rad_per_s: f64,
    /// Laps of the centre.
    pub laps: f64,
    /// Height of the waviness of the unfiltered envelope, mm: what Urinov 2020 calls waviness. The same as Pt.
    pub waviness_mm: f64,
    /// Smallest radius of the wall, mm.
    pub smallest_radius_mm: f64,
    /// Largest radius, mm.
    pub largest_radius_mm: f64,
    /// Teeth that leave a mark at the tip.
    pub cutting_teeth: usize,
    /// Pt by the second-order formula for teeth that run true, mm.
    pub cusp_formula_mm: f64,
    /// Parameters under their ISO names.
    pub parameters: Texture,
    /// The feed for the wanted waviness.
    pub wanted: Option<Wanted>,
    /// Roots on the line of the ray asked for.
    pub roots: Option<Roots>,
    /// Height over number of teeth.
    pub on_teeth: Vec<TeethRow>,
    /// Exponent of the height over the number of teeth as the cutter turns.
    pub teeth_exponent: Option<f64>,
    /// Height over feed.
    pub on_feed: Vec<FeedRow>,
    /// Height over runout; empty for one tooth.
    pub on_runout: Vec<RunoutRow>,
    /// Turn of the profile over helix angles.
    pub on_helix: Vec<HelixRow>,
    /// Profiles over the depth.
    pub levels: Vec<Level>,
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Feed and speed for a wanted height of the waviness.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Wanted {
    /// What was asked for, mm.
    pub wanted_mm: f64,
    /// The feed at the given speed, mm/min.
    pub feed_mm_per_min: f64,
    /// Its feed per tooth, mm.
    pub feed_per_tooth_mm: f64,
    /// Pt at that feed from the envelope, mm.
    #[serde(rename = "Pt_mm")]
    pub height_mm: f64,
    /// The speed at the given feed, rev/min; none without one.
    pub rpm_at_given_feed: Option<f64>,
}

/// The roots of one ray.
#[derive(Clone, Debug, serde::Serialize)]
pub struct Roots {
    /// The ray, degrees along the travel.
    pub phi_deg: f64,
    /// Radius of the wall there, mm.
    pub radius_mm: f64,
    /// Roots on the ray.
    pub on_ray: usize,
    /// Roots on the opposite ray.
    pub opposite: usize,
    /// All of them by time.
    pub list: Vec<Root>,
}
