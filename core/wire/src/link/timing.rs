//! How regularly setpoint frames arrive, and how fast they are answered.
//!
//! In two halves, so that a tick costs some ten instructions: the setpoint path leaves a stamp of each frame that is
//! followed in a ring ([`Stamps`]), and whoever serves the configuration link takes them out and counts
//! ([`TimingMeter`]). Stamps that nobody took out in time are overwritten and counted as missed.
//!
//! All sums are integers that cannot overflow: a count stands at 2³² − 1, a deviation saturates at 32 bits, so a sum of
//! them has 63 bits at the most and one of their squares 94. Mean and deviation are
//! therefore exact to a nanosecond, without a floating point number.

use heapless::Vec;
use serde::{Deserialize, Serialize};
use truepath_units::{div_rounded, isqrt_rounded};

use super::counters::Counters;
use super::endpoint::Verdict;
use super::settings::DeviceSettings;

/// Stamps that [`Stamps::drain`] gives at a time.
pub const STAMPS_AT_ONCE: usize = 16;
/// Lower bounds of all bins but the first of a histogram, ns.
pub const TIMING_EDGES_NS: [u32; 10] =
    [1_000, 2_000, 5_000, 10_000, 20_000, 50_000, 100_000, 200_000, 500_000, 1_000_000];
/// Bins of a histogram.
pub const TIMING_BINS: usize = TIMING_EDGES_NS.len() + 1;

/// Bit of [`Stamp::taken`]: the frame follows the one before.
const FOLLOWS: u32 = 1 << 31;
const NS_PER_S: u32 = 1_000_000_000;

/// What the setpoint path leaves of a frame.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Stamp {
    /// When it arrived, µs, the lower 32 bits.
    arrived_us: u32,
    /// Counts of the board's counter until the answer was made, and [`FOLLOWS`].
    taken: u32,
}

/// A ring of N stamps, a power of two.
#[derive(Clone, Debug)]
pub struct Stamps<const N: usize> {
    places: [Stamp; N],
    /// Stamps written and read so far, wrapping.
    written: u32,
    read: u32,
}

impl<const N: usize> Stamps<N> {
    const MASK: u32 = {
        assert!(N.is_power_of_two());
        (N as u32).wrapping_sub(1)
    };

    /// An empty ring.
    pub const fn new() -> Self {
        Self { places: [Stamp { arrived_us: 0, taken: 0 }; N], written: 0, read: 0 }
    }

    /// Leaves the stamp of a frame that was followed, with the counts from its arrival to its answer, less than 2³¹.
    #[inline]
    pub fn leave(&mut self, verdict: Verdict, arrived_us: u64, counts: u32) {
        let follows = if matches!(verdict, Verdict::Accepted) { FOLLOWS } else { 0 };
        if let Some(place) = self.places.get_mut((self.written & Self::MASK) as usize) {
            *place = Stamp { arrived_us: arrived_us as u32, taken: counts & !FOLLOWS | follows };
        }
        self.written = self.written.wrapping_add(1);
    }

    /// How many were overwritten since the last time, and the oldest that are left; both are gone from here then.
    pub fn drain(&mut self) -> (u32, Vec<Stamp, STAMPS_AT_ONCE>) {
        let missed = self.written.wrapping_sub(self.read).saturating_sub(N as u32);
        self.read = self.read.wrapping_add(missed);
        let mut stamps = Vec::new();
        while self.read != self.written {
            let Some(stamp) = self.places.get((self.read & Self::MASK) as usize) else { break };
            if stamps.push(*stamp).is_err() {
                break;
            }
            self.read = self.read.wrapping_add(1);
        }
        (missed, stamps)
    }
}

impl<const N: usize> Default for Stamps<N> {
    fn default() -> Self {
        Self::new()
    }
}

/// How a time spreads, ns; zeros without a value.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Spread {
    /// Values; at 2³² − 1 it stands, and everything else with it.
    pub count: u32,
    /// Their mean, to nearest.
    pub mean_ns: i32,
    /// Their standard deviation, to a nanosecond.
    pub deviation_ns: u32,
    /// The least.
    pub least_ns: i32,
    /// The greatest.
    pub greatest_ns: i32,
}

/// Timing of the setpoint link since the reset, `ClearCounters` or `Configure`.
///
/// The bins of a histogram are below 1 µs, from there on those of [`TIMING_EDGES_NS`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Timing {
    /// Time between two frames by the settings, ns.
    pub period_ns: u32,
    /// Time between two frames that follow each other, less the period; behind a lost frame, a jump or a silence there
    /// is none.
    pub arrivals: Spread,
    /// Those that came early, by how much.
    pub early: [u32; TIMING_BINS],
    /// Those that came in time or late, by how much.
    pub late: [u32; TIMING_BINS],
    /// Time from where the bytes of a frame were handed to the setpoint path until its answer was made.
    pub answers: Spread,
    /// The same as a histogram.
    pub taken: [u32; TIMING_BINS],
    /// Frames that are in none of this, because the configuration link was busy for too long.
    pub missed: u32,
}

/// Count, sums and extremes of a time in ns.
#[derive(Clone, Copy, Debug, Default)]
struct Moments {
    count: u32,
    sum: i64,
    squares: u128,
    least: i32,
    greatest: i32,
}

impl Moments {
    /// Takes a value; says whether there was room.
    fn take(&mut self, ns: i32) -> bool {
        let Some(count) = self.count.checked_add(1) else { return false };
        let first = self.count == 0;
        self.least = if first { ns } else { self.least.min(ns) };
        self.greatest = if first { ns } else { self.greatest.max(ns) };
        self.count = count;
        self.sum = self.sum.saturating_add(ns.into());
        let size = u128::from(ns.unsigned_abs());
        self.squares = self.squares.saturating_add(size.saturating_mul(size));
        true
    }

    fn spread(&self) -> Spread {
        let count = i128::from(self.count.max(1));
        let mean_ns = i32::try_from(div_rounded(self.sum.into(), count)).unwrap_or(0);
        // n Σx² − (Σx)² is n² times the variance, and never negative.
        let (sum, n) = (u128::from(self.sum.unsigned_abs()), u128::from(self.count.max(1)));
        let scaled = n.saturating_mul(self.squares).saturating_sub(sum.saturating_mul(sum));
        let root = i128::try_from(isqrt_rounded(scaled)).unwrap_or(0);
        let deviation_ns = u32::try_from(div_rounded(root, count)).unwrap_or(u32::MAX);
        Spread { count: self.count, mean_ns, deviation_ns, least_ns: self.least, greatest_ns: self.greatest }
    }
}

/// Counts stamps; gives [`Timing`].
#[derive(Clone, Copy, Debug)]
pub struct TimingMeter {
    period_ns: u32,
    silence_us: u32,
    counter_hz: u32,
    /// Arrival of the last frame, if the next one can follow it.
    last_us: Option<u32>,
    arrivals: Moments,
    early: [u32; TIMING_BINS],
    late: [u32; TIMING_BINS],
    answers: Moments,
    taken: [u32; TIMING_BINS],
    missed: u32,
}

impl TimingMeter {
    /// Nothing counted yet; `counter_hz` is the rate of the counter that the stamps are made with.
    pub fn new(settings: &DeviceSettings, counter_hz: u32) -> Self {
        let tick_hz = settings.rewriter.tick_hz.max(1);
        Self {
            period_ns: div_rounded(NS_PER_S.into(), tick_hz.into()) as u32,
            silence_us: settings.silence_us,
            counter_hz: counter_hz.max(1),
            last_us: None,
            arrivals: Moments::default(),
            early: [0; TIMING_BINS],
            late: [0; TIMING_BINS],
            answers: Moments::default(),
            taken: [0; TIMING_BINS],
            missed: 0,
        }
    }

    /// Takes what [`Stamps::drain`] gave.
    pub fn take(&mut self, missed: u32, stamps: &[Stamp]) {
        if missed > 0 {
            self.missed = self.missed.saturating_add(missed);
            self.last_us = None;
        }
        for stamp in stamps {
            self.arrived(stamp);
            self.answered(stamp.taken & !FOLLOWS);
        }
    }

    fn arrived(&mut self, stamp: &Stamp) {
        let Some(last_us) = self.last_us.replace(stamp.arrived_us) else { return };
        let interval_us = stamp.arrived_us.wrapping_sub(last_us);
        // The first frame after a silence is accepted as well.
        if stamp.taken & FOLLOWS == 0 || interval_us >= self.silence_us {
            return;
        }
        let interval_ns = i64::from(interval_us).saturating_mul(1_000);
        let deviation = saturated(interval_ns.saturating_sub(self.period_ns.into()));
        if self.arrivals.take(deviation) {
            let bins = if deviation < 0 { &mut self.early } else { &mut self.late };
            one_more(bins, deviation.unsigned_abs());
        }
    }

    fn answered(&mut self, counts: u32) {
        let ns = u64::from(counts).saturating_mul(NS_PER_S.into()).checked_div(self.counter_hz.into()).unwrap_or(0);
        let ns = saturated(i64::try_from(ns).unwrap_or(i64::MAX));
        if self.answers.take(ns) {
            one_more(&mut self.taken, ns.unsigned_abs());
        }
    }

    /// What was counted.
    pub fn timing(&self) -> Timing {
        Timing {
            period_ns: self.period_ns,
            arrivals: self.arrivals.spread(),
            early: self.early,
            late: self.late,
            answers: self.answers.spread(),
            taken: self.taken,
            missed: self.missed,
        }
    }
}

fn saturated(ns: i64) -> i32 {
    ns.clamp(i32::MIN.into(), i32::MAX.into()) as i32
}

/// Counts a time in its bin.
fn one_more(bins: &mut [u32; TIMING_BINS], ns: u32) {
    let bin = TIMING_EDGES_NS.partition_point(|edge| *edge <= ns);
    if let Some(count) = bins.get_mut(bin) {
        Counters::one_more(count);
    }
}
