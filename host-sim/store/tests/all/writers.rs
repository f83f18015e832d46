//! Many write at once.

use std::path::{Path, PathBuf};
use std::sync::Barrier;
use std::thread;

use truepath_store::{PartFolder, Place, Store};

use crate::support::{file_in, folder, history, setup, shown};

/// Thirty writers at once, every part by two of them, as from two computers that saw the same folder: none is lost, none twice.
pub fn thirty_writers(place: &Place, at: &Path) {
    const WRITERS: usize = 30;
    let folders: Vec<PathBuf> =
        (0..WRITERS as u64).map(|job| folder(at, &format!("job-{}", job / 2), &history(job / 2, 2, 20))).collect();
    let together = Barrier::new(WRITERS);
    thread::scope(|scope| {
        for folder in &folders {
            scope.spawn(|| {
                let part = shown(PartFolder::read(folder)).expect("a history");
                let mut store = shown(Store::open(place));
                together.wait();
                shown(store.add(&part, &setup()));
            });
        }
    });
    let mut store = shown(Store::open(place));
    let status = shown(store.status(40));
    assert_eq!((status.jobs, status.parts, status.readings, status.histories), (15, 30, 600, 15));
    assert_eq!((status.machines, status.cutters, status.last_parts.len()), (1, 1, 30));
    assert_eq!(shown(store.check()), 15);
}

#[test]
fn thirty_writers_lose_no_part_and_double_none() {
    let at = tempfile::tempdir().expect("a folder");
    thirty_writers(&file_in(at.path()), at.path());
}
