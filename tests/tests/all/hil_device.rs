//! `truepath device` against a device behind a socket: what an engineer does with a new board, from the first look to the
//! recording of a fault.

use std::fs;
use std::io::{Read, Write};
use std::os::unix::net::UnixStream;
use std::path::Path;
use std::process::{Command, Output};

use crate::hil_support::{image, options, part, serve, serve_device};
use truepath::command::hil::{Kind, Source, open, run};
use truepath::coprocessor::{Recorded, recording, recording_table};
use truepath_bench::{Board, Faults, InProcess};
use truepath_core::image::Image;
use truepath_core::link::{Ask, SetpointFrame};
use truepath_core::rewrite::{Flags, Frame, Setpoint};
use truepath_correction::correct::correct_pass;
use truepath_ground::diagnostics;
use truepath_job::job::{JobFile, Route};
use truepath_job::measurement::Measurement;
use truepath_job::pass::Pass;

/// The program's own binary would have to be built for this; the library is called as `main` calls it, in a process of
/// its own by way of this test binary.
fn device(folder: &Path, arguments: &[&str]) -> (u8, String) {
    let (code, said, _) = called(&at_port(folder, arguments));
    (code, said)
}

/// What it says on standard error.
fn device_with_errors(folder: &Path, arguments: &[&str]) -> (u8, String) {
    let (code, _, complaint) = called(&at_port(folder, arguments));
    // The test binary adds its own lines.
    (code, complaint.lines().find(|line| line.starts_with('{')).unwrap_or_default().to_owned())
}

fn at_port(folder: &Path, arguments: &[&str]) -> Vec<String> {
    let port = folder.join("config.sock").display().to_string();
    ["device", "--port", &port].into_iter().chain(arguments.iter().copied()).map(str::to_owned).collect()
}

fn called(arguments: &[String]) -> (u8, String, String) {
    let Output { status, stdout, stderr } = Command::new(std::env::current_exe().unwrap())
        .args(["--exact", "hil_device::child_that_is_the_command_line", "--nocapture", "--ignored"])
        .env("TRUEPATH_ARGUMENTS", arguments.join("\n"))
        .output()
        .unwrap();
    let text = String::from_utf8(stdout).unwrap();
    let said = text.split_once(BEGIN).unwrap().1.split_once(END).unwrap().0;
    let code = if status.success() { 0 } else { 1 };
    (code, said.to_owned(), String::from_utf8(stderr).unwrap())
}

const BEGIN: &str = "<<<said\n";
const END: &str = "said>>>";

#[test]
#[ignore = "called by the others, in a process of its own"]
fn child_that_is_the_command_line() {
    let Ok(arguments) = std::env::var("TRUEPATH_ARGUMENTS") else { return };
    print!("{BEGIN}");
    let code = truepath::cli::run(["truepath"].into_iter().chain(arguments.lines()).map(Into::into));
    print!("{END}");
    assert_eq!(code, 0);
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

    // A part with disturbances, until something went wrong.
    let name = |file: &str| folder.path().join(file).display().to_string();
    let kind = Kind::Ports { names: [name("setpoint.sock"), name("config.sock")], bauds: [0; 2] };
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
fn a_device_with_a_key_takes_what_is_signed_with_it_and_says_what_to_do_about_anything_else() {
    let folder = tempfile::tempdir().unwrap();
    serve_device(folder.path(), InProcess::attended().unwrap());
    let file = |name: &str| folder.path().join(name).display().to_string();
    let call = |words: &[&str]| {
        let (code, said, complaint) = called(&words.iter().map(|word| (*word).to_owned()).collect::<Vec<_>>());
        assert_eq!(code, 0, "{words:?}: {complaint}");
        said
    };
    let ask = |arguments: &[&str]| {
        let (code, said) = device(folder.path(), arguments);
        assert_eq!(code, 0, "{arguments:?}: {said}");
        said
    };
    let key = file("shop.key");
    let told = |arguments: &[&str]| {
        let (code, said) = device_with_errors(folder.path(), &[&["--json"], arguments].concat());
        assert_eq!(code, 1, "{arguments:?}");
        let error: serde_json::Value = serde_json::from_str(&said).unwrap_or_else(|e| panic!("{e}: {said}"));
        ["code", "message", "help"].map(|part| error["error"][part].as_str().unwrap().to_owned()).concat()
    };
    let refused = |image: &str| told(&["--key", &key, "upload", image]);
    for name in ["shop.key", "stranger.key", "operator.key"] {
        call(&["key", "new", &file(name)]);
    }
    let plain = part(0).join("correction.tpi").display().to_string();
    for (key, class, name) in
        [("shop.key", "bench", "good.tpi"), ("shop.key", "board", "board.tpi"), ("stranger.key", "bench", "other.tpi")]
    {
        call(&["image", "sign", &plain, "--key", &file(key), "--for", class, "-o", &file(name)]);
    }
    assert!(ask(&["keys"]).contains("OPEN") && ask(&["info"]).contains("OPEN"));
    ask(&["upload", &plain, "--activate"]);
    assert!(!ask(&["provision", &file("shop.key.pub")]).contains("OPEN"));
    assert!(ask(&["info"]).contains("no image"), "what came while it was open is in use no more");

    // Roles: nobody without a key, an operator, a stranger.
    ask(&["provision", &file("operator.key.pub"), "--role", "operate", "--no-images"]);
    let said = ask(&["keys"]);
    assert!(said.contains(": engineer, signs images\n") && said.contains(": operate\n"), "{said}");
    let (anybody, operator, stranger) = (
        told(&["upload", &plain]),
        told(&["--key", &file("operator.key"), "settings", "axes=4"]),
        told(&["--key", &file("stranger.key"), "deactivate"]),
    );
    assert!(anybody.starts_with("K110") && anybody.contains("engineer") && anybody.contains("--key"), "{anybody}");
    assert!(operator.starts_with("K112") && operator.contains("operate at most"), "{operator}");
    assert!(stranger.starts_with("K111"), "{stranger}");
    assert!(ask(&["settings"]).contains("axes = 3"), "reading needs no role");
    ask(&["--key", &file("operator.key"), "counters", "--clear"]);

    let unsigned = refused(&plain);
    assert!(unsigned.contains("not signed") && unsigned.contains("--sign"), "{unsigned}");
    let (other, board) = (refused(&file("other.tpi")), refused(&file("board.tpi")));
    assert!(other.contains("key") && board.contains("board"), "{other} {board}");
    ask(&["--key", &key, "upload", &file("good.tpi"), "--activate"]);
    assert!(ask(&["list"]).contains("ACTIVE"));
    // The image in use is verified anew behind a reset.
    ask(&["--key", &key, "restart"]);
    assert!(ask(&["list"]).contains("ACTIVE"));

    // One that was signed earlier, and the way back to it.
    let sign = |image: &str, counter: &[&str], name: &str| {
        let (key, to) = (file("shop.key"), file(name));
        call(&[&["image", "sign", image, "--key", &key, "-o", &to], counter].concat());
    };
    sign(&plain, &["--counter", "1000"], "older.tpi");
    let older = refused(&file("older.tpi"));
    assert!(older.contains("1000") && older.contains("sign this one again"), "{older}");
    sign(&file("older.tpi"), &[], "again.tpi");
    ask(&["--key", &key, "upload", &file("again.tpi"), "--activate"]);
    let log = ask(&["log"]);
    assert!(log.contains("activated, signed by") && log.contains("logged in to engineer"), "{log}");
    assert!(log.contains("logged in to operate") && log.contains("failed logins") && log.contains("Z  "), "{log}");

    // A key that got out.
    let keys: serde_json::Value = serde_json::from_str(&ask(&["--json", "keys"])).unwrap();
    let [id, operator] = [0, 1].map(|at| keys["keys"][at].as_str().unwrap().to_owned());
    ask(&["revoke", &operator]);
    assert_eq!(device(folder.path(), &["revoke", "0123456789abcdef"]).0, 1, "not one that is there");
    assert_eq!(device(folder.path(), &["revoke", &id[1..]]).0, 1);
    let said = ask(&["revoke", &id]);
    assert!(said.contains("CLOSED") && said.contains(&id.to_string()), "{said}");
    assert!(ask(&["info"]).contains("no image") && ask(&["info"]).contains("CLOSED"));
    let closed = told(&["--key", &file("shop.key"), "upload", &plain]);
    assert!(closed.starts_with("K111") && closed.contains("revoked"), "{closed}");
}

/// So many setpoints to the device behind the socket, each a millisecond after the one before.
fn send(folder: &Path, sequence: &mut u32, count: u32, flags: Flags, frame_crc: u32) {
    let mut stream = UnixStream::connect(folder.join("setpoint.sock")).unwrap();
    let mut answer = [0; 256];
    for _ in 0..count {
        *sequence += 1;
        let setpoint = Setpoint { sequence: *sequence, flags, frame_crc, ..Setpoint::default() };
        let mut packet = [0; 80];
        let used = SetpointFrame { axes: 3, setpoint }.encode_packet(&mut packet).unwrap();
        stream.write_all(&packet[..used]).unwrap();
        assert!(stream.read(&mut answer).unwrap() > 0);
    }
}

#[test]
fn a_controller_acknowledges_and_arms_and_every_refusal_says_what_to_do() {
    let folder = tempfile::tempdir().unwrap();
    serve(folder.path());
    let mut sequence = 0;
    let ask = |arguments: &[&str]| {
        let (code, said) = device(folder.path(), arguments);
        assert_eq!(code, 0, "{arguments:?}: {said}");
        said
    };
    let refused = |arguments: &[&str]| {
        let (code, said) = device_with_errors(folder.path(), arguments);
        assert_eq!(code, 1, "{arguments:?}");
        let error: serde_json::Value = serde_json::from_str(&said).unwrap_or_else(|e| panic!("{e}: {said}"));
        error["error"]["help"].as_str().unwrap().to_owned() + error["error"]["message"].as_str().unwrap()
    };
    let arm = ["--json", "arm", "--part", "7", "--offset-nm", "-1000,2,3"];
    assert!(refused(&arm).contains("no active image"));
    let file = part(0).join("correction.tpi").display().to_string();
    ask(&["upload", &file, "--activate"]);
    assert!(refused(&arm).contains("device settings"), "not configured");
    ask(&["settings", "axes=3"]);
    assert!(refused(&["--json", "acknowledge"]).contains("start the controller"));
    send(folder.path(), &mut sequence, 40, Flags::DRIVES_ENABLED, 0);
    assert!(refused(&["--json", "acknowledge"]).contains("machine off"));
    assert!(refused(&arm).contains("truepath device acknowledge"));
    send(folder.path(), &mut sequence, 40, Flags(0), 0);
    assert!(ask(&["acknowledge"]).contains("bypass"));

    let with = |more: &[&'static str]| [&arm[..], more].concat();
    assert!(refused(&with(&["--program-crc", "12345678"])).contains("12345678"));
    assert!(refused(&with(&["--tool", "99"])).contains("activate the image of this program"));
    assert!(refused(&with(&["--cosine", "5"])).contains("one angle"));
    assert!(refused(&with(&["--axes", "0,1,1"])).contains("three"));
    let checked: serde_json::Value = serde_json::from_str(&ask(&with(&["--check"]))).unwrap();
    assert_eq!((checked["armed"].as_bool(), checked["part"].as_u64()), (Some(false), Some(7)));
    let armed: serde_json::Value = serde_json::from_str(&ask(&with(&["--image", file.clone().leak()]))).unwrap();
    let frame = Frame { offset_nm: [-1_000, 2, 3], ..Frame::identity() }.sealed();
    assert_eq!(armed["frame_crc"].as_u64(), Some(frame.crc.into()));
    send(folder.path(), &mut sequence, 2, Flags::DRIVES_ENABLED, frame.crc);
    assert!(ask(&["info"]).contains("Armed"));
    assert!(ask(&["disarm"]).contains("disarmed"));
    assert!(refused(&arm).contains("higher than the one before"), "one part, one arming");
    // A frame other than the one armed ends the next arming at once.
    ask(&["arm", "--part", "8", "--offset-nm", "0,0,0"]);
    send(folder.path(), &mut sequence, 2, Flags::DRIVES_ENABLED, frame.crc);
    assert!(ask(&["info"]).contains("Bypass (the frame changed after arming)"));
}

#[test]
fn an_image_is_made_on_the_device_from_the_command_line() {
    let folder = tempfile::tempdir().unwrap();
    serve(folder.path());
    let [job, probe] = ["job.toml", "probe.txt"].map(|file| part(0).join(file).display().to_string());
    let (code, said) = device(folder.path(), &["compute", &job, "--probe", &probe, "--activate"]);
    // The device fits machine and material alone: to the last bit what the host makes of them.
    let mut pass = Pass::read(JobFile::read(Path::new(&job)).unwrap()).unwrap();
    pass.job.discrepancy = false;
    let measurement = Measurement::read(&pass, &diagnostics::Source::read(Path::new(&probe)).unwrap()).unwrap();
    let made = correct_pass(&pass, &measurement, &[], &[Route::Coprocessor], &mut |_| ()).unwrap();
    let name = format!("{:08x}", Image::new_checked(&made.image.unwrap()).unwrap().crc());
    assert!(code == 0 && said.contains(&name), "{said}");
    let (_, list) = device(folder.path(), &["list"]);
    assert!(list.contains("ACTIVE") && list.contains(&name), "{list}");
}

#[test]
fn the_frames_before_a_fault_are_downloaded_as_they_were_sent() {
    let mut board = crate::hil_support::host_board();
    let report = crate::hil_support::on(&mut board, 0, &options(Source::Random, 20_000, Faults::default(), 3));
    assert!(report.identical && !report.faults.is_empty(), "{report:?}");
    let frames = recording(&mut board.client(), 3, |_, _| ()).unwrap();
    let sequences: Vec<u32> =
        frames.iter().map(|f| if let Recorded::Setpoint(s) = f { s.sequence } else { panic!("damaged") }).collect();
    // The recorder is full and stands: what it holds are neighbours, but for disturbances of the counting.
    let neighbours = sequences.windows(2).filter(|pair| pair[1].wrapping_sub(pair[0]) == 1).count();
    assert!(sequences.len() > 500 && neighbours > sequences.len() - 5, "{} {neighbours}", sequences.len());
    assert_eq!(recording_table(&frames, 3).lines().count(), sequences.len() + 1);
    // Released it runs again.
    board.client().done(Ask::ReleaseRecording).unwrap();
    assert!(recording(&mut board.client(), 3, |_, _| ()).is_err());
}
