//! The recorder of raw frames and the queue of trace samples.

use crate::link_support;
use link_support::*;
use truepath_wire::link::{Recorder, TRACE_SAMPLES, Trace, TraceSample, setpoint_bytes};
use truepath_wire::rewrite::{Mode, Output, Reason, State};

const BYTES: usize = setpoint_bytes(AXES);

fn frame(number: u8) -> [u8; BYTES] {
    [number; BYTES]
}

/// The numbers of all frames that can be read, fetched in pieces of at most `most` bytes.
fn numbers(recorder: &Recorder<'_>, most: usize) -> Vec<u8> {
    let mut found = vec![];
    loop {
        let piece = recorder.frames(found.len(), most);
        if piece.is_empty() {
            return found;
        }
        assert!(piece.len() <= most && piece.len().is_multiple_of(BYTES));
        for frame in piece.chunks(BYTES) {
            assert!(frame.iter().all(|b| *b == frame[0]), "frames are whole");
            found.push(frame[0]);
        }
    }
}

#[test]
fn after_a_fault_the_stated_number_of_frames_is_taken_and_then_all_are_read_oldest_first() {
    for capacity in [5usize, 8, 100] {
        for before in [1u8, 4, 7, 90] {
            let mut buffer = vec![0; capacity * BYTES + 13];
            let mut recorder = Recorder::new(&mut buffer, BYTES, 3);
            for number in 0..before {
                recorder.record(&frame(number));
            }
            assert_eq!(recorder.frames(0, 10_000), &[0u8; 0][..], "it runs");
            recorder.fault(Reason::Abort);
            for number in before..before + 10 {
                assert_eq!(recorder.is_frozen(), number >= before + 3);
                recorder.record(&frame(number));
                recorder.fault(Reason::Abort);
            }
            let end = before + 3;
            let expected: Vec<u8> = (end.saturating_sub(capacity as u8)..end).collect();
            for most in [BYTES, 3 * BYTES + 1, 1_024] {
                assert_eq!(numbers(&recorder, most), expected, "{capacity} {before}");
            }
            assert_eq!(recorder.total(), expected.len());
            assert_eq!(recorder.frames(expected.len(), 1_024), &[0u8; 0][..]);
            assert_eq!(recorder.frames(0, BYTES - 1), &[0u8; 0][..]);
        }
    }
}

#[test]
fn at_a_silence_it_stands_at_once_because_no_frames_follow() {
    for fault_before in [None, Some(Reason::Abort)] {
        let mut buffer = [0; 8 * BYTES];
        let mut recorder = Recorder::new(&mut buffer, BYTES, 3);
        recorder.record(&frame(1));
        fault_before.into_iter().for_each(|reason| recorder.fault(reason));
        recorder.record(&frame(2));
        assert!(!recorder.is_frozen());
        recorder.fault(Reason::Silence);
        assert!(recorder.is_frozen());
        recorder.record(&frame(3));
        assert_eq!(numbers(&recorder, 1_024), [1, 2]);
    }
}

#[test]
fn released_it_runs_again_from_nothing() {
    let mut buffer = [0; 4 * BYTES];
    let mut recorder = Recorder::new(&mut buffer, BYTES, 0);
    recorder.record(&frame(1));
    recorder.fault(Reason::Abort);
    assert!(recorder.is_frozen());
    recorder.release();
    assert_eq!((recorder.is_frozen(), recorder.total()), (false, 0));
    recorder.record(&frame(2));
    recorder.fault(Reason::Abort);
    assert_eq!(numbers(&recorder, 1_024), [2]);
}

#[test]
fn for_frames_of_another_length_it_begins_from_nothing() {
    let mut buffer = [0; 4 * BYTES];
    let mut recorder = Recorder::new(&mut buffer, BYTES, 3);
    recorder.record(&frame(1));
    recorder.fault(Reason::Silence);
    // Of twice the length there is room for two, of which one is from before the fault.
    recorder.restart(2 * BYTES);
    assert_eq!((recorder.is_frozen(), recorder.total()), (false, 0));
    for number in 1..=3 {
        recorder.record(&frame(9));
        recorder.record(&[number; 2 * BYTES]);
    }
    recorder.fault(Reason::Abort);
    recorder.record(&[4; 2 * BYTES]);
    assert!(recorder.is_frozen());
    assert_eq!(numbers(&recorder, 10_000), [3, 3, 4, 4], "two frames, in pieces of the old length");
}

#[test]
fn a_fault_is_never_recorded_over_and_frames_of_another_length_are_passed_over() {
    let mut buffer = [0; 4 * BYTES];
    let mut recorder = Recorder::new(&mut buffer, BYTES, 1_000);
    recorder.record(&frame(1)[1..]);
    recorder.record(&frame(1));
    recorder.fault(Reason::Abort);
    for number in 2..100 {
        recorder.record(&frame(number));
    }
    assert_eq!(numbers(&recorder, 1_024), [1, 2, 3, 4], "as many as leave the frame of the fault");
    let mut nothing = Recorder::new(&mut [], BYTES, 3);
    nothing.record(&frame(1));
    nothing.fault(Reason::Abort);
    assert_eq!(nothing.total(), 0);
}

#[test]
fn a_trace_gives_its_samples_oldest_first_and_counts_what_it_had_to_drop() {
    let mut trace = Trace::<40>::new(1);
    let state = State::default();
    let mut wire = Wire::bypass();
    let mut outputs: Vec<Output> = vec![];
    for _ in 0..100 {
        outputs.push(wire.stay().output());
        trace.record(&state, outputs.last().unwrap());
    }
    let expected: Vec<u32> = outputs[60..].iter().map(|o| o.sequence).collect();
    let mut found = vec![];
    let mut dropped = vec![];
    loop {
        let (lost, samples) = trace.drain();
        dropped.push(lost);
        if samples.is_empty() {
            break;
        }
        assert!(samples.len() <= TRACE_SAMPLES);
        found.extend(samples.iter().map(|s| s.sequence));
    }
    assert_eq!((found, dropped), (expected, vec![60, 0, 0, 0]));
}

#[test]
fn a_trace_takes_one_tick_in_so_many_and_shows_the_correction_of_the_path() {
    let mut trace = Trace::<8>::new(10);
    let mut wire = Wire::active();
    let mut outputs = vec![];
    for _ in 0..35 {
        outputs.push(wire.forward(1).output());
        trace.record(wire.endpoint.state(), outputs.last().unwrap());
    }
    let (dropped, samples) = trace.drain();
    let taken: Vec<_> = samples.iter().map(|s| s.sequence).collect();
    let expected: Vec<_> = outputs.iter().step_by(10).map(|o| o.sequence).collect();
    assert_eq!((dropped, taken), (0, expected));
    let first: TraceSample = samples[0];
    assert_eq!(first.mode, Mode::Active);
    assert_eq!(first.correction_nm, [outputs[0].correction_nm[0], outputs[0].correction_nm[1]]);
    assert_ne!(first.correction_nm, [0; 2]);
    assert_eq!(first.place, outputs[0].place);
    // Nominal feed and spindle speed.
    assert_eq!(first.feed_ratio, 1 << 16);
}
