//! The floor: what no correction brings a part below, because nothing repeats better.
//!
//! A correction cancels what comes again on the next part. What does not is left, however well the machine is known, and a
//! prediction that is smaller promises what cannot be held:
//!
//! | part | from |
//! |---|---|
//! | machine | `[machine] repeatability_mm`; else places touched on several corrected parts; else [`PRIOR_MM`] |
//! | probe | places touched several times; else `[probe] noise_mm` |
//! | drift | what the level of force and the size of the cutter do at least from part to part; contained in what parts show |
//! | over the height | what helix and bending leave beside the target: no shift in x and y removes it |
//!
//! All are standard deviations but the last, which is a largest error. Limit: clamping and temperature belong to the machine here.

use truepath_core::identify::Observation;
use truepath_ground::hypotenuse::hypot;
use truepath_ground::length::Unit;
use truepath_ground::units::{float, mm};

use crate::discrepancy::least_change;
use crate::surface::expected::Surface;

/// Repeatability of a machine of which nothing is known, mm: the geometric middle of [`PRIOR_RANGE_MM`].
pub const PRIOR_MM: f64 = 0.010;
/// Standard deviations of single dimensions, coordinate measurements of 59 nominally equal parts: NIST smart manufacturing
/// systems test bed.
pub const PRIOR_RANGE_MM: [f64; 2] = [0.003, 0.031];
/// Differences that a scatter is believed from.
const LEAST: usize = 4;
/// Places nearer than this along the contour, mm, and in height, as a share of the engaged depth, are one.
const SAME: [f64; 2] = [0.2, 0.02];

/// Where the repeatability of the machine is known from.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize, schemars::JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum KnownFrom {
    /// The job states it.
    Job,
    /// The same places of corrected parts.
    Parts,
    /// Machines of its kind.
    #[default]
    Prior,
}

/// A floor in its parts, mm.
#[derive(Clone, Copy, Debug, Default, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Floor {
    /// What the machine repeats to: standard deviation of one place from part to part.
    pub machine_mm: f64,
    /// Where that is known from.
    pub machine_from: KnownFrom,
    /// What the probe repeats to: standard deviation of one reading.
    pub probe_mm: f64,
    /// What force and cutter do from part to part at least: standard deviation where the deflection is largest.
    pub drift_mm: f64,
    /// What is left over the height: the largest deviation from the target.
    pub over_height_mm: f64,
}

impl Floor {
    /// Of a correction that cancels an error of this size, for a machine whose repeatability the job states or does not; `noise_mm`
    /// is that of one reading, `observations` are those of the measured part.
    pub fn of(
        stated_mm: Option<f64>,
        noise_mm: f64,
        observations: &[Observation],
        cancelled_mm: f64,
        over_height_mm: f64,
    ) -> Self {
        Self {
            machine_mm: stated_mm.unwrap_or(PRIOR_MM),
            machine_from: if stated_mm.is_some() { KnownFrom::Job } else { KnownFrom::Prior },
            probe_mm: touched_again(observations).unwrap_or(noise_mm),
            drift_mm: least_change(cancelled_mm),
            over_height_mm,
        }
    }

    /// The same where parts show what the machine repeats to and the job does not state it: the points of those that were cut with a
    /// correction, in their order, as one fit left them.
    #[must_use]
    pub fn shown_by(self, corrected: &[&[Observation]]) -> Self {
        match scatter(corrected) {
            Some(scatter) if self.machine_from != KnownFrom::Job => {
                let machine_mm = (scatter * scatter - self.probe_mm * self.probe_mm).max(0.0).sqrt();
                Self { machine_mm, machine_from: KnownFrom::Parts, drift_mm: 0.0, ..self }
            }
            _ => self,
        }
    }

    /// Of the mean over the height, one standard deviation, mm.
    pub fn mm(&self) -> f64 {
        hypot(hypot(self.machine_mm, self.probe_mm), self.drift_mm)
    }

    /// Of several contours: the highest, with what is left over the height of any.
    pub fn highest(all: impl Iterator<Item = Self> + Clone) -> Self {
        let over_height_mm = all.clone().map(|one| one.over_height_mm).fold(0.0, f64::max);
        let highest = all.max_by(|a, b| a.mm().total_cmp(&b.mm())).unwrap_or_default();
        Self { over_height_mm, ..highest }
    }

    /// A predicted error, or the floor where that is larger, mm.
    pub fn or(&self, predicted_mm: f64) -> f64 {
        predicted_mm.max(self.mm())
    }

    /// From one error to a predicted one, or to the floor where that is larger.
    pub fn fall(&self, unit: Unit, before_mm: f64, predicted_mm: f64) -> String {
        let [before, predicted, floor] = [before_mm, predicted_mm, self.mm()].map(|mm| unit.of(mm));
        if predicted_mm >= self.mm() {
            return format!("{before:.4} -> {predicted:.4} {}", unit.name());
        }
        format!("{before:.4} -> {floor:.4} {}, the floor (the model alone: {predicted:.4})", unit.name())
    }

    /// What the next part will be, and what the machine repeats to, in a line.
    pub fn line(&self, unit: Unit, after: &Surface) -> String {
        // The drift is part of the predicted deviation.
        let sigma = hypot(hypot(after.mean_sigma_mm, self.machine_mm), self.probe_mm);
        let machine = match self.machine_from {
            KnownFrom::Job | KnownFrom::Parts => "your machine repeats",
            KnownFrom::Prior => "machines repeat",
        };
        format!(
            "Will be {:.3} ± {:.3} {} (mean, 1 sigma), {:.3} at the worst height; {machine} to about {:.3}",
            unit.of(self.or(after.mean_mm)),
            unit.of(sigma),
            unit.name(),
            unit.of(self.or(after.profile.profile_mm)),
            unit.of(self.machine_mm)
        )
    }

    /// The same with what a second correction can do.
    pub fn promise(&self, unit: Unit, after: &Surface) -> String {
        format!("{}: {}.", self.line(unit, after), self.next(unit, after))
    }

    /// What a second correction can do.
    pub fn next(&self, unit: Unit, after: &Surface) -> String {
        // The largest of what many places do not repeat is some two deviations.
        let held = 2.0 * self.mm();
        if after.mean_mm <= held {
            "a second correction cannot improve that".to_owned()
        } else {
            format!("a second correction can come down to about {:.3}", unit.of(held))
        }
    }

    /// Its parts in a line.
    pub fn words(&self, unit: Unit) -> String {
        let from = match self.machine_from {
            KnownFrom::Job => "the job says so".to_owned(),
            KnownFrom::Parts => "corrected parts show it".to_owned(),
            KnownFrom::Prior => {
                let [low, high] = PRIOR_RANGE_MM.map(|mm| unit.of(mm));
                format!("a prior: NIST test bed, 59 equal parts, {low:.3} to {high:.3}")
            }
        };
        format!(
            "{:.4} {} (1 sigma) = machine {:.4} ({from}), probe {:.4}, drift {:.4}; over the height {:.4} besides",
            unit.of(self.mm()),
            unit.name(),
            unit.of(self.machine_mm),
            unit.of(self.probe_mm),
            unit.of(self.drift_mm),
            unit.of(self.over_height_mm)
        )
    }
}

/// Whether two points are of one place.
fn same(a: &Observation, b: &Observation) -> bool {
    mm(a.s - b.s).abs() <= SAME[0] && float(a.height - b.height).abs() <= SAME[1]
}

/// Standard deviation of one reading, from places that were touched again on one part; `None` from too few.
fn touched_again(observations: &[Observation]) -> Option<f64> {
    let pairs = observations.windows(2).filter(|pair| same(&pair[0], &pair[1]));
    deviation(pairs.map(|pair| mm(pair[0].error - pair[1].error)))
}

/// Standard deviation of one place from part to part beside what their corrections foretell, the noise of the probe in it; `None`
/// from too few.
fn scatter(parts: &[&[Observation]]) -> Option<f64> {
    let residual = |o: &Observation| mm(o.error - o.predicted);
    let pairs = parts.windows(2).flat_map(|two| {
        two[1].iter().filter_map(|now| {
            let before = two[0].iter().find(|before| same(before, now))?;
            Some(residual(now) - residual(before))
        })
    });
    deviation(pairs)
}

/// Standard deviation of what two independent values differ in.
fn deviation(differences: impl Iterator<Item = f64>) -> Option<f64> {
    let squares: Vec<f64> = differences.map(|difference| difference * difference).collect();
    let count = squares.len();
    (count >= LEAST).then(|| (squares.iter().sum::<f64>() / (2.0 * count as f64)).sqrt())
}

#[cfg(test)]
mod tests {
    use truepath_core::geometry::Direction;
    use truepath_core::units::{Offset, Real};

    use super::*;
    use crate::surface::draws::Predicted;

    fn point(s_mm: i64, error_um: i64) -> Observation {
        let [s, error, noise] = [1000 * s_mm, error_um, 2].map(Offset::from_um);
        Observation::new(s, Real::ratio(1, 2), error, noise, Direction::X)
    }

    #[test]
    fn corrected_parts_show_what_their_machine_repeats_to() {
        // Differences of ±10 um are a deviation of 7.07 um; the probe's 5 um are taken out: 5 um remain.
        let row = |sign: i64| (0..6).map(|k| point(10 * k, sign * (5 - 10 * (k % 2)))).collect::<Vec<_>>();
        let parts = [row(1), row(-1)];
        let parts: Vec<&[Observation]> = parts.iter().map(Vec::as_slice).collect();
        let before = Floor { probe_mm: 0.005, drift_mm: 0.003, machine_mm: PRIOR_MM, ..Floor::default() };
        let shown = before.shown_by(&parts);
        assert!((shown.machine_mm - 0.005).abs() < 1e-9 && shown.machine_from == KnownFrom::Parts, "{shown:?}");
        assert!((shown.mm() - 0.005 * 2f64.sqrt()).abs() < 1e-9, "what parts show holds the drift");
        // One corrected part shows nothing, and the job's word stands.
        assert_eq!(before.shown_by(&parts[..1]), before);
        let stated = Floor { machine_from: KnownFrom::Job, ..before };
        assert_eq!(stated.shown_by(&parts), stated);
    }

    #[test]
    fn places_touched_again_tell_of_the_probe() {
        let twice: Vec<Observation> = (0..5).flat_map(|k| [point(10 * k, 103), point(10 * k, 97)]).collect();
        let found = touched_again(&twice).expect("five places");
        assert!((found - 0.006 / 2f64.sqrt()).abs() < 1e-9, "{found}");
        let once: Vec<Observation> = (0..10).map(|k| point(10 * k, 100)).collect();
        assert_eq!(touched_again(&once), None);
    }

    #[test]
    fn a_promise_never_goes_below_the_floor_and_says_whether_to_correct_again() {
        let floor = Floor { machine_mm: 0.005, machine_from: KnownFrom::Job, ..Floor::default() };
        let profile = Predicted { profile_mm: 0.035, sigma_mm: 0.004 };
        let wall = Surface { profile, mean_mm: 0.0005, mean_sigma_mm: 0.003, ..Surface::default() };
        assert_eq!(
            floor.promise(Unit::Millimetre, &wall),
            "Will be 0.005 ± 0.006 mm (mean, 1 sigma), 0.035 at the worst height; your machine repeats to about 0.005: a second correction cannot improve that."
        );
        let more = floor.promise(Unit::Millimetre, &Surface { mean_mm: 0.012, ..wall });
        assert!(more.contains("Will be 0.012") && more.ends_with("a second correction can come down to about 0.010."));
    }
}
