//! What a schedule does: feeds, force, time.

use truepath_core::cut::Loop;
use truepath_ground::units::{float, mm};

use super::force::Load;
use super::force::Wanted;
use super::schedule::Schedule;

/// What a schedule does, for people and for machines.
#[derive(Clone, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct FeedSummary {
    /// Largest mean force over a revolution that was allowed, N.
    pub limit_n: f64,
    /// Where the limit is from: `max_force_n`, or `probed` for the largest force at the probed places.
    pub limited_by: &'static str,
    /// Lowest and highest feed that was allowed, percent of the programmed one.
    pub range_percent: [u16; 2],
    /// Lowest and highest feed in use, percent of the programmed one.
    pub used_percent: [u16; 2],
    /// Places where the feed changes.
    pub changes: usize,
    /// Largest force at the feeds of the program, N.
    pub max_force_before_n: f64,
    /// Largest force at the scheduled feeds, N.
    pub max_force_after_n: f64,
    /// Time along the contour at the feeds of the program, s.
    pub time_before_s: f64,
    /// Time along the contour at the scheduled feeds, s.
    pub time_after_s: f64,
    /// What a correction at the feeds of the program would leave; absent where the feeds stay, and where its
    /// displacement would be beyond the clamp.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub unscheduled: Option<Unscheduled>,
}

/// A correction at the feeds of the program, to compare with; lengths in mm.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, schemars::JsonSchema)]
pub struct Unscheduled {
    /// Largest predicted wall error of the target quantity.
    pub max_error_after_mm: f64,
    /// Its largest standard deviation.
    pub max_sigma_mm: f64,
    /// Largest deviation over the height, which no displacement in X and Y removes.
    pub axial_form_error_mm: f64,
    /// Largest displacement along an axis.
    pub max_correction_mm: f64,
}

impl FeedSummary {
    /// Of a machine on the path with the feeds of the program; `schedule` is `None` where these stay.
    pub fn new(machine: &Loop, wanted: &Wanted, limited_by: &'static str, schedule: Option<&Schedule>) -> Self {
        let path = machine.path;
        let samples = &path.samples()[path.first()..path.first() + path.count()];
        let load = Load::new(machine);
        let percent = |s| schedule.map_or(100, |schedule| schedule.percent(s));
        let (mut before, mut after) = (0.0f64, 0.0f64);
        for (k, sample) in samples.iter().enumerate() {
            before = before.max(load.newtons(path.first() + k, 100));
            after = after.max(load.newtons(path.first() + k, percent(sample.s)));
        }
        let time = |percent: &dyn Fn(truepath_core::units::Offset) -> u16| {
            let pieces = samples.windows(2);
            let seconds = |feed: f64, length: f64| if feed > 0.0 { 60.0 * length / feed } else { 0.0 };
            pieces
                .map(|p| seconds(float(p[0].feed) * f64::from(percent(p[0].s)) / 100.0, mm(p[1].s - p[0].s)))
                .sum::<f64>()
        };
        let used = || samples.iter().map(|sample| percent(sample.s));
        Self {
            limit_n: wanted.limit_n,
            limited_by,
            range_percent: wanted.percent,
            used_percent: [used().min().unwrap_or(100), used().max().unwrap_or(100)],
            changes: schedule.map_or(0, |schedule| schedule.changes().len().saturating_sub(1)),
            max_force_before_n: before,
            max_force_after_n: after,
            time_before_s: time(&|_| 100),
            time_after_s: time(&percent),
            unscheduled: None,
        }
    }

    /// What the user should know, when the range is too narrow for the limit.
    pub fn doubt(&self) -> Option<String> {
        // The feed is written in whole percents.
        (self.max_force_after_n > 1.01 * self.limit_n).then(|| {
            format!(
                "at {} % of the programmed feed, the least that feed.min_percent allows, the force is still {:.0} N instead of {:.0} N: the edge force does not fall with the feed",
                self.used_percent[0], self.max_force_after_n, self.limit_n
            )
        })
    }

    /// For `difference.txt`.
    pub fn text(&self) -> String {
        let of = match self.limited_by {
            "probed" => "the largest at the probed places",
            _ => "feed.max_force_n",
        };
        format!(
            "\n\
             feed scheduling                   {} to {} % of the programmed feeds, {} changes (allowed {} to {} %)\n\
             largest mean force                {:.1} N instead of {:.1} N (limit {:.1} N, {of})\n\
             time along the contour            {:.1} s instead of {:.1} s\n",
            self.used_percent[0],
            self.used_percent[1],
            self.changes,
            self.range_percent[0],
            self.range_percent[1],
            self.max_force_after_n,
            self.max_force_before_n,
            self.limit_n,
            self.time_after_s,
            self.time_before_s,
        )
    }
}
