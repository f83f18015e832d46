//! The command line from outside: exit codes, streams, errors for people and for machines.

use std::path::Path;
use std::process::{Command, Output};

fn truepath(arguments: &[&str], folder: &Path) -> Output {
    Command::new(env!("CARGO_BIN_EXE_truepath")).args(arguments).current_dir(folder).output().expect("the program runs")
}

fn text(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A folder with a small program and one that is wrong.
fn desk() -> tempfile::TempDir {
    let desk = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(desk.path().join(name), text).expect("a file");
    write("part.nc", "%\nG21 G90\nG0 X0 Y0\nG1 X10 F100\nM30\n%\n");
    write("wrong.nc", "%\nG21 G90\nG0 X0 Y0\nG1 X10 ? F100\nM30\n%\n");
    desk
}

#[test]
fn data_goes_to_standard_output_and_the_exit_code_is_0() {
    let desk = desk();
    let done = truepath(&["canon", "part.nc"], desk.path());
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(text(&done.stdout).contains("STRAIGHT_FEED(10.0000, 0.0000, 0.0000"));
    assert_eq!(text(&done.stderr), "");
}

#[test]
fn wrong_input_is_exit_code_1_with_its_place() {
    let desk = desk();
    let failed = truepath(&["canon", "wrong.nc"], desk.path());
    assert_eq!((failed.status.code(), text(&failed.stdout)), (Some(1), String::new()));
    let shown = text(&failed.stderr);
    assert!(shown.contains("wrong.nc:4:8") && shown.contains("G1 X10 ? F100") && shown.contains("help:"), "{shown}");
    assert!(!shown.contains('\x1b'), "no colours into a pipe");
}

#[test]
fn errors_are_one_json_object_when_asked_for() {
    let desk = desk();
    for (arguments, code, place) in [
        (["canon", "wrong.nc", "--json"], "G001", Some((4, 8))),
        (["canon", "missing.nc", "--json"], "F001", None),
        (["canon", "--nonsense", "--json"], "C001", None),
    ] {
        let failed = truepath(&arguments, desk.path());
        assert_eq!(failed.status.code(), Some(1), "{arguments:?}");
        let json: serde_json::Value = serde_json::from_slice(&failed.stderr).expect("one JSON object");
        let error = &json["error"];
        assert_eq!(error["code"], code, "{json}");
        assert_eq!(error["line"].as_u64().zip(error["column"].as_u64()), place, "{json}");
        assert!(error["message"].as_str().is_some_and(|m| !m.is_empty()) && error["help"].is_string(), "{json}");
    }
}

#[test]
fn a_wrong_command_line_is_wrong_input() {
    let desk = desk();
    for arguments in [&["no-such-command"][..], &["canon"], &[], &["canon", "part.nc", "--force"]] {
        let failed = truepath(arguments, desk.path());
        assert_eq!((failed.status.code(), text(&failed.stdout)), (Some(1), String::new()), "{arguments:?}");
        assert!(text(&failed.stderr).contains("Usage:"), "{arguments:?}");
    }
    for arguments in [["--help"], ["--version"]] {
        let asked = truepath(&arguments, desk.path());
        assert_eq!((asked.status.code(), text(&asked.stderr)), (Some(0), String::new()), "{arguments:?}");
        assert!(!asked.stdout.is_empty());
    }
}

#[test]
fn nothing_is_overwritten_without_force() {
    let desk = desk();
    let run = |arguments: &[&str]| truepath(arguments, desk.path()).status.code();
    let written = || std::fs::read_to_string(desk.path().join("out.txt")).expect("a file");
    assert_eq!(run(&["canon", "part.nc", "-o", "out.txt"]), Some(0));
    let first = written();
    std::fs::write(desk.path().join("out.txt"), "mine").expect("a file");
    assert_eq!(run(&["canon", "part.nc", "-o", "out.txt"]), Some(1));
    assert_eq!(written(), "mine");
    assert_eq!(run(&["canon", "wrong.nc", "-o", "out.txt", "--force"]), Some(1));
    assert_eq!(written(), "mine");
    assert_eq!(run(&["canon", "part.nc", "-o", "out.txt", "--force"]), Some(0));
    assert_eq!(written(), first);
}

#[test]
fn a_reader_that_closes_early_is_no_error() {
    let desk = desk();
    let mut long = String::from("%\nG21 G90\nG0 X0 Y0\nF100\n");
    for i in 0..20_000 {
        long += &format!("G1 X{i}\n");
    }
    std::fs::write(desk.path().join("long.nc"), long + "M30\n%\n").expect("a file");
    let mut child = Command::new(env!("CARGO_BIN_EXE_truepath"))
        .args(["canon", "long.nc"])
        .current_dir(desk.path())
        .stdout(std::process::Stdio::piped())
        .stderr(std::process::Stdio::piped())
        .spawn()
        .expect("the program runs");
    drop(child.stdout.take());
    let done = child.wait_with_output().expect("it ends");
    assert_eq!((done.status.code(), text(&done.stderr)), (Some(0), String::new()));
}
