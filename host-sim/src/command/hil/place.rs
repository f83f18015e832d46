//! Where a board is, and how it is reached.

use std::path::{Path, PathBuf};

use truepath_bench::{BenchError, Board, BulkBoard, Emulator, InProcess, Line, UartBoard, find_elf, find_loader};

/// Which board.
#[derive(Clone, Debug)]
pub enum Kind {
    /// The device in this process.
    Host,
    /// The virtual board in QEMU, by batches in shared memory.
    VirtualBulk {
        /// The firmware; by default what `cargo xtask firmware` made.
        elf: Option<PathBuf>,
    },
    /// The virtual board in QEMU, over its UARTs.
    VirtualUart {
        /// The firmware; by default what `cargo xtask firmware` made.
        elf: Option<PathBuf>,
    },
    /// Two ports: setpoint link, configuration link.
    Ports {
        /// Serial ports, Unix sockets or `tcp:HOST:PORT`.
        names: [String; 2],
        /// Bits per second of each, where it is a serial port.
        bauds: [u32; 2],
    },
}

impl Kind {
    /// Whether the clock of the board is ours.
    pub const fn is_stepped(&self) -> bool {
        matches!(self, Self::Host | Self::VirtualBulk { .. })
    }
}

/// Opens a board. Over streams up to `window` answers may be outstanding, and with `paced` setpoints keep to the rate.
///
/// # Errors
/// Emulator, firmware or port are missing.
pub fn open(kind: &Kind, window: u32, paced: bool) -> Result<Box<dyn Board>, BenchError> {
    opened(kind, window, paced, (false, None))
}

/// Opens a board with its button held, so that keys can be provisioned. At a real one somebody has held it.
///
/// # Errors
/// As [`open`].
pub fn attended(kind: &Kind) -> Result<Box<dyn Board>, BenchError> {
    opened(kind, 1, false, (true, None))
}

/// The same of a board whose program can be replaced; the virtual one starts with this program behind its loader.
///
/// # Errors
/// As [`open`]; the device in this process has no loader.
pub fn updatable(kind: &Kind, program: &Path) -> Result<Box<dyn Board>, BenchError> {
    if matches!(kind, Kind::Host) {
        let (found, help) = ("the device in this process has no loader".to_owned(), "add --board virtual".to_owned());
        return Err(BenchError::Option { found, help });
    }
    opened(kind, 1, false, (true, Some(program)))
}

/// `held`: the button; and the program behind a loader.
fn opened(
    kind: &Kind,
    window: u32,
    paced: bool,
    (held, program): (bool, Option<&Path>),
) -> Result<Box<dyn Board>, BenchError> {
    let start = |elf: &Option<PathBuf>| match program {
        Some(program) => Emulator::loaded(&find_loader(elf.as_deref())?, program),
        None if held => Emulator::attended(&find_elf(elf.as_deref())?),
        None => Emulator::start(&find_elf(elf.as_deref())?),
    };
    Ok(match kind {
        Kind::Host if held => Box::new(BulkBoard::new(InProcess::attended()?)),
        Kind::Host => Box::new(BulkBoard::new(InProcess::start()?)),
        Kind::VirtualBulk { elf } => Box::new(BulkBoard::new(start(elf)?)),
        Kind::VirtualUart { elf } => {
            let emulator = start(elf)?;
            let lines = emulator.lines()?;
            let name = "virtual board in QEMU, UARTs over sockets".to_owned();
            Box::new(UartBoard::new(name, lines, window, paced, Some(emulator)))
        }
        Kind::Ports { names, bauds } => {
            let line = |name: &str, baud| Line::open(name, baud).map_err(|e| BenchError::open(name, &e));
            let lines = [line(&names[0], bauds[0])?, line(&names[1], bauds[1])?];
            Box::new(UartBoard::new(names.join(", "), lines, window, paced, None))
        }
    })
}
