//! Further places, given what was measured.
//!
//! The choice before any touch starts from what the job states; this one from the covariance of the fit to the points
//! at hand, with the sensitivities at its parameters, and asks for the corrected wall: by how much does its standard
//! deviation at the worst place fall? Touched is the part that was measured, or the next one, which is cut with a
//! correction and has a datum of its own.
//!
//! In a tight corner the load is nowhere steady, and only there is it high. So here such places are not kept off: a touch
//! at one is taken to be less certain, by what the wall changes within a tenth of a millimetre.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_ground::diagnostics::Failure;
use truepath_ground::units::{float, mm};
use truepath_job::pass::Pass;

use super::approach::{Xy, along};
use super::choice_next::{Gain, choose_next, largest};
use super::covariance::Covariance;
use super::estimate::Estimate;
use super::plan::{Gained, Place, Plan};
use super::probing_setup::ProbingSetup;
use super::reason;
use super::sensitivity::sensitivities;
use super::settings::Settings;
use super::wall_sensitivity::WallSensitivity;
use crate::correction::Identification;

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
    let (sites, kept_off) = setup.sites(pass, path, &estimate, (true, &[]))?;
    let sensitivities = sensitivities(path, &estimate, &sites, &setup.heights, setup.probe.noise, progress);
    let known = Covariance::of(&fit.covariance, measured.is_next);
    let noise = mm(setup.probe.noise);
    let touched: Vec<Xy> = measured.touched_mm.iter().map(|s| wall(path, *s)).collect();
    let limits = (settings.places as usize, setup.apart(), noise);
    let before = largest(&known, measured.wall).0;
    let gains = choose_next(&sites, &sensitivities, measured.wall, known.clone(), &touched, limits);
    let after = gains.last().map_or(&known, |gain| &gain.choice.after);
    let place = |(rank, gain): (usize, &Gain)| Place {
        gain: Some(Gained {
            max_sigma_before_mm: gain.sigma[0],
            max_sigma_after_mm: gain.sigma[1],
            worst_s_mm: gain.worst_s,
            worth_it: gain.is_worth_it(noise),
        }),
        ..Place::of(&sites[gain.choice.site], &gain.choice, rank, prior, &setup.heights)
    };
    let places: Vec<Place> = gains.iter().enumerate().map(place).collect();
    let mut plan = Plan {
        kept_off,
        unknowns: reason::unknowns(after, prior),
        wall_sigma_mm: [before, largest(after, measured.wall).0],
        ..Plan::of(setup, pass, settings, places)
    };
    plan.warnings.extend(doubt(&gains, settings, noise));
    progress(1.0);
    Ok(plan)
}

/// Nominal wall at a place along the contour, mm.
fn wall(path: &Path, s_mm: f64) -> Xy {
    let sample = &path.samples()[path.index_at(truepath_core::units::Offset::from_nm((s_mm * 1e6).round() as i64))];
    let centre = [sample.point.x, sample.point.y].map(|p| p.nm() as f64 / 1e6);
    along(centre, [float(sample.normal.x), float(sample.normal.y)], mm(path.setup().radius))
}

/// What the user should know: when more touches are not worth it.
fn doubt(gains: &[Gain], settings: &Settings, noise: f64) -> Option<String> {
    let below = format!(
        "would move the least certain place of the corrected wall by less than the noise of a reading, {noise} mm"
    );
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
