//! What waits for the broker.
//!
//! Of state and alarms only the newest counts; parts wait in a queue of so many, and where it is full the oldest is dropped
//! and counted. One message is on its way at a time, the next behind its acknowledgement, so that nothing is lost or
//! overtaken when a connection breaks; a message whose acknowledgement got lost comes twice (QoS 1).

use std::collections::VecDeque;

use crate::machine::Topic;

/// Parts that wait at most for a broker that is away.
pub const MOST: usize = 1000;

/// A message without its topic's text.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// Where it goes.
    pub topic: Topic,
    /// What it says.
    pub payload: Vec<u8>,
}

impl Message {
    /// Whether the broker keeps it for those who come later.
    pub fn is_retained(&self) -> bool {
        self.topic != Topic::Part
    }
}

/// Messages that the broker acknowledged, and parts that were dropped.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, serde::Serialize)]
pub struct Counts {
    /// States.
    pub states: u64,
    /// Parts.
    pub parts: u64,
    /// Sets of alarms.
    pub alarms: u64,
    /// Parts that nobody will hear of.
    pub dropped: u64,
}

/// What waits.
#[derive(Debug)]
pub struct Outbox {
    /// Parts that wait at most.
    most: usize,
    state: Retained,
    alarms: Retained,
    parts: VecDeque<Vec<u8>>,
    on_its_way: Option<Message>,
    counts: Counts,
}

/// The newest of its kind, and whether the broker has it.
#[derive(Debug, Default)]
struct Retained {
    newest: Option<Vec<u8>>,
    waits: bool,
}

impl Outbox {
    /// One in which so many parts have room.
    pub fn new(most: usize) -> Self {
        let (state, alarms) = (Retained::default(), Retained::default());
        Self { most, state, alarms, parts: VecDeque::new(), on_its_way: None, counts: Counts::default() }
    }

    /// Puts a message in.
    pub fn put(&mut self, message: Message) {
        let retained = match message.topic {
            Topic::State => &mut self.state,
            Topic::Alarm => &mut self.alarms,
            Topic::Part => {
                self.parts.push_back(message.payload);
                self.bound();
                return;
            }
        };
        *retained = Retained { newest: Some(message.payload), waits: true };
    }

    fn bound(&mut self) {
        while self.parts.len() > self.most {
            self.parts.pop_front();
            self.counts.dropped += 1;
        }
    }

    /// The next message, where none is on its way. Parts come before the state that counts them.
    pub fn take_next(&mut self) -> Option<Message> {
        if self.on_its_way.is_some() {
            return None;
        }
        let kept = |retained: &mut Retained, topic| {
            let payload = retained.newest.clone().filter(|_| retained.waits)?;
            retained.waits = false;
            Some(Message { topic, payload })
        };
        let next = kept(&mut self.alarms, Topic::Alarm)
            .or_else(|| Some(Message { topic: Topic::Part, payload: self.parts.pop_front()? }))
            .or_else(|| kept(&mut self.state, Topic::State));
        self.on_its_way.clone_from(&next);
        next
    }

    /// The broker has what was on its way.
    pub fn acknowledged(&mut self) {
        match self.on_its_way.take().map(|message| message.topic) {
            Some(Topic::State) => self.counts.states += 1,
            Some(Topic::Alarm) => self.counts.alarms += 1,
            Some(Topic::Part) => self.counts.parts += 1,
            None => (),
        }
    }

    /// A new connection: what was on its way waits again, and what the broker should keep as well, as it may be a new one.
    pub fn connected(&mut self) {
        if let Some(Message { topic: Topic::Part, payload }) = self.on_its_way.take() {
            self.parts.push_front(payload);
            self.bound();
        }
        for retained in [&mut self.state, &mut self.alarms] {
            retained.waits = retained.newest.is_some();
        }
    }

    /// Whether the broker has everything.
    pub fn is_empty(&self) -> bool {
        self.on_its_way.is_none() && self.parts.is_empty() && !self.state.waits && !self.alarms.waits
    }

    /// What became of the messages.
    pub fn counts(&self) -> Counts {
        self.counts
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn message(topic: Topic, payload: &str) -> Message {
        Message { topic, payload: payload.as_bytes().to_vec() }
    }

    /// Everything that is sent over a connection that stands.
    fn drained(outbox: &mut Outbox) -> Vec<String> {
        let mut all = Vec::new();
        while let Some(next) = outbox.take_next() {
            assert_eq!(outbox.take_next(), None, "two on their way");
            all.push(String::from_utf8(next.payload).expect("text"));
            outbox.acknowledged();
        }
        all
    }

    #[test]
    fn of_states_only_the_newest_waits_and_parts_keep_their_order() {
        let mut outbox = Outbox::new(MOST);
        for (topic, payload) in
            [(Topic::State, "s1"), (Topic::Part, "p1"), (Topic::State, "s2"), (Topic::Part, "p2"), (Topic::Alarm, "a")]
        {
            outbox.put(message(topic, payload));
        }
        assert_eq!(drained(&mut outbox), ["a", "p1", "p2", "s2"]);
        assert!(outbox.is_empty());
        assert_eq!(outbox.counts(), Counts { states: 1, parts: 2, alarms: 1, dropped: 0 });
    }

    #[test]
    fn a_broken_connection_loses_nothing_and_a_new_broker_gets_what_it_should_keep() {
        let mut outbox = Outbox::new(MOST);
        outbox.put(message(Topic::State, "s"));
        outbox.put(message(Topic::Part, "p1"));
        outbox.put(message(Topic::Part, "p2"));
        assert_eq!(outbox.take_next(), Some(message(Topic::Part, "p1")));
        assert!(!outbox.is_empty());
        outbox.connected();
        assert_eq!(drained(&mut outbox), ["p1", "p2", "s"]);
        outbox.connected();
        assert_eq!(drained(&mut outbox), ["s"]);
    }

    #[test]
    fn a_full_queue_drops_the_oldest_and_counts_them() {
        let mut outbox = Outbox::new(MOST);
        for part in 0..MOST + 7 {
            outbox.put(message(Topic::Part, &part.to_string()));
        }
        let sent = drained(&mut outbox);
        assert_eq!((sent.len(), sent[0].as_str(), outbox.counts().dropped), (MOST, "7", 7));
    }
}
