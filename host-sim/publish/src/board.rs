//! The batches of a machine side by side: of what changes in one, the messages that tell it.

use std::collections::BTreeMap;

use crate::message::{AlarmMessage, BatchState, Cleared, Head, Part, PartMessage, Raised, StateMessage, Status};
use crate::summary::Summary;

/// Which parts of a summary are told that were not there before.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Parts {
    /// All.
    New,
    /// None: they were there before somebody followed.
    Known,
}

/// What is to be told.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct News {
    /// How the machine stands, where that changed.
    pub state: Option<StateMessage>,
    /// New parts, and those whose readings changed.
    pub parts: Vec<PartMessage>,
    /// The last part of the batch, for who joins now.
    pub last: Option<PartMessage>,
    /// The alarms, where these changed.
    pub alarms: Option<AlarmMessage>,
}

/// All batches of a machine.
#[derive(Debug)]
pub struct Board {
    machine: String,
    status: Status,
    batches: Vec<Batch>,
    /// The one that changed last.
    newest: usize,
    state: Option<StateMessage>,
    alarms: Option<AlarmMessage>,
}

#[derive(Debug)]
struct Batch {
    name: String,
    state: Option<BatchState>,
    raised: Vec<Raised>,
    told: BTreeMap<u32, Part>,
}

impl Board {
    /// Of a machine with batches of these names, of which nothing is known yet.
    pub fn new(machine: &str, status: Status, names: impl IntoIterator<Item = String>) -> Self {
        let batch = |name| Batch { name, state: None, raised: Vec::new(), told: BTreeMap::new() };
        let batches = names.into_iter().map(batch).collect();
        Self { machine: machine.to_owned(), status, batches, newest: 0, state: None, alarms: None }
    }

    /// Whether anything is known of a batch.
    pub fn knows(&self, at: usize) -> bool {
        self.batches.get(at).is_some_and(|batch| batch.state.is_some())
    }

    /// Takes the summary of a batch; `now` is when it was seen.
    pub fn take(&mut self, at: usize, summary: &Summary, parts: Parts, now: &str) -> News {
        let head = Head::new(&self.machine, now);
        let (Some(batch), Some(last)) = (self.batches.get_mut(at), summary.states.last()) else {
            return News::default();
        };
        self.newest = at;
        batch.state = Some(BatchState::of(&batch.name, summary, last));
        let message = |part: &Part| PartMessage { head: head.clone(), batch: batch.name.clone(), part: part.clone() };
        let mut new = Vec::new();
        let mut told = BTreeMap::new();
        for part in summary.states.iter().filter_map(|state| Part::of(summary, state)) {
            if parts == Parts::New && batch.told.get(&part.part) != Some(&part) {
                new.push(message(&part));
            }
            told.insert(part.part, part);
        }
        let last = told.last_key_value().map(|(_, part)| message(part));
        batch.told = told;
        let raised = summary.alarms.iter().map(|alarm| {
            let mut raised = Raised::of(&batch.name, alarm, now);
            if let Some(before) = batch.raised.iter().find(|before| before.key == raised.key) {
                raised.since.clone_from(&before.since);
            }
            raised
        });
        batch.raised = raised.collect();
        News { state: self.state(&head), parts: new, last, alarms: self.alarms(&head) }
    }

    /// The state, where it is another than the last one.
    fn state(&mut self, head: &Head) -> Option<StateMessage> {
        let states = self.batches.iter().enumerate();
        let (newest, others): (Vec<_>, Vec<_>) =
            states.filter_map(|(at, batch)| Some((at, batch.state.clone()?))).partition(|(at, _)| *at == self.newest);
        let mut message = StateMessage {
            // As before, so that the time alone makes no other message.
            head: self.state.as_ref().map_or_else(|| head.clone(), |before| before.head.clone()),
            status: self.status,
            software_version: env!("CARGO_PKG_VERSION"),
            alarms: self.batches.iter().map(|batch| batch.raised.len()).sum(),
            batch: newest.into_iter().next()?.1,
            others: others.into_iter().map(|(_, state)| state).collect(),
        };
        if self.state.as_ref() == Some(&message) {
            return None;
        }
        message.head = head.clone();
        self.state.insert(message).clone().into()
    }

    /// The alarms, where they are others than the last ones.
    fn alarms(&mut self, head: &Head) -> Option<AlarmMessage> {
        let raised: Vec<Raised> = self.batches.iter().flat_map(|batch| batch.raised.iter().cloned()).collect();
        let before = self.alarms.as_ref().map(|message| &message.raised);
        if before == Some(&raised) {
            return None;
        }
        let is_raised = |key: &str| raised.iter().any(|one| one.key == key);
        let gone = before.into_iter().flatten().filter(|one| !is_raised(&one.key));
        let cleared = gone.map(|one| Cleared { key: one.key.clone(), text: one.text.clone() }).collect();
        self.alarms.insert(AlarmMessage { head: head.clone(), raised, cleared }).clone().into()
    }
}
