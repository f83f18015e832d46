//! What becomes of a frame by its sequence: the rules of `docs/link.md`, also where the count begins anew.

use proptest::prelude::*;
use truepath_wire::link::{BEHIND, DeviceSettings, Endpoint, LinkError, RESTART_AFTER, SetpointFrame, Verdict};
use truepath_wire::rewrite::{Rewriter, Setpoint, Settings, SpentList};

/// An endpoint that has accepted a sequence, and a way to give it others.
struct Line {
    rewriter: Rewriter<'static>,
    endpoint: Endpoint,
    now_us: u64,
}

impl Line {
    fn after(sequence: u32) -> Self {
        let rewriter = Rewriter::new(Settings::at_1_khz(), None).unwrap();
        let mut line =
            Self { rewriter, endpoint: Endpoint::new(DeviceSettings::at_1_khz(), SpentList::EMPTY), now_us: 0 };
        assert_eq!(line.give(sequence), Verdict::Accepted, "whatever comes first is a beginning");
        line
    }
    /// A frame one tick later.
    fn give(&mut self, sequence: u32) -> Verdict {
        self.now_us += 1_000;
        self.at_once(sequence)
    }
    /// A frame at the same time.
    fn at_once(&mut self, sequence: u32) -> Verdict {
        let mut raw = [0; 100];
        let setpoint = Setpoint { sequence, ..Setpoint::default() };
        let bytes = SetpointFrame { axes: 3, setpoint }.encode(&mut raw).unwrap();
        let verdict = self.endpoint.frame(&self.rewriter, &raw[..bytes], self.now_us);
        let mut answer = [0; 100];
        assert_eq!(self.endpoint.answer(self.now_us, &mut answer).is_some(), verdict.is_accepted());
        verdict
    }
}

/// Starts at which the count passes its end, its sign or nothing at all.
const STARTS: [u32; 6] = [0, 1, 1_000, u32::MAX - 1, u32::MAX, 1 << 31];

#[test]
fn the_next_sequence_is_accepted_also_over_the_end_of_the_count() {
    for start in STARTS {
        let mut line = Line::after(start);
        for i in 1..=200u32 {
            assert_eq!(line.give(start.wrapping_add(i)), Verdict::Accepted);
        }
        let c = line.endpoint.counters();
        assert_eq!((c.accepted, c.answered, c.lost, c.jumps, c.repeated, c.out_of_order), (201, 201, 0, 0, 0, 0));
    }
}

#[test]
fn every_distance_from_the_last_sequence_has_its_verdict() {
    let most = Settings::at_1_khz().max_lost_frames;
    for start in STARTS {
        for ahead in -100i64..=100 {
            let verdict = Line::after(start).give(start.wrapping_add(ahead as u32));
            let expected = match ahead {
                0 => Verdict::Repeated,
                1 => Verdict::Accepted,
                d if d > 1 && d <= i64::from(most) + 1 => Verdict::Lost(d as u32 - 1),
                d if d < 0 && d >= -i64::from(BEHIND) => Verdict::OutOfOrder,
                _ => Verdict::Jump,
            };
            assert_eq!(verdict, expected, "{ahead} from {start}");
        }
    }
}

#[test]
fn each_verdict_is_counted_once() {
    let mut line = Line::after(10);
    for sequence in [12, 12, 11, 13, 99, 100] {
        line.give(sequence);
    }
    let c = *line.endpoint.counters();
    assert_eq!((c.accepted, c.answered, c.lost, c.repeated, c.out_of_order, c.jumps), (5, 5, 1, 1, 1, 1));
    assert!(matches!(line.endpoint.frame(&line.rewriter, &[0; 48], 0), Verdict::Damaged(LinkError::Checksum { .. })));
    assert_eq!(line.endpoint.counters().damaged, 1);
    line.endpoint.clear_counters();
    assert_eq!(*line.endpoint.counters(), Default::default());
}

#[test]
fn a_controller_that_counts_anew_is_heard_again_within_a_few_frames() {
    for back in 0..=BEHIND {
        let last = 5_000u32;
        let mut line = Line::after(last);
        let begin = last - back;
        let refused = (0..10).take_while(|i| !line.give(begin + i).is_accepted()).count();
        assert!(refused < RESTART_AFTER as usize, "{refused} frames refused when it begins {back} before");
        // From then on it runs through.
        let at = begin + refused as u32;
        for i in 1..20 {
            assert_eq!(line.give(at + i), Verdict::Accepted, "{back}: {i}");
        }
    }
}

#[test]
fn late_frames_that_do_not_follow_each_other_never_pass_for_a_restart() {
    let mut line = Line::after(1_000);
    for sequence in [995, 993, 995, 991, 999, 998, 997, 996, 1_000, 1_000, 1_000, 1_000, 1_000] {
        assert!(!line.give(sequence).is_accepted());
    }
    // Three that follow each other are still late ones, and a good frame ends the run.
    for sequence in [990, 991, 992] {
        assert_eq!(line.give(sequence), Verdict::OutOfOrder);
    }
    assert_eq!(line.give(1_001), Verdict::Accepted);
    assert_eq!(line.give(993), Verdict::OutOfOrder);
}

#[test]
fn old_frames_in_a_burst_never_pass_for_a_restart() {
    // At once behind a good frame, after two lost ones, and after as long a pause as a restart takes.
    for (pause, last) in [(0, 1_000), (2, 1_000), (3, 1_000), (15, 1_000), (3, 61), (15, 61)] {
        let mut line = Line::after(last);
        line.now_us += pause * 1_000;
        for sequence in last - 60..=last {
            assert!(!line.at_once(sequence).is_accepted(), "{sequence} after {pause}");
        }
        assert_eq!(line.give(last + 1), Verdict::Accepted);
    }
    // At a good pace, but between good frames.
    let mut line = Line::after(1_000);
    for i in 1..60 {
        assert_eq!(line.at_once(940 + i), Verdict::OutOfOrder);
        assert_eq!(line.give(1_000 + i), Verdict::Accepted);
    }
    // At twice the pace they are refused longer: a run at less than two thirds of the time of its ticks is none.
    let mut line = Line::after(1_000);
    for sequence in [940, 941, 942, 943, 944] {
        line.now_us += 500;
        assert_eq!(line.at_once(sequence), Verdict::OutOfOrder);
    }
}

proptest! {
    #[test]
    fn any_sequences_leave_a_count_that_adds_up_and_a_line_that_recovers(
        start: u32,
        steps in prop::collection::vec(prop_oneof![4 => -70i64..70, 1 => any::<i32>().prop_map(i64::from)], 1..200),
    ) {
        let mut line = Line::after(start);
        let mut sequence = start;
        for step in &steps {
            sequence = sequence.wrapping_add(*step as u32);
            line.give(sequence);
        }
        let c = *line.endpoint.counters();
        prop_assert_eq!(c.accepted + c.repeated + c.out_of_order, steps.len() as u32 + 1);
        prop_assert_eq!(c.accepted, c.answered);
        let recovered = (1..=RESTART_AFTER).filter(|i| line.give(sequence.wrapping_add(*i)).is_accepted()).count();
        prop_assert!(recovered >= 1);
        let at = sequence.wrapping_add(RESTART_AFTER);
        prop_assert_eq!(line.give(at.wrapping_add(1)), Verdict::Accepted);
    }
}
