//! Images: which there are, and how one is built.

use std::path::PathBuf;

use clap::ValueEnum;

use super::{flat, linker};
use crate::repository::{run, target};
use crate::step::Failure;
use crate::toolchain::{TARGET, Toolchain};

/// A board.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum Board {
    /// QEMU's mps2-an500.
    Virtual,
    /// NUCLEO-H743ZI2.
    NucleoH743,
}

/// A binary of the firmware package with the features it needs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Image {
    /// Name of the binary.
    pub bin: &'static str,
    /// Features of the package.
    pub features: &'static str,
    /// Whether it is built as what a loader starts: for size, where nothing is called once a tick.
    pub for_size: bool,
}

/// What only an updatable program is built with: its profile; hashes for signatures, which nobody waits for, as a third of the code at half the
/// speed; and no pieces of functions that several share, whose stack nobody knows.
const UPDATABLE: (&str, &str) = (
    "firmware-updatable",
    ",\"--cfg\",\"sha2_backend_soft=\\\"compact\\\"\",\"-Cllvm-args=-enable-machine-outliner=never\"",
);

impl Board {
    /// Every board.
    pub const ALL: [Self; 2] = [Self::Virtual, Self::NucleoH743];

    /// Its image, which starts by itself.
    pub const fn image(self) -> Image {
        match self {
            Self::Virtual => Image { bin: "truepath-virtual", features: "board-virtual", for_size: false },
            Self::NucleoH743 => Image { bin: "truepath-nucleo-h743", features: "board-nucleo-h743", for_size: false },
        }
    }
    /// Its loader.
    pub const fn loader(self) -> Image {
        match self {
            Self::Virtual => {
                Image { bin: "truepath-virtual-loader", features: "board-virtual,updatable", for_size: true }
            }
            Self::NucleoH743 => {
                Image { bin: "truepath-nucleo-h743-loader", features: "board-nucleo-h743,updatable", for_size: true }
            }
        }
    }
    /// The image that its loader starts.
    pub const fn updatable(self) -> Image {
        match self {
            Self::Virtual => Image { bin: "truepath-virtual", features: "board-virtual,updatable", for_size: true },
            Self::NucleoH743 => {
                Image { bin: "truepath-nucleo-h743", features: "board-nucleo-h743,updatable", for_size: true }
            }
        }
    }
    /// Its name in tables.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Virtual => "virtual",
            Self::NucleoH743 => "nucleo-h743",
        }
    }
}

impl Image {
    /// Builds it as [`Image::build`] does, and puts it beside that as it lies in the flash (`.bin`): what an update is made of.
    ///
    /// # Errors
    /// When it does not build.
    pub fn build_flat(self, toolchain: &Toolchain) -> Result<PathBuf, Failure> {
        let elf = self.build(toolchain)?;
        let to = elf.with_extension("bin");
        std::fs::write(&to, flat::read(&elf)?).map_err(|e| Failure::found(format!("{}: {e}", to.display())))?;
        Ok(to)
    }

    /// Builds it, and puts it into `target/firmware`. The file also holds what the compiler says about stack frames, in a section that no
    /// board gets: so one image is weighed, proved and run.
    ///
    /// # Errors
    /// When it does not build.
    pub fn build(self, toolchain: &Toolchain) -> Result<PathBuf, Failure> {
        // A directory of its own: another compiler and other flags would rebuild everything else.
        let directory = target().join("device");
        let mut command = toolchain.cargo();
        let (profile, more) = if self.for_size { UPDATABLE } else { ("firmware", "") };
        command.args(["rustc", "--package", "truepath-fw", "--profile", profile, "--target", TARGET]);
        command.args(["--features", self.features, "--bin", self.bin, "--target-dir"]).arg(&directory);
        command
            .arg("--config")
            .arg(format!("target.{TARGET}.rustflags=[\"--remap-path-prefix={}=/cargo\"{more}]", cargo_home()));
        // A `-Z` option of the stable compiler; only this binary's own compilation sees it.
        command.env("RUSTC_BOOTSTRAP", "1").args(["--", "-Zemit-stack-sizes", "-Clink-arg=-Tstack-sizes.x"]);
        linker::provide(toolchain, &mut command)?;
        run(&mut command)?;
        let folder = target().join(if self.for_size { "firmware/updatable" } else { "firmware" });
        let (from, to) = (directory.join(TARGET).join(profile).join(self.bin), folder.join(self.bin));
        let copied = std::fs::create_dir_all(&folder).and_then(|()| std::fs::copy(&from, &to));
        copied.map_err(|e| Failure::found(format!("{} to {}: {e}", from.display(), to.display())))?;
        Ok(to)
    }
}

/// Where cargo keeps the sources of crates. Panics name files there; without a common name for it the size of an image
/// would depend on who builds it.
fn cargo_home() -> String {
    let home = || std::env::var("HOME").map(|home| format!("{home}/.cargo"));
    std::env::var("CARGO_HOME").or_else(|_| home()).unwrap_or_default().replace('\\', "/")
}
