//! Many millions of readings: what a shop has after years.

use std::fs;
use std::time::{Duration, Instant};

use truepath_store::{PartFolder, Store};

use crate::support::{file_in, folder, history, setup, shown};

/// Parts and readings that the store is filled with: `TRUEPATH_SCALE_READINGS` says another number of them.
const READINGS: u64 = 20_000_000;
/// Readings of one part.
const EACH: u64 = 200;

/// Fills a store and measures what an operator waits for; the numbers stand in docs/store.md.
#[test]
#[ignore = "minutes: what docs/store.md says of a large store"]
fn campaign_a_large_store_answers_at_once() {
    let wanted = std::env::var("TRUEPATH_SCALE_READINGS").ok().and_then(|text| text.parse().ok()).unwrap_or(READINGS);
    let at = tempfile::tempdir().expect("a folder");
    let place = file_in(at.path());
    // The way in is the ordinary one for one job; then its rows are multiplied, as it is the size that matters.
    let mut store = shown(Store::open(&place));
    shown(store.add(
        &shown(PartFolder::read(&folder(at.path(), "first", &history(1, 1, EACH)))).expect("a history"),
        &setup(),
    ));
    drop(store);
    let parts = i64::try_from(wanted / EACH).expect("a number");
    let file = rusqlite::Connection::open(at.path().join("shop.db")).expect("the file");
    file.execute_batch("PRAGMA synchronous = OFF; PRAGMA cache_size = -400000").expect("set");
    file.execute_batch(&format!(
        "BEGIN;
         WITH RECURSIVE n(k) AS (SELECT 2 UNION ALL SELECT k + 1 FROM n WHERE k < {parts})
           INSERT INTO part (id, job, number, probe_crc32, serial, machine, cut_nm, stored)
           SELECT k, 1, k, printf('%08x', k), printf('S%d', k), 1, 125500000, k FROM n;
         INSERT INTO measurement (id, part, hash, sigma_nm, readings) SELECT id, id, printf('h%d', id), 2000, {EACH} FROM part WHERE id > 1;
         INSERT INTO history_part (history, position, measurement, set_aside) SELECT 1, id, id, 0 FROM part WHERE id > 1;
         INSERT INTO reading SELECT m.id, r.position, r.place_nm, r.height, r.error_nm + m.id, r.normal_x, r.normal_y, r.across_nm, r.pair, r.sigma_nm, r.used
           FROM measurement m CROSS JOIN reading r WHERE m.id > 1 AND r.measurement = 1;
         UPDATE counter SET value = (SELECT count(*) FROM part) WHERE name = 'part';
         UPDATE counter SET value = (SELECT count(*) FROM reading) WHERE name = 'reading';
         COMMIT;"
    ))
    .expect("filled");
    drop(file);
    let bytes = fs::metadata(at.path().join("shop.db")).expect("the file").len();

    let middle = |mut times: Vec<Duration>| {
        times.sort();
        times[times.len() / 2]
    };
    let timed = |work: &mut dyn FnMut(u64)| {
        let times = (0..9).map(|k| {
            let start = Instant::now();
            work(k);
            start.elapsed()
        });
        middle(times.collect())
    };
    let status =
        timed(&mut |_| assert!(shown(shown(Store::open(&place)).status(10)).readings >= (wanted / EACH * EACH) as i64));
    let add = timed(&mut |k| {
        let folder = folder(at.path(), "one", &history(1000 + k, 1, EACH));
        let part = shown(PartFolder::read(&folder)).expect("a history");
        assert_eq!(shown(shown(Store::open(&place)).add(&part, &setup()))[0].new_parts, 1);
    });
    println!(
        "{wanted} readings of {parts} parts, {:.2} GB: status {:.1} ms, one part of {EACH} readings {:.1} ms",
        bytes as f64 / 1e9,
        status.as_secs_f64() * 1e3,
        add.as_secs_f64() * 1e3
    );
    assert!(status < Duration::from_millis(200) && add < Duration::from_secs(1));
}
