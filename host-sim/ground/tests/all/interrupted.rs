//! Runs that are ended by a signal, and runs that meet in one folder. What is ended is this test binary as a process of
//! its own.

use std::fs;
use std::io::{BufRead, BufReader, Write};
use std::path::Path;
use std::process::{Child, Command, ExitStatus, Stdio};
use std::time::{Duration, Instant};

use truepath_ground::interruption::{hold, listen};
use truepath_ground::output::{OutputFile, OutputFolder};

const OWNED: [&str; 1] = ["corrected.nc"];

fn names(folder: &Path) -> Vec<String> {
    let mut names: Vec<_> =
        fs::read_dir(folder).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn signal(process: &Child, name: &str) {
    assert!(Command::new("kill").args([name, &process.id().to_string()]).status().unwrap().success());
}

/// Waits, but not for ever.
fn ended(mut process: Child) -> ExitStatus {
    let start = Instant::now();
    loop {
        if let Some(status) = process.try_wait().unwrap() {
            return status;
        }
        assert!(start.elapsed() < Duration::from_secs(120), "it does not end");
        std::thread::sleep(Duration::from_millis(5));
    }
}

/// One of the ignored tests below in a folder, once it has said that it is ready.
fn process(name: &str, folder: &Path) -> Child {
    let mut command = Command::new(std::env::current_exe().unwrap());
    command.args(["--exact", &format!("interrupted::{name}"), "--ignored", "--nocapture"]).current_dir(folder);
    let mut process = command.stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(process.stdout.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().ends_with("ready")), "{name} is not ready");
    process
}

fn ready() {
    println!("ready");
    std::io::stdout().flush().unwrap();
}

#[test]
#[ignore = "called by others, in a process of its own"]
fn child_that_does_not_end() {
    listen().unwrap();
    let folder = OutputFolder::create(Path::new("new/out"), false, &OWNED).unwrap();
    folder.write("corrected.nc", b"G1").unwrap();
    let mut file = OutputFile::create(Path::new("other/out.csv"), false).unwrap();
    file.write_all(b"1,2\n").unwrap();
    ready();
    let mut sum = 0u64;
    // Long work: no system call, no end.
    loop {
        sum = std::hint::black_box(sum.wrapping_add(1));
    }
}

#[test]
#[ignore = "called by others, in a process of its own"]
fn child_that_is_moving_its_outputs() {
    listen().unwrap();
    let folder = OutputFolder::create(Path::new("out"), false, &OWNED).unwrap();
    folder.write("corrected.nc", b"G1").unwrap();
    let held = hold();
    ready();
    std::thread::sleep(Duration::from_millis(300));
    drop(held);
    folder.commit().unwrap();
    std::thread::sleep(Duration::from_secs(60));
}

#[test]
#[ignore = "called by others, in a process of its own"]
fn child_that_moves_its_outputs_for_ever() {
    listen().unwrap();
    let _held = hold();
    ready();
    loop {
        std::thread::sleep(Duration::from_secs(60));
    }
}

/// Whether the tests run under `nohup`.
fn hang_ups_are_ignored() -> bool {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let mask = status.lines().find_map(|line| line.strip_prefix("SigIgn:"));
    mask.is_none_or(|mask| u64::from_str_radix(mask.trim(), 16).unwrap() & 1 != 0)
}

#[test]
fn a_signal_takes_everything_temporary_along_in_the_middle_of_work() {
    for (name, code) in [("-INT", 130), ("-TERM", 143), ("-HUP", 129)] {
        if name == "-HUP" && hang_ups_are_ignored() {
            continue;
        }
        let place = tempfile::tempdir().unwrap();
        let process = process("child_that_does_not_end", place.path());
        assert_eq!(names(place.path()), ["new", "other"]);
        assert_eq!((names(&place.path().join("new")).len(), names(&place.path().join("other")).len()), (2, 1));
        signal(&process, name);
        assert_eq!(ended(process).code(), Some(code), "{name}");
        assert_eq!(names(place.path()), [""; 0], "{name}");
    }
}

#[test]
fn a_signal_waits_until_files_are_moved_and_a_second_one_does_not() {
    let place = tempfile::tempdir().unwrap();
    let waiting = process("child_that_is_moving_its_outputs", place.path());
    signal(&waiting, "-INT");
    assert_eq!(ended(waiting).code(), Some(130));
    let left = names(place.path());
    assert!(left.is_empty() || left == ["out"], "{left:?}");

    let mut stuck = process("child_that_moves_its_outputs_for_ever", place.path());
    let start = Instant::now();
    while stuck.try_wait().unwrap().is_none() {
        assert!(start.elapsed() < Duration::from_secs(120), "it does not end");
        signal(&stuck, "-INT");
        std::thread::sleep(Duration::from_millis(50));
    }
    assert_eq!(ended(stuck).code(), Some(130));
}

#[test]
fn a_hang_up_does_not_end_what_runs_under_nohup() {
    let place = tempfile::tempdir().unwrap();
    let mut command = Command::new("nohup");
    command.arg(std::env::current_exe().unwrap()).args([
        "--exact",
        "interrupted::child_that_does_not_end",
        "--ignored",
    ]);
    command.arg("--nocapture").current_dir(place.path()).stdin(Stdio::null()).stderr(Stdio::null());
    let mut process = command.stdout(Stdio::piped()).spawn().unwrap();
    let mut lines = BufReader::new(process.stdout.take().unwrap()).lines();
    assert!(lines.any(|line| line.unwrap().ends_with("ready")));
    signal(&process, "-HUP");
    std::thread::sleep(Duration::from_millis(200));
    assert!(process.try_wait().unwrap().is_none());
    signal(&process, "-TERM");
    assert_eq!(ended(process).code(), Some(143));
    assert_eq!(names(place.path()), [""; 0]);
}

#[test]
fn a_second_run_into_a_folder_is_told_which_process_writes_it() {
    let place = tempfile::tempdir().unwrap();
    let first = process("child_that_does_not_end", place.path());
    let target = place.path().join("new/out");
    for other in [target.clone(), place.path().join("new/../new/./out")] {
        let error = OutputFolder::create(&other, true, &OWNED).expect_err("it is being written");
        let shown = error.to_string();
        assert_eq!(error.code(), "F004");
        assert!(shown.contains(&format!("is being written by process {}", first.id())), "{shown}");
        assert!(shown.contains("child_that_does_not_end"), "{shown}");
    }
    // Other folders beside it are free.
    OutputFolder::create(&place.path().join("new/out2"), false, &OWNED).unwrap().commit().unwrap();
    signal(&first, "-KILL");
    ended(first);
    // A dead process cannot take its lock file along; the file stops nobody.
    assert!(place.path().join("new/.truepath-out.lock").exists());
    let folder = OutputFolder::create(&target, false, &OWNED).unwrap();
    folder.write("corrected.nc", b"G1").unwrap();
    folder.commit().unwrap();
    assert_eq!(names(&target), ["corrected.nc"]);
    assert!(!place.path().join("new/.truepath-out.lock").exists());
}

#[test]
fn a_link_to_a_folder_is_that_folder() {
    let place = tempfile::tempdir().unwrap();
    fs::create_dir_all(place.path().join("far/out")).unwrap();
    std::os::unix::fs::symlink(place.path().join("far/out"), place.path().join("link")).unwrap();
    let first = OutputFolder::create(&place.path().join("link"), false, &OWNED).unwrap();
    let second = OutputFolder::create(&place.path().join("far/out"), true, &OWNED).expect_err("it is the same");
    assert_eq!(second.code(), "F004");
    first.write("corrected.nc", b"G1").unwrap();
    first.commit().unwrap();
    assert_eq!(names(&place.path().join("far")), ["out"]);
    assert_eq!(names(&place.path().join("far/out")), ["corrected.nc"]);
}

#[test]
fn of_many_runs_at_once_one_writes_and_the_others_say_why_not() {
    let place = tempfile::tempdir().unwrap();
    for round in 0..20 {
        let target = place.path().join(format!("out{round}"));
        let runs: Vec<_> = (0..8)
            .map(|k: u8| {
                let target = target.clone();
                std::thread::spawn(move || {
                    let folder = OutputFolder::create(&target, false, &OWNED)?;
                    folder.write("corrected.nc", &[k])?;
                    folder.commit()
                })
            })
            .collect();
        let results: Vec<_> = runs.into_iter().map(|run| run.join().unwrap()).collect();
        assert_eq!(results.iter().filter(|r| r.is_ok()).count(), 1, "{results:?}");
        for error in results.iter().filter_map(|r| r.as_ref().err()) {
            assert!(matches!(error.code(), "F003" | "F004"), "{error}");
        }
        assert_eq!(names(&target), ["corrected.nc"]);
    }
    assert_eq!(names(place.path()).len(), 20);
}
