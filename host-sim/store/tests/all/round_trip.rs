//! What goes in comes out, once.

use std::fs;
use std::path::{Path, PathBuf};

use truepath_correction::learning::History;
use truepath_correction::shop::{QUANTITIES, Said};
use truepath_ground::diagnostics::Source;
use truepath_store::{Choice, PartFolder, Place, Setup, Store, VERSION, setting};

use crate::support::{code, file_in, folder, history, setup, shown};

/// Puts a folder in.
fn add(store: &mut Store, folder: &Path, setup: &Setup) -> Vec<truepath_store::Added> {
    let part = shown(PartFolder::read(folder)).expect("a history");
    shown(store.add(&part, setup))
}

fn newest(store: &mut Store, history: &[u8]) -> Vec<Choice> {
    let history = History::read(&Source::new("history.json", history.to_vec())).expect("a history");
    shown(store.newest(&history.facts))
}

/// The whole way on any back end; `at` is a folder for the files.
pub fn whole_way(place: &Place, at: &Path) {
    let mut store = shown(Store::open(place));
    let mut files = Vec::new();
    for parts in [1, 2, 3, 4, 9, 10] {
        let bytes = history(7, parts, 70);
        let folder = folder(at, &format!("part-{parts}"), &bytes);
        files.push((parts, folder, bytes));
    }
    // In any order, and all of them twice.
    let mut numbers = Vec::new();
    for round in 0..2 {
        for k in [3, 0, 5, 1, 4, 2] {
            let (parts, folder, bytes) = &files[k];
            let added = add(&mut store, folder, &setup());
            assert_eq!((added.len(), added[0].known, u64::from(added[0].last_part)), (1, round == 1, *parts));
            assert!(round == 0 || (added[0].new_parts, added[0].new_readings) == (0, 0));
            assert!(shown(store.history(added[0].history)) == *bytes, "part {parts} comes out otherwise");
            numbers.push((*parts, added[0].history));
        }
    }
    assert_eq!(numbers[..6], numbers[6..]);
    let status = shown(store.status(3));
    // Nine and ten parts leave 2 to 10 and 3 to 10.
    assert_eq!((status.jobs, status.parts, status.readings, status.histories), (1, 10, 700, 6));
    assert_eq!((status.machines, status.holders, status.cutters, status.materials), (1, 1, 1, 1));
    assert_eq!((status.schema_version, status.last_parts.len()), (VERSION, 3));
    assert_eq!((status.last_parts[0].machine.as_deref(), status.last_parts[0].readings), (Some("VF2"), 70));
    assert_eq!(shown(store.check()), 6);
    // Parts 5 to 8 never came as the last one, but 10 goes on from 9, and 4 from 3, 2 and 1.
    let heads: Vec<i64> = newest(&mut store, &files[5].2).iter().map(|choice| choice.last_part).collect();
    assert!(heads.contains(&10) && !heads.contains(&9) && !heads.contains(&3), "{heads:?}");
    assert!(newest(&mut store, &history(8, 1, 3)).is_empty());
    assert_eq!(code(store.history(999)), "O006");
}

#[test]
fn a_history_comes_back_byte_for_byte_and_only_once() {
    let at = tempfile::tempdir().expect("a folder");
    whole_way(&file_in(at.path()), at.path());
}

#[test]
fn a_file_that_rows_cannot_give_back_is_kept_as_it_is() {
    let at = tempfile::tempdir().expect("a folder");
    let mut store = shown(Store::open(&file_in(at.path())));
    let text = String::from_utf8(history(7, 2, 5)).expect("text");
    // A number that no program of ours would have written: the last bit of it is another. And a new cutter, for which there is no column.
    let odd = text.replacen("\"height\":0.", "\"height\":0.000000000000000000", 1);
    let new_cutter = text.replacen("\"files\":", "\"cutter_from\":3,\"files\":", 1);
    for (kept, body) in (1..).zip([odd, new_cutter]) {
        assert!(body != text);
        let body = body.split_once(',').expect("a seal").1;
        let sealed = truepath_sealed(body);
        let added = add(&mut store, &folder(at.path(), &format!("kept-{kept}"), &sealed), &setup());
        assert!(shown(store.history(added[0].history)) == sealed);
        assert_eq!(shown(store.check()), kept);
    }
}

/// A file with its checksum before it.
fn truepath_sealed(rest: &str) -> Vec<u8> {
    let crc = truepath_core::checksum::crc32(rest.as_bytes());
    format!("{{\"crc32\":\"{crc:08x}\",{rest}").into_bytes()
}

#[test]
fn names_come_later_and_never_change() {
    let at = tempfile::tempdir().expect("a folder");
    let mut store = shown(Store::open(&file_in(at.path())));
    let folder = folder(at.path(), "out", &history(1, 2, 6));
    add(&mut store, &folder, &Setup::default());
    assert_eq!(shown(store.status(1)).last_parts[0].machine, None);
    let mut named = setup();
    named.names.serial = Some("17".to_owned());
    add(&mut store, &folder, &named);
    named.names.machine = Some("another".to_owned());
    named.names.serial = Some("18".to_owned());
    add(&mut store, &folder, &named);
    let last = &shown(store.status(1)).last_parts[0];
    assert_eq!((last.machine.as_deref(), last.serial.as_deref(), last.part), (Some("VF2"), Some("17"), 2));
    assert_eq!(last.temperature_c, Some(21.5));
}

#[test]
fn several_contours_of_a_part_go_in_together_or_not_at_all() {
    let at = tempfile::tempdir().expect("a folder");
    let mut store = shown(Store::open(&file_in(at.path())));
    for (name, job) in [("contours/a", 1), ("contours/b", 2)] {
        folder(&at.path().join("part"), name, &history(job, 1, 6));
    }
    assert_eq!(shown(PartFolder::every(&[at.path().to_owned()])), [at.path().join("part")]);
    let added = add(&mut store, &at.path().join("part"), &setup());
    assert_eq!(added.iter().map(|one| one.new_readings).sum::<usize>(), 12);
    fs::write(at.path().join("part/contours/b/history.json"), "damaged").expect("written");
    assert_eq!(code(PartFolder::read(&at.path().join("part"))), "Q001");
    assert_eq!(code(PartFolder::every(&[at.path().join("none")])), "O005");
}

#[test]
fn what_is_no_store_of_this_version_is_refused() {
    let at = tempfile::tempdir().expect("a folder");
    let file = |name: &str| Place::File(at.path().join(name));
    assert_eq!(code(Store::open(&file("none.db"))), "O002");
    fs::write(
        at.path().join("text.db"),
        "this is a text, and longer than the head of a file of SQLite, which has a hundred bytes; so it goes on.",
    )
    .expect("written");
    assert_eq!(code(Store::open(&file("text.db"))), "O002");
    fs::write(at.path().join("empty.db"), "").expect("written");
    assert_eq!(code(Store::open(&file("empty.db"))), "O002");
    assert_eq!(code(Store::migrate(&file("empty.db"))), "O002");
    assert_eq!(code(Store::init(&file("no/folder/shop.db"), false)), "O001");
    assert_eq!(code(Store::init(&file("roles.db"), true)), "C001");
    assert!(!at.path().join("roles.db").exists());

    let place = file_in(at.path());
    let again = shown(Store::init(&place, false));
    assert_eq!((again.before, again.version), (Some(VERSION), VERSION));
    assert_eq!(shown(Store::migrate(&place)).before, Some(VERSION));
    let other = |version: i64| {
        let file = rusqlite::Connection::open(at.path().join("shop.db")).expect("the file");
        file.execute("DELETE FROM schema_version", []).expect("emptied");
        file.execute("INSERT INTO schema_version (version, applied) VALUES (?1, 0)", [version]).expect("changed");
        code(Store::open(&place))
    };
    assert_eq!((other(VERSION - 1), other(VERSION + 1)), ("O003".to_owned(), "O003".to_owned()));
    assert_eq!(code(Store::migrate(&place)), "O003");
}

#[test]
fn a_store_that_was_changed_says_so() {
    let at = tempfile::tempdir().expect("a folder");
    let place = file_in(at.path());
    let mut store = shown(Store::open(&place));
    let number = add(&mut store, &folder(at.path(), "out", &history(1, 2, 6)), &setup())[0].history;
    let file = rusqlite::Connection::open(at.path().join("shop.db")).expect("the file");
    let kept: i64 =
        file.query_row("SELECT count(*) FROM history WHERE original IS NOT NULL", [], |row| row.get(0)).expect("read");
    assert_eq!(kept, 0, "the rows give back what they were made from");
    file.execute("UPDATE counter SET value = value + 1 WHERE name = 'reading'", []).expect("changed");
    assert_eq!(code(store.check()), "O008");
    file.execute("UPDATE counter SET value = value - 1 WHERE name = 'reading'", []).expect("changed");
    file.execute("UPDATE reading SET error_nm = error_nm + 1 WHERE position = 3", []).expect("changed");
    assert_eq!((code(store.check()), code(store.history(number))), ("O008".to_owned(), "O008".to_owned()));
}

#[test]
fn a_part_that_is_refused_in_the_middle_leaves_nothing() {
    let at = tempfile::tempdir().expect("a folder");
    let place = file_in(at.path());
    let folder = folder(at.path(), "out", &history(1, 3, 500));
    let part = shown(PartFolder::read(&folder)).expect("a history");
    let refusing = |refuses: bool| {
        let file = rusqlite::Connection::open(at.path().join("shop.db")).expect("the file");
        // The history comes last, behind all its readings.
        let words = if refuses {
            "CREATE TRIGGER full BEFORE INSERT ON history BEGIN SELECT RAISE(ABORT, 'full'); END"
        } else {
            "DROP TRIGGER full"
        };
        file.execute_batch(words).expect("changed");
    };
    refusing(true);
    let mut store = shown(Store::open(&place));
    assert!(store.add(&part, &setup()).is_err());
    let status = shown(store.status(1));
    assert_eq!((status.parts, status.readings, status.jobs, status.machines), (0, 0, 0, 0));
    refusing(false);
    assert_eq!(shown(store.add(&part, &setup()))[0].new_parts, 3);
    assert_eq!(shown(store.check()), 1);
}

#[test]
fn a_store_of_the_first_version_is_brought_up_and_loses_nothing() {
    let at = tempfile::tempdir().expect("a folder");
    let file = at.path().join("old.db");
    let place = Place::File(file.clone());
    // As the first version wrote it: three parts of a job.
    let old = rusqlite::Connection::open(&file).expect("a file");
    old.execute_batch("PRAGMA foreign_keys = OFF").expect("tables come in the order of their names");
    old.execute_batch(include_str!("../data/version-1.sql")).expect("its statements");
    drop(old);
    assert_eq!(code(Store::open(&place)), "O003");
    let migrated = shown(Store::migrate(&place));
    assert_eq!((migrated.before, migrated.version), (Some(1), VERSION));
    let mut store = shown(Store::open(&place));
    assert_eq!(shown(store.check()), 1);
    let status = shown(store.status(1));
    assert_eq!((status.parts, status.readings, status.last_parts[0].machine.as_deref()), (3, 15, Some("VF2")));
    assert!(shown(store.history(1)) == history(7, 3, 5));
    // What it knows already it knows, and more goes in.
    let added = add(&mut store, &folder(at.path(), "known", &history(7, 3, 5)), &setup());
    assert_eq!((added[0].known, added[0].new_parts), (true, 0));
    assert_eq!(add(&mut store, &folder(at.path(), "new", &history(8, 1, 4)), &setup())[0].new_parts, 1);
}

/// What the points of a job say of the yield alone.
fn said(off: f64) -> Said {
    let mut information = [[0.0; QUANTITIES]; QUANTITIES];
    information[0][0] = 400.0;
    let mut pull = [0.0; QUANTITIES];
    pull[0] = 400.0 * off;
    let stated = [-1.0, 0.0, 0.0, -1.2, -4.0, 0.1, 0.12, 0.15, 0.0];
    let sigma = [0.5, 0.35, 0.08, 0.26, 0.5, 0.28, 0.1, 0.1, 0.0044];
    Said { stated, stated_ln_ktc: 7.0, sigma, information, pull }
}

/// A folder whose summary says so.
fn saying(at: &Path, name: &str, history: &[u8], off: f64) -> PathBuf {
    let folder = folder(at, name, history);
    let said = serde_json::to_string(&said(off)).expect("numbers");
    let identified = r#""identified": { "compliance": { "value": 0.25, "sigma": 0.01 } }"#;
    fs::write(folder.join("summary.json"), format!("{{ {identified}, \"points_say\": {said} }}")).expect("written");
    folder
}

/// What a store lets expect; on any back end.
pub fn what_others_say(place: &Place, at: &Path) {
    let mut store = shown(Store::open(place));
    let facts = |job| History::read(&Source::new("history.json", history(job, 1, 3))).expect("a history").facts;
    let on = |machine: &str, material: &str| {
        let mut setup = setup();
        (setup.names.machine, setup.names.material) = (Some(machine.to_owned()), Some(material.to_owned()));
        setup
    };
    let expected = |store: &mut Store, job, setup: &Setup| {
        let setting = shown(setting(&setup.names, setup.stickout_nm, &facts(job)));
        let (shop, newest) = shown(store.shop(&facts(job), &setting));
        let says: Vec<f64> = shop.members.iter().map(|member| member.said.pull[0] / 400.0).collect();
        (says, newest.is_some())
    };
    // Three parts of job 101, each learned from the one before: the last says all of it.
    for parts in 1..=3 {
        let folder = saying(at, &format!("says-{parts}"), &history(101, parts, 4), 0.1 * parts as f64);
        add(&mut store, &folder, &on("VF2", "42CrMo4"));
    }
    add(&mut store, &saying(at, "says-4", &history(102, 1, 4), 0.7), &on("DMU", "Ti64"));
    add(&mut store, &folder(at, "says-nothing", &history(103, 1, 4)), &on("VF2", "42CrMo4"));
    let near = |found: (Vec<f64>, bool), wanted: &[f64]| {
        let alike = found.0.len() == wanted.len() && found.0.iter().zip(wanted).all(|(a, b)| (a - b).abs() < 1e-9);
        assert!(alike && found.1 != wanted.is_empty(), "{found:?} in place of {wanted:?}");
    };
    near(expected(&mut store, 104, &on("VF2", "7075")), &[0.7, 0.3]);
    let mut other = on("Mikron", "7075");
    (other.names.make, other.names.cutter_serial) = (None, None);
    near(expected(&mut store, 104, &other), &[]);
    other.names.material = Some("Ti64".to_owned());
    near(expected(&mut store, 104, &other), &[0.7]);
    // Not what its own program says, whatever the machine.
    near(expected(&mut store, 102, &on("VF2", "7075")), &[0.3]);
    // The very cutter was on another machine, in another material.
    other.names.material = Some("7075".to_owned());
    near(expected(&mut store, 104, &other), &[]);
    other.names.cutter_serial = setup().names.cutter_serial;
    near(expected(&mut store, 104, &other), &[0.7, 0.3]);
    (other.names.cutter_serial, other.names.material) = (None, Some("Ti64".to_owned()));
    // The walls of one part were fitted together.
    for (name, job) in [("contours/a", 105), ("contours/b", 106)] {
        let text = String::from_utf8(history(job, 1, 4)).expect("text");
        let body = text.split_once(',').expect("a seal").1.replacen(&format!("{:08x}", job * 4096 + 1), "0badcafe", 1);
        saying(&at.join("walls"), name, &truepath_sealed(&body), 0.9);
    }
    add(&mut store, &at.join("walls"), &on("Mikron", "Ti64"));
    near(expected(&mut store, 104, &other), &[0.9, 0.7]);
}

#[test]
fn other_jobs_say_what_their_last_part_says_once_and_never_their_own_program() {
    let at = tempfile::tempdir().expect("a folder");
    what_others_say(&file_in(at.path()), at.path());
}

#[test]
fn what_points_cannot_say_is_neither_taken_in_nor_believed() {
    let at = tempfile::tempdir().expect("a folder");
    let place = file_in(at.path());
    let mut store = shown(Store::open(&place));
    let facts = History::read(&Source::new("history.json", history(2, 1, 3))).expect("a history").facts;
    // A folder that says what cannot be is a folder that says nothing.
    let folder = saying(at.path(), "wrong", &history(1, 1, 4), 1e12);
    add(&mut store, &folder, &setup());
    let members = |store: &mut Store| {
        let setup = setup();
        let setting = shown(setting(&setup.names, setup.stickout_nm, &facts));
        store.shop(&facts, &setting).map(|(shop, _)| shop.members.len())
    };
    assert_eq!(members(&mut store).expect("read"), 0);
    add(&mut store, &saying(at.path(), "right", &history(3, 1, 4), 0.2), &setup());
    assert_eq!(members(&mut store).expect("read"), 1);
    let path = at.path().join("shop.db");
    let write = |said: &serde_json::Value| {
        let file = rusqlite::Connection::open(&path).expect("a file");
        let changed = file.execute("UPDATE estimate SET said = ?1 WHERE said IS NOT NULL", [said.to_string()]);
        assert_eq!(changed.expect("written"), 1);
    };
    // Before the size of the cutter was among the quantities there were eight.
    let good = serde_json::to_value(said(0.2)).expect("numbers");
    let shorter = |value: &serde_json::Value| serde_json::Value::from(value.as_array().expect("a list")[..8].to_vec());
    let mut earlier = good.clone();
    for name in ["stated", "sigma", "pull", "information"] {
        earlier[name] = shorter(&earlier[name]);
    }
    earlier["information"].as_array_mut().expect("rows").iter_mut().for_each(|row| *row = shorter(row));
    write(&earlier);
    assert_eq!(members(&mut store).expect("read"), 1);
    // Damaged in the store: the estimate is named and the shop is not asked.
    type Damage = fn(&mut serde_json::Value);
    let damages: [(&str, Damage); 6] = [
        ("no information matrix", |said| said["information"][0][3] = 50.0.into()),
        ("no information matrix", |said| said["pull"][0] = 1e300.into()),
        ("a variance below zero", |said| said["information"][0][0] = (-400.0).into()),
        ("no job states", |said| said["sigma"][0] = (-0.5).into()),
        ("states what no job can", |said| said["stated"][0] = 710.0.into()),
        ("cannot be read", |said| said["stated"] = serde_json::json!([1.0])),
    ];
    for (words, damage) in damages {
        let mut bad = good.clone();
        damage(&mut bad);
        write(&bad);
        let failure = members(&mut store).expect_err(words).to_string();
        assert!(failure.contains(words), "{failure} in place of {words}");
    }
}
