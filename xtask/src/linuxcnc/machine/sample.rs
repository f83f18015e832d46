//! The sample machine as the tests run it: a copy of `linuxcnc/` in a folder of its own, without the screen.

use std::env;
use std::fs;
use std::path::{Path, PathBuf};

use super::user::User;
use crate::repository::{program, root, run, target};
use crate::step::Failure;

/// INI file of the sample machine, in `linuxcnc/`.
const INI: &str = "sim/truepath-mill.ini";
/// INI file of the tests, beside it.
const DERIVED: &str = "sim/tests.ini";
/// Takes the place of the screen.
const SCREEN: &str = "../tests/drive.py";

/// The machine's folder and who runs it.
#[derive(Clone, Debug)]
pub struct Sample {
    /// Copy of `linuxcnc/`; everything the machine writes lies in it.
    pub folder: PathBuf,
    /// Who runs it.
    pub user: User,
}

impl Sample {
    /// A fresh copy below the target directory, or, where the user does not get there, among the temporary files.
    ///
    /// # Errors
    /// Files cannot be copied.
    pub fn fresh(name: &str) -> Result<Self, Failure> {
        let user = User::find()?;
        let near = target().join("linuxcnc");
        fs::create_dir_all(&near).map_err(|e| Failure::found(format!("{}: {e}", near.display())))?;
        let near = if user.reaches(&near) { near } else { env::temp_dir().join("truepath-linuxcnc") };
        let folder = near.join(name);
        if folder.exists() {
            super::leftovers::clean(&user, &folder)?;
            fs::remove_dir_all(&folder).map_err(|e| Failure::found(format!("{}: {e}", folder.display())))?;
        }
        fs::create_dir_all(&near).map_err(|e| Failure::found(format!("{}: {e}", near.display())))?;
        run(program("cp").arg("-r").arg(root().join("linuxcnc")).arg(&folder))?;
        Ok(Self { folder, user })
    }

    /// The INI file of the tests.
    pub fn ini(&self) -> PathBuf {
        self.folder.join(DERIVED)
    }

    /// Programs of the machine's folder before those of the system.
    pub fn path(&self) -> String {
        format!("{}:{}", self.folder.join("bin").display(), env::var("PATH").unwrap_or_default())
    }

    /// Puts a program into the machine's folder.
    pub fn put(&self, source: &Path) -> Result<(), Failure> {
        let folder = self.folder.join("bin");
        fs::create_dir_all(&folder).map_err(|e| Failure::found(format!("{}: {e}", folder.display())))?;
        run(program("cp").arg(source).arg(&folder))
    }

    /// Writes the INI file, and gives all files to the user.
    ///
    /// # Errors
    /// A file cannot be read, written or given away.
    pub fn ready(&self) -> Result<(), Failure> {
        let source = self.folder.join(INI);
        let text = fs::read_to_string(&source).map_err(|e| Failure::found(format!("{}: {e}", source.display())))?;
        fs::write(self.ini(), derived(&text)).map_err(|e| Failure::found(format!("{}: {e}", self.ini().display())))?;
        self.user.own(&self.folder)
    }
}

/// The machine's INI file with the driver of the tests instead of its screen.
fn derived(text: &str) -> String {
    let mut lines = Vec::new();
    for line in text.lines() {
        match line.split('=').next().map(str::trim) {
            Some("DISPLAY") => lines.push(format!("DISPLAY = {SCREEN}")),
            Some("PYVCP" | "POSTGUI_HALFILE") => {}
            _ => lines.push(line.to_owned()),
        }
    }
    lines.join("\n") + "\n"
}

/// A number of the INI file, by section and key.
pub fn number(text: &str, section: &str, key: &str) -> Option<f64> {
    let mut inside = false;
    for line in text.lines().map(str::trim) {
        if line.starts_with('[') {
            inside = line == format!("[{section}]");
        } else if inside
            && let Some((name, value)) = line.split_once('=')
            && name.trim() == key
        {
            return value.split('#').next()?.trim().parse().ok();
        }
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_the_screen_of_the_machine_is_exchanged() {
        let text = "[DISPLAY]\nDISPLAY = axis\nPYVCP = p.xml\nCYCLE_TIME = 0.05\n[HAL]\nPOSTGUI_HALFILE = p.hal\n";
        assert_eq!(derived(text), format!("[DISPLAY]\nDISPLAY = {SCREEN}\nCYCLE_TIME = 0.05\n[HAL]\n"));
    }

    #[test]
    fn a_number_is_that_of_its_section() {
        let text = "[AXIS_X]\nMAX_VELOCITY = 50\n[JOINT_0]\nMAX_VELOCITY = 70 # mm/s\n";
        assert_eq!(number(text, "JOINT_0", "MAX_VELOCITY"), Some(70.0));
        assert_eq!(number(text, "JOINT_1", "MAX_VELOCITY"), None);
    }
}
