//! Both programs run on one program, each in its own copy of the folder, and what came of it.

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

use super::corpus::{OWN, Program};
use crate::repository::{program, root, target};
use crate::step::Failure;

/// The tool table, beside our own programs; its lengths are inches, as the reference takes them without a configuration.
const TOOLS: &str = "tools.tbl";
/// The parameters: every one the reference wants to find, 0 but for the number of the coordinate system in force.
const PARAMETERS: &str = "machine.var";
/// Seconds either program may take.
const PATIENCE: u32 = 10;

/// How a run ended.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum End {
    /// To the end of the program.
    Accepted,
    /// Stopped with a message, at a line of which the text is known, and its number where that is.
    Refused {
        /// What was said.
        message: String,
        /// The line it was said of, as written.
        line: String,
    },
    /// It died or did not end.
    Crashed(String),
}

/// What one program made of it.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// How it ended.
    pub end: End,
    /// The canonical calls printed.
    pub text: String,
    /// Whether it warned.
    pub warned: bool,
}

/// The folder in which a program is run.
pub struct Bench {
    folder: PathBuf,
    truepath: PathBuf,
}

impl Bench {
    /// A fresh folder for the program numbered `index`.
    ///
    /// # Errors
    /// When files cannot be copied.
    pub fn new(index: usize, of: &Program) -> Result<Self, Failure> {
        let folder = target().join("conformance").join(index.to_string());
        let fail = |e: std::io::Error| Failure::found(format!("{}: {e}", folder.display()));
        match fs::remove_dir_all(&folder) {
            Err(e) if e.kind() != std::io::ErrorKind::NotFound => return Err(fail(e)),
            _ => {}
        }
        fs::create_dir_all(&folder).map_err(fail)?;
        for path in fs::read_dir(&of.folder).map_err(fail)?.flatten().map(|e| e.path()) {
            if path.is_file() && path.extension().is_some_and(|e| e == "ngc") {
                // What is not readable is not called either.
                let _ = fs::copy(&path, folder.join(path.file_name().unwrap_or_default()));
            }
        }
        for name in [TOOLS, PARAMETERS] {
            let from = root().join(OWN).join(name);
            fs::copy(&from, folder.join(name)).map_err(|e| Failure::found(format!("{}: {e}", from.display())))?;
        }
        let truepath = target().join("debug/truepath");
        Ok(Self { folder, truepath })
    }

    fn put(&self, file: &str, text: &[u8]) {
        // A file that cannot be written shows in both outcomes.
        let _ = fs::write(self.folder.join(file), text);
        // The reference writes what it ends with into its copy.
        let _ = fs::copy(root().join(OWN).join(PARAMETERS), self.folder.join(PARAMETERS));
    }

    fn run(&self, name: &Path, arguments: &[&str]) -> Ran {
        let mut command: Command = program("timeout");
        command.arg(PATIENCE.to_string()).arg(name).args(arguments).current_dir(&self.folder);
        // The reference keeps its tool table in a file of the home folder, which runs at the same time would share.
        command.env("HOME", &self.folder).env("LC_ALL", "C");
        match command.stdin(Stdio::null()).output() {
            Ok(output) => Ran {
                code: output.status.code(),
                text: String::from_utf8_lossy(&output.stdout).into_owned(),
                said: String::from_utf8_lossy(&output.stderr).into_owned(),
            },
            Err(e) => Ran { code: None, text: String::new(), said: e.to_string() },
        }
    }

    /// What the reference makes of it.
    pub fn theirs(&self, file: &str, text: &[u8]) -> Outcome {
        self.put(file, text);
        let ran = self.run(Path::new("rs274"), &["-t", TOOLS, "-v", PARAMETERS, "-g", file]);
        let said: Vec<&str> =
            ran.said.lines().filter(|l| *l != "executing" && !l.contains("updating variable")).collect();
        let end = match ran.code {
            Some(0) => End::Accepted,
            Some(1) => {
                let message = said.first().copied().unwrap_or_default().to_owned();
                // Of a missing subroutine it tells the number of the line that calls it.
                let number = message.split_once("from line: ").and_then(|(_, n)| n.parse::<usize>().ok());
                let called =
                    number.and_then(|n| String::from_utf8_lossy(text).split('\n').nth(n - 1).map(str::to_owned));
                let line = called.unwrap_or_else(|| said.get(1).copied().unwrap_or_default().to_owned());
                End::Refused { message, line }
            }
            Some(124) => End::Crashed(format!("not done after {PATIENCE} s")),
            _ => End::Crashed("the program died".to_owned()),
        };
        Outcome { end, text: ran.text, warned: false }
    }

    /// What `truepath canon` makes of it.
    pub fn ours(&self, file: &str, text: &[u8]) -> Outcome {
        self.put(file, text);
        let tools = ["--tool-table", TOOLS, "--tool-table-units", "inch"];
        let parameters = ["--parameters", PARAMETERS, "--machine-units", "inch"];
        let arguments = [&["--json", "canon", file][..], &tools, &parameters].concat();
        let ran = self.run(&self.truepath, &arguments);
        let end = match ran.code {
            Some(0) => End::Accepted,
            Some(1) => self.refusal(&ran.said),
            Some(124) => End::Crashed(format!("not done after {PATIENCE} s")),
            _ => End::Crashed(ran.said.lines().last().unwrap_or_default().to_owned()),
        };
        Outcome { end, text: ran.text, warned: ran.said.contains("\"warning\"") }
    }

    fn refusal(&self, said: &str) -> End {
        let parsed = said.lines().filter_map(|l| serde_json::from_str::<serde_json::Value>(l).ok());
        let Some(error) = parsed.filter_map(|v| v.get("error").cloned()).next_back() else {
            return End::Crashed(said.to_owned());
        };
        let text = |key: &str| error.get(key).and_then(serde_json::Value::as_str).unwrap_or_default();
        let number = error.get("line").and_then(serde_json::Value::as_u64).unwrap_or(0) as usize;
        let source = fs::read(self.folder.join(text("file"))).unwrap_or_default();
        let source = String::from_utf8_lossy(&source).into_owned();
        let line = source.split('\n').nth(number.wrapping_sub(1)).unwrap_or_default().trim_end().to_owned();
        End::Refused { message: format!("{}: {}", text("code"), text("message")), line }
    }
}

/// What a process left.
struct Ran {
    code: Option<i32>,
    text: String,
    said: String,
}
