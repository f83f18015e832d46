//! Folders, board, broker and adapter together.

use std::net::SocketAddr;
use std::path::PathBuf;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use serde::Serialize;
use truepath_ground::diagnostics::{Failure, InputError};

use crate::board::{Board, News, Parts};
use crate::clock::now;
use crate::codes::{Q016, Q017};
use crate::follow::{Followed, Looked};
use crate::machine::{Machine, Topic};
use crate::message::Status;
use crate::mqtt::outbox::{Counts, Message};
use crate::mqtt::{self, Broker};
use crate::mtconnect::{self, Adapter};

/// What is published where.
#[derive(Clone, Debug)]
pub struct Settings {
    /// Folders of `truepath batch`.
    pub folders: Vec<PathBuf>,
    /// The machine.
    pub machine: Machine,
    /// The broker.
    pub mqtt: Option<mqtt::Settings>,
    /// Where agents find the adapter.
    pub mtconnect: Option<String>,
    /// Whether the folders are followed; else all of them is sent once.
    pub follow: bool,
}

/// All of it, at work.
#[derive(Debug)]
pub struct Publisher {
    board: Board,
    followed: Vec<Followed>,
    status: Status,
    broker: Option<Broker>,
    adapter: Option<Adapter>,
    of_broker: Receiver<mqtt::Note>,
    of_adapter: Receiver<mtconnect::Note>,
    said_dropped: u64,
    /// Why it was away, the last time.
    away: Option<String>,
    /// Of the first look.
    unreadable: Vec<InputError>,
}

/// Something to say that is no error.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Said {
    /// Worth a warning.
    Warning(String),
    /// As expected.
    Note(String),
}

impl Publisher {
    /// Looks into the folders and begins to connect. Without `follow` every folder has to be readable.
    ///
    /// # Errors
    /// A folder twice, a summary that cannot be read where all have to be, `Q017` for an address that is taken.
    pub fn start(settings: &Settings) -> Result<Self, Failure> {
        let status = if settings.follow { Status::Online } else { Status::Once };
        let followed = Followed::every(&settings.folders)?;
        let names: Vec<String> = followed.iter().map(|one| one.name.clone()).collect();
        let board = Board::new(settings.machine.name(), status, names);
        let (to_broker, of_broker) = channel();
        let (to_adapter, of_adapter) = channel();
        let mut publisher = Self {
            board,
            followed,
            status,
            broker: None,
            adapter: None,
            of_broker,
            of_adapter,
            said_dropped: 0,
            away: None,
            unreadable: Vec::new(),
        };
        let (news, unreadable) = publisher.looked();
        if status == Status::Once
            && let Some(first) = unreadable.first()
        {
            return Err(first.clone().into());
        }
        publisher.unreadable = unreadable;
        if let Some(address) = &settings.mtconnect {
            let adapter = Adapter::start(address, to_adapter).map_err(|e| {
                Q017.error(format!("agents cannot be waited for at {address} ({e})"), "HOST:PORT of this computer")
            })?;
            publisher.adapter = Some(adapter);
        }
        if let Some(mqtt) = &settings.mqtt {
            let broker = Broker::start(mqtt, &settings.machine, settings.follow, to_broker);
            publisher.broker = Some(broker.map_err(|e| Failure::Internal(format!("no thread: {e}")))?);
        }
        news.iter().try_for_each(|news| publisher.tell(news))?;
        Ok(publisher)
    }

    /// Looks into the folders again and hands on what changed; what cannot be read is told, once.
    ///
    /// # Errors
    /// A fault of the program.
    pub fn look(&mut self) -> Result<Vec<InputError>, Failure> {
        let (news, unreadable) = self.looked();
        news.iter().try_for_each(|news| self.tell(news))?;
        let first = std::mem::take(&mut self.unreadable);
        Ok(first.into_iter().chain(unreadable).collect())
    }

    fn looked(&mut self) -> (Vec<News>, Vec<InputError>) {
        let (mut changed, mut unreadable) = (Vec::new(), Vec::new());
        for (at, followed) in self.followed.iter_mut().enumerate() {
            match followed.look() {
                Looked::Same => (),
                Looked::Changed(summary, written) => changed.push((written, at, summary)),
                Looked::Unreadable(error) => unreadable.push(error),
            }
        }
        changed.sort_by_key(|(written, at, _)| (*written, *at));
        let time = now();
        let news = changed.into_iter().map(|(_, at, summary)| {
            // What was there before somebody followed was told then, or is told by who sends all of it once.
            let parts = match self.status {
                Status::Online if !self.board.knows(at) && self.followed[at].was_there_at_start() => Parts::Known,
                _ => Parts::New,
            };
            self.board.take(at, &summary, parts, &time)
        });
        (news.collect(), unreadable)
    }

    fn tell(&self, news: &News) -> Result<(), Failure> {
        if let Some(broker) = &self.broker {
            news.alarms.iter().try_for_each(|message| put(broker, Topic::Alarm, message))?;
            news.parts.iter().try_for_each(|message| put(broker, Topic::Part, message))?;
            news.state.iter().try_for_each(|message| put(broker, Topic::State, message))?;
        }
        self.adapter.iter().for_each(|adapter| adapter.tell(news));
        Ok(())
    }

    /// What there is to say.
    pub fn said(&mut self) -> Vec<Said> {
        let mut said = Vec::new();
        for note in self.of_broker.try_iter() {
            match note {
                mqtt::Note::Connected { dropped } => {
                    said.push(Said::Note("connected to the broker".to_owned()));
                    let new = dropped - std::mem::replace(&mut self.said_dropped, dropped);
                    if new > 0 {
                        said.push(Said::Warning(format!("{new} parts were dropped while the broker was away")));
                    }
                }
                mqtt::Note::Away(why) => {
                    said.push(Said::Warning(format!(
                        "no connection to the broker: {why}; it is tried again and again"
                    )));
                    self.away = Some(why);
                }
            }
        }
        said.extend(self.of_adapter.try_iter().map(|note| match note {
            mtconnect::Note::Came(who) => Said::Note(format!("an agent at {who}")),
            mtconnect::Note::TooMany(who) => {
                Said::Warning(format!("no place for an agent at {who}: there are too many"))
            }
            mtconnect::Note::TooSlow(who) => {
                Said::Warning(format!("the agent at {who} takes too little and was let go"))
            }
        }));
        said
    }

    /// Where agents find the adapter.
    pub fn adapter_address(&self) -> Option<SocketAddr> {
        self.adapter.as_ref().map(Adapter::address)
    }

    /// Says that nobody follows any more, where somebody did, and ends; it may take so long.
    pub fn end(mut self, within: Duration) -> Counts {
        let begin = Instant::now();
        self.adapter.take().into_iter().for_each(|adapter| adapter.close(within / 2));
        let left = within.saturating_sub(begin.elapsed());
        self.broker.take().map_or_else(Counts::default, |broker| broker.close(left).1)
    }

    /// Waits until the broker has everything that was sent once.
    ///
    /// # Errors
    /// `Q016` where it has not within that time.
    pub fn deliver(mut self, within: Duration) -> Result<Counts, InputError> {
        let Some(broker) = self.broker.take() else { return Ok(Counts::default()) };
        let (all, counts) = broker.close(within);
        if all {
            return Ok(counts);
        }
        let _ = self.said();
        let found = self.away.map_or_else(
            || format!("the broker does not acknowledge within {} s", within.as_secs()),
            |why| format!("no connection to the broker: {why}"),
        );
        Err(Q016.error(found, "a broker that takes everything"))
    }
}

fn put(broker: &Broker, topic: Topic, message: &impl Serialize) -> Result<(), Failure> {
    let payload = serde_json::to_vec(message).map_err(|e| Failure::Internal(e.to_string()))?;
    broker.put(Message { topic, payload });
    Ok(())
}
