//! The live views on a real pseudo-terminal: they draw, follow the keys, and give the terminal back on every way out.
#![cfg(unix)]

mod monitor_support;

use std::io::{BufRead, BufReader};
use std::path::Path;
use std::process::{Command, Stdio};

use monitor_support::cable::Cable;
use monitor_support::{OnTerminal, Served, image};
use truepath::command::hil::{Kind, Options, Source, open, run};
use truepath_bench::Faults;

const LARGE: (u16, u16) = (24, 80);

/// `device monitor` of a served device.
fn monitor<'a>(served: &'a Served, more: &[&'a str]) -> Vec<&'a str> {
    ["device", "--port", &served.config, "monitor", "--every-ms", "50"].iter().chain(more).copied().collect()
}

fn on_terminal(arguments: &[&str]) -> OnTerminal {
    OnTerminal::start(arguments, LARGE.0, LARGE.1, &[])
}

/// Setpoints along the image on the served device, by way of its setpoint link.
fn mill(served: &Served, image: &Path, count: u64) {
    let kind = Kind::Ports { names: [served.setpoints.clone(), served.config.clone()], bauds: [0; 2] };
    let mut board = open(&kind, 8, false).unwrap();
    let options = Options { source: Source::Path, count, axes: 3, rate_hz: 1_000, faults: Faults::default(), seed: 1 };
    let report = run(&mut *board, &std::fs::read(image).unwrap(), &options, &mut |_| ()).unwrap();
    assert!(report.identical, "{report:?}");
}

#[test]
fn the_view_of_a_device_follows_keys_and_size_and_is_left_with_q() {
    let served = Served::start();
    let mut view = on_terminal(&monitor(&served, &[]));
    for wanted in ["O F F", "Nothing goes to the drives", "No image is active", "req. damaged"] {
        view.shows(wanted);
    }
    assert!(view.screen.screen().alternate_screen() && view.screen.screen().hide_cursor());
    view.press("?");
    view.shows("Help");
    view.press("\x1b");
    view.lacks("Help");
    view.press("p");
    view.shows("PAUSED");
    view.resize(10, 40);
    view.shows("q leave  p pause");
    view.shows("OFF");
    view.press("q");
    assert_eq!(view.ends().exit_code(), 0);
    view.is_as_before();
}

#[test]
fn ctrl_c_and_esc_leave_the_view_and_so_does_the_end_of_its_time() {
    let served = Served::start();
    for key in ["\x03", "\x1b"] {
        let mut view = on_terminal(&monitor(&served, &[]));
        view.shows("O F F");
        view.press(key);
        assert_eq!(view.ends().exit_code(), 0);
        view.is_as_before();
    }
    let mut view = on_terminal(&monitor(&served, &["--seconds", "1"]));
    assert_eq!(view.ends().exit_code(), 0);
    view.is_as_before();
}

#[test]
fn a_signal_gives_the_terminal_back_and_ends_the_program_as_ever() {
    let served = Served::start();
    for (name, words) in [("-TERM", "Terminated"), ("-INT", "Interrupt"), ("-HUP", "Hangup")] {
        let mut view = on_terminal(&monitor(&served, &[]));
        view.shows("O F F");
        assert!(Command::new("kill").args([name, &view.id().to_string()]).status().unwrap().success());
        let status = view.ends();
        assert!(status.signal().is_some_and(|signal| signal.starts_with(words)), "{status:?}");
        view.is_as_before();
    }
}

#[test]
fn a_device_that_falls_silent_is_lost_until_it_answers_and_lost_when_left_is_an_error() {
    let served = Served::start();
    let mut view = on_terminal(&monitor(&served, &[]));
    view.shows("O F F");
    served.answers(false);
    view.shows("L O S T");
    view.shows("Trying on: the device does not answer");
    served.answers(true);
    view.shows("O F F");
    served.answers(false);
    view.shows("L O S T");
    view.press("q");
    assert_eq!(view.ends().exit_code(), 1);
    view.is_as_before();
    let said = view.text();
    assert!(said.contains("H003") && said.contains("when the view was left"), "{said}");
}

#[test]
fn a_cable_that_is_pulled_out_is_lost_until_it_is_plugged_in_again() {
    let served = Served::start();
    let mut cable = Cable::to(&served.config);
    let port = cable.port();
    let mut view = on_terminal(&["device", "--port", port.to_str().unwrap(), "monitor", "--every-ms", "50"]);
    view.shows("O F F");
    cable.pull();
    view.shows("L O S T");
    cable.plug();
    view.shows("O F F");
    cable.pull();
    view.shows("L O S T");
    view.press("\x03");
    assert_eq!(view.ends().exit_code(), 1);
    view.is_as_before();
    assert!(view.text().contains("H003") || view.text().contains("H001"), "{}", view.text());
}

#[test]
fn a_port_that_is_not_there_is_an_error_before_there_is_a_view() {
    let mut view = on_terminal(&["device", "--port", "tcp:127.0.0.1:1", "monitor"]);
    assert_eq!(view.ends().exit_code(), 1);
    assert!(view.text().contains("H001") && !view.raw.windows(8).any(|w| w == b"\x1b[?1049h"), "{}", view.text());
}

#[test]
fn lines_are_printed_when_they_are_asked_for_or_nobody_looks_on() {
    let served = Served::start();
    let lines = |text: &str| {
        let mut lines = text.lines();
        assert!(lines.next().unwrap().contains("t s  state    sequence      node   corr X nm"), "{text}");
        assert!(lines.clone().count() >= 2 && lines.all(|line| line.contains("  Off  ")), "{text}");
    };
    // One after the other: the device has one configuration link.
    let output =
        Command::new(env!("CARGO_BIN_EXE_truepath")).args(monitor(&served, &["--seconds", "1"])).output().unwrap();
    lines(&String::from_utf8(output.stdout).unwrap());
    assert!(output.status.success() && output.stderr.is_empty());
    for (more, environment) in [(&["--plain"][..], &[][..]), (&[], &[("TERM", "dumb")])] {
        let arguments = [&monitor(&served, &["--seconds", "1"]), more].concat();
        let mut view = OnTerminal::start(&arguments, 40, 160, environment);
        assert_eq!(view.ends().exit_code(), 0);
        assert!(!view.raw.contains(&0x1b), "{:?}", String::from_utf8_lossy(&view.raw));
        lines(&view.text());
    }
    let mut view = OnTerminal::start(&[&monitor(&served, &["--seconds", "1"])[..], &["--json"]].concat(), 24, 200, &[]);
    assert_eq!(view.ends().exit_code(), 0);
    assert!(view.raw.starts_with(b"{\"dropped\":0,") && !view.raw.contains(&0x1b), "{}", view.text());
}

#[test]
fn lines_end_quietly_when_nobody_reads_them_any_more() {
    let served = Served::start();
    let mut child = Command::new(env!("CARGO_BIN_EXE_truepath"))
        .args(monitor(&served, &["--seconds", "60"]))
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let mut line = String::new();
    BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
    let output = child.wait_with_output().unwrap();
    assert!(output.status.success() && output.stderr.is_empty(), "{output:?}");
}

#[test]
fn the_active_image_is_named_with_what_it_belongs_to() {
    let folder = tempfile::tempdir().unwrap();
    let image = image(folder.path());
    let path = image.display().to_string();
    let served = Served::start();
    mill(&served, &image, 3_000);
    let mut view = on_terminal(&monitor(&served, &["--image", &path]));
    view.shows("program 1234abcd  feature 1  pass 1  tool 4");
    view.press("q");
    assert_eq!(view.ends().exit_code(), 0);
    view.is_as_before();
}

#[test]
fn a_run_on_a_terminal_shows_itself_and_leaves_its_report_on_the_screen() {
    let folder = tempfile::tempdir().unwrap();
    let path = image(folder.path()).display().to_string();
    let arguments = ["hil", &path, "--count", "60000", "--drop", "0.01", "--seed", "5"];
    let mut view = OnTerminal::start(&arguments, 40, 100, &[]);
    view.shows("answers compared, all identical");
    view.shows("of 60,000 setpoints");
    view.shows("off the period of 1000.000");
    assert!(view.screen.screen().alternate_screen());
    assert_eq!(view.ends().exit_code(), 0, "{}", view.text());
    view.is_as_before();
    let piped = Command::new(env!("CARGO_BIN_EXE_truepath")).args(arguments).output().unwrap();
    let report = String::from_utf8(piped.stdout).unwrap();
    assert!(report.ends_with("identical\n") && !report.contains('\x1b'));
    // The same report, but for the time it took.
    let timeless = |text: &str| {
        let lines = text.lines().map(str::trim_end).filter(|line| !line.is_empty() && !line.ends_with(" setpoints/s"));
        lines.map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(timeless(&view.text()), timeless(&report));
}

#[test]
fn a_run_that_is_stopped_reports_what_was_done_and_is_no_success() {
    let folder = tempfile::tempdir().unwrap();
    let path = image(folder.path()).display().to_string();
    let mut view = OnTerminal::start(&["hil", &path, "--count", "500000000"], 40, 100, &[]);
    view.shows("answers compared, all identical");
    view.press("q");
    assert_eq!(view.ends().exit_code(), 1);
    view.is_as_before();
    let said = view.text();
    for wanted in ["setpoints/s", "identical", "H008", "of 500000000 setpoints"] {
        assert!(said.contains(wanted), "{wanted}: {said}");
    }
}

#[test]
fn a_run_over_streams_counts_answers_as_they_arrive() {
    let folder = tempfile::tempdir().unwrap();
    let path = image(folder.path()).display().to_string();
    let served = Served::start();
    let ports = ["--board", "serial", "--port", &served.setpoints, "--config-port", &served.config];
    // The first batch of 8,192 takes eight seconds at this rate.
    let arguments = [&["hil", &path, "--count", "20000", "--rate", "1000"][..], &ports].concat();
    let mut view = OnTerminal::start(&arguments, 24, 80, &[]);
    view.shows("no answer compared yet, ");
    view.shows("round trip: min");
    view.press("q");
    view.shows("stopping after this batch");
    view.press("q");
    assert_eq!(view.ends().exit_code(), 1);
    view.is_as_before();
    assert!(view.text().contains("H008") && view.text().contains("within a batch"), "{}", view.text());
}
