//! The bytes of one frame and one message of each kind, in `core/wire/tests/data/link.txt`, so that another client can be
//! checked against them. `BLESS=1 cargo test` rewrites the file after a wanted change.

use crate::link_samples;
use link_samples::*;
use std::fmt::Write;
use truepath_wire::link::{AnswerFrame, PACKET_BYTES, Request, Response, SetpointFrame, encode, unstuff};
use truepath_wire::rewrite::{Flags, Mode, Output, Place, Reason, Setpoint, Status};

fn hex(bytes: &[u8]) -> String {
    bytes.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").unwrap();
        text
    })
}

fn setpoint() -> Setpoint {
    Setpoint {
        axes: [125_000_000, -1, 0, 0, 0, 0],
        spindle_millirpm: 1_500_000,
        spindle_age_ticks: 3,
        sequence: 0x0102_0304,
        frame_crc: 0x89ab_cdef,
        flags: Flags::DRIVES_ENABLED.with(Flags::SPINDLE_LOADED),
    }
}

fn output() -> Output {
    Output {
        axes: [124_976_000, 89_999, 0, 0, 0, 0],
        correction_nm: [-24_000, 90_000, 0, 0, 0, 0],
        forward: true,
        mode: Mode::Active,
        reason: Reason::None,
        status: Status::WARN,
        place: Place { node: 99, fraction: 1 << 29 },
        sequence: 0x0102_0304,
    }
}

fn text() -> String {
    let mut text = String::from(
        "# One frame and one message of each kind, to check another client against; docs/link.md has the formats.\n\
         # Name; bytes with their CRC-32, before COBS; the packet as it travels, with its 0x00.\n",
    );
    let mut entry = |name: &str, raw: &[u8], packet: &[u8]| {
        writeln!(text, "{name}\n  {}\n  {}", hex(raw), hex(packet)).unwrap();
    };
    let mut packet = [0; 100];
    let used = SetpointFrame { axes: 3, setpoint: setpoint() }.encode_packet(&mut packet).unwrap();
    entry("setpoint frame, 3 axes", unstuff(&mut { packet }[..used - 1]).unwrap(), &packet[..used]);
    let used = AnswerFrame { axes: 3, output: output() }.encode_packet(&mut packet).unwrap();
    entry("answer frame, 3 axes", unstuff(&mut { packet }[..used - 1]).unwrap(), &packet[..used]);
    let mut message = |name: String, encoded: &dyn Fn(&mut [u8]) -> usize| {
        let mut packet = vec![0; PACKET_BYTES];
        let used = encoded(&mut packet);
        let mut raw = packet[..used].to_vec();
        let length = cobs::decode_in_place(&mut raw).unwrap();
        entry(&name, &raw[..length], &packet[..used]);
    };
    for (name, ask) in asks() {
        message(format!("request 300, {name}"), &|to| encode(&Request { id: 300, ask }, to).unwrap());
    }
    for (name, reply) in replies() {
        let response = Response { id: 300, answer: Ok(reply) };
        message(format!("response 300, {name}"), &|to| encode(&response, to).unwrap());
    }
    for (name, denial) in denials() {
        let response = Response { id: 300, answer: Err(denial) };
        message(format!("response 300, denial {name}"), &|to| encode(&response, to).unwrap());
    }
    text
}

#[test]
fn the_bytes_of_every_frame_and_message_are_those_of_the_file() {
    let path = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/data/link.txt");
    if std::env::var_os("BLESS").is_some() {
        std::fs::write(path, text()).unwrap();
    }
    let file = std::fs::read_to_string(path).unwrap();
    for (computed, stored) in text().lines().zip(file.lines()) {
        assert_eq!(computed, stored);
    }
    assert_eq!(text().lines().count(), file.lines().count());
}

/// Worked out by hand from the tables of `docs/link.md`.
#[test]
fn the_setpoint_frame_is_that_of_the_document_byte_for_byte() {
    let mut raw = [0; 100];
    let used = SetpointFrame { axes: 3, setpoint: setpoint() }.encode(&mut raw).unwrap();
    let head = [0x53, 2, 3, 0, 4, 3, 2, 1, 5, 0, 3, 0, 0x60, 0xe3, 0x16, 0, 0xef, 0xcd, 0xab, 0x89];
    assert_eq!(raw[..20], head);
    assert_eq!(raw[20..28], [0x40, 0x59, 0x73, 0x07, 0, 0, 0, 0]);
    assert_eq!((raw[28..36].to_vec(), raw[36..44].to_vec()), (vec![0xff; 8], vec![0; 8]));
    assert_eq!(used, 48);
}
