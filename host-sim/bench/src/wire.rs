//! A byte stream to a link of the device: serial port, Unix socket, TCP.
//!
//! A thread of its own reads and stamps what arrives, so that a round trip is measured to the arrival and not to the
//! moment at which somebody looks. The thread ends when the stream does.

use std::io::{self, Read, Write};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, channel};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Bytes that arrived.
#[derive(Clone, Debug)]
pub struct Arrival {
    /// When.
    pub at: Instant,
    /// What.
    pub bytes: Vec<u8>,
}

/// A byte stream in both directions.
pub trait Wire {
    /// Sends bytes.
    ///
    /// # Errors
    /// The stream has ended.
    fn send(&mut self, bytes: &[u8]) -> io::Result<()>;
    /// What arrives next within a time; `None` when nothing does.
    ///
    /// # Errors
    /// The stream has ended.
    fn receive(&mut self, within: Duration) -> io::Result<Option<Arrival>>;
}

impl<W: Wire + ?Sized> Wire for &mut W {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        (**self).send(bytes)
    }
    fn receive(&mut self, within: Duration) -> io::Result<Option<Arrival>> {
        (**self).receive(within)
    }
}

impl<W: Wire + ?Sized> Wire for Box<W> {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        (**self).send(bytes)
    }
    fn receive(&mut self, within: Duration) -> io::Result<Option<Arrival>> {
        (**self).receive(within)
    }
}

/// How long a read waits before it looks whether the line was closed.
const LOOK: Duration = Duration::from_millis(50);

/// A stream of the operating system.
pub struct Line {
    writer: Box<dyn Write + Send>,
    arrivals: Receiver<io::Result<Arrival>>,
    closed: Arc<AtomicBool>,
    reader: Option<JoinHandle<()>>,
}

impl Line {
    /// What a name stands for: `tcp:HOST:PORT`, the path of a Unix socket, or a serial port.
    ///
    /// # Errors
    /// It cannot be opened.
    pub fn open(name: &str, baud: u32) -> io::Result<Self> {
        if let Some(address) = name.strip_prefix("tcp:") {
            return Self::tcp(address);
        }
        #[cfg(unix)]
        {
            use std::os::unix::fs::FileTypeExt;
            if std::fs::metadata(name).is_ok_and(|m| m.file_type().is_socket()) {
                return Self::socket(Path::new(name));
            }
        }
        Self::serial(name, baud)
    }

    /// A Unix socket.
    ///
    /// # Errors
    /// Nobody listens there.
    #[cfg(unix)]
    pub fn socket(path: &Path) -> io::Result<Self> {
        let stream = std::os::unix::net::UnixStream::connect(path)?;
        stream.set_read_timeout(Some(LOOK))?;
        let reader = stream.try_clone()?;
        Ok(Self::over(reader, stream))
    }

    /// A TCP connection, sent without delay.
    ///
    /// # Errors
    /// Nobody listens there.
    pub fn tcp(address: &str) -> io::Result<Self> {
        let stream = std::net::TcpStream::connect(address)?;
        stream.set_nodelay(true)?;
        stream.set_read_timeout(Some(LOOK))?;
        let reader = stream.try_clone()?;
        Ok(Self::over(reader, stream))
    }

    /// A serial port, 8N1.
    ///
    /// # Errors
    /// There is no such port, or it is in use.
    pub fn serial(path: &str, baud: u32) -> io::Result<Self> {
        let port = serialport::new(path, baud).timeout(LOOK).open()?;
        let reader = port.try_clone()?;
        Ok(Self::over(reader, port))
    }

    fn over(mut reader: impl Read + Send + 'static, writer: impl Write + Send + 'static) -> Self {
        let (sender, arrivals) = channel();
        let closed = Arc::new(AtomicBool::new(false));
        let seen = Arc::clone(&closed);
        let reader = std::thread::spawn(move || {
            let mut buffer = [0; 4096];
            while !seen.load(Ordering::Relaxed) {
                let arrival = match reader.read(&mut buffer) {
                    Ok(0) => Err(io::ErrorKind::UnexpectedEof.into()),
                    Ok(count) => Ok(Arrival { at: Instant::now(), bytes: buffer[..count].to_vec() }),
                    Err(error) if is_patience(error.kind()) => continue,
                    Err(error) => Err(error),
                };
                let ended = arrival.is_err();
                if sender.send(arrival).is_err() || ended {
                    break;
                }
            }
        });
        Self { writer: Box::new(writer), arrivals, closed, reader: Some(reader) }
    }
}

/// Whether a read just found nothing yet.
fn is_patience(kind: io::ErrorKind) -> bool {
    matches!(kind, io::ErrorKind::TimedOut | io::ErrorKind::WouldBlock | io::ErrorKind::Interrupted)
}

impl Wire for Line {
    fn send(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.writer.write_all(bytes)?;
        self.writer.flush()
    }
    fn receive(&mut self, within: Duration) -> io::Result<Option<Arrival>> {
        match self.arrivals.recv_timeout(within) {
            Ok(arrival) => arrival.map(Some),
            Err(RecvTimeoutError::Timeout) => Ok(None),
            Err(RecvTimeoutError::Disconnected) => Err(io::ErrorKind::UnexpectedEof.into()),
        }
    }
}

impl Drop for Line {
    fn drop(&mut self) {
        self.closed.store(true, Ordering::Relaxed);
        if let Some(reader) = self.reader.take() {
            // It ends within LOOK; a panic there has nothing to say here.
            let _ = reader.join();
        }
    }
}
