//! The configuration link itself: duplicates, damage, garbage, unknown requests.

use crate::wire_support;
use proptest::prelude::*;
use truepath_core::checksum::crc32;
use truepath_core::link::{Ask, Denial, PACKET_BYTES, Reply, Request, ResetCause, Response, decode, encode};
use truepath_core::rewrite::{Flags, Mode, Refusal};
use wire_support::part::straight;
use wire_support::*;

/// An undamaged message with any content.
fn sealed(content: &[u8]) -> Vec<u8> {
    let mut raw = content.to_vec();
    raw.extend(crc32(content).to_le_bytes());
    let mut packet = cobs_of(&raw);
    packet.push(0);
    packet
}

/// COBS, byte by byte from the paper, independent of the crate in use.
fn cobs_of(raw: &[u8]) -> Vec<u8> {
    let (mut out, mut block) = (vec![], vec![]);
    for &byte in raw.iter().chain([&0]) {
        if byte != 0 {
            block.push(byte);
        }
        if byte == 0 || block.len() == 254 {
            out.push(block.len() as u8 + 1);
            out.append(&mut block);
        }
    }
    out
}

fn response(mut packet: Vec<u8>) -> (u16, Result<(), Denial>) {
    let response: Response<'_> = decode(&mut packet).unwrap();
    (response.id, response.answer.map(|_| ()))
}

#[test]
fn a_request_that_comes_twice_is_answered_twice_and_carried_out_once() {
    let image = image_of(straight());
    let mut rig = Rig::with_image(&image);
    rig.enable();
    let arming = request(500, Ask::Arm(rig.request(1)));
    let first = rig.raw(&arming);
    assert_eq!(response(first[0].clone()), (500, Ok(())));
    let operations = rig.operations();
    assert_eq!(rig.raw(&arming), first, "not: armed before");
    assert_eq!(rig.operations(), operations);
    assert_eq!(rig.mode(), Mode::Armed);
    rig.done(Ask::Disarm).unwrap();
    // Something else was carried out meanwhile: it is a new request.
    assert!(matches!(response(rig.raw(&arming)[0].clone()), (500, Err(Denial::Refused(_)))));

    rig.begin(&image_of(wire_support::straight(10))).unwrap();
    let chunk = request(600, Ask::Chunk { offset: 0, bytes: &[7; 64] });
    assert_eq!(rig.raw(&chunk), rig.raw(&chunk));
    let other = request(600, Ask::Chunk { offset: 64, bytes: &[7; 64] });
    let mut answer = rig.raw(&other).pop().unwrap();
    let answer: Response<'_> = decode(&mut answer).unwrap();
    assert_eq!(answer.answer, Ok(Reply::Next { offset: 128 }), "the same id with other content is another request");
}

#[test]
fn an_arming_that_has_ended_is_not_called_done_when_it_is_asked_for_again() {
    let mut rig = Rig::with_image(&image_of(straight()));
    rig.enable();
    let arming = request(500, Ask::Arm(rig.request(1)));
    let first = rig.raw(&arming);
    assert_eq!(response(first[0].clone()), (500, Ok(())));
    assert_eq!(rig.raw(&arming), first);
    let flags = rig.setpoint.flags;
    rig.setpoint.flags = flags.with(Flags::EMERGENCY_STOP);
    assert_eq!(rig.stay().unwrap().mode, Mode::Bypass);
    rig.setpoint.flags = flags;
    rig.stay();
    let repeated = Err(Denial::Refused(Refusal::PartRepeated { part_serial: 1 }));
    assert_eq!(response(rig.raw(&arming)[0].clone()), (500, repeated));
    assert_eq!(rig.device().state().mode(), Mode::Bypass);
}

#[test]
fn drives_that_were_dropped_are_acknowledged_anew_by_the_same_request() {
    let mut rig = Rig::with_image(&image_of(straight()));
    rig.setpoint.flags = Flags::default();
    let acknowledge = request(3, Ask::AcknowledgeDrivesDisabled);
    for _ in 0..3 {
        rig.stay();
        assert_eq!(response(rig.raw(&acknowledge)[0].clone()), (3, Ok(())));
        assert_eq!(rig.device().state().mode(), Mode::Bypass);
        rig.wait(25);
        assert_eq!(rig.device().state().mode(), Mode::Off);
        // Nobody sends setpoints: what was done before is not said again.
        let silent = Err(Denial::Refused(Refusal::NoSetpoints));
        assert_eq!(response(rig.raw(&acknowledge)[0].clone()), (3, silent));
    }
}

#[test]
fn requests_that_only_read_are_answered_with_the_present_state() {
    let mut rig = Rig::with_image(&image_of(straight()));
    let status = request(9, Ask::Status);
    let before = rig.raw(&status);
    rig.enable();
    assert_ne!(rig.raw(&status), before);
}

#[test]
fn a_denied_request_can_be_asked_again_with_the_same_id() {
    let mut rig = Rig::with_image(&image_of(straight()));
    let acknowledge = request(3, Ask::AcknowledgeDrivesDisabled);
    assert!(response(rig.raw(&acknowledge)[0].clone()).1.is_err());
    rig.stay();
    assert_eq!(response(rig.raw(&acknowledge)[0].clone()), (3, Ok(())));
}

#[test]
fn every_message_with_one_changed_byte_is_counted_and_without_effect() {
    let mut rig = Rig::with_image(&image_of(straight()));
    rig.enable();
    let arming = request(500, Ask::Arm(rig.request(1)));
    for at in 0..arming.len() - 1 {
        for flip in [1, 0x80, 0xFF, arming[at]] {
            let mut damaged = arming.clone();
            damaged[at] ^= flip;
            let before = rig.status().counters.messages_damaged;
            assert!(rig.raw(&damaged).is_empty(), "byte {at}, {flip}");
            assert!(rig.status().counters.messages_damaged > before);
            assert_eq!(rig.mode(), Mode::Bypass);
        }
    }
    assert_eq!(response(rig.raw(&arming)[0].clone()), (500, Ok(())));
}

#[test]
fn every_message_cut_short_is_without_effect_and_the_next_one_is_understood() {
    let mut rig = Rig::new();
    let hello = request(7, Ask::Hello);
    for cut in 1..hello.len() {
        let mut bytes = hello[..cut].to_vec();
        if cut < hello.len() {
            bytes.push(0);
        }
        if cut < hello.len() - 1 {
            assert!(rig.raw(&bytes).is_empty());
        } else {
            assert_eq!(rig.raw(&bytes).len(), 1, "only its delimiter was missing");
        }
        assert_eq!(rig.raw(&hello).len(), 1);
    }
}

#[test]
fn a_message_that_is_too_long_is_passed_over() {
    let mut rig = Rig::new();
    for length in [PACKET_BYTES, PACKET_BYTES + 1, 20 * PACKET_BYTES] {
        let mut bytes = vec![1; length];
        bytes.push(0);
        bytes.extend(request(1, Ask::Hello));
        let before = rig.status().counters.messages_damaged;
        assert_eq!(rig.raw(&bytes).len(), 1);
        assert_eq!(rig.status().counters.messages_damaged, before + 1);
    }
}

#[test]
fn a_request_of_another_version_is_answered_as_unknown() {
    let mut rig = Rig::new();
    // id 300, request number 36 to 127: not there in this version.
    for number in 36..128 {
        assert_eq!(response(rig.raw(&sealed(&[0xAC, 0x02, number]))[0].clone()), (300, Err(Denial::Unknown)));
    }
    // Hello with a byte too many.
    assert_eq!(response(rig.raw(&sealed(&[5, 0, 9]))[0].clone()), (5, Err(Denial::Unknown)));
    assert_eq!(response(rig.raw(&sealed(&[5, 0]))[0].clone()), (5, Ok(())));
}

#[test]
fn the_smallest_client_is_understood() {
    // Written from the document alone: id 1 and Hello in postcard, CRC-32, COBS.
    let mut packet = [0; PACKET_BYTES];
    let used = encode(&Request { id: 1, ask: Ask::Hello }, &mut packet).unwrap();
    assert_eq!(packet[..used], sealed(&[1, 0]));
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(64))]

    #[test]
    fn garbage_on_both_links_moves_nothing(
        pieces in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..200), 1..40),
        contents in prop::collection::vec(prop::collection::vec(any::<u8>(), 0..60), 0..40),
    ) {
        let image = image_of(straight());
        let mut rig = Rig::with_image(&image);
        rig.enable();
        rig.arm(1).unwrap();
        for piece in &pieces {
            rig.raw(piece);
            prop_assert!(rig.stream(piece).is_empty());
        }
        rig.raw(&[0]);
        rig.stream(&[0]);
        let status = rig.status();
        prop_assert_eq!(status.mode, Mode::Armed);
        prop_assert!(rig.stay().is_some());
        // Undamaged messages with any content: whatever they are taken for, the device goes on answering.
        for content in &contents {
            rig.raw(&sealed(content));
        }
        prop_assert!(rig.status().active.is_some() || rig.mode() != Mode::Active);
        rig.reset(ResetCause::Watchdog);
        prop_assert_eq!(rig.mode(), Mode::Off);
        prop_assert!(!rig.status().drive_enable);
    }
}
