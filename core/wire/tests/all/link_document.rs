//! `docs/link.md` against the code: frames, flags, verdicts and sizes.

use crate::document;
use document::*;
use truepath_units::checksum::crc32;
use truepath_wire::link::{
    AnswerFrame, BEHIND, CHUNK_BYTES, DeviceSettings, Endpoint, FORWARD, LINK_VERSION, MESSAGE_BYTES, PACKET_BYTES,
    RESTART_AFTER, SetpointFrame, TRACE_SAMPLES, Verdict, answer_bytes, setpoint_bytes,
};
use truepath_wire::rewrite::{Flags, Mode, Output, Place, Reason, Rewriter, Setpoint, Settings, SpentList, Status};

const ONES: Setpoint = Setpoint {
    axes: [-1; 6],
    spindle_millirpm: u32::MAX,
    spindle_age_ticks: 0xffff,
    sequence: u32::MAX,
    frame_crc: u32::MAX,
    flags: Flags(u16::MAX),
};

fn output() -> Output {
    Output {
        axes: [0; 6],
        correction_nm: [0; 6],
        forward: false,
        mode: Mode::Off,
        reason: Reason::None,
        status: Status(0),
        place: Place::default(),
        sequence: 0,
    }
}

fn bytes_of(setpoint: Setpoint, axes: u8) -> Vec<u8> {
    let mut raw = vec![0; 200];
    let used = SetpointFrame { axes, setpoint }.encode(&mut raw).unwrap();
    raw.truncate(used);
    raw
}

fn answer_of(output: Output, axes: u8) -> Vec<u8> {
    let mut raw = vec![0; 200];
    let used = AnswerFrame { axes, output }.encode(&mut raw).unwrap();
    raw.truncate(used);
    raw
}

/// Offset and length of what differs, the checksum aside.
fn differing(a: &[u8], b: &[u8]) -> (usize, usize) {
    let end = a.len() - 4;
    let at: Vec<_> = (0..end).filter(|&i| a[i] != b[i]).collect();
    (at[0], at[at.len() - 1] + 1 - at[0])
}

/// Every field of a frame is where the table says, for every number of axes.
fn check_places(section: &str, whole: fn(u8) -> usize, field: impl Fn(&str, u8) -> Option<(usize, usize)>) {
    let page = page("link.md");
    for n in 1..=6u8 {
        let mut end = 0;
        for row in table(&page, section, "| offset") {
            let place = (value(&row[0], n.into()), value(&row[1], n.into()));
            assert_eq!(place.0, end, "{}", row[2]);
            end = place.0 + place.1;
            if let Some(found) = field(&row[2], n) {
                assert_eq!(found, place, "{} with {n} axes", row[2]);
            }
        }
        assert_eq!(end, whole(n));
    }
}

#[test]
fn the_setpoint_frame_lies_as_the_table_says() {
    check_places("Setpoint frame: 24 + 8 n bytes", setpoint_bytes, |field, n| {
        let zero = Setpoint::default();
        let one = match field.split([' ', ',', '(']).next().unwrap() {
            "kind" | "version" | "number" | "0" | "CRC-32" => return None,
            "sequence" => Setpoint { sequence: u32::MAX, ..zero },
            "flags" => Setpoint { flags: ONES.flags, ..zero },
            "age" => Setpoint { spindle_age_ticks: 0xffff, ..zero },
            "spindle" => Setpoint { spindle_millirpm: u32::MAX, ..zero },
            "checksum" => Setpoint { frame_crc: u32::MAX, ..zero },
            "commanded" => Setpoint { axes: ONES.axes, ..zero },
            other => panic!("{other}"),
        };
        Some(differing(&bytes_of(zero, n), &bytes_of(one, n)))
    });
    let raw = bytes_of(ONES, 5);
    assert_eq!(raw[..4], [0x53, LINK_VERSION, 5, 0]);
    assert_eq!(raw[raw.len() - 4..], crc32(&raw[..raw.len() - 4]).to_le_bytes());
}

#[test]
fn the_answer_frame_lies_as_the_table_says() {
    check_places("Answer frame: 24 + 12 n bytes", answer_bytes, |field, n| {
        let zero = output();
        let one = match field.split([' ', ',', ':']).next().unwrap() {
            "kind" | "version" | "number" | "mode" | "reason" | "CRC-32" => return None,
            "sequence" => Output { sequence: u32::MAX, ..zero },
            "status" => Output { status: Status(0x7fff), forward: true, ..zero },
            "node" => Output { place: Place { node: u32::MAX, fraction: 0 }, ..zero },
            "place" => Output { place: Place { node: 0, fraction: u32::MAX }, ..zero },
            "correction" => Output { correction_nm: [-1; 6], ..zero },
            "position" => Output { axes: [-1; 6], ..zero },
            other => panic!("{other}"),
        };
        Some(differing(&answer_of(zero, n), &answer_of(one, n)))
    });
    let raw = answer_of(Output { mode: Mode::Fault, reason: Reason::JointLimit, ..output() }, 5);
    assert_eq!(raw[..4], [0x43, LINK_VERSION, 5, 5]);
    assert_eq!(raw[8..10], 30u16.to_le_bytes());
    assert_eq!(raw[raw.len() - 4..], crc32(&raw[..raw.len() - 4]).to_le_bytes());
}

#[test]
fn flags_status_bits_modes_and_reasons_have_the_numbers_of_the_tables() {
    let page = page("link.md");
    let flags = [
        ("drives enabled", Flags::DRIVES_ENABLED),
        ("feed hold", Flags::FEED_HOLD),
        ("spindle loaded", Flags::SPINDLE_LOADED),
        ("abort", Flags::ABORT),
        ("emergency stop", Flags::EMERGENCY_STOP),
        ("program end", Flags::PROGRAM_END),
        ("tool change", Flags::TOOL_CHANGE),
    ];
    let rows = table(&page, "Setpoint frame", "| flag");
    assert_eq!(rows.len(), flags.len());
    for (row, (name, flag)) in rows.iter().zip(flags) {
        assert_eq!((row[0].as_str(), 1 << value(&row[1], 0)), (name, flag.0));
    }
    let status = [
        (Status::WARN.0, "warn"),
        (Status::SATURATED.0, "saturated"),
        (Status::LAGGING.0, "lagging"),
        (Status::FADED.0, "faded"),
        (Status::JOINT_LIMITED.0, "joint limited"),
        (FORWARD, "forward"),
    ];
    let listed: Vec<_> = status.iter().map(|(bit, name)| format!("{} {name}", bit.trailing_zeros())).collect();
    assert!(page.contains(&format!("status bits: {}", listed.join(", "))), "{listed:?}");
    let modes = [Mode::Off, Mode::Bypass, Mode::Armed, Mode::Active, Mode::Hold, Mode::Fault];
    let listed: Vec<_> = modes.iter().map(|mode| format!("{} {mode}", *mode as u8)).collect();
    assert!(page.contains(&format!("mode: {}", listed.join(", "))));
    let reasons: Vec<_> = Reason::ALL.iter().map(|r| vec![r.code().to_string(), r.to_string()]).collect();
    assert_eq!(table(&page, "Types", "| reason"), reasons);
    assert!(Reason::ALL.iter().all(|r| r.is_fault() == (r.code() >= 16)));
    let faults: Vec<_> = Reason::ALL.iter().filter(|r| r.is_fault()).map(|r| usize::from(r.code() - 16)).collect();
    assert_eq!(faults, (0..Reason::FAULTS).collect::<Vec<_>>());
    assert!(page.contains(&format!("`faults`: {} × u32", Reason::FAULTS)));
}

/// Gives sequences to an endpoint; the verdict on the last one.
fn verdict(sequences: &[u32], damage: bool) -> (Verdict, bool) {
    let rewriter = Rewriter::new(Settings::at_1_khz(), None).unwrap();
    let mut endpoint = Endpoint::new(DeviceSettings::at_1_khz(), SpentList::EMPTY);
    let mut last = (Verdict::Repeated, false);
    for (i, &sequence) in sequences.iter().enumerate() {
        let mut raw = bytes_of(Setpoint { sequence, ..Setpoint::default() }, 3);
        raw[30] ^= u8::from(damage && i + 1 == sequences.len());
        let now_us = 1_000 * i as u64;
        let verdict = endpoint.frame(&rewriter, &raw, now_us);
        last = (verdict, endpoint.answer(now_us, &mut [0; 100]).is_some());
    }
    last
}

#[test]
fn what_becomes_of_a_frame_is_what_the_table_says() {
    let rows = table(&page("link.md"), "What becomes of a frame", "| what comes");
    let examples = [
        ("next sequence", verdict(&[7, 8], false)),
        ("damaged", verdict(&[7, 8], true)),
        ("same sequence", verdict(&[7, 7], false)),
        ("1…63 before", verdict(&[70, 7], false)),
        ("the 4th refused", verdict(&[70, 7, 8, 9, 10], false)),
        ("gap of g frames", verdict(&[7, 10], false)),
        ("larger gap", verdict(&[7, 11], false)),
    ];
    for (row, (begins, (verdict, answered))) in rows.iter().zip(examples) {
        assert!(row[0].starts_with(begins), "{}", row[0]);
        let name: String = format!("{verdict:?}").chars().take_while(|c| c.is_alphabetic()).collect();
        assert!(quoted(&row[1])[0].starts_with(&name), "{}: {verdict:?}", row[0]);
        assert_eq!(if answered { "yes" } else { "none" }, row[2].replace("as a jump", "yes"));
    }
    // Late and silence are no verdicts on a frame; tests of the endpoint hold them.
    assert_eq!(rows.len(), examples.len() + 2);
    assert_eq!((BEHIND, RESTART_AFTER), (63, 4));
    assert_eq!(verdict(&[70, 6], false).0, Verdict::Jump);
    assert_eq!(verdict(&[70, 7, 8, 9], false).0, Verdict::OutOfOrder);
}

#[test]
fn the_sizes_of_the_text_are_those_of_the_code() {
    let page = page("link.md").replace('\n', " ");
    let thousands = |n: usize| format!("{},{:03}", n / 1_000, n % 1_000);
    for text in [
        format!("A message is at most {} bytes before COBS", thousands(MESSAGE_BYTES)),
        format!("0x00 at its end at most {}", thousands(PACKET_BYTES)),
        format!("up to {} bytes at the offset", thousands(CHUNK_BYTES)),
        format!("up to {TRACE_SAMPLES} samples"),
        format!("version of the link, {LINK_VERSION} "),
        format!("is 0x{:X})", crc32(b"123456789")),
    ] {
        assert!(page.contains(&text), "{text}");
    }
}
