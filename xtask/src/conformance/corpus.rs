//! The programs that are compared: those LinuxCNC ships, callers of its subroutines, and our own.
//!
//! Our own lie in `tests/data/conformance/`, one feature or one kind of error each; those whose name begins with
//! `reject-` must be refused at the line where the reference stops, those with `warn-` must be accepted with a warning
//! although it stops. A shipped file that only defines the subroutine it is named after does nothing when run: a
//! caller is made for it whose arguments are the defaults its comments give (`#<x> = #1 (=2.5 …)`), or 1.

use std::fs;
use std::path::{Path, PathBuf};

use crate::repository::{program, read, root};
use crate::step::Failure;

/// The Debian package of the reference.
pub const PACKAGE: &str = "linuxcnc-uspace";
/// The folder of our own programs, from the root.
pub const OWN: &str = "tests/data/conformance";

/// Where a program comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Origin {
    /// LinuxCNC's package.
    Shipped,
    /// Made here to call a shipped subroutine.
    Caller,
    /// Our own, to be treated as the reference does.
    Own,
    /// Our own, to be refused.
    Reject,
    /// Our own, to be accepted with a warning.
    Warn,
}

impl Origin {
    /// All of them, in the order of the report.
    pub const ALL: [Self; 5] = [Self::Shipped, Self::Caller, Self::Own, Self::Reject, Self::Warn];

    /// Its name in the report.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Shipped => "shipped",
            Self::Caller => "callers of shipped subroutines",
            Self::Own => "own",
            Self::Reject => "own, to be refused",
            Self::Warn => "own, to be accepted with a warning",
        }
    }
}

/// One program.
#[derive(Clone, Debug)]
pub struct Program {
    /// Where it comes from.
    pub origin: Origin,
    /// Its name in the report.
    pub name: String,
    /// The folder whose files are beside it.
    pub folder: PathBuf,
    /// Its file name.
    pub file: String,
    /// Its bytes.
    pub text: Vec<u8>,
    /// The file it calls, when it was made for that.
    pub called: Vec<u8>,
}

/// All programs, in the order of their names.
///
/// # Errors
/// When the package cannot be listed or a file not be read.
pub fn programs() -> Result<Vec<Program>, Failure> {
    let mut all = Vec::new();
    for path in read(program("dpkg").args(["-L", PACKAGE]))?.lines().filter(|l| l.ends_with(".ngc")) {
        let shipped = load(Path::new(path), Origin::Shipped)?;
        all.extend(caller_of(&shipped));
        all.push(shipped);
    }
    let own = root().join(OWN);
    let entries = fs::read_dir(&own).map_err(|e| Failure::found(format!("{}: {e}", own.display())))?;
    for path in entries.flatten().map(|e| e.path()).filter(|p| p.extension().is_some_and(|e| e == "ngc")) {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        let origin = match () {
            // Called by others.
            () if name.starts_with("sub-") => continue,
            () if name.starts_with("reject-") => Origin::Reject,
            () if name.starts_with("warn-") => Origin::Warn,
            () => Origin::Own,
        };
        all.push(load(&path, origin)?);
    }
    all.sort_by(|a, b| (a.origin, &a.name).cmp(&(b.origin, &b.name)));
    Ok(all)
}

fn load(path: &Path, origin: Origin) -> Result<Program, Failure> {
    let text = fs::read(path).map_err(|e| Failure::found(format!("{}: {e}", path.display())))?;
    let folder = path.parent().unwrap_or(Path::new("/")).to_owned();
    let file = path.file_name().unwrap_or_default().to_string_lossy().into_owned();
    let whole = path.to_string_lossy();
    let short = ["/usr/share/linuxcnc/", "/usr/share/doc/linuxcnc/examples/sample-configs/", "/usr/share/axis/"]
        .iter()
        .find_map(|prefix| whole.strip_prefix(prefix));
    let name = if origin == Origin::Shipped { short.unwrap_or(&whole).to_owned() } else { file.clone() };
    Ok(Program { origin, name, folder, file, text, called: Vec::new() })
}

/// A program that calls the subroutine a file is named after.
fn caller_of(shipped: &Program) -> Option<Program> {
    let stem = shipped.file.strip_suffix(".ngc")?;
    let text = String::from_utf8_lossy(&shipped.text).to_ascii_lowercase();
    let defines = |line: &str| {
        let line: String = line.split([';', '(']).next().unwrap_or_default().split_whitespace().collect();
        line == format!("o<{}>sub", stem.to_ascii_lowercase())
    };
    if !text.lines().any(defines) {
        return None;
    }
    let arguments: String = (1..=30).map_while(|n| default_of(&text, n)).map(|v| format!(" [{v}]")).collect();
    let call = format!("g21 g90 f1000 s500\no<{stem}> call{arguments}\nm2\n");
    Some(Program {
        origin: Origin::Caller,
        name: format!("{} (called)", shipped.name),
        folder: shipped.folder.clone(),
        file: "truepath-caller.ngc".to_owned(),
        text: call.into_bytes(),
        called: shipped.text.clone(),
    })
}

/// The value the comment beside the first use of `#n` proposes; 1 when it proposes none, nothing when `#n` is not used.
fn default_of(text: &str, n: u32) -> Option<String> {
    let name = format!("#{n}");
    let uses = |line: &&str| {
        let after = line.split(&name).nth(1);
        after.is_some_and(|rest| !rest.starts_with(|c: char| c.is_ascii_digit()))
    };
    let line = text.lines().find(uses)?;
    let proposed = line.split_once("(=").map(|(_, rest)| rest.trim_start());
    let digits: Option<String> = proposed.map(|p| p.chars().take_while(|c| "+-.0123456789".contains(*c)).collect());
    Some(digits.filter(|d| d.parse::<f64>().is_ok()).unwrap_or_else(|| "1".to_owned()))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn shipped(text: &str) -> Program {
        Program {
            origin: Origin::Shipped,
            name: "lib/circle.ngc".into(),
            folder: "/lib".into(),
            file: "circle.ngc".into(),
            text: text.into(),
            called: Vec::new(),
        }
    }

    #[test]
    fn a_subroutine_is_called_with_the_values_its_comments_propose() {
        let caller =
            caller_of(&shipped("(info)\nO<Circle> SUB\n#<r> = #1 (=2.5 radius)\n#<z> = #2\no<circle> endsub\n"));
        let text = String::from_utf8(caller.expect("a subroutine").text).unwrap();
        assert!(text.contains("o<circle> call [2.5] [1]\n"), "{text}");
    }

    #[test]
    fn a_plain_program_has_no_caller() {
        assert!(caller_of(&shipped("o<other> sub\no<other> endsub\nm2\n")).is_none());
    }
}
