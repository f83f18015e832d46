//! Further places, given what was measured.
//!
//! The choice before any touch starts from what the job states; this one from the covariance of the fit to the points
//! at hand, with the sensitivities at its parameters, and asks for the corrected wall: by how much does its standard
//! deviation at the worst place fall? Touched is the part that was measured, or the next one, which is cut with a
//! correction and has a datum of its own.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::units::Offset;
use truepath_ground::diagnostics::Failure;
use truepath_ground::length::Unit;
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;

use super::approach::{Xy, along};
use super::choice_next::{Gain, Limits, Task, choose_next, largest};
use super::covariance::{Covariance, Thing};
use super::estimate::Estimate;
use super::plan::{Gained, Place, Plan};
use super::probing_setup::{ProbingSetup, Touchable};
use super::reason;
use super::settings::Settings;
use super::wall_sensitivity::WallSensitivity;
use crate::correction::Identification;
use crate::discrepancy::Open;

/// What was measured, and which part will be touched.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// Machine and material by the points at hand.
    pub identified: &'a Identification,
    /// The path of the part that will be touched, under the identified wall law.
    pub path: &'a Path<'a>,
    /// The correction that part was cut with; empty for an uncorrected one.
    pub nodes: &'a [Node],
    /// Whether it is another part than those measured.
    pub is_next: bool,
    /// The corrected wall, which is to become certain.
    pub wall: &'a WallSensitivity,
    /// Places touched on the same part already, along the contour, mm.
    pub touched_mm: &'a [f64],
    /// What the points at hand leave open beside the model; `None` where nothing is believed to be there.
    pub open: Option<&'a Open>,
}

/// Plans the touches of further places. `progress` is told the share done, 0…1.
///
/// # Errors
/// As [`plan`](super::plan()).
pub fn plan_next(
    pass: &Pass,
    settings: &Settings,
    measured: &Measured,
    progress: &mut dyn FnMut(f64),
) -> Result<Plan, Failure> {
    let setup = ProbingSetup::of(pass, settings)?;
    let (path, identified) = (measured.path, measured.identified);
    let (prior, fit) = (identified.prior(), identified.fit());
    let estimate = Estimate { prior, theta: fit.theta, nodes: measured.nodes };
    let Touchable { sites, sensitivities, kept_off } = setup.touchable(pass, path, &estimate, &[], progress)?;
    let known = Covariance::of(&fit.covariance, measured.is_next);
    let known = measured.open.map_or(known.clone(), |open| known.beside(open));
    let beside = |s_mm: f64| measured.open.and_then(|open| open.nearest(s_mm));
    let touches: Vec<Vec<Thing>> =
        sites.iter().zip(&sensitivities).map(|(site, touches)| touches.touches(beside(mm(site.s)))).collect();
    let wall: Vec<(f64, Thing)> = measured
        .wall
        .rows
        .iter()
        .map(|(s, row)| (*s, Thing { row: *row, beside: beside(*s).map(|at| (at, 1.0)) }))
        .collect();
    let noise = mm(setup.probe.noise);
    let touched: Vec<Xy> = measured.touched_mm.iter().map(|s| wall_at(path, *s)).collect();
    let worth = if settings.exactly { 0.0 } else { noise };
    let limits = Limits { count: settings.places as usize, apart: setup.apart(), worth };
    let before = largest(&known, &wall).0;
    let task = Task { sites: &sites, touches: &touches, wall: &wall, touched: &touched };
    let gains = choose_next(&task, known.clone(), limits);
    let after = gains.last().map_or(&known, |gain| &gain.choice.after);
    let place = |(rank, gain): (usize, &Gain)| Place {
        gain: Some(Gained {
            max_sigma_before_mm: gain.sigma[0],
            max_sigma_after_mm: gain.sigma[1],
            worst_s_mm: gain.worst_s,
            worth_it: gain.is_worth_it(noise),
        }),
        ..Place::of(&sites[gain.choice.site], &gain.choice, gain.beside, (rank, prior, pass.unit()), &setup.heights)
    };
    let places: Vec<Place> = gains.iter().enumerate().map(place).collect();
    let mut plan = Plan {
        kept_off,
        unknowns: reason::unknowns(after, prior),
        wall_sigma_mm: [before, largest(after, &wall).0],
        ..Plan::of(setup, pass, settings, places)
    };
    plan.warnings.extend(pass.unit().remarks(|unit| doubt(&gains, settings, noise, unit)));
    progress(1.0);
    Ok(plan)
}

/// Nominal wall at a place along the contour, mm.
fn wall_at(path: &Path, s_mm: f64) -> Xy {
    let sample = &path.samples()[path.index_at(Offset::from_nm((s_mm * 1e6).round() as i64))];
    let centre = [sample.point.x, sample.point.y].map(|p| p.nm() as f64 / 1e6);
    along(centre, [float(sample.normal.x), float(sample.normal.y)], mm(path.setup().radius))
}

/// What the user should know: when more touches are not worth it.
fn doubt(gains: &[Gain], settings: &Settings, noise: f64, unit: Unit) -> Option<String> {
    let (told, name) = (unit.of(noise), unit.name());
    let below = format!("would move the corrected wall nowhere by more than the noise of a reading, {told} {name}");
    match gains {
        [] => Some("no further place may be touched that far from those touched already".to_owned()),
        [first, ..] if !first.is_worth_it(noise) => {
            Some(format!("further places are not worth touching: even the most telling one {below}"))
        }
        all if all.len() < settings.places as usize => {
            Some(format!("{} places are enough: another one {below}", all.len()))
        }
        _ => None,
    }
}
