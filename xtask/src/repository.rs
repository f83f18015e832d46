//! Where things are, and programs run from there.

use std::ffi::OsStr;
use std::fs;
use std::os::unix::fs::PermissionsExt as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
use std::sync::OnceLock;

use crate::step::Failure;

/// The root of the repository: of the checkout cargo was called in, where one target directory serves several.
pub fn root() -> &'static Path {
    static ROOT: OnceLock<PathBuf> = OnceLock::new();
    ROOT.get_or_init(|| {
        let package = std::env::var_os("CARGO_MANIFEST_DIR").unwrap_or_else(|| env!("CARGO_MANIFEST_DIR").into());
        Path::new(&package).parent().expect("xtask lies in the root of the repository").to_owned()
    })
}

/// The target directory in force.
pub fn target() -> PathBuf {
    std::env::var_os("CARGO_TARGET_DIR").map_or_else(|| root().join("target"), |dir| root().join(dir))
}

/// How the program `truepath` is built; the profiles are in the workspace's `Cargo.toml`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Profile {
    /// As its tests are.
    Dev,
    /// To be used at once.
    Local,
    /// Its setpoint path as in a release, without the checks of a debug build.
    Bits,
}

/// Builds the program; its file.
///
/// # Errors
/// When it does not build.
pub fn truepath(profile: Profile) -> Result<PathBuf, Failure> {
    let (name, folder) = match profile {
        Profile::Dev => ("dev", "debug"),
        Profile::Local => ("local", "local"),
        Profile::Bits => ("bits", "bits"),
    };
    run(cargo().args(["build", "--quiet", "--profile", name, "--package", "truepath", "--bin", "truepath"]))?;
    Ok(target().join(folder).join("truepath"))
}

/// The cargo that runs this program.
pub fn cargo() -> Command {
    program(std::env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// This program again, also where a later build has put another into its place.
pub fn itself() -> Command {
    let link = Path::new("/proc/self/exe");
    program(if link.exists() { link.into() } else { std::env::current_exe().unwrap_or_else(|_| "xtask".into()) })
}

/// A program, started in the root.
pub fn program(name: impl AsRef<OsStr>) -> Command {
    let mut command = Command::new(name);
    command.current_dir(root());
    command
}

/// Runs a command with its output shown.
///
/// # Errors
/// When it cannot be started or does not succeed; the message is the command line.
pub fn run(command: &mut Command) -> Result<(), Failure> {
    eprintln!("    $ {}", line(command));
    let status = command.status().map_err(|e| not_started(command, &e))?;
    if status.success() { Ok(()) } else { Err(Failure::found(format!("{status}: {}", line(command)))) }
}

/// Runs a command and takes its standard output.
///
/// # Errors
/// When it cannot be started or does not succeed; the message holds what it said.
pub fn read(command: &mut Command) -> Result<String, Failure> {
    let Output { status, stdout, stderr } =
        command.stdin(Stdio::null()).output().map_err(|e| not_started(command, &e))?;
    if status.success() {
        return Ok(String::from_utf8_lossy(&stdout).into_owned());
    }
    let said = String::from_utf8_lossy(&stderr);
    Err(Failure::found(format!("{status}: {}\n{}", line(command), said.trim_end())))
}

/// Whether a command can be started and succeeds, in silence.
pub fn succeeds(command: &mut Command) -> bool {
    command.stdin(Stdio::null()).stdout(Stdio::null()).stderr(Stdio::null()).status().is_ok_and(|s| s.success())
}

/// Lets other processes go first from now on.
pub fn stand_back() {
    if !succeeds(program("renice").args(["-n", "10", "-p", &std::process::id().to_string()])) {
        eprintln!("    there is no renice: what follows does not stand back");
    }
}

/// The lines of a file.
///
/// # Errors
/// What the system says.
pub fn lines(file: &Path) -> Result<Vec<String>, Failure> {
    let text = std::fs::read_to_string(file).map_err(|e| Failure::found(format!("{}: {e}", file.display())))?;
    Ok(text.lines().map(str::to_owned).collect())
}

/// Makes a folder, with those above it.
///
/// # Errors
/// What the system says.
pub fn make_folder(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|e| Failure::found(format!("{}: {e}", folder.display())))
}

/// Writes a file, with the folders above it.
///
/// # Errors
/// What the system says.
pub fn write(file: &Path, bytes: &[u8]) -> Result<(), Failure> {
    make_folder(file.parent().unwrap_or(file))?;
    fs::write(file, bytes).map_err(|e| Failure::found(format!("{}: {e}", file.display())))
}

/// Copies a file and sets its rights.
///
/// # Errors
/// What the system says.
pub fn copy(from: &Path, to: &Path, mode: u32) -> Result<(), Failure> {
    let bytes = fs::read(from).map_err(|e| Failure::found(format!("{}: {e}", from.display())))?;
    write(to, &bytes)?;
    fs::set_permissions(to, fs::Permissions::from_mode(mode)).map_err(|e| Failure::found(e.to_string()))
}

/// Whether missing tools may be installed: by a continuous-integration run, or by a user who is root.
pub fn may_install() -> bool {
    std::env::var_os("CI").is_some_and(|v| v == "true") || is_root()
}

/// Whether the user is root.
pub fn is_root() -> bool {
    read(program("id").arg("-u")).is_ok_and(|uid| uid.trim() == "0")
}

fn not_started(command: &Command, error: &std::io::Error) -> Failure {
    Failure::Missing(format!("{} cannot be started: {error}", command.get_program().to_string_lossy()))
}

fn line(command: &Command) -> String {
    let words = std::iter::once(command.get_program()).chain(command.get_args());
    words.map(OsStr::to_string_lossy).collect::<Vec<_>>().join(" ")
}
