//! `publish`: state, parts and alarms of followed batches for the systems of a shop.
//!
//! It is a command of its own and runs beside all others, so that none of them ever waits for a network.

use std::path::PathBuf;
use std::time::{Duration, Instant};

use clap::Args;
use serde::Serialize;
use truepath_ground::codes::C001;
use truepath_ground::diagnostics::{Failure, InputError};
use truepath_ground::interruption::{self, Watch};
use truepath_publish::machine::Machine;
use truepath_publish::mqtt::address::Address;
use truepath_publish::mqtt::outbox::Counts;
use truepath_publish::mqtt::{self, trust};
use truepath_publish::mtconnect;
use truepath_publish::publisher::{Publisher, Said, Settings};

use crate::terminal::Terminal;

/// How long a broker that acknowledges nothing is waited for with --once.
const DELIVERY: Duration = Duration::from_secs(10);
/// How long the end may take to say that nobody follows any more.
const FAREWELL: Duration = Duration::from_secs(2);
/// How often signals and connections are looked at.
const TICK: Duration = Duration::from_millis(50);

/// What is published, as which machine, to whom.
#[derive(Clone, Debug, Args)]
pub struct Options {
    /// Folders that truepath batch writes; one that is not there yet is waited for.
    #[arg(required = true, value_name = "FOLDER")]
    folders: Vec<PathBuf>,
    /// The machine on which they are cut, as topics name it.
    #[arg(long, value_name = "NAME")]
    machine: String,
    /// A broker, mqtt://HOST:PORT or mqtts://HOST:PORT; user and password come from TRUEPATH_MQTT_USER and TRUEPATH_MQTT_PASSWORD.
    #[arg(long, value_name = "URL")]
    mqtt: Option<String>,
    /// Believe certificates of the authorities in this file (PEM) instead of those that this computer believes.
    #[arg(long, value_name = "FILE", requires = "mqtt")]
    ca: Option<PathBuf>,
    /// Wait for agents of MTConnect on this address; a port alone is one of 127.0.0.1.
    #[arg(long, value_name = "HOST:PORT")]
    mtconnect: Option<String>,
    /// How often the folders are looked at.
    #[arg(long, value_name = "SECONDS", default_value_t = 2.0, value_parser = seconds)]
    every: f64,
    /// Send everything once, wait until the broker has acknowledged it, and end.
    #[arg(long, requires = "mqtt", conflicts_with = "mtconnect")]
    once: bool,
}

/// What became of it.
#[derive(Clone, Debug, Serialize)]
struct Published {
    machine: String,
    acknowledged: Counts,
}

fn seconds(text: &str) -> Result<f64, String> {
    let value = text.parse::<f64>().ok().filter(|value| (0.1..=3600.0).contains(value));
    value.ok_or_else(|| "a number from 0.1 to 3600".to_owned())
}

/// Publishes until a signal comes, or once.
pub(crate) fn main(options: &Options, terminal: &Terminal) -> Result<(), Failure> {
    let settings = settings(options, terminal)?;
    if options.once {
        let acknowledged = Publisher::start(&settings)?.deliver(DELIVERY)?;
        return tell(&settings, acknowledged, terminal);
    }
    // Before anything is connected, so that nothing stays connected unsaid.
    let watch = Watch::begin().map_err(|e| Failure::Internal(format!("signals cannot be waited for: {e}")))?;
    let mut publisher = Publisher::start(&settings)?;
    if let Some(address) = publisher.adapter_address() {
        terminal.note(&format!("agents of MTConnect find it at {address}"));
    }
    let every = Duration::from_secs_f64(options.every);
    let mut looked: Option<Instant> = None;
    let signal = loop {
        if let Some(signal) = watch.came() {
            break signal;
        }
        if looked.is_none_or(|looked| looked.elapsed() >= every) {
            looked = Some(Instant::now());
            for error in publisher.look()? {
                terminal.warn(&format!("{error}; it is looked at again"));
            }
        }
        for said in publisher.said() {
            match said {
                Said::Warning(text) => terminal.warn(&text),
                Said::Note(text) => terminal.note(&text),
            }
        }
        std::thread::sleep(TICK);
    };
    let acknowledged = publisher.end(FAREWELL);
    let told = tell(&settings, acknowledged, terminal);
    drop(watch);
    interruption::end_by(signal);
    told
}

/// What the command line and the environment say.
fn settings(options: &Options, terminal: &Terminal) -> Result<Settings, Failure> {
    let machine = Machine::of(&options.machine)?;
    if options.mqtt.is_none() && options.mtconnect.is_none() {
        return Err(C001.error("nobody to publish to", "--mqtt URL, --mtconnect HOST:PORT, or both").into());
    }
    let mqtt = options.mqtt.as_deref().map(|address| broker(address, options, terminal)).transpose()?;
    let mtconnect = options.mtconnect.as_deref().map(mtconnect::address);
    if let Some(address) = mtconnect.as_deref().filter(|address| mtconnect::is_exposed(address)) {
        terminal.warn(&format!("whoever reaches {address} can read along: MTConnect has no passwords"));
    }
    Ok(Settings { folders: options.folders.clone(), machine, mqtt, mtconnect, follow: !options.once })
}

fn broker(address: &str, options: &Options, terminal: &Terminal) -> Result<mqtt::Settings, InputError> {
    let address = Address::of(address)?;
    let login = address.login(|name| std::env::var(name).ok())?;
    if address.is_exposed() {
        let password = if login.is_some() { ", and the password" } else { "" };
        terminal
            .warn(&format!("whoever listens on the way to {address} can read along{password}: mqtts:// is encrypted"));
    }
    if options.ca.is_some() && !address.tls {
        return Err(C001.error("--ca with a broker that has no certificate", "mqtts://"));
    }
    let trust = address.tls.then(|| trust(options.ca.as_deref())).transpose()?;
    Ok(mqtt::Settings { address, login, trust })
}

fn tell(settings: &Settings, acknowledged: Counts, terminal: &Terminal) -> Result<(), Failure> {
    let published = Published { machine: settings.machine.name().to_owned(), acknowledged };
    terminal.tell(&published, || {
        let Counts { states, parts, alarms, dropped } = acknowledged;
        let lost = if dropped > 0 { format!("; {dropped} parts were dropped") } else { String::new() };
        format!("{}: {states} states, {parts} parts, {alarms} sets of alarms acknowledged{lost}\n", published.machine)
    })
}
