//! Puts the component and what belongs to it where LinuxCNC and its user find them.

use std::path::{Path, PathBuf};
use std::process::Command;

use super::component;
use crate::repository::{self, Profile, copy, is_root, may_install, program, root, run};
use crate::step::{Failure, Outcome, Passed};

/// Programs on the path.
const PROGRAMS: &str = "/usr/local/bin";
/// Where LinuxCNC looks for modules.
const MODULES: &str = "/usr/lib/linuxcnc/modules";
/// Where `HALFILE = LIB:truepath.hal` of an INI file is looked for.
const HAL_FILES: &str = "/usr/share/linuxcnc/hallib";
/// M-codes, to be named in an INI file's `USER_M_PATH`.
const M_CODES: &str = "/usr/local/share/truepath/mcodes";

/// Python package of `truepath-config`.
const PACKAGE: &str = "/usr/local/share/truepath/truepath_config";

/// Files of `linuxcnc/`, where each goes, and its mode.
const FILES: [(&str, &str, &str); 4] = [
    ("truepath-config", PROGRAMS, "755"),
    ("truepath.hal", HAL_FILES, "644"),
    ("mcodes/M160", M_CODES, "755"),
    ("mcodes/M161", M_CODES, "755"),
];

/// Builds and installs, the program only where none is given; says where everything went.
pub fn install(component_only: bool, truepath: Option<PathBuf>) -> Outcome {
    let truepath = truepath.map(|file| root().join(file));
    if let Some(missing) = truepath.as_ref().filter(|file| !file.is_file()) {
        return Err(Failure::found(format!("no program at {}", missing.display())));
    }
    let folder = component::build()?;
    run(with_rights("make").arg("--directory").arg(&folder).arg("install"))?;
    println!("truepath.so -> LinuxCNC's modules (loadrt truepath)");
    if component_only {
        return Ok(Passed::Done);
    }
    put(&truepath.map_or_else(|| repository::truepath(Profile::Local), Ok)?, PROGRAMS, "755")?;
    for (file, folder, mode) in FILES {
        let source = root().join("linuxcnc").join(file);
        if source.exists() {
            put(&source, folder, mode)?;
        }
    }
    for source in files_below(&root().join("linuxcnc/truepath_config"))? {
        put(&source, PACKAGE, "644")?;
    }
    Ok(Passed::Done)
}

/// Builds the component and lays out a tree with it and what belongs to it, as a package of Debian has it; gives the version
/// of LinuxCNC it is for. `None` where LinuxCNC's development package is missing.
pub fn packaged(tree: &Path) -> Result<Option<String>, Failure> {
    let version = program("dpkg-query").args(["--show", "--showformat=${Version}", "linuxcnc-uspace"]).output();
    let Some(version) = version.ok().filter(|said| said.status.success() && component::can_build()) else {
        return Ok(None);
    };
    let built = component::build()?;
    let at = |folder: &str, file: &Path| tree.join(folder).join(file.file_name().unwrap_or_default());
    for (module, _) in component::MODULES {
        let module = built.join(module);
        copy(&module, &at("usr/lib/linuxcnc/modules", &module), 0o644)?;
    }
    for (file, folder, mode) in FILES {
        let source = root().join("linuxcnc").join(file);
        let mode = if mode == "755" { 0o755 } else { 0o644 };
        copy(&source, &at(folder.trim_start_matches('/').replace("/local", "").as_str(), &source), mode)?;
    }
    for source in files_below(&root().join("linuxcnc/truepath_config"))? {
        copy(&source, &at("usr/share/truepath/truepath_config", &source), 0o644)?;
    }
    let papers = "usr/share/doc/truepath-linuxcnc";
    for file in ["docs/linuxcnc.md", "linuxcnc/COPYING"] {
        copy(&root().join(file), &at(papers, Path::new(file)), 0o644)?;
    }
    Ok(Some(String::from_utf8_lossy(&version.stdout).into_owned()))
}

/// Takes away what [`install`] put there, and says what. Images, ledger and configuration of a machine stay.
pub fn uninstall() -> Outcome {
    let modules = component::MODULES.iter().map(|(name, _)| Path::new(MODULES).join(name));
    let files =
        FILES.iter().map(|(file, folder, _)| Path::new(folder).join(Path::new(file).file_name().unwrap_or_default()));
    let whole = [PACKAGE, M_CODES].map(PathBuf::from);
    let all = modules.chain([Path::new(PROGRAMS).join("truepath")]).chain(files).chain(whole);
    let there: Vec<PathBuf> = all.filter(|path| path.symlink_metadata().is_ok()).collect();
    if there.is_empty() {
        return Ok(Passed::Skipped("nothing of Truepath is installed".to_owned()));
    }
    run(with_rights("rm").args(["-r", "-f", "--"]).args(&there))?;
    for path in &there {
        println!("removed {}", path.display());
    }
    // The folder that held both, where it is empty now.
    if let Some(shared) = Path::new(PACKAGE).parent().filter(|folder| folder.is_dir()) {
        run(with_rights("rmdir").arg("--ignore-fail-on-non-empty").arg(shared))?;
    }
    Ok(Passed::Done)
}

/// Builds the component, and installs it where it is not the one that is installed.
///
/// # Errors
/// It does not build, or it would have to be installed and may not be.
pub fn component_if_changed() -> Result<(), Failure> {
    let folder = component::build()?;
    let installed = |name: &str| {
        let made = read_bytes(&folder.join(name));
        made.is_some() && made == read_bytes(&Path::new(MODULES).join(name))
    };
    if component::MODULES.iter().all(|(name, _)| installed(name)) {
        return Ok(());
    }
    if !may_install() {
        return Err(Failure::Missing("another truepath.so is installed: cargo xtask linuxcnc install".to_owned()));
    }
    install(true, None).map(drop)
}

fn read_bytes(file: &Path) -> Option<Vec<u8>> {
    std::fs::read(file).ok()
}

/// The Python files of a folder, in the order of their names.
fn files_below(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let entries = folder.read_dir().map_err(|e| Failure::found(format!("{}: {e}", folder.display())))?;
    let mut files: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "py"));
    files.sort();
    Ok(files)
}

fn put(source: &Path, folder: &str, mode: &str) -> Result<(), Failure> {
    let name = source.file_name().unwrap_or_default().to_string_lossy();
    run(with_rights("install").args(["-D", "-m", mode]).arg(source).arg(format!("{folder}/{name}")))?;
    println!("{name} -> {folder}");
    Ok(())
}

/// A program that may write into the system's folders.
fn with_rights(name: &str) -> Command {
    if is_root() {
        return program(name);
    }
    let mut command = program("sudo");
    command.arg(name);
    command
}
