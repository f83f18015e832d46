//! The figures of a correction: `summary.json` of `correct` and `learn`.

use std::collections::BTreeMap;

use truepath_core::cut::{Path, WallLaw};
use truepath_core::identify;
use truepath_core::units::{Offset, Real};
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::{float, mm};
use truepath_job::feature::FeatureSummary;
use truepath_job::feed::{FeedSummary, Unscheduled};
use truepath_job::job::Assumed;
use truepath_job::pass::{Pass, milling_name};
use truepath_program::Difference;

use crate::correction::{Correction, Identification};
use crate::damped::{DampedSummary, damped_summary};
use crate::floor::Floor;
use crate::guard::{GuardSummary, guard_summary};
use crate::sharp_corners::SharpCorners;
use crate::shop::{Belief, Said};
use crate::surface::expected::Surfaces;

/// An identified quantity.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Parameter {
    /// Its value.
    pub value: f64,
    /// One standard deviation.
    pub sigma: f64,
    /// What was believed before probing.
    pub prior: f64,
    /// One standard deviation of that belief.
    pub prior_sigma: f64,
    /// Unit of the four.
    pub unit: &'static str,
    /// Whether the points decide it: they have at least halved the uncertainty, or moved the value by more than two of them.
    pub observable: bool,
}

/// Summary of `correct`.
#[derive(Clone, Debug, serde::Serialize, schemars::JsonSchema)]
pub struct CorrectSummary {
    /// Version of this file.
    pub version: u32,
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    pub unit: Unit,
    /// How far the cutter runs out by what the points say, mm: radial offset of its axis. Absent where the job says it, and where they
    /// do not speak for any.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub runout_mm: Option<f64>,
    /// Largest predicted wall error without correction (of the target quantity), mm.
    pub max_error_before_mm: f64,
    /// Largest predicted wall error with it, mm.
    pub max_error_after_mm: f64,
    /// Where that is, mm along the contour.
    pub max_error_after_s_mm: f64,
    /// Standard deviation of the error there, mm.
    pub sigma_at_max_error_mm: f64,
    /// Largest standard deviation of the error after, mm: what the points leave open, and what parts differ in.
    pub max_sigma_mm: f64,
    /// The part of it that more points would lower, mm.
    pub max_sigma_by_points_mm: f64,
    /// What no XY correction can remove: the largest deviation from the target over the heights of the band, mm.
    pub axial_form_error_mm: f64,
    /// What the mean over the height is not brought below, one standard deviation, mm.
    pub floor_mm: f64,
    /// Its parts, and what is left over the height besides.
    pub floor: Floor,
    /// Largest error at any height of the wall without correction, the sign aside, mm: its profile error, as it is expected with what
    /// the points leave open.
    pub profile_error_before_mm: f64,
    /// The same with it, mm.
    pub profile_error_after_mm: f64,
    /// The whole wall at every height without and with it: how sure these are, and what makes them.
    pub surface: Surfaces,
    /// Deepest predicted gouge at any height of the engaged depth, mm (positive).
    pub worst_gouge_mm: f64,
    /// What is left beside and in sharp inside corners; absent where there are none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub sharp_corners: Option<SharpCorners>,
    /// What the gouge guard allowed of what the target wants; absent without `max_gouge_mm`.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub guard: Option<GuardSummary>,
    /// Where the points say too little for the whole correction; null where all of it is applied.
    pub damped: Option<DampedSummary>,
    /// Largest correction along an axis, mm.
    pub max_correction_mm: f64,
    /// The law of the correction.
    pub law: &'static str,
    /// The wall law: mean or helical.
    pub wall_law: &'static str,
    /// Climb or conventional.
    pub milling: &'static str,
    /// Identification quantities by name.
    pub identified: BTreeMap<&'static str, Parameter>,
    /// What the points say of what jobs have in common, whatever was believed before: for the shop store. Not under the mean law.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub points_say: Option<Said>,
    /// What was believed beforehand in place of what the job states, to begin there again; absent where nothing was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub believed: Option<Belief>,
    /// Contacts used.
    pub points_used: usize,
    /// Contacts the fit set aside.
    pub points_outlying: usize,
    /// Readings set aside before the fit.
    pub points_rejected: usize,
    /// Root mean square of the fit's residuals, mm.
    pub fit_residual_mm: f64,
    /// CRC-32 of the original program.
    pub program_crc32: String,
    /// The corrected program against its original, when one was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub program: Option<Difference>,
    /// The scheduled feeds; absent when the job does not ask for them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feed: Option<FeedSummary>,
    /// The feature it is about; absent in a program with one cut and no names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feature: Option<FeatureSummary>,
    /// The file of the corrected program that carries the name of the original; absent where none was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub corrected_program: Option<String>,
    /// What the job does not say and was taken from the program or a default.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub assumed: Vec<Assumed>,
    /// What the user should know.
    #[schemars(with = "Vec<String>")]
    pub warnings: Vec<Remark>,
    /// Each of several contours that were corrected together, of which the rest is the worst or the sum; absent for one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub contours: Vec<ContourSummary>,
}

/// One of several contours that were corrected together.
#[derive(Clone, Debug, serde::Serialize, schemars::JsonSchema)]
pub struct ContourSummary {
    /// Its name.
    pub contour: String,
    /// Whether it was corrected: one that no point touches stays as it is.
    pub corrected: bool,
    /// First and last line of the depth that was probed.
    pub lines: [u32; 2],
    /// Its figures, as those of a single contour; absent where it was not corrected.
    #[serde(flatten)]
    pub summary: Option<CorrectSummary>,
}

impl CorrectSummary {
    /// Of several contours that were corrected together: errors are those of the worst, counts are sums.
    pub fn of_every(contours: Vec<ContourSummary>, warnings: Vec<Remark>) -> Option<Self> {
        let all: Vec<&Self> = contours.iter().filter_map(|contour| contour.summary.as_ref()).collect();
        let worst = *all.iter().max_by(|a, b| a.max_error_after_mm.total_cmp(&b.max_error_after_mm))?;
        let largest = |of: fn(&Self) -> f64| all.iter().map(|one| of(one)).fold(0.0, f64::max);
        let floor = Floor::highest(all.iter().map(|one| one.floor));
        let sum = |of: fn(&Self) -> usize| all.iter().map(|one| of(one)).sum::<usize>();
        let used = sum(|s| s.points_used);
        let squares: f64 = all.iter().map(|s| s.fit_residual_mm.powi(2) * s.points_used as f64).sum();
        Some(Self {
            max_error_before_mm: largest(|s| s.max_error_before_mm),
            max_sigma_mm: largest(|s| s.max_sigma_mm),
            max_sigma_by_points_mm: largest(|s| s.max_sigma_by_points_mm),
            axial_form_error_mm: largest(|s| s.axial_form_error_mm),
            floor_mm: floor.mm(),
            floor,
            profile_error_before_mm: largest(|s| s.profile_error_before_mm),
            profile_error_after_mm: largest(|s| s.profile_error_after_mm),
            surface: Surfaces::worst(all.iter().map(|one| one.surface)),
            worst_gouge_mm: largest(|s| s.worst_gouge_mm),
            max_correction_mm: largest(|s| s.max_correction_mm),
            points_used: used,
            points_outlying: sum(|s| s.points_outlying),
            points_rejected: sum(|s| s.points_rejected),
            fit_residual_mm: (squares / used.max(1) as f64).sqrt(),
            guard: None,
            damped: None,
            feed: None,
            feature: None,
            warnings,
            contours: Vec::new(),
            ..worst.clone()
        })
        .map(|joint| Self { contours, ..joint })
    }

    /// The same for a machine that repeats as this floor says.
    #[must_use]
    pub fn with_floor(self, floor: Floor) -> Self {
        Self { floor_mm: floor.mm(), floor, ..self }
    }

    /// `difference.txt`, for a program of this name; empty when no program was written.
    pub fn difference(&self, original: &str) -> String {
        let program = self.program.as_ref().map(|difference| difference.text(original, self.unit));
        let feed = self.feed.as_ref().map(FeedSummary::text);
        program.map_or_else(String::new, |text| text + &feed.unwrap_or_default())
    }
}

/// The name of the corrected program beside `corrected.nc`: that of the original with its extension, `part.corrected.nc`.
pub fn corrected_name(program: &str) -> String {
    name_with(program, "corrected")
}

/// The file name of a program with a word before its extension: `part.planned.nc`.
pub fn name_with(program: &str, word: &str) -> String {
    let name = program.rsplit(['/', '\\']).next().unwrap_or(program);
    match name.rsplit_once('.') {
        Some((stem, extension)) if !stem.is_empty() => format!("{stem}.{word}.{extension}"),
        _ => format!("{name}.{word}"),
    }
}

fn largest(values: impl Iterator<Item = Offset>) -> f64 {
    mm(values.max().unwrap_or_default())
}

/// What is left with a correction at the feeds of the program.
pub fn unscheduled(correction: &Correction) -> Unscheduled {
    let target = correction.wanted.target;
    Unscheduled {
        max_error_after_mm: largest(correction.walls().map(|(_, p)| p.after.aim(target, None).abs())),
        max_sigma_mm: largest(correction.sigma.iter().copied()),
        axial_form_error_mm: largest(correction.walls().map(|(_, p)| p.after.form_error(target))),
        max_correction_mm: largest(correction.nodes.iter().map(|n| n.total().x.abs().max(n.total().y.abs()))),
    }
}

/// Makes the summary of `correct`, but for what was written.
pub fn correct_summary(
    pass: &Pass,
    identified: &Identification,
    path: &Path,
    correction: &Correction,
    surface: Surfaces,
    rejected: usize,
    warnings: Vec<Remark>,
) -> CorrectSummary {
    let target = correction.wanted.target;
    let observations = &identified.observations;
    let squares: f64 = observations.iter().map(|o| mm(o.error - o.predicted).powi(2)).sum();
    let Unscheduled { max_error_after_mm, max_sigma_mm, axial_form_error_mm, max_correction_mm } =
        unscheduled(correction);
    let errors = correction.walls().map(|(at, p)| (at, p.after.aim(target, None).abs()));
    let at = errors.max_by_key(|(_, error)| *error).map(|(at, _)| at);
    let sample = at.and_then(|at| path.samples().get(path.first() + at));
    let noise = pass.job.numbers.probe.map_or(0.0, |probe| mm(probe.noise));
    let before_mm = largest(correction.walls().map(|(_, p)| p.before.aim(target, None).abs()));
    let floor = Floor::of(pass.job.repeatability.map(mm), noise, observations, before_mm, axial_form_error_mm);
    let runout = pass.core.setup.runout.offset;
    CorrectSummary {
        version: 1,
        unit: pass.unit(),
        runout_mm: (runout != pass.core.job.tool.runout).then_some(mm(runout)),
        profile_error_before_mm: surface.before.profile.profile_mm,
        profile_error_after_mm: surface.after.profile.profile_mm,
        surface,
        max_error_before_mm: before_mm,
        max_error_after_mm,
        max_error_after_s_mm: sample.map_or(0.0, |sample| mm(sample.s)),
        sigma_at_max_error_mm: at.and_then(|at| correction.sigma.get(at)).map_or(0.0, |sigma| mm(*sigma)),
        max_sigma_mm,
        max_sigma_by_points_mm: largest(correction.sigma_by_points.iter().copied()),
        axial_form_error_mm,
        floor_mm: floor.mm(),
        floor,
        worst_gouge_mm: largest(correction.predicted.iter().map(|p| -p.after.deepest())).max(0.0),
        sharp_corners: None,
        guard: guard_summary(path, correction),
        damped: damped_summary(path, correction),
        max_correction_mm,
        law: law_name(&correction.wanted.law),
        wall_law: wall_law_name(identified.law()),
        milling: milling_name(pass.core.setup.milling),
        identified: parameters(identified),
        points_say: Said::of(&identified.core, &pass.core.stated_prior(WallLaw::Helical)),
        believed: pass.core.believed.as_ref().map(Belief::from),
        points_used: observations.len(),
        points_outlying: identified.outlying(),
        points_rejected: rejected,
        fit_residual_mm: (squares / observations.len().max(1) as f64).sqrt(),
        program_crc32: format!("{:08x}", pass.core.program_crc),
        program: None,
        feed: None,
        feature: None,
        corrected_program: None,
        assumed: pass.job.assumed.clone(),
        warnings,
        contours: Vec::new(),
    }
}

/// A value that lies farther than this many prior standard deviations from what was believed is what the points say.
const MOVED: f64 = 2.0;

/// What was identified, by name.
pub fn parameters(identified: &Identification) -> BTreeMap<&'static str, Parameter> {
    let (fitted, believed) = (&identified.fit().parameters, &identified.prior().mean);
    let (values, prior) = (fitted.values(), believed.values());
    let (sigma, prior_sigma) = (identified.prior().deviations(fitted), identified.prior().deviations(believed));
    let each = identify::Parameter::ALL.iter().enumerate().filter(|(i, _)| identified.prior().sigma[*i] != Real::ZERO);
    each.map(|(i, parameter)| {
        let remaining = float(identified.fit().remaining(i));
        let (value, prior, prior_sigma) = (float(values[i]), float(prior[i]), float(prior_sigma[i]));
        let value = Parameter {
            value,
            sigma: float(sigma[i]) * remaining,
            prior,
            prior_sigma,
            unit: parameter.unit(),
            observable: remaining <= 0.5 || (value - prior).abs() > MOVED * prior_sigma,
        };
        (parameter.name(), value)
    })
    .collect()
}

/// Name of a law of correction.
pub const fn law_name(law: &truepath_core::correct::Law) -> &'static str {
    match law {
        truepath_core::correct::Law::Model => "model",
        truepath_core::correct::Law::Mirror => "mirror",
        truepath_core::correct::Law::Paper(_) => "paper",
    }
}

/// Name of a wall law.
pub const fn wall_law_name(law: WallLaw) -> &'static str {
    match law {
        WallLaw::Mean => "mean",
        WallLaw::Helical => "helical",
    }
}
