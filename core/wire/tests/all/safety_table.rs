//! The table of `docs/safety.md` is that of the tests: the same text, every test exists, and those of the core take
//! their numbers from it. `BLESS=1 cargo test` rewrites the page after a wanted change.

use crate::document;
use crate::safety;
use safety::{rows, text};
use truepath_wire::link::DeviceSettings;
use truepath_wire::rewrite::Settings;

const BEGIN: &str = "<!-- table of core/wire/tests/all/safety -->\n";
const END: &str = "<!-- end of the table -->";

fn source(path: &str) -> String {
    let path = format!("{}/../../{path}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{path}: {error}"))
}

/// The function of a test with everything up to the next one, if it is a test.
fn test_body<'a>(source: &'a str, name: &str) -> Option<&'a str> {
    let (before, rest) = source.split_once(&format!("fn {name}("))?;
    let attribute = before.lines().rev().map(str::trim).find(|line| !line.is_empty())?;
    let body = rest.split("\n#[test]").next()?;
    (attribute == "#[test]").then_some(body)
}

#[test]
fn the_page_holds_the_table_of_the_tests() {
    let page = document::page("safety.md");
    let (head, rest) = page.split_once(BEGIN).expect("the mark of the table");
    let (table, tail) = rest.split_once(END).expect("the mark behind the table");
    if std::env::var_os("BLESS").is_some() {
        let path = concat!(env!("CARGO_MANIFEST_DIR"), "/../../docs/safety.md");
        std::fs::write(path, [head, BEGIN, &text(), END, tail].concat()).unwrap();
    } else {
        assert_eq!(table, text());
    }
}

#[test]
fn every_test_of_the_table_exists() {
    for row in rows() {
        assert!(!row.tests.is_empty(), "{}", row.event);
        for test in row.tests {
            let (path, name) = test.split_once("::").unwrap();
            assert!(test_body(&source(path), name).is_some(), "{}: no test {test}", row.event);
        }
    }
}

#[test]
fn the_tests_of_the_core_take_their_numbers_from_the_table() {
    for row in rows() {
        let own = row.tests.iter().filter(|test| test.starts_with("core/wire/tests/all/safety_"));
        let mut count = 0;
        for test in own {
            let (path, name) = test.split_once("::").unwrap();
            let source = source(path);
            assert!(test_body(&source, name).unwrap().contains(row.event), "{test} does not name its row");
            count += 1;
        }
        let elsewhere = row.tests.iter().all(|test| test.starts_with("firmware/"));
        assert_eq!(count, usize::from(!elsewhere), "{}", row.event);
    }
}

#[test]
fn the_numbers_of_the_table_are_those_of_the_settings_it_names() {
    let (device, settings) = (DeviceSettings::at_1_khz(), Settings::at_1_khz());
    assert_eq!((settings.tick_hz, settings.max_lost_frames, device.deadline_us), (1_000, 2, 500));
    let noticed = |event: &str| safety::row(event).noticed.unwrap();
    assert_eq!(noticed("silence"), device.silence_us / 1_000);
    assert_eq!(noticed("standing without feed hold"), settings.hold_after_ticks);
    assert_eq!(noticed("spindle speed not renewed"), settings.spindle_stale_ticks + 1);
    assert_eq!(safety::row("spindle stopped").out, Some(settings.fade_ticks));
}
