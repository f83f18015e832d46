//! One part, one arming, one image: what stays uncorrected, by the table of `docs/safety.md`.

use crate::link_support;
use crate::safety;
use link_support::*;
use safety::row;
use truepath_wire::image::{Binding, Image, ImageError};
use truepath_wire::link::Endpoint;
use truepath_wire::rewrite::{Identity, Mode, Reason, Refusal, Rewriter, Settings};

/// Plunge, path, retract; whether any setpoint was corrected.
fn whole_program(wire: &mut Wire) -> bool {
    let mut corrected = false;
    let mut setpoints = vec![(0, 0, CLEAR); 3];
    setpoints.extend((0..=100).map(|i| (0, 0, GATE + (PASS - GATE) * i / 100)));
    setpoints.extend(along(&straight(), FEED).into_iter().map(|(x, y)| (x, y, PASS)));
    setpoints.extend((0..200).map(|i| (10 * MM, 0, PASS + i * 50_000)));
    for (x, y, z) in setpoints {
        let out = wire.send(x, y, z).output();
        assert!(out.forward);
        corrected |= !is_plain(&out, &wire.next);
    }
    corrected
}

/// The whole program passes unchanged, and the state is that of the table.
fn stays_plain(event: &str, wire: &mut Wire) {
    let row = row(event);
    assert_eq!((row.noticed, row.out), (None, None));
    assert_eq!(wire.endpoint.mode().to_string(), row.state);
    assert!(!whole_program(wire));
    assert_eq!(wire.endpoint.mode().to_string(), row.state);
}

#[test]
fn a_program_repeated() {
    let mut wire = Wire::armed();
    assert!(whole_program(&mut wire), "armed it is corrected");
    assert_eq!(wire.endpoint.state().reason(), Reason::Completed);
    stays_plain("program repeated without arming", &mut wire);
    stays_plain("program repeated without arming", &mut wire);
}

#[test]
fn a_spring_pass() {
    let mut wire = Wire::armed();
    whole_program(&mut wire);
    let again = wire.endpoint.arm(&wire.rewriter, &wire.request);
    assert_eq!(again, Err(Refusal::PartRepeated { part_serial: 1 }));
    stays_plain("spring pass", &mut wire);
    wire.request.part_serial = 2;
    wire.arm();
    assert!(whole_program(&mut wire), "the next part is corrected");
}

#[test]
fn a_restart_in_the_middle() {
    let row = row("restart in the middle");
    assert_eq!((row.noticed, row.out), (None, None));
    let mut wire = Wire::armed();
    let plunge = (0..=100).map(|i| (5 * MM, 0, GATE + (PASS - GATE) * i / 100));
    let path = along(&straight(), FEED).into_iter().filter(|p| p.0 > 5 * MM).map(|(x, y)| (x, y, PASS));
    for (x, y, z) in plunge.chain(path) {
        let out = wire.send(x, y, z).output();
        assert!(is_plain(&out, &wire.next));
        assert_eq!(out.mode.to_string(), row.state);
    }
}

#[test]
fn an_image_for_something_else() {
    type Change = fn(&mut Binding);
    let changes: [(Identity, Change); 6] = [
        (Identity::Program, |b| b.program_crc ^= 1),
        (Identity::Feature, |b| b.feature += 1),
        (Identity::Pass, |b| b.pass += 1),
        (Identity::Tool, |b| b.tool += 1),
        (Identity::ToolOffset, |b| b.tool_offset += 1),
        (Identity::Setup, |b| b.setup += 1),
    ];
    for (expected, change) in changes {
        let mut wire = Wire::bypass();
        change(&mut wire.request.binding);
        let refused = wire.endpoint.arm(&wire.rewriter, &wire.request);
        assert!(
            matches!(refused, Err(Refusal::Identity { what, image, request }) if what == expected && image != request)
        );
        stays_plain("image for another program, feature, pass, tool, offset or setup", &mut wire);
    }
    let mut wire = Wire::bypass();
    wire.request.frame.offset_nm[0] += 1;
    let refused = wire.endpoint.arm(&wire.rewriter, &wire.request);
    assert!(matches!(refused, Err(Refusal::FrameDamaged { .. })));
    stays_plain("image for another program, feature, pass, tool, offset or setup", &mut wire);
}

#[test]
fn a_frame_onto_an_axis_that_is_not_sent() {
    for axes in [[3, 1, 2], [0, 5, 2], [0, 1, 3]] {
        let mut wire = Wire::bypass();
        for (map, axis) in wire.request.frame.axes.iter_mut().zip(axes) {
            map.axis = axis;
        }
        wire.request.frame = wire.request.frame.sealed();
        wire.next.frame_crc = wire.request.frame.crc;
        let [x, y, z] = axes;
        let refused = Refusal::FrameAxes { x, y, z };
        assert_eq!(wire.endpoint.check(&wire.rewriter, &wire.request), Err(refused));
        assert_eq!(wire.endpoint.arm(&wire.rewriter, &wire.request), Err(refused));
        stays_plain("frame onto an axis that is not sent", &mut wire);
    }
}

#[test]
fn arming_before_the_pace_is_known() {
    let mut wire = Wire::reset();
    wire.stay();
    wire.endpoint.acknowledge(&wire.rewriter, wire.now_us).unwrap();
    wire.next.flags = truepath_wire::rewrite::Flags::DRIVES_ENABLED;
    for _ in 0..31 {
        wire.stay();
    }
    let refused = wire.endpoint.arm(&wire.rewriter, &wire.request);
    assert_eq!(refused, Err(Refusal::FrameRate { tick_hz: 1_000, interval_ns: 0 }));
    stays_plain("arming before 33 setpoints have come at the pace of the settings", &mut wire);
}

#[test]
fn a_wrong_image() {
    let event = "wrong image: damaged, of another version, under another name";
    let mut bytes = vec![0; truepath_wire::image::image_bytes(101)];
    truepath_wire::image::build(&settings(), nodes(straight()), &mut bytes[..]).unwrap();
    assert!(Image::new_checked(&bytes).is_ok());
    // Every byte, one bit of it.
    for at in 0..bytes.len() {
        let mut damaged = bytes.clone();
        damaged[at] ^= 1 << (at % 8);
        assert!(Image::new_checked(&damaged).is_err(), "byte {at}");
    }
    let mut newer = bytes.clone();
    newer[12] += 1;
    assert!(matches!(Image::new_checked(&newer), Err(ImageError::Semantics { .. })));
    // Without an image nothing is armed.
    let mut wire = Wire::bypass();
    wire.rewriter = Rewriter::new(Settings::at_1_khz(), None).unwrap();
    assert_eq!(wire.endpoint.arm(&wire.rewriter, &wire.request), Err(Refusal::NoImage));
    stays_plain(event, &mut wire);
}

#[test]
fn a_reset_in_any_state() {
    let row = row("reset in any state, the watchdog's too");
    assert_eq!((row.noticed, row.out), (Some(1), Some(0)));
    for mode in MODES {
        let mut wire = Wire::in_mode(mode);
        wire.endpoint = Endpoint::new(*wire.endpoint.settings(), *wire.endpoint.state().spent());
        assert!(!wire.endpoint.drive_enable());
        for _ in 0..50 {
            let out = wire.go_on().output();
            assert_eq!((out.mode.to_string().as_str(), out.forward, out.correction_nm), (row.state, false, [0; 6]));
        }
        // Back to work needs the acknowledgement, another part and another arming.
        wire.next.flags = Default::default();
        wire.stay();
        wire.endpoint.acknowledge(&wire.rewriter, wire.now_us).unwrap();
        wire.next.flags = truepath_wire::rewrite::Flags::DRIVES_ENABLED;
        assert!(is_plain(&wire.stay().output(), &wire.next));
        wire.request.part_serial = 2;
        wire.arm();
        assert_eq!(wire.endpoint.mode(), Mode::Armed);
        assert!(whole_program(&mut wire));
    }
}
