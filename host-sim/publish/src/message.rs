//! The messages, as `docs/publish.md` lists them: keys may be added, none changes its meaning or its unit without another [`SCHEMA`].

use serde::Serialize;
use truepath_batch::batch::{Alarm, Known, State};
use truepath_batch::series::{Event, Place};
use truepath_ground::length::Unit;
use truepath_ground::units::rounded;

use crate::summary::Summary;

/// The version of the messages.
pub const SCHEMA: u32 = 1;
/// Characters of a text at most; names of contours come from programs.
const LONGEST: usize = 500;

/// What every message begins with.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Head {
    schema: u32,
    machine: String,
    time: String,
}

impl Head {
    /// Of a machine, now.
    pub fn new(machine: &str, time: &str) -> Self {
        Self { schema: SCHEMA, machine: machine.to_owned(), time: time.to_owned() }
    }

    /// When.
    pub fn time(&self) -> &str {
        &self.time
    }
}

/// Whether somebody follows the batches.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Status {
    /// Yes: what changes will be told.
    Online,
    /// No: this is how it stood once.
    Once,
}

/// How the process of a machine stands: that of the batch that changed last, with the others behind it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct StateMessage {
    /// Of what, when.
    #[serde(flatten)]
    pub head: Head,
    /// Whether somebody follows.
    pub status: Status,
    /// Of this program.
    pub software_version: &'static str,
    /// Alarms of all batches that are raised.
    pub alarms: usize,
    /// The batch that changed last.
    #[serde(flatten)]
    pub batch: BatchState,
    /// The other ones.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub others: Vec<BatchState>,
}

/// How a batch stands; absent values are null, so that the keys are always the same.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct BatchState {
    /// What it is called.
    pub batch: String,
    /// Whether nothing asks for action.
    pub in_control: bool,
    /// The last touched part.
    pub last_part: u32,
    /// How many parts were touched.
    pub parts_touched: usize,
    /// Change since the first part as a share; null without the folder of the correction, as it is one with the radius then.
    pub force_level: Option<f64>,
    /// Its standard deviation.
    pub force_level_sigma: Option<f64>,
    /// Its change per part.
    pub force_level_per_part: Option<f64>,
    /// The standard deviation of that.
    pub force_level_per_part_sigma: Option<f64>,
    /// Radius that the cutter lost since the first part.
    pub radius_lost_mm: f64,
    /// Its standard deviation.
    pub radius_lost_sigma_mm: f64,
    /// Datum since the first part.
    pub datum_x_mm: f64,
    /// Its standard deviation.
    pub datum_x_sigma_mm: f64,
    /// Datum since the first part.
    pub datum_y_mm: f64,
    /// Its standard deviation.
    pub datum_y_sigma_mm: f64,
    /// Standard deviation of a reading.
    pub reading_sigma_mm: f64,
    /// Lower limit of deviations.
    pub tolerance_lower_mm: Option<f64>,
    /// Upper limit.
    pub tolerance_upper_mm: Option<f64>,
    /// Probability that the next part is in tolerance everywhere, at least.
    pub next_in_tolerance: Option<f64>,
    /// The first part that is more likely out of tolerance than in it; null where none is within 200.
    pub leaves_at_part: Option<u32>,
    /// Parts behind the last touched one that are still expected in tolerance.
    pub parts_left: Option<u32>,
    /// What to do about the most urgent alarm.
    pub next_action: Option<String>,
}

/// A part.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct PartMessage {
    /// Of what, when.
    #[serde(flatten)]
    pub head: Head,
    /// Of which batch.
    pub batch: String,
    /// What is told of it.
    #[serde(flatten)]
    pub part: Part,
}

/// What is told of a part; a part of which this changes is told again.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Part {
    /// Its number in the batch.
    pub part: u32,
    /// The reading farthest beyond a limit or nearest to one; positive, material left.
    pub worst_deviation_mm: f64,
    /// Where, along the contour.
    pub s_mm: f64,
    /// Where, above the tip.
    pub height_mm: f64,
    /// On which contour, where there are several.
    pub contour: Option<String>,
    /// Whether all readings are in tolerance; null without one.
    pub in_tolerance: Option<bool>,
    /// Lower limit of deviations.
    pub tolerance_lower_mm: Option<f64>,
    /// Upper limit.
    pub tolerance_upper_mm: Option<f64>,
    /// How many readings.
    pub readings: usize,
    /// What happened before it.
    pub events: Vec<Event>,
}

/// All alarms of a machine.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct AlarmMessage {
    /// Of what, when.
    #[serde(flatten)]
    pub head: Head,
    /// Those that are raised now, the most urgent of each batch first.
    pub raised: Vec<Raised>,
    /// Those that the message before had and this one has not.
    pub cleared: Vec<Cleared>,
}

/// An alarm.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Raised {
    /// Batch and kind, `corner/leaving`: the same as long as it is raised.
    pub key: String,
    /// What it is of.
    pub kind: &'static str,
    /// How bad.
    pub level: Level,
    /// Of which batch.
    pub batch: String,
    /// The part that it is about; of `leaving` the first that is out.
    pub part: u32,
    /// In words.
    pub text: String,
    /// When it was first seen.
    pub since: String,
    /// For agents: the side of the limit.
    #[serde(skip)]
    pub qualifier: &'static str,
}

/// An alarm that was.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Cleared {
    /// Its key.
    pub key: String,
    /// What it said.
    pub text: String,
}

/// How bad an alarm is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[serde(rename_all = "lowercase")]
pub enum Level {
    /// A part is out of tolerance.
    Fault,
    /// Look before the next part.
    Warning,
}

/// Lengths and shares to a millionth.
fn millionths(value: f64) -> f64 {
    rounded(value, 6)
}

fn clipped(text: &str) -> String {
    text.chars().take(LONGEST).collect()
}

impl BatchState {
    /// Of a summary, which has a part.
    pub(crate) fn of(name: &str, summary: &Summary, last: &State) -> Self {
        let level = |known: &Known| [known.value, known.sigma].map(|v| summary.is_pushed().then(|| millionths(v)));
        let [force_level, force_level_sigma] = level(&last.force_level);
        let [force_level_per_part, force_level_per_part_sigma] = level(&summary.wear_per_part);
        let of = |known: &Known| [known.value, known.sigma].map(millionths);
        let [radius_lost_mm, radius_lost_sigma_mm] = of(&last.radius_lost_mm);
        let [[datum_x_mm, datum_x_sigma_mm], [datum_y_mm, datum_y_sigma_mm]] = [0, 1].map(|k| of(&last.datum_mm[k]));
        let left = |leaves: u32| leaves.saturating_sub(last.part).saturating_sub(1);
        Self {
            batch: name.to_owned(),
            in_control: summary.alarms.is_empty(),
            last_part: last.part,
            parts_touched: summary.touched,
            force_level,
            force_level_sigma,
            force_level_per_part,
            force_level_per_part_sigma,
            radius_lost_mm,
            radius_lost_sigma_mm,
            datum_x_mm,
            datum_x_sigma_mm,
            datum_y_mm,
            datum_y_sigma_mm,
            reading_sigma_mm: millionths(summary.noise_mm),
            tolerance_lower_mm: summary.tolerance_mm.map(|t| t[0]),
            tolerance_upper_mm: summary.tolerance_mm.map(|t| t[1]),
            next_in_tolerance: summary.next_in_tolerance.map(millionths),
            leaves_at_part: summary.leaves_at_part,
            parts_left: summary.leaves_at_part.map(left),
            next_action: summary.next.as_deref().map(clipped),
        }
    }
}

impl Part {
    /// Of a part of a summary; none of one without readings.
    pub(crate) fn of(summary: &Summary, state: &State) -> Option<Self> {
        let worst = state.worst.as_ref()?;
        let Place { contour, s_mm, height_mm, .. } = &worst.place;
        Some(Self {
            part: state.part,
            worst_deviation_mm: millionths(worst.error_mm),
            s_mm: *s_mm,
            height_mm: *height_mm,
            contour: contour.as_deref().map(clipped),
            in_tolerance: worst.in_tolerance,
            tolerance_lower_mm: summary.tolerance_mm.map(|t| t[0]),
            tolerance_upper_mm: summary.tolerance_mm.map(|t| t[1]),
            readings: state.readings,
            events: state.events.clone(),
        })
    }
}

impl Raised {
    /// Of an alarm of a batch, seen at a time.
    pub(crate) fn of(batch: &str, alarm: &Alarm, since: &str) -> Self {
        let side = |value: f64| if value < 0.0 { "LOW" } else { "HIGH" };
        let (kind, level, part, qualifier) = match alarm {
            Alarm::OutOfTolerance { part, error_mm, .. } => ("out_of_tolerance", Level::Fault, part, side(*error_mm)),
            Alarm::Step { part, .. } => ("step", Level::Warning, part, ""),
            Alarm::Wild { part, .. } => ("wild", Level::Warning, part, ""),
            Alarm::Leaving { part, per_part_mm, .. } => ("leaving", Level::Warning, part, side(*per_part_mm)),
        };
        Self {
            key: format!("{batch}/{kind}"),
            kind,
            level,
            batch: batch.to_owned(),
            part: *part,
            text: clipped(&alarm.words(Unit::Millimetre)),
            since: since.to_owned(),
            qualifier,
        }
    }
}
