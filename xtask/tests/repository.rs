//! Properties of the repository as a whole that no compiler checks.

use std::fs;
use std::path::{Path, PathBuf};

/// The crates of the core, and the modules of those that hold several in the order in which data flows; none uses one
/// that comes later.
const CORE: [(&str, &[&str]); 5] = [
    ("core/units", &["errors", "checksum", "geometry"]),
    ("core/rs274", &[]),
    ("core/wire", &["image", "update", "rewrite", "link"]),
    ("core/model", &["probe", "cut", "identify", "correct", "process"]),
    ("core", &["job", "errors"]),
];
/// Names under which unrelated things gather.
const CATCH_ALL: [&str; 6] = ["util", "utils", "common", "helpers", "manager", "misc"];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR")).parent().unwrap()
}

/// The Rust files below a folder.
fn sources(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(folder) = folders.pop() {
        for entry in fs::read_dir(&folder).unwrap().map(|e| e.unwrap().path()) {
            if entry.is_dir() {
                folders.push(entry);
            } else if entry.extension().is_some_and(|e| e == "rs") {
                found.push(entry);
            }
        }
    }
    assert!(!found.is_empty(), "no source in {}", folder.display());
    found
}

/// The sources of every package, without tests and benchmarks.
fn all_sources() -> Vec<PathBuf> {
    let workspace = fs::read_to_string(root().join("Cargo.toml")).unwrap();
    let (_, members) = workspace.split_once("\nmembers = [").unwrap();
    let (members, _) = members.split_once(']').unwrap();
    let members: Vec<&str> = members.split('"').skip(1).step_by(2).collect();
    assert!(members.contains(&"xtask"), "{members:?}");
    members.into_iter().flat_map(|package| sources(&root().join(package).join("src"))).collect()
}

/// Code lines of a file: without comments and without what follows `#[cfg(test)]`; none of a file of tests.
fn code(file: &Path) -> Vec<String> {
    if is_tests(file) {
        return Vec::new();
    }
    let text = fs::read_to_string(file).unwrap();
    let lines = text.lines().take_while(|l| l.trim() != "#[cfg(test)]").filter(|l| !l.trim_start().starts_with("//"));
    lines.map(str::to_owned).collect()
}

fn is_tests(file: &Path) -> bool {
    file.file_stem().is_some_and(|s| s == "tests")
}

#[test]
fn no_module_of_the_core_uses_one_further_down() {
    let mut wrong = Vec::new();
    let layers = CORE.iter().flat_map(|(package, layers)| (0..layers.len()).map(move |place| (package, layers, place)));
    for (package, layers, place) in layers {
        let source = root().join(package).join("src");
        let file = source.join(layers[place]).with_extension("rs");
        let files = if file.exists() { vec![file] } else { sources(&source.join(layers[place])) };
        for file in files {
            for line in code(&file) {
                for below in &layers[place + 1..] {
                    if line.contains(&format!("crate::{below}::")) || line.contains(&format!("crate::{below};")) {
                        wrong.push(format!("{}: {}", file.display(), line.trim()));
                    }
                }
            }
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

#[test]
fn every_module_of_the_core_has_its_place_in_the_order() {
    for (package, layers) in CORE.iter().filter(|(_, layers)| !layers.is_empty()) {
        let lib = fs::read_to_string(root().join(package).join("src/lib.rs")).unwrap();
        let modules: Vec<&str> = lib.lines().filter_map(|l| l.strip_prefix("pub mod ")?.strip_suffix(';')).collect();
        assert!(!modules.is_empty(), "{package}");
        for module in modules {
            assert!(layers.contains(&module), "{package}: {module} has no place");
        }
    }
}

#[test]
fn every_source_file_says_what_it_is_and_is_named_after_something() {
    let mut wrong = Vec::new();
    for file in all_sources() {
        let text = fs::read_to_string(&file).unwrap();
        if !is_tests(&file) && !text.starts_with("//!") && !text.starts_with("#![doc") {
            wrong.push(format!("{} does not begin with what it is", file.display()));
        }
        if file.iter().any(|part| CATCH_ALL.iter().any(|name| part.to_string_lossy().trim_end_matches(".rs") == *name))
        {
            wrong.push(format!("{} is named after nothing in particular", file.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// What of `linuxcnc/` is source.
const LINUXCNC_SOURCES: [&str; 7] = ["py", "comp", "h", "hal", "ini", "xml", ""];

/// The files below a folder of `linuxcnc/` that are source and no Rust.
fn linuxcnc_sources(folder: &Path, found: &mut Vec<PathBuf>) {
    for path in fs::read_dir(folder).unwrap().map(|e| e.unwrap().path()) {
        let name = path.file_name().unwrap().to_string_lossy().into_owned();
        let end = name.rsplit_once('.').map_or("", |(_, end)| end);
        if path.is_dir() {
            linuxcnc_sources(&path, found);
        } else if LINUXCNC_SOURCES.contains(&end) && name != "COPYING" {
            found.push(path);
        }
    }
}

#[test]
fn every_source_file_for_linuxcnc_names_its_licence() {
    let (mut found, mut wrong) = (Vec::new(), Vec::new());
    linuxcnc_sources(&root().join("linuxcnc"), &mut found);
    assert!(found.len() > 20, "{found:?}");
    for file in found {
        let text = fs::read_to_string(&file).unwrap();
        let licence = text.lines().take(3).find_map(|line| line.split_once("SPDX-License-Identifier: "));
        // What is under the permissive licences may be used without HAL.
        let permissive = file.starts_with(root().join("linuxcnc/abi"));
        let expected = if permissive { "MIT OR Apache-2.0" } else { "GPL-2.0-or-later" };
        if !licence.is_some_and(|(_, name)| name.starts_with(expected)) {
            wrong.push(format!("{} does not name {expected} in its first three lines", file.display()));
        }
    }
    assert!(wrong.is_empty(), "{}", wrong.join("\n"));
}

/// A build script that asks cargo for something finds nothing on a machine with an empty cargo home.
#[test]
fn the_build_script_of_the_firmware_starts_no_program() {
    let script = fs::read_to_string(root().join("firmware/build.rs")).unwrap();
    assert!(!script.contains("Command"), "{script}");
}

#[test]
fn the_core_stays_without_std_and_without_unsafe() {
    for (package, _) in CORE {
        let lib = fs::read_to_string(root().join(package).join("src/lib.rs")).unwrap();
        for attribute in ["#![no_std]", "#![forbid(unsafe_code)]", "#![deny(missing_docs)]"] {
            assert!(lib.lines().any(|l| l == attribute), "{package}: {attribute}");
        }
        for file in sources(&root().join(package).join("src")) {
            for line in code(&file) {
                let alloc = line.contains("extern crate alloc") || line.contains("alloc::");
                assert!(!alloc && !line.contains("use std::"), "{}: {line}", file.display());
            }
        }
    }
}
