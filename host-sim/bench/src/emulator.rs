//! The virtual board: QEMU with the firmware, links over sockets, batches over shared memory.
//!
//! The command line is the one of `docs/firmware.md`. Files and sockets lie in a temporary folder that goes with the
//! emulator. Shared memory is reached through the file itself, which is the same pages as the emulator's mapping.

use std::fs::{self, File};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};
use std::sync::Arc;
use std::time::{Duration, Instant};

use tempfile::TempDir;

use super::bulk::Bulk;
use super::error::BenchError;
use super::wire::Line;
use truepath_ground::interruption::{Kind, Temporary, hold};

/// Where `cargo xtask firmware` puts the firmware, from the root of the repository.
pub const ELF: &str = "target/firmware/truepath-virtual";
/// Where it puts the loader.
pub const LOADER: &str = "target/firmware/updatable/truepath-virtual-loader";
/// Where the loader looks for a program at power-up.
const FACTORY: u32 = 0x2_0000;
const QEMU: &str = "qemu-system-arm";
const PSRAM_BYTES: u64 = 16 << 20;
const MAGIC: u32 = 0x4b42_5054;
const VERSION: u32 = 1;
const REQUEST: u64 = 0x08;
const DONE: u64 = 0x0c;
const INPUT_BYTES: u64 = 0x10;
const OUTPUT_BYTES: u64 = 0x14;
/// 1 there: somebody holds the button, at every reset.
const BUTTON: u64 = 0x18;
const INPUT: u64 = 0x1000;
const OUTPUT: u64 = 0x40_0000;
/// How long the firmware may take to come up, and a batch to be done; machines under load are slow.
const PATIENCE: Duration = Duration::from_secs(120);

/// A running emulator. It ends when this is dropped.
#[derive(Debug)]
pub struct Emulator {
    process: Child,
    folder: TempDir,
    _temporary: Arc<Temporary>,
    shared: File,
    request: u32,
}

/// The firmware in `elf`, or where `cargo xtask firmware` puts it, looked for from the present folder upwards.
///
/// # Errors
/// There is none.
pub fn find_elf(elf: Option<&Path>) -> Result<PathBuf, BenchError> {
    find(elf, ELF)
}

/// The same of the loader.
///
/// # Errors
/// As [`find_elf`].
pub fn find_loader(elf: Option<&Path>) -> Result<PathBuf, BenchError> {
    find(elf, LOADER)
}

fn find(elf: Option<&Path>, usual: &str) -> Result<PathBuf, BenchError> {
    let missing = |what: &Path| BenchError::Missing {
        what: format!("the firmware of the virtual board ({})", what.display()),
        remedy: "run cargo xtask firmware in the repository, or name the file with --elf".to_owned(),
    };
    match elf {
        Some(path) if path.is_file() => Ok(path.to_owned()),
        Some(path) => Err(missing(path)),
        None => {
            let here = std::env::current_dir().unwrap_or_default();
            let found = here.ancestors().map(|folder| folder.join(usual)).find(|path| path.is_file());
            found.ok_or_else(|| missing(Path::new(usual)))
        }
    }
}

impl Emulator {
    /// Starts the emulator and waits until the firmware is up.
    ///
    /// # Errors
    /// QEMU is missing, or the firmware does not come up.
    pub fn start(elf: &Path) -> Result<Self, BenchError> {
        Self::made(elf, None, false)
    }

    /// The same with its button held.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn attended(elf: &Path) -> Result<Self, BenchError> {
        Self::made(elf, None, true)
    }

    /// The loader with a program beside it, as it lies in the flash; the button is held.
    ///
    /// # Errors
    /// As [`Self::start`].
    pub fn loaded(loader: &Path, program: &Path) -> Result<Self, BenchError> {
        Self::made(loader, Some(program), true)
    }

    fn made(elf: &Path, program: Option<&Path>, held: bool) -> Result<Self, BenchError> {
        let opened = |e: io::Error| BenchError::open("the folder of the emulator", &e);
        let (folder, temporary) = {
            let mut hold = hold();
            let folder = tempfile::Builder::new().prefix("truepath-").tempdir().map_err(opened)?;
            let temporary = hold.removes(folder.path(), Kind::Folder);
            (folder, temporary)
        };
        let path = folder.path().join("psram");
        let mut shared = File::options().read(true).write(true).create_new(true).open(&path).map_err(opened)?;
        shared.set_len(PSRAM_BYTES).map_err(opened)?;
        shared.seek(SeekFrom::Start(BUTTON)).map_err(opened)?;
        shared.write_all(&u32::from(held).to_le_bytes()).map_err(opened)?;
        let said = File::create(folder.path().join("said")).map_err(opened)?;
        let mut command = Command::new(QEMU);
        command.current_dir(folder.path()).stdin(Stdio::null()).stdout(Stdio::null()).stderr(said);
        command.args(["-M", "mps2-an500,memory-backend=psram", "-object"]);
        command.arg("memory-backend-file,id=psram,size=16M,mem-path=psram,share=on");
        command.args(["-display", "none", "-monitor", "none"]);
        for link in ["setpoint", "config"] {
            command.args(["-chardev", &format!("socket,id={link},path={link}.sock,server=on,wait=off")]);
            command.args(["-serial", &format!("chardev:{link}")]);
        }
        command.args(["-serial", "null", "-serial", "file:log.defmt", "-kernel"]);
        let whole = |path: &Path| fs::canonicalize(path).map_err(|e| BenchError::open(path.display().to_string(), &e));
        command.arg(whole(elf)?);
        if let Some(program) = program {
            // A comma in a name is written twice.
            let file = whole(program)?.display().to_string().replace(',', ",,");
            command.args(["-device", &format!("loader,file={file},addr={FACTORY:#x},force-raw=on")]);
        }
        let process = command.spawn().map_err(|e| match e.kind() {
            io::ErrorKind::NotFound => BenchError::Missing {
                what: QEMU.to_owned(),
                remedy: format!("install it: apt-get install {QEMU}, or your system's package of QEMU for Arm"),
            },
            _ => BenchError::open(QEMU, &e),
        })?;
        let mut emulator = Self { process, folder, _temporary: temporary, shared, request: 0 };
        emulator.wait("the firmware does not come up", |e| Ok(e.word(0)? == MAGIC))?;
        let version = emulator.word(4).map_err(opened)?;
        if version != VERSION {
            return Err(BenchError::Foreign(format!("bench link of version {version}, this program knows {VERSION}")));
        }
        Ok(emulator)
    }

    /// Its setpoint link and its configuration link.
    ///
    /// # Errors
    /// The emulator has ended.
    #[cfg(unix)]
    pub fn lines(&self) -> Result<[Line; 2], BenchError> {
        let line = |name: &str| {
            let path = self.folder.path().join(name);
            Line::socket(&path).map_err(|e| BenchError::open(path.display().to_string(), &e))
        };
        Ok([line("setpoint.sock")?, line("config.sock")?])
    }

    fn word(&mut self, offset: u64) -> io::Result<u32> {
        let mut bytes = [0; 4];
        self.shared.seek(SeekFrom::Start(offset))?;
        self.shared.read_exact(&mut bytes)?;
        Ok(u32::from_le_bytes(bytes))
    }

    fn put(&mut self, offset: u64, bytes: &[u8]) -> io::Result<()> {
        self.shared.seek(SeekFrom::Start(offset))?;
        self.shared.write_all(bytes)
    }

    /// Looks again and again, more and more seldom, until something is so.
    fn wait(&mut self, what: &str, mut is_so: impl FnMut(&mut Self) -> io::Result<bool>) -> Result<(), BenchError> {
        let lost = |e: io::Error| BenchError::open("the shared memory of the emulator", &e);
        let start = Instant::now();
        let mut pause = Duration::from_micros(20);
        while !is_so(self).map_err(lost)? {
            if let Ok(Some(status)) = self.process.try_wait() {
                let said = fs::read_to_string(self.folder.path().join("said")).unwrap_or_default();
                return Err(BenchError::Silent(format!("the emulator has ended, {status}: {}", said.trim())));
            }
            if start.elapsed() > PATIENCE {
                return Err(BenchError::Silent(what.to_owned()));
            }
            std::thread::sleep(pause);
            pause = (pause * 2).min(Duration::from_millis(2));
        }
        Ok(())
    }
}

impl Bulk for Emulator {
    fn describe(&self) -> String {
        "virtual board in QEMU, batches in shared memory".to_owned()
    }
    fn run(&mut self, input: &[u8]) -> Result<Vec<u8>, BenchError> {
        let lost = |e: io::Error| BenchError::open("the shared memory of the emulator", &e);
        self.request = self.request.wrapping_add(1);
        let request = self.request;
        self.put(INPUT, input).map_err(lost)?;
        self.put(INPUT_BYTES, &(input.len() as u32).to_le_bytes()).map_err(lost)?;
        self.put(REQUEST, &request.to_le_bytes()).map_err(lost)?;
        self.wait("a batch does not come to its end", |e| Ok(e.word(DONE)? == request))?;
        let length = self.word(OUTPUT_BYTES).map_err(lost)? as usize;
        let mut output = vec![0; length.min(OUTPUT as usize)];
        self.shared.seek(SeekFrom::Start(OUTPUT)).map_err(lost)?;
        self.shared.read_exact(&mut output).map_err(lost)?;
        Ok(output)
    }
}

impl Drop for Emulator {
    fn drop(&mut self) {
        // It may have ended already; the folder goes afterwards.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
