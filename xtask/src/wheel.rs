//! The package for Python: one wheel for every Python from 3.9 on, made by maturin, and the proof that it works where it is
//! installed.
//!
//! The wheel holds `host-sim/python`: the extension module, built in the profile of the program beside it, so that nothing but
//! the module itself is compiled for it; the Python part with its types; licences and the list of all crates.

use std::fs;
use std::path::{Path, PathBuf};
use std::time::Instant;

use crate::repository::{make_folder, may_install, program, root, run, succeeds, target};
use crate::step::Failure;

/// What makes it, where there is none on the search path.
const MATURIN: &str = "maturin>=1.9.4,<2";
/// What it is used with beside NumPy, which comes with it.
const BESIDE: [&str; 2] = ["matplotlib", "mypy"];
/// Where the package lies.
const PLACE: &str = "host-sim/python";

/// Puts the wheel into a folder; `None` where there is no maturin and none may be installed.
///
/// # Errors
/// When it does not build.
pub fn packaged(folder: &Path, profile: &str, bill: &Path) -> Result<Option<PathBuf>, Failure> {
    let Some(maturin) = maturin() else { return Ok(None) };
    let mut command = program(maturin);
    command.args(["build", "--quiet", "--locked", "--profile", profile, "--manifest-path"]);
    command.arg(root().join(PLACE).join("Cargo.toml")).arg("--sbom-include").arg(bill).arg("--out").arg(folder);
    run(&mut command)?;
    in_folder(folder).map(Some).ok_or_else(|| Failure::found("maturin made no wheel"))
}

/// The wheel of a folder.
pub fn in_folder(folder: &Path) -> Option<PathBuf> {
    let files = folder.read_dir().ok()?.filter_map(|entry| Some(entry.ok()?.path()));
    files.into_iter().find(|file| file.extension().is_some_and(|e| e == "whl"))
}

/// How to get what makes a wheel.
pub fn remedy() -> String {
    format!(
        "the wheel for Python is made with maturin: pip install '{MATURIN}'; or, with python3 and its venv, into the target \
         directory: CI=true cargo xtask dist"
    )
}

/// Installs a wheel into an environment of its own, and uses it: against the command line byte for byte, with wrong input, as a
/// notebook, under a type checker.
///
/// # Errors
/// What does not work.
pub fn check(wheel: &Path, truepath: &Path) -> Result<(), Failure> {
    let place = target().join("python");
    let environment = place.join("clean");
    let _ = fs::remove_dir_all(&environment);
    make_folder(&place)?;
    let begun = Instant::now();
    make_environment(&environment)?;
    let python = environment.join("bin/python");
    pip(&python, &[wheel.as_os_str()])?;
    let installed = begun.elapsed();
    pip(&python, &BESIDE.map(AsRef::as_ref))?;
    let tests = root().join(PLACE).join("tests");
    // Away from the sources, so that it is the installed package that is found.
    let inside = || {
        let mut command = program(&python);
        command.current_dir(&place).env_remove("PYTHONPATH").env("PYTHONNOUSERSITE", "1");
        command
    };
    run(inside().arg(tests.join("notebook.py")).arg(root().join("examples/python/corner.ipynb")))?;
    let size = fs::metadata(wheel).map_or(0, |data| data.len());
    println!("    wheel of {:.1} MB, installed in {:.1} s", size as f64 / 1e6, installed.as_secs_f64());
    run(inside().arg(tests.join("test_truepath.py")).env("TRUEPATH", truepath))?;
    run(inside().args(["-m", "mypy", "--strict"]).arg(tests.join("typed.py")))?;
    run(inside().args(["-m", "mypy", "--strict", "--package", "truepath"]))?;
    run(inside().args(["-m", "mypy.stubtest", "truepath._truepath"]))
}

/// The user's own, or one in the target directory.
fn maturin() -> Option<PathBuf> {
    if succeeds(program("maturin").arg("--version")) {
        return Some("maturin".into());
    }
    let environment = target().join("python/tools");
    let own = environment.join("bin/maturin");
    if !succeeds(program(&own).arg("--version")) && may_install() {
        make_environment(&environment).ok()?;
        pip(&environment.join("bin/python"), &[MATURIN.as_ref()]).ok()?;
    }
    succeeds(program(&own).arg("--version")).then_some(own)
}

fn make_environment(folder: &Path) -> Result<(), Failure> {
    run(program("python3").args(["-m", "venv"]).arg(folder))
}

fn pip(python: &Path, what: &[&std::ffi::OsStr]) -> Result<(), Failure> {
    run(program(python).args(["-m", "pip", "install", "--quiet", "--disable-pip-version-check"]).args(what))
}
