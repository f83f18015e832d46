//! The adapter over a real socket.

use std::io::{BufRead, BufReader, Write};
use std::net::TcpStream;
use std::path::Path;
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use truepath_publish::board::{Board, News, Parts};
use truepath_publish::message::Status;
use truepath_publish::mtconnect::{Adapter, Note};
use truepath_publish::summary::Summary;

use crate::support::batches::summary;

const SOON: Duration = Duration::from_secs(10);

fn adapter() -> (Adapter, Receiver<Note>) {
    let (to, notes) = channel();
    (Adapter::start("127.0.0.1:0", to).expect("a port"), notes)
}

/// The news of a batch with these parts behind one that was in order.
fn news(errors: &[f64]) -> News {
    let parsed = |errors: &[f64]| {
        Summary::parse(summary(errors, 0.01).to_string().as_bytes(), Path::new("summary.json")).expect("a summary")
    };
    let mut board = Board::new("vf2", Status::Online, ["corner".to_owned()]);
    board.take(0, &parsed(&[0.0]), Parts::New, "2026-11-27T18:35:00Z");
    board.take(0, &parsed(errors), Parts::New, "2026-11-27T18:35:01Z")
}

struct Agent {
    lines: BufReader<TcpStream>,
}

impl Agent {
    fn of(adapter: &Adapter) -> Self {
        let stream = TcpStream::connect(adapter.address()).expect("a connection");
        stream.set_read_timeout(Some(SOON)).expect("a time");
        Self { lines: BufReader::new(stream) }
    }

    /// The next line; none at the end.
    fn line(&mut self) -> Option<String> {
        let mut line = String::new();
        let count = self.lines.read_line(&mut line).expect("a line in time");
        (count > 0).then(|| line.trim_end().to_owned())
    }

    /// The next line that holds a text.
    fn until(&mut self, text: &str) -> String {
        loop {
            let line = self.line().unwrap_or_else(|| panic!("no {text}"));
            if line.contains(text) {
                return line;
            }
        }
    }

    fn ask(&mut self) {
        self.lines.get_mut().write_all(b"* PING\r\n").expect("written");
    }
}

fn eventually(what: &str, holds: impl Fn() -> bool) {
    let begin = Instant::now();
    while !holds() {
        assert!(begin.elapsed() < SOON, "{what}");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn an_agent_gets_what_is_so_then_what_changes_and_an_answer() {
    let (adapter, _notes) = adapter();
    let mut first = Agent::of(&adapter);
    let begin = first.line().expect("values");
    assert!(begin.contains("|tp_avail|AVAILABLE|") && begin.contains("|tp_last_part|UNAVAILABLE|"), "{begin}");
    assert!(first.line().is_some_and(|line| line.ends_with("|tp_alarm|UNAVAILABLE||||")));
    first.ask();
    assert_eq!(first.line().as_deref(), Some("* PONG 10000"));
    adapter.tell(&news(&[0.0, 0.012]));
    let alarm = first.until("|tp_alarm|FAULT|");
    assert!(
        alarm.starts_with("2026-11-27T18:35:01Z|tp_alarm|FAULT|corner/out_of_tolerance||HIGH|part 2 is out"),
        "{alarm}"
    );
    let part = first.until("|tp_part|");
    assert!(part.contains("|tp_part|2|tp_deviation|0.012") && part.ends_with("|tp_in_tolerance|NO"), "{part}");
    let state = first.until("|tp_last_part|");
    assert!(state.contains("|tp_batch|corner|tp_in_control|NO|tp_last_part|2|"), "{state}");
    // Who comes later knows the same.
    let mut second = Agent::of(&adapter);
    let values = second.line().expect("values");
    assert!(values.contains("|tp_last_part|2|") && values.contains("|tp_part|2|"), "{values}");
    assert!(second.line().is_some_and(|line| line.contains("|tp_alarm|NORMAL||||")));
    assert!(second.line().is_some_and(|line| line.contains("|tp_alarm|FAULT|corner/out_of_tolerance|")));
    // Cleared by name.
    let mut cleared = news(&[0.0, 0.012]);
    let alarms = cleared.alarms.as_mut().expect("alarms");
    alarms.cleared = alarms
        .raised
        .drain(..)
        .map(|one| truepath_publish::message::Cleared { key: one.key, text: one.text })
        .collect();
    adapter.tell(&News { alarms: cleared.alarms, ..News::default() });
    assert!(second.until("NORMAL").ends_with("|tp_alarm|NORMAL|corner/out_of_tolerance|||"));
    adapter.close(SOON);
    assert!(second.until("|tp_avail|").contains("|tp_avail|UNAVAILABLE|"));
    second.until("|tp_alarm|UNAVAILABLE||||");
    assert_eq!(second.line(), None, "the end");
}

#[test]
fn a_slow_agent_is_let_go_and_the_others_hear_everything() {
    let (adapter, notes) = adapter();
    let slow = Agent::of(&adapter);
    let mut quick = Agent::of(&adapter);
    eventually("two agents", || adapter.clients() == 2);
    let reader = std::thread::spawn(move || {
        let mut last = String::new();
        while let Some(line) = quick.line() {
            if line.contains("|tp_alarm|FAULT|") {
                last = line;
            }
        }
        last
    });
    let mut changing = News { alarms: news(&[0.0, 0.012]).alarms, ..News::default() };
    let mut told = 0;
    let begin = Instant::now();
    while adapter.clients() == 2 {
        told += 1;
        let alarms = changing.alarms.as_mut().expect("alarms");
        alarms.raised.truncate(1);
        for one in 0..200 {
            let mut another = alarms.raised[0].clone();
            another.text = format!("{told} {one} {}", "x".repeat(400));
            alarms.raised.push(another);
        }
        alarms.raised.remove(0);
        adapter.tell(&changing);
        assert!(begin.elapsed() < SOON, "the slow one is waited for");
        // Nobody can follow who is told more than a line takes.
        std::thread::sleep(Duration::from_millis(1));
    }
    let gone: Vec<Note> = notes.try_iter().collect();
    let slow_one = slow.lines.get_ref().local_addr().expect("an address");
    assert_eq!(gone.last(), Some(&Note::TooSlow(slow_one)), "{gone:?}");
    adapter.close(SOON);
    let last = reader.join().expect("it reads");
    assert!(last.contains(&format!("|{told} 199 xxx")), "the last of {told}: {last}");
}

#[test]
fn there_are_so_many_agents_at_most_and_one_that_talks_too_much_is_none() {
    let (adapter, notes) = adapter();
    let mut agents: Vec<Agent> = (0..8).map(|_| Agent::of(&adapter)).collect();
    eventually("eight agents", || adapter.clients() == 8);
    let mut ninth = Agent::of(&adapter);
    assert_eq!(ninth.line(), None);
    assert!(notes.try_iter().any(|note| matches!(note, Note::TooMany(_))));
    // One that goes makes room.
    agents.pop();
    eventually("seven agents", || adapter.clients() == 7);
    let mut again = Agent::of(&adapter);
    assert!(again.line().is_some_and(|line| line.contains("|tp_avail|")));
    let _ = again.lines.get_mut().write_all(&[b'x'; 1000]);
    eventually("it is let go", || adapter.clients() == 7);
}
