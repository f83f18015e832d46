//! A board that takes whole batches, with a clock that only the batch moves: in process, or in shared memory.

use std::io;
use std::time::{Duration, Instant};

use super::board::{Board, Clients, Event, Exchange};
use super::client::Client;
use super::error::BenchError;
use super::records::{Channel, Records, write, write_event};
use super::wire::{Arrival, Wire};

/// Takes a batch of records and gives those that come back.
pub trait Bulk {
    /// What it is, for the report.
    fn describe(&self) -> String;
    /// Runs one batch; `input` is at most [`BATCH_BYTES`] long.
    ///
    /// # Errors
    /// It does not come to an end.
    fn run(&mut self, input: &[u8]) -> Result<Vec<u8>, BenchError>;
}

/// Most bytes of a batch: the answers, which are longer than the frames, have to fit into 4 MiB as well.
pub const BATCH_BYTES: usize = 2 << 20;

/// A board behind a [`Bulk`].
#[derive(Debug)]
pub struct BulkBoard<B> {
    wire: BulkWire<B>,
    clients: Clients,
}

/// The configuration link as a stream.
#[derive(Debug)]
struct BulkWire<B> {
    bulk: B,
    arrived: Vec<u8>,
}

impl<B: Bulk> BulkBoard<B> {
    /// A board.
    pub fn new(bulk: B) -> Self {
        Self { wire: BulkWire { bulk, arrived: vec![] }, clients: Clients::default() }
    }
}

impl<B: Bulk> Wire for BulkWire<B> {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut batch = vec![];
        write(Channel::Config, bytes, &mut batch);
        let back = self.bulk.run(&batch).map_err(io::Error::other)?;
        for record in Records::new(&back).filter(|record| record.channel == Channel::Config) {
            self.arrived.extend_from_slice(record.bytes);
        }
        Ok(())
    }
    fn receive(&mut self, _within: Duration) -> io::Result<Option<Arrival>> {
        // All that comes back from a batch is there when it ends.
        let bytes = std::mem::take(&mut self.arrived);
        Ok((!bytes.is_empty()).then(|| Arrival { at: Instant::now(), bytes }))
    }
}

impl<B: Bulk> Board for BulkBoard<B> {
    fn describe(&self) -> String {
        self.wire.bulk.describe()
    }
    fn is_stepped(&self) -> bool {
        true
    }
    fn client(&mut self) -> Client<&mut dyn Wire> {
        self.clients.client(&mut self.wire)
    }
    fn clients(&mut self) -> &mut Clients {
        &mut self.clients
    }

    fn exchange(&mut self, events: &[Event]) -> Result<Exchange, BenchError> {
        let mut exchange = Exchange::default();
        let mut batch = vec![];
        let mut events = events.iter().peekable();
        while let Some(event) = events.next() {
            write_event(event, &mut batch);
            if events.peek().is_some() && batch.len() < BATCH_BYTES - (1 << 16) {
                continue;
            }
            let back = self.wire.bulk.run(&batch)?;
            for record in Records::new(&back) {
                match record.channel {
                    Channel::Setpoint => exchange.answers.extend_from_slice(record.bytes),
                    Channel::Config => exchange.replies.extend_from_slice(record.bytes),
                    Channel::Time => {}
                }
            }
            batch.clear();
        }
        Ok(exchange)
    }
}
