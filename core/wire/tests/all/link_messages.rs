//! Messages of the configuration link: there and back, damaged in every bit, too long, of another version.

use crate::link_samples;
use link_samples::*;
use proptest::prelude::*;
use truepath_wire::image::{KeyId, Role};
use truepath_wire::link::{
    Ask, CHUNK_BYTES, Change, Denial, DeviceSetting, DeviceSettings, DeviceSettingsError, LinkError, MESSAGE_BYTES,
    PACKET_BYTES, Reply, Request, Response, TRACE_SAMPLES, TraceSample, decode, decode_request, encode, encode_request,
    login_message,
};
use truepath_wire::rewrite::{Mode, Place, Reason, Setting, SettingsError, Status};

fn packet_of<T: serde::Serialize>(message: &T) -> Vec<u8> {
    let mut packet = vec![0xaa; PACKET_BYTES];
    let bytes = encode(message, &mut packet).unwrap();
    packet.truncate(bytes);
    assert_eq!(packet.iter().position(|&b| b == 0), Some(bytes - 1), "0x00 only at the end");
    packet
}

/// A packet of any content with the right checksum.
fn sealed(content: &[u8]) -> Vec<u8> {
    let crc = truepath_units::checksum::crc32(content).to_le_bytes();
    let raw = [content, &crc[..]].concat();
    let mut packet = vec![0; cobs::max_encoding_length(raw.len())];
    let used = cobs::encode(&raw, &mut packet);
    packet.truncate(used);
    packet
}

#[test]
fn every_request_reply_and_denial_comes_back_as_it_went() {
    for (name, ask) in asks() {
        let request = Request { id: 0xbeef, ask };
        assert_eq!(decode::<Request>(&mut packet_of(&request)), Ok(request), "{name}");
    }
    for (name, reply) in replies() {
        let response = Response { id: 1, answer: Ok(reply) };
        assert_eq!(decode::<Response>(&mut packet_of(&response)), Ok(response), "{name}");
    }
    for (name, denial) in denials() {
        let response = Response { id: 0, answer: Err(denial) };
        assert_eq!(decode::<Response>(&mut packet_of(&response)), Ok(response), "{name}");
    }
}

#[test]
fn every_flipped_bit_of_a_message_is_noticed() {
    let requests = asks().into_iter().map(|(_, ask)| packet_of(&Request { id: 7, ask }));
    let responses = replies().into_iter().map(|(_, reply)| packet_of(&Response { id: 7, answer: Ok(reply) }));
    for packet in requests.chain(responses) {
        for bit in 0..8 * (packet.len() - 1) {
            let mut flipped = packet.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            let (as_request, as_response) = (&mut flipped.clone(), &mut flipped);
            assert!(decode::<Request>(as_request).is_err(), "bit {bit}");
            assert!(decode::<Response>(as_response).is_err(), "bit {bit}");
        }
        for end in 0..packet.len() - 1 {
            assert!(decode::<Request>(&mut packet[..end].to_vec()).is_err());
        }
    }
}

#[test]
fn the_longest_messages_fit_and_longer_ones_are_refused() {
    let bytes = [0x5a; CHUNK_BYTES];
    let request = Request { id: u16::MAX, ask: Ask::Chunk { offset: u32::MAX, bytes: &bytes } };
    assert!(packet_of(&request).len() <= PACKET_BYTES);
    let reply = Reply::Recording { total: u32::MAX, from: u32::MAX, bytes: &bytes };
    assert!(packet_of(&Response { id: u16::MAX, answer: Ok(reply) }).len() <= PACKET_BYTES);
    let widest = TraceSample {
        sequence: u32::MAX,
        mode: Mode::Fault,
        reason: Reason::Silence,
        status: Status(u16::MAX),
        place: Place { node: u32::MAX, fraction: u32::MAX },
        correction_nm: [i32::MIN; 2],
        feed_ratio: u32::MAX,
    };
    let samples = [widest; TRACE_SAMPLES].into_iter().collect();
    packet_of(&Response { id: u16::MAX, answer: Ok(Reply::Trace { dropped: u32::MAX, samples }) });

    let long = [0x5a; MESSAGE_BYTES];
    let fits = |bytes: usize, room: usize| {
        let request = Request { id: 0, ask: Ask::Chunk { offset: 0, bytes: &long[..bytes] } };
        encode(&request, &mut vec![0; room]).is_ok()
    };
    // id, index, offset: a byte each; length: two; checksum: four.
    assert!(fits(MESSAGE_BYTES - 9, PACKET_BYTES) && !fits(MESSAGE_BYTES - 8, PACKET_BYTES));
    assert!(!fits(MESSAGE_BYTES - 9, PACKET_BYTES - 1));
    for room in 0..20 {
        assert_eq!(fits(10, room), room == 21, "{room}");
    }
    assert!(fits(10, 21));
}

#[test]
fn an_undamaged_message_of_another_version_is_told_apart_with_its_id() {
    // Postcard: id 300 takes two bytes.
    let id = [0xac, 0x02];
    let unknown = [&id[..], &[asks().len() as u8]].concat();
    assert_eq!(decode::<Request>(&mut sealed(&unknown)), Err(LinkError::Content { id: 300 }));
    let longer = [&id[..], &[0, 0]].concat();
    assert_eq!(decode::<Request>(&mut sealed(&longer)), Err(LinkError::Content { id: 300 }));
    let known = [&id[..], &[0]].concat();
    assert_eq!(decode::<Request>(&mut sealed(&known)), Ok(Request { id: 300, ask: Ask::Hello }));
    assert_eq!(decode::<Request>(&mut sealed(&[])), Err(LinkError::Content { id: 0 }));
    // A reason of a later version.
    let mut status = postcard_of(&Response { id: 1, answer: Ok(Reply::Status(status())) });
    assert_eq!(status[4], Reason::JointLimit.code() as u8);
    status[4] = 99;
    assert_eq!(decode::<Response>(&mut sealed(&status)), Err(LinkError::Content { id: 1 }));
}

fn postcard_of<T: serde::Serialize>(message: &T) -> Vec<u8> {
    let mut packet = packet_of(message);
    let raw = cobs::decode_in_place(&mut packet).unwrap();
    packet[..raw - 4].to_vec()
}

#[test]
fn settings_out_of_range_are_refused_by_name() {
    let good = DeviceSettings::at_1_khz();
    assert_eq!(good.check(), Ok(()));
    let range = |setting, value, low, high| Err(DeviceSettingsError::Range { setting, value, low, high });
    let with = |change: &dyn Fn(&mut DeviceSettings)| {
        let mut other = good;
        change(&mut other);
        other.check()
    };
    assert_eq!(with(&|s| s.axes = 0), range(DeviceSetting::Axes, 0, 1, 6));
    assert_eq!(with(&|s| s.axes = 7), range(DeviceSetting::Axes, 7, 1, 6));
    assert_eq!(with(&|s| s.deadline_us = 9), range(DeviceSetting::Deadline, 9, 10, 1_000_000));
    // Two ticks more than may be lost: (2 + 2) ms at 1 kHz.
    assert_eq!(with(&|s| s.silence_us = 3_999), range(DeviceSetting::Silence, 3_999, 4_000, 10_000_000));
    assert_eq!(with(&|s| s.silence_us = 4_000), Ok(()));
    assert_eq!(with(&|s| s.deadline_us = 20_000), range(DeviceSetting::Silence, 20_000, 20_001, 10_000_000));
    let slow = with(&|s| s.rewriter.tick_hz = 9);
    let name = Setting::TickRate;
    let expected = SettingsError::Range { name, value: 9, low: 10, high: 100_000 };
    assert_eq!(slow, Err(DeviceSettingsError::Rewriter(expected)));
    assert_eq!(slow.unwrap_err().to_string(), "tick rate (Hz) is 9, permitted 10 to 100000");
}

#[test]
fn every_denial_has_its_own_sentence() {
    let mut sentences: Vec<_> = denials().iter().map(|(_, denial)| denial.to_string()).collect();
    sentences.push(Denial::Incomplete { length: 5, written: 4 }.to_string());
    assert_eq!(sentences.last().unwrap(), "only 4 of 5 bytes have arrived");
    let count = sentences.len();
    sentences.sort();
    sentences.dedup();
    assert_eq!(sentences.len(), count);
}

proptest! {
    #[test]
    fn random_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400), valid: bool) {
        // With a good checksum it is postcard that has to cope.
        let mut packet = if valid { sealed(&bytes) } else { bytes };
        let mut copy = packet.clone();
        let as_request = decode::<Request>(&mut packet);
        prop_assert!(valid || as_request.is_err());
        let _ = decode::<Response>(&mut copy);
    }

    #[test]
    fn any_request_to_arm_and_any_chunk_comes_back(
        id: u16,
        offset_nm: [i64; 3],
        turn: [i32; 2],
        numbers: [u32; 7],
        bytes in prop::collection::vec(any::<u8>(), 0..=CHUNK_BYTES),
    ) {
        let mut arm = arm_request();
        (arm.frame.offset_nm, arm.frame.cosine, arm.frame.sine) = (offset_nm, turn[0], turn[1]);
        (arm.part_serial, arm.binding.program_crc, arm.frame.crc) = (numbers[0], numbers[1], numbers[2]);
        (arm.binding.feature, arm.binding.setup) = (numbers[3], numbers[4]);
        for ask in [Ask::Arm(arm), Ask::Check(arm), Ask::Chunk { offset: numbers[5], bytes: &bytes }] {
            let request = Request { id, ask };
            let mut packet = packet_of(&request);
            prop_assert_eq!(decode::<Request>(&mut packet), Ok(request));
        }
    }
}

#[test]
fn a_request_comes_back_with_the_number_of_its_session_and_nothing_else_may_stand_behind_it() {
    for (name, ask) in asks() {
        let request = Request { id: 300, ask };
        for session in [None, Some(0), Some(1), Some(0x0123_4567_89ab_cdef), Some(u64::MAX)] {
            let mut packet = vec![0xaa; PACKET_BYTES];
            let bytes = encode_request(&request, session, &mut packet).unwrap();
            assert_eq!(packet[..bytes].iter().position(|&b| b == 0), Some(bytes - 1), "0x00 only at the end");
            assert_eq!(decode_request(&mut packet[..bytes]), Ok((request, session)), "{name}");
        }
    }
    // The number is little endian; one that is cut off or too long is none.
    let known = [0xac, 0x02, 0];
    let behind = |bytes: &[u8]| {
        let mut packet = sealed(&[&known[..], bytes].concat());
        decode_request(&mut packet).map(|(_, session)| session)
    };
    assert_eq!(behind(&[1, 2, 0, 0, 0, 0, 0, 0]), Ok(Some(0x201)));
    for length in (1..=16).filter(|length| *length != 8) {
        assert_eq!(behind(&vec![7; length]), Err(LinkError::Content { id: 300 }), "{length} bytes");
    }
}

#[test]
fn what_is_signed_to_log_in_is_text_device_challenge_key_and_role() {
    let expected = [&b"truepath login 1"[..], &[1; 12], &[2; 32], &[3; 8], &[2]].concat();
    assert_eq!(login_message(&[1; 12], &[2; 32], KeyId([3; 8]), Role::Engineer)[..], expected[..]);
}

#[test]
fn every_change_of_the_log_comes_back_from_its_number_and_no_other_number_is_one() {
    for (number, change) in Change::ALL.into_iter().enumerate() {
        assert_eq!((change.number(), Change::of(number as u8)), (number as u8, Some(change)));
    }
    assert!((Change::ALL.len() as u8..=255).all(|number| Change::of(number).is_none()));
}
