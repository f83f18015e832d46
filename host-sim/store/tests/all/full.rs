//! A disk that is full. A limit on the size of files stands for it: the system refuses to write in the middle of a part.

use std::path::Path;
use std::process::Command;

use truepath_store::{PartFolder, Place, Store};

use crate::support::{code, file_in, folder, history, setup, shown};

/// Where a child finds its store and its part.
const PLACE: &str = "TRUEPATH_TEST_FULL";

/// Puts one part in, and says what it is refused with.
#[test]
#[ignore = "called by others"]
fn child_meets_a_full_disk() {
    let Ok(place) = std::env::var(PLACE) else { return };
    let part = shown(PartFolder::read(&Path::new(&place).with_file_name("part"))).expect("a history");
    println!("\nrefused with {}", code(shown(Store::open(&Place::of(&place))).add(&part, &setup())));
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_takes_nothing_of_a_part_and_all_of_it_later() {
    let at = tempfile::tempdir().expect("a folder");
    let place = file_in(at.path());
    let part = folder(at.path(), "part", &history(1, 3, 4000));
    let mut store = shown(Store::open(&place));
    // In units of 512 bytes; an ignored signal makes the write an error, as a full disk does.
    let limited =
        "trap '' XFSZ; ulimit -f 600; exec \"$0\" --ignored --exact full::child_meets_a_full_disk --nocapture";
    let child = Command::new("sh")
        .args(["-c", limited])
        .arg(std::env::current_exe().expect("this program"))
        .env(PLACE, at.path().join("shop.db"))
        .output()
        .expect("a child");
    let said = String::from_utf8_lossy(&child.stdout);
    assert!(said.contains("refused with O004"), "{said}");
    let status = shown(store.status(1));
    assert_eq!((status.parts, status.readings, status.jobs, status.machines), (0, 0, 0, 0));
    let part = shown(PartFolder::read(&part)).expect("a history");
    assert_eq!(shown(store.add(&part, &setup()))[0].new_readings, 12_000);
    assert_eq!(shown(store.check()), 1);
}
