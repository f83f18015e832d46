//! The ordinary user LinuxCNC is started as: it refuses to be root.
//!
//! Who is no root starts it as they are. Root gives its rights up to `nobody`, who is there on every system, so that no
//! user has to be made; everything the machine writes lies in a folder given to it.

use std::ffi::OsStr;
use std::path::Path;
use std::process::Command;

use crate::repository::{is_root, program, read, run, succeeds};
use crate::step::Failure;

const NOBODY: &str = "nobody";

/// Who runs the machine.
#[derive(Clone, Debug)]
pub struct User {
    root: bool,
    /// Number of the user, as in `/proc`.
    pub uid: u32,
}

impl User {
    /// # Errors
    /// The number of the user cannot be found out.
    pub fn find() -> Result<Self, Failure> {
        let root = is_root();
        let mut id = program("id");
        id.arg("-u");
        if root {
            id.arg(NOBODY);
        }
        let uid = read(&mut id)?.trim().parse().map_err(|_| Failure::found("id -u does not give a number"))?;
        Ok(Self { root, uid })
    }

    /// A program that this user runs, at home in a folder and there.
    pub fn program(&self, name: impl AsRef<OsStr>, home: &Path) -> Command {
        let mut command = if self.root {
            let mut command = program("setpriv");
            let group = read(program("id").args(["-g", NOBODY])).unwrap_or_default();
            command.arg(format!("--reuid={}", self.uid)).arg(format!("--regid={}", group.trim()));
            command.args(["--clear-groups", "--"]).arg(name);
            command
        } else {
            program(name)
        };
        // No display: what LinuxCNC would ask in a window, it decides itself.
        command.current_dir(home).env("HOME", home).env_remove("DISPLAY").env_remove("XAUTHORITY");
        command
    }

    /// Gives this user a folder.
    pub fn own(&self, folder: &Path) -> Result<(), Failure> {
        if !self.root {
            return Ok(());
        }
        run(program("chown").args(["-R", &self.uid.to_string()]).arg(folder))
    }

    /// Whether this user gets at a folder.
    pub fn reaches(&self, folder: &Path) -> bool {
        succeeds(self.program("test", Path::new("/")).arg("-x").arg(folder))
    }
}
