//! What the runs need, and the comparison of the three ways to run.

use super::program::{Parts, Program, Run};
use crate::firmware::{Board, emulator};
use crate::step::Failure;
use crate::toolchain::Toolchain;

/// Runs whose digests have to be equal everywhere: part, kind and number of setpoints, other options; together above
/// 10⁶ setpoints.
const EQUAL: [(&str, (&str, u32), &[&str]); 5] = [
    ("corner", ("--count", 250_000), &["--seed", "1"]),
    ("pocket", ("--count", 250_000), &["--seed", "2"]),
    ("corner-helix", ("--random", 200_000), &["--seed", "3"]),
    ("corner", ("--random", 200_000), &["--axes", "6", "--rate", "10000", "--seed", "4"]),
    (
        "pocket",
        ("--random", 200_000),
        &[
            "--seed",
            "5",
            "--drop",
            "0.02",
            "--corrupt",
            "0.02",
            "--reorder",
            "0.02",
            "--repeat",
            "0.02",
            "--pause",
            "0.0005",
            "--jitter",
            "500",
        ],
    ),
];
/// Programs, firmware and parts.
pub struct Bench {
    /// Built for debugging.
    debug: Program,
    /// Built for release, when it is wanted.
    release: Option<Program>,
    /// The image of the virtual board.
    firmware: String,
    /// The updatable one as it lies in the flash, and the loader of the board.
    update: [String; 2],
    /// The parts.
    parts: Parts,
}

impl Bench {
    /// Builds all of it, the program for release only when that is compared, too.
    ///
    /// # Errors
    /// Something does not build, or the emulator is missing.
    pub fn set_up(release: bool) -> Result<Self, Failure> {
        emulator::command()?;
        let toolchain = Toolchain::find()?;
        let firmware = Board::Virtual.image().build(&toolchain)?.display().to_string();
        let flat = Board::Virtual.updatable().build_flat(&toolchain)?;
        let loader = Board::Virtual.loader().build(&toolchain)?;
        let debug = Program::build(false)?;
        let release = release.then(|| Program::build(true)).transpose()?;
        let parts = Parts::make(&debug)?;
        let update = [flat, loader].map(|path| path.display().to_string());
        Ok(Self { debug, release, firmware, update, parts })
    }

    /// A run in QEMU.
    ///
    /// # Errors
    /// It fails.
    pub fn emulated(&self, part: &str, link: &str, arguments: &[&str]) -> Result<Run, Failure> {
        let image = self.parts.image(part);
        let board = [image.as_str(), "--board", "virtual", "--link", link, "--elf", &self.firmware];
        self.debug.hil(&[&board[..], arguments].concat())
    }

    /// All of [`EQUAL`] with this part of the setpoints; gives the setpoints compared.
    ///
    /// # Errors
    /// A run fails, or its digest differs.
    pub fn equality(&self, part_of: u32) -> Result<u64, Failure> {
        let mut setpoints = 0;
        for (part, (kind, number), options) in EQUAL {
            let image = self.parts.image(part);
            let number = (number / part_of).to_string();
            let arguments = [&[kind, &number], options].concat();
            let on_host = [&[image.as_str()], &arguments[..]].concat();
            let mut runs =
                vec![("host debug", self.debug.hil(&on_host)?), ("emulated", self.emulated(part, "bulk", &arguments)?)];
            if let Some(release) = &self.release {
                runs.push(("host release", release.hil(&on_host)?));
            }
            for (name, run) in &runs {
                println!("{part:<14} {name:<13} {:>8} answers  {}", run.answers, run.digest);
                if run.digest != runs[0].1.digest {
                    return Err(Failure::found(format!("{part} {}: {name} differs", arguments.join(" "))));
                }
            }
            setpoints += runs[0].1.setpoints;
        }
        Ok(setpoints)
    }

    /// What a device with a key has to refuse, over a link of QEMU; gives how much was tried and how much of it refused.
    ///
    /// # Errors
    /// The device took or refused something that it must not.
    pub fn trust(&self, link: &str) -> Result<(usize, usize), Failure> {
        let image = self.parts.image("corner");
        let board = ["--trust", "--board", "virtual", "--link", link, "--elf", &self.firmware];
        self.debug.trust(&[&[image.as_str()], &board[..]].concat())
    }

    /// Updates of the firmware in QEMU, one of which does not start; gives how much was tried and how much of it refused.
    ///
    /// # Errors
    /// The device took or refused something that it must not, or ran another program than it has to.
    pub fn update(&self) -> Result<(usize, usize), Failure> {
        let [program, loader] = &self.update;
        self.debug.trust(&["--update", program, "--board", "virtual", "--link", "bulk", "--elf", loader])
    }

    /// The image of a part made in QEMU.
    ///
    /// # Errors
    /// It fails, or the image is not the host's.
    pub fn on_board(&self, part: &str, link: &str) -> Result<Run, Failure> {
        let [job, probe] = [self.parts.file(part, "job.toml"), self.parts.file(part, "probe.txt")];
        let made = ["--job", &job, "--probe", &probe, "--count", "2000"];
        let board = ["--board", "virtual", "--link", link, "--elf", &self.firmware];
        self.debug.hil(&[&made[..], &board[..]].concat())
    }
}
