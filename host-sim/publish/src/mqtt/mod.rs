//! A broker of MQTT, near or away.
//!
//! A thread of its own connects, sends what waits in the [`outbox`], and connects again when the connection breaks, at most
//! every half minute. Whoever puts a message in never waits for it. Every connection begins anew (clean session), with the
//! same client identifier, so that the will of one that hangs comes before the state of the next.

pub mod address;
pub mod outbox;
mod trust;

use std::io;
use std::pin::pin;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, Sender, channel};
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::{Duration, Instant};

use rumqttc::{
    AsyncClient, ConnectionError, Event, LastWill, MqttOptions, Outgoing, Packet, QoS, TlsConfiguration, Transport,
};
use rustls::ClientConfig;
use tokio::sync::Notify;

use self::address::{Address, Login};
use self::outbox::{Counts, Message, Outbox};
use crate::machine::{Machine, Topic};
use crate::message::SCHEMA;

pub use self::trust::trust;

/// Waited before the first repetition; twice as long before each further one.
const FIRST: Duration = Duration::from_millis(500);
/// Waited at most.
const LONGEST: Duration = Duration::from_secs(30);
/// A connection that stood as long was a good one.
const GOOD: Duration = Duration::from_secs(10);
/// How often the broker is to hear of a connection on which nothing happens.
const KEEP_ALIVE: Duration = Duration::from_secs(15);
/// Bytes of a packet at most.
const PACKET: usize = 1 << 20;

/// How a broker is reached.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Where it is.
    pub address: Address,
    /// Who one is.
    pub login: Option<Login>,
    /// Whose certificates are believed, for TLS.
    pub trust: Option<Arc<ClientConfig>>,
}

/// What happened.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Note {
    /// There is a connection; so many parts were dropped before it.
    Connected {
        /// All that were dropped until now.
        dropped: u64,
    },
    /// There is none; why.
    Away(String),
}

/// A broker.
#[derive(Debug)]
pub struct Broker {
    shared: Arc<Shared>,
    ended: Receiver<()>,
    offline: Option<Message>,
}

#[derive(Debug)]
struct Shared {
    outbox: Mutex<Outbox>,
    /// Something to do.
    changed: Notify,
    connected: AtomicBool,
    /// Everything goes out, then the connection ends.
    ending: AtomicBool,
    /// Nobody is interested any more.
    left: AtomicBool,
}

impl Shared {
    fn new(most: usize) -> Self {
        let (outbox, changed) = (Mutex::new(Outbox::new(most)), Notify::new());
        let [connected, ending, left] = [false; 3].map(AtomicBool::new);
        Self { outbox, changed, connected, ending, left }
    }
    fn outbox(&self) -> MutexGuard<'_, Outbox> {
        self.outbox.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Broker {
    /// Begins to connect. Who `follows` leaves a will, and its last message says that it has gone.
    ///
    /// # Errors
    /// The system gives no thread.
    pub fn start(settings: &Settings, machine: &Machine, follows: bool, notes: Sender<Note>) -> io::Result<Self> {
        let shared = Arc::new(Shared::new(if follows { outbox::MOST } else { usize::MAX }));
        let offline = serde_json::json!({ "schema": SCHEMA, "machine": machine.name(), "status": "offline" });
        let offline = Message { topic: Topic::State, payload: offline.to_string().into_bytes() };
        let options = options(settings, machine, follows.then_some(&offline));
        let runtime = tokio::runtime::Builder::new_current_thread().enable_all().build()?;
        let (done, ended) = channel();
        let link = Link { options, machine: machine.clone(), follows, shared: Arc::clone(&shared), notes };
        std::thread::Builder::new().name("mqtt".to_owned()).spawn(move || {
            runtime.block_on(link.run());
            drop(done);
        })?;
        Ok(Self { shared, ended, offline: follows.then_some(offline) })
    }

    /// Puts a message in.
    pub fn put(&self, message: Message) {
        self.shared.outbox().put(message);
        self.shared.changed.notify_one();
    }

    /// Whether there is a connection now.
    pub fn is_connected(&self) -> bool {
        self.shared.connected.load(Ordering::SeqCst)
    }

    /// Sends what waits, then that nobody follows any more, and ends the connection. Whether all was acknowledged, and how
    /// much. It takes so long at most; where nothing was followed, so long without an acknowledgement.
    pub fn close(self, within: Duration) -> (bool, Counts) {
        if let Some(offline) = &self.offline {
            self.put(offline.clone());
        }
        self.shared.ending.store(true, Ordering::SeqCst);
        self.shared.changed.notify_one();
        // Of a broker that is away one that follows takes leave at once.
        if self.offline.is_none() || self.is_connected() {
            self.wait(within);
        }
        let outbox = self.shared.outbox();
        (outbox.is_empty(), outbox.counts())
    }

    fn wait(&self, within: Duration) {
        let (mut begin, mut before) = (Instant::now(), self.counts());
        while begin.elapsed() < within {
            if self.ended.recv_timeout(Duration::from_millis(50)) == Err(RecvTimeoutError::Disconnected) {
                return;
            }
            let counts = self.counts();
            if self.offline.is_none() && counts != before {
                (begin, before) = (Instant::now(), counts);
            }
        }
    }

    fn counts(&self) -> Counts {
        self.shared.outbox().counts()
    }
}

impl Drop for Broker {
    fn drop(&mut self) {
        self.shared.left.store(true, Ordering::SeqCst);
        self.shared.changed.notify_one();
    }
}

/// What every connection is made with.
fn options(settings: &Settings, machine: &Machine, will: Option<&Message>) -> MqttOptions {
    let Settings { address, login, trust } = settings;
    // Another one than that of who follows the same machine: a broker ends the older of two connections with one identifier.
    let identifier = format!("truepath-{}{}", machine.name(), if will.is_some() { "" } else { "-once" });
    let mut options = MqttOptions::new(identifier, &address.host, address.port);
    options.set_keep_alive(KEEP_ALIVE).set_clean_session(true).set_max_packet_size(PACKET, PACKET);
    if let Some(Login { user, password }) = login {
        options.set_credentials(user, password);
    }
    if let Some(trust) = trust.as_ref().filter(|_| address.tls) {
        options.set_transport(Transport::tls_with_config(TlsConfiguration::Rustls(Arc::clone(trust))));
    }
    if let Some(will) = will {
        options.set_last_will(LastWill::new(machine.topic(will.topic), will.payload.clone(), QoS::AtLeastOnce, true));
    }
    options
}

/// The side of the thread.
struct Link {
    options: MqttOptions,
    machine: Machine,
    follows: bool,
    shared: Arc<Shared>,
    notes: Sender<Note>,
}

/// Why a connection ended.
enum Ended {
    /// All is sent and leave taken.
    Farewell,
    /// Nobody is interested any more.
    Left,
    Broken(ConnectionError),
}

impl Link {
    async fn run(self) {
        let mut wait = FIRST;
        let mut said = None;
        loop {
            let begin = Instant::now();
            let ended = self.connection(&mut said).await;
            self.shared.connected.store(false, Ordering::SeqCst);
            let Ended::Broken(why) = ended else { return };
            let refused = matches!(why, ConnectionError::ConnectionRefused(_));
            let text = match why {
                ConnectionError::ConnectionRefused(code) => format!("it refuses the connection: {code:?}"),
                other => other.to_string(),
            };
            if said.as_ref() != Some(&text) {
                let _ = self.notes.send(Note::Away(text.clone()));
            }
            said = Some(text);
            if refused && !self.follows {
                return;
            }
            if begin.elapsed() > GOOD {
                wait = FIRST;
            }
            tokio::time::sleep(wait).await;
            if self.shared.left.load(Ordering::SeqCst) {
                return;
            }
            wait = (2 * wait).min(LONGEST);
        }
    }

    /// One connection from its beginning to its end.
    async fn connection(&self, said: &mut Option<String>) -> Ended {
        let (client, mut events) = AsyncClient::new(self.options.clone(), 4);
        events.network_options.set_tcp_nodelay(true);
        let (mut connected, mut farewell) = (false, false);
        loop {
            let event = {
                // Polled again, never given up: a packet that is half written has to be written.
                let mut poll = pin!(events.poll());
                loop {
                    if self.shared.left.load(Ordering::SeqCst) && !self.shared.ending.load(Ordering::SeqCst) {
                        return Ended::Left;
                    }
                    if connected && !farewell {
                        farewell = self.send(&client);
                    }
                    tokio::select! {
                        event = poll.as_mut() => break event,
                        () = self.shared.changed.notified() => (),
                    }
                }
            };
            match event {
                Ok(Event::Incoming(Packet::ConnAck(_))) => {
                    connected = true;
                    *said = None;
                    let mut outbox = self.shared.outbox();
                    outbox.connected();
                    self.shared.connected.store(true, Ordering::SeqCst);
                    let _ = self.notes.send(Note::Connected { dropped: outbox.counts().dropped });
                }
                Ok(Event::Incoming(Packet::PubAck(_))) => self.shared.outbox().acknowledged(),
                Ok(Event::Outgoing(Outgoing::Disconnect)) => return Ended::Farewell,
                Ok(_) => (),
                Err(_) if farewell => return Ended::Farewell,
                Err(error) => return Ended::Broken(error),
            }
        }
    }

    /// Hands on what waits; whether that was the farewell.
    fn send(&self, client: &AsyncClient) -> bool {
        let mut outbox = self.shared.outbox();
        if let Some(message) = outbox.take_next() {
            let topic = self.machine.topic(message.topic);
            // There is room, as one is on its way at a time, and a name of a machine makes a topic.
            let _ = client.try_publish(topic, QoS::AtLeastOnce, message.is_retained(), message.payload);
        }
        let done = self.shared.ending.load(Ordering::SeqCst) && outbox.is_empty();
        done && client.try_disconnect().is_ok()
    }
}
