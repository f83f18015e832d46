//! The setpoint link: equal to the rewriter bit for bit, faults of frames, lateness, silence, recorder, trace.

use crate::wire_support;
use truepath_core::image::Image;
use truepath_core::link::{AnswerFrame, Ask, Denial, Reply, SetpointFrame, TraceSample, setpoint_bytes};
use truepath_core::rewrite::{ArmRequest, Digest, Flags, Frame, Mode, Reason, Rewriter, Setpoint, Settings, State};
use wire_support::part::{CLEAR, FEED, GATE, MM, PASS, along, straight};
use wire_support::*;

/// Plunge, path, retract.
fn program() -> Vec<(i64, i64, i64)> {
    let mut setpoints = vec![(0, 0, CLEAR); 3];
    setpoints.extend((0..=100).map(|i| (0, 0, GATE + (PASS - GATE) * i / 100)));
    setpoints.extend(along(&straight(), FEED).into_iter().map(|(x, y)| (x, y, PASS)));
    setpoints.extend((0..300).map(|i| (10 * MM, 0, PASS + i * 50_000)));
    setpoints
}

#[test]
fn answers_over_the_wire_are_those_of_the_rewriter_bit_for_bit() {
    let bytes = image_of(straight());
    let mut rig = Rig::with_image(&bytes);
    let rewriter = Rewriter::new(Settings::at_1_khz(), Some(Image::new_checked(&bytes).unwrap())).unwrap();
    let mut state = State::default();
    rewriter.acknowledge_drives_disabled(&mut state).unwrap();
    rig.enable();
    let (mut ours, mut theirs, mut corrected) = (Digest::default(), Digest::default(), 0);
    for part_serial in 1..=3 {
        rig.arm(part_serial).unwrap();
        rewriter.arm(&mut state, &rig.request(part_serial)).unwrap();
        for (i, (x, y, z)) in program().into_iter().enumerate() {
            if i % 97 == 0 {
                // A frame is lost on the way.
                rig.setpoint.sequence += 1;
            }
            let out = rig.send(x, y, z).unwrap();
            let expected = rewriter.tick(&mut state, &rig.setpoint);
            assert_eq!(out, expected, "part {part_serial}, setpoint {i}");
            ours.add(&out);
            theirs.add(&expected);
            corrected += usize::from(out.axes != rig.setpoint.axes);
        }
        assert_eq!(rig.device().state(), state);
        assert_eq!(state.reason(), Reason::Completed);
    }
    assert_eq!(ours, theirs);
    assert!(corrected > 3_000, "{corrected}");
}

#[test]
fn on_spi_the_same_frames_travel_without_stuffing() {
    let mut rig = Rig::new();
    let (mut raw, mut answer) = ([0; 128], [0; 128]);
    let setpoint = Setpoint { sequence: 5, axes: [1, -2, 3, 0, 0, 0], ..Setpoint::default() };
    let used = SetpointFrame { axes: 3, setpoint }.encode(&mut raw).unwrap();
    let bytes = rig.device().servo().frame(&raw[..used], 0, &0u64, &mut answer).unwrap();
    let back = AnswerFrame::decode(&answer[..bytes], 3).unwrap().output;
    assert!(back.sequence == 5 && back.mode == Mode::Off && !back.forward && back.axes == setpoint.axes);
    raw[9] ^= 1;
    assert_eq!(rig.device().servo().frame(&raw[..used], 0, &0u64, &mut answer), None);
}

#[test]
fn damaged_repeated_and_old_frames_get_no_answer_and_are_counted() {
    let mut rig = Rig::active(&image_of(straight()));
    let before = rig.status().counters;
    let frame = rig.frame();
    for at in 0..frame.len() - 1 {
        let mut damaged = frame.clone();
        damaged[at] ^= 0x10;
        assert!(rig.stream(&damaged).is_empty());
    }
    assert_eq!(rig.again(), None, "repeated");
    rig.setpoint.sequence -= 5;
    assert_eq!(rig.again(), None, "old");
    rig.setpoint.sequence += 5;
    let after = rig.status().counters;
    assert!(after.damaged >= before.damaged + frame.len() as u32 - 1);
    assert_eq!((after.repeated, after.out_of_order), (before.repeated + 1, before.out_of_order + 1));
    assert_eq!(after.accepted, before.accepted);
    let [x, y, z, ..] = rig.setpoint.axes;
    assert_eq!(rig.send(x + FEED, y, z).unwrap().mode, Mode::Active);
}

#[test]
fn a_frame_may_be_cut_anywhere_and_follow_another_without_a_pause() {
    let mut rig = Rig::new();
    rig.setpoint.sequence = 1;
    let one = rig.frame();
    for cut in 0..one.len() {
        rig.setpoint.sequence += 1;
        let bytes = rig.frame();
        assert!(rig.stream(&bytes[..cut]).is_empty());
        let mut rest = bytes[cut..].to_vec();
        rig.setpoint.sequence += 1;
        rest.extend(rig.frame());
        assert_eq!(rig.stream(&rest).len(), 2);
    }
}

#[test]
fn an_answer_that_would_be_late_is_withheld_and_too_many_of_them_end_the_correction() {
    let mut rig = Rig::active(&image_of(straight()));
    let late = |rig: &mut Rig, by_us: u64| {
        rig.setpoint.sequence += 1;
        rig.now_us += 1_000;
        let (packet, now_us, mut answers) = (rig.frame(), rig.now_us, 0);
        rig.device().setpoint_bytes_answered(&packet, now_us, &(now_us + by_us), |_| answers += 1);
        answers
    };
    assert_eq!(late(&mut rig, 500), 1);
    assert_eq!(late(&mut rig, 501), 0);
    assert_eq!(rig.status().counters.late, 1);
    assert_eq!(late(&mut rig, 501), 0);
    assert_eq!(rig.mode(), Mode::Active);
    assert_eq!(late(&mut rig, 501), 0);
    assert_eq!(late(&mut rig, 0), 1);
    let status = rig.status();
    assert_eq!((status.mode, status.reason), (Mode::Fault, Reason::SequenceBroken));
    assert!(rig.device().fault() && rig.device().drive_enable());
    rig.settle();
}

#[test]
fn silence_drops_the_drives_in_every_state() {
    for armed in [false, true] {
        let mut rig = Rig::with_image(&image_of(straight()));
        rig.enable();
        if armed {
            rig.arm(1).unwrap();
        }
        rig.wait(19);
        assert!(rig.device().drive_enable());
        rig.wait(1);
        assert!(!rig.device().drive_enable() && rig.device().fault());
        let status = rig.status();
        assert_eq!((status.mode, status.reason), (Mode::Off, Reason::Silence));
        assert!(!rig.stay().unwrap().forward);
        rig.enable();
    }
}

#[test]
fn the_recorder_keeps_the_frames_before_a_fault_until_it_is_released() {
    let mut rig = Rig::active(&image_of(straight()));
    assert!(matches!(rig.ask(Ask::Recording { from: 0 }), Err(Denial::NoRecording { .. })));
    let [x, y, z, ..] = rig.setpoint.axes;
    assert_eq!(rig.send(x, y + 400_000, z).unwrap().reason, Reason::OffPath);
    let fault = rig.setpoint;
    for _ in 0..300 {
        rig.stay();
    }
    assert!(rig.status().recording_frozen);
    let (mut raw, mut from) = (vec![], 0);
    loop {
        match rig.ask(Ask::Recording { from }) {
            Ok(Reply::Recording { total, from: at, bytes }) => {
                assert_eq!((total as usize, at), (RECORDED, from));
                raw.extend_from_slice(bytes);
                from = (raw.len() / setpoint_bytes(3)) as u32;
            }
            Err(Denial::NoRecording { total }) => {
                assert_eq!((total, from), (RECORDED as u32, RECORDED as u32));
                break;
            }
            other => panic!("{other:?}"),
        }
    }
    let frames: Vec<Setpoint> =
        raw.chunks(setpoint_bytes(3)).map(|raw| SetpointFrame::decode(raw, 3).unwrap()).collect();
    assert!(frames.windows(2).all(|pair| pair[1].sequence == pair[0].sequence + 1));
    assert_eq!(frames[RECORDED - 1 - truepath_fw::servo::RECORD_AFTER], fault);
    rig.done(Ask::ReleaseRecording).unwrap();
    assert!(!rig.status().recording_frozen);
}

#[test]
fn the_trace_tells_of_one_tick_in_eight_and_how_many_were_lost() {
    let mut rig = Rig::active(&image_of(straight()));
    let fetch = |rig: &mut Rig| -> (u32, Vec<TraceSample>) {
        match rig.ask(Ask::Trace).unwrap() {
            Reply::Trace { dropped, samples } => (dropped, samples.to_vec()),
            other => panic!("{other:?}"),
        }
    };
    while !fetch(&mut rig).1.is_empty() {}
    let mut sent = vec![];
    for _ in 0..80 {
        let [x, y, z, ..] = rig.setpoint.axes;
        sent.push(rig.send(x + FEED, y, z).unwrap());
    }
    let (dropped, samples) = fetch(&mut rig);
    assert_eq!((dropped, samples.len()), (0, 10));
    for sample in samples {
        let out = sent.iter().find(|out| out.sequence == sample.sequence).unwrap();
        assert_eq!(sample.correction_nm, [out.correction_nm[0], out.correction_nm[1]]);
        assert_eq!((sample.mode, sample.place), (out.mode, out.place));
    }
    for _ in 0..8 * 100 {
        rig.stay();
    }
    assert_eq!(fetch(&mut rig).0, 100 - truepath_fw::servo::TRACE_QUEUE as u32);
}

#[test]
fn counters_are_cleared_by_request_only() {
    let mut rig = Rig::new();
    rig.stay();
    assert_eq!(rig.status().counters.accepted, 1);
    rig.done(Ask::ClearCounters).unwrap();
    assert_eq!(rig.status().counters.accepted, 0);
}

#[test]
fn a_frame_change_a_tool_change_and_an_emergency_stop_end_the_correction_and_disarm() {
    for (flags, reason) in [
        (Flags::EMERGENCY_STOP, Reason::EmergencyStop),
        (Flags::ABORT, Reason::Abort),
        (Flags::TOOL_CHANGE, Reason::ToolChange),
        (Flags::PROGRAM_END, Reason::ProgramEnd),
    ] {
        let mut rig = Rig::active(&image_of(straight()));
        rig.setpoint.flags = rig.setpoint.flags.with(flags);
        rig.stay();
        rig.settle();
        assert_eq!(rig.status().reason, reason);
    }
    let mut rig = Rig::active(&image_of(straight()));
    rig.setpoint.frame_crc = Frame { offset_nm: [1, 0, 0], ..Frame::identity() }.sealed().crc;
    assert_eq!(rig.stay().unwrap().reason, Reason::FrameChanged);
    rig.settle();
    let again = ArmRequest { part_serial: 1, ..rig.request(1) };
    assert!(rig.done(Ask::Arm(again)).is_err());
}
