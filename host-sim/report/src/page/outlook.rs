//! How the wall stands and what it will come to, in figures: what the sentence on top of a page is made of.

use serde::Serialize;
use truepath_correction::surface::expected::Surface;

use super::known;

/// A wall in two figures, mm; what is not known is left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct WallFigures {
    /// The largest mean over the height, the sign aside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_mm: Option<f64>,
    /// Its standard deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub mean_sigma_mm: Option<f64>,
    /// The largest error at any height, the sign aside.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst_mm: Option<f64>,
    /// Its standard deviation.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst_sigma_mm: Option<f64>,
}

impl WallFigures {
    /// Of both errors without their standard deviations.
    pub fn of(mean_mm: f64, worst_mm: f64) -> Self {
        Self { mean_mm: known(mean_mm), worst_mm: known(worst_mm), ..Self::default() }
    }
}

impl From<&Surface> for WallFigures {
    fn from(surface: &Surface) -> Self {
        Self {
            mean_sigma_mm: known(surface.mean_sigma_mm),
            worst_sigma_mm: known(surface.profile.sigma_mm),
            ..Self::of(surface.mean_mm, surface.profile.profile_mm)
        }
    }
}

/// The wall now and next.
#[derive(Clone, Debug, Default, PartialEq, Serialize)]
pub struct Outlook {
    /// Without the correction, of the measured part, or of the only pass.
    pub now: WallFigures,
    /// With the correction.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next: Option<WallFigures>,
    /// What machine and probe repeat to, below which no correction brings the mean: one standard deviation, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub floor_mm: Option<f64>,
    /// Whether both were cut; otherwise they are predicted.
    #[serde(skip_serializing_if = "std::ops::Not::not")]
    pub cut: bool,
}
