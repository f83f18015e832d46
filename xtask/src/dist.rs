//! What people install: an archive, Debian packages and a wheel, with manual pages, completions, licences, a list of all parts
//! (CycloneDX) and checksums, in `target/packages`.
//!
//! | file | what |
//! |---|---|
//! | `truepath-VERSION-x86_64-linux.tar.gz` | the program, linked statically, and what belongs to it |
//! | `truepath_VERSION_amd64.deb` | the same for Debian and Ubuntu |
//! | `truepath-VERSION-aarch64-linux.tar.gz`, `truepath_VERSION_arm64.deb` | both for 64-bit ARM ([`aarch64`]) |
//! | `truepath-linuxcnc_VERSION_amd64.deb` | component, M-codes and the operator's side for LinuxCNC, built for the installed one |
//! | `truepath-VERSION-cp39-abi3-….whl` | the package for Python ([`wheel`]) |
//! | `truepath-VERSION.cdx.json` | every crate that is linked in, with version and licence |
//! | `truepath-python-VERSION.cdx.json` | the same of the wheel |
//! | `truepath-core-VERSION.crate` and the four below it | the core as a registry takes it, each built from its own archive |
//! | `SHA256SUMS` | of all of them |
//!
//! [`check`] does the same with the program of the tests, which is there already, then installs the packages into a root
//! of their own, corrects a part with what lies there, and removes them.

use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

use serde_json::{Value, json};

use crate::aarch64;
use crate::linuxcnc;
use crate::repository::{self, Profile, cargo, copy, make_folder, program, read, root, run, target, write};
use crate::step::{Failure, Outcome, Passed};
use crate::wheel;

/// The triple that the packages are for.
const TRIPLE: &str = "x86_64-unknown-linux-gnu";
/// Of the Debian packages.
const MAINTAINER: &str = "The Truepath developers <truepath@localhost>";

/// The crates of the core, each after those that it needs.
const CRATES: [&str; 5] = ["truepath-units", "truepath-rs274", "truepath-wire", "truepath-model", "truepath-core"];

/// Which program goes into the packages.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Build {
    /// Small, fast, linked statically: minutes to build.
    Dist,
    /// That of the tests.
    Dev,
}

impl Build {
    fn profile(self) -> &'static str {
        match self {
            Self::Dist => "dist",
            Self::Dev => "dev",
        }
    }
}

/// Makes the packages.
pub fn make() -> Outcome {
    let folder = target().join("packages");
    packages(&folder, Build::Dist)?;
    for entry in sorted(&folder)? {
        println!("{:>12} {}", fs::metadata(&entry).map_or(0, |data| data.len()), entry.display());
    }
    Ok(Passed::Done)
}

/// Makes the packages of the program of the tests, installs, uses and removes them.
pub fn check() -> Outcome {
    if !crate::repository::succeeds(program("dpkg-deb").arg("--version")) {
        return Ok(Passed::Skipped("there is no dpkg-deb".to_owned()));
    }
    let folder = target().join("packages-check");
    packages(&folder, Build::Dev)?;
    run(program("sha256sum").args(["--quiet", "--check", "SHA256SUMS"]).current_dir(&folder))?;
    let place = folder.join("root");
    for entry in sorted(&folder)?.iter().filter(|entry| entry.extension().is_some_and(|e| e == "deb")) {
        installed_used_removed(entry, &place)?;
    }
    let files = unpacked_used(&folder, "x86_64", &|truepath| program(truepath))?;
    if archive(&folder, "aarch64").exists() {
        // Another processor, with another library of mathematics: the same files.
        same_files(&files, &unpacked_used(&folder, "aarch64", &aarch64::emulated)?)?;
    }
    let wheel = wheel::in_folder(&folder).ok_or_else(|| Failure::Missing(wheel::remedy()))?;
    wheel::check(&wheel, &folder.join(archived("x86_64")).join("bin/truepath"))?;
    Ok(Passed::Done)
}

/// All of them, in a new folder.
fn packages(folder: &Path, build: Build) -> Result<(), Failure> {
    let _ = fs::remove_dir_all(folder);
    make_folder(folder)?;
    let version = env!("CARGO_PKG_VERSION");
    let binary = binary(build)?;
    let stage = folder.join("stage");
    let bill = folder.join(format!("truepath-{version}.cdx.json"));
    write(&bill, &serde_json::to_vec_pretty(&bill_of_materials("truepath", version)?).unwrap_or_default())?;

    // What the program is linked with, where it is not linked statically.
    let needs = if build == Build::Dev { "libc6" } else { "" };
    let native = Native { binary: &binary, bill: &bill };
    native.packed((folder, &stage), &binary, ["x86_64", "amd64"], needs)?;
    match aarch64::built(build.profile())? {
        Some(other) => native.packed((folder, &stage), &other, ["aarch64", "arm64"], "")?,
        None => eprintln!("    nothing for 64-bit ARM: {}", aarch64::remedy()),
    }

    if let Some(modules) = linuxcnc::packaged(&stage.join("linuxcnc"))? {
        let about = "Truepath for LinuxCNC\n The real-time component that corrects in the servo thread, M-codes and the \
                     operator's side.\n";
        let needs = format!("truepath (= {version}), linuxcnc-uspace (= {modules}), python3");
        let file = folder.join(format!("truepath-linuxcnc_{version}_amd64.deb"));
        deb(&stage.join("linuxcnc"), &file, ["truepath-linuxcnc", "amd64"], &needs, about)?;
    }
    let bill = folder.join(format!("truepath-python-{version}.cdx.json"));
    write(&bill, &serde_json::to_vec_pretty(&bill_of_materials("truepath-python", version)?).unwrap_or_default())?;
    if wheel::packaged(folder, build.profile(), &bill)?.is_none() {
        eprintln!("    no wheel: {}", wheel::remedy());
        fs::remove_file(&bill).map_err(|e| Failure::found(e.to_string()))?;
    }
    crates(folder, version)?;
    fs::remove_dir_all(&stage).map_err(|e| Failure::found(e.to_string()))?;
    let names: Vec<_> = sorted(folder)?.iter().filter_map(|entry| entry.file_name().map(ToOwned::to_owned)).collect();
    let sums = read(program("sha256sum").arg("--").args(names).current_dir(folder))?;
    write(&folder.join("SHA256SUMS"), sums.as_bytes())
}

/// Packs the crates of the core; cargo builds each from its archive and those before it.
fn crates(folder: &Path, version: &str) -> Result<(), Failure> {
    let mut command = cargo();
    // What is packed is what lies here, committed or not, as with every other package.
    command.args(["package", "--quiet", "--locked", "--allow-dirty"]);
    command.args(CRATES.iter().flat_map(|name| ["--package", name]));
    run(&mut command)?;
    for name in CRATES {
        let file = format!("{name}-{version}.crate");
        copy(&target().join("package").join(&file), &folder.join(&file), 0o644)?;
    }
    Ok(())
}

/// Builds the program.
fn binary(build: Build) -> Result<PathBuf, Failure> {
    if build == Build::Dev {
        let program_of_tests = repository::truepath(Profile::Dev)?;
        // Packing what debuggers read of it would take longer than all the rest.
        let stripped = target().join("debug/truepath-stripped");
        run(program("strip").arg("-o").arg(&stripped).arg(program_of_tests))?;
        return Ok(stripped);
    }
    let mut command = cargo();
    command.args(["build", "--package", "truepath", "--bin", "truepath"]);
    // With the triple named, build scripts and macros are not linked statically.
    command.args(["--profile", "dist", "--target", TRIPLE]);
    command.env("CARGO_TARGET_X86_64_UNKNOWN_LINUX_GNU_RUSTFLAGS", "-Ctarget-feature=+crt-static");
    run(&mut command)?;
    Ok(target().join(TRIPLE).join("dist/truepath"))
}

/// What lies in every package beside the program: what the one of this computer says, and the list of its parts.
struct Native<'n> {
    binary: &'n Path,
    bill: &'n Path,
}

impl Native<'_> {
    /// Packs a program as an archive and for Debian; a processor has a name in either.
    fn packed(
        &self,
        (folder, stage): (&Path, &Path),
        program_of_it: &Path,
        [processor, architecture]: [&str; 2],
        needs: &str,
    ) -> Result<(), Failure> {
        // The archive: as below /usr/local.
        let name = archived(processor);
        self.filled(&stage.join(&name), program_of_it)?;
        // The same bytes from the same files, whoever packs them and when.
        let same = ["--sort=name", "--owner=0", "--group=0", "--numeric-owner", "--mtime=@0", "--create", "--gzip"];
        let file = archive(folder, processor);
        run(program("tar").args(same).arg("--file").arg(file).arg("--directory").arg(stage).arg(&name))?;
        let tree = stage.join(architecture);
        self.filled(&tree.join("usr"), program_of_it)?;
        let about = "Milling contours as if machine and cutter were rigid\n Corrects finishing contours of milling \
                     programs for the deflection of machine and\n cutter, from a few probe touches.\n";
        let file = folder.join(format!("truepath_{}_{architecture}.deb", env!("CARGO_PKG_VERSION")));
        deb(&tree, &file, ["truepath", architecture], needs, about)
    }

    /// Fills what is `/usr` or `/usr/local` where it is installed.
    fn filled(&self, usr: &Path, program_of_it: &Path) -> Result<(), Failure> {
        let Self { binary, bill } = *self;
        let to = |name: &str| usr.join(name);
        copy(program_of_it, &to("bin/truepath"), 0o755)?;
        let made = to("share/man/man1");
        run(program(binary).args(["--quiet", "man", "--output"]).arg(&made))?;
        for page in sorted(&made)? {
            run(program("gzip").args(["-9", "--no-name"]).arg(page))?;
        }
        for (shell, name) in [
            ("bash", "share/bash-completion/completions/truepath"),
            ("zsh", "share/zsh/vendor-completions/_truepath"),
            ("fish", "share/fish/vendor_completions.d/truepath.fish"),
        ] {
            let script = read(program(binary).args(["completions", shell]))?;
            write(&to(name), script.as_bytes())?;
        }
        let papers = "share/doc/truepath";
        for file in ["README.md", "CHANGELOG.md", "LICENSE-MIT", "LICENSE-APACHE"] {
            copy(&root().join(file), &to(&format!("{papers}/{file}")), 0o644)?;
        }
        copy(bill, &to(&format!("{papers}/parts.cdx.json")), 0o644)?;
        let copyright = "Truepath: MIT OR Apache-2.0, see LICENSE-MIT and LICENSE-APACHE.\n\
                         The crates that are linked in and their licences: parts.cdx.json.\n\
                         Letters of pages and pictures: Arimo, SIL Open Font License 1.1.\n";
        write(&to(&format!("{papers}/copyright")), copyright.as_bytes())
    }
}

/// A Debian package of a tree.
fn deb(tree: &Path, file: &Path, [name, architecture]: [&str; 2], needs: &str, about: &str) -> Result<(), Failure> {
    let mut control = format!(
        "Package: {name}\nVersion: {}\nSection: misc\nPriority: optional\nArchitecture: {architecture}\nMaintainer: {MAINTAINER}\n",
        env!("CARGO_PKG_VERSION")
    );
    if !needs.is_empty() {
        let _ = writeln!(control, "Depends: {needs}");
    }
    let _ = write!(control, "Description: {about}");
    write(&tree.join("DEBIAN/control"), control.as_bytes())?;
    run(program("dpkg-deb").args(["--root-owner-group", "--build"]).arg(tree).arg(file).env("SOURCE_DATE_EPOCH", "0"))
}

/// What the archive for a processor holds is in a folder of this name.
fn archived(processor: &str) -> String {
    format!("truepath-{}-{processor}-linux", env!("CARGO_PKG_VERSION"))
}

/// The archive for a processor, in the folder of packages.
fn archive(folder: &Path, processor: &str) -> PathBuf {
    folder.join(format!("{}.tar.gz", archived(processor)))
}

/// Every crate that is linked into the program or the module of a package, as CycloneDX 1.5 has it.
fn bill_of_materials(of_package: &str, version: &str) -> Result<Value, Failure> {
    let tree = ["tree", "--package", of_package, "--edges", "normal", "--prefix", "none", "--no-dedupe", "--locked"];
    let text = read(cargo().args(tree).args(["--target", TRIPLE, "--format", "{p}|{l}"]))?;
    let mut rows: Vec<(&str, &str, &str)> = Vec::new();
    for line in text.lines() {
        let (package, licence) = line.split_once('|').unwrap_or((line, ""));
        let mut words = package.split(' ');
        let (Some(name), Some(of)) = (words.next(), words.next().and_then(|v| v.strip_prefix('v'))) else { continue };
        if licence.is_empty() {
            return Err(Failure::found(format!("{name} {of} names no licence")));
        }
        rows.push((name, of, licence));
    }
    rows.sort_unstable();
    rows.dedup();
    let components: Vec<Value> = rows
        .into_iter()
        .filter(|(name, ..)| *name != of_package)
        .map(|(name, of, licence)| {
            let place = format!("pkg:cargo/{name}@{of}");
            json!({
                "type": "library", "bom-ref": place, "name": name, "version": of, "purl": place,
                // An older way of writing OR.
                "licenses": [{ "expression": licence.replace('/', " OR ") }],
            })
        })
        .collect();
    Ok(json!({
        "bomFormat": "CycloneDX", "specVersion": "1.5", "version": 1,
        "metadata": { "component": {
            "type": if of_package == "truepath" { "application" } else { "library" }, "bom-ref": of_package, "name": of_package, "version": version,
            "licenses": [{ "expression": "MIT OR Apache-2.0" }],
        } },
        "components": components,
    }))
}

/// Installs a package into a root of its own, uses what lies there, removes it, and looks for what is left.
fn installed_used_removed(package: &Path, place: &Path) -> Result<(), Failure> {
    let _ = fs::remove_dir_all(place);
    for folder in ["var/lib/dpkg/info", "var/lib/dpkg/updates"] {
        make_folder(&place.join(folder))?;
    }
    write(&place.join("var/lib/dpkg/status"), b"")?;
    let before = files_below(place)?;
    let dpkg = |arguments: &[&str]| {
        let mut command = program("dpkg");
        // What it needs is installed on this machine, not in that root; the processor may be another one.
        command.args([
            "--force-architecture",
            "--force-depends",
            "--force-not-root",
            "--force-script-chrootless",
            "--log=/dev/null",
            "--root",
        ]);
        command.arg(place).args(arguments);
        command
    };
    let name = read(program("dpkg-deb").arg("--field").arg(package).arg("Package"))?;
    let begun = Instant::now();
    run(dpkg(&["--install"]).arg(package))?;
    let in_place = begun.elapsed();
    let installed: Vec<_> = files_below(place)?.into_iter().filter(|f| !f.starts_with("var")).collect();
    if installed.is_empty() {
        return Err(Failure::found(format!("{} installs nothing", package.display())));
    }
    let architecture = read(program("dpkg-deb").arg("--field").arg(package).arg("Architecture"))?;
    if name.trim() == "truepath" {
        let start: &Start =
            if architecture.trim() == "arm64" { &aarch64::emulated } else { &|truepath| program(truepath) };
        let part = used(&place.join("usr"), start)?;
        let all = begun.elapsed();
        let file = package.file_name().unwrap_or_default().to_string_lossy();
        println!(
            "    {file} installed in {:.1} s, a part corrected after {:.1} s",
            in_place.as_secs_f64(),
            all.as_secs_f64()
        );
        fs::remove_dir_all(part).map_err(|e| Failure::found(e.to_string()))?;
    }
    run(&mut dpkg(&["--purge", name.trim()]))?;
    let left: Vec<_> =
        files_below(place)?.into_iter().filter(|f| !before.contains(f) && !f.starts_with("var/lib/dpkg")).collect();
    if left.is_empty() { Ok(()) } else { Err(Failure::found(format!("{name} leaves {left:?}"))) }
}

/// Unpacks the archive for a processor and uses it, started in its own way; the folder of the part that it corrected.
fn unpacked_used(folder: &Path, processor: &str, start: &Start) -> Result<PathBuf, Failure> {
    run(program("tar").arg("--extract").arg("--file").arg(archive(folder, processor)).arg("--directory").arg(folder))?;
    used(&folder.join(archived(processor)), start)
}

/// Makes the command that runs a program.
type Start = dyn Fn(&Path) -> Command;

/// Whether two folders hold the same files.
fn same_files(here: &Path, there: &Path) -> Result<(), Failure> {
    let (names, others) = (files_below(here)?, files_below(there)?);
    let differs = |name: &&PathBuf| fs::read(here.join(name)).ok() != fs::read(there.join(name)).ok();
    let different: Vec<&PathBuf> = names.iter().filter(differs).collect();
    if names == others && different.is_empty() {
        return Ok(());
    }
    Err(Failure::found(format!("{} and {} differ in {different:?}", here.display(), there.display())))
}

/// A stranger's first minutes with what lies there: a page of the manual, completions, and a corrected part; its folder.
fn used(usr: &Path, start: &Start) -> Result<PathBuf, Failure> {
    let page =
        read(program("gzip").args(["--decompress", "--stdout"]).arg(usr.join("share/man/man1/truepath-correct.1.gz")))?;
    let completions = usr.join("share/bash-completion/completions/truepath");
    run(program("bash").args(["-n"]).arg(&completions))?;
    if !page.contains(".TH truepath-correct") {
        return Err(Failure::found("the page of correct is not one"));
    }
    let work = usr.join("part");
    let _ = fs::remove_dir_all(&work);
    let part = root().join("linuxcnc/sim/programs");
    let mut command = start(&usr.join("bin/truepath"));
    command.env_clear().arg("correct").arg(part.join("corner.toml"));
    command.arg("--probe").arg(part.join("corner-probe-log.txt"));
    run(command.arg("--quiet").arg("--output").arg(&work))?;
    let corrected = fs::metadata(work.join("corrected.nc")).is_ok_and(|data| data.len() > 0);
    if corrected { Ok(work) } else { Err(Failure::found("the installed program corrected nothing")) }
}

/// What lies in a folder, by name.
fn sorted(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let entries = folder.read_dir().map_err(|e| Failure::found(format!("{}: {e}", folder.display())))?;
    let mut all: Vec<PathBuf> = entries.filter_map(|entry| Some(entry.ok()?.path())).collect();
    all.sort();
    Ok(all)
}

/// The files below a folder, from there.
fn files_below(folder: &Path) -> Result<Vec<PathBuf>, Failure> {
    let mut files = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in sorted(&next)? {
            match entry.is_dir() {
                true => folders.push(entry),
                false => files.push(entry.strip_prefix(folder).unwrap_or(&entry).to_owned()),
            }
        }
    }
    files.sort();
    Ok(files)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_bill_names_the_crates_that_are_linked_in_once_each_with_a_licence() {
        let bill = bill_of_materials("truepath", "1.2.3").unwrap();
        let parts = bill["components"].as_array().unwrap();
        let names: Vec<&str> = parts.iter().filter_map(|part| part["name"].as_str()).collect();
        assert!(["truepath-core", "clap", "serde"].iter().all(|name| names.contains(name)), "{names:?}");
        assert!(!names.contains(&"criterion") && !names.contains(&"truepath"), "{names:?}");
        let mut places: Vec<&str> = parts.iter().filter_map(|part| part["purl"].as_str()).collect();
        let all = places.len();
        places.dedup();
        assert_eq!((places.len(), parts.len()), (all, all));
        assert!(parts.iter().all(|part| part["licenses"][0]["expression"].as_str().is_some_and(|l| !l.contains('/'))));
    }
}
