//! The program for 64-bit ARM, a small computer beside the machine: built here, and tried in an emulated processor.

use std::path::{Path, PathBuf};
use std::process::Command;

use crate::repository::{may_install, program, run, succeeds, target};
use crate::step::Failure;
use crate::toolchain::{Toolchain, install};

/// What it is built for.
const TRIPLE: &str = "aarch64-unknown-linux-gnu";
/// Links it, and compiles what of it is C.
const LINKER: &str = "aarch64-linux-gnu-gcc";
/// Runs it on another processor.
const EMULATOR: &str = "qemu-aarch64-static";
/// Where these come from, in Debian.
const PACKAGES: [&str; 3] = ["gcc-aarch64-linux-gnu", "libc6-dev-arm64-cross", "qemu-user-static"];

/// How to get what builds it.
pub fn remedy() -> String {
    format!(
        "the program for 64-bit ARM needs rustup target add {TRIPLE}, or Debian's compiler as the firmware does; and apt-get install {}",
        PACKAGES.join(" ")
    )
}

/// Builds the program in a profile, linked statically; `None` where something for it is missing and may not be installed.
///
/// # Errors
/// When it does not build.
pub fn built(profile: &str) -> Result<Option<PathBuf>, Failure> {
    let there = || [LINKER, EMULATOR].iter().all(|tool| succeeds(program(tool).arg("--version")));
    let have_tools = there() || (may_install() && install(&PACKAGES).is_ok() && there());
    let Some(toolchain) = have_tools.then(|| Toolchain::find_for(TRIPLE).ok()).flatten() else { return Ok(None) };
    // A directory of its own: another compiler would rebuild everything else.
    let directory = target().join("aarch64");
    let mut command = toolchain.cargo_with("std");
    command.args(["build", "--locked", "--package", "truepath", "--bin", "truepath", "--profile", profile]);
    command.args(["--target", TRIPLE, "--target-dir"]).arg(&directory);
    command.env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_LINKER", LINKER);
    command.env("CARGO_TARGET_AARCH64_UNKNOWN_LINUX_GNU_RUSTFLAGS", "-Ctarget-feature=+crt-static");
    run(&mut command)?;
    let of_profile = if profile == "dev" { "debug" } else { profile };
    let file = directory.join(TRIPLE).join(of_profile).join("truepath");
    let stripped = file.with_extension("stripped");
    run(program("aarch64-linux-gnu-strip").arg("-o").arg(&stripped).arg(file))?;
    Ok(Some(stripped))
}

/// A command that runs it here.
pub fn emulated(truepath: &Path) -> Command {
    let mut command = program(EMULATOR);
    command.arg(truepath);
    command
}
