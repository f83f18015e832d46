//! The verdict on a measured part: how it came out, whether that was foreseen, what was made of it.

use truepath_core::correct::Node;
use truepath_core::cut::Path;
use truepath_core::units::Offset;
use truepath_ground::hypotenuse::hypot;
use truepath_ground::length::{Remark, Unit};
use truepath_ground::units::{mm, rounded};

use super::cutter::Level;
use super::holdout::Residuals;
use super::joint::{Beside, PartPoints};
use super::monitor::{Monitor, PartError};
use crate::discrepancy::Sizes;

/// A change of the level of force from part to part that a machinist wants to know of, as a share.
const TELLING: f64 = 0.04;

/// How a part came out.
#[derive(Clone, Debug, serde::Serialize, schemars::JsonSchema)]
pub struct Verdict {
    /// Its number; the correction is that of the next one.
    pub part: u32,
    /// Error of the target quantity at its places.
    pub measured_error_mm: PartError,
    /// The part before at the same places: measured there, or by the model of all parts.
    pub previous_error_mm: PartError,
    /// The earlier parts, each at its own places.
    pub earlier_parts: Vec<PartError>,
    /// Share by which it was cut with more force than the part before, as the points of both have it.
    pub force_change: f64,
    /// What the next part is expected to need over this one, where it is said to be cut with a new cutter; else absent.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub new_cutter: Option<NewCutter>,
    /// What was promised for it.
    pub promise: Promise,
    /// Places that a first fit has not seen; absent when fewer than four were touched.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub holdout_residual_mm: Option<Residuals>,
    /// What was learned beside the model; absent when the points fit the model within their noise.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub residual: Option<UnmodelledError>,
    /// Whether the next part goes back to what an earlier one was cut with.
    pub rolled_back: bool,
    /// What is used again instead of a new correction; absent when the correction is a new one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub used_again: Option<UsedAgain>,
    /// Why, and other remarks on the part.
    #[serde(skip)]
    remarks: Vec<Remark>,
}

/// The force that a new cutter needs over that of the newest part that counts.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct NewCutter {
    /// Share by which it is more.
    pub force_change: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

impl NewCutter {
    pub(super) fn of(level: Level) -> Self {
        Self { force_change: rounded(level.mean.exp_m1(), 9), sigma: rounded(level.sigma, 9) }
    }
}

/// What a part was cut with and the next one is cut with again.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
pub struct UsedAgain {
    /// Number of the part.
    pub part: u32,
    /// Whether that was a correction: the first part is cut with none.
    pub corrected: bool,
}

/// A prediction held against the measurement.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Promise {
    /// Largest predicted magnitude at the places, mm.
    pub max_mm: f64,
    /// Largest standard deviation there, with that of the measurement, mm.
    pub max_sigma_mm: f64,
    /// Places at which measured − predicted is within two standard deviations.
    pub within_two_sigma: usize,
    /// Places in all.
    pub places: usize,
}

/// The wall error that parts have shown beside the model.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct UnmodelledError {
    /// Largest magnitude along the contour, mm.
    pub max_mm: f64,
    /// Standard deviations of its kinds.
    #[serde(flatten)]
    pub sizes: Sizes,
}

impl UnmodelledError {
    /// `None` where nothing is worth a correction.
    pub(super) fn of(beside: &Beside) -> Option<Self> {
        let largest = beside.along.mean.iter().map(|r| r.abs()).max()?;
        Some(Self { max_mm: mm(largest), sizes: beside.discrepancy.sizes() })
    }
}

impl UsedAgain {
    fn of(part: &PartPoints) -> Self {
        Self { part: part.number, corrected: part.nodes.iter().any(|node| *node != Node::default()) }
    }

    /// What the next part is cut with.
    pub fn words(&self) -> String {
        if self.corrected {
            format!("the correction that part {} was cut with is used again", self.part)
        } else {
            format!("the next part is cut without correction, as part {} was: along the path of the program", self.part)
        }
    }
}

impl Promise {
    /// `promised` has the predicted error and its standard deviation beside every sample of the contour.
    pub fn of(path: &Path, monitor: &Monitor, promised: &[(Offset, Offset)]) -> Self {
        let mut promise = Self { places: monitor.places.len(), ..Self::default() };
        for place in &monitor.places {
            let at = path.index_at(place.s).saturating_sub(path.first());
            let Some((predicted, sigma)) = promised.get(at) else { continue };
            let sigma = hypot(mm(*sigma), mm(place.noise));
            promise.max_mm = promise.max_mm.max(mm(predicted.abs()));
            promise.max_sigma_mm = promise.max_sigma_mm.max(sigma);
            promise.within_two_sigma += usize::from((mm(place.error) - mm(*predicted)).abs() <= 2.0 * sigma);
        }
        promise
    }
}

impl Verdict {
    pub(super) fn of(
        parts: &[PartPoints],
        monitor: &Monitor,
        promise: Promise,
        holdout: Option<Residuals>,
        again: Option<usize>,
        (fits, unit): (bool, Unit),
    ) -> Self {
        let (now, before) = (monitor.now, monitor.before);
        let worse = |unit: Unit| {
            let [now_rms, before_rms] = [now.rms_mm, before.rms_mm].map(|rms| unit.of(rms));
            format!("({now_rms:.4} {name} after {before_rms:.4} {name}, rms at its places)", name = unit.name())
        };
        let mut remarks = Vec::new();
        let rolled_back = again.is_some_and(|again| again + 1 < parts.len());
        let used_again = again.and_then(|again| parts.get(again)).map(UsedAgain::of);
        if let Some(used) = used_again {
            remarks.push(unit.remark(|unit| {
                let why = if fits {
                    format!(
                        "it came out worse {} and the updated model does not foretell the places it was not shown",
                        worse(unit)
                    )
                } else {
                    "most points contradict those of the parts before".to_owned()
                };
                format!(
                    "part {} is set aside and {}: {why}; look at clamping, datum, cutter and probe before the next part",
                    now.part,
                    used.words()
                )
            }));
        } else if monitor.is_worse() {
            remarks.push(unit.remark(|unit| {
                format!(
                    "part {} came out worse than part {} {}, and the updated model foretells the places it was not shown: the next correction is a new one",
                    now.part,
                    before.part,
                    worse(unit)
                )
            }));
        }
        if promise.within_two_sigma * 4 < promise.places * 3 {
            let said = format!(
                "only {} of {} places of part {} came out within two standard deviations of what was promised",
                promise.within_two_sigma, promise.places, now.part
            );
            remarks.push(said.into());
        }
        let earlier_parts = monitor.parts.split_last().map(|(_, earlier)| earlier.to_vec()).unwrap_or_default();
        Self {
            part: now.part,
            measured_error_mm: now,
            previous_error_mm: before,
            earlier_parts,
            force_change: 0.0,
            new_cutter: None,
            promise,
            holdout_residual_mm: holdout,
            residual: None,
            rolled_back,
            used_again,
            remarks,
        }
    }

    /// Notes its level of force over that of the part before, natural logarithm.
    pub(super) fn cut_with(&mut self, level: f64) {
        self.force_change = level.exp_m1();
        if self.force_change.abs() < TELLING || self.used_again.is_some() {
            return;
        }
        let (now, before) = (self.part, self.previous_error_mm.part);
        let more = if self.force_change > 0.0 { "more" } else { "less" };
        let percent = 100.0 * self.force_change.abs();
        let said = format!(
            "part {now} was cut with {percent:.0} % {more} force than part {before}: another lot of the material, a worn cutter or a new one; the next correction is for parts like it"
        );
        self.remarks.push(said.into());
    }

    /// Adds a remark.
    pub(super) fn say(&mut self, remark: Option<Remark>) {
        self.remarks.extend(remark);
    }

    /// What the user should know of the part, a sentence each.
    pub fn remarks(&self) -> &[Remark] {
        &self.remarks
    }
}
