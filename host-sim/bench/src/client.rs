//! Client of the configuration link: requests with an id, time-out and retry, uploads that resume.
//!
//! A request that gets no answer is sent again with the same id; the device then answers again without carrying it
//! out twice. Whatever arrives that is not the answer to the present request (an answer to an earlier copy, a damaged
//! frame) is passed over.

use std::time::{Duration, Instant};

use truepath_core::checksum::crc32;
use truepath_core::image::Role;
use truepath_core::link::{
    AccessError, Ask, CHUNK_BYTES, Denial, DeviceKeys, DeviceSession, DeviceSettings, DeviceStatus, Item, LinkError,
    LogEntry, PACKET_BYTES, Reply, Request, Response, SessionEnd, Slot, Timing, decode, encode_request,
};

use super::access::Access;
use super::error::BenchError;
use super::wire::Wire;

/// A client.
#[derive(Debug)]
pub struct Client<W> {
    wire: W,
    /// The next id.
    id: u16,
    patience: Duration,
    attempts: u32,
    /// What arrived behind the last delimiter.
    pending: Vec<u8>,
    /// The last answer, decoded in place.
    answer: Vec<u8>,
    /// Requests that had to be sent again.
    retries: u64,
    access: Option<Access>,
}

/// An item that arrived and was checked.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Committed {
    /// Slot of an image; 0 for other items.
    pub slot: u8,
    /// Its checksum.
    pub crc: u32,
}

/// Time for the answer to a request before it is sent again: the longest erase of a sector of the flash (STM32H743).
const PATIENCE: Duration = Duration::from_secs(4);
/// How often a request is sent. `Begin` erases three sectors.
const ATTEMPTS: u32 = 4;

impl<W: Wire> Client<W> {
    /// A client on a wire. Its ids begin at `first_id`, best at random, so that those of an earlier client are not
    /// taken for its own.
    pub fn new(wire: W, first_id: u16) -> Self {
        Self {
            wire,
            id: first_id,
            patience: PATIENCE,
            attempts: ATTEMPTS,
            pending: vec![],
            answer: vec![],
            retries: 0,
            access: None,
        }
    }
    /// The same with another time for an answer and another number of attempts.
    #[must_use]
    pub fn with_patience(mut self, patience: Duration, attempts: u32) -> Self {
        (self.patience, self.attempts) = (patience, attempts);
        self
    }
    /// The same with a key to log in with where the device asks for it.
    #[must_use]
    pub fn with_access(mut self, access: Option<Access>) -> Self {
        self.access = access;
        self
    }
    /// Requests that had to be sent again.
    pub const fn retries(&self) -> u64 {
        self.retries
    }
    /// The wire.
    pub fn wire(&mut self) -> &mut W {
        &mut self.wire
    }

    /// Sends a request and waits for its answer.
    ///
    /// # Errors
    /// `Silent` without an answer after all attempts, `Denied` as the device says, `Foreign` for an answer that cannot
    /// be read.
    pub fn ask(&mut self, ask: Ask<'_>) -> Result<Reply<'_>, BenchError> {
        self.exchange(ask)?;
        // A session that is forgotten, and then a login.
        for _ in 0..2 {
            let Some(access) = self.access.clone() else { break };
            match self.denied() {
                Some(AccessError::Role { needed }) => self.log_in(&access, needed)?,
                Some(AccessError::Ended { why: SessionEnd::Unknown | SessionEnd::Silence }) => access.set_session(None),
                _ => break,
            }
            self.exchange(ask)?;
        }
        let response: Response<'_> = decode(&mut self.answer).map_err(|e| BenchError::Foreign(e.to_string()))?;
        response.answer.map_err(BenchError::Denied)
    }

    /// Why the last answer lets nobody in, if it is that.
    fn denied(&self) -> Option<AccessError> {
        match decode::<Response<'_>>(&mut self.answer.clone()).ok()?.answer {
            Err(Denial::Access(error)) => Some(error),
            _ => None,
        }
    }

    fn log_in(&mut self, access: &Access, role: Role) -> Result<(), BenchError> {
        let answer = |client: &mut Self, ask: Ask<'_>| {
            client.exchange(ask)?;
            let response: Response<'_> = decode(&mut client.answer).map_err(|e| BenchError::Foreign(e.to_string()))?;
            match response.answer.map_err(BenchError::Denied)? {
                Reply::Challenge { device, nonce, .. } => Ok((device, nonce, 0)),
                Reply::LoggedIn { session } => Ok(([0; 12], [0; 32], session)),
                other => Err(foreign(&other)),
            }
        };
        access.set_session(None);
        let (device, nonce, _) = answer(self, Ask::Challenge)?;
        let (.., session) = answer(self, access.login(role, &device, &nonce))?;
        access.set_session(Some(session));
        self.tell_time()
    }
    /// Ends the session, if there is one.
    pub fn log_out(&mut self) {
        let Some(access) = self.access.take().filter(|access| access.session().is_some()) else { return };
        let session = access.session();
        access.set_session(None);
        // It ends by itself if the device does not answer any more.
        let _ = self.exchange_in(Ask::Logout, session);
    }

    fn exchange(&mut self, ask: Ask<'_>) -> Result<(), BenchError> {
        self.exchange_in(ask, self.access.as_ref().and_then(Access::session))
    }
    /// Sends a request of a session and keeps its answer.
    fn exchange_in(&mut self, ask: Ask<'_>, session: Option<u64>) -> Result<(), BenchError> {
        self.id = self.id.wrapping_add(1);
        let id = self.id;
        let mut packet = [0; PACKET_BYTES + 1];
        // A leading delimiter clears what noise left in the receiver.
        let used = encode_request(&Request { id, ask }, session, &mut packet[1..]);
        let used = used.map_err(|e| BenchError::Foreign(e.to_string()))?;
        let lost = |e: std::io::Error| BenchError::Silent(e.to_string());
        for attempt in 0..self.attempts {
            self.retries += u64::from(attempt > 0);
            self.wire.send(&packet[..=used]).map_err(lost)?;
            if self.answered(id).map_err(lost)? {
                return Ok(());
            }
        }
        Err(BenchError::Silent(format!("no answer to {} in {} attempts", name(&ask), self.attempts)))
    }

    /// Waits for the answer with an id and puts its packet into `self.answer`.
    fn answered(&mut self, id: u16) -> std::io::Result<bool> {
        let until = Instant::now() + self.patience;
        loop {
            while let Some(end) = self.pending.iter().position(|&b| b == 0) {
                let packet: Vec<u8> = self.pending.drain(..=end).collect();
                let found = match decode::<Response<'_>>(&mut packet.clone()) {
                    Ok(response) => Some(response.id),
                    Err(LinkError::Content { id }) => Some(id),
                    Err(_) => None,
                };
                if found == Some(id) {
                    self.answer = packet;
                    return Ok(true);
                }
            }
            let left = until.saturating_duration_since(Instant::now());
            match self.wire.receive(left)? {
                Some(arrival) => self.pending.extend_from_slice(&arrival.bytes),
                None => return Ok(false),
            }
        }
    }

    /// A request that is answered by `Done`.
    ///
    /// # Errors
    /// As [`Client::ask`].
    pub fn done(&mut self, ask: Ask<'_>) -> Result<(), BenchError> {
        match self.ask(ask)? {
            Reply::Done => Ok(()),
            other => Err(foreign(&other)),
        }
    }
    /// Mode, reason, counters.
    ///
    /// # Errors
    /// As [`Client::ask`].
    pub fn status(&mut self) -> Result<DeviceStatus, BenchError> {
        match self.ask(Ask::Status)? {
            Reply::Status(status) => Ok(status),
            other => Err(foreign(&other)),
        }
    }
    /// The settings in use.
    ///
    /// # Errors
    /// As [`Client::ask`].
    pub fn settings(&mut self) -> Result<DeviceSettings, BenchError> {
        match self.ask(Ask::Settings)? {
            Reply::Settings(settings) => Ok(settings),
            other => Err(foreign(&other)),
        }
    }
    /// Whose images the device takes.
    ///
    /// # Errors
    /// As [`Client::ask`].
    pub fn keys(&mut self) -> Result<DeviceKeys, BenchError> {
        match self.ask(Ask::Keys)? {
            Reply::Keys(keys) => Ok(keys),
            other => Err(foreign(&other)),
        }
    }
    /// Tells a device the time, for its log, if it keeps one and takes the time from whoever asks. Logs nobody in.
    ///
    /// # Errors
    /// As [`Client::ask`].
    pub fn tell_time(&mut self) -> Result<(), BenchError> {
        let since_1970 = std::time::UNIX_EPOCH.elapsed().unwrap_or_default();
        self.exchange(Ask::Time { unix_s: u32::try_from(since_1970.as_secs()).unwrap_or(u32::MAX) })
    }
    /// The log of changes from an entry on, oldest first, and the number of the next one.
    ///
    /// # Errors
    /// As [`Client::ask`].
    pub fn log(&mut self, mut from: u32) -> Result<(Vec<LogEntry>, u32), BenchError> {
        let mut all: Vec<LogEntry> = Vec::new();
        loop {
            let (next, entries) = match self.ask(Ask::Log { from })? {
                Reply::Log { next, entries } => (next, entries),
                other => return Err(foreign(&other)),
            };
            // In their order, so that it ends.
            let Some(last) = entries.last().filter(|last| last.sequence >= from && last.sequence < u32::MAX) else {
                all.extend(entries);
                return Ok((all, next));
            };
            from = last.sequence + 1;
            all.extend(entries);
        }
    }
    /// Who is logged in, and what the keys are good for; nothing of a firmware that knows no roles.
    ///
    /// # Errors
    /// As [`Client::ask`].
    pub fn session(&mut self) -> Result<Option<DeviceSession>, BenchError> {
        match self.ask(Ask::Session) {
            Ok(Reply::Session(session)) => Ok(Some(session)),
            Err(BenchError::Denied(Denial::Unknown)) => Ok(None),
            other => Err(foreign(&other?)),
        }
    }
    /// How regularly setpoints arrive and how fast they are answered; nothing of a firmware that does not count it.
    ///
    /// # Errors
    /// As [`Client::ask`].
    pub fn timing(&mut self) -> Result<Option<Timing>, BenchError> {
        match self.ask(Ask::Timing) {
            Ok(Reply::Timing(timing)) => Ok(Some(timing)),
            Err(BenchError::Denied(Denial::Unknown)) => Ok(None),
            other => Err(foreign(&other?)),
        }
    }
    /// Both image slots.
    ///
    /// # Errors
    /// As [`Client::ask`].
    pub fn slots(&mut self) -> Result<[Slot; 2], BenchError> {
        match self.ask(Ask::List)? {
            Reply::Slots(slots) => Ok(slots),
            other => Err(foreign(&other)),
        }
    }

    /// Uploads an item, going on where an interrupted upload of the same item stopped, and has it checked.
    /// `progress` is told the bytes that are there.
    ///
    /// # Errors
    /// As [`Client::ask`].
    pub fn upload(&mut self, item: Item, bytes: &[u8], mut progress: impl FnMut(u64)) -> Result<Committed, BenchError> {
        let length = u32::try_from(bytes.len()).map_err(|_| BenchError::Option {
            found: "more than 4 GiB".into(),
            help: "upload a smaller file".into(),
        })?;
        let mut at = self.next(Ask::Begin { item, length, crc: checksum(item, bytes) })?;
        while at < length {
            progress(at.into());
            let piece = bytes.get(at as usize..).unwrap_or_default();
            let piece = &piece[..piece.len().min(CHUNK_BYTES)];
            let next = match self.next(Ask::Chunk { offset: at, bytes: piece }) {
                // The device knows better where it is: it was reset and has fewer, or has this one already.
                Err(BenchError::Denied(Denial::Offset { expected, .. })) if expected != at => expected,
                other => other?,
            };
            at = next;
        }
        progress(length.into());
        match self.ask(Ask::Commit)? {
            Reply::Committed { slot, crc } => Ok(Committed { slot, crc }),
            other => Err(foreign(&other)),
        }
    }

    fn next(&mut self, ask: Ask<'_>) -> Result<u32, BenchError> {
        match self.ask(ask)? {
            Reply::Next { offset } => Ok(offset),
            other => Err(foreign(&other)),
        }
    }
}

/// The checksum an upload goes by: of an image its name, which is the CRC-32 at its end; of anything else the CRC-32 of
/// all bytes.
fn checksum(item: Item, bytes: &[u8]) -> u32 {
    match (item, bytes.last_chunk()) {
        (Item::Image, Some(name)) => u32::from_le_bytes(*name),
        _ => crc32(bytes),
    }
}

/// An answer of another kind than the request calls for.
pub(super) fn foreign(reply: &Reply<'_>) -> BenchError {
    BenchError::Foreign(format!("{reply:?}"))
}

/// The name of a request, without what it carries.
fn name(ask: &Ask<'_>) -> String {
    let text = format!("{ask:?}");
    text.split(|c: char| !c.is_alphanumeric()).next().unwrap_or_default().to_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_client_is_as_patient_as_the_document_says_and_outlasts_the_longest_request() {
        let document = include_str!("../../../docs/link.md").replace('\n', " ");
        let (again, all) = (PATIENCE.as_secs(), PATIENCE.as_secs() * u64::from(ATTEMPTS));
        for said in [format!("asks again after {again} s"), format!("gives up after {all} s")] {
            assert!(document.contains(&said), "docs/link.md does not say \"{said}\"");
        }
        assert!(document.contains("up to 4 s a sector: `Begin` for an image (one to three sectors)"));
        assert!(all > 3 * 4, "{all} s");
    }
}
