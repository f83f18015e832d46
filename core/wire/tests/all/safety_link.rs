//! What the setpoint link may do while a correction is on, with the ticks of the table of `docs/safety.md`.

use crate::link_support;
use crate::safety;
use link_support::*;
use safety::row;
use truepath_wire::rewrite::{Mode, Reason};

/// In the middle of the path with a correction on; the next frame is the first of the event.
fn active() -> Wire {
    let mut wire = Wire::active();
    assert_ne!(wire.forward(1).output().correction_nm, [0; 6]);
    wire
}

/// The event changes nothing: afterwards the path goes on, corrected.
fn goes_on(event: &str, mut wire: Wire) {
    let row = row(event);
    assert_eq!((row.noticed, row.out), (None, None));
    for _ in 0..20 {
        let out = wire.forward(1).output();
        assert_eq!((out.mode, out.reason), (Mode::Active, Reason::None));
        assert_ne!(out.correction_nm, [0; 6]);
    }
}

#[test]
fn a_damaged_frame() {
    let mut wire = active();
    let [x, y, z, ..] = wire.next.axes;
    let mut packet = wire.packet([x + FEED, y, z]);
    packet[20] = packet[20].wrapping_add(1).max(1);
    assert_eq!(wire.receive(&packet).unwrap().answer, None);
    goes_on("frame damaged (CRC, length, kind, version, axes)", wire);
}

#[test]
fn a_few_lost_frames() {
    let mut wire = active();
    wire.lose(2);
    goes_on("up to 2 frames lost in a row", wire);
}

#[test]
fn too_many_lost_frames() {
    let row = row("more than 2 frames lost in a row");
    let mut wire = active();
    wire.lose(3);
    wire.ends(row.noticed, row.out, Reason::SequenceBroken, |wire| wire.forward(1));
}

#[test]
fn a_repeated_frame() {
    let mut wire = active();
    let again = packet_of(&wire.next);
    assert_eq!(wire.receive(&again).unwrap().answer, None);
    goes_on("frame repeated", wire);
}

#[test]
fn exchanged_frames() {
    let mut wire = active();
    let [x, y, z, ..] = wire.next.axes;
    let first = wire.packet([x + FEED, y, z]);
    let second = wire.packet([x + 2 * FEED, y, z]);
    assert!(wire.receive(&second).unwrap().output().forward);
    assert_eq!(wire.receive(&first).unwrap().answer, None);
    goes_on("two frames exchanged", wire);
}

#[test]
fn a_sequence_from_elsewhere() {
    let row = row("sequence from elsewhere");
    for elsewhere in [64u32.wrapping_neg(), 4, 1 << 31] {
        let mut wire = active();
        wire.next.sequence = wire.next.sequence.wrapping_add(elsewhere).wrapping_sub(1);
        wire.ends(row.noticed, row.out, Reason::SequenceBroken, |wire| wire.stay());
    }
}

#[test]
fn a_count_that_begins_anew() {
    let row = row("controller counts anew, by less than 64");
    for back in [10, 63] {
        let mut wire = active();
        wire.next.sequence -= back + 1;
        wire.ends(row.noticed, row.out, Reason::SequenceBroken, |wire| wire.stay());
    }
}

#[test]
fn old_frames_in_a_burst() {
    let mut wire = active();
    let old: Vec<_> = (1..=40)
        .map(|_| {
            wire.forward(1);
            packet_of(&wire.next)
        })
        .collect();
    for packet in old {
        assert_eq!(wire.receive(&packet).unwrap().answer, None);
    }
    goes_on("old frames in a burst, up to 63 before the last one", wire);
}

#[test]
fn a_few_missed_deadlines() {
    let mut wire = active();
    wire.delay_us = 501;
    for _ in 0..2 {
        assert_eq!(wire.forward(1).answer, None);
    }
    wire.delay_us = 0;
    goes_on("up to 2 deadlines missed in a row", wire);
}

#[test]
fn too_many_missed_deadlines() {
    let row = row("more than 2 deadlines missed in a row");
    let mut wire = active();
    let mut late = 3;
    wire.ends(row.noticed, row.out, Reason::SequenceBroken, |wire| {
        wire.delay_us = if late > 0 { 501 } else { 0 };
        late -= 1;
        wire.forward(1)
    });
}

#[test]
fn too_many_answers_not_fetched() {
    let row = row("more than 2 answers in a row not fetched (SPI)");
    active().ends(row.noticed, row.out, Reason::SequenceBroken, |wire| {
        let came = wire.forward(1);
        wire.endpoint.withdraw();
        came
    });
}

#[test]
fn setpoints_that_are_too_fast() {
    let row = row("setpoints faster than the settings by more than half");
    let mut longest = (0, 0, 0);
    for tick_us in [50, 500, 666] {
        // The window of 32 frames stands at any place when it begins.
        for before in 0..32 {
            let mut wire = active();
            wire.forward(before + 1);
            wire.tick_us = tick_us;
            let noticed = (1..=200).find(|_| wire.forward(1).output().mode == Mode::Fault).unwrap();
            longest = longest.max((noticed, before, tick_us));
        }
    }
    let (noticed, before, tick_us) = longest;
    assert_eq!(Some(noticed), row.noticed);
    let mut wire = active();
    wire.forward(before + 1);
    wire.ends(row.noticed, row.out, Reason::FrameRate, |wire| {
        wire.tick_us = tick_us;
        let came = wire.forward(1);
        wire.tick_us = TICK_US;
        came
    });
}

#[test]
fn silence() {
    let row = row("silence");
    let mut wire = active();
    let mut ticks = 0;
    while wire.endpoint.mode() != Mode::Off {
        assert_eq!(wire.endpoint.mode(), Mode::Active);
        wire.now_us += TICK_US;
        wire.endpoint.watch(&wire.rewriter, wire.now_us);
        ticks += 1;
        assert!(Some(ticks) <= row.noticed, "{ticks} ticks");
    }
    assert_eq!((Some(ticks), row.out), (row.noticed, Some(0)));
    assert!(!wire.endpoint.drive_enable());
    let out = wire.stay().output();
    assert_eq!((out.forward, out.correction_nm, out.reason), (false, [0; 6], Reason::Silence));
}
