//! One run: traffic through a faulty cable to a board, every answer compared and judged.
//!
//! The host makes the events of a batch and, with its own code, what has to come back; then the board gets the events.
//! Bytes are compared first. At the first difference the run ends and tells the tick, the setpoint and both answers.
//! Answers that agree are judged by rules that know nothing of that code ([`Judge`]).

use std::collections::VecDeque;
use std::hash::Hasher;
use std::time::{Duration, Instant};

use fnv::FnvHasher;
use truepath_core::image::Image;
use truepath_core::link::{
    Ask, Counters, Denial, DeviceSettings, MAX_SETPOINT_BYTES, PACKET_BYTES, Request, SetpointFrame, encode_request,
};
use truepath_core::rewrite::{Mode, Output, Refusal, Setpoint};

use super::board::{Board, Event};
use super::difference::Difference;
use super::error::BenchError;
use super::expect::Expectation;
use super::injector::{Delivery, FaultInjector, Faults, Injected};
use super::judge::{Happened, Judge};
use super::traffic::{Command, Traffic};
use super::watch::RunStatus;

/// Frames of a batch.
const BATCH: usize = 8192;

/// What is fixed for a run.
#[derive(Clone, Copy, Debug)]
pub struct Plan {
    /// Settings of the device.
    pub settings: DeviceSettings,
    /// Faults of the cable.
    pub faults: Faults,
    /// Seed of the cable.
    pub seed: u64,
}

/// What came of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// What the cable did.
    pub injected: Injected,
    /// Answers received.
    pub answers: u64,
    /// FNV-1a of the bytes of all answers: of the board, and of the host.
    pub digest: u64,
    /// The same of the host's own.
    pub expected_digest: u64,
    /// Answers by mode, `Off` first.
    pub modes: [u64; 6],
    /// Parts armed.
    pub armed: u64,
    /// Times the drives were acknowledged to be disabled.
    pub acknowledged: u64,
    /// Largest correction, nm.
    pub largest_nm: i64,
    /// Round trips, ns.
    pub round_trips_ns: Vec<u64>,
    /// Counters as they must be.
    pub counters: Counters,
    /// Time the board took for the batches.
    pub elapsed: Duration,
    /// The first difference.
    pub difference: Option<Difference>,
}

/// A run under way.
pub struct Campaign<'a> {
    pub(super) plan: Plan,
    cable: FaultInjector<Setpoint>,
    pub(super) expectation: Expectation<'a>,
    pub(super) judge: Judge,
    id: u16,
    session: Option<u64>,
    tick_us: u32,
    stepped: bool,
    pub(super) log: VecDeque<Happened>,
    pub(super) host: FnvHasher,
    pub(super) board: FnvHasher,
    pub(super) outcome: Outcome,
    /// Some of the answers of the batch.
    pub(super) trail: Vec<Output>,
}

/// The tick of a device, µs, rounded up: frames at this distance never come faster than its setpoint rate.
pub(super) fn tick_us(settings: &DeviceSettings) -> u32 {
    1_000_000u32.div_ceil(settings.rewriter.tick_hz.max(1))
}

/// What a batch has to give.
pub(super) struct Batch<'a> {
    /// The host's model before it.
    pub start: Expectation<'a>,
    pub events: Vec<Event>,
    pub answers: Vec<u8>,
    /// Id, command and the host's word on it.
    pub replies: Vec<(u16, Command, Result<(), Refusal>)>,
}

impl<'a> Campaign<'a> {
    /// A run against a board that was prepared with the same settings and image ([`prepare`](super::prepare)).
    ///
    /// # Errors
    /// The settings do not go with the image.
    pub fn new(plan: Plan, image: Image<'a>, stepped: bool) -> Result<Self, BenchError> {
        let option = |e: truepath_core::rewrite::SettingsError| BenchError::Option {
            found: e.to_string(),
            help: "choose another --rate".to_owned(),
        };
        let expectation = Expectation::new(plan.settings, image).map_err(option)?;
        let limits = expectation.rewriter().limits().cloned().ok_or(BenchError::Denied(Denial::Unknown))?;
        Ok(Self {
            cable: FaultInjector::new(plan.faults, plan.seed),
            judge: Judge::new(limits, plan.settings.axes),
            id: 0,
            session: None,
            tick_us: tick_us(&plan.settings),
            stepped,
            log: VecDeque::new(),
            host: FnvHasher::default(),
            board: FnvHasher::default(),
            outcome: Outcome {
                injected: Injected::default(),
                answers: 0,
                digest: 0,
                expected_digest: 0,
                modes: [0; 6],
                armed: 0,
                acknowledged: 0,
                largest_nm: 0,
                round_trips_ns: vec![],
                counters: Counters::default(),
                elapsed: Duration::ZERO,
                difference: None,
            },
            trail: vec![],
            expectation,
            plan,
        })
    }

    /// Runs the traffic to its end or to the first difference. `progress` is told after
    /// every batch.
    ///
    /// # Errors
    /// The connection is lost.
    pub fn run(
        mut self,
        traffic: &mut dyn Traffic,
        board: &mut dyn Board,
        mut progress: impl FnMut(&RunStatus<'_>),
    ) -> Result<Outcome, BenchError> {
        self.id = board.first_id();
        self.session = board.session();
        loop {
            let batch = self.batch(traffic);
            if batch.events.is_empty() {
                break;
            }
            let start = Instant::now();
            let exchange = board.exchange(&batch.events)?;
            self.outcome.elapsed += start.elapsed();
            if let Err(difference) = self.compare(&batch, &exchange) {
                self.outcome.difference = Some(*difference);
                break;
            }
            self.outcome.round_trips_ns.extend(exchange.round_trips_ns);
            let timing = board.client().timing()?;
            // The board has seen other ids since, and the session may be another one.
            (self.id, self.session) = (board.first_id(), board.session());
            progress(&RunStatus {
                injected: self.cable.injected(),
                counters: self.expectation.endpoint().counters(),
                answers: self.outcome.answers,
                modes: self.judge.modes(),
                armed: self.outcome.armed,
                largest_nm: self.judge.largest_nm(),
                elapsed: self.outcome.elapsed,
                timing: timing.as_ref(),
                trail: &self.trail,
            });
            self.trail.clear();
        }
        let mut outcome = self.outcome;
        outcome.injected = *self.cable.injected();
        outcome.digest = self.board.finish();
        outcome.expected_digest = self.host.finish();
        outcome.modes = *self.judge.modes();
        outcome.largest_nm = self.judge.largest_nm();
        outcome.counters = *self.expectation.endpoint().counters();
        Ok(outcome)
    }

    /// The next batch; without events at the end of the traffic.
    fn batch(&mut self, traffic: &mut dyn Traffic) -> Batch<'a> {
        let start = self.expectation.clone();
        let mut batch = Batch { start, events: vec![], answers: vec![], replies: vec![] };
        while batch.events.len() < 3 * BATCH && batch.answers.len() < BATCH * MAX_SETPOINT_BYTES {
            match traffic.next(self.expectation.mode()) {
                None => {
                    let mut out = Vec::new();
                    self.cable.finish(|delivery| out.push(delivery));
                    out.into_iter().for_each(|delivery| self.deliver(delivery, &mut batch));
                    break;
                }
                Some(Command::Setpoint(setpoint)) => self.send(&setpoint, &mut batch),
                Some(command) => self.command(command, &mut batch),
            }
        }
        batch
    }

    fn send(&mut self, setpoint: &Setpoint, batch: &mut Batch<'a>) {
        let frame = SetpointFrame { axes: self.plan.settings.axes, setpoint: *setpoint };
        let mut packet = [0; MAX_SETPOINT_BYTES + 2];
        // Six axes fit; the number of axes was checked with the settings.
        let used = frame.encode_packet(&mut packet).unwrap_or(0);
        let mut out = Vec::new();
        self.cable.pass(&packet[..used], *setpoint, |delivery| out.push(delivery));
        out.into_iter().for_each(|delivery| self.deliver(delivery, batch));
    }

    /// What passes in the host's model when `us` pass on the cable. A board with a clock of its own is told of no pause, and
    /// its frames come no faster than its tick: that is all that matters of the time between them.
    pub(super) fn passed(&self, us: u32) -> u32 {
        if self.stepped { us } else { self.tick_us }
    }

    /// What came out of the cable: to the host's model, and into the batch.
    fn deliver(&mut self, delivery: Delivery<Setpoint>, batch: &mut Batch<'a>) {
        let us = delivery.delay_us.saturating_add(self.tick_us);
        batch.events.push(Event::Time(us));
        let before = self.expectation.mode();
        self.expectation.time(self.passed(us));
        if before != Mode::Off && self.expectation.mode() == Mode::Off {
            self.log.push_back(Happened::Silent);
        }
        if delivery.whole {
            self.log.push_back(Happened::Delivered(delivery.content));
        }
        let answers = self.expectation.bytes(&delivery.bytes, &mut batch.answers);
        if !delivery.bytes.is_empty() {
            batch.events.push(Event::Setpoint { bytes: delivery.bytes, answers });
        }
    }

    fn command(&mut self, command: Command, batch: &mut Batch<'a>) {
        let ask = match command {
            Command::Acknowledge => Ask::AcknowledgeDrivesDisabled,
            Command::Arm(request) => Ask::Arm(request),
            Command::Disarm => Ask::Disarm,
            Command::Setpoint(_) => return,
        };
        let expected = self.expectation.command(&command);
        if expected.is_ok() {
            self.log.push_back(Happened::Commanded(command));
            self.outcome.armed += u64::from(matches!(command, Command::Arm(_)));
            self.outcome.acknowledged += u64::from(command == Command::Acknowledge);
        }
        self.id = self.id.wrapping_add(1);
        let mut packet = [0; PACKET_BYTES];
        // A request without a chunk is short.
        let used = encode_request(&Request { id: self.id, ask }, self.session, &mut packet).unwrap_or(0);
        batch.events.push(Event::Request(packet[..used].to_vec()));
        batch.replies.push((self.id, command, expected));
    }
}
