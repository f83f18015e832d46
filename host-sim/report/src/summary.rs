//! `summary.json` of `simulate`.

use truepath_correction::remarks::said_of_every;
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::mm;
use truepath_job::feature::FeatureSummary;
use truepath_job::job::Assumed;
use truepath_job::pass::{Pass, milling_name};
use truepath_plant::{LapFacts, Score, SurfaceScore};
use truepath_trial::recorded;

use super::tables::TraceRow;

/// Summary of `simulate`.
#[derive(Clone, Debug, serde::Serialize)]
pub struct SimulateSummary {
    /// Version of this file.
    pub version: u32,
    /// The unit of the program, in which people are told.
    #[serde(skip)]
    pub unit: Unit,
    /// Who cut: `core` or `plant`.
    pub by: &'static str,
    /// Length of the contour, mm.
    pub length_mm: f64,
    /// Largest magnitude of the wall error, mean over height, mm.
    pub max_error_mm: f64,
    /// Its root mean square, mm.
    pub rms_error_mm: f64,
    /// Largest engagement angle, degrees.
    pub max_arc_deg: f64,
    /// Largest mean force, N.
    pub max_force_n: f64,
    /// Largest chip area per tooth (P23's analogue of the removal rate), mm².
    pub max_chip_area_mm2: f64,
    /// Largest volume per tooth, chip area × cutter radius, mm³.
    pub max_chip_volume_mm3: f64,
    /// Climb or conventional.
    pub milling: &'static str,
    /// The wall away from its ends, where the cutter plunges and lifts; by the plant only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub judged: Option<Score>,
    /// The same wall at every height; by the plant only.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub surface: Option<SurfaceScore>,
    /// The laps along the wall that were cut in order, where a whole program was.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub laps: Vec<LapFacts>,
    /// The recorded pass that was cut along, if one was.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub recorded: Option<recorded::Facts>,
    /// The feature it is about; absent in a program with one cut and no names.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub feature: Option<FeatureSummary>,
    /// Its name, where it is one of several contours.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub contour: Option<String>,
    /// What the job does not say and was taken from the program or a default.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub assumed: Vec<Assumed>,
    /// What the user should know.
    pub warnings: Vec<Remark>,
    /// Each of several contours, of which the rest is the worst or the sum; absent for one.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub contours: Vec<SimulateSummary>,
}

impl SimulateSummary {
    /// Of the contours of a program: largest values are those of the worst, the length is the sum. `None` without any.
    pub fn of_every(contours: Vec<Self>) -> Option<Self> {
        if contours.len() < 2 {
            return contours.into_iter().next();
        }
        let first = contours.first()?.clone();
        let most = |of: fn(&Self) -> f64| contours.iter().map(of).fold(0.0, f64::max);
        let length_mm: f64 = contours.iter().map(|one| one.length_mm).sum();
        let squares: f64 = contours.iter().map(|one| one.rms_error_mm.powi(2) * one.length_mm).sum();
        let said = contours.iter().map(|one| (one.contour.as_deref().unwrap_or_default(), &one.warnings[..]));
        let warnings = said_of_every(said);
        Some(Self {
            length_mm,
            max_error_mm: most(|one| one.max_error_mm),
            rms_error_mm: (squares / length_mm).sqrt(),
            max_arc_deg: most(|one| one.max_arc_deg),
            max_force_n: most(|one| one.max_force_n),
            max_chip_area_mm2: most(|one| one.max_chip_area_mm2),
            max_chip_volume_mm3: most(|one| one.max_chip_volume_mm3),
            judged: None,
            surface: None,
            laps: Vec::new(),
            recorded: None,
            feature: None,
            contour: None,
            warnings,
            contours,
            ..first
        })
    }
}

/// Makes the summary of `simulate`.
pub fn simulate_summary(pass: &Pass, by: &'static str, trace: &[TraceRow], warnings: Vec<Remark>) -> SimulateSummary {
    let most = |f: fn(&TraceRow) -> f64| trace.iter().map(f).filter(|v| v.is_finite()).fold(0.0, f64::max);
    let finite: Vec<f64> = trace.iter().map(|r| r.error_mm).filter(|e| e.is_finite()).collect();
    SimulateSummary {
        version: 1,
        unit: pass.unit(),
        by,
        length_mm: mm(pass.core.contour.length),
        max_error_mm: most(|r| r.error_mm.abs()),
        rms_error_mm: (finite.iter().map(|e| e * e).sum::<f64>() / finite.len().max(1) as f64).sqrt(),
        max_arc_deg: most(|r| r.arc_deg),
        max_force_n: most(|r| r.force_n),
        max_chip_area_mm2: most(|r| r.chip_area_mm2),
        max_chip_volume_mm3: most(|r| r.chip_area_mm2) * mm(pass.core.setup.radius),
        milling: milling_name(pass.core.setup.milling),
        judged: None,
        surface: None,
        laps: Vec::new(),
        recorded: None,
        feature: pass.feature(&[]),
        contour: None,
        assumed: pass.job.assumed.clone(),
        warnings,
        contours: Vec::new(),
    }
}
