//! Answers that the controller has to fetch: one that it did not fetch counts as withheld.

use crate::link_support;
use link_support::*;
use truepath_wire::rewrite::{Mode, Reason};

#[test]
fn an_answer_that_was_not_fetched_counts_as_late_and_not_as_answered_once() {
    let mut wire = Wire::active();
    let before = *wire.endpoint.counters();
    assert!(wire.forward(1).answer.is_some());
    for _ in 0..3 {
        wire.endpoint.withdraw();
        let c = wire.endpoint.counters();
        assert_eq!((c.answered, c.late, c.accepted), (before.answered, before.late + 1, before.accepted + 1));
    }
    // There is nothing to withdraw of a frame that got no answer.
    wire.delay_us = 501;
    assert_eq!(wire.forward(1).answer, None);
    let withheld = *wire.endpoint.counters();
    wire.endpoint.withdraw();
    assert_eq!(*wire.endpoint.counters(), withheld);
}

#[test]
fn more_answers_in_a_row_that_nobody_fetched_than_may_be_lost_end_the_correction() {
    for (unfetched, ends) in [(2, false), (3, true)] {
        let mut wire = Wire::active();
        for _ in 0..unfetched {
            assert_eq!(wire.forward(1).output().mode, Mode::Active);
            wire.endpoint.withdraw();
        }
        let out = wire.forward(1).output();
        let expected = if ends { (Mode::Fault, Reason::SequenceBroken) } else { (Mode::Active, Reason::None) };
        assert_eq!((out.mode, out.reason), expected, "{unfetched}");
        // A fetched one begins the count anew.
        if !ends {
            wire.forward(1);
            wire.endpoint.withdraw();
            wire.forward(1);
            wire.endpoint.withdraw();
            assert_eq!(wire.forward(1).output().mode, Mode::Active);
        }
    }
}

#[test]
fn an_answer_is_due_from_the_frame_on_until_it_is_given_or_late() {
    for late in [false, true] {
        let mut wire = Wire::bypass();
        assert_eq!(wire.endpoint.due(), None);
        let mut packet = wire.packet([1, 2, 3]);
        packet.pop();
        assert!(wire.endpoint.packet(&wire.rewriter, &mut packet, wire.now_us).is_accepted());
        assert_eq!(wire.endpoint.due().map(|output| output.axes), Some([1, 2, 3, 0, 0, 0]));
        let given = wire.endpoint.answer(wire.now_us + if late { 501 } else { 500 }, &mut [0; 100]);
        assert_eq!((given.is_some(), wire.endpoint.due()), (!late, None));
    }
}

#[test]
fn the_answer_is_due_the_deadline_after_the_arrival_of_its_frame() {
    let mut wire = Wire::bypass();
    wire.stay();
    assert_eq!(wire.endpoint.due_by_us(), wire.now_us + 500);
    // A frame that is not accepted changes nothing.
    let again = packet_of(&wire.next);
    let due = wire.endpoint.due_by_us();
    wire.now_us += 10;
    wire.receive(&again);
    assert_eq!(wire.endpoint.due_by_us(), due);
}
