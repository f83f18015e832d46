//! What came of a run, for people and machines.

use serde::Serialize;
use truepath_bench::{Board, Identity, Injected, Outcome, RoundTrip};
use truepath_core::link::Counters;
use truepath_core::rewrite::Mode;

use super::on_board::OnBoard;

/// What came of it.
#[derive(Clone, Debug, Serialize)]
pub struct Report {
    /// Who answered.
    pub device: Identity,
    /// How it was reached.
    pub board: String,
    /// The image made on the device, when that was asked for.
    pub on_board: Option<OnBoard>,
    /// Whether every answer was the host's, byte for byte, and kept every rule.
    pub identical: bool,
    /// The first difference.
    pub difference: Option<String>,
    /// Setpoints sent.
    pub setpoints: u64,
    /// Answers compared.
    pub answers: u64,
    /// FNV-1a of the bytes of all answers of the board.
    pub digest: String,
    /// The same of the host's own.
    pub host_digest: String,
    /// Answers in `Off`, `Bypass`, `Armed`, `Active`, `Hold`, `Fault`.
    pub modes: [u64; 6],
    /// Parts armed.
    pub armed: u64,
    /// Largest correction, mm.
    pub max_correction_mm: f64,
    /// What the cable did.
    pub injected: Injected,
    /// Counters of the device.
    pub counters: Counts,
    /// Faults of the device by reason.
    pub faults: Vec<(String, u32)>,
    /// Setpoints per second of real time, the host's own work not counted.
    pub setpoints_per_s: f64,
    /// Round trips, as measured from this process.
    pub round_trip: Option<RoundTrip>,
}

/// Counters of the setpoint link.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize)]
#[expect(missing_docs, reason = "named as in core::link::Counters")]
pub struct Counts {
    pub accepted: u32,
    pub answered: u32,
    pub damaged: u32,
    pub repeated: u32,
    pub out_of_order: u32,
    pub lost: u32,
    pub jumps: u32,
    pub late: u32,
    pub silences: u32,
}

impl From<&Counters> for Counts {
    fn from(c: &Counters) -> Self {
        Self {
            accepted: c.accepted,
            answered: c.answered,
            damaged: c.damaged,
            repeated: c.repeated,
            out_of_order: c.out_of_order,
            lost: c.lost,
            jumps: c.jumps,
            late: c.late,
            silences: c.silences,
        }
    }
}

/// Puts together what a run gave and what the device counted; counters that differ are a difference.
pub(super) fn report(board: &dyn Board, device: Identity, outcome: &Outcome, counters: &Counters) -> Report {
    let expected = Counts::from(&outcome.counters);
    let found = Counts::from(counters);
    let mut difference = outcome.difference.as_ref().map(ToString::to_string);
    if difference.is_none() && (found != expected || counters.faults != outcome.counters.faults) {
        difference = Some(format!("the counters differ: host {expected:?}, board {found:?}"));
    }
    let faults = counters.by_fault().filter(|&(_, count)| count > 0);
    let faults = faults.map(|(reason, count)| (reason.to_string(), count)).collect();
    let seconds = outcome.elapsed.as_secs_f64();
    Report {
        device,
        board: board.describe(),
        on_board: None,
        identical: difference.is_none(),
        difference,
        setpoints: outcome.injected.frames,
        answers: outcome.answers,
        digest: format!("{:016x}", outcome.digest),
        host_digest: format!("{:016x}", outcome.expected_digest),
        modes: outcome.modes,
        armed: outcome.armed,
        max_correction_mm: outcome.largest_nm as f64 / 1e6,
        injected: outcome.injected,
        counters: found,
        faults,
        setpoints_per_s: if seconds > 0.0 { outcome.injected.frames as f64 / seconds } else { 0.0 },
        round_trip: RoundTrip::of(outcome.round_trips_ns.clone()),
    }
}

impl Report {
    /// Answers in a mode.
    pub fn answers_in(&self, mode: Mode) -> u64 {
        self.modes.get(mode as usize).copied().unwrap_or(0)
    }
}
