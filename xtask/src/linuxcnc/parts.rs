//! The parts of the sample machine: programs, and images made from probed walls.

use std::fs;
use std::path::PathBuf;

use super::machine::sample::Sample;
use crate::repository::{self, Profile, program, read, target};
use crate::step::Failure;

/// Parts that the scenarios mill; their walls have been probed.
pub const PARTS: [&str; 2] = ["corner", "pocket"];

/// The command-line program and the images.
#[derive(Clone, Debug)]
pub struct Parts {
    /// `truepath`.
    pub truepath: PathBuf,
    folder: PathBuf,
}

impl Parts {
    /// Builds the program, makes the images and puts both into the machine's folder.
    ///
    /// # Errors
    /// Something does not build, or a part cannot be corrected.
    pub fn make(sample: &Sample) -> Result<Self, Failure> {
        let truepath = repository::truepath(Profile::Dev)?;
        sample.put(&truepath)?;
        let folder = target().join("linuxcnc/parts");
        let parts = Self { truepath, folder };
        for part in PARTS {
            parts.correct(sample, part)?;
        }
        Ok(parts)
    }

    /// The image of a part.
    pub fn image(&self, part: &str) -> PathBuf {
        self.folder.join(part).join("correction.tpi")
    }

    /// Corrects a part of the machine by the wall that was probed, and lays its image beside its program.
    fn correct(&self, sample: &Sample, part: &str) -> Result<(), Failure> {
        let programs = sample.folder.join("sim/programs");
        let made = self.folder.join(part);
        let mut command = program(&self.truepath);
        command.arg("correct").arg(programs.join(format!("{part}.toml"))).arg("--probe");
        command.arg(programs.join(format!("{part}-probe-log.txt")));
        command.args(["--route", "coprocessor", "--force", "-o"]).arg(&made);
        read(&mut command)?;
        let to = programs.join(format!("{part}.tpi"));
        fs::copy(self.image(part), &to).map(drop).map_err(|e| Failure::found(format!("{}: {e}", to.display())))
    }
}
