//! What the bench must find: boards that are wrong in one bit, one answer, one reply.

use crate::hil_support::{host_board, image, options};
use truepath::command::hil::{Report, Source, run};
use truepath_bench::{BenchError, Board, BulkBoard, Client, Clients, Event, Exchange, Faults, InProcess, Wire};

/// A board with a mistake in what it sends back.
struct Faulty<M> {
    board: BulkBoard<InProcess>,
    mistake: M,
}

impl<M: FnMut(&mut Exchange)> Board for Faulty<M> {
    fn describe(&self) -> String {
        "a faulty board".to_owned()
    }
    fn is_stepped(&self) -> bool {
        true
    }
    fn client(&mut self) -> Client<&mut dyn Wire> {
        self.board.client()
    }
    fn clients(&mut self) -> &mut Clients {
        self.board.clients()
    }
    fn exchange(&mut self, events: &[Event]) -> Result<Exchange, BenchError> {
        let mut exchange = self.board.exchange(events)?;
        (self.mistake)(&mut exchange);
        Ok(exchange)
    }
}

fn with(mistake: impl FnMut(&mut Exchange)) -> Report {
    let mut board = Faulty { board: host_board(), mistake };
    run(&mut board, &image(0), &options(Source::Path, 2_000, Faults::default(), 1), &mut |_| ()).unwrap()
}

/// Where the n-th answer lies.
fn answer(exchange: &Exchange, n: usize) -> std::ops::Range<usize> {
    let mut ends = exchange.answers.iter().enumerate().filter(|(_, b)| **b == 0).map(|(at, _)| at + 1);
    let start = if n == 0 { 0 } else { ends.nth(n - 1).unwrap() };
    start..ends.next().unwrap()
}

fn difference(report: &Report, tick: usize) -> &str {
    assert!(!report.identical);
    let text = report.difference.as_deref().unwrap();
    assert!(text.starts_with(&format!("tick {tick}:")), "{text}");
    text
}

#[test]
fn one_changed_byte_is_found_at_its_tick_and_both_sides_are_shown() {
    let report = with(|exchange| {
        // The lowest byte of a correction that is not zero there.
        let at = answer(exchange, 1234).start + 1 + 20;
        exchange.answers[at] ^= 2;
    });
    let text = difference(&report, 1234);
    assert!(text.contains("setpoint") && text.contains("host state") && text.contains("board"), "{text}");
    assert_ne!(report.digest, report.host_digest);
}

#[test]
fn an_answer_too_few_or_too_many_is_found() {
    let report = with(|exchange| {
        let gone = answer(exchange, 700);
        exchange.answers.drain(gone);
    });
    difference(&report, 700);
    let report = with(|exchange| {
        let twice = exchange.answers[answer(exchange, 900)].to_vec();
        let at = answer(exchange, 901).start;
        exchange.answers.splice(at..at, twice);
    });
    difference(&report, 901);
    let report = with(|exchange| {
        let end = exchange.answers.len();
        exchange.answers.truncate(answer(exchange, 1500).start.min(end));
    });
    assert!(difference(&report, 1500).contains("no answer"));
}

#[test]
fn a_reply_that_is_not_the_hosts_is_found() {
    let report = with(|exchange| exchange.replies.clear());
    assert!(report.difference.as_deref().is_some_and(|text| text.contains("Acknowledge")), "{:?}", report.difference);
}
