//! The plan of a verification program: every touch with its coordinates and its reason.

use std::collections::BTreeMap;

use truepath_core::cut::WallLaw;
use truepath_core::identify::Prior;
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::mm;
use truepath_job::pass::{Pass, PathBuffer};

use super::approach::along;
use super::candidates::{KeptOff, Site};
use super::choice::{Choice, choose};
use super::estimate::Estimate;
use super::heights::Height;
use super::part_program::PartProgram;
use super::probing_setup::ProbingSetup;
use super::reason::{self, Unknown};
use super::sensitivity::sensitivities;
use super::settings::Settings;

/// A place of the wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// Place along the contour, mm.
    pub s_mm: f64,
    /// Line of the part's program.
    pub line: u32,
    /// Nominal wall, mm, program coordinates.
    pub wall: [f64; 2],
    /// Unit normal from the wall to the free side.
    pub normal: [f64; 2],
    /// What is there.
    pub what: String,
    /// What its touches tell.
    pub why: String,
    /// How many places were chosen before it: 0 is the most telling.
    pub rank: usize,
    /// What its touches are expected to bring, where something was measured before.
    pub gain: Option<Gained>,
}

/// What the touches of a further place are expected to bring.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct Gained {
    /// Largest standard deviation of the corrected wall before them, mm.
    pub max_sigma_before_mm: f64,
    /// The same after them, mm.
    pub max_sigma_after_mm: f64,
    /// Where the wall is least certain before them, mm along the contour.
    pub worst_s_mm: f64,
    /// Whether they are expected to move that place by more than the noise of a reading.
    pub worth_it: bool,
}

impl Place {
    /// A chosen site with its reasons.
    pub(super) fn of(site: &Site, choice: &Choice, rank: usize, prior: &Prior) -> Self {
        Self {
            s_mm: mm(site.s),
            line: site.line,
            wall: site.wall,
            normal: site.normal.map(|v| -v),
            what: reason::place(site),
            why: reason::tells([&choice.before, &choice.after], prior),
            rank,
            gain: None,
        }
    }
}

/// One touch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Touch<'p> {
    /// Number of the point, from 1, in the order of the program.
    pub id: usize,
    /// Its place.
    pub place: &'p Place,
    /// Its height.
    pub height: &'p Height,
}

/// A plan.
#[derive(Clone, Debug)]
pub struct Plan {
    /// What the part's program says.
    pub program: PartProgram,
    /// CRC-32 of the correction that the touched part is cut with; `None` where it is cut with none, or nothing is said.
    pub correction: Option<u32>,
    /// The choices it was made with.
    pub settings: Settings,
    /// Diameter of the ball, mm.
    pub ball_mm: f64,
    /// Whether Z is that of the ball's tip instead of its centre.
    pub z_is_tip: bool,
    /// Height for moves between places, mm.
    pub safe_z_mm: f64,
    /// Places in the order of the contour.
    pub places: Vec<Place>,
    /// Heights, from the highest down.
    pub heights: Vec<Height>,
    /// How many places were looked at and kept off, by reason.
    pub kept_off: BTreeMap<KeptOff, usize>,
    /// What the touches leave of every unknown.
    pub unknowns: Vec<Unknown>,
    /// Standard deviation of the wall, mm, before the touches and after them: of the predicted wall, root mean square, or,
    /// of a plan of further places, the largest of the corrected wall.
    pub wall_sigma_mm: [f64; 2],
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl Plan {
    /// A plan of these places, which are put into the order of the contour; nothing is said yet of what they tell.
    pub(super) fn of(setup: ProbingSetup, pass: &Pass, settings: &Settings, mut places: Vec<Place>) -> Self {
        places.sort_by(|a, b| a.s_mm.total_cmp(&b.s_mm));
        Self {
            program: setup.program,
            correction: None,
            settings: settings.clone(),
            ball_mm: 2.0 * setup.ball.radius,
            z_is_tip: setup.probe.z_reference == truepath_core::job::ZReference::Tip,
            safe_z_mm: setup.safe_z_mm,
            places,
            heights: setup.heights,
            kept_off: BTreeMap::new(),
            unknowns: Vec::new(),
            wall_sigma_mm: [0.0; 2],
            warnings: pass.warnings.clone(),
        }
    }
    /// Ball's centre at the stand-off of a place, mm.
    pub fn stand_off(&self, place: &Place) -> [f64; 2] {
        along(place.wall, place.normal, self.ball_mm / 2.0 + self.settings.clearance)
    }
    /// Ball's centre where the search ends, mm.
    pub fn search_end(&self, place: &Place) -> [f64; 2] {
        along(place.wall, place.normal, self.ball_mm / 2.0 - self.settings.overtravel)
    }
    /// All touches, in the order of the program.
    pub fn touches(&self) -> impl Iterator<Item = Touch<'_>> {
        let pairs = self.places.iter().flat_map(|place| self.heights.iter().map(move |height| (place, height)));
        pairs.enumerate().map(|(k, (place, height))| Touch { id: k + 1, place, height })
    }
}

/// Plans the verification of a pass. `progress` is told the share done, 0…1.
///
/// # Errors
/// A job without probe, settings out of range, a ball without room (`V002`, `V003`), no place that may be touched
/// (`V004`), and whatever is wrong with the program.
pub fn plan(pass: &Pass, settings: &Settings, progress: &mut dyn FnMut(f64)) -> Result<Plan, Failure> {
    let setup = ProbingSetup::of(pass, settings)?;
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    let law = path.setup().law;
    let prior = pass.core.prior(law);
    let estimate = Estimate::stated(&prior);
    let (sites, kept_off) = setup.sites(pass, &path, &estimate, false)?;
    let sensitivities = sensitivities(&path, &estimate, &sites, &setup.heights, setup.probe.noise, progress);
    let chosen = choose(&sites, &sensitivities, settings.places as usize, setup.apart(), mm(path.length()));
    let reasoned = chosen.choices.iter().enumerate();
    let places = reasoned.map(|(rank, choice)| Place::of(&sites[choice.site], choice, rank, &prior)).collect();
    let mut plan = Plan {
        kept_off,
        unknowns: reason::unknowns(&chosen.known, &prior),
        wall_sigma_mm: chosen.wall_sigma,
        ..Plan::of(setup, pass, settings, places)
    };
    plan.warnings.extend(plan_warnings(&plan, law));
    progress(1.0);
    Ok(plan)
}

/// A plan that leaves the wall less certain than this, mm, and than this share of what the job states, is doubted.
const TELLING: (f64, f64) = (0.005, 0.1);

/// What the user should know of a plan.
fn plan_warnings(plan: &Plan, law: WallLaw) -> Vec<String> {
    let mut out = Vec::new();
    let (found, wanted) = (plan.places.len(), plan.settings.places as usize);
    if found < wanted {
        out.push(format!(
            "{found} places instead of {wanted}: no more of them may be touched without being too close together"
        ));
    }
    if plan.heights.len() < plan.settings.heights as usize {
        out.push(format!(
            "{} heights instead of {}: the ball has no room for more",
            plan.heights.len(),
            plan.settings.heights
        ));
    }
    let [before, after] = plan.wall_sigma_mm;
    if after > TELLING.0 && after > TELLING.1 * before {
        let hidden: Vec<&str> = plan.unknowns.iter().filter(|u| !u.observable).map(|u| u.words).collect();
        out.push(format!(
            "these touches leave the wall uncertain by {after:.4} mm (one sigma); they hardly tell: {}",
            hidden.join(", ")
        ));
    }
    let spread =
        plan.heights.first().map_or(0.0, |h| h.above_tip_mm) - plan.heights.last().map_or(0.0, |h| h.above_tip_mm);
    if law == WallLaw::Helical && plan.heights.len() > 1 && spread < 1.0 {
        out.push(format!(
            "the heights lie within {spread:.2} mm: bending is hardly seen; a smaller ball reaches lower"
        ));
    }
    if plan.settings.free_width.is_some() {
        out.push("--free-width is taken on trust: nothing else than the contour's wall is known".to_owned());
    }
    out
}
