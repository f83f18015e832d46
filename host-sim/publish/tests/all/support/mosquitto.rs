//! A broker, started for the test in a folder of its own.
//!
//! Without one installed the tests say so and pass; `TRUEPATH_MOSQUITTO=required` makes that a failure.

use std::fs;
use std::io::Write;
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::mpsc::{Receiver, channel};
use std::time::{Duration, Instant};

use rumqttc::{Client, Event, MqttOptions, Packet, QoS};
use serde_json::Value;

/// Who runs it where root must not.
const NOBODY: &str = "65534";
/// How long something is waited for.
pub const SOON: Duration = Duration::from_secs(10);

/// A place for a broker; it ends with this.
pub struct Mosquitto {
    program: PathBuf,
    pub folder: tempfile::TempDir,
    pub port: u16,
    running: Option<Child>,
}

impl Mosquitto {
    /// One that does not run yet; `None`, said, where none is installed.
    pub fn away() -> Option<Self> {
        let Some(program) = installed("mosquitto") else {
            missing("Mosquitto");
            return None;
        };
        let folder = tempfile::Builder::new().prefix("mqtt").tempdir_in("/tmp").expect("a folder");
        allow(folder.path());
        Some(Self { program, folder, port: free_port(), running: None })
    }

    /// One that everybody may use.
    pub fn running() -> Option<Self> {
        let mut broker = Self::away()?;
        broker.start("allow_anonymous true");
        Some(broker)
    }

    /// Starts it.
    pub fn start(&mut self, settings: &str) {
        let file = self.folder.path().join("conf");
        let text = format!("listener {} 127.0.0.1\npersistence false\n{settings}\n", self.port);
        fs::write(&file, text).expect("written");
        allow(&file);
        let mut command = match is_root() {
            true => {
                let mut command = Command::new("setpriv");
                command.args([&format!("--reuid={NOBODY}"), &format!("--regid={NOBODY}"), "--clear-groups"]);
                command.arg(&self.program);
                command
            }
            false => Command::new(&self.program),
        };
        command.arg("-c").arg(&file).stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null());
        self.running = Some(command.spawn().expect("it runs"));
        let begin = Instant::now();
        while TcpStream::connect(("127.0.0.1", self.port)).is_err() {
            assert!(begin.elapsed() < SOON, "the broker does not start");
            std::thread::sleep(Duration::from_millis(10));
        }
    }

    /// Ends it.
    pub fn stop(&mut self) {
        if let Some(mut child) = self.running.take() {
            child.kill().and_then(|()| child.wait()).expect("it ends");
        }
    }

    /// Its address.
    pub fn url(&self) -> String {
        format!("mqtt://127.0.0.1:{}", self.port)
    }

    /// Somebody who hears everything.
    pub fn listen(&self) -> Listener {
        Listener::new(self.port)
    }
}

impl Drop for Mosquitto {
    fn drop(&mut self) {
        self.stop();
    }
}

/// A program in `PATH` or where Debian keeps those of the system.
pub fn installed(name: &str) -> Option<PathBuf> {
    let path = std::env::var_os("PATH").unwrap_or_default();
    let places = std::env::split_paths(&path).chain(["/usr/sbin".into(), "/usr/local/sbin".into()]);
    places.map(|place| place.join(name)).find(|file| file.is_file())
}

/// Says that something is not installed.
pub fn missing(what: &str) {
    let required = std::env::var("TRUEPATH_MOSQUITTO").is_ok_and(|value| value == "required");
    assert!(!required, "TRUEPATH_MOSQUITTO=required, and {what} is not installed");
    // Past the capture of the test's output, so that it is seen.
    let _ = writeln!(std::io::stderr(), "note: {what} is not installed: nothing of it was tested");
}

/// Lets everybody read a file or folder.
pub fn allow(path: &Path) {
    use std::os::unix::fs::PermissionsExt;
    fs::set_permissions(path, fs::Permissions::from_mode(0o755)).expect("rights");
}

fn is_root() -> bool {
    let id = Command::new("id").arg("-u").output();
    id.is_ok_and(|said| said.stdout.trim_ascii() == b"0")
}

/// A port that is free now.
pub fn free_port() -> u16 {
    TcpListener::bind("127.0.0.1:0").and_then(|free| free.local_addr()).expect("a port").port()
}

/// What was heard.
#[derive(Clone, Debug)]
pub struct Heard {
    /// The last level of the topic.
    pub topic: String,
    pub payload: Value,
    /// Whether the broker had kept it.
    pub kept: bool,
}

/// Somebody who subscribes to all of Truepath.
pub struct Listener {
    heard: Receiver<Heard>,
    client: Client,
}

impl Listener {
    fn new(port: u16) -> Self {
        // A broker ends the older of two connections with one identifier.
        let options = MqttOptions::new(format!("listener-{}", free_port()), "127.0.0.1", port);
        let (client, mut connection) = Client::new(options, 8);
        client.subscribe("truepath/#", QoS::AtLeastOnce).expect("subscribed");
        let (to, heard) = channel();
        let (ready, subscribed) = channel();
        std::thread::spawn(move || {
            for event in connection.iter().map_while(Result::ok) {
                match event {
                    Event::Incoming(Packet::SubAck(_)) => drop(ready.send(())),
                    Event::Incoming(Packet::Publish(publish)) => {
                        let topic = publish.topic.rsplit('/').next().unwrap_or_default().to_owned();
                        let payload = serde_json::from_slice(&publish.payload).expect("JSON");
                        if to.send(Heard { topic, payload, kept: publish.retain }).is_err() {
                            return;
                        }
                    }
                    _ => (),
                }
            }
        });
        subscribed.recv_timeout(SOON).expect("the broker takes a subscription");
        Self { heard, client }
    }

    /// The next message of a topic.
    pub fn next(&self, topic: &str) -> Heard {
        self.until(topic, |_| true)
    }

    /// The next message of a topic of which something holds; others are passed over.
    pub fn until(&self, topic: &str, holds: impl Fn(&Value) -> bool) -> Heard {
        let begin = Instant::now();
        let mut others = Vec::new();
        loop {
            let left = SOON.saturating_sub(begin.elapsed());
            let heard = self.heard.recv_timeout(left).unwrap_or_else(|_| panic!("no such {topic}: {others:#?}"));
            if heard.topic == topic && holds(&heard.payload) {
                return heard;
            }
            others.push(heard);
        }
    }

    /// All that comes within a while.
    pub fn within(&self, while_: Duration) -> Vec<Heard> {
        std::thread::sleep(while_);
        self.heard.try_iter().collect()
    }
}

impl Drop for Listener {
    fn drop(&mut self) {
        let _ = self.client.disconnect();
    }
}
