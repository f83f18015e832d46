//! Every transition of the table of states.

use crate::rewrite_support;
use rewrite_support::*;
use truepath_wire::rewrite::{Flags, Frame, Identity, Mode, Reason, Refusal, Rewriter, Setpoint, Settings, State};

#[test]
fn what_is_refused_in_off_says_why_the_drives_were_dropped() {
    let causes = [
        (Reason::None, "nobody has acknowledged since the reset"),
        (Reason::Silence, "the drives were dropped (no setpoint came for too long)"),
        (Reason::ImageChanged, "the drives were dropped (the image changed after arming)"),
    ];
    for (cause, words) in causes {
        let mut m = if cause == Reason::None { Machine::on(straight()) } else { Machine::on(straight()).active() };
        match cause {
            Reason::Silence => m.rewriter.power_off(&mut m.state, Reason::Silence),
            Reason::ImageChanged => {
                m.forward(300);
                m.rewriter = Rewriter::new(Settings::at_1_khz(), None).unwrap();
                m.stay();
            }
            _ => {}
        }
        let refused = m.rewriter.arm(&mut m.state, &m.request).unwrap_err();
        assert_eq!((refused, refused.code()), (Refusal::Off { reason: cause }, 10));
        assert_eq!(m.rewriter.disarm(&mut m.state), Err(refused));
        assert!(refused.to_string().contains(words), "{refused}");
    }
}

#[test]
fn the_reason_why_the_drives_were_dropped_stays_over_the_acknowledgement_until_the_next_arming() {
    let mut m = Machine::on(straight()).active();
    m.next.flags = Flags::default();
    m.forward(1);
    m.rewriter.power_off(&mut m.state, Reason::Silence);
    m.stay();
    m.acknowledge();
    for _ in 0..3 {
        let out = m.stay();
        assert_eq!((out.mode, out.reason, m.state.reason()), (Mode::Bypass, Reason::Silence, Reason::Silence));
    }
    m.request.part_serial += 1;
    m.rewriter.arm(&mut m.state, &m.request).unwrap();
    assert_eq!(m.stay().reason, Reason::None);
}

#[test]
fn a_flag_is_set_by_setting_it_however_often_and_no_other() {
    let all = [
        Flags::DRIVES_ENABLED,
        Flags::FEED_HOLD,
        Flags::SPINDLE_LOADED,
        Flags::ABORT,
        Flags::EMERGENCY_STOP,
        Flags::PROGRAM_END,
        Flags::TOOL_CHANGE,
    ];
    for flag in all {
        let once = Flags::default().with(flag);
        assert_eq!(once.with(flag), once);
        assert!(all.iter().all(|&other| once.has(other) == (other == flag)), "{flag:?}");
    }
}

#[test]
fn after_power_up_nothing_goes_out_until_the_drives_are_acknowledged_as_disabled() {
    let mut m = Machine::on(straight());
    for _ in 0..5 {
        let out = m.send(1, 2, 3);
        assert_eq!((out.mode, out.forward, out.correction_nm), (Mode::Off, false, [0; 6]));
    }
    assert_eq!(m.rewriter.acknowledge_drives_disabled(&mut m.state), Err(Refusal::DrivesEnabled));
    m.next.flags = Flags::default();
    m.send(1, 2, 3);
    m.acknowledge();
    assert!(is_plain(&m.send(4, 5, 6), &m.next.clone()));
    assert_eq!(m.rewriter.acknowledge_drives_disabled(&mut m.state), Err(Refusal::State(Mode::Bypass)));
}

#[test]
fn off_refuses_to_arm() {
    let mut m = Machine::on(straight());
    assert_eq!(m.rewriter.arm(&mut m.state, &m.request), Err(Refusal::Off { reason: Reason::None }));
    assert_eq!(m.rewriter.disarm(&mut m.state), Err(Refusal::Off { reason: Reason::None }));
}

#[test]
fn bypass_and_armed_pass_any_setpoint_byte_for_byte() {
    let mut m = Machine::on(straight());
    m.acknowledge();
    for armed in [false, true] {
        if armed {
            m.rewriter.arm(&mut m.state, &m.request).unwrap();
        }
        let mut seed = 7u64;
        for i in 0..10_000u32 {
            let mut word = || {
                seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1);
                (seed ^ (seed >> 29)) as i64 >> (i % 40)
            };
            let sp = Setpoint { axes: [(); 6].map(|()| word()), sequence: word() as u32, ..m.next };
            let out = m.rewriter.tick(&mut m.state, &sp);
            assert!(is_plain(&out, &sp), "{sp:?} {out:?}");
        }
        assert_eq!(m.state.mode(), if armed { Mode::Armed } else { Mode::Bypass });
    }
}

#[test]
fn every_difference_of_identity_is_refused_by_name() {
    let mut m = Machine::on(straight());
    m.acknowledge();
    let good = m.request;
    let mut check = |what, change: &dyn Fn(&mut truepath_wire::image::Binding)| {
        let mut request = good;
        change(&mut request.binding);
        match m.rewriter.arm(&mut m.state, &request) {
            Err(Refusal::Identity { what: found, image, request }) if found == what => assert_ne!(image, request),
            other => panic!("{what:?}: {other:?}"),
        }
        assert_eq!(m.state.mode(), Mode::Bypass);
    };
    check(Identity::Program, &|b| b.program_crc ^= 1);
    check(Identity::Feature, &|b| b.feature += 1);
    check(Identity::Pass, &|b| b.pass += 1);
    check(Identity::Tool, &|b| b.tool += 1);
    check(Identity::ToolOffset, &|b| b.tool_offset += 1);
    check(Identity::Setup, &|b| b.setup += 1);
    let mut damaged = good;
    damaged.frame.offset_nm[1] = 1;
    assert!(matches!(m.rewriter.arm(&mut m.state, &damaged), Err(Refusal::FrameDamaged { .. })));
    assert_eq!(m.rewriter.arm(&mut m.state, &good), Ok(()));
    assert_eq!(m.rewriter.arm(&mut m.state, &good), Err(Refusal::State(Mode::Armed)));
}

#[test]
fn without_an_image_there_is_only_bypass() {
    let rewriter = Rewriter::new(Settings::at_1_khz(), None).unwrap();
    let mut state = State::default();
    rewriter.acknowledge_drives_disabled(&mut state).unwrap();
    let request = Machine::on(straight()).request;
    assert_eq!(rewriter.arm(&mut state, &request), Err(Refusal::NoImage));
}

#[test]
fn armed_goes_back_to_bypass_on_disarm_and_on_every_stop() {
    let mut m = Machine::on(straight()).armed();
    m.rewriter.disarm(&mut m.state).unwrap();
    assert_eq!((m.state.mode(), m.state.reason()), (Mode::Bypass, Reason::Disarmed));
    for (flag, reason) in [
        (Flags::ABORT, Reason::Abort),
        (Flags::EMERGENCY_STOP, Reason::EmergencyStop),
        (Flags::TOOL_CHANGE, Reason::ToolChange),
        (Flags::PROGRAM_END, Reason::ProgramEnd),
    ] {
        let mut m = Machine::on(straight()).armed();
        m.next.flags = m.next.flags.with(flag);
        let out = m.send(1, 2, 3);
        assert!(is_plain(&out, &m.next));
        assert_eq!((out.mode, out.reason), (Mode::Bypass, reason));
    }
    let mut m = Machine::on(straight()).armed();
    m.next.frame_crc ^= 1;
    let out = m.stay();
    assert_eq!((out.mode, out.reason), (Mode::Bypass, Reason::FrameChanged));
}

#[test]
fn the_gate_opens_only_over_the_start_at_gate_height_at_feed_speed_and_forwards() {
    let tries = [
        ("beside", (0, 300_000, GATE), (0, 300_000, GATE)),
        ("above", (0, 0, CLEAR), (0, 0, CLEAR)),
        ("below", (0, 0, PASS - MM), (0, 0, PASS - MM)),
        ("a rapid passing over it", (-3 * MM, 0, GATE), (0, 0, GATE)),
        ("against the path", (50_000, 0, PASS), (0, 0, PASS)),
    ];
    for (name, from, to) in tries {
        let mut m = Machine::on(straight()).armed();
        m.send(from.0, from.1, from.2);
        // The place before may itself lie in the gate; only the second setpoint counts here.
        if m.state.mode() == Mode::Armed {
            assert_eq!(m.send(to.0, to.1, to.2).mode, Mode::Armed, "{name}");
        } else {
            assert_eq!(name, "against the path");
        }
    }
    let mut m = Machine::on(straight()).armed();
    m.send(50_000, 0, CLEAR);
    m.next.axes[2] = PASS;
    assert_eq!(m.send(40_000, 0, PASS).mode, Mode::Armed, "against the path");
    let mut m = Machine::on(straight()).armed();
    m.next.flags = Flags::default();
    assert_eq!(m.send(0, 0, GATE).mode, Mode::Armed, "drives disabled");
    let mut m = Machine::on(straight()).armed();
    assert_eq!(m.send(0, 0, GATE).mode, Mode::Active);
    let mut m = Machine::on(straight()).armed();
    m.send(-100_000, 0, GATE + 4 * MM);
    assert_eq!(m.send(-93_000, 0, PASS).mode, Mode::Active, "along the path in the pass");
}

#[test]
fn the_correction_is_full_before_the_cutter_reaches_the_pass() {
    let mut m = Machine::on(straight()).armed();
    for i in 0..100 {
        m.send(0, 0, GATE - i * 30_000 + 1);
    }
    let out = m.stay();
    assert!(out.axes[2] > PASS && out.mode == Mode::Active);
    let [cx, cy, ex, ey] = profile(0);
    assert_eq!(out.correction_nm[..2], [(cx + ex) as i32, (cy + ey) as i32]);
    assert_eq!(out.place.node, 0);
    assert_eq!(out.uncorrected(&out.axes), m.next.axes);
}

#[test]
fn a_feed_hold_follows_to_the_stop_holds_and_resumes_where_it_was() {
    let mut m = Machine::on(straight()).active();
    m.forward(500);
    m.next.flags = m.next.flags.with(Flags::FEED_HOLD);
    let moving = m.forward(3);
    assert_eq!(moving.mode, Mode::Active);
    let held = m.stay();
    assert_eq!(held.mode, Mode::Hold);
    m.next.spindle_millirpm = SPINDLE;
    for _ in 0..1_000 {
        let out = m.stay();
        assert_eq!((out.mode, out.correction_nm, out.place), (Mode::Hold, held.correction_nm, held.place));
    }
    m.next.flags = Flags::DRIVES_ENABLED;
    assert_eq!(m.stay().mode, Mode::Hold);
    let x = m.next.axes[0];
    assert_eq!(m.send(x + FEED, 0, PASS).mode, Mode::Active);
    assert_eq!(m.forward(100).mode, Mode::Active);
}

#[test]
fn standing_still_without_a_flag_is_a_hold_after_the_stated_ticks() {
    let mut m = Machine::on(straight()).active();
    m.forward(500);
    let after = m.rewriter.settings().hold_after_ticks;
    for tick in 1..=after {
        assert_eq!(m.stay().mode, if tick < after { Mode::Active } else { Mode::Hold });
    }
}

#[test]
fn a_hold_ends_by_disarm_or_fault_with_a_ramp_to_zero() {
    for fault in [false, true] {
        let mut m = Machine::on(straight()).active();
        m.forward(500);
        m.next.flags = m.next.flags.with(Flags::FEED_HOLD);
        m.stay();
        assert_eq!(m.stay().mode, Mode::Hold);
        if fault {
            let x = m.next.axes[0];
            let out = m.send(x + 210_000, 0, PASS);
            assert_eq!((out.mode, out.reason), (Mode::Fault, Reason::MovedInHold));
        } else {
            m.rewriter.disarm(&mut m.state).unwrap();
            assert_eq!(m.rewriter.disarm(&mut m.state), Err(Refusal::State(Mode::Active)));
        }
        assert!(m.settle() > 3);
        assert!(is_plain(&m.stay(), &m.next.clone()));
    }
}

#[test]
fn the_end_of_the_path_holds_the_correction_until_the_cutter_leaves() {
    for leave in ["up", "on", "aside"] {
        let mut m = Machine::on(straight()).active();
        let end = m.run(&along(&straight(), FEED));
        assert_eq!((end.mode, end.place.node), (Mode::Active, 99));
        let [cx, cy, ex, ey] = profile(100);
        // The last step is shorter than the others, which counts as a slower feed: within 1 % of the table.
        for _ in 0..100 {
            let held = m.stay().correction_nm;
            assert!((i64::from(held[0]) - cx - ex).abs() < 500 && (i64::from(held[1]) - cy - ey).abs() < 500);
        }
        let mut step = 0;
        while m.state.reason() == Reason::None {
            step += 1;
            match leave {
                "up" => m.send(10 * MM, 0, PASS + step * 10_000),
                "on" => m.send(10 * MM + step * 6_667, 0, PASS),
                _ => m.send(10 * MM, -step * 6_667, PASS),
            };
            assert!(step < 100);
        }
        assert_eq!((m.state.mode(), m.state.reason()), (Mode::Active, Reason::Completed), "{leave}");
        m.settle();
        assert_eq!(m.state.reason(), Reason::Completed);
        assert!(is_plain(&m.stay(), &m.next.clone()));
    }
}

#[test]
fn the_program_end_ramps_out_and_disarms() {
    let mut m = Machine::on(straight()).active();
    m.forward(300);
    m.next.flags = m.next.flags.with(Flags::PROGRAM_END);
    assert_eq!(m.stay().reason, Reason::ProgramEnd);
    m.settle();
    assert!(is_plain(&m.stay(), &m.next.clone()));
}

#[test]
fn a_frame_with_offset_turn_and_exchanged_axes_corrects_the_right_axes() {
    let mut m = Machine::on(straight());
    // A quarter turn, X on axis 1, Y reversed on axis 0, Z on axis 3.
    let mut frame = Frame::identity();
    frame.cosine = 0;
    frame.sine = 1 << 30;
    frame.offset_nm = [1_000_000_000, -2_000_000_000, 50];
    frame.axes[0].axis = 1;
    frame.axes[1] = truepath_wire::rewrite::AxisMap { axis: 0, reversed: true };
    frame.axes[2].axis = 3;
    m.request.frame = frame.sealed();
    m.next.frame_crc = m.request.frame.crc;
    m.acknowledge();
    assert_eq!(m.state.plane(), [0, 1]);
    m.rewriter.arm(&mut m.state, &m.request).unwrap();
    assert_eq!(m.state.plane(), [1, 0]);
    let mut out = None;
    for z in [CLEAR, GATE, GATE].into_iter().chain([PASS; 200]) {
        let [a, b, c] = m.request.frame.machine_nm(0, 0, z);
        m.next.sequence += 1;
        m.next.axes = [b, a, 0, c, 0, 0];
        out = Some(m.rewriter.tick(&mut m.state, &m.next));
    }
    let out = out.unwrap();
    let [cx, cy, ex, ey] = profile(0).map(|v| v as i32);
    // Turned a quarter: (x, y) → (−y, x); X on axis 1, Y reversed on axis 0.
    assert_eq!(out.correction_nm, [-(cx + ex), -(cy + ey), 0, 0, 0, 0]);
    assert_eq!(out.mode, Mode::Hold);
}
