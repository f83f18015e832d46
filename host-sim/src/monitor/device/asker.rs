//! The one who asks the device, on a thread of its own, so that a device that does not answer holds up no key.
//!
//! It tries on for as long as somebody looks: after two questions without an answer over a new connection.

use std::ops::ControlFlow;
use std::sync::mpsc::Sender;
use std::time::{Duration, Instant};

use truepath_bench::{BenchError, Client, Wire};
use truepath_core::link::{ActiveImage, Ask, Reply, TraceSample};

use super::model::Message;
use crate::coprocessor::info;

/// Time for an answer.
const PATIENCE: Duration = Duration::from_millis(1_200);
/// Questions without an answer before the connection is made anew.
const MOST_FAILURES: u32 = 2;
/// More replies than the queue of samples of a device fills.
const MOST_REPLIES: usize = 8;

/// What is told to the view.
pub enum Told {
    /// Something to show.
    News(Message),
    /// It cannot be talked to.
    End(BenchError),
}

/// The one who asks.
pub struct Asker<W, R> {
    /// The connection, while there is one.
    pub client: Option<Client<W>>,
    /// Makes a new one.
    pub reopen: R,
    /// Time between two looks.
    pub every: Duration,
    /// The start of the view.
    pub start: Instant,
}

impl<W: Wire, R: FnMut() -> Result<Client<W>, BenchError>> Asker<W, R> {
    /// Asks until nobody listens.
    pub fn run(mut self, tell: &Sender<Told>) {
        let mut failures = 0;
        let mut seen = Seen { fresh: true, ..Seen::default() };
        self.client = self.client.take().map(|client| client.with_patience(PATIENCE, 1));
        loop {
            let due = Instant::now() + self.every;
            let outcome = match &mut self.client {
                Some(client) => look(client, self.start, &mut seen, tell),
                None => (self.reopen)().map(|client| {
                    seen.fresh = true;
                    self.client = Some(client.with_patience(PATIENCE, 1));
                    ControlFlow::Continue(())
                }),
            };
            match outcome {
                Ok(ControlFlow::Break(())) => return,
                Ok(ControlFlow::Continue(())) => failures = 0,
                Err(error @ BenchError::Foreign(_)) if seen.boot.is_none() => {
                    // Firmware of another version stays so.
                    let _ = tell.send(Told::End(error));
                    return;
                }
                Err(error) => {
                    failures += 1;
                    if failures >= MOST_FAILURES {
                        self.client = None;
                    }
                    if tell.send(Told::News(Message::Silent { why: error.to_string() })).is_err() {
                        return;
                    }
                }
            }
            std::thread::sleep(due.saturating_duration_since(Instant::now()));
        }
    }
}

/// What was seen at the look before.
#[derive(Default)]
struct Seen {
    /// Whether the connection is new, so that the samples in the queue are of any age.
    fresh: bool,
    /// Image and uptime; `None` before the first look.
    boot: Option<(Option<ActiveImage>, u64)>,
}

/// One look; breaks when nobody listens.
fn look<W: Wire>(
    client: &mut Client<W>,
    start: Instant,
    seen: &mut Seen,
    tell: &Sender<Told>,
) -> Result<ControlFlow<()>, BenchError> {
    let asked = Instant::now();
    let status = client.status()?;
    let round_trip = asked.elapsed();
    let (dropped, samples) = samples(client)?;
    let timing = client.timing()?.map(Box::new);
    let (dropped, samples) = if seen.fresh { (0, vec![]) } else { (dropped, samples) };
    let at = start.elapsed();
    let changed = seen.boot.is_none_or(|(image, uptime)| image != status.active || status.uptime_us < uptime);
    let known = changed || seen.fresh;
    (seen.fresh, seen.boot) = (false, Some((status.active, status.uptime_us)));
    let look = Message::Look { at, status: Box::new(status), dropped, samples, timing, round_trip };
    if tell.send(Told::News(look)).is_err() {
        return Ok(ControlFlow::Break(()));
    }
    if known {
        let identity = Message::Identity { info: Box::new(info(client)?), slots: client.slots()? };
        if tell.send(Told::News(identity)).is_err() {
            return Ok(ControlFlow::Break(()));
        }
    }
    Ok(ControlFlow::Continue(()))
}

/// All samples since the last time, and how many were dropped.
fn samples<W: Wire>(client: &mut Client<W>) -> Result<(u32, Vec<TraceSample>), BenchError> {
    let (mut lost, mut all) = (0u32, Vec::new());
    for _ in 0..MOST_REPLIES {
        let reply = client.ask(Ask::Trace)?;
        let Reply::Trace { dropped, samples } = reply else {
            return Err(BenchError::Foreign(format!("{reply:?}")));
        };
        lost = lost.saturating_add(dropped);
        all.extend_from_slice(&samples);
        if !samples.is_full() {
            break;
        }
    }
    Ok((lost, all))
}
