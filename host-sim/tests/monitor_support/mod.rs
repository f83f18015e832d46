//! A device behind two sockets that can fall silent, an image for it, and the program on a terminal of its own.
#![allow(dead_code)]

pub mod cable;

use std::io::{Read, Write};
use std::net::{TcpListener, TcpStream};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, channel};
use std::sync::{Arc, Mutex};
use std::thread;
use std::time::{Duration, Instant};

use portable_pty::{Child, CommandBuilder, ExitStatus, MasterPty, PtySize, native_pty_system};
use truepath_bench::records::{Channel, Records};
use truepath_bench::{Bulk, InProcess, records};
use truepath_core::geometry::Point;
use truepath_core::image::{
    Binding, CorrectionLimits, FeedLaw, FineOffset, ImageNode, ImageSettings, PathWindow, build, image_bytes,
};
use truepath_core::units::{Offset, Position, Real};

/// A device in process behind two TCP sockets. Its clock goes on by 1 ms with every frame.
pub struct Served {
    /// `tcp:HOST:PORT` of the setpoint link.
    pub setpoints: String,
    /// `tcp:HOST:PORT` of the configuration link.
    pub config: String,
    silent: Arc<AtomicBool>,
}

impl Served {
    pub fn start() -> Self {
        let device = Arc::new(Mutex::new(InProcess::start().unwrap()));
        let silent = Arc::new(AtomicBool::new(false));
        let listen = |channel| {
            let listener = TcpListener::bind("127.0.0.1:0").unwrap();
            let name = format!("tcp:{}", listener.local_addr().unwrap());
            let (device, silent) = (Arc::clone(&device), Arc::clone(&silent));
            thread::spawn(move || {
                for stream in listener.incoming() {
                    answer(stream.unwrap(), channel, &device, &silent);
                }
            });
            name
        };
        let [setpoints, config] = [Channel::Setpoint, Channel::Config].map(listen);
        Self { setpoints, config, silent }
    }
    /// Whether the device answers.
    pub fn answers(&self, answers: bool) {
        self.silent.store(!answers, Ordering::SeqCst);
    }
}

fn answer(mut stream: TcpStream, channel: Channel, device: &Mutex<InProcess>, silent: &AtomicBool) {
    stream.set_nodelay(true).unwrap();
    let mut buffer = [0; 1024];
    while let Ok(count @ 1..) = stream.read(&mut buffer) {
        if silent.load(Ordering::SeqCst) {
            continue;
        }
        let mut batch = vec![];
        for piece in buffer[..count].split_inclusive(|&b| b == 0) {
            if channel == Channel::Setpoint {
                records::write(Channel::Time, &1_000u32.to_le_bytes(), &mut batch);
            }
            records::write(channel, piece, &mut batch);
        }
        let back = device.lock().unwrap().run(&batch).unwrap();
        Records::new(&back).for_each(|record| stream.write_all(record.bytes).unwrap_or_default());
    }
}

fn fine(nm: i64) -> FineOffset {
    FineOffset::checked_from_offset(Offset::from_nm(nm)).unwrap()
}

/// An image of 40 mm along X with up to 0.05 mm in Y, in a file.
pub fn image(folder: &Path) -> PathBuf {
    let node = |i: i64| {
        let chip = [FineOffset::ZERO, fine(i.min(400 - i).clamp(0, 100) * 500)];
        ImageNode { point: Point::from_nm(i * 100_000, 5_000_000), chip, edge: [FineOffset::ZERO; 2] }
    };
    let nodes: Vec<ImageNode> = (0..=400).map(node).collect();
    let settings = ImageSettings {
        binding: Binding { program_crc: 0x1234_ABCD, feature: 1, pass: 1, tool: 4, tool_offset: 4, setup: 1 },
        closed: false,
        feed: FeedLaw::new(fine(100_000), 4, 1_500_000, Real::ZERO, Real::ratio(1, 4), Real::from_int(2)),
        limits: CorrectionLimits {
            clamp: Offset::from_um(200),
            warn: Offset::from_um(150),
            slew_nm_per_s: 50_000_000,
            acceleration_nm_per_s2: 5_000_000_000,
        },
        window: PathWindow {
            tolerance: Offset::from_um(500),
            z_low: Position::from_nm(-10_000_000),
            z_high: Position::from_nm(-10_000_000),
            gate_height: Offset::from_um(20_000),
        },
        node_step: Offset::from_um(100),
    };
    let mut bytes = vec![0; image_bytes(nodes.len())];
    build(&settings, &nodes, &mut bytes).unwrap();
    let path = folder.join("correction.tpi");
    std::fs::write(&path, bytes).unwrap();
    path
}

/// The program on a pseudo-terminal.
pub struct OnTerminal {
    master: Box<dyn MasterPty + Send>,
    keys: Box<dyn Write + Send>,
    child: Box<dyn Child + Send + Sync>,
    output: Receiver<Vec<u8>>,
    /// What a terminal makes of its output.
    pub screen: vt100::Parser,
    /// All of it.
    pub raw: Vec<u8>,
    /// How much of it the screen has seen.
    shown: usize,
    modes: String,
}

/// How long something may take to be shown.
const PATIENCE: Duration = Duration::from_secs(20);
/// Bytes of output between two looks at the screen.
const SLICE: usize = 64;

impl OnTerminal {
    pub fn start(arguments: &[&str], rows: u16, cols: u16, environment: &[(&str, &str)]) -> Self {
        let pair = native_pty_system().openpty(PtySize { rows, cols, pixel_width: 0, pixel_height: 0 }).unwrap();
        let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_truepath"));
        command.args(arguments);
        command.env("TERM", "xterm-256color");
        command.env_remove("NO_COLOR");
        environment.iter().for_each(|(name, value)| command.env(name, value));
        let modes = format!("{:?}", pair.master.get_termios().unwrap());
        let child = pair.slave.spawn_command(command).unwrap();
        let mut reader = pair.master.try_clone_reader().unwrap();
        let (sender, output) = channel();
        thread::spawn(move || {
            let mut buffer = [0; 4096];
            while let Ok(count @ 1..) = reader.read(&mut buffer) {
                if sender.send(buffer[..count].to_vec()).is_err() {
                    break;
                }
            }
        });
        // The slave stays open here, so that its modes can be looked at when the program has ended.
        std::mem::forget(pair.slave);
        let keys = pair.master.take_writer().unwrap();
        let screen = vt100::Parser::new(rows, cols, 100);
        Self { master: pair.master, keys, child, output, screen, raw: vec![], shown: 0, modes }
    }
    pub fn press(&mut self, keys: &str) {
        self.keys.write_all(keys.as_bytes()).unwrap();
        self.keys.flush().unwrap();
    }
    pub fn resize(&mut self, rows: u16, cols: u16) {
        self.master.resize(PtySize { rows, cols, pixel_width: 0, pixel_height: 0 }).unwrap();
        self.screen.screen_mut().set_size(rows, cols);
    }
    pub fn id(&self) -> u32 {
        self.child.process_id().unwrap()
    }
    /// Shows a little more of the output; a quick program writes everything at once, and what it shows in between is to
    /// be seen as well.
    fn take(&mut self, within: Duration) -> bool {
        if self.shown == self.raw.len() {
            let Ok(bytes) = self.output.recv_timeout(within) else { return false };
            self.raw.extend(bytes);
        }
        let next = self.raw.len().min(self.shown + SLICE);
        self.screen.process(&self.raw[self.shown..next]);
        self.shown = next;
        true
    }
    /// The text on the screen.
    pub fn text(&self) -> String {
        self.screen.screen().contents()
    }
    /// Waits until the screen shows something.
    #[track_caller]
    pub fn shows(&mut self, wanted: &str) {
        let until = Instant::now() + PATIENCE;
        while !self.text().contains(wanted) {
            assert!(Instant::now() < until, "no \"{wanted}\" on the screen:\n{}", self.text());
            self.take(Duration::from_millis(50));
        }
    }
    /// Waits until the screen does not show something any more.
    #[track_caller]
    pub fn lacks(&mut self, unwanted: &str) {
        let until = Instant::now() + PATIENCE;
        while self.text().contains(unwanted) {
            assert!(Instant::now() < until, "\"{unwanted}\" is still on the screen:\n{}", self.text());
            self.take(Duration::from_millis(50));
        }
    }
    /// Waits for the end; what is on the screen afterwards stays readable.
    #[track_caller]
    pub fn ends(&mut self) -> ExitStatus {
        let until = Instant::now() + PATIENCE;
        loop {
            if let Some(status) = self.child.try_wait().unwrap() {
                while self.take(Duration::from_millis(100)) {}
                return status;
            }
            assert!(Instant::now() < until, "it does not end:\n{}", self.text());
            self.take(Duration::from_millis(20));
        }
    }
    /// The terminal is as it was: modes of the line, the first screen, the cursor.
    #[track_caller]
    pub fn is_as_before(&self) {
        assert_eq!(format!("{:?}", self.master.get_termios().unwrap()), self.modes);
        assert!(!self.screen.screen().alternate_screen(), "the other screen is still shown");
        assert!(!self.screen.screen().hide_cursor(), "the cursor is hidden");
    }
}

impl Drop for OnTerminal {
    fn drop(&mut self) {
        // What a test left running; it may have ended.
        let _ = self.child.kill();
    }
}
