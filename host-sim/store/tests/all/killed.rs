//! A process that is killed while it puts parts in: what it has reported is in the store, and the store is sound.

use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Command, Stdio};
use std::sync::mpsc;
use std::time::{Duration, Instant};

use truepath_store::{PartFolder, Place, Store};

use crate::support::{file_in, folder, history, setup, shown};

/// Where a child finds its store and its first job.
const PLACE: &str = "TRUEPATH_TEST_STORE";
const FIRST: &str = "TRUEPATH_TEST_FIRST";

/// Puts part after part in, and says so after each.
#[test]
#[ignore = "called by others"]
fn child_puts_parts_in() {
    let (Ok(place), Ok(first)) = (std::env::var(PLACE), std::env::var(FIRST)) else { return };
    let first: u64 = first.parse().expect("a number");
    // Beside the store, as nothing of its own is cleared away when it is killed.
    let at = Path::new(&place).parent().expect("a folder");
    let mut store = shown(Store::open(&Place::of(&place)));
    let mut out = std::io::stdout();
    writeln!(out, "ready").expect("told");
    for job in first.. {
        let part = shown(PartFolder::read(&folder(at, "part", &history(job, 1, 12)))).expect("a history");
        shown(store.add(&part, &setup()));
        writeln!(out, "stored {job:08x}").expect("told");
        out.flush().expect("told");
    }
}

/// Kills a process so many times, each at another moment of a part that is going in, and looks at the store after each.
fn kills(times: u64) {
    let at = tempfile::tempdir().expect("a folder");
    let place = file_in(at.path());
    let file = at.path().join("shop.db");
    let mut reported: Vec<String> = Vec::new();
    for k in 0..times {
        let first = (k + 1) * 100_000;
        let moment = ((k % 3) as usize, (k * 37 % 101) as f64 / 100.0);
        let lines = killed_at(&file, first, moment);
        reported.extend(lines.iter().filter_map(|line| line.strip_prefix("stored ").map(str::to_owned)));
        // The journal that was left behind is rolled back by whoever comes first.
        let mut store = shown(Store::open(&place));
        shown(store.status(1));
        drop(store);
        let sound = rusqlite::Connection::open(&file).expect("the file");
        let said: String = sound.query_row("PRAGMA integrity_check", [], |row| row.get(0)).expect("an answer");
        assert_eq!(said, "ok", "after kill {k}");
        are_there(&sound, reported.iter().rev().take(20));
    }
    are_there(&rusqlite::Connection::open(&file).expect("the file"), reported.iter());
    let mut store = shown(Store::open(&place));
    let parts = shown(store.status(1)).parts as usize;
    // Of each child one more may have gone in unreported.
    assert!((reported.len()..=reported.len() + times as usize).contains(&parts), "{parts} of {}", reported.len());
    assert!(reported.len() >= times as usize / 2, "only {} parts in {times} kills", reported.len());
    shown(store.check());
    println!("{times} kills, {parts} parts, {} of them reported", reported.len());
}

/// Parts that were reported are in the store, once.
fn are_there<'a>(store: &rusqlite::Connection, jobs: impl Iterator<Item = &'a String>) {
    let count = "SELECT count(*) FROM part p JOIN job j ON j.id = p.job WHERE j.program_crc32 = ?1";
    let mut known = store.prepare(count).expect("read");
    for job in jobs {
        let parts: i64 = known.query_row([job], |row| row.get(0)).expect("an answer");
        assert_eq!(parts, 1, "the part of {job} was reported");
    }
}

/// What a child has said until it was killed: when it had put some parts in, and a share of the time that one takes after it.
fn killed_at(file: &Path, first: u64, (parts, share): (usize, f64)) -> Vec<String> {
    let mut child = Command::new(std::env::current_exe().expect("this program"))
        .args(["--ignored", "--exact", "killed::child_puts_parts_in", "--nocapture", "--test-threads=1"])
        .env(PLACE, file)
        .env(FIRST, first.to_string())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("a child");
    let out = child.stdout.take().expect("its output");
    let (tell, told) = mpsc::channel();
    let reader = std::thread::spawn(move || {
        for line in BufReader::new(out).lines().map_while(Result::ok) {
            let _ = tell.send(line);
        }
    });
    let patience = Instant::now() + Duration::from_secs(60);
    let mut lines: Vec<String> = Vec::new();
    let (mut ready, mut last, mut took) = (false, Instant::now(), Duration::from_millis(10));
    while !ready || lines.len() <= parts {
        let Ok(line) = told.recv_timeout(patience.saturating_duration_since(Instant::now())) else { break };
        if line.starts_with("stored ") || line.ends_with("ready") {
            took = if ready { last.elapsed() } else { took };
            (ready, last) = (true, Instant::now());
            lines.push(line);
        }
    }
    std::thread::sleep(took.mul_f64(share));
    child.kill().expect("killed");
    child.wait().expect("ended");
    reader.join().expect("its lines");
    lines.extend(told.try_iter());
    assert!(lines.iter().any(|line| line.ends_with("ready")), "the child never began: {lines:?}");
    lines
}

#[test]
fn twenty_kills_lose_no_part_that_was_reported() {
    kills(20);
}

#[test]
#[ignore = "slow: cargo xtask test --all"]
fn a_thousand_kills_lose_no_part_that_was_reported() {
    kills(1000);
}
