//! Texture and roundness parameters of a bore's profile under their ISO names.
//!
//! | name | of | definition |
//! |---|---|---|
//! | Pt | the whole profile | total height over the closed circle, from the exact envelope, about the centre of the path (ISO 21920-2; form: the nominal circle). This is the "waviness height" of Urinov 2020 |
//! | Wt | the long-wave part below λc | total height over the closed circle without the least-squares circle (ISO 21920-2, before: ISO 4287) |
//! | Ra, Rq, Rt | the short-wave part above λc | mean, root mean square, total height over the closed circle |
//! | Rz | the same | mean of the height of whole sections of length λc round the circle (ISO 21920-2; an instrument takes five) |
//! | RONt, RONp, RONv, RONq | the part below the cut-off in undulations per revolution | peak to valley, peak, valley, root mean square against the least-squares circle (ISO 12181-1, LSCI); RONt also against MZCI, MICI, MCCI |
//!
//! λc is by default 0.8 mm and the roundness cut-off 50 undulations per revolution, both common defaults of instruments.
//! Which name the marks of the teeth fall under is decided by their distance, not by their cause: see [`Marks`].

use std::f64::consts::TAU;

use super::circle::{Reference, residuals, span};
use super::envelope::{Profile, cutting_teeth};
use super::filter::{Closed, passed};
use super::passes::around;
use super::refusal::Refusal;

/// Cut-offs.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cutoffs {
    /// λc between waviness and roughness, mm.
    pub lambda_c_mm: f64,
    /// Of roundness, undulations per revolution.
    pub upr: f64,
}

impl Default for Cutoffs {
    fn default() -> Self {
        Self { lambda_c_mm: 0.8, upr: 50.0 }
    }
}

/// Where the marks of the teeth fall.
#[derive(Clone, Copy, Debug, serde::Serialize)]
pub struct Marks {
    /// Marks per revolution: whole only where the speeds are in a whole ratio.
    pub per_revolution: f64,
    /// Their mean distance on the wall, mm.
    pub spacing_mm: f64,
    /// Distance of the marks of one tooth, mm.
    pub tooth_spacing_mm: f64,
    /// Share of a wave of the spacing that the filter λc leaves in the waviness profile; the rest is roughness.
    pub share_in_waviness: f64,
    /// The name they fall under by that share: `waviness` above 0.9, `roughness` below 0.1, else `both`.
    pub fall_under: &'static str,
    /// Share that the roundness filter leaves.
    pub share_in_roundness: f64,
}

/// The parameters; lengths in mm.
#[derive(Clone, Copy, Debug, serde::Serialize)]
#[expect(missing_docs, reason = "the names are the standards' and are defined in the table above")]
pub struct Texture {
    #[serde(rename = "Pt_mm")]
    pub pt: f64,
    #[serde(rename = "Wt_mm")]
    pub wt: f64,
    #[serde(rename = "Rz_mm")]
    pub rz: f64,
    #[serde(rename = "Rt_mm")]
    pub rt: f64,
    #[serde(rename = "Ra_mm")]
    pub ra: f64,
    #[serde(rename = "Rq_mm")]
    pub rq: f64,
    pub lambda_c_mm: f64,
    pub lambda_c_upr: f64,
    /// Whole sections of length λc round the circle.
    pub sections: usize,
    #[serde(rename = "RONt_mm")]
    pub ront: f64,
    #[serde(rename = "RONp_mm")]
    pub ronp: f64,
    #[serde(rename = "RONv_mm")]
    pub ronv: f64,
    #[serde(rename = "RONq_mm")]
    pub ronq: f64,
    #[serde(rename = "RONt_MZCI_mm")]
    pub ront_mzci: f64,
    #[serde(rename = "RONt_MICI_mm")]
    pub ront_mici: f64,
    #[serde(rename = "RONt_MCCI_mm")]
    pub ront_mcci: f64,
    pub roundness_upr: f64,
    /// Samples of the closed profile behind the filtered parameters.
    pub samples: usize,
    pub marks: Marks,
}

/// Evaluates a profile.
///
/// # Errors
/// [`Refusal::Range`] for cut-offs that are out of range: λc from 0.001 mm to the circumference, 1 to 100 000 undulations.
pub fn texture(profile: &Profile, cutoffs: &Cutoffs) -> Result<Texture, Refusal> {
    // Before the profile is sampled as finely as they ask for.
    check(cutoffs, TAU * profile.passes.highest())?;
    let finest = cutoffs.upr.max(TAU * profile.passes.highest() / cutoffs.lambda_c_mm);
    evaluate(profile, &Closed::of(profile, finest), cutoffs)
}

fn check(cutoffs: &Cutoffs, circumference: f64) -> Result<(), Refusal> {
    Refusal::unless_in("cut-off λc", "mm", cutoffs.lambda_c_mm, 1e-3, circumference)?;
    Refusal::unless_in("roundness cut-off", "undulations per revolution", cutoffs.upr, 1.0, 1e5)
}

/// The same with the samples given.
///
/// # Errors
/// As [`texture`].
pub fn evaluate(profile: &Profile, closed: &Closed, cutoffs: &Cutoffs) -> Result<Texture, Refusal> {
    let circumference = closed.circumference();
    check(cutoffs, circumference)?;
    let lambda_c_upr = closed.undulations(cutoffs.lambda_c_mm);
    let long = closed.below(lambda_c_upr);
    let short: Vec<f64> = closed.deviations.iter().zip(&long).map(|(d, w)| d - w).collect();
    let waviness = residuals(&long, Reference::LeastSquares);
    let extremes = with_extremes(profile, closed, &short, &long);
    let (rz, sections) = mean_height_of_sections(&extremes, (circumference / cutoffs.lambda_c_mm) as usize);
    let rt = span(&extremes.iter().map(|e| e.1).collect::<Vec<_>>());
    let round = closed.below(cutoffs.upr);
    let against = |reference| span(&residuals(&round, reference));
    let squares = residuals(&round, Reference::LeastSquares);
    let undulations = marks_per_revolution(profile);
    let share = passed(undulations, lambda_c_upr);
    let tooth_spacing_mm = profile.passes.motion.spacing() * closed.mean_mm;
    Ok(Texture {
        pt: profile.height(),
        wt: span(&waviness),
        rz,
        rt,
        ra: short.iter().map(|v| v.abs()).sum::<f64>() / short.len().max(1) as f64,
        rq: root_mean_square(&short),
        lambda_c_mm: cutoffs.lambda_c_mm,
        lambda_c_upr,
        sections,
        ront: span(&squares),
        ronp: squares.iter().copied().fold(0.0, f64::max),
        ronv: -squares.iter().copied().fold(0.0, f64::min),
        ronq: root_mean_square(&squares),
        ront_mzci: against(Reference::MinimumZone),
        ront_mici: against(Reference::MaximumInscribed),
        ront_mcci: against(Reference::MinimumCircumscribed),
        roundness_upr: cutoffs.upr,
        samples: closed.deviations.len(),
        marks: Marks {
            per_revolution: undulations,
            spacing_mm: circumference / undulations,
            tooth_spacing_mm,
            share_in_waviness: share,
            fall_under: if share > 0.9 {
                "waviness"
            } else if share < 0.1 {
                "roughness"
            } else {
                "both"
            },
            share_in_roundness: passed(undulations, cutoffs.upr),
        },
    })
}

/// From the speeds while there is one lap, as the marks where it overlaps itself lie closer; counted where there are more.
fn marks_per_revolution(profile: &Profile) -> f64 {
    if profile.passes.laps >= 2.0 {
        let mean = TAU / profile.stretches.len() as f64;
        return profile.stretches.iter().filter(|s| s.to - s.from > 1e-3 * mean).count() as f64;
    }
    cutting_teeth(&profile.passes, &profile.stretches) as f64 * TAU / profile.passes.motion.spacing()
}

fn root_mean_square(values: &[f64]) -> f64 {
    (values.iter().map(|v| v * v).sum::<f64>() / values.len().max(1) as f64).sqrt()
}

/// The short-wave part as (share of the turn, mm): its samples and, between them, the places where the profile itself has its
/// crests and valleys, so that no peak is lost between samples. The long-wave part is smooth there.
fn with_extremes(profile: &Profile, closed: &Closed, short: &[f64], long: &[f64]) -> Vec<(f64, f64)> {
    let count = short.len();
    let mut all: Vec<(f64, f64)> = short.iter().enumerate().map(|(n, v)| (n as f64 / count as f64, *v)).collect();
    let smooth = |share: f64| {
        let place = share * count as f64;
        let (n, part) = (place as usize % count, place.fract());
        long[n] + (long[(n + 1) % count] - long[n]) * part
    };
    let valleys = profile.stretches.iter().filter(|s| s.from < s.crest && s.crest < s.to);
    let valleys = valleys.map(|s| around(s.crest)).map(|phi| (phi, profile.at(phi).0));
    for (phi, radius) in profile.cusps().chain(valleys) {
        all.push((phi / TAU, radius - closed.mean_mm - smooth(phi / TAU)));
    }
    all.sort_by(|a, b| a.0.total_cmp(&b.0));
    all
}

/// Mean of the heights of equal sections of the turn, and how many there are.
fn mean_height_of_sections(values: &[(f64, f64)], sections: usize) -> (f64, usize) {
    // A section of fewer than eight samples would not show its extremes.
    let sections = sections.clamp(1, (values.len() / 8).max(1));
    let mut heights = vec![(f64::MAX, f64::MIN); sections];
    for (share, value) in values {
        let height = &mut heights[((share * sections as f64) as usize).min(sections - 1)];
        *height = (height.0.min(*value), height.1.max(*value));
    }
    let sum: f64 = heights.iter().filter(|h| h.1 >= h.0).map(|h| h.1 - h.0).sum();
    (sum / sections as f64, sections)
}
