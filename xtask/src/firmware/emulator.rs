//! The emulator of the virtual board.

use std::process::Command;

use crate::repository::{may_install, program, succeeds};
use crate::step::Failure;
use crate::toolchain::install;

const NAME: &str = "qemu-system-arm";

/// A command of the emulator with the machine of the virtual board and no window.
///
/// # Errors
/// It is missing and may not be installed.
pub fn command() -> Result<Command, Failure> {
    let there = || succeeds(program(NAME).arg("--version"));
    let installed = || may_install() && install(&[NAME]).is_ok() && there();
    if !(there() || installed()) {
        return Err(Failure::Missing(format!("no emulator of the virtual board: apt-get install {NAME}")));
    }
    let mut command = program(NAME);
    command.args(["-M", "mps2-an500", "-display", "none", "-monitor", "none"]);
    Ok(command)
}
