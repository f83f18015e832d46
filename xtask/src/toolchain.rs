//! A compiler for the microcontroller, and for WebAssembly.
//!
//! In order of preference: the user's own, when the target is installed for it; Debian's, whose package of the
//! compiler's sources lets cargo build `core` and `std` for any target; else a message with both remedies. Nobody's toolchains
//! are changed: rustup is never called.

use std::ffi::OsString;
use std::fs::File;
use std::path::Path;
use std::process::Command;

use crate::repository::{cargo, is_root, make_folder, may_install, program, read, run, target};
use crate::step::Failure;

/// Cortex-M4F and M7 with the floats in registers.
pub const TARGET: &str = "thumbv7em-none-eabihf";
/// A module of WebAssembly that imports only what it says itself.
pub const WASM: &str = "wasm32-unknown-unknown";

/// Debian's packages, as of the security suite of Debian 12. They move, so no version is named.
const PACKAGES: [&str; 3] = ["cargo-web", "rustc-web", "rust-web-src"];

/// The oldest compiler the crates accept (`rust-version` of the workspace).
const OLDEST_MINOR: u32 = 93;

/// A compiler that can build for another target.
#[derive(Debug)]
pub enum Toolchain {
    /// The one in use, with the target installed.
    Own,
    /// Debian's, which builds `core` and what else is needed from source.
    Debian,
}

impl Toolchain {
    /// Finds one for the microcontroller, installing Debian's packages where that is allowed.
    ///
    /// # Errors
    /// [`Failure::Missing`] with the ways to get one.
    pub fn find() -> Result<Self, Failure> {
        Self::find_for(TARGET)
    }

    /// Finds one for a target.
    ///
    /// # Errors
    /// As [`Toolchain::find`].
    pub fn find_for(target: &str) -> Result<Self, Failure> {
        if own_has(target) {
            return Ok(Self::Own);
        }
        if debian_is_complete() {
            return Ok(Self::Debian);
        }
        if may_install() && install(&PACKAGES).is_ok() && debian_is_complete() {
            return Ok(Self::Debian);
        }
        Err(Failure::Missing(format!(
            "no compiler for {target}. Install one of:\n  rustup target add {target}\n  apt-get install \
             --no-install-recommends {}   (Debian; compiler 1.{OLDEST_MINOR} or newer)",
            PACKAGES.join(" ")
        )))
    }

    /// Its name in reports.
    pub fn describe(&self) -> &'static str {
        match self {
            Self::Own => "the installed target",
            Self::Debian => "Debian's compiler, the standard library built from source",
        }
    }

    /// Its compiler, `1.96.0 of Debian`: sizes and instruction counts are only the same with the same one.
    ///
    /// # Errors
    /// When it does not say.
    pub fn version(&self) -> Result<String, Failure> {
        let rustc = match self {
            Self::Own => std::env::var_os("RUSTC").unwrap_or_else(|| OsString::from("rustc")),
            Self::Debian => OsString::from("/usr/bin/rustc"),
        };
        let said = read(program(rustc).arg("--version"))?;
        let version = said.split_whitespace().nth(1).ok_or_else(|| Failure::found(format!("rustc said {said}")))?;
        Ok(version.to_owned() + if matches!(self, Self::Debian) { " of Debian" } else { "" })
    }

    /// Its cargo, for a target without an operating system.
    pub fn cargo(&self) -> Command {
        self.cargo_with("core")
    }

    /// Its cargo; `library` is what it builds of the standard library where that is not installed.
    pub fn cargo_with(&self, library: &str) -> Command {
        match self {
            Self::Own => cargo(),
            Self::Debian => {
                let mut command = program("/usr/bin/cargo");
                command
                    .env("RUSTC", "/usr/bin/rustc")
                    .env("RUSTDOC", "/usr/bin/rustdoc")
                    // Lets the stable compiler build its library; nothing else unstable is used.
                    .env("RUSTC_BOOTSTRAP", "1")
                    .env("CARGO_UNSTABLE_BUILD_STD", library);
                // What the cargo around this program set would lead back to its own compiler.
                for name in ["RUSTUP_TOOLCHAIN", "CARGO", "RUSTC_WRAPPER", "LD_LIBRARY_PATH"] {
                    command.env_remove(name);
                }
                command
            }
        }
    }
}

fn own_has(target: &str) -> bool {
    let rustc = std::env::var_os("RUSTC").unwrap_or_else(|| OsString::from("rustc"));
    let Ok(directory) = read(program(rustc).args(["--print", "target-libdir", "--target", target])) else {
        return false;
    };
    let Ok(files) = Path::new(directory.trim()).read_dir() else { return false };
    files.flatten().any(|f| f.file_name().to_string_lossy().starts_with("libcore-"))
}

fn debian_is_complete() -> bool {
    let rustc = || program("/usr/bin/rustc");
    let (Ok(version), Ok(sysroot)) = (read(rustc().arg("--version")), read(rustc().args(["--print", "sysroot"])))
    else {
        return false;
    };
    let source = Path::new(sysroot.trim()).join("lib/rustlib/src/rust/library/core");
    minor(&version).is_some_and(|m| m >= OLDEST_MINOR) && source.is_dir() && Path::new("/usr/bin/cargo").exists()
}

/// 95 of `rustc 1.95.0 (…)`.
fn minor(version: &str) -> Option<u32> {
    version.strip_prefix("rustc 1.")?.split('.').next()?.parse().ok()
}

/// Has a tool: where it is missing, its package is installed if that is allowed.
///
/// # Errors
/// It is missing still; `why` is what it is for.
pub fn need(there: impl Fn() -> bool, package: &str, why: &str) -> Result<(), Failure> {
    if there() || (may_install() && install(&[package]).is_ok() && there()) {
        return Ok(());
    }
    Err(Failure::Missing(format!("{why}: apt-get install {package}")))
}

/// Installs packages of Debian.
///
/// # Errors
/// When that does not succeed.
pub fn install(packages: &[&str]) -> Result<(), Failure> {
    let apt = || {
        let mut command = if is_root() { program("apt-get") } else { program("sudo") };
        if !is_root() {
            command.args(["-n", "apt-get"]);
        }
        command
    };
    // Steps run beside each other, and the lists of packages are for one at a time.
    let failed = |e: std::io::Error| Failure::found(format!("the lock of apt-get: {e}"));
    make_folder(&target())?;
    let lock = File::create(target().join("apt-get.lock")).map_err(failed)?;
    lock.lock().map_err(failed)?;
    run(apt().args(["update", "--quiet"]))?;
    run(apt().args(["install", "--yes", "--quiet", "--no-install-recommends"]).args(packages))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_version_of_a_compiler_is_read() {
        assert_eq!(minor("rustc 1.96.0 (ac68faa20 2026-05-25) (built from a source tarball)"), Some(96));
        assert_eq!(minor("rustc 2.0.0"), None);
        assert_eq!(minor("clang 17"), None);
    }
}
