//! The error of a wall at the places that were touched, without any model: between them nothing is measured.

use truepath_core::job::same_place;
use truepath_core::probe::Contact;
use truepath_core::units::Offset;
use truepath_ground::length::Unit;
use truepath_ground::rows::p95;
use truepath_ground::units::{float, mm};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

use super::causes::MeasuredCauses;
use super::expected::place_words;

/// The largest measured error at any touched height beside the largest mean over the touched heights of a place, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct TouchedSurface {
    /// The largest deviation of a point, the sign aside.
    pub profile_mm: f64,
    /// Standard deviation of a single point: half of the stated expanded uncertainty, or the noise of the probe.
    pub sigma_mm: f64,
    /// 95 of 100 points are nearer to the nominal wall than this.
    pub p95_mm: f64,
    /// The largest mean over the touched heights of a place, the sign aside.
    pub mean_mm: f64,
    /// Where the largest deviation is, along the contour.
    pub s_mm: f64,
    /// Its height above the tip.
    pub height_mm: f64,
    /// What makes it.
    pub causes: MeasuredCauses,
    /// Points touched.
    pub points: usize,
    /// Most heights touched at one place.
    pub heights: usize,
}

impl TouchedSurface {
    /// Of a wall that was measured. The standard deviation of a point is half of the expanded uncertainty that the job states, or
    /// the noise of a reading.
    pub fn of_measurement(pass: &Pass, measurement: &Measurement) -> Self {
        let stated = pass.job.part.uncertainty.map(|expanded| Offset::from_nm(expanded.nm() / 2));
        let depth = pass.job.numbers.cut.axial_depth;
        Self::of(&measurement.contacts, depth, stated.unwrap_or(measurement.noise))
    }

    /// Of several contours: the worst of them, with the points of all. `None` without any.
    pub fn worst(all: impl Iterator<Item = Self> + Clone) -> Option<Self> {
        let points = all.clone().map(|one| one.points).sum();
        let worst = all.clone().max_by(|a, b| a.profile_mm.total_cmp(&b.profile_mm))?;
        let most = |of: fn(&Self) -> f64| all.clone().map(|one| of(&one)).fold(0.0, f64::max);
        Some(Self { points, mean_mm: most(|one| one.mean_mm), p95_mm: most(|one| one.p95_mm), ..worst })
    }

    /// In a sentence.
    pub fn words(&self, unit: Unit) -> String {
        format!(
            "measured: mean over the touched heights of a place up to {:.3} {name}; worst at any touched height {:.3} ± {:.3} {name}",
            unit.of(self.mean_mm),
            unit.of(self.profile_mm),
            unit.of(2.0 * self.sigma_mm),
            name = unit.name()
        )
    }

    /// Where the largest deviation is and what makes it, in a line.
    pub fn worst_words(&self, unit: Unit) -> String {
        format!("{}: {}", place_words(unit, self.s_mm, self.height_mm), self.causes.words(unit))
    }

    /// Of contacts in the order of the contour.
    fn of(contacts: &[Contact], depth: Offset, sigma: Offset) -> Self {
        let mut magnitudes: Vec<f64> = contacts.iter().map(|contact| mm(contact.error).abs()).collect();
        let worst = contacts.iter().max_by_key(|contact| contact.error.abs());
        let places: Vec<&[Contact]> = contacts.chunk_by(|a, b| same_place(a.s, b.s)).collect();
        let of_worst = worst.and_then(|worst| places.iter().find(|place| place.iter().any(|c| std::ptr::eq(c, worst))));
        let column: Vec<f64> = of_worst.into_iter().flat_map(|place| place.iter().map(|c| mm(c.error))).collect();
        let mean = |place: &&[Contact]| place.iter().map(|c| mm(c.error)).sum::<f64>() / place.len().max(1) as f64;
        Self {
            profile_mm: worst.map_or(0.0, |contact| mm(contact.error).abs()),
            sigma_mm: mm(sigma),
            p95_mm: p95(&mut magnitudes),
            mean_mm: places.iter().map(mean).fold(0.0, |most, mean| most.max(mean.abs())),
            s_mm: worst.map_or(0.0, |contact| mm(contact.s)),
            height_mm: worst.map_or(0.0, |contact| float(contact.height) * mm(depth)),
            causes: MeasuredCauses::of(&column, worst.map_or(0.0, |contact| mm(contact.error)), mm(sigma)),
            points: contacts.len(),
            heights: places.iter().map(|place| place.len()).max().unwrap_or_default(),
        }
    }
}
