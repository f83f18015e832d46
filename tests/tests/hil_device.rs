//! `truepath device` against a device behind a socket: what an engineer does with a new board, from the first look to the
//! recording of a fault.

mod hil_support;

use std::fs;
use std::path::Path;
use std::process::{Command, Output};

use hil_support::{image, options, part, serve};
use truepath::bench::{Board, Faults};
use truepath::command::device::{Recorded, recording, recording_table};
use truepath::command::hil::{Kind, Source, open, run};
use truepath_core::image::Image;
use truepath_core::link::Ask;

/// The program's own binary would have to be built for this; the library is called as `main` calls it, in a process of
/// its own by way of this test binary.
fn device(folder: &Path, arguments: &[&str]) -> (u8, String) {
    let Output { status, stdout, .. } = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "the_command_line_itself", "--nocapture", "--ignored"])
        .env("TRUEPATH_ARGUMENTS", arguments.join("\n"))
        .env("TRUEPATH_PORT", folder.join("config.sock"))
        .output()
        .unwrap();
    let text = String::from_utf8(stdout).unwrap();
    let said = text.split_once(BEGIN).unwrap().1.split_once(END).unwrap().0;
    let code = if status.success() { 0 } else { 1 };
    (code, said.to_owned())
}

const BEGIN: &str = "<<<said\n";
const END: &str = "said>>>";

#[test]
#[ignore = "called by the others, in a process of its own"]
fn the_command_line_itself() {
    let Ok(arguments) = std::env::var("TRUEPATH_ARGUMENTS") else { return };
    let port = std::env::var("TRUEPATH_PORT").unwrap();
    print!("{BEGIN}");
    let words = ["truepath", "device", "--port", &port].into_iter().chain(arguments.lines()).map(Into::into);
    let code = truepath::cli::run(words);
    print!("{END}");
    assert_eq!(code, std::process::ExitCode::SUCCESS);
}

#[test]
fn a_new_board_is_looked_at_loaded_configured_and_its_fault_recorded() {
    let folder = tempfile::tempdir().unwrap();
    serve(folder.path());
    let ask = |arguments: &[&str]| {
        let (code, said) = device(folder.path(), arguments);
        assert_eq!(code, 0, "{arguments:?}: {said}");
        said
    };
    let json = |arguments: &[&str]| -> serde_json::Value { serde_json::from_str(&ask(arguments)).unwrap() };
    assert!(ask(&["info"]).contains("Off (nothing happened), drive enable dropped, no image"));
    assert_eq!(ask(&["list"]), "slot 0: empty\nslot 1: empty\n");

    let file = part(0).join("correction.tpi").display().to_string();
    let name = format!("{:08x}", Image::new_checked(&image(0)).unwrap().crc());
    assert_eq!(json(&["--json", "upload", &file])["crc"], name);
    assert!(ask(&["list"]).contains(&format!("image {name}")) && !ask(&["list"]).contains("ACTIVE"));
    assert!(ask(&["activate", "0"]).contains(&name));
    assert!(ask(&["list"]).contains("ACTIVE"));

    assert!(ask(&["settings"]).contains("rewriter.tick_hz = 1000\n"));
    assert!(ask(&["settings", "rewriter.tick_hz=2000", "axes=4"]).contains("rewriter.tick_hz = 2000\n"));
    assert_eq!(json(&["--json", "settings"])["axes"], 4);
    // Out of range is the device's to say.
    assert_eq!(device(folder.path(), &["settings", "rewriter.tick_hz=1"]).0, 1);
    assert_eq!(device(folder.path(), &["activate", "1"]).0, 1);

    // A part with mischief, until something went wrong.
    let name = |file: &str| folder.path().join(file).display().to_string();
    let kind = Kind::Ports { names: [name("setpoint.sock"), name("config.sock")], baud: 0 };
    let mut board = open(&kind, 8, false).unwrap();
    let report = run(&mut *board, &image(0), &options(Source::Random, 6_000, Faults::default(), 3), &mut |_| ());
    let report = report.unwrap();
    assert!(report.identical && !report.faults.is_empty(), "{report:?}");
    drop(board);
    let monitored = ask(&["--json", "monitor", "--seconds", "1"]);
    assert!(monitored.lines().count() >= 3 && monitored.contains("\"mode\":\"Off\""), "{monitored}");
    assert!(ask(&["counters", "--clear"]).contains("accepted"));
    ask(&["restart", "--watchdog"]);
    let info = json(&["--json", "info"]);
    assert_eq!(info["device"]["last_reset"], "Watchdog");
    // Nothing is recorded after a reset, and that is said.
    let table = folder.path().join("frames.csv").display().to_string();
    assert_eq!(device(folder.path(), &["record", "-o", &table]).0, 1);
    assert!(!fs::exists(&table).unwrap());
}

#[test]
fn an_image_is_made_on_the_device_from_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    serve(folder.path());
    let [job, probe] = ["job.toml", "probe.txt"].map(|file| part(0).join(file).display().to_string());
    let (code, said) = device(folder.path(), &["compute", &job, "--probe", &probe, "--activate"]);
    let name = format!("{:08x}", Image::new_checked(&image(0)).unwrap().crc());
    assert!(code == 0 && said.contains(&name), "{said}");
    let (_, list) = device(folder.path(), &["list"]);
    assert!(list.contains("ACTIVE") && list.contains(&name), "{list}");
}

#[test]
fn the_frames_before_a_fault_are_downloaded_as_they_were_sent() {
    let mut board = hil_support::host_board();
    let report = hil_support::on(&mut board, 0, &options(Source::Random, 20_000, Faults::default(), 3));
    assert!(report.identical && !report.faults.is_empty(), "{report:?}");
    let frames = recording(&mut board.client(), 3, |_, _| ()).unwrap();
    let sequences: Vec<u32> =
        frames.iter().map(|f| if let Recorded::Setpoint(s) = f { s.sequence } else { panic!("damaged") }).collect();
    // The recorder is full and stands: what it holds are neighbours, but for mischief with the counting.
    let neighbours = sequences.windows(2).filter(|pair| pair[1].wrapping_sub(pair[0]) == 1).count();
    assert!(sequences.len() > 500 && neighbours > sequences.len() - 5, "{} {neighbours}", sequences.len());
    assert_eq!(recording_table(&frames, 3).lines().count(), sequences.len() + 1);
    // Released it runs again.
    board.client().done(Ask::ReleaseRecording).unwrap();
    assert!(recording(&mut board.client(), 3, |_, _| ()).is_err());
}
