//! The plan of a verification program: every touch with its coordinates and its reason.

use std::collections::BTreeMap;

use truepath_core::cut::WallLaw;
use truepath_core::identify::Prior;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::mm;
use truepath_job::job::Assumed;
use truepath_job::pass::{Pass, PathBuffer};

use super::approach::along;
use super::candidates::{KeptOff, Site};
use super::choice::{Choice, choose};
use super::estimate::Estimate;
use super::heights::{Height, smaller_ball};
use super::part_program::PartProgram;
use super::probing_setup::{ProbingSetup, Touchable};
use super::reason::{self, Unknown};
use super::sensitivity::Sensitivity;
use super::settings::{Settings, USUAL_HEIGHTS};

/// A place of the wall.
#[derive(Clone, Debug, PartialEq)]
pub struct Place {
    /// The contour it is of, where the plan is of several.
    pub contour: Option<String>,
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
    /// Its heights, from the highest down.
    pub heights: Vec<Height>,
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
    /// A chosen site with its reasons; what is `beside` the model there has a standard deviation before and after its touches, mm.
    pub(super) fn of(
        site: &Site,
        choice: &Choice,
        beside: [f64; 2],
        (rank, prior, unit): (usize, &Prior, Unit),
        heights: &[Height],
    ) -> Self {
        Self {
            contour: None,
            s_mm: mm(site.s),
            line: site.line,
            wall: site.wall,
            normal: site.normal.map(|v| -v),
            what: reason::place(site, unit),
            why: reason::tells([&choice.before, &choice.after], beside, prior, unit),
            rank,
            gain: None,
            heights: heights.to_vec(),
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
    /// Whether the stock is touched, before the pass.
    pub before_the_pass: bool,
    /// Places in the order of the contour, one contour after the other.
    pub places: Vec<Place>,
    /// How many places were looked at and kept off, by reason.
    pub kept_off: BTreeMap<KeptOff, usize>,
    /// What the touches leave of every unknown.
    pub unknowns: Vec<Unknown>,
    /// Standard deviation of the wall, mm, before the touches and after them: of the predicted wall, root mean square, or,
    /// of a plan of further places, the largest of the corrected wall.
    pub wall_sigma_mm: [f64; 2],
    /// Why the heights are what they are, where they were chosen for the profile of the wall.
    pub heights_why: Option<String>,
    /// A ball that would touch much more of the height of the wall, mm; `None` where that of the job will do.
    pub smaller_ball_mm: Option<f64>,
    /// What the job does not say and was taken from the program or a default.
    pub assumed: Vec<Assumed>,
    /// What the user should know.
    pub warnings: Vec<Remark>,
}

impl Plan {
    /// A plan of these places, which are put into the order of their contour; nothing is said yet of what they tell.
    pub(super) fn of(setup: ProbingSetup, pass: &Pass, settings: &Settings, mut places: Vec<Place>) -> Self {
        places.sort_by(|a, b| a.s_mm.total_cmp(&b.s_mm));
        Self {
            program: setup.program,
            correction: None,
            settings: settings.clone(),
            ball_mm: 2.0 * setup.ball.radius,
            z_is_tip: setup.probe.z_reference == truepath_core::job::ZReference::Tip,
            safe_z_mm: setup.safe_z_mm,
            before_the_pass: false,
            places,
            kept_off: BTreeMap::new(),
            unknowns: Vec::new(),
            wall_sigma_mm: [0.0; 2],
            heights_why: setup.heights_why,
            smaller_ball_mm: None,
            assumed: pass.job.assumed.clone(),
            warnings: pass.warnings.clone(),
        }
    }
    /// The plans of several contours as one; `None` of none.
    pub(super) fn joint(plans: Vec<Self>) -> Option<Self> {
        let mut plans = plans.into_iter();
        let mut joint = plans.next()?;
        for other in plans {
            joint.safe_z_mm = joint.safe_z_mm.max(other.safe_z_mm);
            joint.places.extend(other.places);
            joint
                .warnings
                .extend(other.warnings.into_iter().filter(|said| !joint.warnings.contains(said)).collect::<Vec<_>>());
        }
        Some(joint)
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
        let pairs = self.places.iter().flat_map(|place| place.heights.iter().map(move |height| (place, height)));
        pairs.enumerate().map(|(k, (place, height))| Touch { id: k + 1, place, height })
    }
    /// How many touches there are.
    pub fn count(&self) -> usize {
        self.places.iter().map(|place| place.heights.len()).sum()
    }
    /// Most heights at a place.
    pub fn most_heights(&self) -> usize {
        self.places.iter().map(|place| place.heights.len()).max().unwrap_or_default()
    }
}

/// Plans the verification of a pass. `progress` is told the share done, 0…1.
///
/// # Errors
/// A job without probe, settings out of range, a ball without room (`V002`, `V003`), no place that may be touched
/// (`V004`), and whatever is wrong with the program.
pub fn plan(pass: &Pass, settings: &Settings, progress: &mut dyn FnMut(f64)) -> Result<Plan, Failure> {
    plan_every(std::slice::from_ref(pass), settings, progress)
}

/// A contour with the places that may be touched on it.
struct Wall<'a> {
    pass: &'a Pass,
    setup: ProbingSetup,
    sites: Vec<Site>,
    sensitivities: Vec<Sensitivity>,
    length_mm: f64,
}

/// Places on each contour of several, at least: one says nothing of the shape of its wall.
const LEAST_EACH: usize = 2;

/// Plans the verification of several contours of one part in one program. What a touch tells of machine and material holds
/// for all of them: the places are chosen together, and each contour has two of them at least. A contour that cannot be
/// touched is left out, with the reason among the warnings.
///
/// # Errors
/// As [`plan`], when no contour can be touched.
pub fn plan_every(passes: &[Pass], settings: &Settings, progress: &mut dyn FnMut(f64)) -> Result<Plan, Failure> {
    let (mut walls, mut refused, mut warnings) = (Vec::<Wall>::new(), None, Vec::new());
    let mut kept_off = BTreeMap::new();
    let share = 1.0 / passes.len().max(1) as f64;
    for (at, pass) in passes.iter().enumerate() {
        let told = &mut |done: f64| progress((at as f64 + done) * share);
        match Wall::of(pass, passes, settings, &mut kept_off, told) {
            Ok(wall) => {
                if let Some(first) = walls.first().filter(|first| !first.setup.shares_offset(&wall.setup)) {
                    warnings.push(other_offset(pass, first.pass).into());
                    continue;
                }
                walls.push(wall);
            }
            Err(failure) if passes.len() > 1 => {
                warnings.push(format!("{} is not touched: {}", name(pass), in_short(&failure)).into());
                refused = refused.or(Some(failure));
            }
            Err(failure) => return Err(failure),
        }
    }
    let Some(first) = walls.first() else {
        return Err(refused.unwrap_or_else(|| Failure::Internal("a plan of no contour".to_owned())));
    };
    let law = first.pass.core.setup.law;
    let prior = first.pass.core.prior(law);
    let apart = first.setup.apart();
    let owners: Vec<usize> =
        walls.iter().enumerate().flat_map(|(owner, wall)| wall.sites.iter().map(move |_| owner)).collect();
    let sites: Vec<Site> = walls.iter().flat_map(|wall| wall.sites.iter().copied()).collect();
    let sensitivities: Vec<Sensitivity> =
        walls.iter_mut().flat_map(|wall| std::mem::take(&mut wall.sensitivities)).collect();
    let length_mm = walls.iter().map(|wall| wall.length_mm).sum();
    let each = if walls.len() > 1 { LEAST_EACH } else { 0 };
    let chosen = choose(&sites, &sensitivities, settings.places as usize, apart, length_mm, (&owners, each));
    let mut places: Vec<(usize, Place)> = Vec::new();
    for (rank, choice) in chosen.choices.iter().enumerate() {
        let owner = owners[choice.site];
        let heights = &walls[owner].setup.heights;
        places.push((
            owner,
            Place::of(&sites[choice.site], choice, [0.0; 2], (rank, &prior, walls[owner].pass.unit()), heights),
        ));
    }
    let several = passes.len() > 1;
    let mut plans: Vec<Plan> = Vec::new();
    for (owner, wall) in walls.into_iter().enumerate() {
        let mine = places.iter().filter(|(of, _)| *of == owner);
        let contour = several.then(|| name(wall.pass));
        let own = mine.map(|(_, place)| Place { contour: contour.clone(), ..place.clone() }).collect();
        plans.push(Plan::of(wall.setup, wall.pass, settings, own));
    }
    let unit = passes.first().map(Pass::unit).unwrap_or_default();
    let Some(mut joint) = Plan::joint(plans) else { return Err(Failure::Internal("a plan of no contour".to_owned())) };
    joint.warnings.extend(warnings);
    let mut plan =
        Plan { kept_off, unknowns: reason::unknowns(&chosen.known, &prior), wall_sigma_mm: chosen.wall_sigma, ..joint };
    plan.smaller_ball_mm = Reach::of(&plan).smaller_ball(&plan, law);
    let said = unit.remarks(|unit| plan_warnings(&plan, law, unit));
    plan.warnings.extend(said);
    progress(1.0);
    Ok(plan)
}

impl<'a> Wall<'a> {
    /// The places of one of several contours and what they would tell.
    fn of(
        pass: &'a Pass,
        all: &[Pass],
        settings: &Settings,
        kept_off: &mut BTreeMap<KeptOff, usize>,
        progress: &mut dyn FnMut(f64),
    ) -> Result<Self, Failure> {
        let setup = ProbingSetup::of(pass, settings)?;
        let mut buffer = PathBuffer::default();
        let path = pass.sample(&mut buffer)?;
        let prior = pass.core.prior(path.setup().law);
        let estimate = Estimate::stated(&prior);
        let others: Vec<&Pass> = all.iter().filter(|other| !std::ptr::eq(*other, pass)).collect();
        let Touchable { sites, sensitivities, kept_off: kept } =
            setup.touchable(pass, &path, &estimate, &others, progress)?;
        for (reason, count) in kept {
            *kept_off.entry(reason).or_insert(0) += count;
        }
        let length_mm = mm(path.length());
        Ok(Self { pass, setup, sites, sensitivities, length_mm })
    }
}

/// What a contour is called in sentences.
pub(super) fn name(pass: &Pass) -> String {
    let id = pass.plan.as_ref().and_then(|plan| plan.id.clone());
    id.unwrap_or_else(|| "the contour".to_owned())
}

/// What is said of a contour that is cut in another work offset than the first one.
pub(super) fn other_offset(pass: &Pass, first: &Pass) -> String {
    format!(
        "{} is not touched: it is cut in another work offset than {}, and a verification program changes none",
        name(pass),
        name(first)
    )
}

/// Code and finding of a failure.
pub(super) fn in_short(failure: &Failure) -> String {
    match failure {
        Failure::Input(error) => format!("{}: {}", error.code(), error.found()),
        Failure::Usage(what) | Failure::Internal(what) => what.clone(),
    }
}

/// A plan that leaves the wall less certain than this, mm, and than this share of what the job states, is doubted.
const TELLING: (f64, f64) = (0.005, 0.1);

/// How far up and down a plan touches the walls, and how high they are, mm: the largest of each.
struct Reach {
    spread_mm: f64,
    depth_mm: f64,
}

impl Reach {
    fn of(plan: &Plan) -> Self {
        let spread = |place: &Place| {
            let heights = &place.heights;
            heights.first().map_or(0.0, |h| h.above_tip_mm) - heights.last().map_or(0.0, |h| h.above_tip_mm)
        };
        let depths = plan.places.iter().flat_map(|p| &p.heights).map(|h| h.above_tip_mm / h.fraction);
        Self { spread_mm: plan.places.iter().map(spread).fold(0.0, f64::max), depth_mm: depths.fold(0.0, f64::max) }
    }

    /// What another ball would touch, mm.
    fn with_ball(&self, plan: &Plan, ball_mm: f64) -> f64 {
        self.spread_mm + (plan.ball_mm - ball_mm) / 2.0
    }

    /// The ball that would touch more of the height, where that of the job touches the upper part of the wall only, mm.
    fn smaller_ball(&self, plan: &Plan, law: WallLaw) -> Option<f64> {
        let one_height = plan.settings.heights == Some(1);
        let spread = |ball: f64| self.with_ball(plan, ball);
        if law != WallLaw::Helical || one_height { None } else { smaller_ball(plan.ball_mm, self.depth_mm, spread) }
    }

    fn words(&self, plan: &Plan, ball_mm: f64, unit: Unit) -> String {
        let share = |height: f64| 100.0 * height / self.depth_mm;
        format!(
            "a ball of {} {name} touches {:.0} % of the height of this wall, the rest of it is the model's word; one of {} {name} touches {:.0} %",
            unit.of(plan.ball_mm),
            share(self.spread_mm),
            unit.of(ball_mm),
            share(self.with_ball(plan, ball_mm)),
            name = unit.name()
        )
    }
}

/// What the user should know of a plan.
fn plan_warnings(plan: &Plan, law: WallLaw, unit: Unit) -> Vec<String> {
    let name = unit.name();
    let mut out = Vec::new();
    // Several contours have as many more as each of them needs.
    let (found, wanted) = (plan.places.len(), plan.settings.places as usize);
    if found < wanted {
        out.push(format!(
            "{found} places instead of {wanted}: no more of them may be touched without being too close together"
        ));
    }
    let heights = plan.settings.heights.unwrap_or(USUAL_HEIGHTS);
    if plan.most_heights() < heights as usize {
        out.push(format!("{} heights instead of {}: the ball has no room for more", plan.most_heights(), heights));
    }
    let [before, after] = plan.wall_sigma_mm;
    if after > TELLING.0 && after > TELLING.1 * before {
        let hidden: Vec<&str> = plan.unknowns.iter().filter(|u| !u.observable).map(|u| u.words).collect();
        out.push(format!(
            "these touches leave the wall uncertain by {:.4} {name} (one sigma); they hardly tell: {}",
            unit.of(after),
            hidden.join(", ")
        ));
    }
    let reach = Reach::of(plan);
    // Over less than that nothing bends that would matter.
    if law == WallLaw::Helical && plan.most_heights() > 1 && reach.spread_mm < 1.0 && reach.depth_mm > 2.5 {
        out.push(format!(
            "the heights lie within {:.2} {name}: bending is hardly seen; a smaller ball reaches lower",
            unit.of(reach.spread_mm)
        ));
    }
    out.extend(plan.smaller_ball_mm.map(|ball| reach.words(plan, ball, unit)));
    if plan.settings.free_width.is_some() {
        out.push("--free-width is taken on trust: nothing else than the contour's wall is known".to_owned());
    }
    out
}
