//! Images: which there are, and how one is built.

use std::path::PathBuf;

use clap::ValueEnum;

use super::linker;
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
}

impl Board {
    /// Every board.
    pub const ALL: [Self; 2] = [Self::Virtual, Self::NucleoH743];

    /// Its image.
    pub const fn image(self) -> Image {
        match self {
            Self::Virtual => Image { bin: "truepath-virtual", features: "board-virtual" },
            Self::NucleoH743 => Image { bin: "truepath-nucleo-h743", features: "board-nucleo-h743" },
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
    /// Builds it, and puts it into `target/firmware`. The file also holds what the compiler says about stack frames, in a section that no
    /// board gets: so one image is weighed, proved and run.
    ///
    /// # Errors
    /// When it does not build.
    pub fn build(self, toolchain: &Toolchain) -> Result<PathBuf, Failure> {
        // A directory of its own: another compiler and other flags would rebuild everything else.
        let directory = target().join("device");
        let mut command = toolchain.cargo();
        command.args(["rustc", "--package", "truepath-fw", "--profile", "firmware", "--target", TARGET]);
        command.args(["--features", self.features, "--bin", self.bin, "--target-dir"]).arg(&directory);
        command
            .arg("--config")
            .arg(format!("target.{TARGET}.rustflags=[\"--remap-path-prefix={}=/cargo\"]", cargo_home()));
        // A `-Z` option of the stable compiler; only this binary's own compilation sees it.
        command.env("RUSTC_BOOTSTRAP", "1").args(["--", "-Zemit-stack-sizes", "-Clink-arg=-Tstack-sizes.x"]);
        linker::provide(toolchain, &mut command)?;
        run(&mut command)?;
        let folder = target().join("firmware");
        let (from, to) = (directory.join(TARGET).join("firmware").join(self.bin), folder.join(self.bin));
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
