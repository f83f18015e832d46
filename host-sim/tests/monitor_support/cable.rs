//! A serial cable between the program and a served device, which can be pulled out and plugged in again.

use std::io::{Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread;
use std::time::Duration;

use portable_pty::{PtyPair, PtySize, native_pty_system};

/// How long a thread waits for bytes before it looks whether the cable is still there.
const LOOK: Duration = Duration::from_millis(20);

/// The cable: a pseudo-terminal under a name that stays the same.
pub struct Cable {
    device: String,
    folder: tempfile::TempDir,
    plugged: Option<(PtyPair, Arc<AtomicBool>)>,
}

impl Cable {
    /// Plugged in, to a device at `tcp:HOST:PORT`.
    pub fn to(device: &str) -> Self {
        let device = device.strip_prefix("tcp:").unwrap().to_owned();
        let mut cable = Self { device, folder: tempfile::tempdir().unwrap(), plugged: None };
        cable.plug();
        cable
    }
    /// The name of the port.
    pub fn port(&self) -> PathBuf {
        self.folder.path().join("ttyACM0")
    }
    /// Plugs it in.
    pub fn plug(&mut self) {
        let pair = native_pty_system().openpty(PtySize::default()).unwrap();
        let pulled = Arc::new(AtomicBool::new(false));
        let mut to_device = TcpStream::connect(&self.device).unwrap();
        let mut from_device = to_device.try_clone().unwrap();
        from_device.set_read_timeout(Some(LOOK)).unwrap();
        let (mut reader, mut writer) = (pair.master.try_clone_reader().unwrap(), pair.master.take_writer().unwrap());
        let gone = Arc::clone(&pulled);
        // Its last bytes are those of a question without an answer.
        thread::spawn(move || {
            let mut buffer = [0; 1024];
            while let Ok(count @ 1..) = reader.read(&mut buffer) {
                if gone.load(Ordering::SeqCst) || to_device.write_all(&buffer[..count]).is_err() {
                    break;
                }
            }
        });
        let gone = Arc::clone(&pulled);
        thread::spawn(move || {
            let mut buffer = [0; 1024];
            while !gone.load(Ordering::SeqCst) {
                match from_device.read(&mut buffer) {
                    Ok(0) => break,
                    Ok(count) => writer.write_all(&buffer[..count]).unwrap_or_default(),
                    Err(_) => {}
                }
            }
            let _ = from_device.shutdown(std::net::Shutdown::Both);
        });
        std::os::unix::fs::symlink(pair.master.tty_name().unwrap(), self.port()).unwrap();
        self.plugged = Some((pair, pulled));
    }
    /// Pulls it out: the port is gone, and who had it open is told so.
    pub fn pull(&mut self) {
        if let Some((pair, pulled)) = self.plugged.take() {
            std::fs::remove_file(self.port()).unwrap();
            pulled.store(true, Ordering::SeqCst);
            drop(pair);
        }
    }
}
