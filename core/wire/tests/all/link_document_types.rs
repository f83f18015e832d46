//! `docs/link.md` against the code: requests, replies, denials and the types in them.

use crate::document;
use crate::link_samples;
use document::*;
use link_samples::*;
use serde::Serialize;
use truepath_wire::image::{Binding, DeviceClass, Role};
use truepath_wire::link::{
    ActiveImage, Change, ComputeFailure, Computed, DeviceSettings, Item, PACKET_BYTES, Progress, Request, ResetCause,
    Response, SessionEnd, Slot, Stage, UpdateStage, encode,
};
use truepath_wire::rewrite::{Mode, Settings};

/// Postcard of a message, without its checksum.
fn content<T: Serialize>(message: &T) -> Vec<u8> {
    let mut packet = vec![0; PACKET_BYTES];
    let used = encode(message, &mut packet).unwrap();
    packet.truncate(used);
    let length = cobs::decode_in_place(&mut packet).unwrap();
    packet[..length - 4].to_vec()
}

/// A row names a variant as `Name`, `Name(…)` or `Name { field: type, … }`: its number, name and fields.
fn check_row(row: &[String], index: usize, name: &str, debug: &str) {
    assert_eq!(row[0], index.to_string(), "{name}");
    let named = &quoted(&row[1])[0];
    let (listed, fields_listed) = named_fields(named);
    assert_eq!(listed, name);
    let (_, found) = fields(debug);
    assert_eq!(fields_listed, found, "{name}");
}

/// `Name { a: u8, b }` → `Name` and `a`, `b`.
fn named_fields(named: &str) -> (String, Vec<String>) {
    let name = named.split([' ', '(']).next().unwrap().to_owned();
    let Some((_, body)) = named.split_once('{') else {
        return (name, vec![]);
    };
    let fields = body.trim_end_matches('}').split(',').map(|f| f.split(':').next().unwrap().trim().to_owned());
    (name, fields.collect())
}

#[test]
fn requests_have_the_numbers_and_fields_of_the_table() {
    let rows = table(&page("link.md"), "Configuration link", "| index | `Ask`");
    assert_eq!(rows.len(), asks().len());
    for (index, (row, (name, ask))) in rows.iter().zip(asks()).enumerate() {
        assert_eq!(usize::from(content(&Request { id: 1, ask })[1]), index);
        check_row(row, index, name, &format!("{ask:?}"));
        assert_eq!(row[3], ask.least().name(), "{name}");
    }
}

#[test]
fn replies_have_the_numbers_and_fields_of_the_table() {
    let rows = table(&page("link.md"), "Configuration link", "| index | `Reply`");
    assert_eq!(rows.len(), replies().len());
    for (index, (row, (name, reply))) in rows.iter().zip(replies()).enumerate() {
        let debug = format!("{reply:?}");
        let bytes = content(&Response { id: 1, answer: Ok(reply) });
        assert_eq!((bytes[1], usize::from(bytes[2])), (0, index));
        check_row(row, index, name, &debug);
    }
}

#[test]
fn denials_have_the_numbers_and_fields_of_the_table() {
    let rows = table(&page("link.md"), "Configuration link", "| index | `Denial`");
    assert_eq!(rows.len(), denials().len());
    for (index, (row, (name, denial))) in rows.iter().zip(denials()).enumerate() {
        let bytes = content(&Response { id: 1, answer: Err(denial) });
        assert_eq!((bytes[1], usize::from(bytes[2])), (1, index));
        check_row(row, index, name, &format!("{denial:?}"));
    }
}

#[test]
fn types_have_the_fields_of_the_table_in_its_order() {
    let computed = Computed { slot: 0, crc: 0, length: 0 };
    let failure = ComputeFailure { stage: Stage::Idle, code: 0, line: 0, column: 0 };
    let printed = [
        format!("{:?}", arm_request()),
        format!("{:?}", Binding::default()),
        format!("{:?}", arm_request().frame),
        format!("{:?}", arm_request().frame.axes[0]),
        format!("{:?}", DeviceSettings::at_1_khz()),
        format!("{:?}", Settings::at_1_khz()),
        format!("{:?}", hello()),
        format!("{:?}", status()),
        format!("{:?}", keys()),
        format!("{:?}", keys().keys),
        format!("{:?}", ActiveImage { slot: 0, crc: 0 }),
        format!("{:?}", counters()),
        format!("{:?}", log_entry()),
        format!("{:?}", session()),
        format!("{:?}", session().rights[0]),
        format!("{:?}", update()),
        format!("{:?}", update().running.unwrap()),
        format!("{:?}", sample()),
        format!("{:?}", sample().place),
        format!("{:?}", timing()),
        format!("{:?}", timing().arrivals),
        format!("{:?}", Progress::default()),
        format!("{computed:?}"),
        format!("{failure:?}"),
    ];
    let rows = table(&page("link.md"), "Types", "| type");
    assert_eq!(rows.len(), printed.len());
    for (row, debug) in rows.iter().zip(printed) {
        let (name, mut found) = fields(&debug);
        // Rights travel in `DeviceSession` alone, and that to sign firmware in requests and replies of its own.
        found.retain(|field| (name != "KeyRing" || field != "rights") && (name != "Rights" || field != "firmware"));
        assert_eq!(quoted(&row[0]), [name]);
        // Types in the cell are written with a capital letter, fields with a small one.
        let listed: Vec<_> = quoted(&row[1]).into_iter().filter(|w| w.starts_with(char::is_lowercase)).collect();
        assert_eq!(listed, found);
    }
}

#[test]
fn enums_have_the_variants_of_the_table_in_its_order() {
    let names = |variants: Vec<(u8, String)>| -> Vec<(String, Vec<String>)> {
        variants.iter().enumerate().for_each(|(i, (byte, name))| assert_eq!(usize::from(*byte), i, "{name}"));
        variants.iter().map(|(_, debug)| fields(debug)).collect()
    };
    fn first<T: Serialize + std::fmt::Debug>(values: &[T]) -> Vec<(u8, String)> {
        values.iter().map(|value| (content(value)[0], format!("{value:?}"))).collect()
    }
    use Stage::{Correct, Cut, Ended, Identify, Idle, Job, Probe, Program, Write};
    let image = Slot::Image { length: 0, crc: 0, generation: 0, active: false, binding: BINDING };
    let causes = [
        ResetCause::Unknown,
        ResetCause::PowerOn,
        ResetCause::BrownOut,
        ResetCause::Pin,
        ResetCause::Software,
        ResetCause::Watchdog,
    ];
    let expected = [
        ("Mode", names(first(&[Mode::Off, Mode::Bypass, Mode::Armed, Mode::Active, Mode::Hold, Mode::Fault]))),
        ("Item", names(first(&[Item::Image, Item::Program, Item::Job, Item::Probe, Item::Firmware]))),
        ("ResetCause", names(first(&causes))),
        ("DeviceClass", names(first(&DeviceClass::ALL))),
        ("Slot", names(first(&[Slot::Empty, Slot::Partial { length: 0, crc: 0, written: 0 }, Slot::Damaged, image]))),
        ("Change", names(first(&Change::ALL))),
        ("Role", names(first(&Role::ALL))),
        ("SessionEnd", names(first(&SessionEnd::ALL))),
        ("UpdateStage", names(first(&UpdateStage::ALL))),
        ("Stage", names(first(&[Idle, Job, Program, Probe, Cut, Identify, Correct, Write, Ended]))),
    ];
    let rows = table(&page("link.md"), "Types", "| enum");
    assert_eq!(rows.len(), expected.len());
    for (row, (name, variants)) in rows.iter().zip(expected) {
        assert_eq!(quoted(&row[0]), [name]);
        let listed: Vec<_> = quoted(&row[1]).iter().map(|variant| named_fields(variant)).collect();
        assert_eq!(listed, variants, "{name}");
    }
}
