//! A whole batch: state, charts, forecast, and what asks for action.

use std::ops::Range;

use serde::{Deserialize, Serialize};

use crate::control::{Chart, quantile, share_below};
pub use crate::filter::Cause;
use crate::filter::{DATUM, Estimate, Filtered, LEVEL, LEVEL_SLOPE, SIZE, SIZE_SLOPE, Step, follow};
use crate::series::{Event, Part, Place, Series, any_is_pushed};
use truepath_ground::hypotenuse::hypot;
use truepath_ground::length::Unit;

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
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Known {
    /// The value.
    pub value: f64,
    /// Its standard deviation.
    pub sigma: f64,
}

/// The worst reading of a part: farthest beyond a limit or nearest to one, without a tolerance the largest.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Worst {
    /// Where.
    pub place: Place,
    /// Deviation there, mm.
    pub error_mm: f64,
    /// Whether all readings of the part are in tolerance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub in_tolerance: Option<bool>,
}

/// What moved until a part, since the first one.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct State {
    /// Number of the part.
    pub part: u32,
    /// Force level, as a share: 0.18 is 18 % more.
    pub force_level: Known,
    /// Radius that the cutter lost, mm.
    pub radius_lost_mm: Known,
    /// Datum along X and Y, mm.
    pub datum_mm: [Known; 2],
    /// Its readings.
    pub readings: usize,
    /// The worst of them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub worst: Option<Worst>,
    /// Readings set aside as wild.
    pub wild: usize,
    /// Whether it did not go on as the parts before.
    pub step: bool,
    /// What happened before it.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
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
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
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
    /// Readings of the last part that fit to nothing before.
    Wild {
        /// The part.
        part: u32,
        /// How many.
        readings: usize,
        /// The first of them.
        place: Place,
        /// Its deviation, mm.
        error_mm: f64,
    },
    /// The tolerance will be left.
    Leaving {
        /// First part that is more likely out than in.
        part: u32,
        /// Where.
        place: Place,
        /// What moves there towards the limit, with its change per part; `Place` where nothing does for certain.
        cause: Cause,
        /// Change of the deviation there per part, mm.
        per_part_mm: f64,
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
    /// Probability that the next part is in tolerance at every place, at least: 1 less the sum of what every place may be out with.
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
                    next_mm: Known { value, sigma: hypot(sigma, filtered.noise_mm) },
                }
            })
            .collect();
        let (milled, new) = series.milled.clone().unwrap_or((last_part, Vec::new()));
        // Behind a new cutter or another lot nothing goes on as it went.
        let goes_on = !new.iter().any(|event| matches!(event, Event::Cutter | Event::Lot));
        let leaving = request.tolerance_mm.filter(|_| goes_on).and_then(|tolerance| leaving(series, last, tolerance));
        let out = request.tolerance_mm.and_then(|t| out_of(series, t));
        let is_out = out.is_some();
        let mut alarms: Vec<Alarm> = out.into_iter().collect();
        alarms.extend(
            steps.last().filter(|alarm| matches!(alarm, Alarm::Step { part, .. } if *part == last_part)).cloned(),
        );
        alarms.extend(wild(series, last));
        if let Some(Leaves { part, place, .. }) = leaving
            && part <= milled.saturating_add(request.ahead)
            && !is_out
        {
            let place = &series.places[place];
            let (cause, per_part_mm) = moving(last, place);
            alarms.push(Alarm::Leaving { part, place: place.clone(), cause, per_part_mm });
        }
        let in_tolerance = request.tolerance_mm.filter(|_| goes_on).map(|[low, high]| {
            let out = |p: &PlaceChart| {
                let Known { value, sigma } = p.next_mm;
                share_below((low - value) / sigma) + 1.0 - share_below((high - value) / sigma)
            };
            (1.0 - places.iter().map(out).sum::<f64>()).max(0.0)
        });
        Some(Self {
            parts: [first_part, last_part],
            touched: series.parts.len(),
            noise_mm: filtered.noise_mm,
            tolerance_mm: request.tolerance_mm,
            states: states(series, &filtered, request.tolerance_mm),
            wear_per_part: known(last, LEVEL_SLOPE),
            leaves_at_part: leaving.map(|leaves| leaves.part),
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

    /// Whether the deflection is known at any place: without it a level of force looks like a radius.
    pub fn is_pushed(&self) -> bool {
        any_is_pushed(self.places.iter().map(|chart| &chart.place))
    }

    /// How the batch stands, in a few sentences: what moves, and for how long it goes well.
    pub fn words(&self, unit: Unit) -> Vec<String> {
        let mut said: Vec<String> = self.alarms.iter().map(|alarm| alarm.words(unit)).collect();
        let Some(now) = self.states.last() else { return said };
        let (since, pushed) = (self.parts[0], self.is_pushed());
        let Known { value, sigma } = now.force_level;
        if pushed && value.abs() > 2.0 * sigma && value.abs() > 0.01 {
            let why = if value > 0.0 {
                "the cutter wears, or the material is harder"
            } else {
                "a sharper cutter, or softer material"
            };
            said.push(format!(
                "force level {:+.0} ± {:.0} % (2 sigma) since part {since}: {why}",
                100.0 * value,
                200.0 * sigma
            ));
        }
        let Known { value, sigma } = now.radius_lost_mm;
        if value.abs() > 2.0 * sigma && value.abs() > 0.001 {
            said.push(format!("{} than at part {since}", smaller(value, sigma, pushed, unit)));
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
    pub fn words(&self, unit: Unit) -> String {
        let small = unit.small_name();
        match self {
            Self::OutOfTolerance { part, place, error_mm } => {
                format!(
                    "part {part} is out of tolerance: {:+.1} {small} at {}",
                    unit.small(*error_mm),
                    place.words(unit)
                )
            }
            Self::Step { part, cause, change } => {
                let by = match cause {
                    Cause::ForceLevel => {
                        format!("force level {:+.0} ± {:.0} % at once", 100.0 * change.value, 200.0 * change.sigma)
                    }
                    Cause::Radius => {
                        format!(
                            "{} at once: another cutter, or a chipped one",
                            smaller(change.value, change.sigma, true, unit)
                        )
                    }
                    Cause::RadiusOrForce => smaller(change.value, change.sigma, false, unit) + " at once",
                    Cause::Datum => format!(
                        "the datum moved by {:.1} ± {:.1} {small}: clamping, probe or temperature",
                        unit.small(change.value.abs()),
                        unit.small(2.0 * change.sigma)
                    ),
                    Cause::Place => {
                        "not the force level, the cutter or the datum alone: look at the places of this part".to_owned()
                    }
                };
                format!("part {part} does not go on as those before: {by}")
            }
            Self::Wild { part, readings, place, error_mm } => {
                let touches =
                    if *readings == 1 { "a reading fits".to_owned() } else { format!("{readings} readings fit") };
                format!(
                    "part {part}: {touches} to nothing before, {:+.1} {small} at {}: a chip under the ball, or a wall that is another there; touch it again",
                    unit.small(*error_mm),
                    place.words(unit)
                )
            }
            Self::Leaving { part, place, cause, per_part_mm } => {
                let why = match cause {
                    Cause::ForceLevel if *per_part_mm > 0.0 => "the force level grows",
                    Cause::ForceLevel => "the force level falls",
                    Cause::Radius if *per_part_mm > 0.0 => "the cutter gets smaller",
                    Cause::Radius => "the cutter gets larger",
                    Cause::RadiusOrForce => "the cutter wears",
                    Cause::Datum | Cause::Place => "it is near its limit",
                };
                format!(
                    "the tolerance is left at about part {part}, first at {}: {why} ({:+.2} {small} a part there)",
                    place.words(unit),
                    unit.small(*per_part_mm)
                )
            }
        }
    }
}

/// A radius that was lost, in words; without a known deflection a larger force looks the same.
fn smaller(lost_mm: f64, sigma_mm: f64, pushed: bool, unit: Unit) -> String {
    let which = if lost_mm > 0.0 { "smaller" } else { "larger" };
    let by = format!(
        "{:.1} ± {:.1} {} (2 sigma) {which}",
        unit.small(lost_mm.abs()),
        unit.small(2.0 * sigma_mm),
        unit.small_name()
    );
    if pushed {
        return format!("the cutter's radius is {by}");
    }
    let force = if lost_mm > 0.0 { "higher" } else { "lower" };
    format!("the cutter's radius is {by}, or the force {force}, which are one without --from")
}

fn known(estimate: &Estimate, state: usize) -> Known {
    Known { value: estimate.mean[state], sigma: estimate.sigma(state) }
}

fn states(series: &Series, filtered: &Filtered, tolerance: Option<[f64; 2]>) -> Vec<State> {
    let one = |(estimate, part): (&Estimate, &Part)| State {
        part: estimate.number,
        force_level: known(estimate, LEVEL),
        radius_lost_mm: known(estimate, SIZE),
        datum_mm: [known(estimate, DATUM), known(estimate, DATUM + 1)],
        readings: part.readings.len(),
        worst: worst(series, part, tolerance),
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

/// The worst reading of a part.
fn worst(series: &Series, part: &Part, tolerance: Option<[f64; 2]>) -> Option<Worst> {
    let beyond = |error: f64| tolerance.map_or(error.abs(), |[low, high]| (error - high).max(low - error));
    let (place, error_mm) = *part.readings.iter().max_by(|a, b| beyond(a.1).total_cmp(&beyond(b.1)))?;
    let in_tolerance = tolerance.map(|_| beyond(error_mm) <= 0.0);
    Some(Worst { place: series.places[place].clone(), error_mm, in_tolerance })
}

/// The worst reading of the last part, where it is out of tolerance.
fn out_of(series: &Series, tolerance: [f64; 2]) -> Option<Alarm> {
    let part = series.parts.last()?;
    let Worst { place, error_mm, in_tolerance } = worst(series, part, Some(tolerance))?;
    (in_tolerance == Some(false)).then_some(Alarm::OutOfTolerance { part: part.number, place, error_mm })
}

/// Readings of the last part that were set aside.
fn wild(series: &Series, last: &Estimate) -> Option<Alarm> {
    let (place, error_mm) = *series.parts.last()?.readings.get(*last.wild.first()?)?;
    let place = series.places[place].clone();
    Some(Alarm::Wild { part: last.number, readings: last.wild.len(), place, error_mm })
}

/// When and where the tolerance is left.
#[derive(Clone, Copy, Debug)]
struct Leaves {
    part: u32,
    place: usize,
}

/// The first part of which a place is more likely out of tolerance than in it, and the place.
fn leaving(series: &Series, last: &Estimate, [low, high]: [f64; 2]) -> Option<Leaves> {
    let out = |at: usize, parts: u32| {
        let (mean, _) = last.forecast(at, &series.places[at], parts);
        mean > high || mean < low
    };
    // A slope that may as well be none leads nowhere.
    let sloped = [LEVEL_SLOPE, SIZE_SLOPE].iter().any(|state| is_sloped(last, *state));
    HORIZON.take_while(|parts| sloped || *parts == 1).find_map(|parts| {
        let place = (0..series.places.len()).find(|at| out(*at, parts))?;
        Some(Leaves { part: last.number.saturating_add(parts), place })
    })
}

fn is_sloped(last: &Estimate, state: usize) -> bool {
    last.mean[state].abs() > quantile(0.975) * last.sigma(state)
}

/// What moves a place most, and by how much it moves per part, mm.
fn moving(last: &Estimate, place: &Place) -> (Cause, f64) {
    let whole = last.mean[LEVEL_SLOPE] * place.deflection_mm + last.mean[SIZE_SLOPE];
    let pushed = place.deflection_mm != 0.0;
    let kinds = [
        (Cause::ForceLevel, LEVEL_SLOPE, last.mean[LEVEL_SLOPE] * place.deflection_mm),
        (if pushed { Cause::Radius } else { Cause::RadiusOrForce }, SIZE_SLOPE, last.mean[SIZE_SLOPE]),
    ];
    let sense = if whole >= 0.0 { 1.0 } else { -1.0 };
    let towards = kinds.into_iter().filter(|(_, state, change)| change * sense > 0.0 && is_sloped(last, *state));
    let most = towards.max_by(|a, b| (a.2 * sense).total_cmp(&(b.2 * sense)));
    (most.map_or(Cause::Place, |(cause, ..)| cause), whole)
}
