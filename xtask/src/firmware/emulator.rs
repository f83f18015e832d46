//! The emulator of the virtual board.

use std::process::Command;

use crate::repository::{program, succeeds};
use crate::step::Failure;
use crate::toolchain::need;

const NAME: &str = "qemu-system-arm";

/// A command of the emulator with the machine of the virtual board and no window.
///
/// # Errors
/// It is missing and may not be installed.
pub fn command() -> Result<Command, Failure> {
    need(|| succeeds(program(NAME).arg("--version")), NAME, "no emulator of the virtual board")?;
    let mut command = program(NAME);
    command.args(["-M", "mps2-an500", "-display", "none", "-monitor", "none"]);
    Ok(command)
}
