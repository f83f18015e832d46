//! The figures of a correction: `summary.json` of `correct` and `learn`.

use std::collections::BTreeMap;

use truepath_core::cut::{Path, WallLaw};
use truepath_core::identify;
use truepath_core::units::{Offset, Real};
use truepath_ground::units::{float, mm};
use truepath_job::feature::FeatureSummary;
use truepath_job::feed::FeedSummary;
use truepath_job::measurement::Measurement;
use truepath_job::pass::{Pass, milling_name};
use truepath_program::Difference;

use crate::correction::{Correction, Identification};
use crate::damped::{DampedSummary, damped_summary};
use crate::guard::{GuardSummary, guard_summary};

/// What a measurement leaves to be said.
#[derive(Clone, Copy, Debug)]
pub struct Remarks<'a> {
    /// Readings set aside.
    pub set_aside: usize,
    /// Sentences for the summary.
    pub texts: &'a [String],
    /// CRC-32 of the probe file.
    pub probe: u32,
    /// Whether it is of the pass that is corrected, and not of one before it.
    pub of_this_pass: bool,
}

impl<'a> Remarks<'a> {
    /// Of a measurement, with sentences about it.
    pub const fn of(measurement: &Measurement, texts: &'a [String]) -> Self {
        Self { set_aside: measurement.rejected.len(), texts, probe: measurement.crc, of_this_pass: true }
    }
}

/// An identified quantity.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
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
    /// Whether the points decide it: they have at least halved the uncertainty.
    pub observable: bool,
}

/// Summary of `correct`.
#[derive(Clone, Debug, serde::Serialize)]
pub struct CorrectSummary {
    /// Version of this file.
    pub version: u32,
    /// Largest predicted wall error without correction (of the target quantity), mm.
    pub max_error_before_mm: f64,
    /// Largest predicted wall error with it, mm.
    pub max_error_after_mm: f64,
    /// Where that is, mm along the contour.
    pub max_error_after_s_mm: f64,
    /// Standard deviation of the error there, mm.
    pub sigma_at_max_error_mm: f64,
    /// Largest standard deviation of the error after, mm: what the points leave open.
    pub max_sigma_mm: f64,
    /// What no XY correction can remove: the largest deviation from the target over the heights of the band, mm.
    pub axial_form_error_mm: f64,
    /// Deepest predicted gouge at any height of the engaged depth, mm (positive).
    pub worst_gouge_mm: f64,
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
    /// Identified quantities by name.
    pub identified: BTreeMap<&'static str, Parameter>,
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
    /// What the user should know.
    pub warnings: Vec<String>,
}

impl CorrectSummary {
    /// `difference.txt`, for a program of this name; empty when no program was written.
    pub fn difference(&self, original: &str) -> String {
        let program = self.program.as_ref().map(|difference| difference.text(original));
        let feed = self.feed.as_ref().map(FeedSummary::text);
        program.map_or_else(String::new, |text| text + &feed.unwrap_or_default())
    }
}

fn largest(values: impl Iterator<Item = Offset>) -> f64 {
    mm(values.max().unwrap_or_default())
}

/// Makes the summary of `correct`.
pub fn correct_summary(
    pass: &Pass,
    identified: &Identification,
    correction: &Correction,
    rejected: usize,
    warnings: Vec<String>,
) -> CorrectSummary {
    let target = correction.wanted.target;
    let predicted = &correction.predicted;
    let observations = &identified.observations;
    let squares: f64 = observations.iter().map(|o| mm(o.error - o.predicted).powi(2)).sum();
    CorrectSummary {
        version: 1,
        max_error_before_mm: largest(predicted.iter().map(|p| p.before.aim(target, None).abs())),
        max_error_after_mm: largest(predicted.iter().map(|p| p.after.aim(target, None).abs())),
        max_error_after_s_mm: 0.0,
        sigma_at_max_error_mm: 0.0,
        max_sigma_mm: largest(correction.sigma.iter().copied()),
        axial_form_error_mm: largest(predicted.iter().map(|p| p.after.form_error(target))),
        worst_gouge_mm: largest(predicted.iter().map(|p| -p.after.deepest())).max(0.0),
        guard: None,
        damped: None,
        max_correction_mm: largest(correction.nodes.iter().map(|n| n.total().x.abs().max(n.total().y.abs()))),
        law: law_name(&correction.wanted.law),
        wall_law: wall_law_name(identified.law()),
        milling: milling_name(pass.core.setup.milling),
        identified: parameters(identified),
        points_used: observations.len(),
        points_outlying: identified.fit().outliers,
        points_rejected: rejected,
        fit_residual_mm: (squares / observations.len().max(1) as f64).sqrt(),
        program_crc32: format!("{:08x}", pass.core.program_crc),
        feature: pass.feature(&[]),
        program: None,
        feed: None,
        warnings,
    }
}

impl CorrectSummary {
    /// Adds what depends on where along the contour a wall lies.
    pub fn place(&mut self, path: &Path, correction: &Correction) {
        let errors = correction.predicted.iter().map(|p| p.after.aim(correction.wanted.target, None).abs());
        if let Some((at, _)) = errors.enumerate().max_by_key(|(_, error)| *error) {
            self.max_error_after_s_mm = path.samples().get(path.first() + at).map_or(0.0, |sample| mm(sample.s));
            self.sigma_at_max_error_mm = correction.sigma.get(at).map_or(0.0, |sigma| mm(*sigma));
        }
        self.guard = guard_summary(path, correction);
        self.damped = damped_summary(path, correction);
    }
}

fn parameters(identified: &Identification) -> BTreeMap<&'static str, Parameter> {
    let (fitted, believed) = (&identified.fit().parameters, &identified.prior().mean);
    let (values, prior) = (fitted.values(), believed.values());
    let (sigma, prior_sigma) = (identified.prior().deviations(fitted), identified.prior().deviations(believed));
    let each = identify::Parameter::ALL.iter().enumerate().filter(|(i, _)| identified.prior().sigma[*i] != Real::ZERO);
    each.map(|(i, parameter)| {
        let remaining = float(identified.fit().remaining(i));
        let value = Parameter {
            value: float(values[i]),
            sigma: float(sigma[i]) * remaining,
            prior: float(prior[i]),
            prior_sigma: float(prior_sigma[i]),
            unit: parameter.unit(),
            observable: remaining <= 0.5,
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
