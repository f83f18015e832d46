//! A whole batch: state, charts, forecast, and what asks for action.

use std::ops::Range;

use serde::Serialize;

use crate::control::{Chart, quantile, share_below};
pub use crate::filter::Cause;
use crate::filter::{DATUM, Estimate, Filtered, LEVEL, LEVEL_SLOPE, SIZE, SIZE_SLOPE, Step, follow};
use crate::series::{Event, Place, Series};

/// What is asked of a batch.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Request {
    /// Standard deviation of one reading, mm.
    pub noise_mm: f64,
    /// Tolerance of deviations, mm.
    pub tolerance_mm: Option<[f64; 2]>,
    /// Parts ahead for which the tolerance has to be held.
    pub ahead: u32,
    /// A false alarm is to come once in so many parts at most.
    pub rarely: f64,
}

impl Default for Request {
    /// Noise of 2 µm, no tolerance, five parts ahead, a false alarm in 2,000 parts.
    fn default() -> Self {
        Self { noise_mm: 0.002, tolerance_mm: None, ahead: 5, rarely: 2_000.0 }
    }
}

/// A value and its standard deviation.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize)]
pub struct Known {
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// What moved until a part, since the first one or what was put in new.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct State {
    /// Number of the part.
    pub part: u32,
    /// Force level, as a share: 0.18 is 18 % more.
    pub force_level: Known,
    /// Radius that the cutter lost, mm.
    pub radius_lost_mm: Known,
    /// Datum along X and Y, mm.
    pub datum_mm: [Known; 2],
    /// Readings set aside as wild.
    pub wild: usize,
    /// Whether it did not go on as the parts before.
    pub step: bool,
    /// What happened before it.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub events: Vec<Event>,
}

/// A place with its chart.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PlaceChart {
    /// The place.
    #[serde(flatten)]
    pub place: Place,
    /// Deviations there: part and mm.
    pub deviations_mm: Vec<(u32, f64)>,
    /// Its chart; absent below five parts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub chart: Option<Chart>,
    /// Expected on the next part, mm.
    pub next_mm: Known,
}

/// What asks for action.
#[derive(Clone, Debug, PartialEq, Serialize)]
#[serde(tag = "kind", rename_all = "snake_case")]
pub enum Alarm {
    /// A reading of the last part is out of tolerance.
    OutOfTolerance {
        /// The part.
        part: u32,
        /// Where it is worst.
        place: Place,
        /// Deviation there, mm.
        error_mm: f64,
    },
    /// A part does not go on as those before.
    Step {
        /// The part.
        part: u32,
        /// What changed most.
        cause: Cause,
        /// By how much.
        change: Known,
    },
    /// The tolerance will be left.
    Leaving {
        /// First part that is more likely out than in.
        part: u32,
        /// Where.
        place: Place,
        /// What moves there most.
        cause: Cause,
    },
}

/// A batch, followed.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Batch {
    /// Parts that were touched, first and last.
    pub parts: [u32; 2],
    /// How many of them.
    pub touched: usize,
    /// Standard deviation of a reading beside the model, mm.
    pub noise_mm: f64,
    /// Tolerance, mm.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub tolerance_mm: Option<[f64; 2]>,
    /// Part after part.
    pub states: Vec<State>,
    /// Change of the force level per part, as a share.
    pub wear_per_part: Known,
    /// First part that is more likely out of tolerance than in it, by how things go; absent where none within 200 parts.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub leaves_at_part: Option<u32>,
    /// Probability that all places of the next part are in tolerance, each for itself: that of the worst.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub next_in_tolerance: Option<f64>,
    /// Places with their charts.
    pub places: Vec<PlaceChart>,
    /// What asks for action, the most urgent first. Steps count where the last touched part is one.
    pub alarms: Vec<Alarm>,
    /// Steps that were found, the last part's and earlier ones.
    pub steps: Vec<Alarm>,
}

/// How far ahead is looked for the part that leaves the tolerance.
const HORIZON: Range<u32> = 1..201;

impl Batch {
    /// Follows a batch; `None` without a touched part.
    pub fn of(series: &Series, request: &Request) -> Option<Self> {
        let filtered = follow(series, request.noise_mm, request.rarely);
        let last = filtered.estimates.last()?;
        let [first_part, last_part] = [series.parts.first()?.number, series.parts.last()?.number];
        let steps: Vec<Alarm> = filtered.estimates.iter().filter_map(step).collect();
        let per_chart = request.rarely * series.places.len().max(1) as f64;
        let places: Vec<PlaceChart> = (0..series.places.len())
            .map(|at| {
                let deviations = series.at(at);
                let plain: Vec<f64> = deviations.iter().map(|(_, d)| *d).collect();
                let (value, sigma) = last.forecast(at, &series.places[at], 1);
                PlaceChart {
                    place: series.places[at].clone(),
                    chart: Chart::of(&plain, request.tolerance_mm, per_chart),
                    deviations_mm: deviations,
                    next_mm: Known { value, sigma: sigma.hypot(filtered.noise_mm) },
                }
            })
            .collect();
        let leaving = request.tolerance_mm.and_then(|tolerance| leaving(series, last, tolerance));
        let mut alarms: Vec<Alarm> = request.tolerance_mm.and_then(|t| out_of(series, last, t)).into_iter().collect();
        alarms.extend(
            steps.last().filter(|alarm| matches!(alarm, Alarm::Step { part, .. } if *part == last_part)).cloned(),
        );
        if let Some((part, at)) = leaving
            && part <= last_part + request.ahead
            && !alarms.iter().any(|alarm| matches!(alarm, Alarm::OutOfTolerance { .. }))
        {
            let (place, cause) = (series.places[at].clone(), moving(last, &series.places[at]));
            alarms.push(Alarm::Leaving { part, place, cause });
        }
        let in_tolerance = request.tolerance_mm.map(|[low, high]| {
            let of = |p: &PlaceChart| {
                let Known { value, sigma } = p.next_mm;
                share_below((high - value) / sigma) - share_below((low - value) / sigma)
            };
            places.iter().map(of).fold(1.0, f64::min)
        });
        Some(Self {
            parts: [first_part, last_part],
            touched: series.parts.len(),
            noise_mm: filtered.noise_mm,
            tolerance_mm: request.tolerance_mm,
            states: states(series, &filtered),
            wear_per_part: known(last, LEVEL_SLOPE),
            leaves_at_part: leaving.map(|(part, _)| part),
            next_in_tolerance: in_tolerance,
            places,
            alarms,
            steps,
        })
    }

    /// The place whose next part comes nearest to a limit, or that is farthest off without a tolerance.
    pub fn worst(&self) -> Option<&PlaceChart> {
        let margin = |p: &PlaceChart| {
            let Known { value, sigma } = p.next_mm;
            match self.tolerance_mm {
                Some([low, high]) => ((high - value).min(value - low)) / sigma,
                None => -value.abs(),
            }
        };
        self.places.iter().min_by(|a, b| margin(a).total_cmp(&margin(b)))
    }

    /// What was put in new last, and before which part.
    fn since(&self) -> (u32, Option<Event>) {
        let newest =
            self.states.iter().rev().find_map(|s| Some((s.part, *s.events.iter().find(|e| **e != Event::Setup)?)));
        newest.map_or((self.parts[0], None), |(part, event)| (part, Some(event)))
    }

    /// How the batch stands, in a few sentences: what moves, and for how long it goes well.
    pub fn words(&self) -> Vec<String> {
        let mut said: Vec<String> = self.alarms.iter().map(Alarm::words).collect();
        let Some(now) = self.states.last() else { return said };
        let (since, _) = self.since();
        if now.force_level.value.abs() > 2.0 * now.force_level.sigma && now.force_level.value.abs() > 0.01 {
            let why = if now.force_level.value > 0.0 { "the cutter wears" } else { "the cutter cuts more easily" };
            said.push(format!(
                "force level {:+.0} ± {:.0} % since part {since}: {why}, or the material is another",
                100.0 * now.force_level.value,
                200.0 * now.force_level.sigma
            ));
        }
        if now.radius_lost_mm.value.abs() > 2.0 * now.radius_lost_mm.sigma && now.radius_lost_mm.value.abs() > 0.001 {
            said.push(format!(
                "the cutter's radius is {:.1} ± {:.1} µm smaller than at part {since}",
                1e3 * now.radius_lost_mm.value,
                2e3 * now.radius_lost_mm.sigma
            ));
        }
        let said_already =
            self.alarms.iter().any(|a| matches!(a, Alarm::OutOfTolerance { .. } | Alarm::Leaving { .. }));
        if let Some(part) = self.leaves_at_part.filter(|part| !said_already && *part > self.parts[1]) {
            said.push(format!("as things go, the tolerance is reached at about part {part}"));
        }
        if said.is_empty() {
            said.push("nothing moves by more than chance".to_owned());
        }
        said
    }
}

impl Alarm {
    /// In words.
    pub fn words(&self) -> String {
        match self {
            Self::OutOfTolerance { part, place, error_mm } => {
                format!("part {part} is out of tolerance: {:+.1} µm at {}", 1e3 * error_mm, place.words())
            }
            Self::Step { part, cause, change } => {
                let by = match cause {
                    Cause::ForceLevel => {
                        format!("force level {:+.0} ± {:.0} % at once", 100.0 * change.value, 200.0 * change.sigma)
                    }
                    Cause::Radius => format!(
                        "the cutter's radius is {:.1} ± {:.1} µm smaller at once: another cutter, or a chipped one",
                        1e3 * change.value,
                        2e3 * change.sigma
                    ),
                    Cause::Datum => format!(
                        "the datum moved by {:.1} ± {:.1} µm: clamping, probe or temperature",
                        1e3 * change.value.abs(),
                        2e3 * change.sigma
                    ),
                    Cause::Place => {
                        "not the force level, the cutter or the datum alone: look at the places of this part".to_owned()
                    }
                };
                format!("part {part} does not go on as those before: {by}")
            }
            Self::Leaving { part, place, cause } => {
                let why = match cause {
                    Cause::ForceLevel => "the force level grows",
                    Cause::Radius => "the cutter gets smaller",
                    Cause::Datum | Cause::Place => "it is near its limit",
                };
                format!("the tolerance is left at about part {part}, first at {}: {why}", place.words())
            }
        }
    }
}

fn known(estimate: &Estimate, state: usize) -> Known {
    Known { value: estimate.mean[state], sigma: estimate.sigma(state) }
}

fn states(series: &Series, filtered: &Filtered) -> Vec<State> {
    let one = |(estimate, part): (&Estimate, &crate::series::Part)| State {
        part: estimate.number,
        force_level: known(estimate, LEVEL),
        radius_lost_mm: known(estimate, SIZE),
        datum_mm: [known(estimate, DATUM), known(estimate, DATUM + 1)],
        wild: estimate.wild.len(),
        step: estimate.step.is_some(),
        events: part.events.clone(),
    };
    filtered.estimates.iter().zip(&series.parts).map(one).collect()
}

/// The alarm of a part that does not go on as those before.
fn step(estimate: &Estimate) -> Option<Alarm> {
    let Step { cause, change, sigma } = estimate.step?;
    Some(Alarm::Step { part: estimate.number, cause, change: Known { value: change, sigma } })
}

/// The worst reading of the last part, where it is out of tolerance. Wild ones are not looked at.
fn out_of(series: &Series, last: &Estimate, [low, high]: [f64; 2]) -> Option<Alarm> {
    let part = series.parts.last()?;
    let readings =
        part.readings.iter().enumerate().filter(|(at, _)| !last.wild.contains(at)).map(|(_, reading)| reading);
    let beyond = |error: f64| (error - high).max(low - error);
    let (place, error) = readings.max_by(|a, b| beyond(a.1).total_cmp(&beyond(b.1)))?;
    let place = series.places[*place].clone();
    (beyond(*error) > 0.0).then_some(Alarm::OutOfTolerance { part: part.number, place, error_mm: *error })
}

/// The first part of which a place is more likely out of tolerance than in it, and the place.
fn leaving(series: &Series, last: &Estimate, [low, high]: [f64; 2]) -> Option<(u32, usize)> {
    let out = |at: usize, parts: u32| {
        let (mean, _) = last.forecast(at, &series.places[at], parts);
        mean > high || mean < low
    };
    // A slope that may as well be none leads nowhere.
    let sloped = [LEVEL_SLOPE, SIZE_SLOPE].iter().any(|s| last.mean[*s].abs() > quantile(0.975) * last.sigma(*s));
    HORIZON.take_while(|parts| sloped || *parts == 1).find_map(|parts| {
        let at = (0..series.places.len()).find(|at| out(*at, parts))?;
        Some((last.number + parts, at))
    })
}

/// What moves a place most.
fn moving(last: &Estimate, place: &Place) -> Cause {
    let level = (place.deflection_mm * last.mean[LEVEL_SLOPE]).abs();
    let size = last.mean[SIZE_SLOPE].abs();
    match level.max(size) {
        most if most < 5e-5 => Cause::Place,
        most if most == level => Cause::ForceLevel,
        _ => Cause::Radius,
    }
}
