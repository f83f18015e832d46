//! A board on two byte streams: setpoint link and configuration link, as on an axis drive.
//!
//! Up to `window` answers may be outstanding; 1 is the ping-pong of a servo cycle. Commands wait until every answer
//! before them has arrived, so that their place among the setpoints is the same on both sides.

use std::collections::VecDeque;
use std::sync::Arc;
use std::time::{Duration, Instant};

use super::board::{Board, Clients, Event, Exchange};
use super::client::Client;
use super::emulator::Emulator;
use super::error::BenchError;
use super::watch::Watch;
use super::wire::{Line, Wire};

/// How long an answer is waited for before it is taken for missing.
const PATIENCE: Duration = Duration::from_secs(3);

/// A board on two streams.
pub struct UartBoard {
    /// The emulator, if any: it ends before the streams are closed.
    _behind: Option<Emulator>,
    name: String,
    setpoints: Line,
    configuration: Line,
    window: u32,
    /// Whether events keep to their time.
    paced: bool,
    clients: Clients,
    watch: Option<Arc<Watch>>,
}

impl UartBoard {
    /// A board; with `paced` setpoints go out at their times, otherwise as fast as `window` permits.
    pub fn new(
        name: String,
        [setpoints, configuration]: [Line; 2],
        window: u32,
        paced: bool,
        behind: Option<Emulator>,
    ) -> Self {
        // Not the ids of the client before: its last answer is still remembered over there.
        let now = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).unwrap_or_default();
        let clients = Clients::from_id(now.as_millis() as u16);
        Self { _behind: behind, name, setpoints, configuration, window: window.max(1), paced, clients, watch: None }
    }
}

/// An exchange under way.
struct Running<'b> {
    board: &'b mut UartBoard,
    exchange: Exchange,
    /// When the frames were sent whose answers are outstanding.
    outstanding: VecDeque<Instant>,
    /// Answers that were given up.
    missing: bool,
}

impl Running<'_> {
    /// Takes what arrives until at most `most` answers are outstanding, and no longer than until `until`.
    fn collect(&mut self, most: usize, until: Option<Instant>) -> Result<(), BenchError> {
        let lost = |e: std::io::Error| BenchError::Silent(format!("setpoint link: {e}"));
        loop {
            let now = Instant::now();
            let enough = self.outstanding.len() <= most || self.missing;
            let within = match (enough, until) {
                (false, _) => PATIENCE,
                (true, Some(until)) if until > now => until - now,
                (true, _) => Duration::ZERO,
            };
            match self.board.setpoints.receive(within).map_err(lost)? {
                Some(arrival) => {
                    for _ in arrival.bytes.iter().filter(|&&b| b == 0) {
                        if let Some(sent) = self.outstanding.pop_front() {
                            let ns = arrival.at.saturating_duration_since(sent).as_nanos();
                            let ns = ns.try_into().unwrap_or(u64::MAX);
                            self.exchange.round_trips_ns.push(ns);
                            self.board.watch.iter().for_each(|watch| watch.answer(ns));
                        }
                    }
                    self.exchange.answers.extend_from_slice(&arrival.bytes);
                }
                None if !enough => {
                    // The comparison will tell which one; the rest is not waited for one by one.
                    self.missing = true;
                }
                None => return Ok(()),
            }
        }
    }

    fn request(&mut self, packet: &[u8]) -> Result<(), BenchError> {
        let lost = |e: std::io::Error| BenchError::Silent(format!("configuration link: {e}"));
        self.board.configuration.send(packet).map_err(lost)?;
        let until = Instant::now() + PATIENCE;
        loop {
            let left = until.saturating_duration_since(Instant::now());
            match self.board.configuration.receive(left).map_err(lost)? {
                Some(arrival) => {
                    self.exchange.replies.extend_from_slice(&arrival.bytes);
                    if arrival.bytes.contains(&0) {
                        return Ok(());
                    }
                }
                None => return Ok(()),
            }
        }
    }
}

impl Board for UartBoard {
    fn describe(&self) -> String {
        self.name.clone()
    }
    fn is_stepped(&self) -> bool {
        false
    }
    fn client(&mut self) -> Client<&mut dyn Wire> {
        self.clients.client(&mut self.configuration)
    }
    fn clients(&mut self) -> &mut Clients {
        &mut self.clients
    }

    fn watched_by(&mut self, watch: Arc<Watch>) {
        self.watch = Some(watch);
    }

    fn exchange(&mut self, events: &[Event]) -> Result<Exchange, BenchError> {
        let (window, paced) = (self.window as usize, self.paced);
        let mut running =
            Running { board: self, exchange: Exchange::default(), outstanding: VecDeque::new(), missing: false };
        let mut due = Instant::now();
        for event in events {
            if running.board.watch.as_ref().is_some_and(|watch| watch.is_leaving()) {
                return Err(BenchError::Stopped("within a batch".to_owned()));
            }
            match event {
                Event::Time(us) => {
                    let step = Duration::from_micros((*us).into());
                    due = (due + step).max(Instant::now() - LATE.min(step * LATE_STEPS));
                }
                Event::Setpoint { bytes, answers } => {
                    running.collect(window - 1, paced.then_some(due))?;
                    let sent = Instant::now();
                    let lost = |e: std::io::Error| BenchError::Silent(format!("setpoint link: {e}"));
                    running.board.setpoints.send(bytes).map_err(lost)?;
                    running.outstanding.extend((0..*answers).map(|_| sent));
                }
                Event::Request(packet) => {
                    running.collect(0, None)?;
                    running.request(packet)?;
                }
            }
        }
        running.collect(0, None)?;
        Ok(running.exchange)
    }
}

/// A late sender catches up on so much, and on no more than so many frames: a longer burst would be faster than the device
/// permits on average. What is more is lost time.
const LATE: Duration = Duration::from_millis(5);
const LATE_STEPS: u32 = 4;
