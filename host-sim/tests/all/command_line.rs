//! The command line from outside: exit codes, streams, errors for people and for machines.

use crate::workplace::{Workplace, text, truepath};
use std::process::Command;

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
    let done = truepath(desk.path(), &["canon", "part.nc"]);
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert!(text(&done.stdout).contains("STRAIGHT_FEED(10.0000, 0.0000, 0.0000"));
    assert_eq!(text(&done.stderr), "");
}

#[test]
fn wrong_input_is_exit_code_1_with_its_place() {
    let desk = desk();
    let failed = truepath(desk.path(), &["canon", "wrong.nc"]);
    assert_eq!((failed.status.code(), text(&failed.stdout)), (Some(1), String::new()));
    let shown = text(&failed.stderr);
    assert!(shown.contains("wrong.nc:4:8") && shown.contains("G1 X10 ? F100") && shown.contains("help:"), "{shown}");
    assert!(!shown.contains('\x1b'), "no colours into a pipe");
}

#[test]
fn errors_are_one_json_object_when_asked_for() {
    let desk = desk();
    for (arguments, exit, code, place) in [
        (["canon", "wrong.nc", "--json"], 1, "G001", Some((4, 8))),
        (["canon", "missing.nc", "--json"], 1, "F001", None),
        (["canon", "--nonsense", "--json"], 2, "C001", None),
    ] {
        let failed = truepath(desk.path(), &arguments);
        assert_eq!(failed.status.code(), Some(exit), "{arguments:?}");
        let json: serde_json::Value = serde_json::from_slice(&failed.stderr).expect("one JSON object");
        let error = &json["error"];
        assert_eq!(error["code"], code, "{json}");
        assert_eq!(error["line"].as_u64().zip(error["column"].as_u64()), place, "{json}");
        assert!(error["message"].as_str().is_some_and(|m| !m.is_empty()) && error["help"].is_string(), "{json}");
    }
}

#[test]
fn a_wrong_command_line_is_exit_code_2_and_help_is_none() {
    let desk = desk();
    for arguments in [&["no-such-command"][..], &["canon"], &[], &["canon", "part.nc", "--force"]] {
        let failed = truepath(desk.path(), arguments);
        assert_eq!((failed.status.code(), text(&failed.stdout)), (Some(2), String::new()), "{arguments:?}");
        assert!(text(&failed.stderr).contains("Usage:"), "{arguments:?}");
    }
    for arguments in [["--help"], ["--version"]] {
        let asked = truepath(desk.path(), &arguments);
        assert_eq!((asked.status.code(), text(&asked.stderr)), (Some(0), String::new()), "{arguments:?}");
        assert!(!asked.stdout.is_empty());
    }
}

#[test]
fn the_overview_groups_the_commands_and_colours_come_when_asked_for() {
    let desk = desk();
    let plain = text(&truepath(desk.path(), &["--help"]).stdout);
    assert!(plain.contains("\nCorrect a part:\n  init") && !plain.contains('\x1b'), "{plain}");
    for colour in [&["--color", "always", "--help"][..], &["--color=always", "correct", "--help"]] {
        let coloured = text(&truepath(desk.path(), colour).stdout);
        assert!(coloured.contains('\x1b'), "{coloured}");
    }
    let failed = truepath(desk.path(), &["--color=always", "canon", "wrong.nc"]);
    assert!(text(&failed.stderr).contains('\x1b'), "{}", text(&failed.stderr));
    assert!(
        text(&truepath(desk.path(), &["correct", "--help"]).stdout).contains("Examples:\n  truepath correct job.toml")
    );
}

#[test]
fn a_dash_is_standard_input() {
    let desk = desk();
    let canon = |name: &str, from: &str| {
        let file = std::fs::File::open(desk.path().join(from)).expect("a file");
        let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
        command.args(["canon", name]).stdin(file).current_dir(desk.path()).output().expect("it runs")
    };
    assert_eq!(canon("-", "part.nc").stdout, canon("part.nc", "part.nc").stdout);
    let failed = canon("-", "wrong.nc");
    assert!(
        failed.status.code() == Some(1) && text(&failed.stderr).contains("standard input:4:8"),
        "{}",
        text(&failed.stderr)
    );
}

#[test]
fn quiet_leaves_files_data_warnings_and_errors() {
    let place = Workplace::demo("corner", &["job.toml", "plant.toml", "program.nc"]);
    let simulate = |out: &str, quiet: &[&str]| {
        let words = [&["simulate", "job.toml", "-o", out][..], quiet].concat();
        truepath(place.path(), &words)
    };
    let [loud, quiet, json] =
        [("a", &[][..]), ("b", &["-q"]), ("c", &["-q", "--json"])].map(|(out, more)| simulate(out, more));
    let said = text(&quiet.stderr);
    assert!(!loud.stdout.is_empty() && quiet.stdout.is_empty(), "{}", text(&quiet.stdout));
    assert!(said.lines().all(|line| line.starts_with("warning: ")), "{said}");
    assert!(serde_json::from_slice::<serde_json::Value>(&json.stdout).is_ok());
    assert_eq!(place.read("a/trace.csv"), place.read("b/trace.csv"));
    assert!(!truepath(place.path(), &["-q", "canon", "program.nc"]).stdout.is_empty(), "data");
    assert!(!truepath(place.path(), &["-q", "canon", "none.nc"]).stderr.is_empty(), "errors");
}

#[test]
fn shells_and_man_get_what_they_need() {
    let desk = desk();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let script = text(&truepath(desk.path(), &["completions", shell]).stdout);
        assert!(script.contains("truepath") && script.contains("multiaxis") && script.contains("tolerance"), "{shell}");
    }
    let pages = || std::fs::read_dir(desk.path().join("man1")).expect("a folder").count();
    let man = |more: &[&str]| truepath(desk.path(), &[&["man", "-o", "man1"][..], more].concat()).status.code();
    assert_eq!((man(&[]), pages()), (Some(0), 32));
    assert_eq!((man(&[]), man(&["--force"]), pages()), (Some(1), Some(0), 32));
    let page = std::fs::read_to_string(desk.path().join("man1/truepath-correct.1")).expect("a page");
    assert!(page.contains(".TH truepath-correct 1") && page.contains("truepath correct job.toml"), "{page}");
}

#[test]
fn nothing_is_overwritten_without_force() {
    let desk = desk();
    let run = |arguments: &[&str]| truepath(desk.path(), arguments).status.code();
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
    for arguments in [["canon", "long.nc"], ["probe", "--help"], ["completions", "bash"]] {
        let mut child = Command::new(env!("CARGO_BIN_EXE_truepath"))
            .args(arguments)
            .current_dir(desk.path())
            .stdout(std::process::Stdio::piped())
            .stderr(std::process::Stdio::piped())
            .spawn()
            .expect("the program runs");
        drop(child.stdout.take());
        let done = child.wait_with_output().expect("it ends");
        assert_eq!((done.status.code(), text(&done.stderr)), (Some(0), String::new()), "{arguments:?}");
    }
}

/// A sequence that clears the screen, one that renames the window, one in eight bits, a bell and a step back.
const STEERING: &str = "\x1b[2J\x1b]0;mine\x07\u{9b}31m\x08\x7f\u{202e}";

fn assert_steers_nothing(shown: &[u8], what: &str) {
    let shown = text(shown);
    let steers = |c: char| c.is_control() && !matches!(c, '\n' | '\t') || ('\u{202a}'..='\u{202e}').contains(&c);
    assert!(!shown.contains(steers), "{what}: {shown:?}");
}

#[test]
fn control_characters_of_a_file_are_shown_and_never_sent_to_the_terminal() {
    let desk = desk();
    let write = |name: &str, text: String| std::fs::write(desk.path().join(name), text).expect("a file");
    let job = include_str!("../../demo/corner/job.toml");
    write("program.nc", include_str!("../../demo/corner/program.nc").to_owned());
    write("job.toml", job.to_owned());
    write("wrong.nc", format!("%\nG21 G90\nG0 X0 Y0\nG1 X{STEERING} F100\nM30\n"));
    write("comment.nc", format!("%\nG21 G90\n(MSG,{STEERING})\nG1 X10 ? F100\nM30\n"));
    let escaped: String = STEERING.chars().map(|c| format!("\\U{:08x}", u32::from(c))).collect();
    write("key.toml", format!("{job}\n\"{escaped}\" = 1\n"));
    write("raw.toml", format!("{job}\n{STEERING} = 1\n"));
    write(
        "feature.toml",
        format!("{job}\n[[feature]]\nid = \"\\u001b[2J\\u009b\"\nblocks = [1, 2]\nrole = \"finish\"\n"),
    );
    write("probe.txt", format!("1 2 3 4 5 6 7 8 9\n{STEERING} 2 3 4 5 6 7 8 9\n"));
    write("named.csv", format!("x_mm,y_mm,{STEERING}\n1,2,3\n"));
    write("table.csv", format!("s_mm,{STEERING}\n1,2\n"));
    write("plant.toml", format!("ktc_n_per_mm2 = \"{STEERING}\"\n"));
    let file = format!("{STEERING}.nc");
    std::fs::copy(desk.path().join("wrong.nc"), desk.path().join(&file)).expect("a file");
    let probe = |probe: &'static str| vec!["correct", "job.toml", "--probe", probe, "-o", "out"];
    for arguments in [
        vec!["canon", "wrong.nc"],
        vec!["canon", "comment.nc"],
        vec!["canon", &file],
        vec!["simulate", "key.toml", "-o", "out"],
        vec!["simulate", "raw.toml", "-o", "out"],
        vec!["simulate", "feature.toml", "-o", "out"],
        vec!["simulate", "job.toml", "-o", "out", "--plant", "plant.toml"],
        probe("probe.txt"),
        probe("named.csv"),
        vec!["plot", "trace", "table.csv", "-o", "out.svg"],
        vec!["image", &file],
        vec![STEERING],
    ] {
        for json in [false, true] {
            let arguments: Vec<&str> = arguments.iter().copied().chain(json.then_some("--json")).collect();
            let done = truepath(desk.path(), &arguments);
            let what = format!("{arguments:?}");
            let usage = arguments[0] == STEERING;
            assert_eq!(done.status.code(), Some(if usage { 2 } else { 1 }), "{what}: {}", text(&done.stderr));
            assert_steers_nothing(&done.stderr, &what);
            assert_steers_nothing(&done.stdout, &what);
        }
    }
    let shown = text(&truepath(desk.path(), &["canon", "wrong.nc"]).stderr);
    assert!(shown.contains("␛[2J␛]0;mine␇") && shown.contains("wrong.nc:4:"), "{shown}");
    // Data stay as they are where nobody looks on.
    write("data.nc", format!("%\nG21 G90\n({STEERING})\nG1 X10 F100\nM30\n"));
    let done = truepath(desk.path(), &["canon", "data.nc"]);
    assert!(text(&done.stdout).contains('\x1b'), "{}", text(&done.stdout));
}

#[cfg(unix)]
#[test]
fn data_that_a_person_looks_at_steer_nothing_either() {
    use portable_pty::{CommandBuilder, PtySize, native_pty_system};
    use std::io::Read;
    let desk = desk();
    let program = format!("%\nG21 G90\n({STEERING})\nG1 X10 F100\nM30\n");
    std::fs::write(desk.path().join("data.nc"), program).expect("a file");
    let pair = native_pty_system().openpty(PtySize::default()).expect("a terminal");
    let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_truepath"));
    command.args(["canon", "data.nc"]);
    command.cwd(desk.path());
    let mut child = pair.slave.spawn_command(command).expect("the program runs");
    drop(pair.slave);
    let mut reader = pair.master.try_clone_reader().expect("a reader");
    let (mut shown, mut buffer) = (Vec::new(), [0; 4096]);
    // On Linux the end of a terminal is an error.
    while let Ok(count @ 1..) = reader.read(&mut buffer) {
        shown.extend_from_slice(&buffer[..count]);
    }
    assert!(child.wait().expect("it ends").success());
    let shown = text(&shown).replace("\r\n", "\n");
    assert!(shown.contains("␛[2J"), "{shown:?}");
    assert_steers_nothing(shown.as_bytes(), "canon");
}

#[cfg(unix)]
#[test]
fn ctrl_c_during_the_demonstration_leaves_nothing_behind() {
    use std::time::{Duration, Instant};
    let place = tempfile::tempdir().expect("a folder");
    let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
    command.args(["demo", "-o", "out/demo"]).current_dir(place.path()).stdout(std::process::Stdio::null());
    let mut process = command.spawn().expect("the program runs");
    let start = Instant::now();
    while !place.path().join("out/demo").exists() {
        assert!(start.elapsed() < Duration::from_secs(60), "it does not begin");
        std::thread::sleep(Duration::from_millis(2));
    }
    // In the middle of the milling.
    std::thread::sleep(Duration::from_millis(300));
    let kill = Command::new("kill").args(["-INT", &process.id().to_string()]).status();
    assert!(kill.expect("kill runs").success());
    assert_eq!(process.wait().expect("it ends").code(), Some(130));
    assert_eq!(std::fs::read_dir(place.path()).expect("a folder").count(), 0);
}
