//! What moves from part to part: a Kalman filter (Bar-Shalom, *Estimation with Applications to Tracking and Navigation*, chapters 5
//! and 11), whose readings come one by one, so that no matrix is inverted.
//!
//! | state | between two parts |
//! |---|---|
//! | force level ΔL, share | walks, and has a slope that walks slowly: wear |
//! | radius lost ΔU, mm | the same |
//! | datum D, mm | walks: clamping, warming up |
//! | offset b of every place, mm | stays |
//!
//! Level and size are counted from the first part. A new cutter frees level, size and their slopes, a lot the level, a set-up the datum.

use statrs::distribution::{ChiSquared, ContinuousCDF};
use truepath_ground::hypotenuse::hypot;

use crate::series::{Event, Part, Place, Series, any_is_pushed};

/// States before those of the places.
pub const OWN: usize = 6;
/// Force level, its slope, radius lost, its slope, datum along X and Y.
pub const LEVEL: usize = 0;
/// Change of the force level per part.
pub const LEVEL_SLOPE: usize = 1;
/// Radius that the cutter lost, mm.
pub const SIZE: usize = 2;
/// Its change per part, mm.
pub const SIZE_SLOPE: usize = 3;
/// Datum along X, mm; along Y it follows.
pub const DATUM: usize = 4;

/// Standard deviations of the walk between two parts, by state.
const WALK: [f64; OWN] = [0.004, 0.0003, 0.0002, 2e-5, 0.002, 0.002];
/// Standard deviations at the first part; level and size are counted from it.
const FIRST: [f64; OWN] = [0.0, 0.004, 0.0, 2e-4, 0.01, 0.01];
/// What a new cutter may change: level, slope, size, slope.
const NEW_CUTTER: [f64; OWN] = [0.15, 0.004, 0.01, 2e-4, 0.0, 0.0];
/// What another lot may change.
const NEW_LOT: [f64; OWN] = [0.1, 0.0, 0.0, 0.0, 0.0, 0.0];
/// What a new set-up may change.
const NEW_SETUP: [f64; OWN] = [0.0, 0.0, 0.0, 0.0, 0.03, 0.03];
/// What a part that does not go on as those before may have changed.
const STEP: [f64; OWN] = [0.15, 0.0, 0.01, 0.0, 0.03, 0.03];
/// Standard deviation of a place's own offset, mm.
const OFFSET: f64 = 0.05;
/// A wall is not pushed in proportion to the force: share of a change of the level by which a place may answer otherwise.
const UNEVEN: f64 = 0.15;
/// A reading farther from its expectation is wild, standard deviations; several of a part are none.
const WILD: f64 = 4.5;
/// Parts whose misfit says what the noise is, from the first on that has one before it.
const LEAST_PARTS: usize = 4;

/// State after a part.
#[derive(Clone, Debug, PartialEq)]
pub struct Estimate {
    /// Number of the part.
    pub number: u32,
    /// Mean of every state: [`OWN`], then places.
    pub mean: Vec<f64>,
    /// Covariance, row by row.
    pub covariance: Vec<Vec<f64>>,
    /// Readings set aside as wild.
    pub wild: Vec<usize>,
    /// How well it went with the parts before.
    pub innovation: Fit,
    /// What changed at once, where the part did not go on as those before.
    pub step: Option<Step>,
}

/// What a part does not share with those before.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// What explains it best.
    pub cause: Cause,
    /// By how much that changed; of the datum its length, mm.
    pub change: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// What a change is of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, serde::Serialize, serde::Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Cause {
    /// The force level: wear, material.
    ForceLevel,
    /// The cutter's radius.
    Radius,
    /// The cutter's radius or the force: without a known deflection they are one.
    RadiusOrForce,
    /// The datum: clamping, temperature.
    Datum,
    /// None of these alone.
    Place,
}

impl Cause {
    /// The states it changes.
    const fn states(self) -> &'static [usize] {
        match self {
            Self::ForceLevel => &[LEVEL],
            Self::Radius | Self::RadiusOrForce => &[SIZE],
            Self::Datum => &[DATUM, DATUM + 1],
            Self::Place => &[],
        }
    }
}

/// The filter's result.
#[derive(Clone, Debug, PartialEq)]
pub struct Filtered {
    /// After every touched part.
    pub estimates: Vec<Estimate>,
    /// Standard deviation of a reading beside the model, mm.
    pub noise_mm: f64,
}

impl Estimate {
    /// Standard deviation of a state.
    pub fn sigma(&self, state: usize) -> f64 {
        self.covariance[state][state].max(0.0).sqrt()
    }

    /// Deviation at a place so many parts later, and its standard deviation without noise, mm.
    pub fn forecast(&self, place: usize, of: &Place, parts: u32) -> (f64, f64) {
        let mut h = row(place, of, self.mean.len());
        let walked_by = h.clone();
        h[LEVEL_SLOPE] = h[LEVEL] * f64::from(parts);
        h[SIZE_SLOPE] = h[SIZE] * f64::from(parts);
        let mean = h.iter().zip(&self.mean).map(|(h, x)| h * x).sum();
        let walked: f64 = walked_by.iter().take(OWN).zip(walked(parts)).map(|(h, walked)| h * h * walked).sum();
        let variance: f64 = product(&self.covariance, &h).iter().zip(&h).map(|(a, h)| a * h).sum();
        (mean, (variance.max(0.0) + walked).sqrt())
    }
}

/// Follows a batch. `noise_mm` is the standard deviation of one reading where the parts say nothing of it yet; a part counts as a step
/// that chance would make once in `rarely` parts.
pub fn follow(series: &Series, noise_mm: f64, rarely: f64) -> Filtered {
    let mut noise = noise_mm;
    for _ in 0..2 {
        // Nothing is set aside: what the noise says is wild depends on the noise that is sought. The median is not moved by
        // the parts that differ.
        let all = run(series, noise, None);
        let misfit = |e: &Estimate| {
            let (sum, count, _) = e.innovation;
            Some(sum / ChiSquared::new(count as f64).ok()?.inverse_cdf(0.5))
        };
        let mut seen: Vec<f64> = all.estimates.iter().skip(1).filter_map(misfit).collect();
        if seen.len() < LEAST_PARTS {
            break;
        }
        seen.sort_by(f64::total_cmp);
        let factor = seen[seen.len() / 2].sqrt().clamp(0.2, 10.0);
        // Of few parts the expected noise counts as four of them.
        let weight = seen.len() as f64 / (seen.len() + LEAST_PARTS) as f64;
        noise *= 1.0 + (factor - 1.0) * weight;
    }
    run(series, noise, Some(rarely))
}

/// `rarely` as in [`follow`]; `None` sets nothing aside and takes no part for a step.
fn run(series: &Series, noise_mm: f64, rarely: Option<f64>) -> Filtered {
    let count = OWN + series.places.len();
    let mut mean = vec![0.0; count];
    let mut covariance = vec![vec![0.0; count]; count];
    widen(&mut covariance, &FIRST);
    (OWN..count).for_each(|at| covariance[at][at] = OFFSET * OFFSET);
    let mut before: Option<u32> = None;
    let mut estimates = Vec::new();
    let mut wild_before: Vec<usize> = Vec::new();
    for part in &series.parts {
        if let Some(before) = before {
            advance(&mut mean, &mut covariance, part.number.saturating_sub(before));
            let moved = mean[LEVEL_SLOPE] * f64::from(part.number.saturating_sub(before));
            uneven(series, &mut covariance, moved);
        }
        before = Some(part.number);
        // Level and size are counted from the first part, whatever was new then.
        for event in part.events.iter().filter(|_| !estimates.is_empty()) {
            let by = match event {
                Event::Cutter => &NEW_CUTTER,
                Event::Lot => &NEW_LOT,
                Event::Setup => &NEW_SETUP,
            };
            widen(&mut covariance, by);
            uneven(series, &mut covariance, by[LEVEL]);
        }
        let expected = (mean.clone(), covariance.clone());
        // Nothing before says what the first part should be: no reading of it is wild, and it is no step.
        let gated = rarely.filter(|_| !estimates.is_empty());
        let (mut wild, mut innovation) =
            update(series, part, noise_mm, (&mut mean, &mut covariance), &[], gated.is_some());
        let mut step = None;
        if let Some(rarely) = gated
            && differs(innovation, wild.len(), part.readings.len(), rarely)
        {
            (mean, covariance) = expected.clone();
            step = Some(cause_of(series, part, noise_mm, &expected));
            widen(&mut covariance, &STEP);
            uneven(series, &mut covariance, STEP[LEVEL]);
            let of_step;
            (wild, of_step) = update(series, part, noise_mm, (&mut mean, &mut covariance), &[], true);
            innovation.1 = of_step.1;
        }
        // A place that is wild part after part is another place now.
        let wild_places: Vec<usize> = wild.iter().map(|at| part.readings[*at].0).collect();
        for place in wild_places.iter().filter(|place| wild_before.contains(place)) {
            covariance[OWN + place][OWN + place] += OFFSET * OFFSET;
        }
        wild_before = wild_places;
        let (mean, covariance) = (mean.clone(), covariance.clone());
        estimates.push(Estimate { number: part.number, mean, covariance, wild, innovation, step });
    }
    Filtered { estimates, noise_mm }
}

/// The one cause under which the readings of a part are most probable: what it changes is a state of its own then, beside that
/// which it changes. None where they fit under no single one.
fn cause_of(series: &Series, part: &Part, noise_mm: f64, (mean, covariance): &(Vec<f64>, Vec<Vec<f64>>)) -> Step {
    let pushed = any_is_pushed(&series.places);
    let causes: &[Cause] = match pushed {
        true => &[Cause::ForceLevel, Cause::Radius, Cause::Datum],
        false => &[Cause::RadiusOrForce, Cause::Datum],
    };
    let tried = causes.iter().map(|&cause| {
        let (mut mean, mut covariance) = (mean.clone(), covariance.clone());
        let first = mean.len();
        for state in cause.states() {
            mean.push(0.0);
            covariance.iter_mut().for_each(|line| line.push(0.0));
            covariance.push(vec![0.0; mean.len()]);
            if let Some(cell) = covariance.last_mut().and_then(|line| line.last_mut()) {
                *cell = STEP[*state] * STEP[*state];
            }
        }
        if cause == Cause::ForceLevel {
            uneven(series, &mut covariance, STEP[LEVEL]);
        }
        let (wild, fit) = update(series, part, noise_mm, (&mut mean, &mut covariance), cause.states(), true);
        let change = mean[first..].iter().fold(0.0, |sum: f64, v| hypot(sum, *v));
        let signed = if cause == Cause::Datum { change } else { mean[first] };
        let sigma = (first..mean.len()).map(|at| covariance[at][at].max(0.0).sqrt()).fold(0.0, f64::max);
        // A reading set aside is as improbable as one at the bound.
        let improbable = fit.0 + fit.2 + wild.len() as f64 * WILD * WILD;
        let fits = wild.len() * 4 <= part.readings.len();
        (improbable, fits, Step { cause, change: signed, sigma })
    });
    let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
    let certain = |step: &Step| step.change.abs() > 2.0 * step.sigma;
    best.filter(|(_, fits, step)| *fits && certain(step))
        .map_or(Step { cause: Cause::Place, change: 0.0, sigma: 0.0 }, |(.., step)| step)
}

/// Whether a part differs from what was expected by more than chance.
fn differs((sum, count, _): Fit, wild: usize, readings: usize, rarely: f64) -> bool {
    let many = wild * 4 >= readings && wild >= 2 || wild == readings;
    let limit =
        |count: usize| ChiSquared::new(count as f64).map_or(f64::MAX, |chi| chi.inverse_cdf(1.0 - 1.0 / rarely));
    many || (count > 0 && sum > limit(count))
}

/// Sum of squared normalised innovations, how many, and the sum of the logarithms of their variances, mm².
pub type Fit = (f64, usize, f64);

/// One part's readings, one by one; wild ones are set aside where they are `gated`. `changed` are states that have a change of their own behind the places.
fn update(
    series: &Series,
    part: &Part,
    noise_mm: f64,
    (mean, covariance): (&mut [f64], &mut [Vec<f64>]),
    changed: &[usize],
    gated: bool,
) -> (Vec<usize>, Fit) {
    let (mut wild, mut sum, mut count, mut logarithms) = (Vec::new(), 0.0, 0, 0.0);
    let first = OWN + series.places.len();
    for (at, &(place, error)) in part.readings.iter().enumerate() {
        let mut h = row(place, &series.places[place], mean.len());
        for (at, state) in changed.iter().enumerate() {
            h[first + at] = h[*state];
        }
        let gain = product(covariance, &h);
        let variance = gain.iter().zip(&h).map(|(a, h)| a * h).sum::<f64>() + noise_mm * noise_mm;
        let off = error - h.iter().zip(mean.iter()).map(|(h, x)| h * x).sum::<f64>();
        let square = off * off / variance;
        // What is set aside counts as improbable as well.
        logarithms += variance.ln();
        if gated && square > WILD * WILD {
            wild.push(at);
            continue;
        }
        sum += square;
        count += 1;
        for (i, x) in mean.iter_mut().enumerate() {
            *x += gain[i] * off / variance;
        }
        for (i, line) in covariance.iter_mut().enumerate() {
            for (j, cell) in line.iter_mut().enumerate() {
                *cell -= gain[i] * gain[j] / variance;
            }
        }
    }
    (wild, (sum, count, logarithms))
}

/// How a place answers to the states.
fn row(place: usize, of: &Place, count: usize) -> Vec<f64> {
    let mut h = vec![0.0; count];
    h[LEVEL] = of.deflection_mm;
    h[SIZE] = 1.0;
    h[DATUM] = of.normal[0];
    h[DATUM + 1] = of.normal[1];
    h[OWN + place] = 1.0;
    h
}

fn product(matrix: &[Vec<f64>], vector: &[f64]) -> Vec<f64> {
    matrix.iter().map(|line| line.iter().zip(vector).map(|(a, b)| a * b).sum()).collect()
}

fn widen(covariance: &mut [Vec<f64>], by: &[f64; OWN]) {
    for (at, by) in by.iter().enumerate() {
        covariance[at][at] += by * by;
    }
}

/// The offsets of places after a change of the force level.
fn uneven(series: &Series, covariance: &mut [Vec<f64>], change: f64) {
    for (at, place) in series.places.iter().enumerate() {
        covariance[OWN + at][OWN + at] += (UNEVEN * change * place.deflection_mm).powi(2);
    }
}

/// Goes on by some parts.
fn advance(mean: &mut [f64], covariance: &mut [Vec<f64>], parts: u32) {
    let k = f64::from(parts);
    for (state, slope) in [(LEVEL, LEVEL_SLOPE), (SIZE, SIZE_SLOPE)] {
        mean[state] += k * mean[slope];
        // F·P·Fᵀ with F = 1 + k at (state, slope).
        let of_slope = covariance[slope].clone();
        for (cell, of_slope) in covariance[state].iter_mut().zip(of_slope) {
            *cell += k * of_slope;
        }
        for line in covariance.iter_mut() {
            line[state] += k * line[slope];
        }
    }
    for (at, walked) in walked(parts).into_iter().enumerate() {
        covariance[at][at] += walked;
    }
    for (state, slope) in [(LEVEL, LEVEL_SLOPE), (SIZE, SIZE_SLOPE)] {
        let both = WALK[slope].powi(2) * k * (k - 1.0) / 2.0;
        covariance[state][slope] += both;
        covariance[slope][state] += both;
    }
}

/// Variance that walks add over some parts; level and size have what their slopes walked in between as well.
fn walked(parts: u32) -> [f64; OWN] {
    let k = f64::from(parts);
    let mut walked = WALK.map(|walk| walk * walk * k);
    for (state, slope) in [(LEVEL, LEVEL_SLOPE), (SIZE, SIZE_SLOPE)] {
        walked[state] += WALK[slope].powi(2) * (k * (k - 1.0) * (2.0 * k - 1.0)).max(0.0) / 6.0;
    }
    walked
}
