//! Frames of the setpoint link: there and back, damaged in every bit, of every wrong length.

use proptest::prelude::*;
use truepath_wire::link::{
    AnswerFrame, LINK_VERSION, LinkError, MAX_ANSWER_BYTES, MAX_SETPOINT_BYTES, MAX_STUFFED, SetpointFrame,
    answer_bytes, setpoint_bytes, stuff, unstuff,
};
use truepath_wire::rewrite::{AXES, Flags, Mode, Output, Place, Reason, Setpoint, Status};

fn seal(raw: &mut [u8]) {
    let end = raw.len() - 4;
    let crc = truepath_units::checksum::crc32(&raw[..end]);
    raw[end..].copy_from_slice(&crc.to_le_bytes());
}

/// Some setpoint: numbers of all sizes and signs, zero bytes in all places.
fn a_setpoint() -> impl Strategy<Value = Setpoint> {
    let place = prop_oneof![any::<i64>(), (-4_000_000_000i64..4_000_000_000), Just(0), Just(i64::MIN)];
    (prop::array::uniform6(place), any::<(u32, u16, u32, u32, u16)>()).prop_map(
        |(axes, (spindle_millirpm, age, sequence, frame_crc, flags))| Setpoint {
            axes,
            spindle_millirpm,
            spindle_age_ticks: age.into(),
            sequence,
            frame_crc,
            flags: Flags(flags),
        },
    )
}

fn an_output() -> impl Strategy<Value = Output> {
    (
        prop::array::uniform6(any::<i64>()),
        any::<([i32; 6], bool, u32, u32, u32, u16)>(),
        0..6usize,
        0..Reason::ALL.len(),
    )
        .prop_map(|(axes, (correction_nm, forward, sequence, node, fraction, status), mode, reason)| Output {
            axes,
            correction_nm,
            forward,
            mode: [Mode::Off, Mode::Bypass, Mode::Armed, Mode::Active, Mode::Hold, Mode::Fault][mode],
            reason: Reason::ALL[reason],
            status: Status(status & 0x7fff),
            place: Place { node, fraction },
            sequence,
        })
}

/// What is left of a setpoint that travels with fewer axes.
fn cut<T: Default>(mut values: [T; AXES], axes: u8) -> [T; AXES] {
    values.iter_mut().skip(axes.into()).for_each(|v| *v = T::default());
    values
}

proptest! {
    #[test]
    fn a_setpoint_comes_back_as_it_went(setpoint in a_setpoint(), axes in 1..=6u8) {
        let mut raw = [0xaa; MAX_SETPOINT_BYTES];
        let frame = SetpointFrame { axes, setpoint };
        let bytes = frame.encode(&mut raw).unwrap();
        prop_assert_eq!(bytes, setpoint_bytes(axes));
        let expected = Setpoint { axes: cut(setpoint.axes, axes), ..setpoint };
        prop_assert_eq!(SetpointFrame::decode(&raw[..bytes], axes), Ok(expected));
        let mut packet = [0xaa; MAX_SETPOINT_BYTES + 2];
        prop_assert_eq!(frame.encode_packet(&mut packet), Ok(bytes + 2));
        prop_assert_eq!(packet[bytes + 1], 0);
        prop_assert!(!packet[..=bytes].contains(&0));
        prop_assert_eq!(unstuff(&mut packet[..=bytes]), Some(&raw[..bytes]));
    }

    #[test]
    fn an_answer_comes_back_as_it_went(output in an_output(), axes in 1..=6u8) {
        let mut raw = [0xaa; MAX_ANSWER_BYTES];
        let frame = AnswerFrame { axes, output };
        let bytes = frame.encode(&mut raw).unwrap();
        prop_assert_eq!(bytes, answer_bytes(axes));
        let (places, corrections) = (cut(output.axes, axes), cut(output.correction_nm, axes));
        let expected = Output { axes: places, correction_nm: corrections, ..output };
        prop_assert_eq!(AnswerFrame::decode(&raw[..bytes], axes), Ok(AnswerFrame { axes, output: expected }));
        let mut packet = [0xaa; MAX_ANSWER_BYTES + 2];
        prop_assert_eq!(frame.encode_packet(&mut packet), Ok(bytes + 2));
        prop_assert_eq!(unstuff(&mut packet[..=bytes]), Some(&raw[..bytes]));
    }

    #[test]
    fn every_flipped_bit_of_a_frame_and_of_its_packet_is_noticed(setpoint in a_setpoint(), axes in 1..=6u8) {
        let mut packet = [0; MAX_SETPOINT_BYTES + 2];
        let bytes = SetpointFrame { axes, setpoint }.encode_packet(&mut packet).unwrap();
        for bit in 0..8 * (bytes - 1) {
            let mut flipped = packet;
            flipped[bit / 8] ^= 1 << (bit % 8);
            let good = unstuff(&mut flipped[..bytes - 1]).is_some_and(|raw| SetpointFrame::decode(raw, axes).is_ok());
            prop_assert!(!good, "bit {bit} of the packet");
        }
        let raw = unstuff(&mut packet[..bytes - 1]).unwrap().to_vec();
        for bit in 0..8 * raw.len() {
            let mut flipped = raw.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            let found = SetpointFrame::decode(&flipped, axes);
            prop_assert!(matches!(found, Err(LinkError::Checksum { .. })), "bit {bit} of the frame: {found:?}");
        }
    }

    #[test]
    fn random_bytes_are_no_frame_and_never_a_panic(bytes in prop::collection::vec(any::<u8>(), 0..300), axes in 0..=8u8) {
        prop_assert!(SetpointFrame::decode(&bytes, axes).is_err());
        prop_assert!(AnswerFrame::decode(&bytes, axes).is_err());
        let mut packet = bytes.clone();
        let _ = unstuff(&mut packet);
        let mut packet = bytes;
        let _ = stuff(&mut packet);
    }

    #[test]
    fn the_stuffing_is_that_of_the_cobs_crate(zeros: bool, bytes in prop::collection::vec(0..=255u8, 0..=MAX_STUFFED)) {
        // Half of the frames consist mostly of zeros.
        let frame: Vec<u8> = bytes.into_iter().map(|b| if zeros && b < 200 { 0 } else { b }).collect();
        let mut packet = vec![0; frame.len() + 2];
        packet[1..=frame.len()].copy_from_slice(&frame);
        prop_assert_eq!(stuff(&mut packet), frame.len() + 2);
        let mut expected = vec![0; cobs::max_encoding_length(frame.len())];
        let used = cobs::encode(&frame, &mut expected);
        prop_assert_eq!(&packet[..used], &expected[..used]);
        prop_assert_eq!(&packet[used..], &[0]);
        prop_assert_eq!(unstuff(&mut packet[..used]), Some(&frame[..]));
    }

    #[test]
    fn what_is_not_cobs_is_refused_as_by_the_cobs_crate(bytes in prop::collection::vec(1..=255u8, 1..=MAX_STUFFED + 1)) {
        let mut expected = bytes.clone();
        let decoded = cobs::decode_in_place(&mut expected).ok();
        let mut packet = bytes;
        // A block of 254 bytes without a zero is longer than any frame here.
        if !packet.contains(&0xff) {
            prop_assert_eq!(unstuff(&mut packet), decoded.map(|used| &expected[..used]));
        }
    }
}

#[test]
fn what_is_too_short_or_too_long_to_be_stuffed_is_left_as_it_is() {
    for length in [0, 1, MAX_STUFFED + 3, 300, 1_000] {
        let mut packet = vec![7; length];
        assert_eq!((stuff(&mut packet), &packet[..]), (0, &vec![7; length][..]));
    }
    for length in [2, MAX_STUFFED + 2] {
        let mut packet = vec![7; length];
        assert_eq!(stuff(&mut packet), length);
        assert_eq!((usize::from(packet[0]), packet[length - 1]), (length - 1, 0));
    }
    // Whole ways, of 85 and of 127 bytes: it is the length alone.
    assert_eq!(unstuff(&mut [85; MAX_STUFFED + 2]), None);
    assert!(unstuff(&mut [127; MAX_STUFFED + 1]).is_some());
}

#[test]
fn a_frame_of_another_length_kind_version_or_number_of_axes_is_refused_by_name() {
    let mut raw = [0; MAX_SETPOINT_BYTES + 1];
    let bytes = SetpointFrame { axes: 3, setpoint: Setpoint::default() }.encode(&mut raw).unwrap();
    for length in (0..raw.len()).filter(|&l| l != bytes) {
        let expected = Err(LinkError::Length { expected: bytes, found: length });
        assert_eq!(SetpointFrame::decode(&raw[..length], 3), expected);
    }
    let changed = |at: usize, to: u8| {
        let mut other = raw[..bytes].to_vec();
        other[at] = to;
        seal(&mut other);
        SetpointFrame::decode(&other, 3)
    };
    assert_eq!(changed(0, b'C'), Err(LinkError::Kind { found: b'C' }));
    assert_eq!(changed(1, LINK_VERSION + 1), Err(LinkError::Version { found: LINK_VERSION + 1 }));
    assert_eq!(changed(2, 4), Err(LinkError::Axes { expected: 3, found: 4 }));
    assert_eq!(changed(3, 1), Err(LinkError::Reserved));
    assert!(changed(0, b'S').is_ok());
}

#[test]
fn an_answer_of_a_mode_or_reason_that_does_not_exist_is_refused() {
    let output = Output {
        axes: [1; 6],
        correction_nm: [2; 6],
        forward: true,
        mode: Mode::Active,
        reason: Reason::None,
        status: Status(0),
        place: Place::default(),
        sequence: 3,
    };
    let mut raw = [0; MAX_ANSWER_BYTES];
    let bytes = AnswerFrame { axes: 2, output }.encode(&mut raw).unwrap();
    let mut changed = |at: usize, to: u8| {
        let before = std::mem::replace(&mut raw[at], to);
        seal(&mut raw[..bytes]);
        let found = AnswerFrame::decode(&raw[..bytes], 2);
        raw[at] = before;
        found.map(|_| ())
    };
    assert_eq!(changed(3, 6), Err(LinkError::Reserved));
    assert_eq!(changed(8, 4), Err(LinkError::Reserved));
    assert_eq!(changed(9, 1), Err(LinkError::Reserved));
    assert_eq!(changed(0, b'S'), Err(LinkError::Kind { found: b'S' }));
    assert_eq!(changed(3, 3), Ok(()));
}

#[test]
fn a_buffer_that_is_too_short_or_a_number_of_axes_that_does_not_exist_is_refused() {
    let setpoint = Setpoint { spindle_age_ticks: 1 << 20, ..Setpoint::default() };
    for axes in 1..=6 {
        let frame = SetpointFrame { axes, setpoint };
        let mut raw = [0; MAX_SETPOINT_BYTES];
        let bytes = frame.encode(&mut raw).unwrap();
        assert_eq!(SetpointFrame::decode(&raw[..bytes], axes).unwrap().spindle_age_ticks, 65_535);
        assert_eq!(frame.encode(&mut raw[..bytes - 1]), Err(LinkError::Buffer));
        assert_eq!(frame.encode_packet(&mut raw[..bytes]), Err(LinkError::Buffer));
    }
    for axes in [0, 7, 255] {
        assert_eq!(SetpointFrame { axes, setpoint }.encode(&mut [0; 3_000]), Err(LinkError::Buffer));
    }
}

#[test]
fn a_frame_of_another_version_is_told_the_one_that_can_be_read() {
    let said = truepath_wire::link::LinkError::Version { found: 1 }.to_string();
    assert_eq!(said, format!("version 1 of the link, only {} can be read", truepath_wire::link::LINK_VERSION));
}
