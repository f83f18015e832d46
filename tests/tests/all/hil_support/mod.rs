//! Images of the demonstration, runs on the device in process, and a device behind two sockets.

use std::io::{Read, Write};
use std::os::unix::net::UnixListener;
use std::path::{Path, PathBuf};
use std::sync::{Arc, LazyLock, Mutex};
use std::thread;

use truepath::command::demo;
use truepath::command::hil::{Options, Report, Source, run};
use truepath_bench::records::{Channel, Records};
use truepath_bench::{Board, Bulk, BulkBoard, Faults, InProcess, Probability, records};

/// The parts of the demonstration, made once.
pub static PARTS: LazyLock<(tempfile::TempDir, Vec<PathBuf>)> = LazyLock::new(|| {
    let folder = tempfile::tempdir().unwrap();
    let options = demo::Options { output: folder.path().to_owned(), keep: false, force: true };
    let outcomes = demo::run(&options, &mut |_| ()).unwrap();
    let folders = outcomes.iter().map(|o| o.folder.clone()).collect();
    (folder, folders)
});

/// The folder of a part: 0 corner, 1 corner-helix, 2 pocket.
pub fn part(index: usize) -> &'static Path {
    &PARTS.1[index]
}

/// The image of a part.
pub fn image(index: usize) -> Vec<u8> {
    std::fs::read(part(index).join("correction.tpi")).unwrap()
}

pub fn host_board() -> BulkBoard<InProcess> {
    BulkBoard::new(InProcess::start().unwrap())
}

pub fn probability(share: f64) -> Probability {
    Probability::new(share).unwrap()
}

/// Every kind of fault at once.
pub fn everything() -> Faults {
    Faults {
        drop: probability(0.05),
        corrupt: probability(0.05),
        reorder: probability(0.05),
        repeat: probability(0.05),
        pause: probability(0.001),
        pause_us: 30_000,
        jitter_us: 500,
    }
}

pub fn options(source: Source, count: u64, faults: Faults, seed: u64) -> Options {
    Options { source, count, axes: 3, rate_hz: 1_000, faults, seed }
}

/// A run of a part on the device in process.
pub fn on_host(part: usize, options: &Options) -> Report {
    on(&mut host_board(), part, options)
}

pub fn on(board: &mut dyn Board, part: usize, options: &Options) -> Report {
    run(board, &image(part), options, &mut |_| ()).unwrap()
}

/// A device in process behind two Unix sockets in a folder: `setpoint.sock`, `config.sock`. Its clock goes on by 1 ms with
/// every frame.
pub fn serve(folder: &Path) {
    serve_device(folder, InProcess::start().unwrap());
}

/// The same of this device.
pub fn serve_device(folder: &Path, device: InProcess) {
    let device = Arc::new(Mutex::new(device));
    for (name, channel) in [("setpoint.sock", Channel::Setpoint), ("config.sock", Channel::Config)] {
        let listener = UnixListener::bind(folder.join(name)).unwrap();
        let device = Arc::clone(&device);
        thread::spawn(move || {
            for stream in listener.incoming() {
                let mut stream = stream.unwrap();
                let mut buffer = [0; 1024];
                while let Ok(count @ 1..) = stream.read(&mut buffer) {
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
        });
    }
}
