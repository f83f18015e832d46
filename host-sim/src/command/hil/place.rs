//! Where a board is, and how it is reached.

use std::path::PathBuf;

use truepath_bench::{BenchError, Board, BulkBoard, Emulator, InProcess, Line, UartBoard, find_elf};

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
    opened(kind, window, paced, false)
}

/// Opens a board with its button held, so that keys can be provisioned. At a real one somebody has held it.
///
/// # Errors
/// As [`open`].
pub fn attended(kind: &Kind) -> Result<Box<dyn Board>, BenchError> {
    opened(kind, 1, false, true)
}

fn opened(kind: &Kind, window: u32, paced: bool, held: bool) -> Result<Box<dyn Board>, BenchError> {
    let start = |elf: &Option<PathBuf>| {
        let elf = find_elf(elf.as_deref())?;
        if held { Emulator::attended(&elf) } else { Emulator::start(&elf) }
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
