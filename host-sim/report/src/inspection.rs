//! Summary of `inspect`: which part, how far its wall is off, and the verdict.

use truepath_core::checksum::crc32;
use truepath_core::probe::Contact;
use truepath_correction::inspection::{Count, Coverage, Judgement, Verdict};
use truepath_correction::surface::touched::TouchedSurface;
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::mm;
use truepath_job::feature::FeatureSummary;
use truepath_job::job::Assumed;
use truepath_job::job::{PartNames, Tolerance};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

/// Summary of `inspect`: the accuracy of the wall from measurements alone.
#[derive(Clone, Debug, serde::Serialize)]
pub struct InspectSummary {
    /// Version of this file.
    pub version: u32,
    /// The part, as job and command line name it.
    pub part: PartNames,
    /// CRC-32 of the program.
    pub program_crc32: String,
    /// CRC-32 of the job.
    pub job_crc32: String,
    /// CRC-32 of the probe file.
    pub probe_crc32: String,
    /// Contacts on the wall.
    pub points: usize,
    /// Readings set aside.
    pub points_rejected: usize,
    /// Mean wall error, mm: what a wear offset could remove.
    pub mean_error_mm: f64,
    /// Largest (most material left), mm.
    pub max_error_mm: f64,
    /// Smallest (deepest), mm.
    pub min_error_mm: f64,
    /// Root mean square, mm.
    pub rms_error_mm: f64,
    /// Largest spread over the heights of one place, mm.
    pub spread_over_height_mm: f64,
    /// The largest deviation at any touched height with its standard deviation, beside the largest mean over the touched heights of a
    /// place; all of it measured, nothing predicted.
    pub surface: TouchedSurface,
    /// Limits of the wall error; null where none are given.
    pub tolerance: Option<ToleranceSummary>,
    /// Expanded uncertainty (k = 2) of a deviation, mm; null where none is given.
    pub uncertainty_mm: Option<f64>,
    /// The verdict on the part.
    pub verdict: Verdict,
    /// Points by verdict; null without a tolerance.
    pub points_by_verdict: Option<Count>,
    /// Decision rule and what the verdict does not cover, in sentences.
    pub statements: Vec<String>,
    /// Stretches of the contour that no point speaks for; each of several contours has its own.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub coverage: Option<Coverage>,
    /// Its name, where it is one of several contours.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<String>,
    /// The feature it is about; absent in a program with one cut and no names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feature: Option<FeatureSummary>,
    /// What the job does not say and was taken from the program or a default.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub assumed: Vec<Assumed>,
    /// What the user should know.
    pub warnings: Vec<Remark>,
    /// Each of several contours that was touched, of all of which the rest is said; absent for one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub contours: Vec<InspectSummary>,
}

impl InspectSummary {
    /// Of several contours of a part and the judgement on all their points. `None` without any.
    pub fn of_every(contours: Vec<Self>, judgement: &Judgement, warnings: Vec<Remark>) -> Option<Self> {
        let first = contours.first()?.clone();
        let points: usize = contours.iter().map(|one| one.points).sum();
        let mean = |of: fn(&Self) -> f64| {
            contours.iter().map(|one| of(one) * one.points as f64).sum::<f64>() / points.max(1) as f64
        };
        let most = |of: fn(&Self) -> f64| contours.iter().map(of).fold(f64::MIN, f64::max);
        Some(Self {
            points,
            points_rejected: contours.iter().map(|one| one.points_rejected).sum(),
            mean_error_mm: mean(|one| one.mean_error_mm),
            max_error_mm: most(|one| one.max_error_mm),
            min_error_mm: -most(|one| -one.min_error_mm),
            rms_error_mm: mean(|one| one.rms_error_mm.powi(2)).sqrt(),
            spread_over_height_mm: most(|one| one.spread_over_height_mm),
            surface: TouchedSurface::worst(contours.iter().map(|one| one.surface))?,
            verdict: judgement.verdict.clone(),
            points_by_verdict: judgement.count,
            statements: judgement.statements.clone(),
            coverage: None,
            contour: None,
            feature: None,
            warnings,
            contours,
            ..first
        })
    }
}

/// Limits of the wall error.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct ToleranceSummary {
    /// The deepest cut, mm.
    pub lower_mm: f64,
    /// The most material left, mm.
    pub upper_mm: f64,
    /// `job` or `command line`.
    pub from: &'static str,
}

impl From<Tolerance> for ToleranceSummary {
    fn from(tolerance: Tolerance) -> Self {
        let from = if tolerance.from_command_line { "command line" } else { "job" };
        Self { lower_mm: mm(tolerance.lower), upper_mm: mm(tolerance.upper), from }
    }
}

/// Makes the summary of `inspect`.
pub fn inspect_summary(
    pass: &Pass,
    measurement: &Measurement,
    judgement: &Judgement,
    coverage: Coverage,
    warnings: Vec<Remark>,
) -> InspectSummary {
    let contacts = &measurement.contacts;
    let part = &pass.job.part;
    let errors: Vec<f64> = contacts.iter().map(|c| mm(c.error)).collect();
    let n = errors.len().max(1) as f64;
    let surface = TouchedSurface::of_measurement(pass, measurement);
    let feature = pass.feature(&[]);
    InspectSummary {
        version: 1,
        part: part.names.clone(),
        program_crc32: format!("{:08x}", pass.core.program_crc),
        job_crc32: format!("{:08x}", crc32(pass.job.source().bytes())),
        probe_crc32: format!("{:08x}", measurement.crc),
        points: contacts.len(),
        points_rejected: measurement.rejected.len(),
        mean_error_mm: errors.iter().sum::<f64>() / n,
        max_error_mm: errors.iter().copied().fold(f64::MIN, f64::max),
        min_error_mm: errors.iter().copied().fold(f64::MAX, f64::min),
        rms_error_mm: (errors.iter().map(|e| e * e).sum::<f64>() / n).sqrt(),
        spread_over_height_mm: spread_over_height(contacts),
        surface,
        tolerance: part.tolerance.map(ToleranceSummary::from),
        uncertainty_mm: part.uncertainty.map(mm),
        verdict: judgement.verdict.clone(),
        points_by_verdict: judgement.count,
        statements: statements(judgement, &surface, feature.as_ref(), Unit::Millimetre),
        coverage: Some(coverage),
        contour: None,
        feature,
        assumed: pass.job.assumed.clone(),
        warnings,
        contours: Vec::new(),
    }
}

/// What the verdict on a wall rests on and what it does not cover, in a unit.
pub fn statements(
    judgement: &Judgement,
    surface: &TouchedSurface,
    feature: Option<&FeatureSummary>,
    unit: Unit,
) -> Vec<String> {
    let beyond = feature.and_then(|feature| feature.not_judged(unit));
    judgement.statements.iter().cloned().chain([between_touches(surface)]).chain(beyond).collect()
}

/// What the measurement leaves open of the whole wall.
fn between_touches(surface: &TouchedSurface) -> String {
    let heights = match surface.heights {
        1 => "at one height of a place, so that nothing is known of its error over the height".to_owned(),
        most => format!("at up to {most} heights of a place"),
    };
    format!(
        "The wall was touched {heights}. Between the touches nothing is measured, and no model says anything here: what is to be expected of the whole wall, at every height, truepath correct and truepath learn predict."
    )
}

/// Largest spread over the heights of one place, mm.
fn spread_over_height(contacts: &[Contact]) -> f64 {
    let spread = contacts.chunk_by(|a, b| truepath_core::job::same_place(a.s, b.s)).map(|group| {
        let low = group.iter().map(|c| c.error).min().unwrap_or_default();
        group.iter().map(|c| c.error).max().unwrap_or_default() - low
    });
    mm(spread.max().unwrap_or_default())
}
