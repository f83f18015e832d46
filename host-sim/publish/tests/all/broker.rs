//! A real broker: near, away, gone and back.

use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::{Duration, Instant};

use serde_json::{Value, json};
use truepath_ground::diagnostics::Failure;
use truepath_publish::machine::Machine;
use truepath_publish::mqtt::address::{Address, Login};
use truepath_publish::mqtt::{self, trust};
use truepath_publish::publisher::{Publisher, Said, Settings};

use crate::support::batches::{summary, write};
use crate::support::mosquitto::{Mosquitto, SOON, allow, installed, missing};

fn settings(url: &str, folder: &Path, follow: bool) -> Settings {
    Settings {
        folders: vec![folder.to_owned()],
        machine: Machine::of("vf2").expect("a name"),
        mqtt: Some(mqtt::Settings { address: Address::of(url).expect("an address"), login: None, trust: None }),
        mtconnect: None,
        follow,
    }
}

fn shown<T>(result: Result<T, Failure>) -> T {
    result.unwrap_or_else(|failure| panic!("{failure}"))
}

/// A folder below a temporary one, named as the batch is.
fn corner(errors: &[f64]) -> (tempfile::TempDir, PathBuf) {
    let place = tempfile::tempdir().expect("a folder");
    let folder = place.path().join("corner");
    write(&folder, &summary(errors, 0.01));
    (place, folder)
}

fn is(key: &'static str, wanted: Value) -> impl Fn(&Value) -> bool {
    move |payload| payload[key] == wanted
}

/// Looks until something of that kind is said.
fn until_said(publisher: &mut Publisher, wanted: &str) {
    let begin = Instant::now();
    let mut all = Vec::new();
    while !all.iter().any(|said: &String| said.contains(wanted)) {
        assert!(begin.elapsed() < SOON, "no {wanted}: {all:?}");
        std::thread::sleep(Duration::from_millis(10));
        all.extend(publisher.said().into_iter().map(|(Said::Note(text) | Said::Warning(text))| text));
    }
}

#[test]
fn state_part_and_alarm_arrive_and_the_broker_keeps_state_and_alarms() {
    let Some(broker) = Mosquitto::running() else { return };
    let (_place, folder) = corner(&[0.0, 0.001]);
    let listener = broker.listen();
    let mut publisher = shown(Publisher::start(&settings(&broker.url(), &folder, true)));
    let state = listener.until("state", is("last_part", json!(2))).payload;
    assert_eq!(
        (&state["status"], &state["in_control"], &state["batch"]),
        (&json!("online"), &json!(true), &json!("corner"))
    );
    write(&folder, &summary(&[0.0, 0.001, 0.02], 0.01));
    assert!(shown(publisher.look()).is_empty());
    let alarm = listener.until("alarm", |alarm| alarm["raised"][0]["kind"] == "out_of_tolerance");
    assert!(!alarm.kept);
    let part = listener.next("part").payload;
    // What was there before is not told again.
    assert_eq!((&part["part"], &part["in_tolerance"]), (&json!(3), &json!(false)));
    assert_eq!(listener.until("state", is("last_part", json!(3))).payload["in_control"], json!(false));
    // Who comes later hears what is so, of parts nothing.
    let late = broker.listen();
    let kept = late.within(Duration::from_millis(300));
    let topics: Vec<&str> = kept.iter().map(|heard| heard.topic.as_str()).collect();
    assert!(kept.iter().all(|heard| heard.kept) && topics.len() == 2 && !topics.contains(&"part"), "{kept:#?}");
    // Damage is told once and changes nothing.
    std::fs::write(folder.join("summary.json"), "{").expect("written");
    assert_eq!(shown(publisher.look()).len(), 1);
    assert!(shown(publisher.look()).is_empty());
    write(&folder, &summary(&[0.0, 0.001, 0.002], 0.01));
    assert!(shown(publisher.look()).is_empty());
    let cleared = late.next("alarm").payload;
    assert_eq!((&cleared["raised"], &cleared["cleared"][0]["key"]), (&json!([]), &json!("corner/out_of_tolerance")));
    let counts = publisher.end(SOON);
    assert_eq!(late.until("state", is("status", json!("offline"))).payload["machine"], "vf2");
    assert!(counts.parts == 2 && counts.dropped == 0, "{counts:?}");
}

#[test]
fn a_broker_that_is_away_is_waited_for_and_one_that_comes_back_hears_all() {
    let Some(mut broker) = Mosquitto::away() else { return };
    let (_place, folder) = corner(&[0.0]);
    let begin = Instant::now();
    let mut publisher = shown(Publisher::start(&settings(&broker.url(), &folder, true)));
    until_said(&mut publisher, "no connection to the broker");
    write(&folder, &summary(&[0.0, 0.001], 0.01));
    shown(publisher.look());
    assert!(begin.elapsed() < Duration::from_secs(2), "nobody waits for a broker");
    broker.start("allow_anonymous true");
    let listener = broker.listen();
    assert_eq!(listener.next("part").payload["part"], 2);
    listener.until("state", is("last_part", json!(2)));
    until_said(&mut publisher, "connected");
    broker.stop();
    until_said(&mut publisher, "no connection to the broker");
    write(&folder, &summary(&[0.0, 0.001, 0.002, 0.001], 0.01));
    shown(publisher.look());
    broker.start("allow_anonymous true");
    // It keeps nothing over its end, and has the state again all the same.
    let listener = broker.listen();
    assert_eq!([3, 4].map(|_| listener.next("part").payload["part"].clone()), [json!(3), json!(4)]);
    listener.until("state", is("last_part", json!(4)));
    // The end does not wait for one that is away.
    broker.stop();
    until_said(&mut publisher, "no connection to the broker");
    let begin = Instant::now();
    publisher.end(SOON);
    assert!(begin.elapsed() < Duration::from_secs(1));
}

#[test]
fn everything_is_sent_once_and_acknowledged_or_an_error() {
    let Some(mut broker) = Mosquitto::running() else { return };
    let errors: Vec<f64> = (0..1200).map(|k| 0.001 * f64::from(k % 2)).collect();
    let (_place, folder) = corner(&errors);
    let listener = broker.listen();
    let once = settings(&broker.url(), &folder, false);
    // More than wait for a broker that is away.
    let begin = Instant::now();
    let counts = shown(Publisher::start(&once)).deliver(SOON).expect("acknowledged");
    println!("{counts:?} in {:?}", begin.elapsed());
    assert_eq!((counts.states, counts.parts, counts.alarms, counts.dropped), (1, 1200, 1, 0));
    listener.until("part", is("part", json!(1200)));
    listener.until("state", is("status", json!("once")));
    broker.stop();
    let begin = Instant::now();
    let failed = shown(Publisher::start(&once)).deliver(Duration::from_millis(700)).expect_err("no broker");
    assert!(failed.code() == "Q016" && failed.found().contains("refused"), "{failed}");
    assert!(begin.elapsed() < Duration::from_secs(3));
    std::fs::write(folder.join("summary.json"), "half").expect("written");
    let refused = Publisher::start(&once).expect_err("damaged");
    assert!(matches!(&refused, Failure::Input(error) if error.code() == "Q013"), "{refused}");
}

#[test]
fn a_password_over_tls_is_believed_only_with_the_right_authority() {
    let Some(mut broker) = Mosquitto::away() else { return };
    let (Some(openssl), Some(passwords)) = (installed("openssl"), installed("mosquitto_passwd")) else {
        return missing("openssl or mosquitto_passwd");
    };
    let place = broker.folder.path().to_owned();
    let at = |name: &str| place.join(name).display().to_string();
    let certificate = |name: &str, more: &[&str]| {
        let made = Command::new(&openssl)
            .args(["req", "-x509", "-newkey", "ec", "-pkeyopt", "ec_paramgen_curve:prime256v1", "-nodes", "-days", "2"])
            .args(["-keyout", &at(&format!("{name}.key")), "-out", &at(&format!("{name}.pem"))])
            .args(more)
            .output()
            .expect("openssl");
        assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
        [".key", ".pem"].iter().for_each(|end| allow(&place.join(format!("{name}{end}"))));
    };
    let (own, key) = (at("own.pem"), at("own.key"));
    certificate("own", &["-subj", "/CN=an authority"]);
    certificate("other", &["-subj", "/CN=an authority"]);
    let of_the_broker = ["-subj", "/CN=localhost", "-addext", "basicConstraints=critical,CA:FALSE"];
    let signed = ["-addext", "subjectAltName=DNS:localhost", "-CA", &own, "-CAkey", &key];
    certificate("broker", &[&of_the_broker[..], &signed].concat());
    let made = Command::new(passwords).args(["-b", "-c", &at("users"), "ann", "geheim"]).status();
    assert!(made.is_ok_and(|ended| ended.success()));
    allow(&place.join("users"));
    let (certificate, key, users) = (at("broker.pem"), at("broker.key"), at("users"));
    broker.start(&format!("certfile {certificate}\nkeyfile {key}\nallow_anonymous false\npassword_file {users}"));
    let (_place, folder) = corner(&[0.0]);
    let url = format!("mqtts://localhost:{}", broker.port);
    let send = |authority: &str, password: &str| {
        let mut settings = settings(&url, &folder, false);
        let mqtt = settings.mqtt.as_mut().expect("a broker");
        mqtt.trust = Some(trust(Some(Path::new(&at(authority)))).expect("an authority"));
        mqtt.login = Some(Login { user: "ann".to_owned(), password: password.to_owned() });
        shown(Publisher::start(&settings)).deliver(Duration::from_secs(1)).map_err(|error| error.found().to_owned())
    };
    assert_eq!(send("own.pem", "geheim").map(|counts| counts.states), Ok(1));
    let refused = send("own.pem", "wrong").expect_err("a wrong password");
    assert!(refused.contains("refuses the connection"), "{refused}");
    let unknown = send("other.pem", "geheim").expect_err("another authority");
    assert!(unknown.contains("ertificate"), "{unknown}");
    assert!(trust(Some(Path::new(&at("own.key")))).is_err_and(|error| error.code() == "Q018"));
}
