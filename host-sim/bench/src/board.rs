//! What the bench needs of a board: the configuration link, and setpoints with commands in their order.

use std::sync::Arc;

use super::access::Access;
use super::client::Client;
use super::error::BenchError;
use super::watch::Watch;
use super::wire::Wire;

/// One step of the bench, in the order in which the board gets them.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Event {
    /// So many microseconds pass. A board with a clock of its own waits for its tick instead.
    Time(u32),
    /// Bytes on the setpoint link.
    Setpoint {
        /// The bytes.
        bytes: Vec<u8>,
        /// Answers that are expected to them: 0 or 1, more where a lost delimiter is found.
        answers: u32,
    },
    /// A packet on the configuration link; there is one answer.
    Request(Vec<u8>),
}

/// What came back.
#[derive(Clone, Debug, Default)]
pub struct Exchange {
    /// Bytes of the setpoint link.
    pub answers: Vec<u8>,
    /// Bytes of the configuration link.
    pub replies: Vec<u8>,
    /// Time from the sending of a frame to the arrival of its answer, ns; empty where that means nothing.
    pub round_trips_ns: Vec<u64>,
}

/// Ids between two series of requests.
const IDS: u16 = 4_099;

/// What the clients of a board, one after the other, have in common: ids that do not come twice, and who logs in.
#[derive(Debug, Default)]
pub struct Clients {
    first_id: u16,
    access: Option<Access>,
}

impl Clients {
    /// Their ids begin some way behind this one.
    pub fn from_id(first_id: u16) -> Self {
        Self { first_id, access: None }
    }
    /// The next one, on the wire of the board.
    pub fn client<'w>(&mut self, wire: &'w mut dyn Wire) -> Client<&'w mut dyn Wire> {
        Client::new(wire, self.next_id()).with_access(self.access.clone())
    }
    fn next_id(&mut self) -> u16 {
        self.first_id = self.first_id.wrapping_add(IDS);
        self.first_id
    }
}

/// A board under test.
pub trait Board {
    /// What it is, for the report.
    fn describe(&self) -> String;
    /// Whether its clock is that of the events, so that every run gives the same bytes whatever the machine is doing.
    fn is_stepped(&self) -> bool;
    /// A client of its configuration link.
    fn client(&mut self) -> Client<&mut dyn Wire>;
    /// What its clients have in common.
    fn clients(&mut self) -> &mut Clients;
    /// Logs in with a key from now on, where the device asks for it; or does not any more.
    fn use_access(&mut self, access: Option<Access>) {
        self.clients().access = access;
    }
    /// The number of its session.
    fn session(&mut self) -> Option<u64> {
        self.clients().access.as_ref().and_then(Access::session)
    }
    /// The first id for a new series of requests, far from those of the series before: a device takes a repeated id
    /// for a repeated request.
    fn first_id(&mut self) -> u16 {
        self.clients().next_id()
    }
    /// Tells of every answer from now on, if it knows of them one by one, and ends an exchange when that is asked for.
    fn watched_by(&mut self, _watch: Arc<Watch>) {}
    /// Sends events and collects what comes back, up to what is expected.
    ///
    /// # Errors
    /// The connection is lost. An answer that does not come is no error here: it is missing in what came back.
    fn exchange(&mut self, events: &[Event]) -> Result<Exchange, BenchError>;
}
