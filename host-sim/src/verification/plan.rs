//! The plan of a verification program: every touch with its coordinates and its reason.

use std::collections::BTreeMap;

use truepath_core::cut::WallLaw;

use crate::diagnostics::{Failure, InputError};
use crate::pass::{Pass, PathBuffer};
use crate::report::{float, mm};

use super::approach::{Ball, along};
use super::candidates::{KeptOff, candidates};
use super::choice::choose;
use super::heights::{Height, heights};
use super::reason::{self, Unknown};
use super::sensitivity::tellings;
use super::settings::Settings;
use super::shop::Shop;

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
    pub shop: Shop,
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
    /// Standard deviation of the predicted wall, root mean square, mm: as the job states it, and after the touches.
    pub wall_sigma_mm: [f64; 2],
    /// What the user should know.
    pub warnings: Vec<String>,
}

/// Between two places, at least: the ball's radius and this much more, mm, so that they are two places of the wall.
const APART: f64 = 1.0;
/// Above the engaged depth, when neither user nor program says how high is safe, mm.
const SAFE_ABOVE: f64 = 50.0;

impl Plan {
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
    settings.check()?;
    let probe = pass.job.require_probe()?;
    let shop = Shop::read(pass)?;
    let heights = heights(pass, &probe, settings)?;
    let ball = Ball { radius: mm(probe.ball_diameter) / 2.0, clearance: settings.clearance };
    let free = settings.free_width.unwrap_or(2.0 * mm(pass.core.setup.radius));
    if ball.width() > free + 1e-9 {
        return Err(no_width(ball, free, settings).into());
    }
    let mut buffer = PathBuffer::default();
    let path = pass.sample(&mut buffer)?;
    let law = path.setup().law;
    let prior = pass.core.prior(law);
    let (sites, kept_off) = candidates(pass, &path, &prior, ball, mm(probe.noise));
    let kept_off = kept_off.iter().fold(BTreeMap::new(), |mut counts, reason| {
        *counts.entry(*reason).or_insert(0) += 1;
        counts
    });
    if sites.is_empty() {
        return Err(no_place(&kept_off).into());
    }
    let tellings = tellings(&path, &prior, &sites, &heights, probe.noise, progress);
    let chosen = choose(&sites, &tellings, settings.places as usize, ball.radius + APART, mm(path.length()));
    let mut places: Vec<Place> = chosen
        .choices
        .iter()
        .enumerate()
        .map(|(rank, choice)| {
            let site = &sites[choice.site];
            Place {
                s_mm: mm(site.s),
                line: site.line,
                wall: site.wall,
                normal: site.normal.map(|v| -v),
                what: reason::place(site),
                why: reason::tells(choice, &prior),
                rank,
            }
        })
        .collect();
    places.sort_by(|a, b| a.s_mm.total_cmp(&b.s_mm));
    let safe_z_mm = safe_z(pass, settings, &shop)?;
    let mut plan = Plan {
        shop,
        settings: settings.clone(),
        ball_mm: 2.0 * ball.radius,
        z_is_tip: probe.z_reference == truepath_core::job::ZReference::Tip,
        safe_z_mm,
        places,
        heights,
        kept_off,
        unknowns: reason::unknowns(&chosen.known, &prior),
        wall_sigma_mm: chosen.wall_sigma,
        warnings: pass.warnings.clone(),
    };
    plan.warnings.extend(doubts(&plan, law));
    progress(1.0);
    Ok(plan)
}

/// Height of the moves between places: above the engaged depth, and no lower than the part's program ever moved.
fn safe_z(pass: &Pass, settings: &Settings, shop: &Shop) -> Result<f64, InputError> {
    let top = pass.core.contour.z.nm() as f64 / 1e6 + float(pass.core.setup.axial_depth);
    let highest = shop.highest_nm.map_or(f64::NEG_INFINITY, |z| z as f64 / 1e6);
    match settings.safe_z {
        None => Ok((top + SAFE_ABOVE).max(highest)),
        Some(z) if z > top => Ok(z),
        Some(z) => Err(InputError::new(
            "V001",
            format!("--safe-z {z} is not above the wall, which ends at Z{top}"),
            format!("a height above Z{top} and above every clamp"),
            "give a higher one, or leave it out",
        )),
    }
}

fn no_width(ball: Ball, free: f64, settings: &Settings) -> InputError {
    let (found, help) = if settings.free_width.is_some() {
        (format!("--free-width {free}"), "use a smaller ball, or a smaller --clearance")
    } else {
        (
            format!("the pass has cleared {free} mm before the wall, the cutter's diameter"),
            "use a smaller ball or a smaller --clearance, or say with --free-width how much is free before the wall",
        )
    };
    let expected = format!("{} mm: the ball of {} mm and its clearance", ball.width(), 2.0 * ball.radius);
    InputError::new("V003", found, expected, help)
}

fn no_place(kept_off: &BTreeMap<KeptOff, usize>) -> InputError {
    let reasons: Vec<String> = kept_off.iter().map(|(reason, n)| format!("{n} {}", reason.words())).collect();
    InputError::new(
        "V004",
        format!("no place of the contour may be touched; of those looked at, {}", reasons.join(", ")),
        "a place where wall and engagement are steady and the ball's way is free",
        "use a smaller ball or a smaller --clearance, or probe by hand",
    )
}

/// A plan that leaves the wall less certain than this, mm, and than this share of what the job states, is doubted.
const TELLING: (f64, f64) = (0.005, 0.1);

/// What the user should know of a plan.
fn doubts(plan: &Plan, law: WallLaw) -> Vec<String> {
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
