//! An adapter of MTConnect: a server of lines, to which agents connect.
//!
//! Every client has a queue and two threads, one that writes and one that answers `* PING`. A client whose queue is full, or
//! that takes nothing for so long, is let go: it comes again and begins with the current values.

mod items;
mod shdr;

use std::collections::BTreeMap;
use std::io::{self, Read, Write};
use std::net::{Shutdown, SocketAddr, TcpListener, TcpStream, ToSocketAddrs};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, Sender, SyncSender, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError, Weak};
use std::thread::Builder;
use std::time::{Duration, Instant};

use crate::board::News;
use crate::clock;
use crate::message::AlarmMessage;

use self::items::{ALARM, AVAILABLE, UNAVAILABLE, Values};

/// Clients at a time.
const MOST: usize = 8;
/// Messages that wait for a client at most.
const QUEUE: usize = 256;
/// A client that takes nothing for so long is let go.
const PATIENCE: Duration = Duration::from_secs(5);
/// How often an agent is to ask whether somebody is there.
const HEARTBEAT: Duration = Duration::from_secs(10);
/// What an agent says is short.
const LINE: usize = 256;

/// Lines for a client; nothing ends the connection.
type Queue = SyncSender<Option<Arc<str>>>;

/// An address; a port alone is one that only this computer reaches.
pub fn address(text: &str) -> String {
    if text.parse::<u16>().is_ok() { format!("127.0.0.1:{text}") } else { text.to_owned() }
}

/// Whether other computers can reach an address.
pub fn is_exposed(address: &str) -> bool {
    address.to_socket_addrs().is_ok_and(|mut all| all.any(|one| !one.ip().is_loopback()))
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Note {
    /// A client is there.
    Came(SocketAddr),
    /// There are too many already.
    TooMany(SocketAddr),
    /// A client took too little.
    TooSlow(SocketAddr),
}

/// The adapter.
#[derive(Debug)]
pub struct Adapter {
    address: SocketAddr,
    shared: Arc<Shared>,
}

#[derive(Debug)]
struct Shared {
    now: Mutex<Now>,
    notes: Mutex<Sender<Note>>,
    ending: AtomicBool,
}

/// The current values, and who is told of changes.
#[derive(Debug, Default)]
struct Now {
    values: BTreeMap<&'static str, String>,
    alarms: Option<AlarmMessage>,
    clients: Vec<Client>,
}

#[derive(Debug)]
struct Client {
    address: SocketAddr,
    stream: TcpStream,
    queue: Queue,
    /// Both threads hold it as long as they run.
    lives: Arc<()>,
}

impl Shared {
    fn now(&self) -> MutexGuard<'_, Now> {
        self.now.lock().unwrap_or_else(PoisonError::into_inner)
    }
    fn note(&self, note: Note) {
        let _ = self.notes.lock().unwrap_or_else(PoisonError::into_inner).send(note);
    }
}

impl Adapter {
    /// Begins to wait for clients.
    ///
    /// # Errors
    /// The address is none of this computer, or taken.
    pub fn start(address: &str, notes: Sender<Note>) -> io::Result<Self> {
        let listener = TcpListener::bind(address)?;
        let address = listener.local_addr()?;
        let mut values: BTreeMap<_, _> = items::all().map(|item| (item, UNAVAILABLE.to_owned())).collect();
        values.insert(AVAILABLE, "AVAILABLE".to_owned());
        let now = Now { values, ..Now::default() };
        let shared =
            Arc::new(Shared { now: Mutex::new(now), notes: Mutex::new(notes), ending: AtomicBool::new(false) });
        let of_thread = Arc::clone(&shared);
        Builder::new().name("mtconnect".to_owned()).spawn(move || accept(&listener, &of_thread))?;
        Ok(Self { address, shared })
    }

    /// Where clients find it.
    pub const fn address(&self) -> SocketAddr {
        self.address
    }

    /// How many clients there are.
    pub fn clients(&self) -> usize {
        self.shared.now().clients.len()
    }

    /// Tells what is new, all of it at once: a client has room for so many news, not for so many parts.
    pub fn tell(&self, News { state, parts, last, alarms }: &News) {
        let mut now = self.shared.now();
        let mut lines = String::new();
        if let Some(message) = alarms {
            lines += &items::changes(now.alarms.as_ref(), message);
            now.alarms = Some(message.clone());
        }
        for message in parts.iter().chain(last) {
            lines += &now.changed(message.head.time(), items::of_part(message));
        }
        if let Some(message) = state {
            lines += &now.changed(message.head.time(), items::of_state(message));
        }
        if !lines.is_empty() {
            now.send(lines, &self.shared);
        }
    }

    /// Says that nothing is known any more and lets all clients go, which may take so long.
    pub fn close(self, within: Duration) {
        let begin = Instant::now();
        let lives: Vec<Arc<()>> = {
            let mut now = self.shared.now();
            let time = clock::now();
            let lines = shdr::values(&time, items::all().map(|item| (item, UNAVAILABLE)))
                + &shdr::condition(&time, ALARM, UNAVAILABLE, "", "", "");
            now.send(lines, &self.shared);
            now.clients
                .drain(..)
                .filter(|client| client.queue.try_send(None).is_ok())
                .map(|client| client.lives)
                .collect()
        };
        while lives.iter().any(|lives| Arc::strong_count(lives) > 1) && begin.elapsed() < within {
            std::thread::sleep(Duration::from_millis(5));
        }
    }
}

impl Drop for Adapter {
    fn drop(&mut self) {
        self.shared.ending.store(true, Ordering::SeqCst);
        self.shared.now().clients.drain(..).for_each(|client| drop(client.stream.shutdown(Shutdown::Both)));
        // Who waits for clients sees it when one comes.
        drop(TcpStream::connect_timeout(&self.address, Duration::from_millis(200)));
    }
}

impl Now {
    /// Takes values; a line with those that are new, if any is.
    fn changed(&mut self, time: &str, values: Values) -> String {
        let new: Values = values.into_iter().filter(|(item, value)| self.values.get(item) != Some(value)).collect();
        if new.is_empty() {
            return String::new();
        }
        let line = shdr::values(time, new.iter().map(|(item, value)| (*item, value.as_str())));
        self.values.extend(new);
        line
    }

    /// Sends lines to everybody, and lets those go whose queue is full.
    fn send(&mut self, lines: String, shared: &Shared) {
        let lines: Arc<str> = lines.into();
        self.clients.retain(|client| {
            let sent = client.queue.try_send(Some(Arc::clone(&lines)));
            if let Err(TrySendError::Full(_)) = sent {
                shared.note(Note::TooSlow(client.address));
                let _ = client.stream.shutdown(Shutdown::Both);
            }
            sent.is_ok()
        });
    }

    /// All that a new client has to know.
    fn whole(&self) -> String {
        let time = clock::now();
        let values = items::all().filter_map(|item| Some((item, self.values.get(item)?.as_str())));
        let alarms = self.alarms.as_ref().map(items::conditions);
        let unknown = || shdr::condition(&time, ALARM, UNAVAILABLE, "", "", "");
        shdr::values(&time, values) + &alarms.unwrap_or_else(unknown)
    }
}

fn accept(listener: &TcpListener, shared: &Arc<Shared>) {
    for stream in listener.incoming() {
        if shared.ending.load(Ordering::SeqCst) {
            return;
        }
        match stream.and_then(|stream| welcome(stream, shared)) {
            Ok(()) => (),
            // Not to take all of a processor while none can be had.
            Err(_) => std::thread::sleep(Duration::from_millis(50)),
        }
    }
}

/// Takes a client: it gets the current values, then what changes.
fn welcome(stream: TcpStream, shared: &Arc<Shared>) -> io::Result<()> {
    let address = stream.peer_addr()?;
    stream.set_nodelay(true)?;
    stream.set_write_timeout(Some(PATIENCE))?;
    stream.set_read_timeout(Some(3 * HEARTBEAT))?;
    let (queue, lines) = sync_channel(QUEUE);
    let lives = Arc::new(());
    let mut now = shared.now();
    if now.clients.len() == MOST {
        shared.note(Note::TooMany(address));
        return stream.shutdown(Shutdown::Both);
    }
    // The queue is new.
    let _ = queue.try_send(Some(now.whole().into()));
    let (writing, reading, answers) = (stream.try_clone()?, stream.try_clone()?, queue.clone());
    let (one, other) = (Arc::clone(&lives), Arc::clone(&lives));
    let weak = Arc::downgrade(shared);
    let of_writer = Weak::clone(&weak);
    Builder::new().name("mtconnect-write".to_owned()).spawn(move || {
        if let (false, Some(shared)) = (write(writing, &lines), of_writer.upgrade()) {
            shared.note(Note::TooSlow(address));
        }
        drop(one);
    })?;
    Builder::new().name("mtconnect-read".to_owned()).spawn(move || {
        read(reading, &answers);
        drop((answers, other));
        // Who has gone is no client any more.
        if let Some(shared) = weak.upgrade() {
            shared.now().clients.retain(|client| client.address != address);
        }
    })?;
    now.clients.push(Client { address, stream, queue, lives });
    shared.note(Note::Came(address));
    Ok(())
}

/// Writes what waits, until there is to be an end; not true where the client takes nothing.
fn write(mut stream: TcpStream, lines: &Receiver<Option<Arc<str>>>) -> bool {
    let mut patient = true;
    for text in lines.iter().map_while(|lines| lines) {
        if let Err(error) = stream.write_all(text.as_bytes()) {
            patient = !is_timeout(&error);
            break;
        }
    }
    let _ = stream.shutdown(Shutdown::Both);
    patient
}

fn is_timeout(error: &io::Error) -> bool {
    matches!(error.kind(), io::ErrorKind::WouldBlock | io::ErrorKind::TimedOut)
}

/// Answers what a client asks, until it goes. One that has asked before and is silent for so long has gone without a word.
fn read(mut stream: TcpStream, answers: &Queue) {
    let answer: Arc<str> = format!("* PONG {}\n", HEARTBEAT.as_millis()).into();
    let (mut line, mut bytes, mut asked) = (Vec::new(), [0; LINE], false);
    loop {
        let count = match stream.read(&mut bytes) {
            Ok(0) => break,
            Ok(count) => count,
            Err(error) if is_timeout(&error) && !asked || error.kind() == io::ErrorKind::Interrupted => continue,
            Err(_) => break,
        };
        for &byte in &bytes[..count] {
            if byte != b'\n' {
                line.push(byte);
                continue;
            }
            if line.trim_ascii() == b"* PING" {
                asked = true;
                if answers.try_send(Some(Arc::clone(&answer))).is_err() {
                    let _ = stream.shutdown(Shutdown::Both);
                    return;
                }
            }
            line.clear();
        }
        if line.len() > LINE {
            break;
        }
    }
    let _ = stream.shutdown(Shutdown::Both);
}
