//! `publish` as a process: its end by a signal and without one, and what it refuses.

use std::io::{BufRead, BufReader};
use std::net::TcpStream;
use std::os::unix::process::ExitStatusExt;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::{Duration, Instant};

use serde_json::{Value, json};

use crate::publish_support::batches::{summary, write};
use crate::publish_support::mosquitto::{Listener, Mosquitto, SOON};
use crate::workplace::{text, truepath};

/// The program at work, killed with this.
struct Running(Child);

impl Running {
    fn start(place: &Path, arguments: &[&str]) -> Self {
        let mut command = Command::new(env!("CARGO_BIN_EXE_truepath"));
        command.arg("publish").args(arguments).args(["--machine", "vf2", "--every", "0.1", "--json"]);
        command.current_dir(place).stdout(Stdio::piped()).stderr(Stdio::piped());
        Self(command.spawn().expect("the program runs"))
    }

    fn signal(&self, name: &str) {
        let kill = Command::new("kill").args([name, &self.0.id().to_string()]).status();
        assert!(kill.expect("kill runs").success());
    }

    /// How it ended: by which signal, and what it printed.
    fn ended(mut self) -> (Option<i32>, String) {
        let begin = Instant::now();
        let status = loop {
            if let Some(status) = self.0.try_wait().expect("it can be waited for") {
                break status;
            }
            assert!(begin.elapsed() < SOON, "it does not end");
            std::thread::sleep(Duration::from_millis(10));
        };
        let mut said = String::new();
        let _ = std::io::Read::read_to_string(&mut self.0.stdout.take().expect("its output"), &mut said);
        (status.signal(), said)
    }
}

impl Drop for Running {
    fn drop(&mut self) {
        let _ = self.0.kill().and_then(|()| self.0.wait());
    }
}

/// A folder with a batch `corner`.
fn desk() -> tempfile::TempDir {
    let desk = tempfile::tempdir().expect("a folder");
    write(&desk.path().join("corner"), &summary(&[0.0, 0.001], 0.01));
    desk
}

fn state(listener: &Listener, status: &str) -> Value {
    listener.until("state", |state| state["status"] == status).payload
}

#[test]
fn whoever_kills_it_leaves_a_state_that_is_offline_and_whoever_interrupts_it_as_well() {
    let Some(broker) = Mosquitto::running() else { return };
    let desk = desk();
    let listener = broker.listen();
    let url = broker.url();
    let start = || Running::start(desk.path(), &["corner", "--mqtt", &url]);
    let killed = start();
    assert_eq!(state(&listener, "online")["last_part"], 2);
    // The folder is followed.
    write(&desk.path().join("corner"), &summary(&[0.0, 0.001, 0.002], 0.01));
    assert_eq!(listener.next("part").payload["part"], 3);
    killed.signal("-KILL");
    assert_eq!(state(&listener, "offline"), json!({"schema": 1, "machine": "vf2", "status": "offline"}));
    assert_eq!(killed.ended().0, Some(9));
    for (name, number) in [("-INT", 2), ("-TERM", 15)] {
        let interrupted = start();
        assert_eq!(state(&listener, "online")["last_part"], 3);
        interrupted.signal(name);
        state(&listener, "offline");
        // A shell says 130 and 143.
        let (signal, said) = interrupted.ended();
        assert_eq!(signal, Some(number));
        let said: Value = serde_json::from_str(&said).unwrap_or_else(|_| panic!("{said}"));
        // The state, and that nobody follows any more; the parts were there before.
        assert_eq!((&said["acknowledged"]["states"], &said["acknowledged"]["parts"]), (&json!(2), &json!(0)), "{said}");
    }
    // It stays for those who come later.
    let kept = broker.listen().within(Duration::from_millis(300));
    assert!(kept.iter().any(|heard| heard.kept && heard.payload["status"] == "offline"), "{kept:#?}");
}

#[test]
fn under_nohup_it_outlives_the_terminal_that_started_it() {
    let Some(broker) = Mosquitto::running() else { return };
    let desk = desk();
    let listener = broker.listen();
    let program = env!("CARGO_BIN_EXE_truepath");
    let mut shell = Command::new("sh");
    shell.args([
        "-c",
        "trap '' HUP; exec \"$@\"",
        "sh",
        program,
        "publish",
        "corner",
        "--machine",
        "vf2",
        "--every",
        "0.1",
    ]);
    shell.args(["--mqtt", &broker.url()]).current_dir(desk.path()).stdout(Stdio::piped()).stderr(Stdio::null());
    let running = Running(shell.spawn().expect("a shell"));
    state(&listener, "online");
    running.signal("-HUP");
    std::thread::sleep(Duration::from_millis(200));
    write(&desk.path().join("corner"), &summary(&[0.0, 0.001, 0.002], 0.01));
    assert_eq!(listener.next("part").payload["part"], 3);
    running.signal("-INT");
    assert_eq!(running.ended().0, Some(2));
}

#[test]
fn an_agent_finds_it_and_nobody_else_is_needed() {
    let desk = desk();
    let mut running = Running::start(desk.path(), &["corner", "missing", "--mtconnect", "0"]);
    let mut notes = BufReader::new(running.0.stderr.take().expect("its notes")).lines().map_while(Result::ok);
    let found = notes.find_map(|line| Some(line.split_once("find it at ")?.1.trim_end_matches("\"}").to_owned()));
    let agent = TcpStream::connect(found.expect("its address")).expect("a connection");
    agent.set_read_timeout(Some(SOON)).expect("a time");
    let mut lines = BufReader::new(agent).lines().map_while(Result::ok);
    // A folder that is not there yet is told and waited for.
    assert!(notes.any(|line| line.contains("missing/summary.json cannot be read")));
    assert!(lines.any(|line| line.contains("|tp_last_part|2|")));
    write(&desk.path().join("missing"), &summary(&[0.02], 0.01));
    let alarm = lines.find(|line| line.contains("|tp_alarm|FAULT|missing/out_of_tolerance|"));
    assert!(alarm.is_some());
    running.signal("-INT");
    assert!(lines.any(|line| line.contains("|tp_avail|UNAVAILABLE")));
    assert_eq!(running.ended().0, Some(2));
}

#[test]
fn everything_once_is_exit_code_0_and_what_cannot_be_read_1() {
    let Some(broker) = Mosquitto::running() else { return };
    let desk = desk();
    let url = broker.url();
    let once = || truepath(desk.path(), &["publish", "corner", "--machine", "vf2", "--mqtt", &url, "--once"]);
    let done = once();
    assert_eq!(done.status.code(), Some(0), "{}", text(&done.stderr));
    assert_eq!(text(&done.stdout), "vf2: 1 states, 2 parts, 1 sets of alarms acknowledged\n");
    assert_eq!(broker.listen().next("state").payload["status"], "once");
    std::fs::write(desk.path().join("corner/summary.json"), "{\"touched\": 3, ").expect("written");
    let failed = once();
    assert_eq!((failed.status.code(), text(&failed.stdout)), (Some(1), String::new()));
    assert!(text(&failed.stderr).contains("Q013"), "{}", text(&failed.stderr));
}

#[test]
fn what_cannot_be_published_is_refused_before_anything_is_sent() {
    let desk = desk();
    let refused = |arguments: &[&str]| {
        let words = [&["publish", "corner", "--json"][..], arguments].concat();
        let done = truepath(desk.path(), &words);
        let said = text(&done.stderr);
        let last = said.lines().last().unwrap_or_default().to_owned();
        assert!(!said.contains("geheim"), "{said}");
        let error: Value = serde_json::from_str(&last).unwrap_or_else(|_| panic!("{said}"));
        (done.status.code(), error["error"]["code"].as_str().unwrap_or_default().to_owned())
    };
    let cases = [
        (&["--machine", "vf2"][..], 2, "C001"),
        (&["--machine", "vf2", "--once"], 2, "C001"),
        (&["--machine", "vf2", "--mtconnect", "7878", "--once", "--mqtt", "mqtt://localhost"], 2, "C001"),
        (&["--machine", "a/b", "--mqtt", "mqtt://localhost"], 1, "Q014"),
        (&["--machine", "vf2", "--mqtt", "mqtt://ann:geheim@localhost"], 1, "Q015"),
        (&["--machine", "vf2", "--mqtt", "http://localhost"], 1, "Q015"),
        (&["--machine", "vf2", "--mqtt", "mqtt://localhost", "--ca", "none.pem"], 2, "C001"),
        (&["--machine", "vf2", "--mqtt", "mqtts://localhost", "--ca", "none.pem"], 1, "F001"),
        (&["--machine", "vf2", "--mqtt", "mqtts://localhost", "--ca", "corner/summary.json"], 1, "Q018"),
        (&["corner", "--machine", "vf2", "--mqtt", "mqtt://localhost"], 2, "C001"),
        (&["--machine", "vf2", "--mtconnect", "192.0.2.1:7878"], 1, "Q017"),
    ];
    for (arguments, exit, code) in cases {
        assert_eq!(refused(arguments), (Some(exit), code.to_owned()), "{arguments:?}");
    }
}
